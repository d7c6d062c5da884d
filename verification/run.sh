#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# verification/run.sh: mesh real geometry and check every result.
#
# usage: verification/run.sh --data DIR [--quick] [--vanguard PROGRAM]
#            [--threads N] [--meshcheck PROGRAM] [--work DIR] [--out FILE]
#            [NAME...]
#   --data       folder of the geometry (verification/fetch.md)
#   --quick      only small cases: seconds instead of minutes
#   --vanguard   the program (default build/release/bin/vanguard)
#   --threads    threads of every run (default 1); the report of a run with
#                another number is a failure
#   --meshcheck  another checker, run as PROGRAM -q [-s SURFACE] MESH.lb8.ugrid;
#                exit status 0 if the mesh is valid and has all triangles of the
#                surface
#   --work       scratch folder, kept (default: a temporary one, removed)
#   --out        write the table to FILE too
#   NAME         only these cases
# Exit status: 0 all as expected, 1 a failure, 2 usage, 77 no data.
set -uo pipefail
export LC_ALL=C

root=$(cd "$(dirname "$0")/.." && pwd)
vanguard=$root/build/release/bin/vanguard
data='' work='' out='' meshcheck='' quick=0 threads=1 only=()
LIMIT_S=3600

usage() { sed -n '2,/^# Exit status/p' "$0" | sed 's/^# \{0,1\}//'; }

while [ $# -gt 0 ]; do
  case $1 in
    --quick) quick=1 ;;
    --data|--vanguard|--threads|--meshcheck|--work|--out)
      [ $# -gt 1 ] || { usage >&2; exit 2; }
      declare "${1#--}=$2"
      shift ;;
    -h|--help) usage; exit 0 ;;
    -*) usage >&2; exit 2 ;;
    *) only+=("$1") ;;
  esac
  shift
done

if [ -z "$data" ] || [ ! -d "$data" ]; then
  echo "SKIP: no folder of geometry: give --data DIR (verification/fetch.md)"
  exit 77
fi
[ -x "$vanguard" ] || { echo "no program $vanguard: build it first" >&2
                        exit 2; }
if [ -z "$work" ]; then
  work=$(mktemp -d "${TMPDIR:-/tmp}/vanguard-verify.XXXXXX")
  trap 'rm -rf "$work"' EXIT
fi
mkdir -p "$work"

# name; file below --data; kind:
#   project is complete       domain  bounds the fluid by itself
#   wall    needs a farfield  dirty   must be refused
# (A closed shell whose normals point outwards may be a body or a domain, so the
# deck of a file without boundary conditions must say which.)
# volume of the fluid without farfield if it is known exactly, otherwise "-";
# q: part of --quick
cases="
vgrid_box        vgrid_box/box                                       project 8000 q
dlr_f6_coarse    transport/dlr_f6_wbnp_half_coarse.lb8.ugrid.xz      domain - -
dlr_f6_medium    transport/dlr_f6_wbnp_half_medium.lb8.ugrid.xz      domain - -
onera_m6         transport/onera_m6_sharp_te_farfield.lb8.ugrid.xz   domain - -
onera_m6_ugawg   transport/onera_m6_om6ste01.meshb.xz                domain - q
30p30n_coarse    highlift/30p30n_swept_wing_in_box_coarse.lb8.ugrid.xz domain - -
30p30n_medium    highlift/30p30n_swept_wing_in_box_medium.lb8.ugrid.xz domain - -
hemisphere       simple/hemisphere_cylinder_farfield.lb8.ugrid.xz    domain - q
cone_cone        simple/cone_cone.lb8.ugrid.xz                       domain - q
cube_sphere      simple/cube_sphere_coarse_volume.meshb.xz           domain - q
cube_sphere_uni  simple/cube_sphere_uniform_volume.meshb.xz          domain - q
cigar            simple/cape_cigar_viscous_volume.lb8.ugrid.xz       domain - q
bullet           simple/cape_bullet.tri.xz                           wall - q
ellipsoid        simple/cape_ellipsoid.lr4.tri                       wall - q
falcon           bizjet/falcon_full_mirrored.lb8.ugrid.xz            wall - -
p180             bizjet/p180_avanti_full.lb8.ugrid.xz                wall - -
concorde         supersonic/concorde_full.lb8.ugrid.xz               wall - -
f16              supersonic/f16_full.lb8.ugrid.xz                    wall - -
low_boom         supersonic/low_boom_sst_full.lb8.ugrid.xz           wall - -
tmx1242          supersonic/tmx1242_wing_body.lb8.ugrid.xz           wall - -
tnd6480          supersonic/tnd6480_delta_wing_body.lb8.ugrid.xz     wall - -
drivaer          dirty/drivaer_fastback_body.obj.gz                  dirty - -
f16_parts        dirty/f16_components_overlapping.stl.xz             wall - q
motorbike        dirty/motorbike.obj.gz                              dirty - -
cfdmesh_concorde dirty/openvsp_cfdmesh_concorde.tri.xz               dirty - q
cfdmesh_lowboom  dirty/openvsp_cfdmesh_lowboom.tri.xz                dirty - q
three_plugs      dirty/three_plugs.bin.tri.xz                        wall - q
toy_airplane     dirty/toy_airplane_with_holes.obj.xz                dirty - q
"

say() { if [ -n "$out" ]; then tee -a "$out"; else cat; fi; }

# The first number after "key": in the part "mesh" (or $3) of a report.
json() {
  awk -v key="\"$2\":" -v part="\"${3:-mesh}\":" '
    $1 == part { on = 1 }
    on && $1 == key { sub(/,$/, "", $2); print $2; exit }' "$1"
}

