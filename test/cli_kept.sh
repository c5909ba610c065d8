#!/usr/bin/env bash
# girih refine keeps all of a glTF file: skins, morph targets, animations and everything beside the
# geometry, on the device and the CPU.
# Usage: cli_kept.sh GIRIH ASSETS_FOLDER
set -uo pipefail

kept=$(realpath -- "$(dirname -- "$0")/kept.py")
# shellcheck source=test/cli_functions.sh
. "$(dirname -- "$0")/cli_functions.sh"

kept() {
    python3 "$kept" "$@" >python 2>&1 || fail "kept.py $*: $(tail -n 1 python)"
}

kept make
for run in 'flat --cpu' 'pn --cpu' 'pn'; do
    read -r surface device <<<"$run"
    flat=()
    if [[ $surface == flat ]]; then
        flat=(--flat)
    fi
    # What is left out is named, and nothing that is not.
    levels=(--segments random:4:7 --surface "$surface")
    expect 0 refine rich.gltf "${levels[@]}" $device -o out.glb
    if [[ $(grep -c 'left out' err) -ne 1 ]] || ! grep -q 'EXT_mesh_features is left out' err; then
        fail "not EXT_mesh_features alone is left out: $(<err)"
    fi
    kept check out.glb "${flat[@]}"
    expect 0 check out.glb --from rich.gltf "${levels[@]}"
    # The triangles are those that a file without skins and morph targets has.
    expect 0 refine plain.gltf "${levels[@]}" $device -o plain.glb
    kept vertices out.glb plain.glb
done
for surface in flat pn; do
    # A morph target is the surface of the morphed mesh.
    for model in rich morphed; do
        expect 0 refine "$model.gltf" --segments 4 --surface "$surface" --mode baked --cpu -o "$model.glb"
    done
    kept check rich.glb
    kept compare rich.glb morphed.glb
done

# Triangles that are split, too.
expect 0 refine rich.gltf --segments random:9:24 --max-segments 24 --catalogue linear --surface flat --cpu -o out.glb
kept check out.glb --flat

exit $((failures > 0))
