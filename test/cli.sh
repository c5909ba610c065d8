#!/usr/bin/env bash
# The program girih as its users meet it: exit codes, messages, reports, files.
# Usage: cli.sh GIRIH ASSETS_FOLDER
set -uo pipefail

# shellcheck source=test/cli_functions.sh
. "$(dirname -- "$0")/cli_functions.sh"

# --- Help and wrong use ---
expect 0 --help
for command in render view refine info inspect check validate; do
    expect 0 "$command" --help
    grep -q 'Examples:' out || fail "girih $command --help: no examples"
done
expect 2
expect 2 frobnicate
expect 2 render
expect 2 render "$assets/teapot.glb"
expect 2 refine "$assets/teapot.glb"
expect 2 info
expect 2 check
teapot=("$assets/teapot.glb" -o out.png)
for wrong in --displace=map.png --mode=none --surface=nurbs --segments=0 --segments=3x --segments=-1 \
    --segments=random:7 --segments=random:7:0 --edge-pixels=0 --edge-pixels=nan --edge-length=-1 --crease=200 \
    --resolution=10 --resolution=0,10 --camera-position=1,2 --camera-view-angle=0 --shade=pretty \
    --backface-color=255,0,255 --camera-view-up=0,0,0 --time=soon --time=nan; do
    expect 2 render "${teapot[@]}" "$wrong"
    [[ ! -s out ]] || fail "girih render $wrong: something on standard output"
done
expect 2 render "${teapot[@]}" --segments 2 --edge-pixels 3
expect 2 render "${teapot[@]}" --cpu --shade levels
expect 2 render "${teapot[@]}" --camera-index 0 --camera-view-angle 20
expect 2 render "${teapot[@]}" another.glb
expect 2 refine "$assets/teapot.glb" -o out.glb --mode instanced
expect 2 check "$assets/teapot.glb" --segments 2
[[ ! -e out.png && ! -e out.glb ]] || fail 'wrong use wrote a file'

# --- Failures: one clear line, exit code 1, no file ---
printf 'not glTF' >bad.glb
printf '{"asset":{"version":"2.0"}}' >empty.gltf
for command in render refine; do
    for file in nosuch.glb bad.glb empty.gltf .; do
        expect 1 "$command" "$file" -o out.any
        expect_one_line "girih $command $file"
    done
done
grep -q 'no triangles' err || expect 1 render empty.gltf -o out.any
expect 1 info nosuch.glb
expect_one_line info
expect 1 check bad.glb
expect_one_line check
expect 1 render "${teapot[@]}" --device 'no such device'
expect_one_line device
expect 1 render "${teapot[@]}" --catalogue bad.glb
expect_one_line catalogue
expect 1 render "${teapot[@]}" --camera-index 99
expect_one_line camera
expect 1 render "$assets/teapot.glb" -o nosuch/out.png
expect_one_line output
[[ ! -e out.any && ! -e out.png ]] || fail 'a failure wrote a file'
cp "$assets/cube_hard.glb" same.glb
expect 1 refine same.glb -o ./same.glb
expect_one_line 'refine over its input'
same same.glb "$assets/cube_hard.glb"

# --- info ---
expect 0 info "$assets/teapot.glb" --json
json 'o["triangles"] == 1164 and len(o["meshes"]) >= 1 and all(m["open"] == 0 for m in o["meshes"])'
expect 0 inspect "$assets/crack_traps.glb"

# --- render: the same picture in every mode, and a report ---
for model in teapot mirror seam_sphere primitives crack_traps; do
    for mode in instanced baked welded; do
        expect 0 render "$assets/$model.glb" --mode "$mode" --resolution 300,200 -o "$mode.png" --json
        json "o[\"mode\"] == \"$mode\" and o[\"output_triangles\"] > 0 and o[\"groups\"] >= o[\"base_patterns\"] > 0"
    done
    expect 0 render "$assets/$model.glb" --cpu --resolution 300,200 -o cpu.png --json
    same instanced.png baked.png
    same instanced.png welded.png
    same instanced.png cpu.png
