#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# bench/scale.sh: does the cost of a cell stay constant in large meshes? The
# layered demo wing with a number of cells that grows by factors of four:
# seconds per million cells for each phase, and for each kind of task per
# million of the cells that it made. Other projects can be added, such as an
# aircraft with a refined surface.
#
# usage: bench/scale.sh [--threads N] [--fail SHARE] [--vanguard PROGRAM]
#          [--work DIR] [--out FILE] [MILLIONS | PROJECT]...
#   --threads   threads of the runs (default 2)
#   --fail      make this share of the leaves fail, and compare with no failures
#   --vanguard  the program (default build/release/bin/vanguard)
#   --work      scratch folder, kept (default: a temporary one, removed)
#   --out       write the table to FILE too (markdown)
#   MILLIONS    requested cells of the demo; half of them are outside the layers
#               (default 2 8 32; with layers 300 gives 565 M cells)
#   PROJECT     a stem with a "/" in it, as for vanguard mesh -p
# Exit status: 0 done, 1 a run failed, 2 usage. Needs: jq.
set -euo pipefail

root=$(cd "$(dirname "$0")/.." && pwd)
# shellcheck source=bench/common.sh
. "$root/bench/common.sh"
vanguard=$root/build/release/bin/vanguard threads=2 fail='' work=''
take_options "threads fail vanguard work out" "" "$@"
[ -x "$vanguard" ] || die "no program $vanguard: build it first"
need jq jq
work_folder scale
[ -z "$out" ] || : > "$out"
[ ${#cases[@]} -gt 0 ] || cases=(2 8 32)

{
  echo "| M cells | check | sizes | layers | fill | of it repairs | judge |" \
    "write | total | leaf | zone | join | memory, GB | smallest angle | parts" \
    "widened |"
  echo "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|"
} | say

# row STEM NAME: seconds per million cells of the mesh, for tasks per million of
# their own cells, for front updates per million cells outside the layers.
row() {
  jq -rn --slurpfile r "$1.report.json" --slurpfile t "$1.timeline.json" \
    --arg name "$2" '
    $r[0] as $r | $t[0] as $t | ($t.facts.cells / 1e6) as $n |
    ($t.columns | to_entries | map({(.value): .key}) | add) as $c |
    def cpu(k): [$t.spans[] | select(.[$c.kind] as $i | k | index($i))
                 | .[$c.cpu]] | add // 0;
    def made(k): ([$t.spans[] | select(.[$c.kind] as $i | k | index($i))
                  | .[$c.cells]] | add // 0) / 1e6;
    def per(s; m): if m > 0 then s / m * 1000 | round / 1000 else "-" end;
    $r.seconds as $s |
    ["\($n * 10 | round / 10)\($name)", per($s.check; $n), per($s.sizes; $n),
     per($s.layers // 0; $n), per($s.fill; $n),
     per($r.partition.repair_seconds; $n), per($s.judge; $n),
     per($s.write; $n), per($s.total; $n), per(cpu(["L"]); made(["L"])),
     per(cpu(["P", "T"]); made(["P", "T"])),
     per(cpu(["J"]); made(["L", "P", "T"])),
     ($r.peak_memory_bytes / 1e8 | round / 10),
     ($r.field.angle_min // $r.mesh.angle_min | . * 100 | round / 100),
     $r.partition.subdomains_extended] | "| " + (map(tostring) | join(" | ")) + " |"'
}

mesh() {   # mesh PROJECT NAME OPTION...
  local stem=$1 name=$2
  shift 2
  "$vanguard" mesh -q -p "$stem" --threads "$threads" --timeline \
    --write b8.ugrid --out "$work/files" "$@" > "$work/log" 2>&1 < /dev/null ||
    die "$stem: $(tail -1 "$work/log")"
  check_workers "$work/files/${stem##*/}.report.json" 1 "$threads"
  row "$work/files/${stem##*/}" "$name" | say
  rm -rf "$work/files"
}

for case in "${cases[@]}"; do
  stem=$case name=", ${case##*/}"
  if [[ $case =~ ^[0-9]+$ ]]; then
    rm -rf "$work/in"
    "$vanguard" demo wing --cells "${case}000000" --out "$work/in" \
      > "$work/log"
    stem=$work/in/wing name=""
  elif [[ $case != */* ]]; then
    usage >&2
    exit 2
  fi
  mesh "$stem" "$name"
  [ -z "$fail" ] ||
    mesh "$stem" "$name, leaves failed" --test-fail-leaves "$fail"
done