# Seconds of the fill: the last object "seconds" of a report is that of the run.
seconds() {
  awk '$1 == "\"seconds\":" { on = 1; t = 0 }
    on && $1 == "\"fill\":" { t = $2 + 0 } END { print t }' "$1"
}

# Unpacked copy of the input in folder $1; a project is its stem.
stage() {
  local from=$data/$2 name
  name=$(basename "$2")
  case $2 in
    *.xz) xz -dc "$from" > "$1/${name%.xz}" && echo "$1/${name%.xz}" ;;
    vgrid_box/box) cp "$from".d3m "$from".front "$from".mapbc "$1/" &&
      echo "$1/box" ;;
    *) cp "$from" "$1/" && echo "$1/$name" ;;
  esac
}

present() { [ -e "$data/$1" ] || [ -e "$data/$1.d3m" ]; }

# The run deck of a domain or body.
write_deck() {
  local farfield=none
  [ "$3" != wall ] || farfield=sphere
  cat > "$1" << END
$2

farfield
kind       lengths
$farfield  20
END
}

why=''
bad() { why="${why:+$why; }$*"; }

# Mesh the case and check the result. Sets row.
mesh_case() {
  local d=$1 name=$2 kind=$3 volume=$4 input=$5 report result options=()
  why='' row=''
  if [ "$kind" != project ]; then
    write_deck "$d/deck" "$name" "$kind"
    options=(--deck "$d/deck")
  fi
  timeout $LIMIT_S "$vanguard" mesh -q -p "$input" --out "$d/out" \
    --write lb8.ugrid --threads "$threads" "${options[@]}" > "$d/log" 2>&1
  local status=$?
  report=$(echo "$d"/out/*.report.json)
  result=$(echo "$d"/out/*.lb8.ugrid)
  if [ $status != 0 ] || [ ! -f "$result" ]; then
    bad "exit $status: $(grep -a '^vanguard:' "$d/log" | tail -1)"
    return
  fi
  [ "$(json "$report" threads partition)" = "$threads" ] ||
    bad "not $threads threads"
  "$vanguard" check -q "$result" > "$d/check" 2>&1 || bad "vanguard check"
  case $kind in
    wall) [ "$(json "$report" farfield domain)" = true ] ||
      bad "no farfield was added" ;;
    *) [ "$(json "$report" farfield domain)" = false ] ||
      bad "a farfield was added" ;;
  esac
  if [ "$volume" != - ]; then
    awk -v a="$(json "$report" volume)" -v b="$volume" \
      'BEGIN { d = a / b - 1; exit !(d < 1e-9 && d > -1e-9) }' ||
      bad "the volume is not $volume"
  fi
  if [ -n "$meshcheck" ]; then
    local surface=()
    case $input in *.lb8.ugrid) surface=(-s "$input") ;; esac
    "$meshcheck" -q "${surface[@]}" "$result" > "$d/meshcheck" 2>&1 ||
      bad "meshcheck: $(grep -a FAIL "$d/meshcheck" | head -1)"
  fi
  row=$(printf '%d | %.1f | %.2f / %.2f | %.4f' "$(json "$report" cells)" \
    "$(seconds "$report")" "$(json "$report" angle_min)" \
    "$(json "$report" angle_max)" "$(json "$report" radius_ratio_mean)")
}

# A refusal: exit status 1, a message, no mesh. Sets row.
dirty_case() {
  local d=$1 input=$2 status
  why='' row='- | - | - | -'
  timeout $LIMIT_S "$vanguard" mesh -q -p "$input" --out "$d/out" \
    --write lb8.ugrid --threads "$threads" > "$d/log" 2> "$d/err"
  status=$?
  [ $status = 1 ] || bad "exit $status instead of 1"
  grep -q '^vanguard: .' "$d/err" || bad "no message"
  [ -z "$(find "$d/out" -name '*.lb8.ugrid' 2> /dev/null)" ] ||
    bad "a mesh was written"
}

wanted() {
  [ ${#only[@]} = 0 ] || { printf '%s\n' "${only[@]}" | grep -qx "$1"
                           return; }
  [ $quick = 0 ] || [ "$2" = q ]
}

[ -z "$out" ] || : > "$out"
say << END
| case | input | result | cells | fill on $threads thread(s), s | dihedral min / max | radius ratio |
|---|---|---|---|---|---|---|
END
failed=0 done=0
while read -r name file kind volume small; do
  if [ -z "$name" ] || ! wanted "$name" "$small"; then continue; fi
  if ! present "$file"; then
    echo "| $name | $file | no such file (verification/fetch.md) | | | | |" | say
    failed=1
    continue
  fi
  d=$work/$name
  rm -rf "$d"
  mkdir -p "$d"
  why='' row='- | - | - | -'
  if ! input=$(stage "$d" "$file"); then bad "cannot unpack"
  elif [ "$kind" = dirty ]; then dirty_case "$d" "$input"
  else mesh_case "$d" "$name" "$kind" "$volume" "$input"
  fi
  result=valid
  [ "$kind" != dirty ] || result="refused: $(sed -n \
    's/^vanguard: //p' "$d/err" | head -1 | cut -c1-60)"
  [ -z "$why" ] || { result="FAIL: $why"; failed=1; }
  echo "| $name | $file | $result | ${row:-- | - | - | -} |" | say
  done=$((done + 1))
  find "$d" -type f -size +1M -delete
done <<< "$cases"
if [ $done = 0 ] && [ $failed = 0 ]; then
  echo "no such case" >&2
  exit 2
fi
if [ $failed = 0 ]; then echo "$done cases, all as expected" | say
else echo "FAILED" | say; fi
exit $failed
