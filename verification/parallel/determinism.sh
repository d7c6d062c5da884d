#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# verification/parallel/determinism.sh: the same files for any number of ranks
# and threads, any order of the tasks, and runs resumed after kill -9.
#
# usage: verification/parallel/determinism.sh [--quick] [--vanguard PROGRAM]
#          [--data DIR] [--cells N] [--leaves N] [--ranks LIST]
#          [--threads LIST] [--decompose LIST] [--kills N] [--seed N]
#          [--work DIR] [--out FILE] [CASE...]
#   --quick     small: 60,000 cells (the wing more, but few layers), 1 and 2
#               ranks and threads, one kill, no aircraft
#   --vanguard  the program (default build/release/bin/vanguard)
#   --data      folder of real geometry (verification/fetch.md), for aircraft
#   --cells     cells of box, sphere and wing without its layers (default
#               600000; the wing has at least 250000)
#   --leaves    approximate number of subdomains (default 24)
#   --ranks     default "1 2 4 7"
#   --threads   default "1 2 3"
#   --decompose  default advancing; also discrete, octree
#   --kills     runs of each case that are killed and resumed (default 5)
#   --seed      seed of orders, times and victims (default: the clock; printed)
#   --work      scratch folder, kept (default: a temporary one, removed)
#   --out       write the table to FILE too (markdown)
#   CASE        box sphere wing dlr_f6_coarse tmx1242 falcon; the wing and the
#               aircraft have viscous layers, tmx1242 with mixed cells
#
# For each case: first one rank, one thread, most expensive task first. Then all
# ranks x threads, each with a different order of tasks. Then runs in which one
# rank is killed at a random time; they are resumed on another number of ranks
# and threads, and may be killed again, until one ends. Requirement: every file
# except report and resolved deck is the same, byte for byte, in all of them. A
# kill that comes after the end is repeated at an earlier time. The whole grid
# takes less than 20 minutes on two idle cores; 96 leaves, so that lattices of
# planes are among the cuts:
#   verification/parallel/determinism.sh --data DIR --cells 2000000 \
#     --leaves 96 --kills 2 box sphere wing dlr_f6_coarse tmx1242
# Exit status: 0 all equal, 1 a difference or failure, 2 usage, 77 no mpirun.
set -euo pipefail

root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=bench/common.sh
. "$root/bench/common.sh"
# shellcheck source=bench/aircraft.sh
. "$root/bench/aircraft.sh"
# shellcheck source=verification/parallel/runs.sh
. "$root/verification/parallel/runs.sh"
vanguard=$root/build/release/bin/vanguard
work='' data='' cells='' leaves=24 ranks='' threads='' kills='' seed='' quick=0
project='' options=() decompose=advancing
take_options "vanguard data cells leaves ranks threads decompose kills seed \
  work out" quick "$@"
if [ "$quick" = 1 ]; then
  data='' cells=${cells:-60000} ranks=${ranks:-1 2} threads=${threads:-1 2}
  kills=${kills:-1}
fi
: "${cells:=600000}" "${ranks:=1 2 4 7}" "${threads:=1 2 3}" "${kills:=5}"
RANDOM=${seed:=$(($(date +%s) % 32768))}
[ -x "$vanguard" ] || die "no program $vanguard: build it first"
command -v mpirun > /dev/null || skip "no mpirun"
work_folder determinism
work=$(cd "$work" && pwd)
read -ra ranks <<< "$ranks"
read -ra threads <<< "$threads"
out_dir=$work/files run_dir='' failed=0
[ -z "$out" ] || : > "$out"

