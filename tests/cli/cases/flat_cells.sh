# SPDX-License-Identifier: LGPL-3.0-or-later
# Causes of flat cells, in all reports: two boxes with layers that nearly fill
# the gap between them, cut into subdomains.
needs tetgen
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 \
  OMPI_MCA_rmaps_base_oversubscribe=1 \
  OMPI_MCA_hwloc_base_binding_policy=none \
  PRTE_MCA_rmaps_default_mapping_policy=:oversubscribe \
  PRTE_MCA_hwloc_default_binding_policy=none
cat >boxes.awk <<'END'
function corner(axis, side, u, v, half,  w) {
  w[axis] = side * half
  w[(axis + 1) % 3] = u * half
  w[(axis + 2) % 3] = v * half
  return sprintf("vertex %.17g %.17g %.17g\n", w[0], w[1], w[2])
}
function facet(a, b, c) {
  print "facet normal 0 0 0\nouter loop\n" a b c "endloop\nendfacet"
}
# n by n quadrilaterals a side; normals along `out`.
function box(name, n, half, out,  k, s, i, j, d, a, b, c, e) {
  print "solid " name
  d = 2 / n
  for (k = 0; k < 3; k++)
    for (s = -1; s <= 1; s += 2)
      for (i = 0; i < n; i++)
        for (j = 0; j < n; j++) {
          a = corner(k, s, -1 + i * d, -1 + j * d, half)
          b = corner(k, s, -1 + (i + 1) * d, -1 + j * d, half)
          c = corner(k, s, -1 + (i + 1) * d, -1 + (j + 1) * d, half)
          e = corner(k, s, -1 + i * d, -1 + (j + 1) * d, half)
          if (s * out > 0) { facet(a, b, c); facet(a, c, e) }
          else { facet(a, c, b); facet(a, e, c) }
        }
  print "endsolid " name
}
BEGIN { box("hull", 4, 1, -1); box("core", 10, half, 1) }
END
awk -v half=0.98 -f boxes.awk >gap.stl
run="-q -p gap.stl --farfield none --first 0.002 --write b8.ugrid"

# flat FOLDER: the causes of flat cells in the report.
flat() { sed -n '/"flat_cells": {/,/^    }/p' "$1/gap.report.json"; }

# shellcheck disable=SC2086 # lists of options
{
# Opposite layers.
vanguard mesh $run --walls 1,2 --leaf-cells 500 -t 1 --out one
exits 0
says out "cells with an angle below 5 degrees by the kinds of their points: "
says out "    four tops of several patches "
flat one >one.flat
says one.flat '"limit": 5.0'
says one.flat '"on_needles": 0'
grep -A3 '"tops_of_several_patches": {' one.flat |
  grep -q '"spanning": [1-9]' || fail "no cell spans the gap"
grep -A3 '"tops_of_one_patch": {' one.flat |
  grep -q '"cells": 0' || fail "tops of one patch"
says one.flat '"kind": "top"'
says one.flat '"name": "hull"'
says one.flat '"name": "core"'
says one/gap.report.html "<th scope=\"row\">four tops of several patches</th>"
says one/gap.report.html " top 1 hull, "
[ "$(grep -c '"flat_cells"' one/gap.report.json)" = 1 ] ||
  fail "the layers are not excluded"

# The same for any number of threads and ranks.
vanguard mesh $run --walls 1,2 --leaf-cells 500 -t 3 --out threads
exits 0
flat threads >threads.flat
same one.flat threads.flat
if mpirun -n 2 true >/dev/null 2>&1; then
  ASAN_OPTIONS=$ASAN_OPTIONS:detect_leaks=0 mpirun -n 3 "$program" mesh $run --walls 1,2 \
    --leaf-cells 500 -t 1 --out ranks >out 2>err
  status=$?
  exits 0
  flat ranks >ranks.flat
  same one.flat ranks.flat
else
  echo "no mpirun that starts here: threads only"
fi

# Layers on one side only.
vanguard mesh $run --walls 2 --out side
exits 0
says out "    tops and other surface points "

# Without layers, all cells are examined.
vanguard mesh $run --layers no --out plain
exits 0
flat plain >plain.flat
grep -A3 '"surface": {' plain.flat | grep -q '"cells": [1-9]' ||
  fail "no cell between the surfaces"
says plain.flat '"kind": "surface"'
lacks plain.flat '"kind": "top"'

# No flat cell: nothing in the text.
vanguard demo box --cells 2000 --out p
vanguard mesh -q -p p/box --walls 5 --first 1e-3 --out fine
exits 0
lacks out "by the kinds of their points"
grep -A1 '"flat_cells": {' fine/box.report.json >/dev/null || fail "no causes"
}
