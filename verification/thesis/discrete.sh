#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# verification/thesis/discrete.sh: the discrete decomposition on the cases of
# the thesis, with and without viscous layers, compared with the octree-guided
# decomposition and the advancing partition.
#
# usage: verification/thesis/discrete.sh --data DIR [--scale X] [--build DIR]
#          [--parts N] [--workers N] [--ways LIST] [--work DIR] [--out FILE]
#          [CASE...]
#   --data     folder of real geometry (verification/fetch.md)
#   --scale    numbers of cells times X (default 1)
#   --build    build folder (default build/release, built if missing)
#   --parts    number of subdomains (default 100)
#   --workers  number of workers of the replay (default 32)
#   --ways     default "advancing discrete octree"
#   --work     scratch folder, kept (default: a temporary one, removed)
#   --out      write the table to FILE too (markdown)
#   CASE       f6-2 f6-14 jet-3 jet-25, with or without -layers; or patterns
#              (default: f6-2* jet-3*)
#
# vanguard plan chooses the growth so that the number of cells outside the
# layers is about the total of the thesis. Each case is meshed on one thread,
# and its timeline replayed with dynamic and with static assignment of tasks
# (--schedule). The cases of 2 and 3 million take some minutes of one core.
# Exit status: 0 all meshes valid, 1 a mesh is invalid, 2 usage.
# Needs: jq, time, openmpi-bin.
set -euo pipefail

root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=bench/common.sh
. "$root/bench/common.sh"
# shellcheck source=bench/aircraft.sh
. "$root/bench/aircraft.sh"
build=$root/build/release
work='' data='' scale=1 parts=100 workers=32 ways='advancing discrete octree'
project='' options=()
take_options "data scale build parts workers ways work out" "" "$@"
[ -n "$data" ] || skip "no --data: the cases are real geometry (verification/fetch.md)"
[ ${#cases[@]} -gt 0 ] || cases=('f6-2*' 'jet-3*')
to_measure thesis-discrete
[ -z "$out" ] || : > "$out"

# Expected cells for a growth, in total and outside the layers.
cells_at() {
  "$vanguard" plan -q -p "$project" "${options[@]}" --growth "$1" -n 1 --json \
    2> "$work/plan.log" | jq -r '"\(.mesh.cells) \(.mesh.field_cells)"'
}

# growth_for CELLS: the growth that gives this number of cells outside the
# layers within 4 %; the number decreases with growth.
growth_for() {
  local lo=1.01 hi=1.6 growth cells step
  for step in 1 2 3 4 5 6 7 8 9 10; do
    growth=$(calc "sqrt(($lo - 1) * ($hi - 1)) + 1")
    read -r _ cells < <(cells_at "$growth")
    holds "$cells < 0.96 * $1" || holds "$cells > 1.04 * $1" || break
    if holds "$cells > $1"; then lo=$growth; else hi=$growth; fi
  done
  echo "$growth"
}

# replayed TIMELINE OPTION...: speed-up, idle share.
replayed() {
  local record=$1
  shift
  "$vanguard" plan --replay "$record" --ranks "$workers" --json "$@" |
    jq -r '.forecast[0] | "\(.speedup * 100 | round / 100) \(.idle * 1000 |
      round / 10)"'
}

# Seconds of processor time of all tasks of a timeline, or of one kind.
spent() {
  jq --arg task "${2:-}" '(.columns | index("cpu")) as $c | [.spans[] |
    select($task == "" or .[0] == $task) | .[$c]] | add // 0 |
    . * 100 | round / 100' "$1"
}

figures='(.partition.decomposition // {}) as $q |
  [(.partition.leaf_cells | add) + .partition.fragment_cells
    + .partition.separator_cells + .partition.repair_cells,
   $q.parts // .partition.leaves,
   (.partition.balance * 1000 | round / 1000)] | map(tostring) | join(" | ")'

failed=0
try() {   # try WAY THE_THESIS
  local way=$1 d=$work/$name.$1 dynamic cyclic all idle idle_cyclic made
  if ! run_mesh "$vanguard" "$d" 1 1 -p "$project" "${options[@]}" \
       --decompose "$way" --subdomains "$parts" --write lb8.ugrid \
       --report-html no ||
     ! "$vanguard" check -q "$d"/out/*.lb8.ugrid > "$d/check.log" 2>&1
  then
    echo "| $name | $way | FAILED: $(tail -1 "$d/log") |" | say
    failed=1
    return
  fi
  rm -f "$d"/out/*.ugrid
  read -r dynamic idle < <(replayed "$d/record.json" --serial 0)
  read -r cyclic idle_cyclic < <(replayed "$d/record.json" --serial 0 \
    --schedule cyclic)
  read -r all _ < <(replayed "$d/record.json")
  made=$(spent "$d/record.json" 0J0)
  [ "$way" != advancing ] || made=-
  echo "| $name | $way | $(jq -r "$figures" "$d"/out/*.report.json) |" \
    "$(spent "$d/record.json") | $made |" \
    "$dynamic | $idle | $cyclic | $idle_cyclic | $all | $2 |" | say
}

{
  echo "| case | way | cells outside layers | parts | balance |" \
    "tasks on one core, s | decomposition, s | speed-up of this at $workers |" \
    "idle, % | dealt out in turn | idle, % | of all | the thesis's |"
  echo "|---|---|---|---|---|---|---|---|---|---|---|---|---|"
} | say
while read -r base surface cells thesis; do
  for layers in no yes; do
    name=$base
    [ $layers = no ] || name=$base-layers
    wanted "$name" || continue
    aircraft "$data" "$surface" "$work/input" || {
      echo "SKIP $name: no $surface below --data (verification/fetch.md)" >&2
      continue
    }
    options+=(--layers $layers)
    growth=$(growth_for "$(calc "$cells * $scale")")
    options+=(--growth "$growth")
    echo "$name: growth $growth" >&2
    for way in $ways; do
      if [ $layers$way = nodiscrete ]; then try "$way" "$thesis"
      else try "$way" -; fi
    done
  done
done << END
f6-2 dlr_f6_coarse 2e6 7.03
f6-14 dlr_f6_medium 14e6 6.89
jet-3 falcon 3e6 5.42
jet-25 falcon 25e6 5.27
END
exit $failed
