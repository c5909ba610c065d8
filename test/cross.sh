#!/usr/bin/env bash
# cross.sh SOURCE: a cross build with mingw-w64 makes the DLL and the static library without a
# warning, from the generator of the build machine and two sets of headers, and programs link both.
# Skipped (77) where there is no such compiler.
set -euo pipefail

source=$1
prefix=x86_64-w64-mingw32
if ! command -v "$prefix-gcc" >/dev/null; then
    printf 'no %s-gcc: install gcc-mingw-w64-x86-64-win32\n' "$prefix" >&2
    exit 77
fi
folder=$(mktemp -d)
trap 'rm -rf -- "$folder"' EXIT

# The build machine's Vulkan and xxHash headers alone: its other headers are not Windows'.
mkdir "$folder/include"
for header in vulkan/vulkan_core.h vk_video/vulkan_video_codec_h264std.h xxhash.h; do
    found=$(printf '#include <stdint.h>\n#include <%s>\n' "$header" | ${CC:-cc} -E -x c - \
        | sed -n "s,^# 1 \"\(.*\)/$header\".*,\1,p" | head -n 1)
    if [[ -z $found ]]; then
        printf '<%s> not found\n' "$header" >&2
        exit 1
    fi
    ln -s "$found/${header%%/*}" "$folder/include/${header%%/*}"
done

build=$folder/build
if ! meson setup "$build" "$source" --cross-file "$source/test/cross/mingw-w64.ini" --werror \
    -Dcatalogues="${2:-}" -Dc_args="-I$folder/include" >"$folder/log" 2>&1 || ! ninja -C "$build" >>"$folder/log" 2>&1; then
    tail -n 60 "$folder/log" >&2
    exit 1
fi

shared=$(echo "$build"/engine/libgirih*.dll)
static=$build/engine/libgirih.a
NM=$prefix-nm OBJDUMP=$prefix-objdump "$source/test/symbols.sh" "$source" "$shared" "$static"

link() {
    "$prefix-gcc" -std=c11 -Wall -Wextra -Werror -I"$source/engine/include" -I"$folder/include" \
        "$source/test/install/version.c" -o "$folder/version.exe" "$@"
}
imports_dll() {
    [[ $("$prefix-objdump" -p "$folder/version.exe") == *"DLL Name: ${shared##*/}"* ]]
}
for define in -DGIRIH_USE_DLL -UGIRIH_USE_DLL; do
    link "$define" -L"$build/engine" -lgirih
    imports_dll || { printf 'linked with %s, no DLL used\n' "$define" >&2; exit 1; }
done
link "$static"
if imports_dll; then
    printf 'linked with %s, a DLL used\n' "${static##*/}" >&2
    exit 1
fi
