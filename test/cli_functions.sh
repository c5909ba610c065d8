# shellcheck shell=bash
# What the tests of the program share, to be sourced with GIRIH ASSETS_FOLDER: a folder to work in,
# and ways to run girih and to look at what it gave. They count in $failures.
girih=$(realpath -- "$1")
# shellcheck disable=SC2034 # for the test that sources this
assets=$(realpath -- "$2")
folder=$(mktemp -d)
trap 'rm -rf -- "$folder"' EXIT
cd -- "$folder" || exit 1
export GIRIH_VALIDATION=1
failures=0

fail() {
    printf 'FAILED: %s\n' "$*"
    failures=$((failures + 1))
}

# expect CODE ARGUMENT...: runs girih; its output lands in out and err. refine may replace what an
# earlier run wrote.
expect() {
    local wanted=$1 code=0
    shift
    if [[ ${1-} == refine ]]; then
        set -- "$@" --overwrite
    fi
    "$girih" "$@" >out 2>err </dev/null || code=$?
    if [[ $code -ne $wanted ]]; then
        fail "girih $*: exit code $code, not $wanted: $(head -c 400 err)"
    fi
}

# One line on standard error that begins with the program's name, nothing on standard output.
expect_one_line() {
    if [[ $(wc -l <err) -ne 1 || -s out || $(<err) != "${girih##*/}"[\ :]* ]]; then
        fail "$*: not one line: $(head -c 400 err)"
    fi
}

# json EXPRESSION: evaluates to true with the printed object as o.
json() {
    python3 -c 'import json, sys
o = json.load(open("out"))
sys.exit(0 if eval(sys.argv[1]) else 1)' "$1" 2>>err || fail "JSON: not so: $1: $(tr -s " \n" " " <out | head -c 200)"
}

same() {
    cmp -s "$1" "$2" || fail "$1 and $2 differ"
}
