#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# verification/cad.sh: CAD files, and surfaces on which a mesher once failed,
# with the default command.
#
# usage: verification/cad.sh --data DIR [--vanguard PROGRAM] [--meshcheck PROGRAM]
#                            [--threads N] [--work DIR] [--out FILE] [--quick]
#                            [CASE...]
#   --data       folder of real geometry (verification/fetch.md)
#   --vanguard   program (default build/release/bin/vanguard)
#   --meshcheck  independent checker of a .ugrid (default: vanguard check)
#   --threads    threads of every run (default: the cores); the report of a run
#                with another number is a failure
#   --work       folder for all results (default: a temporary one)
#   --out        write the table to FILE too
#   --quick      only cases of the folder field that take a few seconds
#   CASE         names of the table below (default: all)
#
# Each case runs `vanguard mesh -p FILE --y-plus 1 --reynolds 5e6
# --reference-length L` with its options. The result must be as its row says: a
# valid mesh with the named flow domain, or a refusal with the named words.
# Further requirements: full layers on 99.9 % of the wall; if the row gives
# them, a least angle outside the layers, 99 % of the points on the CAD model,
# and the volume of the body within 0.1 % of that of the model. Exit status 0 if
# all are met.
set -euo pipefail

root=$(cd "$(dirname "$0")/.." && pwd)
# shellcheck source=bench/common.sh
. "$root/bench/common.sh"
data='' vanguard=$root/build/release/bin/vanguard meshcheck='' work='' quick=
threads=$(nproc)
take_options "data vanguard threads meshcheck work out" "quick" "$@"
[ -d "$data" ] || skip "no folder of real geometry: give --data DIR (verification/fetch.md)"
need jq jq
[ -n "$work" ] || { work=$(mktemp -d); trap 'rm -rf "$work"' EXIT; }
mkdir -p "$work"

