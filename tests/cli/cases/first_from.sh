# SPDX-License-Identifier: LGPL-3.0-or-later
# First heights from the wall shear of a solution: with a known skin friction,
# the heights measured in the mesh are those of the requested y+. The mesh does
# not depend on threads and ranks, and invalid solutions are refused.
needs tetgen
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 \
  OMPI_MCA_rmaps_base_oversubscribe=1 OMPI_MCA_hwloc_base_binding_policy=none
command -v python3 >/dev/null || skip "no python3"
first_from() { python3 "$here/first_from.py" "$@"; }

vanguard demo wing --cells 60000 --out .
exits 0
cf='0.003 * (1 + 0.5 * sin(4 * x))'
first_from write wing.lb8.ugrid s.vtu 1,2,3 cf "$cf"

# The deck of the demo requests y+ 1 at Reynolds number 5e6 and length 0.7.
for cells in mixed tets; do
  vanguard mesh -q -p wing --write b8.ugrid --cells "$cells" \
    --first-from s.vtu --out "$cells" --threads 1
  exits 0
  says out "note: first heights at 5825 points of walls follow from the skin"
  says out "y+ of the first heights with the skin friction of the solution"
done
read -r share n <<<"$(first_from measure mixed/wing.b8.ugrid 1,2,3 \
  "0.7 / (5e6 * sqrt(($cf) / 2))")"
[ "$share" -ge 99 ] && [ "$n" -gt 3000 ] ||
  fail "$share % of $n first heights are those of y+ 1"
grep -q '"requested": 1.0' mixed/wing.report.json || fail "no y+ in the report"
vanguard plan -q -p wing --first-from s.vtu --json
exits 0

# The resolved deck has y_plus and the file; threads and ranks do not matter.
says tets/wing.resolved.deck s.vtu
vanguard mesh -q -p wing --deck tets/wing.resolved.deck --out again --threads 3
exits 0
same tets/wing.b8.ugrid again/wing.b8.ugrid
if mpirun -n 2 true >/dev/null 2>&1; then
  ASAN_OPTIONS=$ASAN_OPTIONS:detect_leaks=0 mpirun -n 2 "$program" mesh -q \
    -p wing --deck tets/wing.resolved.deck --out ranks >out 2>err
  same tets/wing.b8.ugrid ranks/wing.b8.ugrid
fi

# The same walls in a folder with a file for each patch, of which one is no wall.
mkdir empty folder
for patch in 1 2 3; do
  first_from write wing.lb8.ugrid "folder/$patch.vtp" "$patch" cf "$cf"
done
first_from write wing.lb8.ugrid folder/0.vtu 4 cf 0
vanguard mesh -q -p wing --write b8.ugrid --cells mixed --first-from folder \
  --out of_folder
exits 0
same mixed/wing.b8.ugrid of_folder/wing.b8.ugrid

# The same walls as polygons, and as the boundary of cells.
vanguard demo sphere --cells 20000 --out .
exits 0
vanguard mesh -q -p sphere --layers no --write lb8.ugrid --out cells
exits 0
walls=$(awk '$2 == 4 { printf "%s%s", n++ ? "," : "", $1 }' sphere.mapbc)
first_from write cells/sphere.lb8.ugrid cells.vtu "$walls" cf "0.01 + 0.005 * x"
first_from write sphere.lb8.ugrid faces.vtp "$walls" cf "0.01 + 0.005 * x"
flow="--y-plus 1 --reynolds 1e6 --reference-length 1"
for file in cells.vtu faces.vtp; do
  vanguard mesh -q -p sphere $flow --write b8.ugrid --first-from "$file" \
    --out "${file%.*}2"
  exits 0
  says out "follow from the skin friction 'cf' of $file"
  lacks out "are too far from the walls"
done
same cells2/sphere.b8.ugrid faces2/sphere.b8.ugrid

# A run with another solution cannot be resumed.
vanguard mesh -q -p sphere $flow --first-from faces.vtp --out run1 \
  --write b8.ugrid --run-dir run --keep-run
exits 0
vanguard mesh -q -p sphere $flow --first-from faces.vtp --out run2 \
  --write b8.ugrid --run-dir run --resume --keep-run
exits 0
same run1/sphere.b8.ugrid run2/sphere.b8.ugrid
first_from write sphere.lb8.ugrid faces.vtp "$walls" cf "0.01 + 0.004 * x"
vanguard mesh -q -p sphere $flow --first-from faces.vtp --out run3 \
  --write b8.ugrid --run-dir run --resume
