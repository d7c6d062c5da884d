#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# verification/parallel/memory.sh: memory of a large mesh with layers, on one
# rank and on several.
#
# usage: verification/parallel/memory.sh [--quick] [--build DIR] [--cells N]
#          [--least N] [--ranks LIST] [--work DIR] [--out FILE]
#   --quick  a mesh of 2 million cells
#   --build  build folder (default build/release, built if missing)
#   --cells  cells of the demo "wing" without its layers (default 14000000; 56
#            million with layers)
#   --least  least number of cells in total (default 50000000)
#   --ranks  numbers of ranks (default "1 2 4"); the ranks share the cores
#   --work   scratch folder, kept (default: a temporary one, removed)
#   --out    write the table to FILE too (markdown)
#
# Requirements: all ranks together within 24 GiB; each rank within its share of
# 1.3 x 150 bytes per cell, plus 30 MB for program and MPI, plus the part that
# the ranks of a node share (surface, layers, sizing field), as forecast by
# vanguard plan. A peak above 200 MB is within 25 % of its forecast. Peaks are
# resident memory: of the largest process as measured by the system, and of the
# sum as reported by the ranks.
# Exit status: 0 all requirements met, 1 one missed or a run failed, 2 usage.
# Needs: jq, time, openmpi-bin. By default about 3 minutes on two cores, and 2
# GB of disk.
set -euo pipefail

root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=bench/common.sh
. "$root/bench/common.sh"
# shellcheck source=bench/aircraft.sh
. "$root/bench/aircraft.sh"
build=$root/build/release
work='' cells='' least='' ranks='1 2 4' quick=0 project='' options=() failed=0
take_options "build cells least ranks work out" quick "$@"
if [ "$quick" = 1 ]; then cells=${cells:-250000} least=${least:-1000000}; fi
: "${cells:=14000000}" "${least:=50000000}"
to_measure memory
[ -z "$out" ] || : > "$out"

demo_project wing "$cells" "$work/input"
"$vanguard" plan -q -j -n 1 -p "$project" > "$work/plan.json"
shared=$(get "$work/plan.json" '(.memory.shared + 30e6) / 1048576')
say << HEAD
Vanguard $("$vanguard" --version | awk 'NR == 1 { print $2 }'), $(nproc) cores, $(date -u +%Y-%m-%d); wing with layers; shared part $(calc "int($shared + 0.5)") MB. Bars: all ranks 24576 MB, a rank 1.3 x 150 bytes x cells / ranks + shared part.

| ranks x threads | cells | s | peak of a rank, MB | bar | beside the shared part, bytes per cell of a rank | forecast, MB | all ranks, MB | bars |
|---|---|---|---|---|---|---|---|---|
HEAD
for n in $ranks; do
  threads=$(($(nproc) > n ? $(nproc) / n : 1))
  run_mesh "$vanguard" "$work/run" "$n" "$threads" -p "$project" \
    --write b8.ugrid ||
    die "$n x $threads failed: $(grep -a '^vanguard' "$work/run/log" | tail -1)"
  rm -f "$work"/run/out/*.ugrid
  "$vanguard" plan -q -j -n "$n" -t "$threads" -p "$project" \
    --write b8.ugrid > "$work/forecast.json"
  forecast=$(get "$work/forecast.json" '.forecast[0].memory_bytes / 1048576')
  line=$(jq -r --argjson n "$n" --argjson t "$threads" \
    --argjson shared "$shared" --argjson least "$least" \
    --argjson forecast "$forecast" '
    (.cells / $n / 1048576) as $share | ($shared + 195 * $share) as $bar |
    ([if .cells < $least then "too few cells" else empty end,
      if .valid then empty else "not valid" end,
      if .peak_mb > $bar then "a rank" else empty end,
      if .peak_mb > 200 and ($forecast / .peak_mb - 1 | fabs) > 0.25
      then "forecast" else empty end,
      if .memory_mb > 24576 then "all ranks" else empty end] |
     join(", ")) as $missed |
    "| \($n) x \($t) | \(.cells) | \(.wall | round) | \(.peak_mb | round) | " +
    "\($bar | round) | \((.peak_mb - $shared) / $share | round) | " +
    "\($forecast | round) | \(.memory_mb | round) | " +
    "\(if $missed == "" then "kept" else "missed: " + $missed end) |"' \
    "$work/run/row.json")
  echo "$line" | say
  case $line in *missed*) failed=1 ;; esac
done
exit $failed
