#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# verification/zones/run.sh: do solvers of OpenFOAM run on the zones, inner surfaces
# and periodic patches of a mesh?
#
# usage: verification/zones/run.sh [--vanguard PROGRAM] [--data DIR] [--work DIR]
#                                  [--meshcheck PROGRAM] [NAME...]
#   rotor  `vanguard demo rotor` in simpleFoam, with the MRFProperties of
#          docs/guide/zones.md: the initial residuals fall below 1e-3, and the
#          blades turn
#   ami    the same mesh with a doubled interface (cyclicAMI) on which the zone
#          turns, in pimpleFoam: the sums of the weights of its faces are within
#          5 % of 1, and all but 0.1 % of the mass passes
#   fins   `vanguard demo fins` in splitMeshRegions, simpleFoam and
#          chtMultiRegionFoam: the 100 W of the solid arrive in the flow and in
#          the outflow
#   exchanger  `vanguard demo exchanger` in the same programs: the hot fluid loses
#          the heat that the cold one gains
#   baffle a duct with a baffle and a sheet, both with layers, in simpleFoam: the
#          initial residuals fall below 1e-3, and all of the flow passes the
#          sheet
#   passage  `vanguard demo passage` between cyclic patches, in simpleFoam: the
#          initial residuals fall below 1e-3, and the blade turns the flow
#   wake   half of the ONERA M6 (--data) with its wake as a sheet: layers on both
#   blades half domain of two rotor blades with four wakes (--data): full layers on
#          99 % of the blades, and of the wakes away from free edges; needs no OpenFOAM.
#          --meshcheck is an independent judge of NAME.b8.ugrid, exit status 0: valid
# checkMesh finds no fault in the meshes, and none in the regions of
# fins and exchanger.
# Without NAME: all of them.
# Exit status: 0 all passed, 1 a failure, 2 usage, 77 no OpenFOAM.
set -uo pipefail
export LC_ALL=C

here=$(cd "$(dirname "$0")" && pwd)
vanguard=$here/../../build/release/bin/vanguard data='' work='' meshcheck=''
usage() { sed -n '2,/^# Exit status/p' "$0" | sed 's/^# \{0,1\}//'; }
while [ $# -gt 0 ]; do
  case $1 in
    --vanguard|--data|--work|--meshcheck)
      [ $# -gt 1 ] || { usage >&2; exit 2; }
      declare "${1#--}=$2"
      shift 2 ;;
    -h|--help) usage; exit 0 ;;
    rotor|ami|fins|exchanger|baffle|passage|wake|blades) break ;;
    *) usage >&2; exit 2 ;;
  esac
done
[ $# -gt 0 ] || set -- rotor ami fins exchanger baffle passage wake blades

if [ "$*" != blades ] && ! command -v checkMesh >/dev/null; then
  echo "SKIP: no OpenFOAM (checkMesh is not in PATH)"
  exit 77
fi
environment() {
  # shellcheck disable=SC1090
  . "${FOAM_BASHRC:-/usr/share/openfoam/etc/bashrc}" 2>/dev/null
}
if [ -z "${WM_PROJECT_DIR:-}" ]; then
  set +u
  environment
  set -u
fi
if [ "$*" != blades ] && ! checkMesh -help >/dev/null 2>&1; then
  echo "SKIP: OpenFOAM does not start; source its etc/bashrc first"
  exit 77
fi
vanguard=$(realpath "$vanguard") || exit 2
[ -z "$meshcheck" ] || meshcheck=$(realpath "$meshcheck") || exit 2
if [ -z "$work" ]; then
  work=$(mktemp -d) || exit 1
  trap 'rm -rf "$work"' EXIT
fi
mkdir -p "$work" && work=$(realpath "$work") || exit 1
failures=0

bad() { echo "FAILED: $*"; failures=$((failures + 1)); }

# dictionary FILE [CLASS]: a file of OpenFOAM with the entries of the input.
dictionary() {
  mkdir -p "$(dirname "$1")"
  printf 'FoamFile { version 2.0; format ascii; class %s; object %s; }\n' \
    "${2:-dictionary}" "$(basename "$1")" >"$1"
  cat >>"$1"
}

# run LIMIT_S PROGRAM [OPTION...]: its output is in PROGRAM.log.
run() {
  local limit=$1 log
  log=$(basename "$2").log
  shift
  if ! timeout "$limit" "$@" >"$log" 2>&1; then
    bad "$*"
    tail -n 20 "$log"
    return 1
  fi
}

# sound [OPTION...]: checkMesh finds no fault.
sound() {
  run 120 checkMesh "$@" || return
  grep -q '^Mesh OK.' checkMesh.log ||
    { bad "checkMesh $*"; grep '\*' checkMesh.log; }
  sed -n 's/^ *\(Mesh non-orth.*\|Max skew.*\)/  \1/p' checkMesh.log
}

# shellcheck source=verification/zones/rotor.bash
. "$here/rotor.bash"
# shellcheck source=verification/zones/ami.bash
. "$here/ami.bash"
# shellcheck source=verification/zones/fins.bash
. "$here/fins.bash"
# shellcheck source=verification/zones/exchanger.bash
. "$here/exchanger.bash"
# shellcheck source=verification/zones/baffle.bash
. "$here/baffle.bash"
# shellcheck source=verification/zones/passage.bash
. "$here/passage.bash"
# shellcheck source=verification/zones/wake.bash
. "$here/wake.bash"
# shellcheck source=verification/zones/blades.bash
. "$here/blades.bash"
for name; do
  echo "== $name"
  cd "$work" || exit 1
  "$name"
done
[ "$failures" = 0 ] && echo good
[ "$failures" = 0 ]
