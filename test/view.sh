#!/usr/bin/env bash
# girih view: a window on a display of its own, with real keys and a real mouse. Exit code 77, which
# meson counts as skipped, where there is nothing to make a display with.
# Usage: view.sh GIRIH ASSETS_FOLDER
set -uo pipefail

if ! command -v Xvfb >/dev/null || ! command -v xdotool >/dev/null; then
    echo 'no Xvfb or no xdotool'
    exit 77
fi

# shellcheck source=test/cli_functions.sh
. "$(dirname -- "$0")/cli_functions.sh"

# --- Wrong use, and no display ---
unset DISPLAY WAYLAND_DISPLAY
expect 2 view
for wrong in --cpu '--projection cylinder' '--frames 0' '--shade pretty' '-o - --json'; do
    # shellcheck disable=SC2086 # two words
    expect 2 view "$assets/teapot.glb" $wrong
done
expect 1 view "$assets/teapot.glb"
expect_one_line 'no display'
grep -q 'girih render' err || fail "no display: nothing about girih render: $(<err)"

# --- A display ---
mkfifo display_number
# Without -noreset it starts anew, and is not there, whenever a window was its last.
Xvfb -noreset -displayfd 3 -screen 0 800x600x24 3>display_number 2>xvfb &
server=$!
trap 'kill "$server" 2>/dev/null; wait "$server" 2>/dev/null; rm -rf -- "$folder"' EXIT
read -r number <display_number
export DISPLAY=":$number"
small=(--resolution '320,240' --samples 1)

# within SECONDS COMMAND...: until it succeeds.
within() {
    local end=$((${EPOCHREALTIME/./} + $1 * 1000000))
    shift
    until "$@"; do
        if ((${EPOCHREALTIME/./} > end)); then
            return 1
        fi
        sleep 0.05
    done
}

find_window() {
    window=$(xdotool search --onlyvisible --name ' - girih$' 2>/dev/null) && [[ -n $window ]]
}

# open ARGUMENT...: a window, its output in out and err.
open() {
    "$girih" view "$@" "${small[@]}" --json >out 2>err &
    viewer=$!
    within 40 find_window || fail "girih view $*: no window: $(<err)"
    xdotool windowfocus "$window"
}

# close: with Escape; nothing may have been said by the validation layer.
close() {
    local code=0
    xdotool key --window "$window" Escape
    wait "$viewer" || code=$?
    [[ $code -eq 0 ]] || fail "girih view: exit code $code: $(<err)"
}

keys() {
    xdotool key --delay 5 --window "$window" "$@"
}

pictures=0

# picture FILE.png: of the window, moved from the name that girih gives it.
picture() {
    local name
    keys p
    pictures=$((pictures + 1))
    if ! within 40 has_pictures; then
        fail "$1: no picture: $(<err)"
        return
    fi
    name=$(grep '^girih: wrote ' err | tail -n 1)
    mv -- "${name#girih: wrote }" "$1"
}

has_pictures() {
    [[ $(grep -c '^girih: wrote ' err) -ge $pictures ]]
}

says() {
    grep -q -- "$1" err
}

compiled_twice() {
    [[ $(grep -c 'compiled own.glsl' err) -eq 2 ]]
}

differ() {
    if cmp -s "$1" "$2"; then
        fail "$1 and $2 are the same"
    fi
}

# --- By itself: some pictures, then the end; the last one is what girih render draws ---
expect 0 view "$assets/crack_traps.glb" "${small[@]}" --frames 3 --no-legend --json -o last.png
json 'o["frames"] == 3 and o["output_triangles"] > 0 and o["frames_per_second"] > 0'
expect 0 render "$assets/crack_traps.glb" "${small[@]}" --no-legend -o render.png
same last.png render.png

# --- Looks, levels, modes, camera ---
pictures=0
open "$assets/crack_traps.glb" --no-legend
picture lit.png
for shade in normals levels patterns density; do
    keys c
    picture "$shade.png"
    differ "$shade.png" lit.png
