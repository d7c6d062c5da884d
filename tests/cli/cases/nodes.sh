# SPDX-License-Identifier: LGPL-3.0-or-later
# Ranks on separate nodes each make surface, layers and sizes: the files equal
# those of one rank, or the run is refused, naming the nodes that differ.
needs mpi
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 \
  OMPI_MCA_rmaps_base_oversubscribe=1
timeout 20 mpirun -n 2 true >/dev/null 2>&1 || skip "no mpirun"
vanguard demo wing-half --cells 200000 --out p
options="-q -p p/wing-half --layer-count 5 --leaf-cells 20000"
# shellcheck disable=SC2086
vanguard mesh $options --out one
exits 0

on_nodes() {   # on_nodes RANKS PER_NODE OPTION...; MPI itself leaks
  # shellcheck disable=SC2086
  ASAN_OPTIONS=$ASAN_OPTIONS:detect_leaks=0 timeout 120 mpirun -n "$1" --bind-to none "$program" mesh $options \
    --out many --test-node-ranks "$2" "${@:3}" >out 2>err
  status=$?
}

on_nodes 3 2
exits 0
same one/wing-half.b8.ugrid many/wing-half.b8.ugrid

rm -r many
for what in surface layers sizes; do
  on_nodes 4 2 --test-differ $what
  exits 1
  says err "rank 2 on "
  says err "computed different $what than rank 0 on "
  [ -z "$(ls -A many)" ] || fail "left behind: $(ls -A many)"
done
