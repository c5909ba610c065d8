#!/usr/bin/env bash
# The program girih-patterns as its users meet it: exit codes, messages, reports, files.
# Usage: cli_patterns.sh GIRIH_PATTERNS
set -uo pipefail

# shellcheck source=test/cli_functions.sh
. "$(dirname -- "$0")/cli_functions.sh" "$1" .

# change EXPRESSION: writes changed.json, small.json after a statement about the document o and its
# patterns p, by levels.
change() {
    python3 -c 'import json, sys
o = json.load(open("small.json"))
p = {tuple(pattern["levels"]): pattern for pattern in o["patterns"]}
exec(sys.argv[1])
json.dump(o, open("changed.json", "w"))' "$1" || fail "cannot change: $1"
}

# refused EXPRESSION WORDS: import refuses small.json changed so, in one line with these words.
refused() {
    change "$1"
    expect 1 import changed.json -o changed.gpat
    expect_one_line "import after $1"
    grep -qF -- "$2" err || fail "import after $1: not '$2': $(head -c 400 err)"
    [[ ! -e changed.gpat ]] || fail "import after $1: wrote a file"
}

# well_formed FILE: SVG that an XML parser reads.
well_formed() {
    python3 -c 'import sys, xml.etree.ElementTree
root = xml.etree.ElementTree.parse(sys.argv[1]).getroot()
sys.exit(0 if root.tag == "{http://www.w3.org/2000/svg}svg" and len(list(root.iter())) > 20 else 1)' "$1" \
        || fail "$1: no SVG"
}

# readable FILE: a PNG whose rows all unpack and are not all of one colour.
readable() {
    python3 -c 'import struct, sys, zlib
file = open(sys.argv[1], "rb").read()
assert file[:8] == b"\x89PNG\r\n\x1a\n"
at, data = 8, b""
while at < len(file):
    length, kind = struct.unpack(">I4s", file[at:at + 8])
    body = file[at + 8:at + 8 + length]
    assert struct.unpack(">I", file[at + 8 + length:at + 12 + length])[0] == zlib.crc32(kind + body)
    if kind == b"IHDR":
        width, height, depth, colour = struct.unpack(">IIBB", body[:10])
        assert (depth, colour) == (8, 2) and width > 500 and height > 300
    data += body if kind == b"IDAT" else b""
    at += 12 + length
rows = zlib.decompress(data)
assert len(rows) == height * (1 + 3 * width) and len(set(rows)) > 100' "$1" || fail "$1: no PNG"
}

# --- Help and wrong use ---
expect 0 --help
for command in generate import info compare sheet dump check embed emit-permutation; do
    grep -q "^  $command " <("$girih" --help) || fail "--help does not list $command"
    expect 0 "$command" --help
    grep -q 'Examples:' out || fail "girih-patterns $command --help: no examples"
done
expect 2
expect 2 frobnicate
expect_one_line frobnicate
expect 0 generate --spacing linear --max 3 -o small.gpat
for wrong in 'import' 'import small.json' 'import a b -o c' 'info' 'info a b' 'compare' 'compare small.gpat' \
    'compare a b c' 'sheet' 'sheet small.gpat' 'sheet small.gpat -o out.jpeg' 'sheet small.gpat -o out.svg --columns 0' \
    'sheet small.gpat -o out.svg --columns x' 'sheet small.gpat -o out.svg --patterns 1' \
    'sheet small.gpat -o out.svg --patterns 1,1,1;' 'sheet small.gpat -o out.svg --patterns 1,1,x'; do
    # shellcheck disable=SC2086 # several words
    expect 2 $wrong
    expect_one_line "$wrong"
done
[[ ! -e out.svg && ! -e c ]] || fail 'wrong use wrote a file'

# --- Failures: one clear line, exit code 1, no file ---
printf 'not a catalogue' >bad.gpat
: >empty.json
for file in nosuch bad.gpat empty.json .; do
    for command in "info $file" "check $file" "compare $file small.gpat" "compare small.gpat $file" \
        "sheet $file -o out.svg" "import $file -o out.gpat"; do
        # shellcheck disable=SC2086 # several words
        expect 1 $command
        expect_one_line "$command"
    done
