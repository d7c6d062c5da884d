#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# verification/decompositions.sh: all decompositions: every mesh must be valid;
# cells, balance and angles are compared with the advancing partition.
#
# usage: verification/decompositions.sh [--vanguard PROGRAM]
#          [--meshcheck PROGRAM] [--data DIR] [--work DIR] [--out FILE]
#          [--parts LIST] [--ways LIST] [--partitioners LIST] [--bare]
#          [CASE...]
#   --vanguard   the program (default build/release/bin/vanguard)
#   --meshcheck  an independent checker, called with one .lb8.ugrid file
#   --data       folder of real geometry (verification/fetch.md)
#   --work       scratch folder, kept (default: a temporary one, removed)
#   --out        write the table to FILE too (markdown)
#   --parts      numbers of subdomains (default "4 16 100")
#   --ways       some of advancing, octree, remesh, h-refine; the last two are
#                the interfaces of the discrete decomposition (default: all)
#   --partitioners  default "metis rcb"
#   --bare       aircraft without layers
#   CASE         names or patterns of the table at the end
# Exit status: 0 all valid, 1 a mesh is invalid or a run failed, 2 usage.
set -euo pipefail

root=$(cd "$(dirname "$0")/.." && pwd)
# shellcheck source=bench/common.sh
. "$root/bench/common.sh"
# shellcheck source=bench/aircraft.sh
. "$root/bench/aircraft.sh"
vanguard=$root/build/release/bin/vanguard
meshcheck='' data='' work='' project='' parts='4 16 100' options=()
ways='advancing octree remesh h-refine' partitioners='metis rcb'
bare=0
take_options "vanguard meshcheck data work out parts ways partitioners" bare \
  "$@"
[ -x "$vanguard" ] || die "no program $vanguard: build it first"
work_folder decompositions
[ -z "$out" ] || : > "$out"

need jq jq

# Cells outside the layers, maximum over mean of leaves, triangles of
# interfaces, 1st percentile of the smallest angle of these cells and of those
# within two rings of interfaces, subdomains filled together with others.
row='[(.partition | (.leaf_cells | add) + .fragment_cells + .separator_cells
  + .repair_cells), (.partition.balance * 1000 | round / 1000),
  .partition.decomposition.interface_triangles // 0,
  (.field // .mesh).angle_min_p1,
  .partition.near_interfaces.angle_min_p1 // "-",
  .partition.subdomains_extended] | map(tostring) | join(" | ")'

# try WAY OPTIONS...: mesh and check the case; prints a row of the table.
failed=0
try() {
  local way=$1 verdict=valid figures=' | | | | | '
  shift
  rm -rf "$work/files"
  if ! "$vanguard" mesh -q -p "$project" "${options[@]}" "$@" \
       --timeline --write lb8.ugrid --out "$work/files" > "$work/log" 2>&1 < /dev/null
  then verdict="FAILED: $(tail -1 "$work/log")"
  elif ! "$vanguard" check -q "$work"/files/*.lb8.ugrid > "$work/log" 2>&1
  then verdict="NOT VALID"
  elif [ -n "$meshcheck" ] &&
       ! "$meshcheck" -q "$work"/files/*.lb8.ugrid > "$work/log" 2>&1
  then verdict="meshcheck: $(tail -1 "$work/log")"; fi
  [ "$verdict" = valid ] || failed=1
  ! ls "$work"/files/*.report.json > /dev/null 2>&1 ||
    figures=$(jq -r "$row" "$work"/files/*.report.json)
  echo "| $name | $way | $verdict | $figures |" | say
}

{
  echo "| case | decomposition | verdict | cells outside layers | balance |" \
    "interface triangles | 1st percentile | near interfaces | parts widened |"
  echo "|---|---|---|---|---|---|---|---|---|"
} | say
while read -r name kind size; do
  wanted "$name" || continue
  case $kind in
    demo) demo_project "$name" "$size" "$work/input" ;;
    data) if [ -z "$data" ] || ! aircraft "$data" "$name" "$work/input"; then
            echo "SKIP $name: no file for it below --data" \
              "(verification/fetch.md)" >&2
            continue
          fi
          options+=(--cells mixed)   # a third of the cells to check
          [ "$bare" = 0 ] || options+=(--layers no) ;;
  esac
  for way in $ways; do
    case $way in
      advancing) try advancing --leaf-cells 30000
        continue ;;
      octree) how=(--decompose octree) ;;
      *) how=(--decompose discrete --interfaces "$way") ;;
    esac
    for n in $parts; do
      for partitioner in $partitioners; do
        try "$way $n $partitioner" "${how[@]}" --subdomains "$n" \
          --partitioner "$partitioner"
      done
    done
  done
done << END
box demo 200000
sphere demo 200000
wing-half demo 200000
wing demo 200000
dlr_f6_coarse data -
falcon data -
low_boom data -
30p30n_coarse data -
END
exit "$failed"
