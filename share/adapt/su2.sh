#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# SU2 as the solver of vanguard adapt:
#
#     solver  "su2.sh CONFIG [RANKS]"
#
# CONFIG is a file for SU2_CFD whose markers are the patches of the mesh. Each
# cycle gets a copy of it, runs SU2_CFD on the .su2 mesh, and leaves
#
#     solution.csv  the restart file, in the order of the points of the mesh
#     wall.vtu      surface_flow.vtu
#     outputs.csv   the last line of history.csv
#
# The deck needs "su2,b8.ugrid" in the setting write: the metric is computed on
# the points of the .b8.ugrid, which both files number alike.
set -euo pipefail

die() { echo "su2.sh: $*" >&2; exit 1; }

[ $# -ge 1 ] || die "usage: su2.sh CONFIG [RANKS]"
config=$1 ranks=${2:-1}
folder=${VANGUARD_FOLDER:?is set by vanguard adapt} stem=$VANGUARD_STEM
[ -r "$config" ] || die "there is no $config"
[ -e "$folder/$stem.su2" ] ||
  die "there is no $folder/$stem.su2: add su2 to the setting write"
[ -e "$folder/$stem.b8.ugrid" ] ||
  die "there is no $folder/$stem.b8.ugrid: add b8.ugrid to the setting write"
command -v SU2_CFD >/dev/null || die "SU2_CFD is not found: set PATH"

# Settings of CONFIG, except those that the loop sets.
own='MESH_FILENAME|MESH_FORMAT|RESTART_FILENAME|CONV_FILENAME|TABULAR_FORMAT'
own="$own|OUTPUT_FILES|RESTART_SOL|SURFACE_FILENAME"
{
  grep -vE "^[ \t]*($own)[ \t]*=" "$config" || true
  echo "MESH_FILENAME= $stem.su2"
  echo "MESH_FORMAT= SU2"
  echo "RESTART_SOL= NO"
  echo "RESTART_FILENAME= restart_flow"
  echo "CONV_FILENAME= history"
  echo "TABULAR_FORMAT= CSV"
  echo "SURFACE_FILENAME= surface_flow"
  echo "OUTPUT_FILES= RESTART_ASCII, PARAVIEW, SURFACE_PARAVIEW"
} >"$folder/$stem.cfg"
cd "$folder"
if [ "$ranks" -gt 1 ]; then mpirun -n "$ranks" SU2_CFD "$stem.cfg"
else SU2_CFD "$stem.cfg"; fi
[ -e restart_flow.csv ] || die "SU2_CFD left no restart_flow.csv in $folder"
if [ -e history.csv ]; then
  awk -F, '
    NR == 1 { n = split($0, name, ","); next }
    { last = $0 }
    END {
      split(last, value, ",")
      for (i = 1; i <= n && k < 16; i++) {
        gsub(/["\t ]/, "", name[i]); gsub(/[\t ]/, "", value[i])
        if (name[i] ~ /^C[A-Z]/ && value[i] ~ /^[-+.0-9eE]+$/) {
          print name[i] "," value[i]; k++
        }
      }
    }' history.csv >outputs.csv
fi
mv restart_flow.csv solution.csv
[ ! -e surface_flow.vtu ] || cp surface_flow.vtu wall.vtu
