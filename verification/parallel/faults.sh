#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# verification/parallel/faults.sh: behaviour of runs that fail.
#
# usage: verification/parallel/faults.sh [--vanguard PROGRAM] [--cells N]
#          [--kills N] [--seed N] [--demo NAME] [--work DIR] [--out FILE]
#          [CASE...]
#   --vanguard  the program (default build/release/bin/vanguard)
#   --cells     cells of the demo (default 600000)
#   --demo      name of the demo (default box; wing has layers)
#   --kills     random times at which a rank is killed (default 5)
#   --seed      seed of the times (default: the clock; printed)
#   --work      scratch folder, kept (default: a temporary one, removed)
#   --out       write the table to FILE too
#   CASE        kill random signal full-out full-run no-run changed busy damaged
#               memory
#
# In each case the run ends by itself within a time limit, with a message and
# exit status 1 (or the signal that killed it), and leaves neither complete nor
# partial results. Then --resume on another number of ranks and threads writes
# the same files as an undisturbed run, and leaves no run directory. Full disks
# are small tmpfs, which need root; without root those cases are skipped by
# name.
# Exit status: 0 as expected, 1 a failure, 2 usage.
set -euo pipefail

root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=bench/common.sh
. "$root/bench/common.sh"
# shellcheck source=verification/parallel/runs.sh
. "$root/verification/parallel/runs.sh"
vanguard=$root/build/release/bin/vanguard
work='' cells=600000 kills=5 seed='' demo=box
take_options "vanguard cells kills seed demo work out" "" "$@"
RANDOM=${seed:=$(($(date +%s) % 32768))}
[ -x "$vanguard" ] || die "no program $vanguard: build it first"
command -v mpirun > /dev/null || skip "no mpirun"
work_folder faults
work=$(cd "$work" && pwd)
leaf=$((cells / 30))
mesh_options=(-p "$work/in/$demo" --leaf-cells "$leaf")
mounts=() failed=0

# shellcheck disable=SC2317 # a trap
clean_up() {
  local m
  for m in "${mounts[@]}"; do umount "$m" 2> /dev/null || true; done
  case $work in "${TMPDIR:-/tmp}"/vanguard-faults.*) rm -rf "$work" ;; esac
}
trap clean_up EXIT

# until_kept N: wait until N tasks are in the run directory, or the run ends.
until_kept() {
  while kill -0 "$pid" 2> /dev/null; do
    [ "$(find "$run_dir" -type f ! -name 'run.*' 2> /dev/null | wc -l)" \
      -lt "$1" ] || return 0
    sleep 0.02
  done
}
fresh() {   # fresh NAME: folders of a case
  case_name=$1 out_dir=$work/$1/out run_dir=$work/$1/run why=''
  rm -rf "${work:?}/$1"
  mkdir -p "$out_dir"
}
bad() { why="${why:+$why; }$*"; }
said() { grep -qaE "$1" "$work/log" || bad "the log does not mention '$1'"; }
ended() {   # ended STATUS...
  local s
  [ $hung = 0 ] || { bad "hung"; return; }
  for s; do [ "$status" != "$s" ] || return 0; done
  bad "exit status $status instead of $*"
}
nothing_written() {
  local left
  left=$(find "$out_dir" -mindepth 1 -maxdepth 1 -name "$demo.*" |
    sed 's|.*/||' | sort | tr '\n' ' ')
  [ -z "$left" ] || bad "there is ${left% }"
}
no_litter() {
  local left
  left=$(find "$1" -mindepth 1 -maxdepth 1 -name '.*' | sed 's|.*/||' |
    tr '\n' ' ')
  [ -z "$left" ] || bad "left behind: ${left% }"
}

# resume RANKS THREADS: continue the run; the files must equal those of the
# undisturbed run.
resume() {
  local how=()
  [ ! -e "$run_dir/run.txt" ] || how=(--resume)
  begin "$1" "$2" "${how[@]}"
  finish
  if [ "$status" != 0 ]; then
    bad "${how[*]:-again} on $1 x $2: exit status $status: $(message)"
    return
  fi
  [ "$(digest "$out_dir")" = "$whole" ] || bad "files differ on $1 x $2"
  [ ! -e "$run_dir" ] || bad "the run directory is still there"
  no_litter "$out_dir"
}
row() {   # row WHAT SAID
  echo "| $case_name | $1 | ${2:-} | ${why:-as expected} |" | say
  [ -z "$why" ] || failed=1
}
not_tried() { echo "| $case_name | $1 | | skipped: $2 |" | say; }

tmpfs() {   # tmpfs FOLDER OPTIONS: status 1 without the rights
  mkdir -p "$1"
  mount -t tmpfs -o "$2" tmpfs "$1" 2> /dev/null || return 1
  mounts+=("$1")
}
drop() {
  umount "$1"
  unset 'mounts[-1]'
}