done
expect 1 sheet small.gpat -o out.svg --patterns '4,1,1'
expect_one_line 'a pattern that is not there'
expect 1 sheet small.gpat -o out.svg --patterns '1,2,1'
expect 1 sheet small.gpat -o nosuch/out.svg
expect_one_line 'a folder that is not there'
[[ ! -e out.svg && ! -e out.gpat ]] || fail 'a failure wrote a file'

# --- import: what is dumped comes back, what is wrong is refused ---
expect 0 dump small.gpat --json
cp out small.json
json 'o["family"] == "optimal" and o["denominator"] == 32768'
json 'all(len(p["parents"]) == len(p["vertices"]) and p["parents"][:3] == p["vertices"][:3] for p in o["patterns"])'
expect 0 import small.json -o again.gpat
same again.gpat small.gpat
# Parents are found anew.
change 'for pattern in o["patterns"]: pattern["parents"] = "no"'
expect 0 import changed.json -o again.gpat
same again.gpat small.gpat
change 'o["patterns"].reverse(); o["family"] = "reversed"'
expect 0 import changed.json -o reversed.gpat
expect 0 check reversed.gpat
expect 0 info reversed.gpat --json
json 'o["family"] == "reversed" and o["base_patterns"] == 10'
change 'del o["family"]'
expect 0 import changed.json -o unnamed.gpat
expect 0 info unnamed.gpat --json
json 'o["family"] == "imported"'
change 'o["denominator"] *= 6
for pattern in o["patterns"]: pattern["vertices"] = [[6 * w for w in v] for v in pattern["vertices"]]'
expect 0 import changed.json -o again.gpat
same again.gpat small.gpat
refused 'o["patterns"].remove(p[3, 2, 1]); o["patterns"].remove(p[3, 3, 2])' 'missing: [3,2,1] [3,3,2]'
refused 'o["patterns"].append(p[3, 2, 2])' 'more than once: [3,2,2]'
refused 'p[3, 2, 1]["vertices"][3] = [20000, 12768, 0]' '[3,2,1]: its border has no vertex'
refused 'p[3, 2, 1]["triangles"][1].reverse()' 'turned over'
refused 'p[3, 2, 1]["triangles"].pop()' '3, 2, 1 segments'
refused 'o["denominator"] = 32767' 'does not add up to the denominator'
refused 'o["denominator"] = "half"' '"denominator" is not'
refused 'p[2, 1, 1]["vertices"] = [[u / 2, v, w] for u, v, w in p[2, 1, 1]["vertices"]]' 'three whole numbers'
refused 'o["max"] = 4' 'missing: [4,1,1]'
refused 'o["spacing"] = "quadratic"' '"spacing" is neither'
refused 'o["family"] = "a name that is too long"' '"family" is not'
head -c 500 small.json >cut.json
expect 1 import cut.json -o out.gpat
expect_one_line 'JSON cut off'
grep -q 'line [0-9]*: no JSON' err || fail "JSON cut off: $(head -c 400 err)"

# --- info ---
expect 0 generate --spacing dyadic --max 3 -o dyadic.gpat
expect 0 info dyadic.gpat
grep -q '^mean min angle  *[0-9.]* degrees' out || fail 'info: no mean angle'
lines=$(wc -l <out)
expect 0 info dyadic.gpat --verbose
[[ $(wc -l <out) -eq $((lines + 2 + 20)) ]] || fail 'info --verbose: not a row for every pattern'
expect 0 info dyadic.gpat --json
json 'list(o)[:11] == ["spacing", "max", "family", "base_patterns", "adaptive_patterns", "vertices", "triangles",
                       "bytes", "mean_min_angle", "worst_min_angle", "worst_pattern"]'
