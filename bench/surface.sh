#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# bench/surface.sh: the speed of vanguard surface.
#
# usage: bench/surface.sh --data DIR [--runs N] [--build DIR] [--out FILE]
#                         [CASE...]
#   --data   folder of real geometry (verification/fetch.md)
#   --runs   runs of a case, alternating between one and two threads; medians
#            are shown (default 3)
#   --build  build folder (default build/release)
#   --out    write the table to FILE too
#   CASE     names of the table below (default all)
#
# Triangles of the remeshed surface per second of one thread: user and system
# time of the whole program: reading, remeshing, checking, measuring the
# distance in both directions, writing. The wall-clock time of one thread over
# that of two is only meaningful on an idle machine. Cases that end in -1m use
# sizes that give about a million triangles.
set -euo pipefail

root=$(cd "$(dirname "$0")/.." && pwd)
# shellcheck source=bench/common.sh
. "$root/bench/common.sh"
data='' runs=3 build=$root/build/release
take_options "data runs build out" "" "$@"
[ -d "$data" ] || skip "no folder of real geometry: give --data DIR (verification/fetch.md)"
need jq jq
need /usr/bin/time time
# name, file, options
table='tmx1242 supersonic/tmx1242_wing_body
tnd6480 supersonic/tnd6480_delta_wing_body
f16 supersonic/f16_full
falcon bizjet/falcon_full_mirrored
dlr-f6 transport/dlr_f6_wbnp_half_coarse
dlr-f6-medium transport/dlr_f6_wbnp_half_medium
p180 bizjet/p180_avanti_full
30p30n highlift/30p30n_swept_wing_in_box_coarse
dlr-f6-1m transport/dlr_f6_wbnp_half_medium --scale 0.36
f16-1m supersonic/f16_full --scale 0.29
concorde supersonic/concorde_full
low-boom supersonic/low_boom_sst_full'
[ ${#cases[@]} -gt 0 ] || mapfile -t cases < <(cut -d' ' -f1 <<<"$table")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

row() { echo "$1"; [ -z "$out" ] || echo "$1" >>"$out"; }
[ -z "$out" ] || : >"$out"
median() { sort -g | sed -n "$(((runs + 1) / 2))p"; }

row "| case | triangles | s | triangles/s | wall, 1 over 2 threads | MB |"
row "|---|---|---|---|---|---|"
for name in "${cases[@]}"; do
  read -r _ file options < <(grep "^$name " <<<"$table") ||
    die "no case '$name'"
  [ -e "$data/$file.lb8.ugrid.xz" ] ||
    die "no $data/$file.lb8.ugrid.xz: verification/fetch.md has the source"
  xz -dc "$data/$file.lb8.ugrid.xz" >"$work/in.lb8.ugrid"
  : >"$work/times1"; : >"$work/times2"
  for ((i = 0; i < runs; i++)); do
    for t in 1 2; do
      rm -rf "$work/new$t"
      # shellcheck disable=SC2086 # options are words
      /usr/bin/time -a -o "$work/times$t" -f '%U %S %e %M' \
        "$build/bin/vanguard" surface -q -j -t $t $options \
        "$work/in.lb8.ugrid" --out "$work/new$t" >"$work/out" 2>"$work/err" ||
        die "$name: $(tail -1 "$work/err")"
    done
    cmp -s "$work"/new[12]/in.lb8.ugrid ||
      die "$name: different bytes on two threads"
  done
  awk '$1 + $2 > 1.05 * $3 + 0.05 { exit 1 }' "$work/times1" ||
    die "$name: more CPU time than one thread has"
  row "$(awk -v c="$name" -v n="$(jq .remesh.triangles[1] "$work/out")" \
    -v t="$(awk '{ print $1 + $2 }' "$work/times1" | median)" \
    -v w1="$(awk '{ print $3 }' "$work/times1" | median)" \
    -v w2="$(awk '{ print $3 }' "$work/times2" | median)" \
    -v m="$(awk '{ print $4 }' "$work/times1" | median)" \
    'BEGIN { printf "| %s | %d | %.2f | %.0f | %.2f | %.0f |", c, n, t, n / t,
             w1 / w2, m / 1024 }')"
done