case_kill() {   # kill the first, the middle and the last of three ranks
  local k victim said
  for k in 1 2 3; do
    fresh "kill-$k"
    begin 3 1
    until_kept $((4 * k))
    victim=$(ranks_of 3 | sed -n "${k}p")
    kill -9 "$victim" 2> /dev/null || bad "ended before it could be killed"
    finish
    [ $hung = 0 ] || bad "hung"
    [ "$status" != 0 ] || bad "exit status 0"
    said 'signal 9|Killed'
    nothing_written
    said=$(grep -am1 'signal 9' "$work/log" | cut -c1-70 || true)
    resume $((k % 2 + 1)) "$k"
    row "kill -9 of rank $((k - 1)) of 3" "$said"
  done
}

case_random() {
  local k ranks threads wait_s late=0 victims killed
  fresh random-time
  local from to
  from=$(date +%s%N)
  begin 2 1
  finish
  to=$(date +%s%N)
  for ((k = 1; k <= kills; k++)); do
    fresh "random-$k"
    ranks=$((RANDOM % 3 + 1)) threads=$((RANDOM % 2 + 1))
    wait_s=$(calc "$RANDOM / 32768 * $((to - from)) / 1e9")
    begin $ranks $threads
    until_open
    sleep "$wait_s"
    mapfile -t victims < <(ranks_of $ranks)
    # No result: the run had ended before.
    [ ${#victims[@]} = 0 ] ||
      kill -9 "${victims[RANDOM % ${#victims[@]}]}" 2> /dev/null || true
    finish
    killed=$status
    [ $hung = 0 ] || bad "hung"
    if [ "$status" = 0 ]; then
      late=$((late + 1))
      [ "$(digest "$out_dir")" = "$whole" ] || bad "files differ"
    else
      # Files get their names one after the other at the very end: complete
      # files may exist, partial ones never.
      local f
      for f in "$out_dir/$demo".*; do
        [ -e "$f" ] || continue
        case $f in *.json|*.deck) continue ;; esac
        cmp -s "$f" "$work/whole/out/${f##*/}" || bad "half-written ${f##*/}"
      done
      rm -rf "$out_dir"
      mkdir -p "$out_dir"
      resume $((RANDOM % 4 + 1)) $((RANDOM % 2 + 1))
    fi
    row "kill -9 of a rank of $ranks x $threads after $wait_s s" \
      "exit status $killed"
  done
  [ $late -lt "$kills" ] || echo "all kills came too late" >&2
}

case_signal() {
  local name ranks to kept
  for name in TERM USR1 INT; do
    for ranks in 1 2; do
      fresh "SIG$name-$ranks"
      begin $ranks 1
      until_kept 5
      # INT and TERM end mpirun and its ranks at once; mpirun forwards the USR1
      # of a batch system. A rank that receives TERM itself stops all ranks.
      to=$pid
      [ $name != TERM ] || to=$(ranks_of $ranks | tail -1)
      [ $name != INT ] || [ $ranks = 1 ] || continue
      # a shell starts background processes with INT ignored, but this program
      # handles it
      kill "-$name" "$to" 2> /dev/null || bad "ended before"
      finish
      ended 1
      said 'interrupted|stopped; finished tasks are kept'
      nothing_written
      no_litter "$out_dir"
      kept=$(message)
      [ -e "$run_dir/run.txt" ] || bad "no run directory"
      resume $((3 - ranks)) 2
      row "SIG$name on $ranks rank(s)" "$kept"
    done
  done
}

case_full_out() {
  local ranks kept size
  size=$(calc "int($(du -sk "$work/whole/out" | cut -f1) * 0.6)")
  for ranks in 1 2; do
    fresh "full-out-$ranks"
    if ! tmpfs "$out_dir" "size=${size}k"; then
      not_tried "full disk for the results" "no rights to mount"
      return
    fi
    begin $ranks 1
    finish
    ended 1
    said 'No space left|disk is full|disk full'
    nothing_written
    no_litter "$out_dir"
    kept=$(message)
    mount -o "remount,size=$((size * 4))k" "$out_dir"
    resume $((3 - ranks)) 1
    row "full disk for the results, $ranks rank(s)" "$kept"
    drop "$out_dir"
  done
}

case_full_run() {
  fresh full-run
  if ! tmpfs "$run_dir" "size=100k"; then
    not_tried "full disk for the run directory" "no rights to mount"
    return
  fi
  begin 2 1
  finish
  ended 0
  [ "$(digest "$out_dir")" = "$whole" ] || bad "files differ"
  said 'not all tasks were stored there'
  row "full disk for the run directory: the run goes on" \
    "$(sed -n 's/^  \(not all tasks were stored.*\)/\1/p' "$work/log")"
  drop "$run_dir"
}

case_no_run() {   # unusable run directories
  local kept
  fresh no-run-file
  : > "$run_dir"
  begin 2 1
  finish
  ended 1
  said "$run_dir"
  nothing_written
  row "a file instead of the run directory" "$(message)"

  fresh no-run-resume
  begin 2 1 --resume
  finish
  ended 1
  said "$run_dir"
  nothing_written
  row "--resume without a run directory" "$(message)"

  fresh no-run-damaged
  mkdir "$run_dir"
  echo rubbish > "$run_dir/run.txt"
  begin 2 1 --resume
  finish
  ended 1
  said 'damaged'
  nothing_written
  row "run.txt of another program" "$(message)"

  fresh no-run-readonly
  if tmpfs "$run_dir" "size=1m,ro"; then
    begin 2 1
    finish
    ended 1
    said 'cannot be written|Read-only'
    nothing_written
    kept=$(message)
    drop "$run_dir"
    row "a run directory that cannot be written" "$kept"
  else
    mkdir "$run_dir"
    chmod 000 "$run_dir"
    begin 2 1
    finish
    ended 1
    said 'cannot be|Permission'
    nothing_written
    chmod 755 "$run_dir"
    row "a run directory that cannot be read" "$(message)"
  fi
}

interrupt() {   # interrupt a run that has kept some tasks
  begin "$1" 1
  until_kept 6
  kill -USR1 "$pid" 2> /dev/null || bad "ended before"
  finish
}

case_changed() {
  local kept
  fresh changed
  interrupt 2
  begin 1 1 --resume --growth 1.37
  finish
  ended 1
  said 'input or options have changed'
  said 'growth was [0-9.]*, is 1.37'
  nothing_written
  kept=$(message)
  begin 1 1
  finish
  ended 1
  said 'finished tasks of this same run'
  resume 3 1   # no result is lost
  row "changed options with --resume; then without it; then as it was" "$kept"
}

case_busy() {
  local first
  fresh busy
  begin 2 1
  until_kept 2
  first=$pid
  local out_of_first=$out_dir
  out_dir=$out_dir.second
  begin 1 1
  finish
  ended 1
  said 'another run is using this directory'
  pid=$first out_dir=$out_of_first
  local kept
  kept=$(message)
  finish
  ended 0
  [ "$(digest "$out_dir")" = "$whole" ] || bad "files differ"
  row "a second run in the same run directory" "$kept"
}

case_damaged() {
  local f n=0
  fresh damaged
  interrupt 2
  while read -r f; do
    n=$((n + 1))
    case $((n % 3)) in
      0) truncate -s -7 "$f" ;;
      1) printf X | dd of="$f" bs=1 seek=$(($(stat -c %s "$f") / 2)) \
        conv=notrunc status=none ;;
      2) : > "$f" ;;
    esac
  done < <(find "$run_dir" -type f ! -name 'run.*' | sort | head -6)
  [ $n -gt 0 ] || bad "nothing was kept"
  resume 1 2
  row "$n records shortened, overwritten or emptied" ""
}

