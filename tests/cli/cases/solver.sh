# SPDX-License-Identifier: LGPL-3.0-or-later
# Solver partitions: of a mesh as it is made, by ranks and threads, and of a
# mesh file, in three forms; refusals.
needs metis mpi
vanguard demo wing-half --cells 8000 --out p
exits 0
layers="--first 0.001 --layer-count 6 --fan-angle 60"

# With the mesh: .part, cell data of the .vtu, and OpenFOAM.
# shellcheck disable=SC2086
vanguard mesh -q -p p/wing-half $layers --ugrid-tail yes --solver-parts 4 \
  --write b8.ugrid,cogsg,vtu,foam --out one
exits 0
says out "Solver partition"
says out "none of them cut"
says one/wing-half.report.json '"solver_parts": {'
says one/wing-half.resolved.deck "solver_parts"
exists one/wing-half.part.4
n=$(wc -l <one/wing-half.part.4)
says one/wing-half.vtu 'Name="solver_part"'
parts=$(sort -nu one/wing-half.part.4 | tr '\n' ' ')
[ "$parts" = "0 1 2 3 " ] || fail "parts are $parts"
sed -n '/^(/,/^)/p' one/wing-half.openfoam/constant/cellDecomposition |
  grep -v '[()]' | cmp - one/wing-half.part.4 || fail "cellDecomposition"
says one/wing-half.openfoam/constant/cellDecomposition "$n"
says one/wing-half.openfoam/system/decomposeParDict "numberOfSubdomains 4;"

# From the file: the same stacks, hence the same partitions; from either
# format.
for file in wing-half.b8.ugrid wing-half.cogsg; do
  vanguard partition -q one/$file -n 4 --out again
  exits 0
  same one/wing-half.part.4 again.part.4
  rm again.part.4
done

# On any number of threads and ranks.
# shellcheck disable=SC2086
vanguard mesh -q -p p/wing-half $layers -t 2 --solver-parts 4 \
  --write vtu,pvtu --out two
same one/wing-half.vtu two/wing-half.vtu
same one/wing-half.part.4 two/wing-half.part.4
says two/wing-half.pvtu 'Name="solver_part"'
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 \
  OMPI_MCA_rmaps_base_oversubscribe=1 OMPI_MCA_hwloc_base_binding_policy=none
if mpirun -n 2 true >/dev/null 2>&1; then
  # shellcheck disable=SC2086
  ASAN_OPTIONS=$ASAN_OPTIONS:detect_leaks=0 mpirun -n 2 "$program" mesh -q -p p/wing-half \
    $layers -t 1 --solver-parts 4 --write vtu,pvtu --out ranks >out 2>err
  for file in wing-half.vtu wing-half.part.4 wing-half_0.vtu; do
    same two/$file ranks/$file
  done
fi

# Prisms form stacks in any file; tetrahedra only if the file marks them.
# shellcheck disable=SC2086
vanguard mesh -q -p p/wing-half $layers --cells mixed --write lb8.ugrid --out m
vanguard partition -q m/wing-half.lb8.ugrid -n 3 --weights pri=2,pyr=1.5 \
  --write part,vtu,foam-ascii --json
exits 0
says out '"tetrahedra_in_stacks_known": false'
says out '"parts": 3'
exists m/wing-half.part.3 m/wing-half.vtu \
  m/wing-half.openfoam/constant/cellDecomposition
vanguard partition -q m/wing-half.lb8.ugrid -n 3
says out "is not known"
says out "none of them cut"

# Refusals.
vanguard partition one/wing-half.b8.ugrid
exits 2
says err "no number of partitions given"
for n in 0 -1 x 1.5 99999999999999999999; do
  vanguard partition one/wing-half.b8.ugrid -n $n
  exits 2
done
vanguard partition -q one/wing-half.b8.ugrid -n 999999999
exits 1
says err "999999999 solver partitions were requested, but the mesh has"
absent one/wing-half.part.999999999
vanguard partition -q p/wing-half.lb8.ugrid -n 2
exits 1
says err "a surface"
vanguard partition -q one/wing-half.vtu -n 2
exits 1
says err "can only be written"
vanguard partition -q one/wing-half.b8.ugrid -n 2 --weights prism=2
exits 2
vanguard partition -q one/wing-half.b8.ugrid -n 2 --weights pri=0
exits 2
vanguard partition -q one/wing-half.b8.ugrid -n 2 --write stl
exits 2
vanguard partition -q one/wing-half.b8.ugrid -n 2 --out no/folder/x
exits 1
says err "no/folder: cannot write in this folder"
# shellcheck disable=SC2086
vanguard mesh -q -p p/wing-half $layers --solver-parts 9999999 \
  --write b8.ugrid --out many
exits 1
says err "9999999 solver partitions were requested"
absent many/wing-half.b8.ugrid

# If one file cannot be written, none is left.
mkdir limited
(ulimit -f $(($(wc -c <one/wing-half.part.4) / 1024 + 8))
  "$program" partition -q one/wing-half.b8.ugrid -n 4 --write part,vtu \
    --out limited/s 2>err)
status=$?
exits 1
says err "limited/s.vtu: cannot write"
absent limited/s.part.4 limited/s.vtu
