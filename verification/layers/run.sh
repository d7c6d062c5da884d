#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# verification/layers/run.sh: layers on VGRID's example, wings and aircraft,
# checked by independent programs.
#
# usage: verification/layers/run.sh [--data DIR] [--quick] [--build DIR]
#          [--meshcheck PROGRAM|SOURCE.c] [--work DIR] [--out FILE]
#          [--cells "tets mixed"] [--threads N] [--options "OPTION..."] [CASE...]
#   --data       folder of real geometry (verification/fetch.md); without it
#                only the wings
#   --quick      VGRID's case, the smallest wings and DLR-F6
#   --build      build folder with bin/vanguard and bin/vg_measure_layers
#                (default build/release)
#   --meshcheck  another checker: PROGRAM -q MESH.b8.ugrid, exit status 0 if the
#                mesh is valid; or its C source, a copy of which with UGRID's
#                order of pyramids checks mixed cells (README.md)
#   --work       scratch folder, logs and reports are kept (default: a
#                temporary one, removed)
#   --out        write the table to FILE too
#   --cells      kinds of cells, one after the other; also hex (README.md)
#   --threads    threads of every run (default: the cores); the report of a run
#                with another number is a failure
#   --options    more options for `vanguard mesh`, e.g. "--fan-angle 60"
#   CASE         names or patterns: 'wing*_s_*' falcon
# Prints a row per mesh. Exit status: 0 every mesh is valid, 1 a mesh is
# invalid, 2 usage, 77 nothing to do. Requirements that are not met only appear
# in the last column.
set -uo pipefail
export LC_ALL=C

root=$(cd "$(dirname "$0")/../.." && pwd)
build=$root/build/release
data='' work='' out='' meshcheck='' cells='tets mixed' options='' quick=0
threads=$(nproc)
only=()
LIMIT_S=3600

usage() { sed -n '2,/^# 77/p' "$0" | sed 's/^# \{0,1\}//'; }

while [ $# -gt 0 ]; do
  case $1 in
    --quick) quick=1 ;;
    --data|--build|--meshcheck|--work|--out|--cells|--threads|\
    --options)
      [ $# -gt 1 ] || { usage >&2; exit 2; }
      declare "${1#--}=$2"
      shift ;;
    -h|--help) usage; exit 0 ;;
    -*) usage >&2; exit 2 ;;
    *) only+=("$1") ;;
  esac
  shift
done
vanguard=$build/bin/vanguard measure=$build/bin/vg_measure_layers
for program in "$vanguard" "$measure"; do
  [ -x "$program" ] || { echo "no program $program: build it first" >&2
                         exit 2; }
done
if [ -z "$work" ]; then
  work=$(mktemp -d "${TMPDIR:-/tmp}/vanguard-layers.XXXXXX")
  trap 'rm -rf "$work"' EXIT
fi
mkdir -p "$work"

# name, file below --data, patches that are walls (all: a body), mean chord,
# Reynolds number, q: part of --quick. Chords without a source are estimated
# from the bounding box.
aircraft="
dlr_f6_coarse transport/dlr_f6_wbnp_half_coarse.lb8.ugrid.xz 1-123 141.2 3e6 q
dlr_f6_medium transport/dlr_f6_wbnp_half_medium.lb8.ugrid.xz 1-123 141.2 3e6 -
onera_m6      transport/onera_m6_sharp_te_farfield.lb8.ugrid.xz 3-12 0.646 11.72e6 -
30p30n_coarse highlift/30p30n_swept_wing_in_box_coarse.lb8.ugrid.xz 1-10 1000 9e6 -
30p30n_medium highlift/30p30n_swept_wing_in_box_medium.lb8.ugrid.xz 1-10 1000 9e6 -
falcon        bizjet/falcon_full_mirrored.lb8.ugrid.xz all 2.9 5e6 -
p180          bizjet/p180_avanti_full.lb8.ugrid.xz all 1.14 5e6 -
concorde      supersonic/concorde_full.lb8.ugrid.xz all 14 5e6 -
f16           supersonic/f16_full.lb8.ugrid.xz all 3.4 5e6 -
low_boom      supersonic/low_boom_sst_full.lb8.ugrid.xz all 20 5e6 -
tmx1242       supersonic/tmx1242_wing_body.lb8.ugrid.xz all 9 5e6 -
tnd6480       supersonic/tnd6480_delta_wing_body.lb8.ugrid.xz all 15 5e6 -
"

