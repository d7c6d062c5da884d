# SPDX-License-Identifier: LGPL-3.0-or-later
# Periodic patches: a box with two pairs, sectors of a ring and of a disk.
needs tetgen
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 \
  OMPI_MCA_rmaps_base_oversubscribe=1 \
  OMPI_MCA_hwloc_base_binding_policy=none \
  PRTE_MCA_rmaps_default_mapping_policy=:oversubscribe \
  PRTE_MCA_hwloc_default_binding_policy=none

# shellcheck source=tests/cli/duct.bash
. "$here/duct.bash"

# shellcheck source=tests/cli/sector.bash
. "$here/sector.bash"

# report NAME EXPRESSION: a value of the JSON report is as the jq expression says.
report() {
  if command -v jq >/dev/null; then
    jq -e "$2" "o_$1/$1.report.json" >out || fail "$1: $2: $(cat out)"
  fi
}

duct box
deck box "patch image" "w1 w2" "w3 w4"
valid box
report box '.periodic | length == 2 and .[0].translation == [0, 0, 1] and
  .[0].triangles == 128 and .[0].moved == 0 and .[1].translation == [0, 1, 0]'
report box '.periodic_distance == 0'

sector ring 7 0.3
deck ring "patch image" "lo hi"
valid ring
report ring '.periodic[0] | .kind == "rotation" and .turns_per_circle == 7 and
  .axis == [0, 0, 1] and .moved > 0 and .moved < 1e-6'
report ring '.periodic_distance == 0'
cp ring.stl given.stl
deck given "patch image angle ux uy uz" "hi lo -51.4286 0 0 2"
valid given
report given '.periodic[0] | .angle == -360 / 7 and .centre == [0, 0, 0]'

# Points on the axis are their own images.
sector disk 5 0
deck disk "patch image" "lo hi"
valid disk
report disk '.periodic[0].turns_per_circle == 5'
vanguard mesh disk.stl --flow internal --hmax 0.12 --out text
exits 0
says out "1 to 2: rotation by 72 degrees (360/5) about (0, 0, 1) through (0, 0, 0)"
says out "distance in the mesh: at most 0"

# The same faces for other threads and ranks, and from the resolved deck.
for threads in 1 3; do
  vanguard mesh ring.stl --flow internal --quiet --hmax 0.08 --leaf-cells 2000 \
    --threads $threads --write b8.ugrid,foam-ascii --out t$threads
  exits 0
done
vanguard mesh ring.stl --deck t1/ring.resolved.deck --quiet \
  --write b8.ugrid,foam-ascii --out again
exits 0
boundary=ring.openfoam/constant/polyMesh
for other in t3 again; do
  same t1/ring.b8.ugrid $other/ring.b8.ugrid
  for file in points faces boundary; do
    same t1/$boundary/$file $other/$boundary/$file
  done
done
if mpirun -n 2 true >/dev/null 2>&1; then
  ASAN_OPTIONS=$ASAN_OPTIONS:detect_leaks=0 mpirun -n 2 "$program" mesh \
    ring.stl --flow internal --quiet --hmax 0.08 --leaf-cells 2000 --threads 1 \
    --write b8.ugrid,foam-ascii --out ranks >out 2>err ||
    fail "two ranks: $(cat err)"
  same t1/ring.b8.ugrid ranks/ring.b8.ugrid
  same t1/$boundary/faces ranks/$boundary/faces
else echo "mpirun is not installed: the ranks are omitted"; fi

# --- layers --------------------------------------------------------------------

# The columns that slide in a periodic patch, and the triangles around them, are
# the images of those of the other one: at walls that continue through both
# patches with a slope, at corners, edges with fans, and in two pairs at once.
sector wave 7 0.3 0.08
layers() {
  local name=$1
  shift
  vanguard mesh "$name.stl" --flow internal --quiet --hmax 0.12 --first 0.004 \
    --write b8.ugrid,foam-ascii --out "l_$name" "$@"
  exits 0
  vanguard check "l_$name/$name.b8.ugrid"
  exits 0
  says out "valid"
  if command -v jq >/dev/null; then
    jq -e '.periodic_distance == 0 and .layers.points > 500 and
      all(.layers.patches[]; .first_error_percent < 0.01)' \
      "l_$name/$name.report.json" >out || fail "$name: layers: $(cat out)"
  fi
}
deck wave "patch image" "lo hi"
layers wave --walls in --cells mixed
cp wave.stl corner.stl
deck corner "patch image" "hi lo"
layers corner --walls in,bot,out --cells hex
cp wave.stl again.stl
cp wave.deck again.deck
layers again --walls in,bot --cells tets --decompose octree --threads 3
cp box.stl pairs.stl
cp box.deck pairs.deck
layers pairs --walls w5,w6 --cells mixed
vanguard mesh wave.stl --flow internal --quiet --hmax 0.12 --first 0.004 \
  --write b8.ugrid,foam-ascii --out l_again --walls in --cells mixed --threads 3
exits 0
same l_wave/wave.b8.ugrid l_again/wave.b8.ugrid
same l_wave/wave.openfoam/constant/polyMesh/faces \
  l_again/wave.openfoam/constant/polyMesh/faces

# The example: a blade with a gap at the casing, and layers in it.
vanguard demo passage --cells 3000 --out demo
exits 0
says out "the geometry needs more"
vanguard mesh -p demo/passage --quiet --cells mixed --write b8.ugrid,foam \
  --out demo/m
