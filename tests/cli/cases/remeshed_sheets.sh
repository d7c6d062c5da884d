# SPDX-License-Identifier: LGPL-3.0-or-later
# Inner surfaces that are remeshed with the walls, and that are cut where they
# cross walls, bodies, each other and the plane of a half model.
needs tetgen wrap

# shellcheck source=tests/cli/duct.bash
. "$here/duct.bash"

# Coarse triangles, walls and inner surfaces get the same edges.
fin="fin 2 2  0.5 0.25 0  0 0.5 0  0 0 0.5"
plate="plate 1 2  0.5 0.25 0.25  0.25 0 0  0 0.5 0"
duct both "$fin" "$plate"
remeshed="--remesh-surface yes --surface-size 0.08 --hmin 0.02"
# shellcheck disable=SC2086
valid both --baffles fin --sheets plate $remeshed
vanguard mesh both.stl --flow internal --baffles fin --sheets plate \
  --walls '*' --first 0.004 --layer-count 5 $remeshed --hmax 0.12 \
  --write b8.ugrid --out layers
exits 0
says out "the inner surfaces were remeshed: "
says out "curves along which they share edges with other surfaces: 2"
vanguard check layers/both.b8.ugrid
exits 0
says out "valid"

# The remeshed surface as a file has the inner surfaces once.
# shellcheck disable=SC2086
vanguard surface both.stl --flow internal --baffles fin --sheets plate \
  $remeshed --write b8.ugrid --out surface
exits 0
lacks out "fin_back_"
vanguard mesh surface/both.b8.ugrid --flow internal --baffles 7 --sheets 8 \
  --hmax 0.12 --quiet --write b8.ugrid --out again
exits 0
vanguard check again/both.b8.ugrid
exits 0
says out "valid"

# Parts of one patch that meet along an edge are pieces.
awk '/solid plate/ { sub("plate", "fin") } { print }' both.stl >self.stl
# shellcheck disable=SC2086
valid self --baffles fin $remeshed
vanguard check o_self/self.b8.ugrid
exits 0

# A plate that passes through the floor, a fin and both sides; without
# remeshing it is refused, and the message says how it is cut.
duct cross "fin 2 2  0.5 0.25 -0.2  0 0.5 0.01  0.1 0 0.7" \
  "cut 1 3  0.3 -0.1 0.2  0.4 0.03 0.02  0 1.3 0.1"
vanguard mesh cross.stl --flow internal --baffles fin --sheets cut
exits 1
says out "set remesh_surface to yes, which cuts the inner surface there"
ways="advancing octree"
vanguard --version --verbose
grep -q "METIS" out && ways="$ways discrete"
for way in $ways; do
  for threads in 1 3; do
    # shellcheck disable=SC2086
    vanguard mesh cross.stl --flow internal --baffles fin --sheets cut \
      $remeshed --hmax 0.1 --decompose $way --leaf-cells 1500 --quiet \
      --threads $threads --write b8.ugrid --out $way$threads
    exits 0
    says out "inner surfaces were cut where they cross other surfaces"
  done
  same ${way}1/cross.b8.ugrid ${way}3/cross.b8.ugrid
  same ${way}1/cross.sheets ${way}3/cross.sheets
  vanguard check ${way}1/cross.b8.ugrid
  exits 0
  says out "valid"
done

if mpirun -n 2 true >/dev/null 2>&1; then
  # shellcheck disable=SC2086
  ASAN_OPTIONS=${ASAN_OPTIONS:-}:detect_leaks=0 mpirun -n 2 "$program" mesh \
    cross.stl --flow internal --baffles fin --sheets cut $remeshed --hmax 0.1 \
    --decompose octree --leaf-cells 1500 --quiet --threads 1 --write b8.ugrid \
    --out ranks >out 2>err || fail "2 ranks: $(cat err)"
  same octree1/cross.b8.ugrid ranks/cross.b8.ugrid
fi

# A half model: the plate passes through the plane of symmetry and the body.
awk '/^solid (w3|fin)/ { out = 1 } !out { print }
  /^endsolid/ { out = 0 }' cross.stl >half.stl
# shellcheck disable=SC2086
vanguard mesh half.stl --flow external --half y --sheets cut $remeshed \
  --farfield-lengths 4 --write b8.ugrid --out half
exits 0
says out "inner surfaces were cut where they cross other surfaces or the symmetry"
vanguard check half/half.b8.ugrid
exits 0
says out "valid"

# A patch that is inside the body as a whole.
duct inside "in 1 1  0.4 0.4 0.5  0.2 0 0  0 0.2 0" \
  "out 1 1  0.4 0.9 0.5  0.2 0 0  0 0.3 0"
