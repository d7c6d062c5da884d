#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# verification/flow/run.sh: lift and drag of NACA 0012 at Reynolds number 6 million, by
# simpleFoam with the model of Spalart and Allmaras, on families of meshes of Vanguard
# and of gmsh (docs/guide/flow.md).
#
# usage: verification/flow/run.sh [--vanguard PROGRAM] [--work DIR] [--svg FILE]
#                                 [--levels LIST] [--angle DEGREES] [NAME...]
#   vanguard  quadrilaterals in the layers, triangles elsewhere, 500 chords
#   gmsh      gmsh's mesh of about the same size: layers with the same first height and
#             growth, the same number of edges on the section
# --levels: factors on all edges, from coarse to fine (1.4,1,0.7,0.5); each starts from
# the solution of the level before. --angle: of attack (10).
# The table has the coefficients and their deviation from CFL3D's on NASA's Turbulence
# Modeling Resource. --svg draws drag over the number of cells.
# --work keeps the cases, and continues with those that are finished.
# Without NAME: both. It takes about half an hour on one processor.
# Exit status: 0: lift and drag of Vanguard's finest mesh are within 2 % and come closer
# from level to level, 1 a failure, 2 usage, 77 no OpenFOAM or gmsh.
set -uo pipefail
export LC_ALL=C

here=$(cd "$(dirname "$0")" && pwd)
vanguard=$here/../../build/release/bin/vanguard work='' svg='' levels=1.4,1,0.7,0.5
angle=10
usage() { sed -n '2,/^set /p' "$0" | sed '$d; s/^# \{0,1\}//'; }
while [ $# -gt 0 ]; do
  case $1 in
    --vanguard|--work|--svg|--levels|--angle)
      [ $# -gt 1 ] || { usage >&2; exit 2; }
      declare "${1#--}=$2"
      shift 2 ;;
    -h|--help) usage; exit 0 ;;
    vanguard|gmsh) break ;;
    *) usage >&2; exit 2 ;;
  esac
done
[ $# -gt 0 ] || set -- vanguard gmsh

# shellcheck source=tests/cli/openfoam.bash
. "$here/../../tests/cli/openfoam.bash"
load_openfoam
for program in simpleFoam gmshToFoam gmsh; do
  command -v $program >/dev/null || { echo "SKIP: no $program"; exit 77; }
done
vanguard=$(realpath "$vanguard") || exit 2
if [ -z "$work" ]; then
  work=$(mktemp -d) || exit 1
  trap 'rm -rf "$work"' EXIT
fi
[ -z "$svg" ] || svg=$(realpath "$svg")
mkdir -p "$work" && work=$(realpath "$work") && cd "$work" || exit 1

# shellcheck source=verification/flow/case.bash
. "$here/case.bash"
# shellcheck source=verification/flow/meshes.bash
. "$here/meshes.bash"
# shellcheck source=verification/flow/table.bash
. "$here/table.bash"

IFS=, read -ra level <<<"$levels"
for name; do
  from=''
  for s in "${level[@]}"; do
    mesh_of "$name" "$s" && solve "$name-$s" "$angle" "$from" ||
      { echo "FAILED: $name $s"; exit 1; }
    from=$name-$s-$angle
  done
done
table "$@" | tee results.txt
[ -z "$svg" ] || python3 "$here/plot.py" "$angle" results.txt >"$svg" || exit 1
judge results.txt