exits 0
vanguard check demo/m/passage.b8.ugrid
exits 0
says out "validity: valid"
if command -v jq >/dev/null; then
  jq -e '.periodic_distance == 0 and .layers.points > 3000 and
    (.periodic[0] | .turns_per_circle == 22 and .moved < 1e-12) and
    ([.layers.patches[] | select(.name == "tip")][0].percent_any == 100)' \
    demo/m/passage.report.json >out || fail "passage: $(cat out)"
fi

# --- OpenFOAM ------------------------------------------------------------------

grep -A5 '^    hi$' t1/$boundary/boundary >out
says out "type            cyclic;"
says out "neighbourPatch  lo;"
says out "transform       rotational;"
vanguard mesh box.stl --flow internal --quiet --hmax 0.12 --write foam --out fbox
exits 0
grep -A5 '^    w2$' fbox/box.openfoam/constant/polyMesh/boundary >out
says out "separationVector (0 0 -1);"

if command -v checkMesh >/dev/null; then
  # shellcheck source=tests/cli/openfoam.bash
  . "$here/openfoam.bash"
  load_openfoam
  for case in fbox/box t1/ring l_wave/wave l_corner/corner l_pairs/pairs \
    demo/m/passage; do
    (cd $case.openfoam && checkMesh -allTopology) >out 2>err
    says out "Coupled point location match"
    says out "Mesh OK."
  done
else echo "OpenFOAM is not installed: checkMesh is omitted"; fi

# --- errors --------------------------------------------------------------------

# refused TEXT OPTION...: meshing box with err.deck fails with the text.
refused() {
  local text=$1
  shift
  vanguard mesh box.stl --deck err.deck --flow internal --out refused "$@"
  exits 1
  says err "$text"
  [ ! -e refused/box.b8.ugrid ] || fail "a mesh was written"
}
# table TEXT LINE LINE...
table() {
  local text=$1
  shift
  deck err "$@"
  refused "$text"
}
table "patch 1 is paired with itself" "patch image" "w1 1"
table "no patch of the surface is named 'nix'" "patch image" "w1 nix"
table "line 2: patch 2 is in an earlier line" "patch image" "w1 w2" "w2 w3"
table "'w*' matches patches 1 w1 and 2 w2" "patch image" "w* w3"
table "81 of 81 points have no partner" "patch image tx ty tz" "w1 w2 0 0 1.01"
table "largest distance is 0.01, at (0, 0, 0)" "patch image tx ty tz" \
  "w1 w2 0 0 1.01"
table "tx, ty and tz must be given together" "patch image tx ty" "w1 w2 0 0"
table "needs angle and ux, uy, uz" "patch image angle" "w1 w2 90"
table "no rotation takes patches 1 (w1) and 2 (w2)" "patch image kind" \
  "w1 w2 rotation"
deck err "patch image" "w1 w2"
refused "wrap is given" --wrap 0.1
refused "surface_swap is yes" --surface-swap yes
refused "baffles, sheets or interfaces are given" --sheets w5
refused "patch 1 w1 is periodic, but layers" --walls w1,w5 --first 0.01

# Periodic patches get FUN3D's code, among other conditions and without any.
code() { awk -v name="$2" '$NF == name { print $2 }' "$1"; }
duct box
deck box "patch image" "w1 w2"
vanguard mesh box.stl --flow internal --quiet --write b8.ugrid --out bare
exits 0
[ "$(code bare/box.mapbc w1)/$(code bare/box.mapbc w3)" = 6100/5 ] ||
  fail "without conditions: $(cat bare/box.mapbc)"
lacks out "(number 1"
printf '\npatches\nid bc\nw3 4\nw4 4\nw5 3\nw6 3\n' >>box.deck
vanguard mesh box.stl --flow internal --quiet --write b8.ugrid --out some
exits 0
[ "$(code some/box.mapbc w2)/$(code some/box.mapbc w3)" = 6100/4 ] ||
  fail "with conditions: $(cat some/box.mapbc)"
for code in 1 3 4; do
  sed "s/^w3 .*/&\nw1 $code/" box.deck >err.deck
  refused "patch 1 w1 is in the table periodic, but its boundary condition is $code"
done

# Slivers do not start the automatic remeshing.
duct long
awk '$1 == "vertex" { $2 *= 12 } { print }' long.stl >long.new
mv long.new long.stl
deck long "patch image" "w5 w6"
vanguard plan long.stl --flow internal
exits 0
says out "a surface with periodic patches is not remeshed"

# On request the first patch is remeshed, and the second one is its image.
for name in ring disk; do
  vanguard mesh $name.stl --flow internal --remesh-surface yes --hmax 0.12 \
    --surface-size 0.1 --quiet --write b8.ugrid --out "o_$name"
  exits 0
  report $name '.periodic_distance == 0 and .periodic[0].triangles > 200'
  vanguard check "o_$name/$name.b8.ugrid"
  exits 0
done

# Other diagonals, and other numbers of triangles.
duct box "w7 8 8  1 0 1  0 1 0  -1 0 0"
sed -i '/^solid w2$/,/^endsolid w2$/d' box.stl
table "128 of 128 faces have no partner" "patch image" "w1 w7"
cp ring.stl box.stl
table "differ: 48 and 64 faces" "patch image tx ty tz" "lo out 1 0 0"