exits 1
says err "cannot be resumed: input or options have changed"

# The same values as a vector, which is a stress with a factor; y+ 2 on one
# patch, and on another a first height of its own, which lowers those of its
# neighbours.
cat >patches.deck <<'END'
Patches
hmax  y_plus  reynolds  reference_length  first_scale
4     1       5000000   0.7               0.02

layers
id  y_plus  first
2   2       -
3   -       3e-6

farfield
kind
none
END
first_from write wing.lb8.ugrid v.vtu 1,2,3 wallShearStress \
  "(0.3 * $cf * 100, 0, -0.4 * $cf * 100)"
vanguard mesh -q -p wing --deck patches.deck --first-from v.vtu --write b8.ugrid \
  --cells mixed --out patches
exits 0
grep -q '"requested": 2.0' patches/wing.report.json || fail "no y+ of a patch"
grep -qE "^ +3 base +3e-06 +3e-06 +3e-06 +3e-06" out ||
  fail "a patch does not keep its own first height"
read -r share n <<<"$(first_from measure patches/wing.b8.ugrid 1 \
  "0.7 / (5e6 * sqrt(($cf) / 2))")"
[ "$share" -ge 80 ] || fail "$share % of $n heights with a vector"

# No friction: the bound holds, and part of the walls keep y_plus alone.
first_from write wing.lb8.ugrid zero.vtu 1 cf "1e-12 if z > 0 else $cf"
vanguard check -q -p wing --first-from zero.vtu --first-bound 2
says out "of them they are bounded by the factor 2 (first_bound)"
says out "are too far from the walls of the solution"

# refused FILE TEXT ARGS...: the solution is refused with the TEXT.
refused() {
  local file=$1 text=$2
  shift 2
  vanguard mesh -q -p wing --first-from "$file" --out no "$@"
  [ "$status" != 0 ] || fail "not refused"
  says err "$text"
  absent no
}
refused nowhere.vtu "nowhere.vtu"
for unit in 1000 0.001; do
  awk -v unit=$unit '/Name=/ { on = /NumberOfComponents="3"/ && !/Name="cf"/ }
       on && NF == 3 && !/</ { $1 *= unit; $2 *= unit; $3 *= unit } 1' s.vtu \
    >unit.vtu
  refused unit.vtu "points of walls are near a wall of unit.vtu, less than half"
done
refused empty "there is no .vtu or .vtp in the folder empty"
refused s.csv "neither a .vtu nor a .vtp"
refused s.vtu "first and first_from are both given" --first 1e-5
refused s.vtu "first_from requires y_plus" --y-plus 0
refused s.vtu "first_from is given, but layers is no" --layers no
refused s.vtu "layer_sources and first_from" --layer-sources yes
refused s.vtu "there is no array 'tau'; its point arrays are: cf" \
  --first-field tau
refused s.vtu "set ratio, and layer_count or layer_total" --layer-count 30 \
  --layer-total 0.01
refused v.vtu "'wallShearStress' is a stress"
first_from write wing.lb8.ugrid bad.vtu 1 friction 1
refused bad.vtu "give a field by --first-field; its point arrays are: friction"
first_from write wing.lb8.ugrid bad.vtu 1 cf "0"
refused bad.vtu "bad.vtu has no walls: 'cf' is zero"
first_from write wing.lb8.ugrid bad.vtu 1 cf "-$cf"
refused bad.vtu "gives the skin friction coefficient -0.00"
first_from write wing.lb8.ugrid bad.vtu 1 cf "nan"
refused bad.vtu "value 1 of 5801 is not a number"
first_from write wing.lb8.ugrid bad.vtu 1 cf "(1, 2, 3, 4)"
refused bad.vtu "has 4 components"
first_from write wing.lb8.ugrid bad.vtu 4 cf "1"
refused bad.vtu "points of walls are near a wall of bad.vtu, less than half"
sed 's/PointData/CellData/' s.vtu >bad.vtu
refused bad.vtu "'cf' has values in the cells" --first-field cf
{
  sed '/<PointData>/q' s.vtu
  sed -n '/Name="cf"/,/<.DataArray>/p' s.vtu | sed 's/"cf"/"Cf"/'
  sed '1,/<PointData>/d' s.vtu
} >bad.vtu
refused bad.vtu "both point arrays 'cf' and 'Cf'"