# shellcheck disable=SC2086
vanguard mesh inside.stl --flow external --sheets in,out $remeshed
exits 1
says err "patch 7 in, an inner surface, is not in the fluid"

# A wake that ends beyond the generated farfield is cut there, around a whole
# body and half of one; without remeshing, and as a whole beyond it, it is
# refused.
duct far "wake 60 2  0.5 -0.3 0.45  30 0 0  0 0.9 0.03"
awk '/^solid w3/ { out = 1 } !out { print } /^endsolid/ { out = 0 }' far.stl \
  >cutoff.stl
far="--flow external --sheets wake --farfield-lengths 5 --surface-size 0.25"
for threads in 1 3; do
  # shellcheck disable=SC2086
  vanguard mesh far.stl $far --remesh-surface yes --quiet --threads $threads \
    --decompose octree --leaf-cells 4000 --write b8.ugrid --out far$threads
  exits 0
  says out "were removed"
  vanguard check far$threads/far.b8.ugrid
  exits 0
  says out "valid"
done
same far1/far.b8.ugrid far3/far.b8.ugrid
same far1/far.sheets far3/far.sheets
# shellcheck disable=SC2086
vanguard mesh far.stl $far --remesh-surface yes --farfield box --quiet \
  --write b8.ugrid --out box
exits 0
vanguard check box/far.b8.ugrid
exits 0
says out "valid"
# shellcheck disable=SC2086
vanguard mesh cutoff.stl $far --half y --remesh-surface yes --quiet \
  --write b8.ugrid --out cutoff
exits 0
vanguard check cutoff/cutoff.b8.ugrid
exits 0
says out "valid"
for name in "cutoff.stl --half y" "far.stl"; do
  # shellcheck disable=SC2086
  vanguard mesh $name $far --out refused
  exits 1
done
says err "patch 7 wake, an inner surface, crosses the generated boundary at"
says err "set remesh_surface to yes, which cuts it there"
duct beyond "wake 4 2  40 -0.3 0.45  30 0 0  0 0.9 0.03"
# shellcheck disable=SC2086
vanguard mesh beyond.stl $far --remesh-surface yes --out refused
exits 1
says err "patch 7 wake, an inner surface, lies beyond the generated boundary as"

# Points of a smooth wall within rounding of a sheet: the equator of a sphere in
# its plane, and meridians in that of another sheet.
duct plates "lie 8 8  -1 -1 0  2 0 0  0 2 0" "up 7 9  -1 0 -1  2 0 0  0 0 2"
{
  awk 'function corner(i, j, t, p) {
      t = 3.14159265358979 * i / 12
      if (i % 12 == 0) j = 0
      p = 6.28318530717959 * (j % 24) / 24
      print "vertex", sprintf("%.17g %.17g %.17g", sin(t) * cos(p) / 2,
        sin(t) * sin(p) / 2, cos(t) / 2 + (i == 6 ? 1e-9 : 0))
    }
    function facet(a, b, c, d, e, f) {
      print "facet normal 0 0 0\nouter loop"
      corner(a, b); corner(c, d); corner(e, f)
      print "endloop\nendfacet"
    }
    BEGIN {
      print "solid ball"
      for (i = 0; i < 12; i++) for (j = 0; j < 24; j++) {
        if (i) facet(i, j, i + 1, j + 1, i, j + 1)
        if (i < 11) facet(i, i ? j : 0, i + 1, j, i + 1, j + 1)
      }
      print "endsolid ball"
    }'
  awk '/^solid lie/ { on = 1 } on { print }' plates.stl
} >equator.stl
vanguard mesh equator.stl --flow external --farfield-lengths 3 --quiet \
  --sheets lie,up --remesh-surface yes --surface-size 0.12 \
  --write b8.ugrid --out equator
exits 0
vanguard check equator/equator.b8.ugrid
exits 0
says out "valid"

# Sheets that overlap in one plane are refused by name; those that meet there in an
# edge that they divide differently are divided alike.
duct coplanar "p 4 4  0.5 0.25 0.25  0 0.4 0  0 0 0.4" \
  "q 4 4  0.5 0.33 0.37  0 0.4 0  0 0 0.4"
vanguard mesh coplanar.stl --flow internal --sheets p,q --remesh-surface yes \
  --quiet --out coplanar
exits 1
says err "patches 7 p and 8 q, inner surfaces, overlap in one plane at (0.5, "
absent coplanar/coplanar.b8.ugrid
duct beside "p 4 4  0.5 0.25 0.25  0 0.4 0  0 0 0.4" \
  "q 3 5  0.5 0.65 0.25  0 0.3 0  0 0 0.4"
valid beside --sheets p,q --remesh-surface yes
