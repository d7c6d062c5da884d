# SPDX-License-Identifier: LGPL-3.0-or-later
# Decomposition of the void by the faces of a coarse mesh, or by octants: the
# same files for any number of ranks and threads, in any order; reports; what
# is refused.
needs metis mpi
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 \
  OMPI_MCA_rmaps_base_oversubscribe=1 \
  OMPI_MCA_hwloc_base_binding_policy=none \
  PRTE_MCA_rmaps_default_mapping_policy=:oversubscribe \
  PRTE_MCA_hwloc_default_binding_policy=none

vanguard demo box --cells 20000 --out p
for way in 'remesh metis' 'h-refine rcb'; do
  read -r interfaces partitioner <<< "$way"
  set -- mesh -q -p p/box --decompose discrete --subdomains 5 --write b8.ugrid \
    --interfaces "$interfaces" --partitioner "$partitioner"
  vanguard "$@" -t 1 --out one
  exits 0
  says out "decomposition discrete; subdomains: 5 "
  says out "validity: valid"
  says one/box.report.json '"decomposition": "discrete"'
  says one/box.report.json '"interface_triangles": '
  says one/box.resolved.deck discrete
  vanguard "$@" -t 3 --out many --shuffle-tasks 7
  exits 0
  cmp -s one/box.b8.ugrid many/box.b8.ugrid || fail "the mesh depends on threads"
  if mpirun -n 2 true >/dev/null 2>&1; then
    ASAN_OPTIONS=$ASAN_OPTIONS:detect_leaks=0 mpirun -n 2 "$program" "$@" -t 2 \
      --out ranks >out 2>err || fail "2 ranks: $(cat err)"
    cmp -s one/box.b8.ugrid ranks/box.b8.ugrid || fail "the mesh depends on ranks"
  fi
  vanguard check -q one/box.b8.ugrid
  exits 0
done

# Without a number of subdomains, leaf_cells gives the cells of each.
vanguard mesh -q -p p/box --decompose discrete --leaf-cells 7000 --out by
exits 0
says out "decomposition discrete; subdomains: 3 "

vanguard mesh -q -p p/box --decompose discrete --subdomains 0
exits 2
says err "subdomains"
vanguard mesh -q -p p/box --decompose discrete --coarsening 0.5
exits 2
says err "coarsening is 0.5; it must be at least 1"
for way in 'discrete --subdomains 900000' 'octree --subdomains 900000' \
  'discrete --subdomains 19000 --coarsening 6'; do
  # shellcheck disable=SC2086 # words
  vanguard mesh -q -p p/box --decompose $way --out none
  exits 1
  says err "request fewer subdomains"
  [ ! -e none ] || [ -z "$(ls none)" ] || fail "files of a refused mesh exist"
done
vanguard plan -q -p p/box --decompose discrete --subdomains 5 -n 1,5
exits 0
says out "discrete: 5 subdomains filled without cuts"
says out "0 cuts into 5 leaves; 0 edge separators and 0 face separators"
lacks out "by leaf_cells"
vanguard plan -q -p p/box --decompose discrete --subdomains 5 -n 1 -j
says out '"leaves": 5'
says out '"complete_subdomains": 5'
says out '"path": "0.4"'
says out '"balance": 1.'

