# SPDX-License-Identifier: LGPL-3.0-or-later
# Layers of walls that end in the plane of a slip patch: a flat plate with slip
# upstream, on the floor of a box.
quad() {
  local corner
  for corner in "$1 $2 $3" "$1 $3 $4"; do
    echo " facet normal 0 0 0"; echo "  outer loop"
    for corner in $corner; do echo "   vertex ${corner//,/ }"; done
    echo "  endloop"; echo " endfacet"
  done
}
{
  echo "solid slip"; quad 0,0,0 1,0,0 1,1,0 0,1,0
  echo "endsolid slip"; echo "solid plate"; quad 1,0,0 2,0,0 2,1,0 1,1,0
  echo "endsolid plate"; echo "solid side"
  quad 0,0,1 0,1,1 1,1,1 1,0,1; quad 1,0,1 1,1,1 2,1,1 2,0,1
  echo "endsolid side"; echo "solid left"
  quad 0,0,0 0,0,1 1,0,1 1,0,0; quad 1,0,0 1,0,1 2,0,1 2,0,0
  echo "endsolid left"; echo "solid right"
  quad 0,1,0 1,1,0 1,1,1 0,1,1; quad 1,1,0 2,1,0 2,1,1 1,1,1
  echo "endsolid right"; echo "solid inlet"; quad 0,0,0 0,1,0 0,1,1 0,0,1
  echo "endsolid inlet"; echo "solid outlet"; quad 2,0,0 2,0,1 2,1,1 2,1,0
  echo "endsolid outlet"
} >box.stl

vanguard mesh -q -p box --flow internal --walls plate --first 1e-3 \
  --remesh-surface yes --surface-size 0.15
exits 0
says out "the layers of patch 2 plate continue over patch 1 slip"
says box.report.json '"wall_by": "extended"'
says box.report.json '"visibility": 0'
[ "$(grep -c '"percent_full": 100.0' box.report.json)" = 3 ] ||
  fail "the layers are not complete"
# The condition of the slip patch stays.
says out "1 patch with layers but without a boundary condition"
# The resolved deck repeats the run.
vanguard mesh -q -p box --deck box.resolved.deck --out again
exits 0
cmp -s box.b8.ugrid again/box.b8.ugrid || fail "the resolved deck differs"

# Without layers on the slip patch, its edge limits them.
printf 'slip without layers\n\nlayers\nid grow\nslip no\n' >no.deck
vanguard mesh -q -p box --deck no.deck --flow internal --walls plate \
  --first 1e-3 --remesh-surface yes --surface-size 0.15 --out no
exits 0
lacks out "continue over"
[ "$(grep -c '"visibility": 0' no/box.report.json)" = \
  "$(grep -c '"visibility": ' no/box.report.json)" ] ||
  fail "a column has the cause visibility"
[ "$(grep -c '"slide": 0' no/box.report.json)" -lt \
  "$(grep -c '"slide": ' no/box.report.json)" ] ||
  fail "no column has the cause slide"
