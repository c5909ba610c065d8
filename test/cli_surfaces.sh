#!/usr/bin/env bash
# Surfaces of the user's: --surface FILE.glsl and --displace, in every mode, on the device and the CPU.
# Usage: cli_surfaces.sh GIRIH ASSETS_FOLDER
set -uo pipefail

# shellcheck source=test/cli_functions.sh
. "$(dirname -- "$0")/cli_functions.sh"

# Height maps of random texels: nothing about them agrees across a seam.
python3 - <<'PYTHON'
import random, struct, zlib

def chunk(kind, data):
    return struct.pack('>I', len(data)) + kind + data + struct.pack('>I', zlib.crc32(kind + data))

def png(name, width, height, bits, value):
    rows = b''.join(b'\0' + b''.join(value().to_bytes(bits // 8, 'big') for _ in range(width)) for _ in range(height))
    with open(name, 'wb') as file:
        file.write(b'\x89PNG\r\n\x1a\n' + chunk(b'IHDR', struct.pack('>IIBBBBB', width, height, bits, 0, 0, 0, 0))
                   + chunk(b'IDAT', zlib.compress(rows)) + chunk(b'IEND', b''))

random.seed(7)
png('random16.png', 37, 23, 16, lambda: random.randrange(65536))
png('random8.png', 64, 64, 8, lambda: random.randrange(256))
png('half.png', 1, 1, 16, lambda: 32768)
PYTHON

# The positions of every primitive, bit by bit.
same_positions() {
    python3 - "$1" "$2" <<'PYTHON' || fail "$1 and $2 have other positions"
import json, struct, sys

def positions(path):
    data = open(path, 'rb').read()
    size = struct.unpack_from('<I', data, 12)[0]
    document = json.loads(data[20:20 + size])
    for mesh in document['meshes']:
        for primitive in mesh['primitives']:
            accessor = document['accessors'][primitive['attributes']['POSITION']]
            view = document['bufferViews'][accessor['bufferView']]
            start = 28 + size + view.get('byteOffset', 0) + accessor.get('byteOffset', 0)
            yield data[start:start + 12 * accessor['count']]

sys.exit(list(positions(sys.argv[1])) != list(positions(sys.argv[2])))
PYTHON
}

# Pictures that differ by nothing that an eye could see.
alike() {
    python3 - "$1" "$2" <<'PYTHON' || fail "$1 and $2 do not look alike"
import struct, sys, zlib

def pixels(path):
    data, at, packed = open(path, 'rb').read(), 8, b''
    while at < len(data):
        size, kind = struct.unpack_from('>I4s', data, at)
        if kind == b'IHDR':
            width, height = struct.unpack_from('>II', data, at + 8)
        if kind == b'IDAT':
            packed += data[at + 8:at + 8 + size]
        at += 12 + size
    raw, stride, above, rows = zlib.decompress(packed), 4 * width, bytes(4 * width), []
    for y in range(height):
        method, row = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for x in range(stride):
            a, b, c = row[x - 4] if x > 3 else 0, above[x], above[x - 4] if x > 3 else 0
            p = a + b - c
            paeth = min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2]
            row[x] = (row[x] + (0, a, b, (a + b) // 2, paeth)[method]) & 255
        above = bytes(row)
        rows.append(above)
    return b''.join(rows)

sys.exit(max(abs(a - b) for a, b in zip(pixels(sys.argv[1]), pixels(sys.argv[2]))) > 4)
PYTHON
}

cat >base.glsl <<'GLSL'
vec3 girih_surface(GirihPatch patch_, vec3 barycentric) {
    return girih_base_position(patch_, barycentric);
}
GLSL
cat >waves.glsl <<'GLSL'
#include "girih.glsl" // for editors; here it is there already
#include "depth.glsl"
vec3 girih_surface(GirihPatch patch_, vec3 barycentric) {
    vec3 base = girih_base_position(patch_, barycentric);
    return base + girih_base_normal(patch_, barycentric) * (depth * patch_.scale * sin(40.0 * base.y));
}
GLSL
echo 'const float depth = 0.02;' >depth.glsl

# --- Wrong use ---
sphere=("$assets/seam_sphere.glb" -o out.any)
for command in render refine; do
    for wrong in '--displace half.png' '--height 1' '--height-zero 1' '--base flat' '--surface surface.frag' \
        '--surface .glsl' '--surface base.glsl --cpu' '--surface base.glsl --base nurbs' \
        '--displace half.png --height tall'; do
        # shellcheck disable=SC2086 # several words
        expect 2 "$command" "${sphere[@]}" $wrong
    done
done

# --- Failures: one line with the user's own file and line ---
printf 'vec3 girih_surface(GirihPatch patch_, vec3 b) {\n    return girih_base_position(patch_, b)\n}\n' >syntax.glsl
printf '#include "deeper.glsl"\n' >deep.glsl
printf '\n\nfloat height = unknown;\n' >deeper.glsl
printf 'vec3 surface() { return vec3(0); }\n' >none.glsl
head -c 100 random16.png >short.png
failure() { # WORDS OPTION...
    local words=$1
    shift
    for command in render refine; do
        expect 1 "$command" "${sphere[@]}" "$@"
        expect_one_line "girih $command $*"
        grep -qF -- "$words" err || fail "girih $command $*: not '$words' but $(cat err)"
    done
}
failure "girih: syntax.glsl:3: '' :  syntax error" --surface syntax.glsl
printf 'vec3 girih_surface(GirihPatch patch_, vec3 b) {\n    return girih_base_position(patch_, b);\n' >open.glsl
failure "girih: open.glsl:2: something is not closed by the end of the file" --surface open.glsl
printf 'layout(set = 1, binding = 0) uniform sampler2D own;\nvec3 girih_surface(GirihPatch patch_, vec3 b) {\n' >texture.glsl
printf '    return girih_base_position(patch_, b) * textureLod(own, b.xy, 0.0).x;\n}\n' >>texture.glsl
failure "girih: texture.glsl: declares 'own', a texture or buffer that the command line cannot fill" --surface texture.glsl
failure "girih: deeper.glsl:3: 'unknown' : undeclared identifier" --surface deep.glsl
# shellcheck disable=SC2016 # the message's own quotes
lacking='girih: none.glsl: defines no function `vec3 girih_surface(GirihPatch, vec3)`'
failure "$lacking" --surface none.glsl
failure "$lacking" --surface none.glsl --displace half.png --height 1
failure 'girih: absent.glsl: there is no such file' --surface absent.glsl
failure 'height map absent.png: No such file' --displace absent.png --height 1
failure 'height map short.png: damaged PNG' --displace short.png --height 1
failure 'height map base.glsl: is neither a PNG nor an OpenEXR file' --displace base.glsl --height 1
expect 1 render "${sphere[@]}" --surface syntax.glsl --mode instanced
grep -qF "girih: syntax.glsl:3: '' :  syntax error" err || fail "instanced: $(cat err)"
[[ ! -e out.any ]] || fail 'a failure wrote a file'

# --- The same picture in every mode ---
for model in mirror seam_sphere; do
    for surface in '--surface base.glsl' '--surface waves.glsl --base flat' '--displace random16.png --height 0.1' \
        '--displace random8.png --height 0.1 --height-zero 0.5 --surface waves.glsl'; do
        for mode in instanced baked welded; do
            # shellcheck disable=SC2086 # several words
            expect 0 render "$assets/$model.glb" --mode "$mode" --resolution 300,200 -o "$mode.png" $surface
        done
        same instanced.png baked.png
        same instanced.png welded.png
    done
done
# A map that moves nothing moves nothing.
expect 0 refine "$assets/seam_sphere.glb" -o own.glb --segments 4 --displace half.png --height 0
expect 0 refine "$assets/seam_sphere.glb" -o pn.glb --segments 4
same_positions own.glb pn.glb

# --- Closed by bits wherever the input is, seams, hard edges and mirrored instances included; the CPU
# moves every point as the device does. Where GIRIH_MODELS names a folder that has them, of the Stanford
# bunny and of Spot too ---
models=("$assets"/{teapot,cube_hard,seam_sphere,mirror,primitives}.glb)
if [[ -n ${GIRIH_MODELS:-} ]]; then
    mapfile -t -O "${#models[@]}" models < <(find "$GIRIH_MODELS" -name stanford_bunny.glb -o -name spot_textured.glb)
fi
for model in "${models[@]}"; do
    for surface in '--displace random16.png --height 0.13' '--displace random8.png --height -0.2 --surface flat' \
        '--surface waves.glsl --displace random8.png --height 0.1'; do
        for mode in $([[ $model == */seam_sphere.glb ]] && echo welded baked || echo welded); do
            # shellcheck disable=SC2206 # several words
            options=(--segments random:3:6 $surface)
            expect 0 refine "$model" -o fine.glb --mode "$mode" "${options[@]}"
            expect 0 check fine.glb --from "$model" "${options[@]}" --json
            json 'o["as_expected"] and o["open"] == o["expected_open"]'
            if [[ $surface != *.glsl* ]]; then
                expect 0 refine "$model" -o cpu.glb --mode "$mode" "${options[@]}" --cpu
                same_positions fine.glb cpu.glb
            fi
        done
    done
done

# --- What is culled could not be seen: next to the camera, most of the base is out of the picture ---
# shellcheck disable=SC2054 # commas inside the elements
near=(--camera-position 0,0,1.6 --camera-focal-point 0.5,0,0 --camera-view-angle 25 --resolution 300,200)
expect 0 render "$assets/seam_sphere.glb" --displace random8.png --height 0.3 "${near[@]}" -o culled.png --json
json 'o["culled_triangles"] > 0'
expect 0 render "$assets/seam_sphere.glb" --displace random8.png --height 0.3 --surface base.glsl "${near[@]}" \
    -o whole.png --json
json 'o["culled_triangles"] == 0'
alike culled.png whole.png

if [[ $failures -ne 0 ]]; then
    printf '%d failures\n' "$failures"
    exit 1
fi
echo 'all as it should be'
