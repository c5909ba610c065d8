#!/usr/bin/env bash
# symbols.sh SOURCE SHARED STATIC: the shared library exports the functions that the public headers
# declare and nothing else, and asks for nothing but the C library; all that the static library
# defines begins with girih_. For a Windows DLL, NM and OBJDUMP name the tools for its format.
set -euo pipefail

source=$1
shared=$2
static=$3
nm=${NM:-nm}
objdump=${OBJDUMP:-objdump}
failed=0

# complain WHAT NAMES: nothing where there are no names.
complain() {
    if [[ -n $2 ]]; then
        printf '%s: %s:\n%s\n' "${shared##*/}" "$1" "$2" >&2
        failed=1
    fi
}

declared=$(cat "$source"/engine/include/girih/*.h | sed 's,//.*,,; /^#/d' | tr '\n' ' ' \
    | grep -o 'GIRIH_API [^;(]*(' | grep -o 'girih_[a-z0-9_]*(' | tr -d '(' | sort -u)
case $shared in
*.dll)
    exported=$("$objdump" -p "$shared" | sed -n '/^\[Ordinal\/Name Pointer\]/,/^$/p' \
        | awk '/^[[:space:]]*\[ *[0-9]+\]/ { print $NF }' | sort -u)
    wanted=$("$objdump" -p "$shared" | sed -n 's/.*DLL Name: //p')
    foreign=$(grep -v -i -E '^(kernel32|msvcrt|ucrtbase|api-ms-win-crt-.*)\.dll$' <<<"$wanted" || true)
    ;;
*)
    exported=$("$nm" -D --defined-only "$shared" | awk '{ print $NF }' | sort -u)
    # Weak ones may be missing; the C library's carry a version.
    foreign=$("$nm" -D --undefined-only "$shared" | awk '$1 == "U" && $2 !~ /@GLIBC_/ { print $2 }')
    needed=$("$objdump" -p "$shared" | awk '$1 == "NEEDED" { print $2 }')
    foreign+=$(grep -v -E '^(libc|libm|ld-linux[^.]*)\.so\.[0-9]+$' <<<"$needed" || true)
    ;;
esac
complain 'exported and declared in no header' "$(comm -13 <(echo "$declared") <(echo "$exported"))"
complain 'declared and not exported' "$(comm -23 <(echo "$declared") <(echo "$exported"))"
complain 'not of the C library' "$foreign"

# mingw-w64 names its indirections after what they lead to.
defined=$("$nm" -g --defined-only "$static" | awk 'NF == 3 { sub(/^\.refptr\./, "", $3); print $3 }')
complain "defined in ${static##*/} without the prefix girih_" "$(grep -v '^girih_' <<<"$defined" || true)"
complain "declared and not in ${static##*/}" "$(comm -23 <(echo "$declared") <(sort -u <<<"$defined"))"
if [[ -z $declared || -z $defined ]]; then
    printf 'no symbols found\n' >&2
    failed=1
fi
exit "$failed"
