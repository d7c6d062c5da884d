#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# verification/surface.sh: tessellations remeshed by vanguard surface.
#
# usage: verification/surface.sh --data DIR [--vanguard PROGRAM] [--work DIR]
#                                [--out FILE] [--volume] [CASE...]
#   --data      folder of real geometry (verification/fetch.md)
#   --vanguard  program (default build/release/bin/vanguard)
#   --work      folder for the results (default: a temporary one)
#   --out       write the table to FILE too
#   --volume    also mesh the volume with layers on the remeshed surface (F-16,
#               P180, Concorde, low-boom); takes long
#   CASE        names below (default: all)
#
# Requirements: no defect according to vanguard check, except open edges of the
# input; 99.9 % of the length of feature curves, except dropped strips
# narrower than the tolerance, which are listed; distances in both directions
# within 1.065 times the tolerance (divided by the cosine of half the feature
# angle); 1st percentile of the smallest angles 35 degrees; 90 % of the edges
# within a factor of 1.41 of the size; angles below 10 degrees as in the table.
# Corners never move; the number of them that the check of the remeshed surface
# finds again is reported, because curves may turn less or more over coarser
# edges. With --volume: smallest angle outside the layers 5 degrees, 0.01 % of
# the cells below 10. Exit status 0 if all are met.
set -euo pipefail

root=$(cd "$(dirname "$0")/.." && pwd)
# shellcheck source=bench/common.sh
. "$root/bench/common.sh"
data='' vanguard=$root/build/release/bin/vanguard work='' volume=
take_options "data vanguard work out" "volume" "$@"
[ -d "$data" ] || skip "no folder of real geometry: give --data DIR (verification/fetch.md)"
need jq jq
[ -n "$work" ] || { work=$(mktemp -d); trap 'rm -rf "$work"' EXIT; }
mkdir -p "$work"

# name, file, largest share below 10 degrees, chord for y+
table='f16 supersonic/f16_full 0.003 3.5
p180 bizjet/p180_avanti_full 0.05 1.2
concorde supersonic/concorde_full 0.1 18
low-boom supersonic/low_boom_sst_full 0.1 20
falcon bizjet/falcon_full_mirrored 0.1 -
tmx1242 supersonic/tmx1242_wing_body 0.1 -
tnd6480 supersonic/tnd6480_delta_wing_body 0.1 -
30p30n highlift/30p30n_swept_wing_in_box_coarse 0.1 -
dlr-f6 transport/dlr_f6_wbnp_half_coarse 0.1 -'
[ ${#cases[@]} -gt 0 ] || mapfile -t cases < <(cut -d' ' -f1 <<<"$table")

failed=0
row() { echo "$1"; [ -z "$out" ] || echo "$1" >>"$out"; }
[ -z "$out" ] || : >"$out"
row "| case | triangles | worst, 1st percentile | below 10, 20 % | forced by corner, strip, line, surface | sizes met % | distance / tolerance | lines kept % | corners, found again | strips closed, length | missed |"
row "|---|---|---|---|---|---|---|---|---|---|---|"

judge() { # NAME BELOW-10
  local r=$work/$1/in.surface.json missed
  missed=$(jq -r --argjson below "$2" '.remesh as $m | .surface.quality as $q |
    [(if $m.line_length[1] < 0.999 * $m.line_length[0] then "lines" else empty
      end),
     (if ([$m.new_from_given.largest, $m.given_from_new.largest] | max)
         > 1.065 * $m.tolerance then "distance" else empty end),
     (if $q.angle_min_percentile_1 < 35 then "percentile" else empty end),
     (if $m.percent_edges_fit < 90 then "sizes" else empty end),
     (if $q.percent_below_5_10_20_30[1] > $below then "below-10" else empty
      end)] | join(" ")' "$r")
  "$vanguard" check -q -j "$work/$1/in.lb8.ugrid" >"$work/$1/check" ||
    missed+=" defects"
  missed=${missed# }
  row "$(jq -r --arg name "$1" --arg missed "${missed:-none}" \
    --argjson again "$(jq .lines.corners "$work/$1/check")" '
    def at(n): . * n | round / n;
    .remesh as $m | .surface.quality as $q |
    [$name, "\($m.triangles[0]) -> \($m.triangles[1])",
     "\($q.angle_min | at(100)), \($q.angle_min_percentile_1 | at(10))",
     "\($q.percent_below_5_10_20_30[1] | at(1e4)), " +
     "\($q.percent_below_5_10_20_30[2] | at(1e4))",
     (["corner", "strip", "line", "surface"] | map(. as $c |
      [$m.below_20_degrees[] | select(.cause == $c)] | length | tostring) |
      join(", ")), ($m.percent_edges_fit | at(100)),
     "\($m.new_from_given.largest / $m.tolerance | at(100)), " +
     "\($m.given_from_new.largest / $m.tolerance | at(100))",
     (if $m.line_length[0] > 0 then
      100 * $m.line_length[1] / $m.line_length[0] | at(1000) else "-" end),
     "\($m.corners), \($again)", ($m.strips_closed | if . then
      "\(.number), \(.length | at(1000))" else "-" end),
     $missed] | "| " + (map(tostring) | join(" | ")) + " |"' "$r")"
  [ -z "$missed" ] || failed=1
}

mesh() { # NAME CHORD
  "$vanguard" mesh -q -p "$work/$1/in.lb8.ugrid" --walls -999999-999999 \
    --y-plus 1 --reynolds 5e6 --reference-length "$2" --write lb8.ugrid \
    --out "$work/$1/volume" >"$work/$1/volume.out" || {
    row "$1: no volume mesh"; failed=1; return; }
  local report=$work/$1/volume/in.report.json
  row "$1, field: $(jq -r '.field | "smallest angle \(.angle_min), % below 5, 10 "
    + "degrees \(.percent_below_5_10_15_20_30[:2])"' "$report")"
  jq -e '.field | .angle_min >= 5 and .percent_below_5_10_15_20_30[1] <= 0.01' \
    "$report" >/dev/null || failed=1
}

for name in "${cases[@]}"; do
  read -r _ file below chord < <(grep "^$name " <<<"$table") ||
    die "no case '$name'"
  mkdir -p "$work/$name"
  rm -f "$work/$name"/in.*
  [ -e "$data/$file.lb8.ugrid.xz" ] ||
    die "no $data/$file.lb8.ugrid.xz: verification/fetch.md has the source"
  xz -dc "$data/$file.lb8.ugrid.xz" >"$work/$name.lb8.ugrid"
  mv "$work/$name.lb8.ugrid" "$work/$name/given.lb8.ugrid"
  if ! "$vanguard" surface -q "$work/$name/given.lb8.ugrid" \
    --out "$work/$name/new" >"$work/$name/out" 2>"$work/$name/err"; then
    row "$name: $(tail -1 "$work/$name/err")"
    failed=1
    continue
  fi
  mv -f "$work/$name/new/given.lb8.ugrid" "$work/$name/in.lb8.ugrid"
  mv -f "$work/$name/new/given.surface.json" "$work/$name/in.surface.json"
  rm -rf "$work/$name/new"
  judge "$name" "$below"
  [ -z "$volume" ] || [ "$chord" = - ] || mesh "$name" "$chord"
done
exit $failed
