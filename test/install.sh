#!/usr/bin/env bash
# install.sh SOURCE BUILD: installs a build elsewhere, and there builds and runs what a host would:
# a C program, every program in examples/ with its own build file, and the snippet in README.md;
# against the shared library, then again against the static one.
set -euo pipefail

source=$1
build=$2
compiler=${CC:-cc}
folder=$(mktemp -d)
trap 'rm -rf -- "$folder"' EXIT

fail() {
    printf 'install: %s\n' "$*" >&2
    exit 1
}

meson install -C "$build" --no-rebuild --quiet --destdir "$folder/root" >"$folder/log" 2>&1 \
    || { cat "$folder/log" >&2; fail "meson install failed"; }
description=$(find "$folder/root" -name girih.pc)
[[ -n $description ]] || fail "no girih.pc is installed"
# What lies under a DESTDIR is not at its prefix yet.
sed -i "s,^prefix=,&$folder/root," "$description"
export PKG_CONFIG_PATH=${description%/*}
library=$(pkg-config --variable=libdir girih)
shaders=$(pkg-config --variable=glsldir girih)
export LD_LIBRARY_PATH=$library${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}

# What the shaders include is installed beside them, what the headers include with them.
for file in "$shaders"/*; do
    while read -r included; do
        [[ -f $shaders/$included ]] || fail "${file##*/} includes $included, which is not installed"
    done < <(sed -n 's/^ *#include *"\(.*\)".*/\1/p' "$file")
done
[[ -f $shaders/girih.glsl ]] || fail "girih.glsl is not installed"
headers=$(pkg-config --variable=includedir girih)
for file in "$source"/engine/include/girih/*.h; do
    cmp -s "$file" "$headers/girih/${file##*/}" || fail "girih/${file##*/} is not installed"
done

uses_shared() {
    grep -q 'NEEDED *libgirih' <<<"$(objdump -p "$1")"
}

# snippet: the first C code after its mark, a whole translation unit.
awk '/<!-- snippet: embedding -->/ { marked = 1 }
     marked && /^```/ && inside { exit }
     inside { print }
     marked && /^```c$/ { inside = 1 }' "$source/README.md" >"$folder/snippet.c"
[[ -s $folder/snippet.c ]] \
    || fail 'README.md has no ```c code after a line <!-- snippet: embedding -->'

# programs LINKED: builds and runs all of them, LINKED being shared or static.
programs() {
    local linked=$1 example name place flags vulkan
    flags=$(pkg-config --cflags --libs girih)
    vulkan=$(pkg-config --libs vulkan)
    # shellcheck disable=SC2086 # compilers and flags are several words
    {
        $compiler -std=c11 -Wall -Wextra -Werror "$source/test/install/version.c" \
            -o "$folder/version" $flags || fail "no program can be built ($linked)"
        # As a library, so that it need not have a main(); complete nevertheless.
        $compiler -std=c11 -Wall -Wextra -Werror -shared -fPIC -Wl,--no-undefined \
            "$folder/snippet.c" -o "$folder/snippet.so" $flags $vulkan \
            || fail "the snippet in README.md does not build ($linked)"
    }
    "$folder/version" || fail "the headers are not those of the library ($linked)"
    check_linked "$linked" "$folder/version"

    local count=0
    for example in "$source"/examples/*/; do
        [[ -f $example/Makefile ]] || continue
        count=$((count + 1))
        name=$(basename "$example")
        place=$folder/$linked/$name
        mkdir -p "$folder/$linked"
        cp -r "$example" "$place"
        make -C "$place" CC="$compiler" all || fail "examples/$name does not build ($linked)"
        check_linked "$linked" "$place/$name"
        run "$place" || fail "examples/$name failed ($linked)"
        if [[ $name == renderer ]]; then
            run "$place" baked || fail "examples/renderer baked failed ($linked)"
            run "$place" threads || fail "examples/renderer threads failed ($linked)"
        fi
    done
    [[ $count -gt 0 ]] || fail "no program in examples/"
}

# run PLACE [ARGUMENT...]: an example in its folder.
run() {
    local said
    said=$(cd "$1" && timeout 90 "./${1##*/}" "${@:2}") || return
    printf '%s\n' "$said"
    [[ $said != *'not validated'* ]] || fail 'the Khronos validation layer is not installed'
}

check_linked() {
    if [[ $1 == shared ]]; then
        uses_shared "$2" || fail "${2##*/} does not use the shared library"
    elif uses_shared "$2"; then
        fail "${2##*/} is not linked with the static library"
    fi
}

programs shared

# Without the shared library -lgirih finds the static one, whose own needs --static adds.
rm "$library"/libgirih.so*
mkdir "$folder/bin"
printf '#!/bin/sh\nexec "%s" --static "$@"\n' "$(command -v pkg-config)" >"$folder/bin/pkg-config"
chmod +x "$folder/bin/pkg-config"
PATH=$folder/bin:$PATH
programs static
