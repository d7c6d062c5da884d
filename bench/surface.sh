#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# bench/surface.sh: the speed of vanguard surface, and that of gmsh on CAD.
#
# usage: bench/surface.sh --data DIR [--runs N] [--against PROGRAM] [--no-peers]
#                         [--build DIR] [--out FILE] [CASE...]
#   --data      folder of real geometry (verification/fetch.md)
#   --runs      runs of a case; medians are shown (default 3)
#   --against   another vanguard program, run in turn with this one: the column
#               "other" is its processor time, "ratio" the median of the ratios
#               of the pairs, and the last row their geometric mean
#   --no-peers  without gmsh
#   --build     build folder (default build/release)
#   --out       write the table to FILE too
#   CASE        names of the table below, or patterns (default all)
#
# Triangles of the remeshed surface per second of one thread: user and system
# time of the whole program, pinned to one core: reading, tessellating,
# remeshing, checking, measuring the distance in both directions, writing. The
# wall-clock time of one thread over that of two is only meaningful on an idle
# machine. Cases that end in -1m use sizes that give about a million triangles.
# Angles are the smallest one and the 1st percentile, in degrees.
#
# gmsh meshes CAD files with `-algo front2d`; a factor on its sizes is sought
# until its number of triangles is within 5 % of ours. Its time is that of the
# whole program as well; it is ended after two minutes. Needs: jq, time,
# taskset; gmsh if it is installed.
set -euo pipefail

root=$(cd "$(dirname "$0")/.." && pwd)
# shellcheck source=bench/common.sh
. "$root/bench/common.sh"
data='' runs=3 build=$root/build/release against='' no_peers=0
take_options "data runs build out against" "no-peers" "$@"
[ -d "$data" ] || skip "no folder of real geometry: give --data DIR (verification/fetch.md)"
need jq jq
need /usr/bin/time time
need taskset util-linux
[ -z "$against" ] || need "$against" "another version of vanguard"
command -v gmsh >/dev/null || no_peers=1
# name, file, options
table='tmx1242 supersonic/tmx1242_wing_body.lb8.ugrid.xz
tnd6480 supersonic/tnd6480_delta_wing_body.lb8.ugrid.xz
f16 supersonic/f16_full.lb8.ugrid.xz
falcon bizjet/falcon_full_mirrored.lb8.ugrid.xz
dlr-f6 transport/dlr_f6_wbnp_half_coarse.lb8.ugrid.xz
dlr-f6-medium transport/dlr_f6_wbnp_half_medium.lb8.ugrid.xz
p180 bizjet/p180_avanti_full.lb8.ugrid.xz
30p30n highlift/30p30n_swept_wing_in_box_coarse.lb8.ugrid.xz
dlr-f6-1m transport/dlr_f6_wbnp_half_medium.lb8.ugrid.xz --scale 0.36
f16-1m supersonic/f16_full.lb8.ugrid.xz --scale 0.29
concorde supersonic/concorde_full.lb8.ugrid.xz
low-boom supersonic/low_boom_sst_full.lb8.ugrid.xz
cad-cube-cylinder simple/cube_cylinder.step
cad-cone-cone simple/cone_cone.step
cad-hemisphere simple/hemisphere_cylinder_farfield.stp
cad-dlr-f6 transport/dlr_f6_wbnp_half.brep.xz
cad-m6-farfield transport/onera_m6_sharp_te_farfield.stp.xz
cad-m6-openvsp field/onera_m6_openvsp.igs.gz
cad-m6-root-cap field/onera_m6_root_cap.igs.gz
cad-m6-sharp-te field/onera_m6_sharp_te.stp.gz
cad-transport field/transport_half_wing_open_root.igs.gz --close-holes yes
cad-clark field/clark_wing_open_ends.step.gz --close-holes yes
cad-rocket field/rocket_touching_solids.step.gz
cad-blade field/turbine_blade_open_ends.stp.gz --close-holes yes
cad-vtol field/vtol_wing_thin_te.step.gz'
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
core=$(taskset -cp $$ | sed 's/.*[ ,-]//')   # the last one that we may use

median() { sort -g | sed -n "$(((runs + 1) / 2))p"; }
cpu() { awk '{ print $1 + $2 }' "$1"; }

# unpack FILE: the input as $work/in.EXTENSION; prints its name.
unpack() {
  local file=$data/$1 name
  [ -e "$file" ] || die "no $file: verification/fetch.md has the source"
  case $1 in *ugrid.*) name=in.lb8.ugrid ;;
    *) name=${1%.[gx]z}; name=in.${name##*.} ;;
  esac
  case $1 in
    *.xz) xz -dc "$file" ;;
    *.gz) gzip -dc "$file" ;;
    *) cat "$file" ;;
  esac >"$work/$name"
  echo "$work/$name"
}

# remesh PROGRAM TAG THREADS INPUT OPTION...: one run, timed in $work/times-TAG;
# its report is $work/report-TAG.
remesh() {
  local program=$1 tag=$2 t=$3 pin=()
  shift 3
  [ "$t" != 1 ] || pin=(taskset -c "$core")
  rm -rf "$work/new-$tag"
  "${pin[@]}" /usr/bin/time -a -o "$work/times-$tag" -f '%U %S %e %M' \
    "$program" surface -q -j --threads "$t" "$@" --out "$work/new-$tag" \
    >"$work/report-$tag" 2>"$work/err" ||
    die "$name, $tag: $(tail -1 "$work/err")"
}

