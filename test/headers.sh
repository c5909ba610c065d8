#!/usr/bin/env bash
# headers.sh SOURCE: each public header compiles alone, and twice, as C11 and as C++17 without a
# warning, and says how stable it is. CC and CXX name the compilers, with arguments if need be.
set -euo pipefail

include=$1/engine/include
failed=0
count=0
for header in "$include"/girih/*.h; do
    name=girih/${header##*/}
    count=$((count + 1))
    if ! grep -q '^// Stability: \(stable\|experimental\)' <<<"$(sed '/^#ifndef/q' "$header")"; then
        printf '%s: no "Stability: stable" or "Stability: experimental" above its guard\n' "$name" >&2
        failed=1
    fi
    for language in c c++; do
        if [[ $language == c ]]; then
            compiler=("$CC" -std=c11)
        else
            compiler=("$CXX" -std=c++17)
        fi
        # shellcheck disable=SC2086 # a compiler may come with arguments
        if ! printf '#include <%s>\n#include <%s>\n' "$name" "$name" \
            | ${compiler[0]} "${compiler[1]}" -Wall -Wextra -Wpedantic -Werror -fsyntax-only \
                -I"$include" -x "$language" -; then
            printf '%s: does not compile alone as %s\n' "$name" "${compiler[1]#-std=}" >&2
            failed=1
        fi
    done
done
if [[ $count -eq 0 ]]; then
    printf 'no header in %s/girih\n' "$include" >&2
    failed=1
fi
exit "$failed"
