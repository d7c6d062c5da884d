#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# verification/helgrind.sh: every module with threads under valgrind's helgrind.
#
# usage: verification/helgrind.sh [--vanguard PROGRAM] [--seconds N] [--threads N]
#          [--work DIR] [--out FILE] [CASE...]
#   --vanguard  the program (default build/release/bin/vanguard)
#   --seconds   limit of each case (default 600)
#   --threads   (default 3)
#   --work      scratch folder, kept (default: a temporary one, removed)
#   --out       write the table to FILE too (markdown)
#   CASE        names or patterns; default: all
#
# Helgrind reports accesses of several threads to the same memory without a lock
# between them, locks in an order that can block, and wrong use of POSIX threads.
# It sees the order of events by calls of POSIX threads alone: what atomic
# variables order looks like a race to it. verification/helgrind.supp lists these
# places, each with its reason. ThreadSanitizer, which knows atomic variables, runs
# on the tests (.ci/run).
#
# Cases: `layers` has the surface check, the sizing field, layers, the engine, the
# fill, judge, slices, pictures and solver partitions; `octree` and `discrete` the
# decompositions before the fill; `whole` another mesher in its process; `remesh`
# remeshing; `metric` metrics at points; `repair` the surface of a wrap; `resume`
# the run directory; `check` a mesh in a file.
# Exit status: 0 no report, 1 a report, or a run that failed or did not end, 2
# usage, 77 no valgrind.
set -euo pipefail

root=$(cd "$(dirname "$0")/.." && pwd)
# shellcheck source=bench/common.sh
. "$root/bench/common.sh"
vanguard=$root/build/release/bin/vanguard seconds=600 threads=3 work='' failed=0
take_options "vanguard seconds threads work out" "" "$@"
command -v valgrind > /dev/null || skip "needs valgrind"
[ -x "$vanguard" ] || die "no program $vanguard: build it first"
vanguard=$(realpath "$vanguard")
work_folder helgrind
[ -z "$out" ] || : > "$out"
# shellcheck source=tests/faults/shapes.sh
. "$root/tests/faults/shapes.sh"
cd "$work"
octahedron > body.obj
defects > defects.stl
for form in b8.ugrid mesh; do
  "$vanguard" mesh -q --threads 1 -p body.obj --growth 2 --write $form \
    --out given_$form > given.out
done
awk -f "$root/tests/faults/metric.awk" given_mesh/body.mesh > given_mesh/body.sol

# run CASE ARGUMENT...: one run of the program, and a row of the table.
run() {
  local name=$1 status=0 reports started=$SECONDS
  shift
  wanted "$name" || return 0
  rm -f "$name".log.*
  timeout "$seconds" valgrind --tool=helgrind --num-callers=24 \
    --suppressions="$root/verification/helgrind.supp" \
    --log-file="$name.log.%p" "$vanguard" "$@" > "$name.out" 2>&1 || status=$?
  reports=$(cat "$name".log.* | awk '/ERROR SUMMARY:/ { n += $4 }
    END { print n + 0 }')
  echo "| $name | $((SECONDS - started)) | $status | $reports |" | say
  [ "$status$reports" = 00 ] || failed=1
}

mesh() {
  local name=$1
  shift
  run "$name" mesh -q --threads "$threads" -p body.obj --growth 2 --write b8.ugrid \
    --out "$name" "$@"
}

{ build=${vanguard%/bin/*} about_machine
  echo
  echo "| case | seconds | status | reports |"
  echo "|---|---|---|---|"
} | say
mesh layers --first 0.05 --layer-count 2 --leaf-cells 400 --solver-parts 2 \
  --write b8.ugrid,pvtu,cogsg
mesh octree --decompose octree --subdomains 4
mesh discrete --decompose discrete --subdomains 4
mesh whole --mesher tetgen
mesh remesh --remesh-surface yes --surface-size 0.5
mesh metric --sizes given_mesh/body.sol
run repair mesh -q --threads "$threads" -p defects.stl --growth 2 --close-holes yes \
  --write b8.ugrid --out repair
mesh resume --leaf-cells 400 --run-dir kept --keep-run
mesh resume --leaf-cells 400 --run-dir kept --keep-run --resume
run check check -q --threads "$threads" given_b8.ugrid/body.b8.ugrid
exit $failed
