# SPDX-License-Identifier: LGPL-3.0-or-later
# bench/aircraft.sh: surfaces of the data folder, and their settings for layers.
# Sourced after common.sh; `vanguard` is the program.
# shellcheck shell=bash disable=SC2034,SC2154 # for, and from, the caller

# name, file below the data folder, patches that are walls (all: a body in open
# air), mean chord, Reynolds number; chords without a source are estimated from
# the bounding box.
aircraft_table="
dlr_f6_coarse transport/dlr_f6_wbnp_half_coarse.lb8.ugrid.xz 1-123 141.2 3e6
dlr_f6_medium transport/dlr_f6_wbnp_half_medium.lb8.ugrid.xz 1-123 141.2 3e6
onera_m6      transport/onera_m6_sharp_te_farfield.lb8.ugrid.xz 3-12 0.646 11.72e6
30p30n_coarse highlift/30p30n_swept_wing_in_box_coarse.lb8.ugrid.xz 1-10 1000 9e6
30p30n_medium highlift/30p30n_swept_wing_in_box_medium.lb8.ugrid.xz 1-10 1000 9e6
falcon        bizjet/falcon_full_mirrored.lb8.ugrid.xz all 2.9 5e6
low_boom      supersonic/low_boom_sst_full.lb8.ugrid.xz all 20 5e6
f16           supersonic/f16_full.lb8.ugrid.xz all 3.4 5e6
tmx1242       supersonic/tmx1242_wing_body.lb8.ugrid.xz all 8 5e6
"

# aircraft DATA NAME FOLDER: copy the surface, compressed or not, to FOLDER;
# sets `project` and `options` for meshing. Status 1, with a message: no such
# file.
aircraft() {
  local name file walls length reynolds
  read -r name file walls length reynolds < <(
    awk -v n="$2" '$1 == n' <<< "$aircraft_table") || return 1
  mkdir -p "$3"
  project=$3/$name.lb8.ugrid
  if [ -e "$1/${file%.xz}" ]; then cp -f "$1/${file%.xz}" "$project"
  elif [ -e "$1/$file" ]; then xz -dc "$1/$file" > "$project"
  else
    echo "no $1/$file: verification/fetch.md has the source" >&2
    return 1
  fi
  options=(--layers yes --y-plus 1 --reynolds "$reynolds"
    --reference-length "$length" --ratio 1.2)
  case $walls in
    all) options+=(--farfield sphere) ;;
    *) options+=(--farfield none --walls "$walls") ;;
  esac
}

# demo_project NAME CELLS FOLDER: the same for a case of vanguard demo.
demo_project() {
  project=$3/$1.$2/$1
  options=()
  [ -e "$project.lb8.ugrid" ] ||
    "$vanguard" demo "$1" --cells "$2" --out "$3/$1.$2" > /dev/null
}
