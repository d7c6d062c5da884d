# SPDX-License-Identifier: LGPL-3.0-or-later
# Searches that once grew without end: a surface with a far point, a plate of
# nearly no thickness, coordinates beyond the range of numbers.

# far_octahedron X: one corner at X, and one triangle too many.
far_octahedron() {
  octahedron | sed "s/^v 1 0 0/v $1 0 0/"
  echo "f 1 3 2"
}
for far in 100 1e4 1e8; do
  far_octahedron $far >far.obj
  vanguard check -q far.obj
  exits 1
  if ! vanguard --version --verbose || grep -q "vanguard-wrap not found" out; then
    continue
  fi
  vanguard check -q far.obj
  says err "point 1 ($(printf %g $far), 0, 0) of triangle 1 is far away"
done

# plate THICKNESS
plate() {
  for z in 0 "$1"; do
    printf "v %s $z\n" "0 0" "1 0" "1 1" "0 1"
  done
  echo "g plate"
  printf 'f %s\n' "1 3 2" "1 4 3" "5 6 7" "5 7 8" "1 2 6" "1 6 5" "2 3 7" \
    "2 7 6" "3 4 8" "3 8 7" "4 1 5" "4 5 8"
}
plate 1e-7 >plate.obj
for growth in 1.2 1.5 2; do
  vanguard surface -q plate.obj --growth $growth --out "g$growth"
  exits 0
  n=$(sed -n 's/.*remeshed (remesh_surface): \([0-9]*\) triangles.*/\1/p' out)
  [ "${n:-0}" -gt 0 ] && [ "$n" -lt 50000 ] || fail "$n triangles"
done

octahedron | sed "s/ 1/ 1e300/; s/-1/-1e300/" >huge.obj
vanguard mesh -q huge.obj --out huge
exits 1
