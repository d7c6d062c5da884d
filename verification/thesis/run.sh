#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# verification/thesis/run.sh: the cases of the thesis on PVGRID, at sizes for 2
# cores and 24 GiB.
#
# usage: verification/thesis/run.sh [--quick] [--scale X] [--data DIR]
#          [--build DIR] [--meshcheck PROGRAM] [--work DIR] [--out FILE]
#          [--json FILE] [CASE...]
#   --quick      all cases at a hundredth of their size
#   --scale      numbers of cells times X (default 1)
#   --data       folder of real geometry (verification/fetch.md), for aircraft
#   --build      build folder (default build/release, built if missing)
#   --meshcheck  another checker, run as PROGRAM -q MESH.b8.ugrid; exit status
#                0: valid
#   --work       scratch folder, kept (default: a temporary one, removed)
#   --out        write the tables to FILE too
#   --json       all runs as one JSON file
#   CASE         box sphere wing aircraft jet
#
# box 23 M and sphere 12 M as in the thesis; wing and aircraft with viscous
# layers, 20 M and more, in place of its DLR-F6 and EET; jet: a nozzle whose
# fine plume fills a corner of a large box, where one of 16 subdomains of equal
# volume has most of the work. Each runs on one thread, two ranks and two
# threads, which must write the same files. The timeline of one thread is
# replayed on 64 workers and compared with the 64 processors of the thesis
# (README.md). All cases take about 8 minutes on two idle cores, and 4 GB of
# disk.
# Exit status: 0 all valid and equal, 1 not, 2 usage.
# Needs: jq, time, openmpi-bin.
set -euo pipefail

root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=bench/common.sh
. "$root/bench/common.sh"
# shellcheck source=bench/aircraft.sh
. "$root/bench/aircraft.sh"
build=$root/build/release
work='' json='' data='' meshcheck='' quick=0 scale=1
project='' options=() options_all=() this=''
take_options "scale data build meshcheck work out json" quick "$@"
[ "$quick" = 0 ] || scale=$(calc "$scale / 100")
to_measure thesis
rows=$work/rows.json failed=0
: > "$rows"
[ -z "$out" ] || : > "$out"
cells() { calc "int($1 * $scale)"; }

