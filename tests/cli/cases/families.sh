# SPDX-License-Identifier: LGPL-3.0-or-later
# Families with the laws of a workshop: two levels are meshed, one is planned,
# and the tables have the figures that the workshop asks for.
vanguard demo wing-sharp --cells 20000 --out w
exits 0
vanguard sweep -q -p w/wing-sharp --family hlpw:A-C --planned C --out fam -- \
  --write b8.ugrid
exits 0
says out "hlpwA"
says out "hlpwC*"
says out "* planned, not meshed"
[ -s fam/hlpwA-n1-t1/wing-sharp.b8.ugrid ] || fail "no mesh of level A"
[ -s fam/hlpwC-n1-t1/plan.json ] || fail "no forecast of level C"
grep -q "Grid metrics" fam/metrics.html || fail "no page"
python3 - fam/metrics.csv <<'PY' || fail "metrics.csv"
import csv, math, sys
a, b, c = csv.DictReader(open(sys.argv[1]))
assert [r["level"] for r in (a, b, c)] == ["hlpwA", "hlpwB", "hlpwC"]
assert [r["state"] for r in (a, b, c)] == ["meshed", "meshed", "planned"]
for row, y, g in ((a, 2.25, 1.25), (b, 1.5, 1.16)):
    assert abs(float(row["y_plus"]) - y) < 1e-6 * y, row
    assert float(row["growth_max"]) <= g + 1e-6, row
    assert float(row["nodes"]) > float(row["boundary_nodes"]) > 0
    kinds = ("tetrahedra", "pyramids", "prisms", "hexahedra")
    assert sum(float(row[k]) for k in kinds) == float(row["cells"])
    assert float(row["percent_full_layers"]) > 99
share = float(a["layer_cells"]) / float(a["cells"])
more = math.log(1.25) / math.log(1.16)
ratio = 2.25 * (share * more + (1 - share) * 1.5)
assert 0.5 < share < 1
assert a["lead"] == a["trail"] == "" # the deck requests no spacing
assert abs(float(b["cells_ratio_requested"]) - ratio) < 1e-6 * ratio
assert float(b["cells"]) > float(a["cells"])
assert float(c["cells"]) > float(b["cells"]) and c["boundary_nodes"] == ""
assert float(c["y_plus_requested"]) == 1
PY

refuses() { # MESSAGE OPTION...
  local message=$1
  shift
  vanguard sweep -q -p w/wing-sharp --out no "$@"
  exits 2
  says err "$message"
}
refuses "its levels are 1 to 6" --family dpw:7
refuses "its levels are A to F" --family hlpw:1
refuses "its levels are A to F" --family hlpw:C-A
refuses "its levels are A to F" --family hlpw:
refuses "'gmgw:1' is no family" --family gmgw:1
vanguard sweep -q -p w/wing-sharp --out no --family dpw:1,3 --planned 2
exits 1
says err "level 2 is not in --family"
vanguard sweep -q -p w/wing-sharp --out no --family 1:2 --planned 2
exits 1
says err "needs a family with the laws of a workshop"
sed 's/ *5000000 / 0 /; s/0\.7 *$/0/; s/^\(4 *\)1 /\10 /' w/wing-sharp.deck >w/n.deck
vanguard sweep -q -p w/wing-sharp --deck w/n.deck --out no --family dpw:1
exits 1
says err "need reynolds and reference_length"

# Edges across a blunt trailing edge at the levels of hlpw: 4, 6, 9, 12, 18 and
# 27, counted at both ends of a section with one.
{
  for y in 0 0.04; do
    echo "v 0 $y 0"; echo "v 0.1 $y 0.03"; echo "v 0.3 $y 0.005"
    echo "v 0.3 $y -0.005"; echo "v 0.1 $y -0.03"
  done
  echo "g sides"
  for k in 1 2 4 5; do
    n=$((k % 5 + 1))
    echo "f $k $((k + 5)) $((n + 5))"; echo "f $k $((n + 5)) $n"
  done
  echo "g ends"
  for k in 2 3 4; do
    echo "f 1 $k $((k + 1))"; echo "f 6 $((k + 6)) $((k + 5))"
  done
  echo "g base"; echo "f 3 8 9"; echo "f 3 9 4"
} >wedge.obj
cat >wedge.deck <<'DECK'
Edges across a base
remesh_surface  surface_size
yes             0.05

surface
patch  across
base   4
DECK
for level in 1:4 2/3:6 4/9:9 1/3:12 2/9:18 4/27:27; do
  scale=$(awk "BEGIN { printf \"%.17g\", ${level%:*} }")
  rm -rf edge
  vanguard surface -q wedge.obj --deck wedge.deck --scale "$scale" --out edge \
    --farfield none --write lb8.ugrid
  exits 0
  python3 - edge/wedge.lb8.ugrid "${level#*:}" <<'PY' || fail "level $level"
import struct, sys
data = open(sys.argv[1], "rb").read()
ends = [0, 0]
for i in range(struct.unpack_from("<i", data)[0]):
    x, y, z = struct.unpack_from("<3d", data, 28 + 24 * i)
    if abs(x - 0.3) < 1e-9 and min(y, 0.04 - y) < 1e-9:
        ends[y > 0.02] += 1
n = int(sys.argv[2])
for end in ends:
    assert abs(end - 1 - n) <= max(1, n // 8), (end - 1, n)
PY
done

# Edge lengths at leading and trailing edges, requested and reached.
cat >spacing.deck <<'DECK'
Leading and trailing edges
remesh_surface  surface_size
yes             0.05

surface
patch  lead  trail
sides  0.02  0.01
DECK
sed 's/ 0\.04 / 0.4 /' wedge.obj >long.obj
vanguard surface -q long.obj --deck spacing.deck --flow external --out spaced
exits 0
says out "edge length at leading edges, % of the local chord: requested 2, reached"
jq -e '.remesh | .leading_edges, .trailing_edges |
  .reached_percent / .requested_percent | . > 0.8 and . < 1.15' \
  spaced/long.surface.json >ratios || fail "spacing: $(cat ratios)"
! grep -q false ratios || fail "spacing: $(cat ratios)"

# Edge lengths along the span at root and tip, in semispans.
sed 's/lead  trail/root  tip/' spacing.deck >span.deck
vanguard surface -q long.obj --deck span.deck --flow external --out span
exits 0
says out "edge length along the span at tips, % of the semispan: requested 1, reached"
jq -e '.remesh | .roots, .tips |
  .reached_percent / .requested_percent | . > 0.7 and . < 1.15' \
  span/long.surface.json >ratios || fail "span: $(cat ratios)"
! grep -q false ratios || fail "span: $(cat ratios)"

# Two rows with different requests at one place: each is reported by itself.
cat >rows.deck <<'DECK'
two rows

remesh_surface
yes

surface
patch  root  tip
sides  0.02  0
sides  0.01  0.02
DECK
vanguard surface -q long.obj --deck rows.deck --flow external --out rows
exits 0
says out "at roots, % of the semispan, row 1 of \`surface\`: requested 2, reached"
says out "at roots, % of the semispan, row 2 of \`surface\`: requested 1, reached"
says out "at tips, % of the semispan: requested 2, reached"
jq -e '.remesh.roots.rows | map(.row) == [1, 2]' rows/long.surface.json \
  >ratios || fail "rows: $(cat ratios)"
