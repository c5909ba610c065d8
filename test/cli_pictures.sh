#!/usr/bin/env bash
# girih render's pictures: legends, lines, sizes, sides, turntables, transparency.
# Usage: cli_pictures.sh GIRIH ASSETS_FOLDER
set -uo pipefail

tests=$(dirname -- "$(realpath -- "$0")")

# shellcheck source=test/cli_functions.sh
. "$tests/cli_functions.sh"

# picture FILE.png MODEL OPTION...
picture() {
    local file=$1
    shift
    expect 0 render "$@" -o "$file" --json
}

# holds LAW ARGUMENT...: of pictures.py
holds() {
    python3 "$tests/pictures.py" "$@" >reason 2>&1 || fail "pictures.py $*: $(tail -n 1 reason)"
}

cube=$assets/cube_hard.glb
size=(--resolution '240,160')
half=(--resolution '120,160')

# --- Wrong use ---
for wrong in --line-width=2 '--wireframe --line-width=0' --exposure=99 --exposure=x --samples=3 --samples=16 \
    --turntable=0 '--turntable=3 --projection=cylinder' '--turntable=3 --camera-index=0' --compare '--compare only' \
    '--compare --nonsense --wireframe' '--compare model.glb --wireframe' '--compare --cpu --wireframe' \
    '--compare --line-width=2 --wireframe' '--compare --camera-view-angle=20 --wireframe' \
    '--compare --wireframe --wireframe --beside-input' '--cpu --compare --wireframe --shade=levels'; do
    # shellcheck disable=SC2086 # several words
    expect 2 render "$cube" -o out.png $wrong
    [[ ! -s out ]] || fail "$wrong: something on standard output"
done
expect 2 render "$cube" -o out.png --compare "--surface 'flat" ''
[[ ! -e out.png ]] || fail 'wrong use wrote a file'

# --- Sizes and lines: a square of 128 pixels, seen from straight ahead ---
python3 "$tests/pictures.py" quad quad.gltf
ahead=(--resolution '256,256' --camera-position '0,0,1' --camera-focal-point '0,0,0'
    --camera-view-angle 90 --surface flat)
picture density.png quad.gltf "${ahead[@]}" --segments 4 --shade density --no-legend --mode instanced
holds density density.png 512
picture legend.png quad.gltf "${ahead[@]}" --segments 4 --shade density --mode baked
holds legend legend.png density.png bottom,right
picture plain.png quad.gltf "${ahead[@]}" --segments 2
for width in 1 4; do
    picture lines.png quad.gltf "${ahead[@]}" --segments 2 --wireframe --line-width "$width"
    holds lines plain.png lines.png "$width"
done
picture other.png quad.gltf "${ahead[@]}" --segments 2 --wireframe --line-width 4 --mode instanced
same lines.png other.png

# --- Legends: a panel in the corner, with the colours that are in use and no others ---
# Split triangles' parts have levels of their own.
picture plain.png "$cube" "${size[@]}" --segments 128 --shade levels --no-legend
picture legend.png "$cube" "${size[@]}" --segments 128 --shade levels
json 'o["split_triangles"] > 0'
holds legend legend.png plain.png bottom,right +0.378,0.95,0.285 -0.95,0.285,0.285 -0.285,0.468,0.95
picture plain.png "$cube" --resolution 300,300 --segments random:7:4 --shade patterns --no-legend
picture legend.png "$cube" --resolution 300,300 --segments random:7:4 --shade patterns
holds legend legend.png plain.png bottom,right
# What has no room for its legend says so and does without.
picture plain.png "$cube" --resolution 40,30 --shade patterns --no-legend
picture legend.png "$cube" --resolution 40,30 --shade patterns
grep -q 'too small for its legend' err || fail "no word about the legend: $(cat err)"
same legend.png plain.png

# --- Sides: each as if it were drawn alone ---
picture both.png "$cube" "${size[@]}" --edge-pixels 30 --no-legend \
    --compare '--surface flat --wireframe' '--segments 3 --shade "normals"'
json 'o["sides"][0]["options"] == "--surface flat --wireframe" and o["sides"][1]["output_triangles"] > 0'
picture left.png "$cube" "${half[@]}" --edge-pixels 30 --surface flat --wireframe
picture right.png "$cube" "${half[@]}" --segments 3 --no-legend --shade normals
holds halves both.png left.png right.png
picture legend.png "$cube" "${half[@]}" --segments 3 --shade normals
holds legend legend.png right.png bottom,left,right +1,0.5,0.5 +0.5,1,0.5 +0.5,0.5,1 +0,0.5,0.5
picture beside.png "$cube" "${size[@]}" --segments 5 --no-legend --beside-input
picture both.png "$cube" "${size[@]}" --segments 5 --no-legend --compare '--segments 1 --surface flat' ''
same beside.png both.png
picture captions.png "$cube" "${size[@]}" --segments 5 --compare '--segments 1 --surface flat --no-legend' ''
holds legend captions.png both.png top,right

# --- A turntable: N files, each what render draws from the position that is told ---
picture turn.v2.png "$cube" "${half[@]}" --edge-pixels 20 --turntable 3
json '[image["output"] for image in o["images"]] == ["turn.v2-%03d.png" % n for n in range(3)]'
place=$(python3 -c 'import json
image = json.load(open("out"))["images"][1]
for key in "camera_position", "camera_focal_point":
    print("--%s=%s" % (key.replace("_", "-"), ",".join("%.9g" % x for x in image[key])))')
[[ ! -e turn.v2.png && ! -e turn.v2-003.png ]] || fail 'a turntable wrote other files'
# shellcheck disable=SC2086
picture one.png "$cube" "${half[@]}" --edge-pixels 20 $place
same one.png turn.v2-001.png
cmp -s turn.v2-000.png turn.v2-001.png && fail 'the turntable does not turn'

# --- Transparency: straight alpha that gives the picture back; 4 samples are the default ---
picture plain.png "$cube" "${half[@]}" --samples 1
picture clear.png "$cube" "${half[@]}" --samples 1 --transparent
holds composed clear.png plain.png 1
picture plain.png "$cube" "${half[@]}"
picture clear.png "$cube" "${half[@]}" --samples 4 --transparent
holds composed clear.png plain.png 4
picture bright.png "$cube" "${half[@]}" --exposure 1
holds brighter plain.png bright.png

if [[ $failures -ne 0 ]]; then
    printf '%d failures\n' "$failures"
    exit 1
fi
echo 'all as it should be'
