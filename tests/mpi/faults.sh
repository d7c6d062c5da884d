#!/bin/sh
# SPDX-License-Identifier: LGPL-3.0-or-later
# Ways to end a job: faults.sh PROGRAM MPIRUN [FLAG] (-n). None of them may
# hang.
set -u
program=$1
shift
bad=0

check() { # WHAT EXPECTED_STATUS
  timeout 30 "$mpirun" "$flag" 2 "$program" "$1" >/dev/null 2>&1
  status=$?
  [ $status = "$2" ] || { echo "$1: status $status, not $2"; bad=1; }
}

mpirun=$1
flag=${2:--n}
check abort 7
timeout 30 "$mpirun" "$flag" 2 "$program" abort 2>&1 |
  grep -q "rank 1: out of luck" || { echo "abort: no text"; bad=1; }
check kill 137
timeout 30 "$mpirun" "$flag" 2 "$program" stop 2>&1 |
  grep -q "rank 1 on .* has given no sign of life for 3 s" ||
  { echo "stop: the silent rank is not named"; bad=1; }
check leave 0
check jump 0

# Processes started by a launcher of another MPI, which are not connected.
loose() {
  text=$(env "$@" timeout 30 "$program" leave 2>&1) &&
    { echo "$*: no error"; bad=1; }
  case $text in
    *"processes"*) ;;
    *) echo "$*: says '$text'"; bad=1 ;;
  esac
}
loose PMI_SIZE=4 PMI_RANK=0
loose SLURM_STEP_ID=0 SLURM_PROCID=0 SLURM_STEP_NUM_TASKS=3
exit $bad