json 'sum(o["min_angle_histogram"]) == o["base_patterns"] == len(o["patterns"]) == 20'
json 'o["mean_min_angle"] <= o["mean_min_angle_bound"] and o["worst_min_angle"] <= o["worst_min_angle_bound"]'
json 'sum(p["triangles"] for p in o["patterns"]) == o["triangles"]'
json 'abs(sum(p["min_angle"] for p in o["patterns"]) / 20 - o["mean_min_angle"]) < 1e-6'
json 'o["shapes"]["equilateral"]["mean_min_angle"] == o["mean_min_angle"]'
json 'all(o["shapes"][s]["mean_min_angle"] < o["mean_min_angle"] for s in ("right", "thin", "obtuse"))'
json 'o["patterns"][0]["shortest_spacing"] is None and o["shortest_spacing"] > 0'
json '0 < o["worst_area_ratio"] <= o["mean_area_ratio"] <= 1 and 0.4 < o["cache_misses_per_triangle"] < 3'
json 'o["parents"]["bytes"] == 4 * o["vertices"] and o["parents"]["uneven_patterns"] == 0'
json '0 < o["parents"]["farthest"] < 1 and len(o["parents"]["farthest_pattern"]) == 3'
# Every edge of two segments has a middle that stays.
json 'o["parents"]["staying_middles"] == sum(p["levels"].count(1) for p in o["patterns"])'

# --- compare ---
expect 0 compare small.gpat reversed.gpat --json
json 'o["a"]["family"] == "optimal" and o["b"]["family"] == "reversed" and o["common"]["base_patterns"] == 10'
json 'o["common"]["a"] == o["common"]["b"] and o["largest_differences"] == []'
json 'o["common"]["a"]["larger_min_angle"] == o["common"]["b"]["fewer_triangles"] == 0'
# 1, 2, 4 and 8 segments against 1, 2 and 3: the patterns of 1 and 2.
expect 0 compare small.gpat dyadic.gpat --json
json 'o["common"]["base_patterns"] == 4 and o["a"]["spacing"] == "linear" and o["b"]["spacing"] == "dyadic"'
# A vertex more in the middle of the whole.
change 'p[1, 1, 1]["vertices"].append([8192, 8192, 16384])
p[1, 1, 1]["triangles"] = [[0, 1, 3], [1, 2, 3], [2, 0, 3]]
o["family"] = "other"'
expect 0 import changed.json -o other.gpat
expect 0 compare small.gpat other.gpat --json
json 'o["common"]["a"]["larger_min_angle"] == o["common"]["a"]["fewer_triangles"] == 1'
json 'o["common"]["b"]["larger_min_angle"] == o["common"]["b"]["fewer_vertices"] == 0'
json 'len(o["largest_differences"]) == 1 and o["largest_differences"][0]["segments"] == [1, 1, 1]'
json 'o["largest_differences"][0]["triangles"] == [1, 3]'
expect 0 compare small.gpat other.gpat
grep -q '^\[1,1,1\]' out || fail 'compare: the difference is missing'

# --- sheet ---
expect 0 sheet small.gpat -o small.svg
[[ ! -s out && ! -s err ]] || fail 'sheet: something printed'
well_formed small.svg
expect 0 sheet small.gpat -o small.png
readable small.png
expect 0 sheet small.gpat -o again.png
same small.png again.png
expect 0 sheet dyadic.gpat -o some.svg --patterns '3,1,0;0,0,0;3,1,0' --columns 2
well_formed some.svg
expect 0 sheet other.gpat -o column.png --columns 1
readable column.png
expect 0 sheet small.gpat -o wide.png --columns 999999999
same wide.png <("$girih" sheet small.gpat -o wider.png --columns 10; cat wider.png)

# --- generate --seed ---
expect 0 generate --spacing linear --max 7 --seed 0 -o seed0.gpat
expect 0 generate --spacing linear --max 7 -o default.gpat
same seed0.gpat default.gpat
expect 0 generate --spacing linear --max 7 --seed 1 -o seed1.gpat
cmp -s seed0.gpat seed1.gpat && fail 'generate: another seed gives the same patterns'
expect 0 check seed1.gpat
expect 2 generate --spacing linear --max 7 --family uniform --seed 1 -o none.gpat
expect_one_line 'generate: a seed for uniform'

if [[ $failures -ne 0 ]]; then
    printf '%d failures\n' "$failures"
    exit 1
fi
echo 'all as it should be'
