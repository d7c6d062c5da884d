#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# verification/slurm.sh: share/slurm/vanguard.sbatch under a Slurm on one host.
#
# usage: verification/slurm.sh [--vanguard PROGRAM] [--work DIR] [--cells N]
#   --vanguard  the program (default build/release/bin/vanguard)
#   --work      scratch folder, kept (default: a temporary one, removed)
#   --cells     of the box that is meshed (default 2000000)
# Starts private instances of munged, slurmctld and slurmd on free ports, with
# all state in the scratch folder, and ends them afterwards. Jobs of two ranks:
# an undisturbed one; with mpirun and with srun, one that Slurm signals near its
# time limit, that returns to the queue and continues; and one that a portal
# starts, stops and resumes. All must write the same files. Needs root (slurmd
# changes users) and Debian's slurm-wlm, munge and openmpi-bin. Exit status: 0
# as expected, 1 a failure, 2 usage, 77 not possible here.
set -euo pipefail

root=$(cd "$(dirname "$0")/.." && pwd)
# shellcheck source=bench/common.sh
. "$root/bench/common.sh"
vanguard=$root/build/release/bin/vanguard
work='' cells=2000000
take_options "vanguard work cells" "" "$@"

for program in munged slurmctld slurmd sbatch scontrol mpirun; do
  command -v $program > /dev/null || skip "no $program"
done
[ "$(id -u)" = 0 ] || skip "a private Slurm needs root"
[ -x "$vanguard" ] || die "no program $vanguard: build it first"
work_folder slurm
work=$(cd "$work" && pwd)

daemons=()
clean_up() {
  status=$?
  [ ${#daemons[@]} = 0 ] || kill "${daemons[@]}" 2> /dev/null || true
  wait
  if [ $status != 0 ] && [ $status != 77 ]; then
    tail -n 15 "$work"/*.log >&2 || true
  fi
  case $work in "${TMPDIR:-/tmp}"/vanguard-slurm.*) rm -rf "$work" ;; esac
  exit $status
}
trap clean_up EXIT

free_port() {   # from $1 on
  local port=$1
  while (: < "/dev/tcp/127.0.0.1/$port") 2> /dev/null; do
    port=$((port + 1))
  done
  echo "$port"
}

start_slurm() {
  local d=$work/slurm cores host port
  host=$(hostname -s)
  cores=$(nproc)
  port=$(free_port 16817)
  rm -rf "$d"
  mkdir -p "$d/state" "$d/spool"
  chmod 755 "$work" "$d"
  (umask 077; head -c 1024 /dev/urandom > "$d/munge.key")
  munged --foreground --force --key-file "$d/munge.key" \
    --socket "$d/munge.socket" --pid-file "$d/munged.pid" \
    --seed-file "$d/munge.seed" > "$work/munged.log" 2>&1 &
  daemons+=($!)
  cat > "$d/slurm.conf" << CONF
ClusterName=vanguard
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$port
SlurmdPort=$(free_port $((port + 1)))
AuthType=auth/munge
AuthInfo=socket=$d/munge.socket
CredType=cred/munge
SlurmUser=root
SlurmdUser=root
StateSaveLocation=$d/state
SlurmdSpoolDir=$d/spool
SlurmctldPidFile=$d/slurmctld.pid
SlurmdPidFile=$d/slurmd.pid
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerType=sched/backfill
SchedulerParameters=sched_interval=1,bf_interval=1,requeue_setup_env_fail
MpiDefault=none
ReturnToService=2
KillWait=20
NodeName=$host NodeAddr=127.0.0.1 CPUs=$cores State=UNKNOWN
PartitionName=all Nodes=$host Default=YES MaxTime=INFINITE State=UP
CONF
  export SLURM_CONF=$d/slurm.conf
  slurmctld -D -i > "$work/slurmctld.log" 2>&1 &
  daemons+=($!)
  slurmd -D > "$work/slurmd.log" 2>&1 &
  daemons+=($!)
  for _ in $(seq 100); do
    [ "$(sinfo -h -o %t 2> /dev/null || true)" != idle ] || return 0
    sleep 0.2
  done
  tail -n 5 "$work"/*.log >&2 || true
  skip "Slurm does not start on this host"
}

# submit NAME LAUNCHER: a job; its id.
submit() {
  LAUNCHER=$2 \
  PROJECT=$work/box OUT=$work/$1 VANGUARD=$vanguard \
    OPTIONS='--leaf-cells 30000' \
    OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 \
    sbatch --parsable --job-name "$1" --output "$work/$1.log" --ntasks 2 \
    --ntasks-per-node 2 --cpus-per-task $(($(nproc) > 1 ? $(nproc) / 2 : 1)) \
    --overcommit "$root/share/slurm/vanguard.sbatch"
}

state() { scontrol show job "$1" -o | sed -n 's/.* JobState=\([A-Z]*\) .*/\1/p'; }
await_end() {   # await_end JOB SECONDS: its last state
  local s=''
  for _ in $(seq "$2"); do
    s=$(state "$1")
    case $s in
      # Slurm delays a requeued job by two minutes; release it at once.
      PENDING) scontrol update jobid="$1" starttime=now > /dev/null 2>&1 ||
        true ;;
      RUNNING|COMPLETING|CONFIGURING|REQUEUED) ;;
      *) break ;;
    esac
    sleep 1
  done
  echo "$s"
}

