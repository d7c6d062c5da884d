#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# verification/plane/run.sh: meshes of plane sections in two dimensions, with
# layers of y+ 1, wakes and farfield, judged by other programs.
#
# usage: verification/plane/run.sh [--build DIR] [--data DIR] [--work DIR]
#                                  [--out FILE] [--quick] [CASE...]
#   --build   build folder with vanguard (build/release)
#   --data    folder of real geometry (verification/fetch.md), for 30p30n, which
#             is the section of a wing at its symmetry plane
#   --work    folder for the results (default: a temporary one)
#   --out     write the table to FILE, too
#   --quick   two levels of the families instead of three
#   CASE      naca0012, blunt, 30p30n (default: all)
#
# Requirements: a valid mesh; all layers on every wall face; no angle below 20
# degrees outside the layers; no failed check of checkMesh but the aspect ratio,
# no error of cgnscheck, and gmsh counts the same cells; a family whose numbers
# of cells follow the rule within 5 %. Clients that are not installed are
# skipped.
# Exit status: 0 all passed, 1 a failure, 2 usage, 77 nothing to do.
set -uo pipefail

root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=bench/common.sh
. "$root/bench/common.sh"
# shellcheck source=tests/cli/openfoam.bash
. "$root/tests/cli/openfoam.bash"
build=$root/build/release work='' data='' quick=
take_options "build work out data" "quick" "$@"
need jq jq
make_programs "$build" vanguard
vanguard=$(realpath "$build/bin/vanguard")
work_folder plane
[ -z "$out" ] || : >"$out"
load_openfoam
failed=0

row() { echo "$*" | tee ${out:+-a "$out"}; }
bad() { echo "  FAIL: $name: $*" >&2; failed=1; }
has() { command -v "$1" >/dev/null; }

# The words of clients that agree, in `agreed`.
ask_clients() { # STEM
  local stem=$1 cells
  agreed=''
  cells=$(sed -n 's/^NELEM= //p' "$stem.su2")
  if has gmsh; then
    gmsh -parse_and_exit "$stem.msh" -save -format su2 -o "$stem.back.su2" \
      >"$stem.gmsh" 2>&1
    if [ "$(sed -n 's/^NELEM= *//p' "$stem.back.su2" 2>&1)" = "$cells" ]; then
      agreed+=' gmsh'
    else
      bad "gmsh does not count $cells cells: $(tail -1 "$stem.gmsh")"
    fi
  fi
  if has cgnscheck && [ -e "$stem.cgns" ]; then
    if cgnscheck "$stem.cgns" >"$stem.cgnscheck" 2>&1 &&
      ! grep -qa ERROR "$stem.cgnscheck"; then
      agreed+=' cgnscheck'
    else
      bad "cgnscheck: $(grep -a -m 1 ERROR "$stem.cgnscheck")"
    fi
  fi
  if checkMesh -help >/dev/null 2>&1; then
    checkMesh -case "$stem.openfoam" >"$stem.checkMesh" 2>&1
    if ! grep -q '^End' "$stem.checkMesh"; then
      bad "checkMesh did not end: $(tail -1 "$stem.checkMesh")"
    elif grep -F '***' "$stem.checkMesh" | grep -v 'High aspect ratio'; then
      bad "checkMesh, $stem.checkMesh"
    else
      agreed+=' checkMesh'
    fi
  fi
}

# Layers of y+ 1 and the wake; CGNS if this program writes it.
options=(--y-plus 1 --wakes auto --te-cells 8 --threads 2)
formats=su2,msh,foam,b8.ugrid
"$vanguard" --version --verbose | grep -qE "HDF5 +not in" || formats+=,cgns

run_case() { # NAME SECTION OPTION...
  local name=$1 section=$2 stem figures levels=1:3 ratios
  shift 2
  stem=$work/$name/$(basename "${section%.dat}")
  if ! "$vanguard" mesh -q -p "${section%.dat}" --out "$work/$name" --write $formats \
    "${options[@]}" "$@" >"$work/$name.log" 2>&1; then
    bad "no mesh: $(tail -1 "$work/$name.log")"
    return
  fi
  figures=$(jq -r '[.mesh.valid, .layers.all.percent_full, .plane.angle_min,
    .plane.quadrilaterals, .plane.triangles] | @tsv' "$stem.report.json")
  # shellcheck disable=SC2086 # words
  set -- $figures "$@"
  [ "$1" = true ] || bad "the mesh is not valid"
  awk -v p="$2" 'BEGIN { exit !(p == 100) }' || bad "full layers: $2 %"
  awk -v a="$3" 'BEGIN { exit !(a >= 20) }' || bad "smallest angle: $3 degrees"
  ask_clients "$stem"
  local text
  text=$(printf '| %s | %d | %d | %.1f | %.1f |%s |' "$name" "$4" "$5" "$2" "$3" \
    "$agreed")
  shift 5
  [ -z "$quick" ] || levels=1:2
  if ! "$vanguard" sweep -p "${section%.dat}" --family $levels \
    -o "$work/$name.family" -- "${options[@]}" --scale-layers even "$@" \
    >"$work/$name.log" 2>&1; then
    bad "no family: $(tail -1 "$work/$name.log")"
    return
  fi
  ratios=$(awk -F, 'NR > 2 { printf " %.3f (%.3f)", $5, $6
    if ($5 / $6 > 1.05 || $5 / $6 < 0.95) bad = 1 } END { exit bad }' \
    "$work/$name.family/family.csv") || bad "ratios of cells:$ratios"
  row "$text$ratios |"
}

row '| section | quadrilaterals | triangles | full layers, % | smallest angle | accepted by | cells over those of the level before (rule) |'
row '|---|---|---|---|---|---|---|'
n_run=0
if wanted naca0012; then
  "$vanguard" demo aerofoil --out "$work" >/dev/null
  run_case naca0012 "$work/aerofoil.dat" && n_run=1
fi
if wanted blunt; then
  "$vanguard" demo aerofoil-blunt --out "$work" >/dev/null
  run_case blunt "$work/aerofoil-blunt.dat" && n_run=1
fi
if wanted 30p30n; then
  wing=$data/highlift/30p30n_swept_wing_in_box_medium.lb8.ugrid.xz
  if [ ! -e "$wing" ]; then
    echo "SKIP: 30p30n: no file ${wing:-}; give --data (verification/fetch.md)"
  else
    "$root/verification/plane/sections.py" "$wing" 11 slat=1,2 main=4,5,6 \
      flap=8,9 >"$work/30p30n.dat" || exit 1
    run_case 30p30n "$work/30p30n.dat" --file-unit mm --reynolds 9e6 \
      --reference-length 1000 && n_run=1
  fi
fi
[ $failed = 0 ] || exit 1
[ $n_run = 1 ] || exit 77
