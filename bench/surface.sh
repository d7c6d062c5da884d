#!/usr/bin/env bash
# bench/surface.sh: how fast vanguard surface makes a surface anew.
#
# usage: bench/surface.sh --data DIR [--runs N] [--build DIR] [--out FILE]
#                         [CASE...]
#   --data   folder of real geometry (verification/README.md)
#   --runs   runs of a case, of which the median counts (default 3)
#   --build  build folder (default build/release)
#   --out    write the table to FILE too
#   CASE     f16 p180 concorde low-boom tmx1242 falcon (default all)
#
# Triangles of the new surface per second of one thread, user time of the whole
# program: reading, making, checking, measuring the distance both ways, writing.
set -euo pipefail

root=$(cd "$(dirname "$0")/.." && pwd)
# shellcheck source=bench/common.sh
. "$root/bench/common.sh"
data='' runs=3 build=$root/build/release
take_options "data runs build out" "" "$@"
[ -d "$data" ] || skip "no folder of real geometry: --data DIR"
declare -A file=([f16]=supersonic/f16_full [p180]=bizjet/p180_avanti_full
  [concorde]=supersonic/concorde_full [low-boom]=supersonic/low_boom_sst_full
  [tmx1242]=supersonic/tmx1242_wing_body
  [falcon]=bizjet/falcon_full_mirrored)
[ ${#cases[@]} -gt 0 ] || cases=(f16 p180 concorde low-boom tmx1242 falcon)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

row() { echo "$1"; [ -z "$out" ] || echo "$1" >>"$out"; }
[ -z "$out" ] || : >"$out"
row "| case | triangles | user s | triangles/s |"
row "|---|---|---|---|"
for name in "${cases[@]}"; do
  [ -n "${file[$name]:-}" ] || die "no case '$name'"
  xz -dc "$data/${file[$name]}.lb8.ugrid.xz" >"$work/$name.lb8.ugrid"
  times=()
  for ((i = 0; i < runs; i++)); do
    rm -rf "$work/new"
    TIMEFORMAT=%U
    times+=("$({ time "$build/bin/vanguard" surface -q -t 1 \
      "$work/$name.lb8.ugrid" --out "$work/new" >"$work/out"; } 2>&1)")
  done
  n=$(sed -n 's/.*, now \([0-9,]*\);.*/\1/p' "$work/out" | tr -d ,)
  t=$(printf '%s\n' "${times[@]}" | sort -g | sed -n "$(((runs + 1) / 2))p")
  row "$(awk -v c="$name" -v n="$n" -v t="$t" \
    'BEGIN { printf "| %s | %d | %.2f | %.0f |", c, n, t, n / t }')"
done