# name; file; reference length; required result: external, half, internal, or
# words of the refusal; least angle outside the layers (-: not checked); options
table='m6-openvsp|field/onera_m6_openvsp.igs.gz|0.64|external|5|
m6-openvsp-half|field/onera_m6_openvsp.igs.gz|0.64|half|-|--half y
m6-sharp-te|field/onera_m6_sharp_te.stp.gz|646|external|5|
m6-sharp-te-half|field/onera_m6_sharp_te.stp.gz|646|half|-|--half y
m6-root-cap|field/onera_m6_root_cap.igs.gz|646|external|5|
m6-root-cap-half|field/onera_m6_root_cap.igs.gz|646|half|-|--half y
transport-half|field/transport_half_wing_open_root.igs.gz|3|half|-|
vtol-wing|field/vtol_wing_thin_te.step.gz|0.3|external|-|
clark-open|field/clark_wing_open_ends.step.gz|1|close-holes yes|-|
clark-closed|field/clark_wing_open_ends.step.gz|1|external|-|--close-holes yes
blade-open|field/turbine_blade_open_ends.stp.gz|5|close-holes yes|-|
blade-closed|field/turbine_blade_open_ends.stp.gz|5|external|-|--close-holes yes
blade-wrapped|field/turbine_blade_open_ends.stp.gz|5|hollow shell|-|--wrap 0.2
rocket|field/rocket_touching_solids.step.gz|1|external|-|
tunnel|field/tunnel_ball.stl.gz|1|internal|-|
tunnel-wrapped|field/tunnel_ball.stl.gz|1|internal|-|--wrap 0.2
hollow|field/hollow_ball.stl.gz|1|external|-|
inside-out|field/ball_inside_out.stl.gz|1|external|-|
duct|field/duct_bend.msh.gz|1|internal|-|
duct-fun3d|field/duct_bend.msh.gz|1|internal|-|--deck field/duct_bend_fun3d.deck
duct-usm3d|field/duct_bend.msh.gz|1|internal|-|--deck field/duct_bend_usm3d.deck
pipe-open|field/pipe_open.stl.gz|1|close-holes yes|-|
pipe-asked|field/pipe_open.stl.gz|1|flow internal|-|--close-holes yes
pipe-closed|field/pipe_open.stl.gz|1|internal|-|--close-holes yes --flow internal
gap|field/boxes_gap_1e-4.stl.gz|1|surface triangles|-|--remesh-surface yes --gap-edges 2 --max-cells 3000000
sunk-ball|field/ball_sunk_in_ground.msh.gz|1|internal|-|--walls 3,6
tubes|field/tube_row_in_duct.msh.gz|1|internal|-|--walls 3
doubled|field/one_doubled_triangle.stl.gz|1|external|-|
byte-order-mark|field/byte_order_mark.stl.gz|1|external|-|
naca0012|hard/naca0012_extruded.obj.gz|1|external|-|
dlr-f6|transport/dlr_f6_wbnp_half.brep.xz|141.2|internal|-|
m6-farfield|transport/onera_m6_sharp_te_farfield.stp.xz|0.646|internal|-|
hemisphere|simple/hemisphere_cylinder_farfield.stp|1|internal|-|
cone-cone|simple/cone_cone.step|1|external|-|--layers no
cube-cylinder|simple/cube_cylinder.step|1|external|-|--layers no'
brief=' tunnel hollow inside-out duct duct-fun3d duct-usm3d pipe-open pipe-asked
pipe-closed gap doubled byte-order-mark clark-open '
if [ ${#cases[@]} -eq 0 ]; then
  mapfile -t cases < <(cut -d'|' -f1 <<<"$table")
fi

failed=0
row() { echo "$1"; [ -z "$out" ] || echo "$1" >>"$out"; }
[ -z "$out" ] || : >"$out"
row "| case | result | cells | full layers % | worst angle outside layers | points on CAD % | volume / CAD's - 1 | s on $threads thread(s) | checker | missed |"
row "|---|---|---|---|---|---|---|---|---|---|"

judge() { # MESH
  if [ -n "$meshcheck" ]; then
    "$meshcheck" -q "$1" 2>&1 | tail -1 | sed 's/RESULT: //'
  elif "$vanguard" check -q "$1" >/dev/null 2>&1; then
    echo OK
  else
    echo "not valid"
  fi
}

refused() { # NAME WANTED STATUS SECONDS
  local why missed=none
  why=$(grep . "$work/$1/err" | tail -1 | cut -c1-200)
  grep -qF -- "$2" "$work/$1/err" || { missed="refused"; failed=1; }
  row "| $1 | refused, status $3: ${why//|//} | - | - | - | - | - | $4 | - | $missed |"
}

made() { # NAME WANTED ANGLE SECONDS
  local r=$work/$1/report verdict missed
  verdict=$(judge "$(ls "$work/$1"/*.b8.ugrid)")
  # shellcheck disable=SC2016 # of jq
  local full='def full: if .layers then [.layers.patches[] | .faces] as $n |
    ([.layers.patches[] | .faces * .percent_full] | add) / ($n | add)
    else null end;
    def volume: if .remesh.cad_volume
    then .remesh.volume / .remesh.cad_volume - 1 else 0 end;'
  missed=$(jq -r --arg wanted "$2" --arg angle "$3" --arg verdict "$verdict" "$full"'
    (if .flow.half != "no" then "half" else .flow.kind end) as $kind |
    [(if $wanted != "-" and $kind != $wanted then "domain" else empty end),
     (if $verdict != "OK" then "judge" else empty end),
     (if full and full < 99.9 then "layers" else empty end),
     (if $angle != "-" and (.field // .mesh).angle_min
         < ($angle | tonumber) then "angle" else empty end),
     (if $angle != "-" and (.remesh.cad.percent_on // 0) < 99
      then "points" else empty end),
     (if $angle != "-" and (volume | fabs) > 0.001
      then "volume" else empty end)] | join(" ")' "$r")
  [ -z "$missed" ] || failed=1
  row "$(jq -r --arg name "$1" --arg s "$4" --arg verdict "$verdict" \
    --arg missed "${missed:-none}" "$full"'
    def at(n): if . == null then "-" else . * n | round / n end;
    [$name, .flow.statement, .mesh.cells, (full | at(100)),
     ((.field // .mesh).angle_min | at(100)),
     (.remesh.cad.percent_on | at(100)),
     (if .remesh.cad_volume then volume | at(1e6) else "-" end), $s, $verdict, $missed] | "| " + (map(tostring) | join(" | ")) +
    " |"' "$r")"
}

for name in "${cases[@]}"; do
  IFS='|' read -r _ file length wanted angle options < <(
    grep "^$name|" <<<"$table") || die "no case '$name'"
  [ -z "$quick" ] || [[ $brief == *[[:space:]]"$name"[[:space:]]* ]] || continue
  if [ ! -e "$data/$file" ]; then
    row "| $name | no $file (see verification/fetch.md) | - | - | - | - | - | - | - | skipped |"
    continue
  fi
  rm -rf "${work:?}/$name"
  mkdir -p "$work/$name"
  input=$work/$name/$(basename "$file" | sed 's/\.[gx]z$//')
  case $file in
  *.gz) gzip -dc "$data/$file" >"$input" ;;
  *.xz) xz -dc "$data/$file" >"$input" ;;
  *) cp "$data/$file" "$input" ;;
  esac
  options=${options/field\//$data/field/}
  start=$(date +%s.%N)
  status=0
  # shellcheck disable=SC2086 # a list of words
  timeout 600 "$vanguard" mesh -q -j -p "$input" --y-plus 1 --reynolds 5e6 \
    --reference-length "$length" --threads "$threads" $options \
    >"$work/$name/report" \
    2>"$work/$name/err" || status=$?
  seconds=$(awk -v a="$start" -v b="$(date +%s.%N)" \
    'BEGIN { printf "%.1f", b - a }')
  if [ $status = 0 ]; then
    check_workers "$work/$name/report" 1 "$threads"
    made "$name" "$wanted" "$angle" "$seconds"
  else
    refused "$name" "$wanted" "$status" "$seconds"
  fi
done
exit $failed
