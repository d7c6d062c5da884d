# SPDX-License-Identifier: LGPL-3.0-or-later
# A rank that stops silently, as if its node had failed, is named and ends the
# run. The resumed run writes the files of an undisturbed one.
needs mpi
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 \
  OMPI_MCA_rmaps_base_oversubscribe=1 \
  OMPI_MCA_hwloc_base_binding_policy=none \
  PRTE_MCA_rmaps_default_mapping_policy=:oversubscribe \
  PRTE_MCA_hwloc_default_binding_policy=none
mpirun -n 2 true >/dev/null 2>&1 || skip "no mpirun that starts here"
vanguard demo sphere --cells 200000 --out p
set -- mesh -q -p p/sphere --leaf-cells 20000 -t 1 --write b8.ugrid
vanguard "$@" --out whole
exits 0

# A rank stops itself when the first tasks are kept.
cat >rank <<'END'
#!/bin/bash
if [ "${OMPI_COMM_WORLD_RANK:-${PMIX_RANK:-${PMI_RANK:-0}}}" = 1 ]; then
  self=$$
  (
    while [ "$(find run/records -type f 2>/dev/null | wc -l)" -lt 3 ]; do
      sleep 0.005
    done
    kill -STOP $self
  ) &
fi
exec "$@"
END
chmod +x rank
ASAN_OPTIONS=$ASAN_OPTIONS:detect_leaks=0 timeout 120 mpirun -n 2 ./rank "$program" \
  "$@" --out silent --run-dir run --rank-silence 5 >out 2>err </dev/null
status=$?
[ $status != 0 ] && [ $status != 124 ] || fail "exit status $status"
says err "rank 1 on"
says err "has given no sign of life for 5 s"
absent silent/sphere.b8.ugrid
exists run/run.txt
vanguard "$@" --out silent --run-dir run --resume
exits 0
says out 'tasks reused from run: '
lacks out 'tasks reused from run: 0'
same whole/sphere.b8.ugrid silent/sphere.b8.ugrid