# once CASE HOW OPTION...: HOW is RANKSxTHREADS. Sets the digest `this`.
once() {
  local name=$1 how=$2
  local d=$work/$name.$how
  shift 2
  run_mesh "$vanguard" "$d" "${how%x*}" "${how#*x}" -p "$project" \
    "${options[@]}" "$@" ||
    die "$name $how failed: $(grep -a '^vanguard' "$d/log" | tail -1)"
  jq -c --arg case "$name" --arg how "$how" '{case: $case, how: $how} + .' \
    "$d/row.json" >> "$rows"
  echo "$name $how: $(get "$d/row.json" '"\(.wall) s"')" >&2
  this=$(digest "$d/out")
  if [ -n "$meshcheck" ] && [ "$how" = 2x1 ]; then
    "$meshcheck" -q "$d"/out/*.b8.ugrid > "$d/meshcheck" 2>&1 || {
      echo "$name: the other checker refuses it: $d/meshcheck" >&2; failed=1; }
  fi
  [ "$(get "$d/row.json" .valid)" = true ] || {
    echo "$name $how: not valid" >&2; failed=1; }
  find "$d/out" -type f ! -name '*.json' -size +1M -delete
}

row() {   # row CASE HOW RESULT
  jq -r --slurpfile one "$work/$1.1x1/row.json" --arg case "$1" --arg how "$2" \
    --arg result "$3" '
    def f($d): . * pow(10; $d) | round / pow(10; $d);
    .seconds as $s | "| \($case) | \(.cells) | \($how) | \(.wall | f(1)) | " +
    "\($s.layers | f(1)) | \($s.cut_fill | f(1)) | " +
    "\($s.judge + $s.write | f(1)) | \($one[0].wall / .wall | f(2)) | " +
    "\(.leaves) | \(100 * .zone_share | f(1)) | \(.imbalance | f(3)) | " +
    "\(.peak_mb | f(0)) | \(.angle_min | f(2)) | \($result) |"' \
    "$work/$1.$2/row.json" | say
}

# Run a case on one and on two cores.
three() {
  local how first='' result
  for how in 1x1 2x1 1x2; do
    once "$1" $how
    first=${first:-$this} result='the same'
    [ "$this" = "$first" ] || { result='DIFFERS'; failed=1; }
    [ $how != 1x1 ] || result='-'
    row "$1" $how "$result"
  done
}

# forecast NAME TIMELINE WORKERS: lines of the second table.
forecast() {
  "$vanguard" plan --replay "$2" --ranks "$3" --serial 0 --json \
    > "$work/tasks.json"
  "$vanguard" plan --replay "$2" --ranks "$3" --json |
    jq -r --slurpfile tasks "$work/tasks.json" --arg name "$1" '
    def f($d): . * pow(10; $d) | round / pow(10; $d);
    .forecast[0] as $all | $tasks[0].forecast[0] | "| \($name) | " +
    "\(.workers) | \(.cuts_end | f(2)) | \(.seconds | f(2)) | " +
    "\($all.seconds | f(2)) | \(.speedup | f(2)) | " +
    "\($all.speedup | f(2)) | \(.imbalance | f(3)) |"'
}

# --- the jet ------------------------------------------------------------------

# A nozzle of length 1, radius 0.15, along x from the origin: rings of points
# with a disc at both ends.
nozzle() {
  awk 'BEGIN {
    n = 24; pi = atan2(0, -1); r = 0.15
    k = 0
    for (j = 3; j >= 1; j--) ring[k++] = "0 " r * j / 3      # inner to outer:
    for (j = 1; j <= 26; j++) ring[k++] = j / 26 " " r       # see below
    for (j = 2; j >= 1; j--) ring[k++] = "1 " r * j / 3
    # the first disc from its centre outwards
    t = ring[0]; ring[0] = ring[2]; ring[2] = t
    print "v 0 0 0"
    for (i = 0; i < k; i++) {
      split(ring[i], p, " ")
      for (a = 0; a < n; a++)
        printf "v %.9f %.9f %.9f\n", p[1], p[2] * cos(2 * pi * a / n),
               p[2] * sin(2 * pi * a / n)
    }
    print "v 1 0 0"
    for (a = 0; a < n; a++) {
      b = (a + 1) % n
      print "f", 1, 2 + b, 2 + a
      for (i = 0; i + 1 < k; i++) {
        s = 2 + i * n; t = s + n
        print "f", s + a, s + b, t + b
        print "f", s + a, t + b, t + a
      }
      print "f", 2 + k * n, 2 + (k - 1) * n + a, 2 + (k - 1) * n + b
    }
  }'
}

# The nozzle is near the corner of a box of 80 lengths. Its plume is a cone of
# fine cells, ten lengths from the faces of the box; over this distance cells
# can shrink to the spacing of the cone at a growth of 1.2. The spacing follows
# from the number of cells: nearly all are in the cone and in the layer around
# it in which cells grow to twice its spacing.
jet_project() {
  local d=$work/input/jet h
  mkdir -p "$d"
  nozzle > "$d/jet.obj"
  # 6.5 cells per cube of the spacing; 14.1 is the volume of the cone; the
  # growth around it adds about 50 %
  h=$(calc "exp(log(1.5 * 6.5 * 14.1 / $1) / 3)")
  cat > "$d/jet.deck" << DECK
A supersonic jet in the corner of a large box

growth
1.2

farfield
kind  spacing  xlo  ylo  zlo  xhi  yhi  zhi
box   2        -9   -11  -11  71   69   69

sources
kind      x0  y0  z0  x1  y1  z1  r0    r1   h0
cylinder  1   0   0   11  0   0   0.25  1.0  $h
DECK
  project=$d/jet.obj
  options=(--layers no)
}

jet_row() {   # jet_row WHAT NAME
  local d=$work/$2.1x1
  "$vanguard" plan --replay "$d/record.json" --ranks 8,16 --serial 0 --json \
    > "$work/plan.json"
  jq -r --slurpfile r "$d/out/jet.report.json" --slurpfile p \
    "$work/plan.json" --arg what "$1" --slurpfile two "$work/$2.1x2/row.json" '
    def f($d): . * pow(10; $d) | round / pow(10; $d);
    $r[0].partition.leaf_cells as $l | $p[0].forecast as $f |
    "| \($what) | \(.cells) | \($l | length) | " +
    "\(100 * ($l | max) / ($l | add) | f(1)) | \(.wall | f(1)) | " +
    "\($two[0].wall | f(1)) | \($two[0].imbalance | f(3)) | " +
    "\($f[0].speedup | f(2)) | \($f[1].speedup | f(2)) | " +
    "\($f[1].imbalance | f(3)) |"' "$d/row.json" | say
}

# PVGRID bisects the bounding box repeatedly: x into N, y and z into two parts.
# Share of the cells in the fullest part, from the forecast of cells,
# distributed uniformly over each of many small leaves.
halved() {
  "$vanguard" plan -p "$project" "${options[@]}" -q --json -n 1 \
    --leaf-cells "$(cells 40000)" > "$work/boxes.json"
  jq -r '
    def f($d): . * pow(10; $d) | round / pow(10; $d);
    def in($lo; $hi; $k; $n; $from):
      [0, ([$hi, 80 * ($k + 1) / $n + $from] | min) -
          ([$lo, 80 * $k / $n + $from] | max)] | max;
    [.tree.nodes[] | select(.leaf)] as $l |
    def most($nx): [range($nx) as $i | range(2) as $j | range(2) as $k |
      [$l[] | .cells * in(.lo[0]; .hi[0]; $i; $nx; -9) *
        in(.lo[1]; .hi[1]; $j; 2; -11) * in(.lo[2]; .hi[2]; $k; 2; -11) /
        in(.lo[0]; .hi[0]; 0; 1; -9) / in(.lo[1]; .hi[1]; 0; 1; -11) /
        in(.lo[2]; .hi[2]; 0; 1; -11)] | add] | max / add;
    "| halved in the middle, as PVGRID does (forecast) | " +
    "\(.mesh.cells | round) | 16 | \(100 * most(4) | f(1)) | - | - | - | " +
    "at most \(1 / most(2) | f(2)) | at most \(1 / most(4) | f(2)) | " +
    "\(16 * most(4) | f(2)) |"' "$work/boxes.json" | say
}

case_jet() {
  jet_project "$(cells 8000000)"
  say << 'HEAD'

## Jet: one of 16 subdomains has most of the work

| decomposition | cells | leaves | largest leaf, % | 1x1, s | 1x2, s | imbalance, 1x2 | forecast of cutting and filling: speed-up at 8 | at 16 | imbalance at 16 |
|---|---|---|---|---|---|---|---|---|---|
HEAD
  local how leaf
  leaf=$(cells 125000)   # 64 leaves and more
  for how in 1x1 1x2; do
    once jet-uniform $how -L 4
    once jet-adaptive $how --leaf-cells "$leaf"
  done
  halved
  jet_row "uniform, -L 4" jet-uniform
  jet_row "adaptive, --leaf-cells $leaf" jet-adaptive
}

# ------------------------------------------------------------------------------

# The same number of leaves at any scale; leaves below 20,000 cells are mostly
# surface.
[ "$scale" = 1 ] || options_all=(--leaf-cells "$(calc "int(150000 * $scale < \
  20000 ? 20000 : 150000 * $scale)")")
say << HEAD
Vanguard $("$vanguard" --version | awk 'NR == 1 { print $2 }'), $(uname -m), $(nproc) cores, $(date -u +%Y-%m-%d), load before $(cut -d' ' -f1 /proc/loadavg), sizes x $scale. Bar: every mesh valid, all files of a case the same.
HEAD
if wanted box || wanted sphere || wanted wing || wanted aircraft; then say << 'HEAD'

| case | cells | ranks x threads | start to files closed, s | layers, s | cutting and filling, s | judging and writing, s | speed-up | leaves | zones, % of cells | imbalance | peak MB of a rank | smallest angle | files |
|---|---|---|---|---|---|---|---|---|---|---|---|---|---|
HEAD
fi
forecasts=()
for name in box sphere wing aircraft; do
  wanted $name || continue
  case $name in
    box) demo_project box "$(cells 23000000)" "$work/input" ;;
    sphere) demo_project sphere "$(cells 12000000)" "$work/input" ;;
    wing) demo_project wing "$(cells 4400000)" "$work/input" ;;
    aircraft)
      if holds "$scale" '<' 0.5; then plane=dlr_f6_coarse
      else plane=dlr_f6_medium; fi
      if [ -z "$data" ] || ! aircraft "$data" $plane "$work/input"; then
        echo "SKIP aircraft: no $plane below --data" \
          "(verification/fetch.md)" >&2
        continue
      fi
      # smaller growth than usual, for 20 million cells
      [ $plane = dlr_f6_coarse ] || options+=(--ratio 1.12 --growth 1.12) ;;
  esac
  options+=("${options_all[@]}")
  three $name
  forecasts+=("$name")
done
if [ ${#forecasts[@]} -gt 0 ]; then
  say << 'HEAD'

## On more workers, forecast from the timeline of one thread

| case | workers | last cut, s | cutting and filling, s | reading to files, s | speed-up of cutting and filling | of all | imbalance |
|---|---|---|---|---|---|---|---|
HEAD
  for name in "${forecasts[@]}"; do
    for n in 1 2 16 64; do
      forecast "$name" "$work/$name.1x1/record.json" $n | say
    done
  done
  say << 'END_OF_THESIS'
| PVGRID, box 23 M | 64 | 373.97 | 554.87 | 624.06 | | 22.95 | |
| PVGRID, sphere 12 M | 64 | | | | | 15.47 | |
END_OF_THESIS
fi
! wanted jet || case_jet
[ -s "$rows" ] || die "no such case; see --help"
[ -z "$json" ] || jq -s '{runs: .}' "$rows" > "$json"
exit $failed
