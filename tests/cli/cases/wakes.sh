# SPDX-License-Identifier: LGPL-3.0-or-later
# Wakes: the trailing edges of a wing are found, cells across the wake are
# reported, and the files do not depend on ranks and threads.
vanguard demo wing-sharp --cells 60000 --out w
exits 0
vanguard mesh -q -p w/wing-sharp --layers no --out plain
exits 0
lacks out "Wakes"
lacks plain/wing-sharp.report.json '"wakes"'
vanguard mesh -q -p w/wing-sharp --layers no --wakes auto --out one
exits 0
says out "note: wake 1 (patch *): trailing edges of 5."
says one/wing-sharp.report.json '"wakes": ['
says one/wing-sharp.report.json '"chords": 2.0'
says one/wing-sharp.report.html 'id="wakes"'
python3 - one/wing-sharp.report.json <<'PY' || fail "cells across the wake"
import json, sys
wakes = json.load(open(sys.argv[1]))["wakes"]
for at in wakes[0]["cells_across"]:
    assert at["lines"] == at["lines_measured"] > 0, at
    assert abs(at["requested"] - 5) < 1e-9, at
    assert 0.85 * 5 < at["reached_mean"] < 1.4 * 5, at
PY
vanguard mesh -q -p w/wing-sharp --layers no --wakes auto --out two \
  --threads 2
exits 0
cmp one/wing-sharp.b8.ugrid two/wing-sharp.b8.ugrid ||
  fail "the mesh depends on threads"

# The resolved deck has sources and leads to the same mesh.
grep -qx wakes one/wing-sharp.resolved.deck &&
  fail "the resolved deck has a table of wakes"
vanguard mesh -q -p w/wing-sharp --out again \
  --deck one/wing-sharp.resolved.deck
exits 0
cmp one/wing-sharp.b8.ugrid again/wing-sharp.b8.ugrid ||
  fail "the resolved deck makes another mesh"

# Stretched along the stream: the same cells across, and fewer in all.
sed '/^wakes$/,$d' w/wing-sharp.deck >w/t.deck
printf 'wakes\npatch  stretch\n*      4\n' >>w/t.deck
vanguard mesh -q -p w/wing-sharp --layers no --deck w/t.deck --out long
exits 0
says long/wing-sharp.report.json '"valid": true'
python3 - one long <<'PY' || fail "cells across the stretched wake"
import json, sys
one, long = (json.load(open(f"{f}/wing-sharp.report.json")) for f in sys.argv[1:])
assert long["mesh"]["cells"] < 0.7 * one["mesh"]["cells"], long["mesh"]["cells"]
for at in long["wakes"][0]["cells_across"]:
    assert at["stretch_requested"] == 4, at
    assert 3.4 < at["stretch_reached"] < 4.6, at
    assert at["lines"] == at["lines_measured"] > 0, at
    assert 0.85 * 5 < at["reached_mean"] < 1.4 * 5, at
PY
vanguard mesh -q -p w/wing-sharp --layers no --deck w/t.deck --threads 2 \
  --out long2
exits 0
cmp long/wing-sharp.b8.ugrid long2/wing-sharp.b8.ugrid ||
  fail "the stretched mesh depends on threads"

# A table: two angles of attack, and a larger scale has fewer cells across.
table() { # COLUMNS VALUES
  sed '/^wakes$/,$d' w/wing-sharp.deck >w/t.deck
  printf 'wakes\n%s\n%s\n' "$1" "$2" >>w/t.deck
}
table "patch  alpha  length" "wing   0,10   1"
vanguard plan -q -p w/wing-sharp -n 1 --deck w/t.deck
exits 0
says out "and 2 directions of the stream"

refuses() { # COLUMNS VALUES MESSAGE
  table "$1" "$2"
  vanguard plan -q -p w/wing-sharp -n 1 --deck w/t.deck
  exits 1
  says err "$3"
}
refuses "patch" "wings" "is named 'wings'; did you mean 'wing'"
refuses "patch" "farfield" "patch farfield has no trailing edge"
refuses "patch  length" "*  0" "length"
refuses "patch  size" "*  0.5" "exceeds the height of the wake"
refuses "patch  length" "*  0.01" "exceeds the length of the wake"
refuses "patch  stretch" "*  0.5" "stretch"
refuses "patch  alpha" "*  0,x" "is not a list of 1 to 16 angles"
refuses "patch  alpha" "*  61" "is not a list of 1 to 16 angles"
refuses "patch  stream  up" "*  -x  x" "name the same axis, x"

