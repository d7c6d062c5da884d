#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# OpenFOAM as the solver of vanguard adapt:
#
#     solver  "openfoam.sh CASE [RANKS]"
#
# CASE is a folder with 0, constant and system, without a mesh; the fields in 0
# name the patches of the mesh. Each cycle gets a copy of it, with the mesh of
# the cycle and, from the second cycle on, the last fields of the previous one
# (mapFields -consistent), runs the application of system/controlDict, and
# leaves
#
#     solution.vtu  the last time, by foamToVTK, with values at the points
#     wall          its boundary, if it has wallShearStress
#     outputs.csv   the last line of every postProcessing/NAME/TIME/*.dat
#
# The deck needs foam in the setting write. Exit status: that of the first
# command that fails; its messages are in CASE/log.NAME of the cycle.
set -euo pipefail

die() { echo "openfoam.sh: $*" >&2; exit 1; }

# OpenFOAM's bashrc takes the arguments of the function that reads it for
# settings, so this function has no arguments.
load_openfoam() { set +eu; . "$settings" 2>/dev/null; set -eu; }
find_openfoam() {
  [ -z "${WM_PROJECT_DIR:-}" ] || return 0
  for settings in "${FOAM_BASHRC:-/usr/share/openfoam/etc/bashrc}" \
      /usr/lib/openfoam/*/etc/bashrc /opt/openfoam*/etc/bashrc; do
    [ -r "$settings" ] || continue
    load_openfoam
    break
  done
  command -v foamToVTK >/dev/null ||
    die "foamToVTK is not found: load OpenFOAM's etc/bashrc first"
}

# Run a command of OpenFOAM in the case, with its output in log.NAME. In the
# background, so that a signal ends it and this script at once.
child=
trap '[ -z "$child" ] || kill "$child" 2>/dev/null; exit 143' TERM INT
step() {
  local name=$1
  shift
  "$@" >"$case/log.$name" 2>&1 &
  child=$!
  wait "$child" || {
    local status=$?
    tail -n 30 "$case/log.$name" >&2
    die "$name ended with status $status; its log is $case/log.$name"
  }
}

# mapFields of OpenFOAM 1912 ends with a signal on meshes in two dimensions.
map_fields() {
  mapFields "$previous" -consistent -sourceTime latestTime \
    >log.mapFields 2>&1 && return
  echo "openfoam.sh: mapFields failed (log.mapFields): this cycle starts from" \
    "the fields in $template/0"
  rm -rf 0
  cp -r "$template_path/0" .
}

# The last values of all tables of function objects: NAME:COLUMN,VALUE.
outputs() {
  local file
  for file in "$case"/postProcessing/*/*/*.dat; do
    [ -e "$file" ] || continue
    # Columns are padded with blanks and separated by tabs; vectors have blanks.
    name=$(basename "$(dirname "$(dirname "$file")")") awk '
      { gsub(/ *\t */, "\t"); sub(/ +$/, "") }
      /^#/ { sub(/^# */, ""); n = split($0, column, "\t"); next }
      { last = $0 }
      END {
        if (split(last, value, "\t") < n) n = 0
        for (i = 2; i <= n; i++)
          if (value[i] ~ /^[-+.0-9eE]+$/)
            print ENVIRON["name"] ":" column[i] "," value[i]
      }' "$file"
  done | awk -F, '!seen[$1]++' | head -n 16
}

[ $# -ge 1 ] || die "usage: openfoam.sh CASE [RANKS]"
template=$1 ranks=${2:-1}
folder=${VANGUARD_FOLDER:?is set by vanguard adapt} stem=$VANGUARD_STEM
mesh=$folder/$stem.openfoam/constant/polyMesh
case=$folder/case previous=${VANGUARD_PREVIOUS:+$VANGUARD_PREVIOUS/case}

[ -d "$template/system" ] || die "$template is no case: it has no folder system"
[ -d "$mesh" ] || die "there is no $mesh: add foam to the setting write"
find_openfoam
template_path=$(realpath "$template")
rm -rf "$case"
cp -r "$template_path" "$case"
cp -r "$mesh" "$case/constant/"
cd "$case"
[ -z "$previous" ] || map_fields
application=$(foamDictionary -entry application -value system/controlDict)
if [ "$ranks" -gt 1 ]; then
  foamDictionary -entry numberOfSubdomains -set "$ranks" \
    system/decomposeParDict >/dev/null
  step decomposePar decomposePar -force
  step "$application" mpirun -n "$ranks" "$application" -parallel
  step reconstructPar reconstructPar -latestTime
  rm -rf processor*
else
  step "$application" "$application"
fi
step foamToVTK foamToVTK -latestTime
vtu=$(find VTK -name internal.vtu | tail -n 1)
[ -n "$vtu" ] || die "foamToVTK left no internal.vtu in $case/VTK"
outputs >"$folder/outputs.csv"
cp "$vtu" "$folder/solution.vtu"
if grep -qa "Name=.wallShearStress" "$vtu"; then
  cp -r "$(dirname "$vtu")/boundary" "$folder/wall"
fi
