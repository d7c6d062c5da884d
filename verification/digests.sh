#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# verification/digests.sh: digests of the meshes of twelve cases, made by one or
# two programs, to show that a change of the code leaves every byte unchanged.
#
# usage: verification/digests.sh [--vanguard PROGRAM] [--against PROGRAM]
#          [--data DIR] [--work DIR] [--out FILE] [CASE...]
#   --vanguard  the program (default build/release/bin/vanguard)
#   --against   a second program, such as that of the previous commit; without
#               it only the digests are printed
#   --data      folder of real geometry (verification/fetch.md)
#   --work      scratch folder, kept (default: a temporary one, removed)
#   --out       write the table to FILE too (markdown)
#   CASE        names or patterns: 'wing*' f16
# Exit status: 0 all equal, 1 a digest differs or a run failed, 2 usage.
set -euo pipefail

root=$(cd "$(dirname "$0")/.." && pwd)
# shellcheck source=bench/common.sh
. "$root/bench/common.sh"
# shellcheck source=bench/aircraft.sh
. "$root/bench/aircraft.sh"
vanguard=$root/build/release/bin/vanguard
against='' data='' work='' project='' options=()
take_options "vanguard against data work out" "" "$@"
[ -x "$vanguard" ] || die "no program $vanguard: build it first"
work_folder digests
[ -z "$out" ] || : > "$out"

# made PROGRAM: the digest of the mesh that PROGRAM makes for the case.
made() {
  rm -rf "$work/files"
  launch "$ranks" "$threads" "$1" mesh -q -p "$project" "${options[@]}" \
    --threads "$threads" --out "$work/files" > "$work/log" 2>&1 < /dev/null ||
    die "$name: $1: status $?: $(tail -1 "$work/log")"
  digest "$work/files"
}

{
  echo "| case | digest | other |"
  echo "|---|---|---|"
} | say
failed=0
while read -r name kind size ranks threads more; do
  wanted "$name" || continue
  case $kind in
    demo) demo_project "$size" 300000 "$work/input" ;;
    data) if [ -z "$data" ] || ! aircraft "$data" "$size" "$work/input"; then
            echo "SKIP $name: no file for it below --data" \
              "(verification/fetch.md)" >&2
            continue
          fi ;;
    vgrid) project=$data/vgrid_box/box options=()
           [ -n "$data" ] && [ -e "$project.d3m" ] || continue ;;
  esac
  read -ra extra <<< "$more"
  options+=("${extra[@]}")
  this=$(made "$vanguard") other=-
  if [ -n "$against" ]; then
    other=same
    [ "$(made "$against")" = "$this" ] || { other=DIFFERS; failed=1; }
  fi
  echo "| $name | $this | $other |" | say
done << 'CASES'
box demo box 1 2 --leaf-cells 20000 --write cogsg,b8.ugrid,vtu
sphere demo sphere 2 1 --leaf-cells 20000 --write lb8.ugrid
sphere_uncut demo sphere 1 1 --leaf-cells 0 --write foam
wing demo wing 1 2 --leaf-cells 50000 --write cogsg,b8.ugrid,vtu
wing_half demo wing-half 2 1 --cells mixed --write b8.ugrid,vtu
wing_sharp_half demo wing-sharp-half 1 2 --fan-angle 60 --write b8.ugrid
vgrid_box vgrid - 1 2 --write cogsg,b8.ugrid
dlr_f6 data dlr_f6_coarse 2 1 --leaf-cells 40000 --write b8.ugrid,vtu
onera_m6 data onera_m6 1 2 --cells mixed --write b8.ugrid,foam
falcon data falcon 1 2 --write b8.ugrid
f16 data f16 1 2 --leaf-cells 100000 --write b8.ugrid
tmx1242 data tmx1242 2 1 --cells mixed --leaf-cells 60000 --write b8.ugrid
CASES
exit $failed