# In the advancing partition subdomains are leaves; the mesher that fills them
# does not matter. A box of 20,000 cells in two: the sixteenth of its cells
# that is in the separator zone belongs to neither.
vanguard mesh -q -p p/box --subdomains 2 --out by
exits 0
says by/box.report.json '"leaves": 2'
says by/box.report.json '"schedule": "dynamic"'
vanguard plan -q -p p/box --subdomains 2 -n 1
says out "1 cut into 2 leaves"
for way in advancing discrete octree; do
  set -- mesh -q -p p/box --decompose $way --subdomains 4 --write b8.ugrid \
    --timeline
  vanguard "$@" -t 1 --out one
  exits 0
  says one/box.report.json '"near_interfaces": '
  vanguard "$@" --schedule cyclic -t 3 --out many
  exits 0
  says out "leaves assigned in turn"
  says many/box.timeline.json '"cyclic": 1'
  cmp -s one/box.b8.ugrid many/box.b8.ugrid || fail "$way: static assignment: the mesh differs"
  near() { jq -c .partition.near_interfaces "$1/box.report.json"; }
  [ "$(near one)" = "$(near many)" ] || fail "$way: the cells near interfaces differ"
  if mpirun -n 2 true >/dev/null 2>&1; then
    ASAN_OPTIONS=$ASAN_OPTIONS:detect_leaks=0 mpirun -n 2 "$program" "$@" -t 2 \
      --schedule cyclic --out ranks >out 2>err || fail "2 ranks: $(cat err)"
    cmp -s one/box.b8.ugrid ranks/box.b8.ugrid || fail "$way: ranks, static assignment: the mesh differs"
    [ "$(near one)" = "$(near ranks)" ] || fail "$way: ranks: near interfaces"
  fi
  jq -e '.partition.near_interfaces | .cells > 5000 and .cells < 20000 and
    .angle_min_p1 > 20 and .angle_min_p1 < 45 and .angle_min <= .angle_min_p1' \
    one/box.report.json >out || fail "$way: cells near interfaces"
  # The coarse mesh is made first, and recorded as void 1 without cells.
  jq -e --arg way $way '.columns as $c | [.spans[] | [$c, .] | transpose |
    map({(.[0]): .[1]}) | add] | map(select(.path[:1] == "1")) as $first |
    if $way != "discrete" then $first == [] else ($first | length) > 0 and
    ($first | map(.cells + .work) | add) == 0 and
    any(.[]; .path == "0J0" and .after[:1] == "1") end' \
    one/box.timeline.json >out || fail "$way: the record of the coarse mesh"
  vanguard plan -r one/box.timeline.json -n 2 --schedule cyclic
  exits 0
  says out "Forecast, leaves assigned in turn"
done

# A single subdomain has no interfaces.
vanguard mesh -q -p p/box --leaf-cells 0 --timeline --out whole
exits 0
lacks whole/box.report.json near_interfaces

# By octants, with the gap region at the walls cut by planes; where no octant
# fits, the gap region is the whole void.
vanguard mesh -q -p p/box --decompose octree --subdomains 4 -t 1 --write b8.ugrid \
  --out one
exits 0
says out "octants, coarsening 4.00"
says out "in the gap region at the front, which planes may cut: "
says one/box.report.json '"gap_parts": 1'
vanguard mesh -q -p p/box --decompose octree --subdomains 4 -t 3 --write b8.ugrid \
  --shuffle-tasks 7 --out many
exits 0
cmp -s one/box.b8.ugrid many/box.b8.ugrid || fail "the mesh depends on threads"
if mpirun -n 2 true >/dev/null 2>&1; then
  ASAN_OPTIONS=$ASAN_OPTIONS:detect_leaks=0 mpirun -n 2 "$program" mesh -q -p p/box \
    --decompose octree --subdomains 4 -t 1 --write b8.ugrid --out ranks >out 2>err ||
    fail "2 ranks: $(cat err)"
  cmp -s one/box.b8.ugrid ranks/box.b8.ugrid || fail "the mesh depends on ranks"
  says ranks/box.report.json '"gap_parts": 1'
  says out "octants, coarsening 4.00"
fi
vanguard check -q one/box.b8.ugrid
exits 0
vanguard demo box --cells 500 --out tiny
vanguard mesh -q -p tiny/box --decompose octree --subdomains 4 --out tiny
exits 0
says out "there is no room for octants away from the front"
says out "octree; subdomains: 1 (requested: 4;"
vanguard mesh -q -p p/box --decompose octree --subdomains 4000 --out short
exits 0
says out "(requested: 4,000;"
vanguard mesh -q -p p/box --decompose octree --subdomains 0
exits 2
says err "subdomains"
vanguard mesh -q -p p/box --decompose octree --coarsening 1.5
exits 1
says err "at least 2 sizes wide"
vanguard mesh -q -p p/box --decompose octree --interfaces h-refine
exits 1
says err "set interfaces to remesh"
vanguard plan -q -p p/box --decompose octree --subdomains 4 -n 1
exits 0
says out "of the gap region at the front, which planes may cut"
