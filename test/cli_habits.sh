#!/usr/bin/env bash
# The program's habits: every line of doc/cli.md, many files in one call, standard output, files that
# are there already, help, the man page and completions, colours. Usage: cli_habits.sh GIRIH ASSETS_FOLDER
set -u
here=$(dirname "$(realpath "$0")")
# shellcheck source=test/cli_functions.sh
source "$here/cli_functions.sh"

# --- The lines of doc/cli.md, as they stand there.

mkdir models
cp "$assets/teapot.glb" "$assets/crack_traps.glb" .
cp "$assets/cube_hard.glb" "$assets/seam_sphere.glb" "$assets/teapot.glb" models
# A height map of its own: 2 x 2 pixels of gray.
python3 - <<'PYTHON'
import struct, zlib
def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
rows = b"\0\0\xff\0\xff\0"
open("bumps.png", "wb").write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 2, 2, 8, 0, 0, 0, 0)) +
                              chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))
PYTHON
mkdir bin
ln -s "$girih" bin/girih
lines=0
# shellcheck disable=SC2016 # backquotes of the page
while IFS= read -r line; do
    lines=$((lines + 1))
    PATH=$PWD/bin:$PATH bash -o pipefail -c "$line" >out 2>err </dev/null || fail "doc/cli.md: $line: $(head -c 400 err)"
done < <(sed -n '/^```/,/^```/{/^girih /p}' "$here/../doc/cli.md")
[[ $lines -ge 10 ]] || fail "doc/cli.md has $lines lines of girih"
for file in right lines turn-000 turn-003 thumbnail levels both cracks teapot; do
    [[ -s $file.png ]] || fail "doc/cli.md: no $file.png"
done
[[ ! -e turn-004.png ]] || fail "a turntable of 4 has a fifth picture"
gunzip -t even.glb.gz || fail "what went into the pipe is not whole"

# --- Many files: what fails leaves the others to be done.

echo "no glTF" >broken.glb
expect 1 check models/cube_hard.glb broken.glb models/seam_sphere.glb --json
json '[f["file"] for f in o["files"]] == ["models/cube_hard.glb", "models/seam_sphere.glb"]'
expect 1 refine models/cube_hard.glb broken.glb models/seam_sphere.glb --segments 2 --output-folder some --json
json '[f["output"] for f in o["files"]] == ["some/cube_hard.glb", "some/seam_sphere.glb"]'
json 'o["files"][0]["output_triangles"] == 12 * 4'
expect 1 refine models/teapot.glb teapot.glb --output-folder twice
expect_one_line "two models of one name"
[[ ! -e twice ]] || fail "a folder is made for models that cannot be told apart"
expect 1 refine models/cube_hard.glb --output-folder broken.glb
expect_one_line "a folder that is a file"
expect 2 refine models/teapot.glb teapot.glb -o one.glb
expect 2 check models/teapot.glb teapot.glb --from teapot.glb

# --- Files that are there, and standard output.

cp some/cube_hard.glb kept.glb
code=0
"$girih" refine models/cube_hard.glb --segments 3 -o kept.glb >out 2>err || code=$?
[[ $code -eq 1 ]] || fail "a file that is there: exit code $code, not 1"
expect_one_line "a file that is there"
same kept.glb some/cube_hard.glb
"$girih" refine models/cube_hard.glb --segments 3 -o kept.glb --overwrite 2>err || fail "--overwrite: $(<err)"
"$girih" refine models/cube_hard.glb --segments 3 -o - >piped.glb 2>err || fail "-o -: $(<err)"
same kept.glb piped.glb
expect 1 refine models/cube_hard.glb --segments 3 -o /dev/full
expect_one_line "a full disk"
[[ $(<err) != */dev/full*/dev/full* ]] || fail "a full disk is named twice: $(<err)"
"$girih" render models/cube_hard.glb --resolution 64,64 -o - >piped.png 2>err || fail "-o -: $(<err)"
expect 0 render models/cube_hard.glb --resolution 64,64 -o file.png
same piped.png file.png
expect 2 refine models/cube_hard.glb -o - --json
expect 2 render models/cube_hard.glb -o - --json

# --- Cameras by direction: what is seen from one side is mirrored from the other.

expect 0 render models/cube_hard.glb --camera-direction 0,0,-1 --resolution 80,80 -o front.png
expect 0 render models/cube_hard.glb --camera-direction 0,0,-7 --resolution 80,80 -o same.png
same front.png same.png
expect 2 render models/cube_hard.glb --camera-direction 0,0,0 -o none.png
expect 2 render models/cube_hard.glb --camera-direction 0,0,-1 --camera-position 0,0,5 -o none.png

# --- Help, man page, completions.

built=$(dirname "$girih")
for command in render view refine info check; do
    expect 0 help "$command"
    mv out helped
    expect 0 "$command" --help
    same out helped
    grep -q '^Examples:' out || fail "girih $command --help has no examples"
    while read -r option; do
        grep -q -- "${option//-/\\\\-}" "$built/girih.1" || fail "man page: no $option of $command"
        for shell in girih.bash _girih girih.fish; do
            grep -q -- "${option#--}" "$built/$shell" || fail "$shell: no $option of $command"
        done
    done < <(grep -oE '^ +(-., )?--[a-z-]+' out | grep -oE -- '--[a-z-]+')
done
expect 2 help nothing
expect 0 --version
[[ $(<out) == "girih "* ]] || fail "--version: $(<out)"

# shellcheck disable=SC1091 # made by the build
source "$built/girih.bash"
complete_line() {
    COMP_WORDS=("$@") COMP_CWORD=$(($# - 1))
    _girih
    completed="${COMPREPLY[*]}"
}
complete_line girih re
[[ $completed == "render refine" ]] || fail "completion of re: $completed"
complete_line girih render --shade le
[[ $completed == levels ]] || fail "completion of --shade le: $completed"
complete_line girih check models/te
[[ $completed == models/teapot.glb ]] || fail "completion of a file: $completed"

# --- Colours on a terminal alone.

"$girih" info models/cube_hard.glb | grep -q $'\033' && fail "colours in a pipe"
if command -v script >/dev/null; then
    TERM=xterm script -qec "'$girih' info models/cube_hard.glb" /dev/null </dev/null | grep -q $'\033\[1m' ||
        fail "no colours on a terminal"
    NO_COLOR=1 TERM=xterm script -qec "'$girih' info models/cube_hard.glb" /dev/null </dev/null |
        grep -q $'\033\[1m' && fail "NO_COLOR is not heard"
fi

echo "$failures failures"
[[ $failures -eq 0 ]]
