# SPDX-License-Identifier: LGPL-3.0-or-later
# Wakes of kind sheet: inner surfaces along the stream from trailing edges.
needs tetgen

row() { printf 'wake\n\nwakes\npatch  kind   length  alpha\n%s\n' "$1"; }

vanguard demo wing-sharp --cells 40000 --out w
exits 0
row '*  sheet  1  3' >w/sheet.deck
layers="--walls 1,wake1 --y-plus 30 --reynolds 5e6 --reference-length 1"
for threads in 1 3; do
  vanguard mesh -q -p w/wing-sharp --deck w/sheet.deck $layers --cells mixed \
    --write b8.ugrid --threads $threads --out w/$threads
  exits 0
  says out "patch 4 (wake1)"
  says out "sheet with layers"
done
cmp w/1/wing-sharp.b8.ugrid w/3/wing-sharp.b8.ugrid ||
  fail "the sheet depends on threads"
vanguard check w/1/wing-sharp.b8.ugrid
exits 0
python3 - w/1/wing-sharp.report.json <<'PY' || fail "layers on the sheet"
import json, sys
report = json.load(open(sys.argv[1]))
assert report["mesh"]["valid"] and report["wakes"][0]["kind"] == "sheet"
full = [p for p in report["layers"]["patches"] if p["name"].startswith("wake1")]
assert len(full) == 2 and min(p["percent_full"] for p in full) > 75, full
PY

# The resolved deck, whose tables name the sheet, leads to the same mesh.
vanguard mesh -q -p w/wing-sharp --deck w/1/wing-sharp.resolved.deck --out w/again
exits 0
cmp w/1/wing-sharp.b8.ugrid w/again/wing-sharp.b8.ugrid ||
  fail "the resolved deck makes another mesh"

# A blunt trailing edge: one sheet, from the upper rim.
vanguard demo wing --cells 40000 --out b
vanguard mesh -q -p b/wing --deck w/sheet.deck --layers no --write b8.ugrid --out b/1
exits 0
vanguard check b/1/wing.b8.ugrid
exits 0

# Next to refined wakes; the lines of the table keep their numbers.
{ row '*  sheet    0.5  0' && echo '*  sources  0.5  0'; } >w/both.deck
vanguard mesh -q -p w/wing-sharp --deck w/both.deck --layers no --out w/both
exits 0
says out "wake 1 (patch *): a sheet of"
says out "wake 2 (patch *): trailing edges of"

# What a sheet cannot follow.
row '*  sheet  1  0,3' >w/two.deck
vanguard mesh -q -p w/wing-sharp --deck w/two.deck --out w/no
exits 1
says err "a sheet follows one stream; give one angle in alpha and in beta"
{ row '1  sheet  1  3' && echo '*  sheet  2  3'; } >w/same.deck
vanguard mesh -q -p w/wing-sharp --deck w/same.deck --out w/no
exits 1
says err "lines 1 and 2 make a sheet from the same trailing edge"
row 'tip  sheet  1  0' >w/tip.deck
vanguard mesh -q -p w/wing-sharp --deck w/tip.deck --out w/no
exits 1
says err "has no trailing edge"
vanguard demo aerofoil --out a
vanguard mesh -q -p a/aerofoil --deck w/sheet.deck --out w/no
exits 1
says err "a section has no sheets; give kind sources"
[ ! -e w/no ] || fail "files of a refused run"