start_slurm
echo "Slurm $(sinfo --version | cut -d' ' -f2), $(nproc) cores"
rm -f "$work"/box.*
"$vanguard" demo box --cells "$cells" --out "$work" > "$work/demo.log"

job=$(submit peace mpirun)
end=$(await_end "$job" 600)
[ "$end" = COMPLETED ] || die "the undisturbed job ended as $end"

told() {   # told NAME LAUNCHER
  local d=$work/$1 file n=0
  # Send the signal of --signal=B:USR1@120 as soon as a task has been kept,
  # without waiting for a time limit, which Slurm counts in minutes.
  job=$(submit "$1" "$2")
  for _ in $(seq 300); do
    [ "$(find "$d/box.run" -type f 2> /dev/null | wc -l)" -lt 6 ] || break
    sleep 0.1
  done
  scancel --batch --signal USR1 "$job"
  for _ in $(seq 60); do
    [ "$(state "$job")" = RUNNING ] || break
    sleep 1
  done
  grep -q 'asked to stop (limit)' "$d.log" ||
    die "the job ended before the signal: use more --cells"
  grep -q 'requeued' "$d.log" || die "$2: not requeued"
  end=$(await_end "$job" 900)
  [ "$end" = COMPLETED ] || die "$2: the resumed job ended as $end"
  grep -q 'continuing from' "$d.log" || die "$2: it did not continue"
  for file in "$work"/peace/box.*; do
    case $file in *.json|*.deck|*.html) continue ;; esac
    cmp "$file" "$d/${file##*/}" || die "$2: files differ"
    n=$((n + 1))
  done
  [ $n -ge 3 ] || die "only $n files were compared"
  [ ! -e "$d/box.run" ] || die "$2: the run directory is still there"
  echo "$2: requeued, continued, $n files the same"
}

told mpirun-job mpirun
if srun --mpi=list 2>&1 | grep -qw pmix; then
  told srun-job "srun --mpi=pmix --overcommit"
else
  echo "srun: not tried, this Slurm has no pmix"
fi

# The same with a portal (docs/reference/portal.md): its forms start, stop and
# resume a job.
await_run() {   # await_run STATE SECONDS
  local s=''
  for _ in $(seq "$2"); do
    s=$(curl -s "${url}runs.json" |
      sed -n 's/.*"state": "\([a-z]*\)".*/\1/p')
    [ "$s" != "$1" ] || return 0
    sleep 1
  done
  die "the run of the portal is $s, not $1"
}
post() {   # post PATH CURL-OPTION...
  curl -s -o "$work/body" -H "Origin: ${url%/*/}" "${@:2}" "$url$1"
}

by_portal() {
  local file n=0 run=$work/vanguard-runs/0001
  rm -rf "$work/vanguard-runs"
  "$vanguard" serve --port 0 --root "$work" >"$work/url" \
    2> "$work/serve.log" &
  daemons+=($!)
  for _ in $(seq 100); do
    [ ! -s "$work/url" ] || break
    sleep 0.1
  done
  url=$(cat "$work/url")
  [ -n "$url" ] || die "no portal: $(cat "$work/serve.log")"
  post runs -d project=box.lb8.ugrid -d where=slurm -d ranks=2 -d cpus=1 \
    -d s.leaf_cells=30000 -d time=00:10:00
  for _ in $(seq 300); do
    [ "$(find "$run/kept" -type f 2> /dev/null | wc -l)" -lt 6 ] || break
    sleep 0.1
  done
  await_run running 30
  post runs/1/stop -d x=
  await_run stopped 60
  post runs/1/resume -d x=
  await_run done 900
  for file in "$work"/peace/box.*; do
    case $file in *.json|*.deck|*.html) continue ;; esac
    cmp "$file" "$run/mesh/${file##*/}" || die "the portal's files differ"
    n=$((n + 1))
  done
  [ $n -ge 3 ] || die "only $n files were compared"
  echo "portal: stopped, resumed, $n files the same"
}
if command -v curl > /dev/null; then by_portal; fi
