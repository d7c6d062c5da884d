#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# verification/metric/run.sh: the adaptation benchmarks of the Unstructured Grid
# Adaptation Working Group, by the program `vanguard` from a file of metrics.
#
# usage: verification/metric/run.sh [--build DIR] [--work DIR] [--out FILE]
#                                   [--data DIR] [--threads N] [--quick]
#                                   [CASE...]
#   --build    build folder with vanguard and vg_bench_metric (build/release)
#   --work     folder for the results (default: a temporary one)
#   --out      write the table to FILE too
#   --data     folder of real geometry (verification/fetch.md), for the cases
#              on the cube without the cylinder
#   --threads  threads (default 1, as in the published times)
#   --quick    complexity 5,000 alone, as a test
#   CASE       names such as polar2-500000 (default: all)
#
# Each case starts from the boundary alone: twelve triangles, or the STEP file.
# vg_bench_metric writes a background mesh with the analytic metric at its
# points, vanguard remeshes the surface and fills it, and vg_bench_metric
# measures the mesh in the analytic metric (bench/metric_cases.h). The time is
# that of the run from the first to the last file, without pictures.
#
# Requirements: a valid mesh; for polar2 at 500,000, 96 % of the edges within
# 0.71 to 1.41, none outside 0.3 to 3, a mean of the mean ratios of 0.80, none
# below 0.1. Exit status 0 if all are met.
set -euo pipefail

root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=bench/common.sh
. "$root/bench/common.sh"
build=$root/build/release work='' data='' threads=1 quick=
take_options "build work out data threads" "quick" "$@"
need jq jq
make_programs "$build" vanguard vg_bench_metric
vanguard=$build/bin/vanguard tool=$build/bin/vg_bench_metric
work_folder metric
[ -z "$out" ] || : >"$out"

# The results of UGAWG/parallel-adapt-results for polar2 at 500,000, evaluated
# from their histograms; times are of one core.
published='| refine | 500000 | - | - | - | 87.5 % | 98.9 % | - | 0.27 .. 2.1 | 0.777, 0.099, -, 0.013 % | 5520 to 8358 |
| EPIC | 500000 | - | - | - | 86.5 % | 99.7 % | - | 0.16 .. 2.5 | 0.728, 0.010, -, 0.59 % | - |
| FeFlo.a | 500000 | - | - | - | 96.4 % | 99.6 % | - | 0.03 .. 19 | 0.753, 0.016, -, 1.6 % | 44, from 50000 |
| CDT3D | 500000 | - | - | - | 79.6 % | 99.9 % | - | 0.20 .. 4.5 | 0.753, 0.094, -, 0.049 % | 1225 to 1384 |'

# The unit cube, two triangles on each side.
write_cube() { # FILE
  awk 'BEGIN {
    for (p = 0; p < 8; p++) print "v", p % 2, int(p / 2) % 2, int(p / 4)
    split("1 2 4 1 2", bit, " ")
    for (axis = 1; axis <= 3; axis++)
      for (side = 0; side < 2; side++) {
        u = bit[axis + 1]; v = bit[axis + 2]; o = 1 + side * bit[axis]
        print "g side" 2 * axis + side
        a = side ? o + u : o + v; b = side ? o + v : o + u
        print "f", o, a, o + u + v
        print "f", o, o + u + v, b
      } }' >"$1"
}

mesh() { # NAME CASE COMPLEXITY SURFACE
  local in=$work/$1
  mkdir -p "$in"
  "$tool" "$2" "$3" --background "$in/background"
  # The metric itself is requested: growth does not limit it.
  "$vanguard" mesh -q --json -p "$4" --flow internal --layers no \
    --remesh-surface yes --surface-sizes no --growth 2 --hmax 1 \
    --sizes "$in/background.sol" --write meshb --report-html no \
    --threads "$threads" --out "$in/out" >"$in/report.json" 2>"$in/log"
}

judge() { # NAME ROW
  [[ $1 = polar2-500000 ]] || return 0
  awk -F'|' '{
    split($11, q, ",")
    if ($7 + 0 < 96) print "  edges in [0.71, 1.41]"
    if ($9 + 0 > 0) print "  edges outside [0.3, 3]"
    if (q[1] + 0 < 0.8) print "  mean ratio"
    if (q[3] + 0 > 0) print "  cells below 0.1" }' <<<"$2"
}

failed=0
run_case() { # NAME CASE COMPLEXITY SURFACE
  local row seconds missed in=$work/$1
  wanted "$1" || return 0
  if ! mesh "$@"; then
    echo "| $2 | $3 | failed: $(tail -1 "$in/log") |" | say
    failed=1
    return
  fi
  seconds=$(jq '.seconds.total' "$in/report.json")
  row=$("$tool" "$2" "$3" --measure "$in"/out/*.meshb --seconds "$seconds")
  echo "$row" | say
  missed=$(judge "$1" "$row")
  if [ -n "$missed" ]; then
    echo "missed by $1:" && echo "$missed"
    failed=1
  fi
}

complexities='50000 500000'
[ -z "$quick" ] || complexities=5000
write_cube "$work/cube.obj"
"$tool" --head | say
for complexity in $complexities; do
  for case in linear polar1 polar2; do
    run_case "$case-$complexity" "$case" "$complexity" "$work/cube.obj"
  done
done
if [ -d "$data" ] && [ -z "$quick" ]; then
  for case in polar1 polar2; do
    run_case "$case-cylinder-50000" "$case-cylinder" 50000 \
      "$data/simple/cube_cylinder.step"
  done
fi
echo "$published" | say
exit $failed