# Edges at the trailing edge of a remeshed surface: 2 % of the local chord, which
# is 1 at the root and 0.4 at the tip, 2.5 from it. The edge is at x = 1 + 0.26 y.
sed '/^wakes$/,$d; /^sources$/,$d' w/wing-sharp.deck >w/s.deck
printf 'surface\npatch  trail\nwing   0.02\n' >>w/s.deck
vanguard mesh -q -p w/wing-sharp --deck w/s.deck --layers no \
  --remesh-surface yes --write ugrid --out trail
exits 0
python3 - trail/wing-sharp.ugrid <<'PY' || fail "edges at the trailing edge"
import sys
words = open(sys.argv[1]).read().split()
n = int(words[0])
x = [tuple(map(float, words[7 + 3 * i:10 + 3 * i])) for i in range(n)]
edge = sorted(p[1] for p in x
              if abs(p[0] - 1 - 0.26 * abs(p[1])) < 1e-6 and abs(p[2]) < 1e-6)
steps = [(b - a) / (1 - 0.24 * abs(a + b) / 2) for a, b in zip(edge, edge[1:])]
assert len(steps) > 50, len(steps)
assert 0.012 < sum(steps) / len(steps) < 0.022, sum(steps) / len(steps)
assert max(steps) < 0.032, max(steps)
PY
sed -i 's/^wing   0.02/farfield 0.02/' w/s.deck
vanguard mesh -q -p w/wing-sharp --deck w/s.deck --layers no \
  --remesh-surface yes --out trail
exits 1
says err "patch farfield has no trailing edge for the stream along x"

# Inner surfaces attached to the trailing edge of a wing, which has the span 2 and
# a sweep of 0.5, do not hide it.
python3 - >attached.stl <<'PY'
n, spans = 4, 4
def wing(i, j, side):
    t = 0.06 * (1 - abs(2 * i / n - 1))
    return i / n + j / spans, 2 * j / spans, side * t
def wake(i, j):
    return 1 + i / n + j / spans, 2 * j / spans, 0.1 * (i / n) ** 2
def quad(a, b, c, d):
    return [t for t in ((a, b, c), (a, c, d)) if len(set(t)) == 3]
body, sheet = [], []
for j in range(spans):
    for i in range(n):
        for side in 1, -1:
            q = quad(wing(i, j, side), wing(i + 1, j, side),
                     wing(i + 1, j + 1, side), wing(i, j + 1, side))
            body += [t[::side] for t in q]
        sheet += quad(wake(i, j), wake(i + 1, j), wake(i + 1, j + 1),
                      wake(i, j + 1))
for i in range(n):
    body += quad(wing(i, spans, 1), wing(i + 1, spans, 1),
                 wing(i + 1, spans, -1), wing(i, spans, -1))
for name, faces in ("wing", body), ("wake", sheet):
    print("solid", name)
    for t in faces:
        print("facet normal 0 0 0\nouter loop")
        for x in t:
            print("vertex", *x)
        print("endloop\nendfacet")
    print("endsolid", name)
PY
for role in sheets baffles; do
  vanguard mesh -q -p attached.stl --$role wake --wakes auto --layers no \
    --farfield-lengths 2 --out attached_$role
  exits 0
  says out "trailing edges of 2.236 in total, with chords of 1 to 1,"
  says attached_$role/attached.report.json '"valid": true'
done

# Cells across the wake of a section, with triangles and with quadrilaterals in
# its layers.
vanguard demo aerofoil --out a
for cells in tets mixed; do
  vanguard mesh -q -p a/aerofoil --wakes auto --cells $cells --out a/$cells
  exits 0
  python3 - a/$cells/aerofoil.report.json <<'PY' || fail "cells in the section"
import json, sys
for at in json.load(open(sys.argv[1]))["wakes"][0]["cells_across"]:
    assert at["lines"] == at["lines_measured"] == 1, at
    assert 0.85 * 5 < at["reached_mean"] < 1.4 * 5, at
PY
done

# A wake that is far too fine is refused before the surface is remeshed, as are
# sizes of the surface.
printf 'fine\n\nwakes\npatch  size\n*      0.0005\n' >w/fine.deck
vanguard mesh -q -p w/wing-sharp --deck w/fine.deck --remesh-surface yes \
  --max-cells 20000000 --out w/fine
exits 1
says err "the wakes request at least"
says err "but only 20000000 are allowed (max_cells)"
[ ! -e w/fine ] || fail "files of a refused wake"
vanguard surface -q w/wing-sharp.lb8.ugrid --surface-size 0.001 \
  --max-cells 1000000 --out w/fine
exits 1
says err "triangles, more than the 1000000 cells that are allowed (max_cells)"

# A ball has none.
vanguard demo sphere --cells 20000 --out s
exits 0
vanguard mesh -q -p s/sphere --wakes auto --out s
exits 1
says err "has no trailing edge (the surface has 0 such edges of triangles in all)"
