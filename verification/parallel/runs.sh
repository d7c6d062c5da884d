# SPDX-License-Identifier: LGPL-3.0-or-later
# verification/parallel/runs.sh: background runs that can be killed. Sourced by
# bash after bench/common.sh; the caller sets `vanguard`, `work`, `out_dir`,
# `run_dir` and the mesh_options, which give input and settings.
# shellcheck shell=bash disable=SC2034,SC2154 # variables of the caller
LIMIT_S=${LIMIT_S:-300}
mesh_options=()

# begin RANKS THREADS OPTION...: start a run; sets `pid`. More ranks than cores
# are allowed, without binding.
begin() {
  local ranks=$1 threads=$2
  shift 2
  local command=("$vanguard" mesh -q "${mesh_options[@]}" --out "$out_dir"
    --threads "$threads" "$@")
  [ -z "$run_dir" ] || command+=(--run-dir "$run_dir")
  [ "$ranks" = 1 ] || command=(mpirun --oversubscribe --bind-to none
    -n "$ranks" "${command[@]}")
  "${command[@]}" > "$work/log" 2>&1 < /dev/null &
  pid=$!
}

# Wait for the end of `pid`; sets `status` and `hung`. (The shell itself would
# print messages about killed runs.)
finish() {
  local i
  hung=0 status=0
  {
    for ((i = 0; i < LIMIT_S * 20; i++)); do
      kill -0 "$pid" || break
      sleep 0.05
    done
    if kill -0 "$pid"; then
      hung=1
      kill -9 "$pid"
    fi
    wait "$pid" || status=$?
  } 2> /dev/null
}

# Wait until the run directory is open, or the run has ended. Its lock must not
# exist before. Earlier there is nothing to resume, and mpirun of Open MPI 4.1
# may wait forever if a rank is killed while ranks connect to it.
until_open() {
  until [ -e "$run_dir/run.lock" ] || ! kill -0 "$pid" 2> /dev/null; do
    sleep 0.01
  done
}

# ranks_of RANKS: the processes of the ranks. (Their children have the same
# name.)
ranks_of() { if [ "$1" = 1 ]; then echo "$pid"; else pgrep -P "$pid"; fi; }

# The error message of the program.
message() { grep -a -m 1 '^vanguard: ' "$work/log" | cut -c11- || true; }
