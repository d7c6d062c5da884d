#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# verification/openfoam/parts.sh: does decomposePar accept the partitions of a
# mesh, with the numbers of cells and faces that Vanguard reports?
#
# usage: verification/openfoam/parts.sh [--vanguard PROGRAM] [--work DIR]
#            [--parts N]
# A demo wing-half with layers in N partitions (default 6), made by `vanguard
# mesh --solver-parts` with tetrahedra and by `vanguard partition` with prisms.
# Exit status: 0 accepted, 1 a failure, 2 usage, 77 no OpenFOAM.
set -uo pipefail
export LC_ALL=C

here=$(cd "$(dirname "$0")" && pwd)
vanguard=$here/../../build/release/bin/vanguard work='' parts=6
while [ $# -gt 1 ]; do
  case $1 in
    --vanguard|--work|--parts) declare "${1#--}=$2"; shift 2 ;;
    *) sed -n '2,/^# Exit status/p' "$0" | sed 's/^# \{0,1\}//' >&2; exit 2 ;;
  esac
done
[ $# = 0 ] || { sed -n '2,/^# Exit status/p' "$0" >&2; exit 2; }

if ! command -v decomposePar > /dev/null; then
  echo "SKIP: no OpenFOAM (decomposePar is not in PATH)"
  exit 77
fi
if [ -z "${WM_PROJECT_DIR:-}" ]; then
  set +u
  # shellcheck disable=SC1090
  . "${FOAM_BASHRC:-/usr/share/openfoam/etc/bashrc}" 2> /dev/null
  set -u
fi
if ! decomposePar -help > /dev/null 2>&1; then
  echo "SKIP: OpenFOAM does not start; source its etc/bashrc first"
  exit 77
fi
vanguard=$(realpath "$vanguard") || exit 2
if [ -z "$work" ]; then
  work=$(mktemp -d) || exit 1
  trap 'rm -rf "$work"' EXIT
fi
mkdir -p "$work" && cd "$work" || exit 1
failures=0

bad() { echo "FAILED: $*"; failures=$((failures + 1)); }

# figure REPORT NAME: an integer of a JSON report.
figure() { sed -n "s/.*\"$2\": \([0-9]*\).*/\1/p" "$1" | head -1; }

# check CASE REPORT: decomposePar agrees with the report.
check() {
  local log=$1.log faces cells most
  if ! decomposePar -case "$1" > "$log" 2>&1; then
    bad "decomposePar refused $1"
    grep -A5 'FATAL' "$log"
    return
  fi
  faces=$(sed -n 's/^Number of processor faces = //p' "$log")
  cells=$(sed -n 's/^ *Number of cells = //p' "$log" | sort -n | tail -1)
  most=$(sed -n 's/^Max number of faces between processors = \([0-9]*\).*/\1/p' \
    "$log")
  echo "$1: $faces faces between parts, $most on one, $cells cells at most"
  [ "$faces" = "$(figure "$2" cut_faces)" ] || bad "$1: faces between parts"
  [ "$most" = "$(figure "$2" most_cut_faces)" ] || bad "$1: largest border"
  [ "$cells" = "$(figure "$2" most_cells)" ] || bad "$1: cells of a part"
}

"$vanguard" demo wing-half --cells 20000 --out p > /dev/null || exit 1
"$vanguard" mesh -q -p p/wing-half --first 0.001 --layer-count 6 \
  --solver-parts "$parts" --write foam --out tets > /dev/null ||
  bad "vanguard mesh"
check tets/wing-half.openfoam tets/wing-half.report.json
"$vanguard" mesh -q -p p/wing-half --first 0.001 --layer-count 6 --cells mixed \
  --write lb8.ugrid --out mixed > /dev/null || bad "vanguard mesh"
"$vanguard" partition -q mixed/wing-half.lb8.ugrid -n "$parts" --json \
  --write foam > mixed/parts.json || bad "vanguard partition"
check mixed/wing-half.openfoam mixed/parts.json
[ "$failures" = 0 ] && echo good
[ "$failures" = 0 ]