any() { local list=("$@"); echo "${list[RANDOM % $#]}"; }
fact() {   # fact BLOCK KEY: a number of a block of the report
  sed -n "/^  \"$1\": {/,/^  }/s/^    \"$2\": \([0-9]*\),*\$/\1/p" \
    "$out_dir"/*.report.json
}

# whole RANKS THREADS OPTION...: a complete run; sets its digest `this`.
whole() {
  rm -rf "$out_dir"
  begin "$@"
  finish
  [ $hung = 0 ] || die "$name: $1 x $2 hung"
  [ "$status" = 0 ] || die "$name: $1 x $2: status $status: $(message)"
  this=$(digest "$out_dir")
}

differs() {   # differs HOW
  [ "$this" != "$first" ] || return 0
  bad="$bad${bad:+, }$1"
  failed=1
}

shuffled() {
  local r t order
  for r in "${ranks[@]}"; do
    for t in "${threads[@]}"; do
      order=$((RANDOM + 1))
      whole "$r" "$t" --shuffle-tasks $order
      n_run=$((n_run + 1))
      differs "$r x $t (order $order)"
    done
  done
}

kept() {   # tasks in the run directory
  { find "$run_dir/records" -type f 2> /dev/null || true; } | wc -l
}

# A run that is killed once or several times, each time with other numbers of
# ranks and threads; sets the digest `this` of the result.
killed() {
  local r t how wait_s victims within=$1 chain=''
  run_dir=$work/run
  rm -rf "$run_dir" "$out_dir"
  while :; do
    r=$(any "${ranks[@]}") t=$(any "${threads[@]}") how=()
    [ ! -e "$run_dir/run.txt" ] || how=(--resume)
    wait_s=$(calc "$within * (0.05 + 0.9 * $RANDOM / 32768)")
    rm -rf "$out_dir" "$run_dir/run.lock"
    begin "$r" "$t" "${how[@]}"
    # one of three is killed again
    if [ -z "$chain" ] || [ $((RANDOM % 3)) = 0 ]; then
      until_open
      sleep "$wait_s"
      mapfile -t victims < <(ranks_of "$r")
      [ ${#victims[@]} = 0 ] ||
        kill -9 "$(any "${victims[@]}")" 2> /dev/null || true
    fi
    finish
    [ $hung = 0 ] || die "$name: killed on $r x $t: the others hung"
    if [ "$status" = 0 ]; then
      if [ -z "$chain" ]; then   # too late
        within=$(calc "$within / 2")
        continue
      fi
      break
    fi
    said=$(message)
    [ -z "$said" ] || die "$name: $r x $t: $said"
    n_kill=$((n_kill + 1))
    n_kept=$((n_kept + $(kept)))
    chain="$chain $r x $t for $(printf %.2f "$wait_s") s,"
  done
  this=$(digest "$out_dir")
  run_dir=''
  [ ! -e "$work/run" ] || bad="$bad${bad:+, }run directory still there"
  differs "killed:$chain then $r x $t"
}

one_case() {   # one_case WAY
  local from to n way=$1
  n=$(get_cells)
  mesh_options=(-p "$project" "${options[@]}" --leaf-cells $((n / leaves))
    --decompose "$way")
  bad='' first='' n_run=1 n_kill=0 n_kept=0
  from=$(date +%s%N)
  whole 1 1
  to=$(date +%s%N)
  first=$this
  local made parts
  made=$(fact mesh cells) parts=$(fact partition leaves)
  shuffled
  for ((k = 0; k < kills; k++)); do
    killed "$(calc "($to - $from) / 1e9")"
  done
  echo "| $name, $way | $made | $parts | $n_run | $kills | $n_kill | $n_kept |" \
    "$first | ${bad:-none} |" | say
  rm -rf "$out_dir"
}

# Expected cells outside the layers, for the size of a leaf.
get_cells() {
  "$vanguard" plan -p "$project" "${options[@]}" -q -j -n 1 > "$work/plan.json" ||
    die "$name: no forecast"
  sed -n 's/^    "field_cells": \([0-9]*\).*/\1/p' "$work/plan.json"
}

say << HEAD
Vanguard $("$vanguard" --version | awk 'NR == 1 { print $2 }'), $(nproc) cores, $(date -u +%Y-%m-%d); ranks ${ranks[*]}, threads ${threads[*]}, each with tasks in another order; seed $seed. Bar: no run differs.

| case | cells | leaves | runs to the end | runs killed and resumed | kills | tasks found again | digest | runs that differ |
|---|---|---|---|---|---|---|---|---|
HEAD
tried=0
for name in box sphere wing dlr_f6_coarse tmx1242 falcon; do
  wanted $name || continue
  case $name in
    wing)
      demo_project wing $((cells < 250000 ? 250000 : cells)) "$work/input"
      [ "$quick" = 0 ] || options+=(--layer-count 5) ;;
    box|sphere) demo_project $name "$cells" "$work/input" ;;
    *)
      if [ -z "$data" ] || ! aircraft "$data" $name "$work/input"; then
        [ "$quick" = 1 ] ||
          echo "SKIP $name: no file for it below --data" \
            "(verification/fetch.md)" >&2
        continue
      fi
      [ $name != tmx1242 ] || options+=(--cells mixed) ;;
  esac
  tried=1
  for way in $decompose; do one_case "$way"; done
done
[ $tried = 1 ] || die "no such case, or no data for it; see --help and verification/fetch.md"
exit $failed
