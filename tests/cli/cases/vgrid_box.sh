# SPDX-License-Identifier: LGPL-3.0-or-later
# An unmodified VGRID project meshes with the layers that it requests.
[ -d "${VG_DATA_DIR:-}/vgrid_box" ] ||
  skip "VG_DATA_DIR has no vgrid_box: verification/fetch.md has the sources"
for suffix in d3m front mapbc; do
  cp "$VG_DATA_DIR/vgrid_box/box.$suffix" .
done
vanguard mesh -q -p box
exits 0
says out "validity: valid"
says out "layer settings taken from the .d3m (grid = 1): first height 0.001, rates 0.15 and 0.02"
exists box.cogsg box.bc box.b8.ugrid box.wall.vtu
says box.report.json '"wall_by": "meshing class"'
grep -A6 '"first_requested":' box.report.json | grep -q '"min": 0.001' ||
  fail "not the first height of the .d3m"
same box.mapbc "$VG_DATA_DIR/vgrid_box/box.mapbc"
same box.front "$VG_DATA_DIR/vgrid_box/box.front"
vanguard check -q "$VG_DATA_DIR/vgrid_box/box.cogsg"
exits 0
says out "validity: valid"

# VGRID made 51,564 layer cells of 30 levels; the points that it already
# placed on the side walls must not limit the layers.
n=$(sed -n 's/.*"tetrahedra_if_subdivided": \([0-9]*\).*/\1/p' box.report.json)
[ "$n" -gt 50533 ] && [ "$n" -lt 52595 ] ||
  fail "$n layer cells are not within 2 % of VGRID's 51,564"

# The header gives the numbers of points and cells in layers, in VGRID's
# order.
count() { sed -n "s/.*\"$1\": \([0-9]*\).*/\1/p" box.report.json | tail -1; }
nev=$(od -An -tu4 --endian=big -j 24 -N 4 box.cogsg | tr -d ' ')
[ "$nev" = "$(count tetrahedra_if_subdivided)" ] ||
  fail "nev is $nev, not $(count tetrahedra_if_subdivided)"

# The resolved deck no longer needs the .d3m and repeats the run.
vanguard mesh -q -p box --deck box.resolved.deck --out again
exits 0
lacks out "taken from the .d3m"
same box.cogsg again/box.cogsg

# Without layers the mesh is the one made before layers existed.
vanguard mesh -q -p box --layers no --out plain
exits 0
absent plain/box.wall.vtu

# grid 2: the growth law follows the sources; at a source it equals that of
# the source.
mkdir by_source
cp box.front box.mapbc by_source
awk '/\( *grid:/ { sub(/1 \(/, "2 (") }
  /^source_number/ && !n++ { at = NR + 4 }
  NR == at { sub(/^0.001/, "0.002") } { print }' box.d3m >by_source/box.d3m
cmp -s box.d3m by_source/box.d3m && fail "the .d3m was not changed"
vanguard mesh -q -p by_source/box
exits 0
grep -A4 '"first_requested"' by_source/box.report.json >asked
grep -q '"max": 0.002' asked || fail "not the law at the first source"
grep -q '"min": 0.001,' asked || fail "not between the laws of the sources"
vanguard mesh -q -p by_source/box --deck by_source/box.resolved.deck \
  --out source_again
exits 0
same by_source/box.cogsg source_again/box.cogsg
