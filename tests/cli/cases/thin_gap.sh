# SPDX-License-Identifier: LGPL-3.0-or-later
# The gap between two boxes, far narrower than their edges, cut into far more
# subdomains than it holds cells: some regions of the lattice contain no face
# of the front.
needs tetgen
awk '
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
BEGIN { box("hull", 4, 1, -1); box("core", 10, 0.998344, 1) }' >gap.stl
vanguard mesh -p gap.stl -L 7 --split-direction 2 --farfield none \
  --hmax 0.0446684 --quiet --write b8.ugrid --out o
exits 0
vanguard check o/gap.b8.ugrid
exits 0
says out valid

# Edges across the gap: far too many triangles, reported before any is made.
for limit in "" "--max-cells 100000"; do
  # shellcheck disable=SC2086
  vanguard mesh -q -p gap.stl --farfield none --remesh-surface yes \
    --gap-edges 3 $limit --out edges
  exits 1
  says err "gap_edges 3 needs about"
  says err "surface triangles in gaps"
  says err "the narrowest gap is 0.001656 wide, between patches 1 (hull)"
  says err "Reduce gap_edges, increase hmin, or close the gap"
done
says err "the limit is 100000 (max_cells)"