done
keys c e
picture edges.png
differ edges.png lit.png
keys e
picture again.png
same again.png lit.png
for mode in 1 2 3; do
    keys m
    picture "mode.png"
    same mode.png lit.png
done
keys s
picture flat.png
differ flat.png lit.png
keys s plus plus plus
picture fine.png
keys minus minus minus r s s
keys r r r
picture again.png
same again.png lit.png
keys h
picture help.png
differ help.png lit.png
keys h z
picture statistics.png
differ statistics.png lit.png
keys z
xdotool mousemove --window "$window" 160 120 mousedown 1 \
    mousemove --window "$window" 200 110 mouseup 1 click 4
picture turned.png
differ turned.png lit.png
keys Return
picture again.png
same again.png lit.png

# --- Sizes: one pixel, hidden, and back ---
xdotool windowsize --sync "$window" 1 1
sleep 0.2
picture pixel.png
xdotool windowunmap --sync "$window"
sleep 0.3
xdotool windowmap --sync "$window" windowsize --sync "$window" 320 240
xdotool windowfocus "$window"
sleep 0.2
keys Return
picture again.png
same again.png lit.png
close

# --- Frozen levels: what is culled stays so while the camera goes to the other side ---
pictures=0
open "$assets/teapot.glb" --shade levels --no-legend --segments 2
keys f
picture front.png
xdotool mousemove --window "$window" 40 120 mousedown 1 mousemove --window "$window" 280 120 mouseup 1
picture frozen.png
differ frozen.png front.png
close
culled=$(python3 -c 'import json; print(json.load(open("out"))["culled_triangles"])')
expect 0 render "$assets/teapot.glb" "${small[@]}" --segments 2 --json -o render.png
json "o['culled_triangles'] == $culled"

# --- More than a plan's room at first, and split triangles ---
expect 0 view "$assets/cube_hard.glb" "${small[@]}" --segments 500 --frames 6 --json
json 'o["output_triangles"] == 6 * 512 * 512 and o["split_triangles"] == 6'

# --- A surface's file: compiled within half a second of its change; an error leaves the last one ---
wave() {
    printf 'vec3 girih_surface(GirihPatch patch_, vec3 b) {
    vec3 base = girih_base_position(patch_, b);
    return base + girih_base_normal(patch_, b) * (%s * patch_.scale);
}\n' "$1" >next.glsl
    mv next.glsl own.glsl
    changed=${EPOCHREALTIME/./}
}
wave 0.0
pictures=0
open "$assets/teapot.glb" --surface own.glsl --segments 2 --no-legend
picture before.png
wave 0.2
within 20 says 'compiled own.glsl' || fail "own.glsl: not compiled again: $(<err)"
echo "an edited surface is there after $(((${EPOCHREALTIME/./} - changed) / 1000)) ms"
picture after.png
differ after.png before.png
wave 'no_such_thing'
within 20 says 'own.glsl:3: ' || fail "own.glsl: no error: $(<err)"
picture error.png
differ error.png after.png
wave 0.2
within 20 compiled_twice || fail "own.glsl: not compiled after the error: $(<err)"
picture again.png
same again.png after.png
close

# --- A model with a skin and morph targets that moves ---
pictures=0
open "$assets/worm.glb" --play --no-legend
picture first.png
picture second.png
differ first.png second.png
keys space
picture paused.png
keys w
picture other.png
differ other.png paused.png
close
moment=(--animation 1 --time 0.4 --surface flat --no-legend)
expect 0 view "$assets/worm.glb" "${small[@]}" "${moment[@]}" --frames 1 -o moment.png
expect 0 render "$assets/worm.glb" "${small[@]}" "${moment[@]}" -o render.png
same moment.png render.png

# --- Files that are no good ---
printf 'not glTF' >bad.glb
expect 1 view bad.glb
expect_one_line 'not glTF'
expect 1 view "$assets/teapot.glb" --surface missing.glsl
expect_one_line 'no surface file'

[[ $failures -eq 0 ]]
