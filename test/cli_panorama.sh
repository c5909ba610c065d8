#!/usr/bin/env bash
# girih render --projection cylinder: panoramas without a hole or a seam, alike in every mode.
# Usage: cli_panorama.sh GIRIH ASSETS_FOLDER
set -uo pipefail

panorama="$(dirname -- "$(realpath -- "$0")")/panorama.py"

# shellcheck source=test/cli_functions.sh
. "$(dirname -- "$0")/cli_functions.sh"

# holds SUBCOMMAND ARGUMENT...: panorama.py finds nothing wrong.
holds() {
    python3 "$panorama" "$@" >holds 2>&1 || fail "panorama.py $*: $(tail -n 1 holds)"
}

# picture FILE.png ARGUMENT...: a panorama that looks along -z.
picture() {
    expect 0 render "${@:2}" --projection cylinder -o "$1" --json
}

holds room room.gltf
holds ring "$assets/teapot.glb" ring.glb
size=(--resolution '480,240')
eye=(--camera-position '0.1,0.2,0.1')
ahead=(--camera-focal-point '0.1,0.2,-5')

# --- Wrong use and failures ---
for wrong in '--projection sphere' '--projection cylinder --camera-view-angle 361' \
    '--projection perspective --camera-view-angle 200' '--projection cylinder --camera-view-angle 0'; do
    # shellcheck disable=SC2086 # several words
    expect 2 render room.gltf -o wrong.png $wrong
done
expect 1 render room.gltf --projection cylinder "${eye[@]}" --camera-focal-point 0.1,9,0.1 -o wrong.png
expect_one_line 'a focal point on the axis'
[[ ! -e wrong.png ]] || fail 'wrong use wrote a file'

# --- Inside a closed room: no pixel of the background, the same picture in every mode ---
for surface in flat pn; do
    for mode in instanced baked welded auto; do
        picture "$mode.png" room.gltf "${size[@]}" "${eye[@]}" "${ahead[@]}" --mode "$mode" --surface "$surface"
        same instanced.png "$mode.png"
    done
    json 'o["culled_triangles"] > 0 and o["clamped_edges"] == 0'
    picture cpu.png room.gltf "${size[@]}" "${eye[@]}" "${ahead[@]}" --cpu --surface "$surface"
    same instanced.png cpu.png
    holds covered instanced.png
done
# Wherever one stands and looks to, tilted too, coarse and fine, in every way to shade.
picture middle.png room.gltf "${size[@]}" --surface flat
holds covered middle.png
picture coarse.png room.gltf "${size[@]}" "${eye[@]}" "${ahead[@]}" --surface flat --edge-pixels 40
holds covered coarse.png
picture tilted.png room.gltf "${size[@]}" --camera-position -1.5,0.5,-2 --camera-focal-point 1,0.2,-1.5 \
    --camera-view-up 0.2,1,0.1 --surface flat --edge-pixels 4 --catalogue linear
holds covered tilted.png
picture wide.png room.gltf --resolution 400,200 "${eye[@]}" "${ahead[@]}" --camera-view-angle 160 --surface flat
holds covered wide.png
picture narrow.png room.gltf "${size[@]}" "${eye[@]}" "${ahead[@]}" --camera-view-angle 20 --surface flat
holds covered narrow.png
json 'o["culled_triangles"] > 150'
for extra in '--shade normals' '--shade levels' '--shade patterns' --wireframe --beside-input '--edge-length 0.3' \
    '--segments random:3:9' '--backface-color 1,0,1'; do
    # shellcheck disable=SC2086 # several words
    picture extra.png ring.glb --resolution 202,80 --camera-position 0,1,0 $extra
done
picture file.png "$assets/blend.glb" --camera-index 0 --camera-view-angle 160 --resolution 200,100

# Corners of the room lie where their angles and slopes put them.
picture normals.png room.gltf "${size[@]}" "${eye[@]}" "${ahead[@]}" --surface flat --shade normals --no-legend --edge-pixels 2
holds corners normals.png 0.1 0.2 0.1

# --- It closes, and turning the camera by 90 degrees moves the picture by a quarter of its width ---
for model in 'room.gltf --surface flat --wireframe' 'room.gltf --surface flat --shade normals --no-legend' 'ring.glb --shade normals --no-legend'; do
    # shellcheck disable=SC2086 # several words
    picture first.png $model "${size[@]}" "${eye[@]}" "${ahead[@]}"
    holds closed first.png
    # shellcheck disable=SC2086
    picture second.png $model "${size[@]}" "${eye[@]}" --camera-focal-point 5.1,0.2,0.1
    # Normals are the world's; lights would turn with the camera. Lines are a pixel wide, and where
    # they pass between two, rounding says which one.
    [[ $model == *wireframe ]] && permille=10 || permille=1
    holds turned first.png second.png 120 "$permille"
done

# --- Surfaces of the user's own, refine and check ---
cat >wave.glsl <<'GLSL'
vec3 girih_surface(GirihPatch patch_, vec3 barycentric) {
    vec3 p = girih_base_position(patch_, barycentric);
    return p + 0.02 * sin(9.0 * p.yzx);
}
GLSL
for mode in instanced baked welded; do
    picture "$mode.png" room.gltf "${size[@]}" "${eye[@]}" "${ahead[@]}" --mode "$mode" --surface wave.glsl --base flat
    holds covered "$mode.png"
    same instanced.png "$mode.png"
done
options=(--projection cylinder --camera-position '0,1,0' --edge-pixels 20 --resolution '600,300')
expect 0 refine ring.glb -o fine.glb "${options[@]}"
expect 0 refine ring.glb -o cpu.glb "${options[@]}" --cpu
same fine.glb cpu.glb
expect 0 check fine.glb --from ring.glb "${options[@]}" --json
json 'o["open"] == o["expected_open"] == 0'

if [[ $failures -ne 0 ]]; then
    printf '%d failures\n' "$failures"
    exit 1
fi
echo 'all as it should be'
