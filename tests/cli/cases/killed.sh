# SPDX-License-Identifier: LGPL-3.0-or-later
# A run killed by SIGKILL while a decomposed void is filled, and resumed,
# writes the files of an undisturbed run, for every way to decompose.
needs metis mpi
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 \
  OMPI_MCA_rmaps_base_oversubscribe=1 \
  OMPI_MCA_hwloc_base_binding_policy=none \
  PRTE_MCA_rmaps_default_mapping_policy=:oversubscribe \
  PRTE_MCA_hwloc_default_binding_policy=none
vanguard demo sphere --cells 200000 --out p
launcher=
! mpirun -n 2 true >/dev/null 2>&1 || launcher='mpirun -n 2'

# kill_after N: starts the run "$@" and kills it when N tasks are kept. Status
# 1 if it ended before.
kill_after() {
  local n=$1 job
  shift
  rm -rf run
  "$program" "$@" >out 2>err </dev/null &
  job=$!
  while kill -0 $job 2>/dev/null; do
    [ "$(find run/records -type f 2>/dev/null | wc -l)" -lt "$n" ] || break
    sleep 0.005
  done
  kill -KILL $job 2>/dev/null
  wait $job 2>/dev/null
  [ $? = 137 ]
}

for way in 'discrete' 'discrete --interfaces h-refine --partitioner rcb' \
  'octree' 'advancing --leaf-cells 20000'; do
  # shellcheck disable=SC2086 # words
  set -- mesh -q -p p/sphere --decompose $way --write b8.ugrid
  case $way in advancing*) ;; *) set -- "$@" --subdomains 12 ;; esac
  vanguard "$@" -t 2 --out whole
  exits 0
  rm -rf killed
  kill_after 3 "$@" -t 1 --out killed --run-dir run ||
    fail "$way: it ended before it was killed"
  absent killed/sphere.b8.ugrid
  exists run/run.txt
  if [ -n "$launcher" ]; then
    # shellcheck disable=SC2086 # words
    ASAN_OPTIONS=$ASAN_OPTIONS:detect_leaks=0 $launcher "$program" "$@" -t 2 --out killed \
      --run-dir run --resume --keep-run >out 2>err || fail "$way: $(cat err)"
  else
    vanguard "$@" -t 2 --out killed --run-dir run --resume --keep-run
    exits 0
  fi
  says out 'tasks reused from run: '
  lacks out 'tasks reused from run: 0'
  same whole/sphere.b8.ugrid killed/sphere.b8.ugrid
  rm -rf whole killed run
done