say() { if [ -n "$out" ]; then tee -a "$out"; else cat; fi; }

wanted() {
  local pattern
  [ ${#only[@]} -gt 0 ] || return 0
  for pattern in "${only[@]}"; do
    # shellcheck disable=SC2254
    case $1 in $pattern) return 0 ;; esac
  done
  return 1
}

# The value of the last of several nested keys.
json() {
  local file=$1
  shift
  awk -v keys="$*" 'BEGIN { n = split(keys, key, " "); at = 1 }
    $1 == "\"" key[at] "\":" { if (at++ == n) {
      sub(/,$/, "", $2); print $2; exit } }' "$file"
}
value() { awk -v k="$2" '$1 == k { print $2; exit }' "$1"; }
holds() { awk -v a="$2" -v b="$3" "BEGIN { exit !(a $1 b) }"; }

# The checker of mixed cells: the faces of pyramids are reversed if the source
# has them opposite to UGRID, refine and its own prisms; volumes of prisms are
# the mean of both subdivisions, as for quadrilaterals.
checker='' checker_mixed=''
prepare_checker() {
  case $meshcheck in
    '') return ;;
    *.c) ;;
    *) checker=$meshcheck checker_mixed=$meshcheck
       return ;;
  esac
  sed -e 's/PYB\[4\] = {0,3,4,1}/PYB[4] = {1,4,3,0}/' \
    -e 's/{{0,1,2},{1,4,2},{4,3,2},{3,0,2}}/{{2,1,0},{2,4,1},{2,3,4},{2,0,3}}/' \
    "$meshcheck" > "$work/judge_mixed.c"
  checker=$work/judge checker_mixed=$work/judge_mixed
  gcc -O2 -w -o "$checker" "$meshcheck" -lm &&
    gcc -O2 -w -o "$checker_mixed" "$work/judge_mixed.c" -lm || {
    echo "cannot build $meshcheck" >&2; exit 2; }
}

why='' missed=''
bad() { why="${why:+$why; }$*"; }
miss() { missed="${missed:+$missed, }$*"; }

judge_mesh() {   # judge_mesh FOLDER MESH KIND
  local program=$checker
  "$vanguard" check -q "$2" > "$1/check" 2>&1 || bad "vanguard check"
  [ "$3" = tets ] || program=$checker_mixed
  [ -n "$program" ] || return
  "$program" -q "$2" > "$1/meshcheck" 2>&1 ||
    bad "judge: $(grep -a FAIL "$1/meshcheck" | head -1)"
}

# Quality of the field above the layers, on surfaces without needles.
field_bars() {
  local least largest jump
  least=$(json "$1" field angle_min)
  largest=$(json "$1" field angle_max)
  jump=$(json "$1" all top_volume_ratio percentile_95)
  holds '>=' "$least" 5 || miss "smallest angle $(printf %.2f "$least") < 5"
  holds '<=' "$largest" 172 || miss "largest angle $(printf %.1f "$largest") > 172"
  holds '<=' "$jump" 4 || miss "volume ratio across the top $(
    printf %.2f "$jump") > 4 (95 %)"
}