done
json 'set(o) >= {"device", "mode", "input_triangles", "culled_triangles", "clamped_edges", "output_triangles",
                 "output_vertices", "groups", "base_patterns", "time_ms"}'
json 'list(o["time_ms"]) == ["levels", "select", "group", "dispatch", "evaluate", "draw"]'
for extra in '--shade normals' '--shade levels' '--shade patterns' --wireframe --beside-input \
    '--segments 3 --catalogue linear' '--edge-length 0.3 --surface flat' '--backface-color 1,0,1'; do
    # shellcheck disable=SC2086 # several words
    expect 0 render "$assets/teapot.glb" --resolution 101,80 -o extra.png $extra
    [[ ! -s out ]] || fail "$extra: something on standard output"
done
expect 0 render "$assets/blend.glb" --camera-index 0 --resolution 200,150 -o blend.png

# --- Poses: by time and animation, alike in every mode, held behind the end ---
worm=("$assets/worm.glb" --resolution 120,90)
pose() { # FILE OPTION...
    expect 0 render "${worm[@]}" -o "$@"
}
pose rest.png
pose start.png --animation swallow
same rest.png start.png # the worm swallows nothing yet, and its node's transform is not the skin's
for mode in instanced baked welded; do
    pose "$mode.png" --time 0.7 --mode "$mode"
done
pose cpu.png --time 0.7 --animation wave --cpu
same instanced.png baked.png
same instanced.png welded.png
same instanced.png cpu.png
pose end.png --time 2 --animation 1
pose later.png --time 99 --animation swallow
same end.png later.png
pose near.png --time 0.9 --camera-index 0
pose far.png --time 1 --camera-index 0
for other in 'rest.png cpu.png' 'near.png far.png'; do
    cmp -s ${other% *} ${other#* } && fail "${other% *} and ${other#* } are alike"
done
expect 1 render "${teapot[@]}" --time 0
expect_one_line 'no animations'
expect 1 render "${worm[@]}" -o out.png --animation crawl
expect_one_line 'no such animation'
grep -q "0 'wave', 1 'swallow'" err || fail 'it does not say which animations there are'
[[ ! -e out.png ]] || fail 'a failure wrote a file'

# --- refine and check: nothing opens that was closed, the CPU writes the same ---
for model in teapot cube_hard seam_sphere crack_traps mirror primitives blend; do
    for surface in pn flat; do
        options=(--segments random:7:16 --surface "$surface")
        expect 0 refine "$assets/$model.glb" -o fine.glb "${options[@]}" --json
        json 'o["culled_triangles"] == 0 and o["output"] == "fine.glb" and o["time_ms"]["draw"] is None'
        expect 0 refine "$assets/$model.glb" -o cpu.glb "${options[@]}" --cpu --json
        same fine.glb cpu.glb
        # Points on the edges of crack_traps's sliver, a triangle without area, meet by position.
        expect "$([[ $model == crack_traps ]] && echo 1 || echo 0)" \
            check fine.glb --from "$assets/$model.glb" "${options[@]}" --json
        json 'all(m["as_expected"] or m["name"] == "sliver" for m in o["meshes"]) and len(o["meshes"]) > 0'
        json 'o["open"] == o["expected_open"] and o["flipped"] == o["expected_flipped"]'
    done
done
expect 0 refine "$assets/teapot.glb" -o pixels.glb --mode baked
expect 0 check pixels.glb --from "$assets/teapot.glb" --json
json 'o["open"] == o["expected_open"] == 0 and o["degenerate"] == 0'
expect 1 check pixels.glb --from "$assets/cube_hard.glb" --segments 2

# What is not there is refused in one line, and the input is never written over.
expect 1 refine "$assets/teapot.glb" -o large.glb --segments 64 --device llvmpipe --catalogue nosuch.gpat
expect_one_line large
cp -- "$assets/cube_hard.glb" own.glb
for command in render refine; do
    expect 1 "$command" own.glb -o own.glb
    expect_one_line "$command"
    same own.glb "$assets/cube_hard.glb"
done

if [[ $failures -ne 0 ]]; then
    printf '%d failures\n' "$failures"
    exit 1
fi
echo 'all as it should be'
