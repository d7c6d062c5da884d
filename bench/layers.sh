#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# bench/layers.sh: the cost of viscous layers, phase by phase.
#
# usage: bench/layers.sh [--quick] [--out FILE] [--build DIR] [--work DIR]
#                        [--runs N] [--threads LIST] [--data DIR] [CASE...]
#   --quick    the smallest size of each wing, one run
#   --out      write the tables to FILE too
#   --build    build folder (default build/release, built if missing)
#   --work     folder for the written mesh (default: a temporary one)
#   --runs     runs of a case; medians are shown (default 3)
#   --threads  numbers of threads (default "1 2")
#   --data     folder of real geometry (verification/fetch.md), whose surfaces
#              are used too; for these only layers are made, joined and written
#   CASE       wing wing-half wing-sharp, or a surface of --data
#
# Layers with y+ 1 at Re 5 million based on the mean chord and ratio 1.2. Phases
# are wall-clock times of the report of vg_layers_grow; "D + H + C" are
# directions, heights and collisions together. Joining makes the whole mesh of
# layers and other cells from an empty mesh; writing makes a .b8.ugrid in the
# work folder, through the page cache. In wall / CPU time, the CPU time (user
# and system time of all threads) shows how much other load disturbed the
# wall-clock time; "by CPU time" is the rate corrected for this disturbance, per
# core, provided that it was uniform.
set -euo pipefail

root=$(cd "$(dirname "$0")/.." && pwd)
# shellcheck source=bench/common.sh
. "$root/bench/common.sh"
build=$root/build/release
work='' data='' quick=0 runs=3 threads='1 2'

take_options "out build work runs threads data" quick "$@"
[ $quick = 0 ] || runs=1

# Isotropic cells requested from `vanguard demo`: 2, 5 and 10 million tetrahedra
# with the layers.
sizes="600000 1100000 2000000"
[ $quick = 0 ] || sizes=600000

# name, file below --data, walls, b: body or d: domain, mean chord, Re
surfaces="
dlr_f6_coarse  transport/dlr_f6_wbnp_half_coarse.lb8.ugrid.xz       1-123 d 141.2 3e6
dlr_f6_medium  transport/dlr_f6_wbnp_half_medium.lb8.ugrid.xz       1-123 d 141.2 3e6
onera_m6       transport/onera_m6_sharp_te_farfield.lb8.ugrid.xz    3-12 d 0.646 11.72e6
30p30n_coarse  highlift/30p30n_swept_wing_in_box_coarse.lb8.ugrid.xz 1-10 d 1000 9e6
30p30n_medium  highlift/30p30n_swept_wing_in_box_medium.lb8.ugrid.xz 1-10 d 1000 9e6
falcon         bizjet/falcon_full_mirrored.lb8.ugrid.xz             1-999 b 2.9 5e6
p180           bizjet/p180_avanti_full.lb8.ugrid.xz                 1-999 b 1.14 5e6
concorde       supersonic/concorde_full.lb8.ugrid.xz                1-999 b 14 5e6
f16            supersonic/f16_full.lb8.ugrid.xz                     1-999 b 3.4 5e6
low_boom       supersonic/low_boom_sst_full.lb8.ugrid.xz            1-999 b 20 5e6
tmx1242        supersonic/tmx1242_wing_body.lb8.ugrid.xz            1-999 b 9 5e6
tnd6480        supersonic/tnd6480_delta_wing_body.lb8.ugrid.xz      1-999 b 15 5e6
"

make_programs "$build" vg_bench_layers
program=$build/bin/vg_bench_layers

work_folder layers
rows=$work/rows
: > "$rows"

run_case() {   # run_case NAME OPTION...
  local name=$1 t
  shift
  for t in $threads; do
    "$program" --name "$name" --threads "$t" --runs "$runs" \
      --out "$work/mesh.b8.ugrid" "$@" | tee -a "$rows" >&2 ||
      die "$name failed, see above"
  done
}

for wing in wing wing-half wing-sharp; do
  wanted $wing || continue
  for n in $sizes; do run_case $wing --demo $wing --cells "$n"; done
done
if [ -n "$data" ] && [ $quick = 0 ]; then
  while read -r name file walls kind length reynolds; do
    if [ -z "$name" ] || ! wanted "$name"; then continue; fi
    if [ ! -e "$data/$file" ]; then
      echo "SKIP $name: no $file below --data (verification/fetch.md)" >&2
      continue
    fi
    surface=$work/$(basename "${file%.xz}")
    xz -dc "$data/$file" > "$surface"
    domain=no
    [ "$kind" = b ] || domain=yes
    run_case "$name" --fill no --walls "$walls" --domain $domain \
      --length "$length" --reynolds "$reynolds" "$surface"
    rm -f "$surface"
  done <<< "$surfaces"
fi
[ -s "$rows" ] || die "no such case; see --help"

[ -z "$out" ] || : > "$out"
{
  echo "$(about_machine)" \
    "Medians of $runs runs, load before $(cut -d' ' -f1 /proc/loadavg)."
  cat << END

Growing, microseconds per wall point:

| case | threads | wall points | layer tetrahedra | mean levels | topology | directions | heights | clearance | slide patches | D + H + C, wall points/s | the same by CPU time | wall / CPU, s | all phases, wall points/s | all phases, M layer cells/s | rounds |
|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|
END
  sed -n 's/^grow //p' "$rows"
  cat << END

Joining and writing:

| case | threads | cells | all cells | layer cells | % prisms of these | joining, M cells/s | wall / CPU, s | writing: wall / CPU, s | MB/s | both, M cells/s |
|---|---|---|---|---|---|---|---|---|---|---|
END
  sed -n 's/^join //p' "$rows"
} | say