# Triangles that gmsh makes of INPUT with the factor on its sizes.
gmsh_triangles() {
  taskset -c "$core" /usr/bin/time -o "$work/gmsh.time" -f '%U %S' timeout 120 \
    gmsh -2 -algo front2d -nt 1 -clmax "$(jq .remesh.size_max "$work/report-one")" \
    -clcurv 24 -clscale "$2" -format msh22 -o "$work/gmsh.msh" "$1" \
    >"$work/gmsh.log" 2>&1 || return 1
  awk '/^\$Elements/ { on = 1 } on && $2 == 2 { n++ } END { print n + 0 }' \
    "$work/gmsh.msh"
}

# Columns of gmsh: triangles, triangles/s, angles. It fails on some files.
gmsh_columns() {
  local wanted factor=1 n=0
  wanted=$(jq .remesh.triangles[1] "$work/report-one")
  for _ in 1 2 3 4 5; do
    n=$(gmsh_triangles "$1" "$factor") || n=0
    if [ "$n" = 0 ]; then
      echo "failed | | |"
      return
    fi
    ! holds "$n > 0.95 * $wanted && $n < 1.05 * $wanted" || break
    factor=$(calc "$factor * sqrt($n / $wanted)")
  done
  "$build/bin/vanguard" check -q -j "$work/gmsh.msh" >"$work/gmsh.json" \
    2>/dev/null || true
  awk -v n="$n" -v a="$(jq -r '.surface.quality |
      "\(.angle_min) \(.angle_min_percentile_1)"' "$work/gmsh.json")" \
    '{ split(a, b, " "); printf "%d | %.0f | %.2g, %.1f |", n, n / ($1 + $2),
       b[1], b[2] }' "$work/gmsh.time"
}

one_case() {
  local file options input
  name=$1 file=$2 options=$3
  input=$(unpack "$file")
  rm -f "$work"/times-*
  for ((i = 0; i < runs; i++)); do
    # shellcheck disable=SC2086 # options are words
    {
      remesh "$build/bin/vanguard" one 1 "$input" $options
      [ -z "$against" ] || remesh "$against" other 1 "$input" $options
      remesh "$build/bin/vanguard" two 2 "$input" $options
    }
  done
  cmp -s "$work"/new-{one,two}/in.lb8.ugrid ||
    die "$name: different bytes on two threads"
  awk -v c="$name" -v n="$(jq .remesh.triangles[1] "$work/report-one")" \
    -v t="$(cpu "$work/times-one" | median)" \
    -v w1="$(awk '{ print $3 }' "$work/times-one" | median)" \
    -v w2="$(awk '{ print $3 }' "$work/times-two" | median)" \
    -v m="$(awk '{ print $4 }' "$work/times-one" | median)" \
    -v a="$(jq -r '.surface.quality |
      "\(.angle_min) \(.angle_min_percentile_1)"' "$work/report-one")" \
    'BEGIN { split(a, b, " ")
             printf "| %s | %d | %.2f | %.0f | %.2f | %.0f | %.2g, %.1f |", c,
             n, t, n / t, w1 / w2, m / 1024, b[1], b[2] }'
  if [ -n "$against" ]; then
    paste -d' ' <(cpu "$work/times-one") <(cpu "$work/times-other") |
      awk '{ print $1 / $2 }' | median >"$work/ratio"
    cat "$work/ratio" >>"$work/ratios"
    printf ' %.2f | %.2f |' "$(cpu "$work/times-other" | median)" \
      "$(cat "$work/ratio")"
  fi
  if [ $no_peers = 0 ]; then
    case $name in
      cad-*) printf ' %s' "$(gmsh_columns "$input")" ;;
      *) printf ' | | |' ;;
    esac
  fi
  echo
}

n_case=0
while read -r name _; do
  ! wanted "$name" || n_case=$((n_case + 1))
done <<<"$table"
[ $n_case -gt 0 ] || die "no case '${cases[*]}'; see --help"
[ -z "$out" ] || : >"$out"
{
  about_machine
  [ $no_peers = 1 ] || echo "gmsh $(gmsh --version 2>&1 | tail -1)."
  echo
  printf '| case | triangles | s | triangles/s | wall, 1 over 2 threads | MB | angles |'
  [ -z "$against" ] || printf ' other, s | ratio |'
  [ $no_peers = 1 ] || printf ' gmsh: triangles | triangles/s | angles |'
  printf '\n|---|---|---|---|---|---|---|'
  [ -z "$against" ] || printf -- '---|---|'
  [ $no_peers = 1 ] || printf -- '---|---|---|'
  echo
} | say
while read -r name file options; do
  ! wanted "$name" || one_case "$name" "$file" "$options" | say
done <<<"$table"
[ -z "$against" ] || [ ! -s "$work/ratios" ] ||
  awk '{ s += log($1) } END {
    printf "| geometric mean | | | | | | | | %.3f |\n", exp(s / NR) }' \
    "$work/ratios" | say
