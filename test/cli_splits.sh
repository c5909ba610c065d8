#!/usr/bin/env bash
# More segments than the catalogue holds: refine, check and render with triangles that are split.
# Usage: cli_splits.sh GIRIH ASSETS_FOLDER
set -uo pipefail

tests=$(dirname -- "$(realpath -- "$0")")

# shellcheck source=test/cli_functions.sh
. "$tests/cli_functions.sh"

# lacks PNG R G B: no pixel has about this colour.
lacks() {
    python3 - "$tests" "$@" <<'PYTHON' || fail "$1 has pixels of colour ${*:2}"
import sys
sys.path.insert(0, sys.argv[1])
from panorama import read_png
wanted = [int(n) for n in sys.argv[3:]]
sys.exit(any(max(abs(a - b) for a, b in zip(pixel, wanted)) < 60 for row in read_png(sys.argv[2]) for pixel in row))
PYTHON
}

# welded GLB: every vertex is used, and no two of a primitive have the same bits.
welded() {
    python3 - "$1" <<'PYTHON' || fail "$1 is not welded"
import json, struct, sys

data = open(sys.argv[1], 'rb').read()
size = struct.unpack_from('<I', data, 12)[0]
document = json.loads(data[20:20 + size])
sizes = {'SCALAR': 4, 'VEC2': 8, 'VEC3': 12, 'VEC4': 16}

def records(number):
    accessor = document['accessors'][number]
    view = document['bufferViews'][accessor['bufferView']]
    step = sizes[accessor['type']] if accessor['componentType'] in (5125, 5126) else 2
    start = 28 + size + view.get('byteOffset', 0) + accessor.get('byteOffset', 0)
    return [data[start + step * n:start + step * (n + 1)] for n in range(accessor['count'])]

for mesh in document['meshes']:
    for primitive in mesh['primitives']:
        vertices = list(zip(*(records(n) for n in primitive['attributes'].values())))
        assert len(set(vertices)) == len(vertices)
        assert len(set(records(primitive['indices']))) == len(vertices)
PYTHON
}

# --- Wrong use, and what is too large: one line, at once, and no file ---
for wrong in 0 32769 3x; do
    expect 2 refine "$assets/cube_hard.glb" -o out.any --max-segments "$wrong"
done
for how in '' --cpu; do
    for options in '--segments 32768' '--catalogue linear --segments random:1:32768'; do
        # shellcheck disable=SC2086 # several words
        expect 1 refine "$assets/teapot.glb" -o out.any $options $how
        expect_one_line "refine $options $how"
        grep -q 'ask for fewer segments' err || fail "refine $options $how: $(cat err)"
    done
    expect 1 render "$assets/teapot.glb" -o out.any --segments 32768 ${how:+"$how"}
    expect_one_line "render $how"
done
[[ ! -e out.any ]] || fail 'a failure wrote a file'

# --- refine and check: closed, welded, the counts that the levels say, the CPU writes the same ---
for refined in 'teapot --catalogue linear --segments 37' 'cube_hard --segments random:7:300' \
    'seam_sphere --catalogue linear --segments random:3:40 --surface flat' 'mirror --segments random:2:90' \
    'primitives --catalogue linear --segments random:5:40'; do
    read -r model options <<<"$refined"
    read -ra options <<<"$options"
    expect 0 refine "$assets/$model.glb" -o fine.glb "${options[@]}" --json
    json 'o["clamped_edges"] == 0 and o["parts"] > o["split_triangles"] > 0 and o["mode"] == "welded"'
    cp out report
    expect 0 refine "$assets/$model.glb" -o cpu.glb "${options[@]}" --cpu --json
    json 'all(o[key] == other[key] for other in [json.load(open("report"))]
              for key in ("split_triangles", "parts", "output_triangles", "output_vertices", "groups"))'
    same fine.glb cpu.glb
    expect 0 check fine.glb --from "$assets/$model.glb" "${options[@]}" --json
    json 'all(m["as_expected"] and m["degenerate"] == 0 for m in o["meshes"])'
done
for catalogue in dyadic linear; do
    expect 0 refine "$assets/cube_hard.glb" -o fine.glb --segments random:2:90 --catalogue "$catalogue" --cpu
    welded fine.glb
done

