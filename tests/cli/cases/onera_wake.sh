# SPDX-License-Identifier: LGPL-3.0-or-later
# The wake of the ONERA M6 from another source than the wing: it shares no edge
# with it, begins inside it, passes along its trailing edge to within 1e-4 mm,
# and crosses the plane of symmetry and the tip.
needs tetgen wrap
field=${VG_DATA_DIR:-}/field/onera_m6_root_cap.igs.gz
sheet=${VG_DATA_DIR:-}/sheets/onera_m6_wake_3.09deg.stl.gz
[ -f "$field" ] && [ -f "$sheet" ] ||
  skip "VG_DATA_DIR has no field/onera_m6_root_cap.igs.gz or sheets: verification/fetch.md has the sources"
gunzip -c "$field" >wing.igs
vanguard surface wing.igs --half y --hmin 4 --hmax 20 --write stl --out surface
if grep -q "cannot read CAD" err; then skip "built without Open CASCADE"; fi
exits 0

# The wing is in mm, the wake in m.
{ cat surface/wing.stl
  gunzip -c "$sheet" | awk '/^ *solid/ { print "solid wake"; next }
    $1 == "vertex" { printf "vertex %.17g %.17g %.17g\n", 1000 * $2, 1000 * $3,
                            1000 * $4; next } { print }'; } >m6.stl
options="--half y --sheets wake --unit mm --hmin 4 --surface-size 20
  --remesh-surface yes --farfield-lengths 10 --first 0.02 --layer-count 12
  --cells mixed"
# shellcheck disable=SC2086
vanguard mesh m6.stl --walls 'FACE*,wake' $options --write b8.ugrid --out mesh
exits 0
says out "points of inner surfaces were moved by at most 0.0122 onto sharp edges"
says out "curves along which they share edges with other surfaces: 1"
for patch in 'FACE(11)' 'FACE(12)' wake wake_back; do
  awk -v patch="$patch" '$2 == patch && NF > 8 { exit !($4 > 97 && $NF > 99) }' out ||
    fail "layers of $patch"
done
vanguard check mesh/m6.b8.ugrid
exits 0
says out "valid"
says out "connected regions: 1"
