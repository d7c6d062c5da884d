# SPDX-License-Identifier: LGPL-3.0-or-later
# Boxes with sheets and their meshes, for the cases of inner surfaces.

# duct NAME SHEET...: a closed box from 0 to 1 of 8 x 8 quadrilaterals a side,
# patches 1 to 6, and sheets "ID N M  ox oy oz  ux uy uz  vx vy vz" of N x M,
# as NAME.stl with a solid for each patch.
duct() {
  local name=$1
  shift
  { printf '%s\n' "w1 8 8  0 0 0  0 1 0  1 0 0" "w2 8 8  0 0 1  1 0 0  0 1 0" \
      "w3 8 8  0 0 0  1 0 0  0 0 1" "w4 8 8  0 1 0  0 0 1  1 0 0" \
      "w5 8 8  0 0 0  0 0 1  0 1 0" "w6 8 8  1 0 0  0 1 0  0 0 1" "$@"; } |
    awk 'function at(i, j, k) {
        return sprintf("%.17g", $(4 + k) + $(7 + k) * i / $2 + $(10 + k) * j / $3)
      }
      function corner(i, j) {
        print "vertex", at(i, j, 0), at(i, j, 1), at(i, j, 2)
      }
      function facet(a, b, c, d, e, f) {
        print "facet normal 0 0 0\nouter loop"
        corner(a, b); corner(c, d); corner(e, f)
        print "endloop\nendfacet"
      }
      { print "solid " $1
        for (j = 0; j < $3; j++) for (i = 0; i < $2; i++) {
          facet(i, j, i + 1, j, i + 1, j + 1)
          facet(i, j, i + 1, j + 1, i, j + 1)
        }
        print "endsolid " $1 }' >"$name.stl"
}

# valid NAME OPTION...: meshes NAME.stl with the options.
valid() {
  local name=$1
  shift
  vanguard mesh "$name.stl" --flow internal --quiet --write b8.ugrid \
    --out "o_$name" --hmax 0.12 "$@"
  exits 0
  vanguard check "o_$name/$name.b8.ugrid"
  exits 0
  says out "valid"
}

# full FILE PATCH: share of its faces with all layers, in percent.
full() { awk -v patch="$2" '$2 == patch && NF > 6 { print $4; exit }' "$1"; }