# Compare a mesh with the requirements. bars REPORT MEASURED KIND FULL
bars() {
  local full any first layers prisms quads dense
  full=$(json "$1" all percent_full)
  any=$(json "$1" all percent_any)
  first=$(json "$1" all first_error_percent)
  holds '>=' "$full" "$4" || miss "full $(printf %.2f "$full") < $4"
  holds '>=' "$any" 99.9 || miss "any $(printf %.2f "$any") < 99.9"
  holds '<=' "$first" 1 || miss "first height off by $(printf %.2f "$first") %"
  field_bars "$1"
  prisms=-
  if [ "$3" != tets ]; then
    layers=$(awk -v t="$(json "$1" layers tetrahedra)" \
      -v p="$(json "$1" layers pyramids)" -v q="$(json "$1" layers prisms)" \
      -v h="$(json "$1" layers hexahedra)" \
      'BEGIN { print t + p + q + h, 100 * (q + h) / (t + p + q + h) }')
    prisms=${layers#* }
    if [ "$3" = mixed ]; then
      holds '>=' "$prisms" 90 || miss "prisms $prisms < 90"
      [ "$(value "$2" first_off_1_percent)" = 0 ] ||
        miss "first height in the file off at $(value "$2" \
          first_off_1_percent) points"
      first=$(value "$2" first_error_percent)
    else
      quads=$(json "$1" layers percent_wall_quadrilaterals)
      dense=$(json "$1" layers cells_per_point)
      holds '>=' "$quads" 80 || miss "wall quadrilaterals $quads % < 80"
      holds '<=' "$dense" 1.4 || miss "cells per point $dense > 1.4"
    fi
  fi
  row=$(printf '%d | %d | %.1f | %.2f | %.2f | %.4f | %.6s | %s' \
    "$(json "$1" layers wall_points)" "$(json "$1" mesh cells)" \
    "$(json "$1" all levels mean)" "$full" "$any" "$first" "$prisms" \
    "$(json "$1" field angle_min | cut -c1-5)")
}

# one NAME KIND FULL INPUT OPTION...: mesh and check; prints a row.
one() {
  local name=$1 kind=$2 full=$3 input=$4 d=$work/$1.$2 start status
  shift 4
  why='' missed='' row='- | - | - | - | - | - | - | -'
  mkdir -p "$d/out"
  start=$(date +%s.%N)
  # shellcheck disable=SC2086
  timeout $LIMIT_S "$vanguard" mesh -q -p "$input" --out "$d/out" \
    --write b8.ugrid,mapbc --layers yes --cells "$kind" \
    --threads "$threads" "$@" $options \
    > "$d/log" 2>&1
  status=$?
  seconds=$(awk -v a="$start" -v b="$(date +%s.%N)" \
    'BEGIN { printf "%.0f", b - a }')
  local mesh report
  mesh=$(echo "$d"/out/*.b8.ugrid) report=$(echo "$d"/out/*.report.json)
  if [ $status != 0 ] || [ ! -f "$mesh" ]; then
    bad "exit $status: $(grep -a '^vanguard:' "$d/log" | tail -1)"
  else
    [ "$(json "$report" partition threads)" = "$threads" ] ||
      bad "not $threads threads"
    judge_mesh "$d" "$mesh" "$kind"
    [ "$kind" != mixed ] || "$measure" first "$mesh" \
      "$(json "$report" all first_requested mean)" > "$d/measured" 2>&1 ||
      bad "not measured"
    bars "$report" "$d/measured" "$kind" "$full"
  fi
  finish "$name" "$kind" "$d"
}

finish() {
  local result=valid
  [ -z "$why" ] || { result="FAIL: $why"; failed=1; }
  echo "| $1 | $2 | $row | $seconds | $result | ${missed:-all met} |" | say
  done=$((done + 1))
  find "$3" -type f -size +1M -delete
}

wing_cases() {
  local shape size law n laws sizes='s m l'
  [ $quick = 0 ] || sizes=s
  for shape in wing wing-half wing-sharp wing-sharp-half; do
    for size in $sizes; do
      case $size in s) n=600000 ;; m) n=1100000 ;; l) n=2000000 ;; esac
      for law in 1.16 1.2; do
        wanted "${shape}_${size}_$law" || continue
        if [ $law = 1.16 ]; then
          laws='--rate1 0.16 --rate2 0.002 --layer-cap 1.2'
        else
          laws='--ratio 1.2'
        fi
        rm -rf "$work/input"
        "$vanguard" demo $shape --cells $n --out "$work/input" > /dev/null
        for kind in $cells; do
          # shellcheck disable=SC2086
          one "${shape}_${size}_$law" "$kind" 98 "$work/input/$shape" $laws
        done
      done
    done
  done
}

aircraft_cases() {
  local name file walls length reynolds small input bar how kind
  while read -r name file walls length reynolds small; do
    [ -n "$name" ] && wanted "$name" || continue
    [ $quick = 0 ] || [ "$small" = q ] || continue
    [ -e "$data/$file" ] || {
      echo "SKIP $name: no $file below --data (verification/fetch.md)" >&2
      continue
    }
    rm -rf "$work/input"
    mkdir -p "$work/input"
    input=$work/input/$name.lb8.ugrid
    xz -dc "$data/$file" > "$input"
    bar=95
    case $walls in
      all) how='--farfield sphere' ;;
      *) how="--farfield none --walls $walls" ;;
    esac
    [ "$name" != onera_m6 ] || bar=98   # a wing
    for kind in $cells; do
      # shellcheck disable=SC2086
      one "$name" "$kind" $bar "$input" $how --y-plus 1 \
        --reynolds "$reynolds" --reference-length "$length" --ratio 1.2
    done
  done <<< "$aircraft"
}

# VGRID's example: law, levels and cells; quality compared with VGRID's mesh.
box_row() {
  echo "| $1 | $(value "$2" layer_cells) | $(value "$2" levels_29) / $(value \
    "$2" levels_30) | $(value "$2" law_error) | $(value "$2" other_cells) |" \
    "$(value "$2" angle_min) | $(value "$2" below_10) | $(value "$2" \
    top_ratio_median) / $(value "$2" top_ratio_95) / $(value "$2" \
    top_ratio_max) |"
}

box_bars() {   # box_bars OURS THEIRS
  local key n
  holds '<=' "$(value "$1" law_error)" 1e-12 ||
    miss "law off by $(value "$1" law_error)"
  [ "$(value "$1" points_off_columns)" = 0 ] || miss "points off columns"
  [ "$(grep -c '^levels_' "$1")" = 2 ] || miss "levels other than 29 and 30"
  n=$(value "$1" layer_cells)
  holds '<=' "$(awk -v n="$n" 'BEGIN { d = n / 51564 - 1
    print d < 0 ? -d : d }')" 0.02 || miss "layer cells $n"
  holds '>' "$(value "$1" angle_min)" "$(value "$2" angle_min)" ||
    miss angle_min
  for key in below_10 top_ratio_median top_ratio_95 top_ratio_max; do
    holds '<' "$(value "$1" $key)" "$(value "$2" $key)" ||
      miss "$key $(value "$1" $key), VGRID's is $(value "$2" $key)"
  done
}

box_case() {
  local d=$work/vgrid_box f
  why='' missed=''
  wanted vgrid_box && [ -e "$data/vgrid_box/box.front" ] || return
  mkdir -p "$d/in" "$d/out"
  for f in d3m front mapbc; do cp "$data/vgrid_box/box.$f" "$d/in/"; done
  # shellcheck disable=SC2086
  "$vanguard" mesh -q -p "$d/in/box" --out "$d/out" --write cogsg,b8.ugrid \
    $options > "$d/log" 2>&1 || bad "exit $?: $(tail -1 "$d/log")"
  judge_mesh "$d" "$d/out/box.b8.ugrid" tets
  # The law of box.d3m on patch 3, the floor.
  for f in "$data/vgrid_box" "$d/out"; do
    "$measure" box "$f/box.cogsg" 3 0.001 0.15 0.02 \
      > "$d/$(basename "$f").measured" || bad "not measured"
  done
  box_bars "$d/out.measured" "$d/vgrid_box.measured"
  say << END
| vgrid_box | layer cells | columns of 29 / 30 levels | off the law by | other cells | worst dihedral | % below 10 | volume ratio across the top: median / 95 % / max |
|---|---|---|---|---|---|---|---|
$(box_row VGRID "$d/vgrid_box.measured")
$(box_row Vanguard "$d/out.measured")

vgrid_box: ${why:-valid}; bars missed: ${missed:-none}

END
  [ -z "$why" ] || failed=1
  done=$((done + 1))
}

[ -z "$out" ] || : > "$out"
prepare_checker
failed=0 done=0
[ -z "$data" ] || box_case
say << END
| case | cells | wall points | all cells | mean levels | full % | any % | first height off, % | % prisms and hexahedra | worst dihedral outside | s on $threads thread(s) | result | bars |
|---|---|---|---|---|---|---|---|---|---|---|---|---|
END
wing_cases
[ -z "$data" ] || aircraft_cases
[ $done -gt 0 ] || {
  echo "SKIP: no such case, or no data (verification/fetch.md)"
  exit 77
}
exit $failed