# Every edge in n segments: a triangle becomes n * n. A dyadic catalogue rounds 200 up to 256.
expect 0 refine "$assets/cube_hard.glb" -o fine.glb --segments 200 --json
json 'o["split_triangles"] == 12 and o["output_triangles"] == 12 * 256 * 256'
expect 0 check fine.glb --from "$assets/cube_hard.glb" --segments 200 --json
json 'o["triangles"] == 12 * 256 * 256 and o["open"] == o["nonmanifold"] == o["degenerate"] == 0'
# Baked has the same triangles and more vertices.
expect 0 refine "$assets/cube_hard.glb" -o baked.glb --segments 100 --mode baked --cpu --json
json 'o["mode"] == "baked" and o["output_triangles"] == 12 * 128 * 128 and o["output_vertices"] > 12 * 130 * 129 // 2'
expect 0 check baked.glb --from "$assets/cube_hard.glb" --segments 100

# --- --max-segments: what is beyond it is clamped and counted, and no more than the catalogue holds clamps to it ---
expect 0 refine "$assets/cube_hard.glb" -o fine.glb --segments 1000 --max-segments 128 --cpu --json
json 'o["clamped_edges"] == 18 and o["output_triangles"] == 12 * 128 * 128'
expect 0 check fine.glb --from "$assets/cube_hard.glb" --segments 1000 --max-segments 128
expect 0 refine "$assets/cube_hard.glb" -o fine.glb --segments 1000 --max-segments 64 --cpu
grep -q '18 edges asked for more segments' err || fail "no note about clamped edges: $(cat err)"
expect 0 check fine.glb --from "$assets/cube_hard.glb" --segments 1000 --max-segments 64 --json
json 'o["triangles"] == 12 * 64 * 64'

# --- render: the same picture in every mode; back faces show nowhere ---
cat >waves.glsl <<'GLSL'
vec3 girih_surface(GirihPatch patch_, vec3 barycentric) {
    vec3 base = girih_base_position(patch_, barycentric);
    return base + girih_base_normal(patch_, barycentric) * (0.02 * patch_.scale * sin(40.0 * base.y));
}
GLSL
size=(--resolution '300,200')
for drawing in 'primitives --segments random:3:100' 'mirror --catalogue linear --segments random:2:30 --surface flat' \
    'cube_hard --segments 100 --surface waves.glsl'; do
    read -r model options <<<"$drawing"
    read -ra options <<<"$options"
    for mode in instanced baked welded; do
        expect 0 render "$assets/$model.glb" "${options[@]}" --mode "$mode" "${size[@]}" -o "$mode.png" --json
        json "o['split_triangles'] > 0 and o['mode'] == '${mode/welded/baked}'"
    done
    same instanced.png baked.png
    same instanced.png welded.png
    if [[ $drawing != *.glsl* ]]; then
        expect 0 render "$assets/$model.glb" "${options[@]}" --cpu "${size[@]}" -o cpu.png
        same instanced.png cpu.png
    fi
done
for extra in '--shade levels' '--shade patterns' '--wireframe --mode instanced' '--beside-input --mode instanced'; do
    # shellcheck disable=SC2086
    expect 0 render "$assets/cube_hard.glb" --segments random:7:100 "${size[@]}" -o extra.png $extra
done
for options in '--segments random:7:90 --mode baked' '--catalogue linear --segments random:3:30 --mode instanced'; do
    # shellcheck disable=SC2086
    expect 0 render "$assets/teapot.glb" $options --backface-color 1,0,1 "${size[@]}" -o cracks.png
    lacks cracks.png 255 0 255
done

# Inside a closed room, all the way round: no pixel of the background.
python3 "$tests/panorama.py" room room.gltf
for mode in instanced baked; do
    expect 0 render room.gltf --projection cylinder --segments random:3:150 --surface flat --resolution 480,240 \
        --mode "$mode" -o "$mode.png" --json
    json 'o["split_triangles"] > 0'
    python3 "$tests/panorama.py" covered "$mode.png" 2>holes || fail "panorama, $mode: $(tail -n 1 holes)"
done
same instanced.png baked.png

if [[ $failures -ne 0 ]]; then
    printf '%d failures\n' "$failures"
    exit 1
fi
echo 'all as it should be'