# One of two ranks gets less and less memory, until the memory is insufficient.
case_memory() {
  local limit_kb kept
  for ((limit_kb = 420000; limit_kb > 200000; limit_kb -= 20000)); do
    fresh memory
    cat > "$work/memory/limited" << LIMITED
#!/bin/bash
[ "\${OMPI_COMM_WORLD_RANK:-0}" = 0 ] || ulimit -v $limit_kb
exec "\$@"
LIMITED
    chmod +x "$work/memory/limited"
    mpirun --oversubscribe --bind-to none -n 2 "$work/memory/limited" \
      "$vanguard" mesh -q -p "$work/in/$demo" --out "$out_dir" --threads 1 \
      --leaf-cells "$leaf" --run-dir "$run_dir" > "$work/log" 2>&1 &
    pid=$!
    finish
    [ $hung = 0 ] || bad "hung"
    [ "$status" = 0 ] || break
  done
  if [ "$status" = 0 ]; then
    not_tried "no memory on one rank" "it had enough"
    return
  fi
  nothing_written
  kept=$(message)
  [ -n "$kept" ] || bad "no message"
  resume 1 1
  row "no memory on one rank of 2, above $limit_kb kB" "$kept"
}

[ -z "$out" ] || : > "$out"
rm -rf "$work/in"
"$vanguard" demo "$demo" --cells "$cells" --out "$work/in" > /dev/null
fresh whole
begin 1 2
finish
[ "$status" = 0 ] || die "the undisturbed run failed: $(message)"
whole=$(digest "$out_dir")
say << HEAD
$demo, $(sed -n '/^  "mesh": {/,/^  }/s/^    "cells": \([0-9]*\).*/\1/p' "$out_dir/$demo.report.json") cells; seed $seed. Bar: each run ends by itself, with a message and status 1 (but where the run goes on), nothing half-written; resumed on other ranks and threads it writes the same files.

| case | what | message | result |
|---|---|---|---|
HEAD
for name in kill random signal full-out full-run no-run changed busy damaged \
  memory; do
  wanted $name || continue
  case $name in
    kill) case_kill ;;
    random) case_random ;;
    signal) case_signal ;;
    full-out) case_full_out ;;
    full-run) case_full_run ;;
    no-run) case_no_run ;;
    changed) case_changed ;;
    busy) case_busy ;;
    damaged) case_damaged ;;
    memory) case_memory ;;
  esac
done
exit $failed
