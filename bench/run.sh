#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# bench/run.sh: Vanguard, TetGen and gmsh HXT on the same surfaces.
#
# usage: bench/run.sh [--quick] [--out FILE] [--build DIR] [--work DIR]
#                     [--runs N] [--threads N] [--meshcheck PROGRAM]
#                     [--gmsh PROGRAM] [--tetgen PROGRAM] [--no-peers] [CASE...]
#   --quick      one run of every case at a tenth of its size
#   --out        write the table to FILE too
#   --build      build folder (default build/release, built if missing)
#   --work       scratch folder, kept (default: a temporary one, removed)
#   --runs       runs of a small case (default 3; large ones: 1)
#   --threads    threads of Vanguard and of HXT (default 1); TetGen has one
#   --meshcheck  a program that checks NAME.lb8.ugrid, exit status 0: valid
#   --gmsh, --tetgen  other versions than those of the system
#   --no-peers   only Vanguard
#   CASE         box-1M box-10M sphere-2M sphere-12M wing wing-half wing-sharp
#
# Every run must have had the requested number of threads: the report of
# Vanguard and the log of gmsh say how many there were, and no process may have
# used more CPU time than that many threads have. Otherwise the script ends with
# status 1.
#
# Seconds are those of the volume stage, from the boundary triangulation to the
# finished mesh, without reading and writing: for Vanguard the fill and its
# optimisation, for TetGen its total without output, for HXT "Done meshing 3D".
# With one thread they are processor times, pinned to one core, because other
# load changes these least: for Vanguard the sum over the tasks of its
# timeline. With more threads they are wall-clock times, and TetGen's processor
# time is scaled by elapsed / CPU time of its process. Peak memory is that of
# the whole process.
# All three keep the boundary triangulation of Vanguard's mesh, and use the same
# sizing field: TetGen as a background mesh, HXT as a view on that mesh. Gmsh
# evaluates a view slowly, so HXT also runs with the sizes of the boundary
# extended inwards ("hxt-ext"): its full speed, but not the same sizes. The
# column "/ HXT" compares with the faster of the two.
# Needs: tetgen, gmsh, jq, time (Debian packages of these names).
set -euo pipefail

root=$(cd "$(dirname "$0")/.." && pwd)
# shellcheck source=bench/common.sh
. "$root/bench/common.sh"
build=$root/build/release
work='' meshcheck='' gmsh=gmsh tetgen=tetgen quick=0 runs=3 threads=1 no_peers=0
TETGEN_OPTIONS=-pq1.414Ym

take_options "out build work runs threads meshcheck gmsh tetgen" "quick no-peers" "$@"
[ ${#cases[@]} -gt 0 ] || cases=(box-1M wing wing-half wing-sharp sphere-2M
                                 box-10M sphere-12M)

# name -> demo, cells
case_demo() {
  case $1 in
    box-*) echo box ;;
    sphere-*) echo sphere ;;
    wing|wing-half|wing-sharp) echo "$1" ;;
    *) die "no case '$1'; see --help" ;;
  esac
}
case_cells() {
  local n=2000000
  case $1 in
    *-*M) n=${1##*-}; n=$((${n%M} * 1000000)) ;;
  esac
  [ $quick = 0 ] || n=$((n / 10))
  echo "$n"
}
is_large() { [ "$(case_cells "$1")" -gt 5000000 ]; }

[[ $threads =~ ^[1-9][0-9]*$ ]] || die "--threads $threads: not a number"
export OMP_NUM_THREADS=$threads

need /usr/bin/time time
need jq jq
if [ $no_peers = 0 ]; then need "$tetgen" tetgen; need "$gmsh" gmsh; fi

pin=()
if [ "$threads" = 1 ]; then
  need taskset util-linux
  pin=(taskset -c "$(taskset -cp $$ | sed 's/.*[ ,-]//')")
fi
make_programs "$build" vanguard vg_bench_peers
vanguard=$build/bin/vanguard
helper=$build/bin/vg_bench_peers

work_folder bench

# field FILE KEY: the value in a file of "key value" lines.
field() { awk -v k="$2" '$1 == k { print $2; exit }' "$1"; }
peak_mb() { awk '/Maximum resident/ { printf "%.0f", $NF / 1024 }' "$1"; }
timed() {
  local log=$1
  shift
  /usr/bin/time -v -o "$log.time" "${pin[@]}" "$@" > "$log" 2>&1
}
# Version 1.5 does not print its own; it is that of the Debian package.
tetgen_version() {
  local text
  text=$("$tetgen" -h 2>&1 | sed -n 's/.*Version \([0-9.]*\).*/\1/p') || true
  [ -n "$text" ] || [ "$tetgen" != tetgen ] ||
    text=$(dpkg-query -W -f '${Version}' tetgen 2>/dev/null) || true
  echo "${text:-of unknown version}"
}
# within_threads LOG N: N threads are enough for the CPU time of a process that
# `timed` ran.
within_threads() {
  local percent
  percent=$(sed -n 's/.*Percent of CPU.*: \([0-9]*\)%.*/\1/p' "$1.time")
  [ "$percent" -le $((100 * $2 + 5)) ] ||
    die "$1: used $percent % CPU, more than $2 threads have"
}

# Each of these functions runs one mesher once in folder $1 and appends its
# seconds and peak MB to NAME.runs.
run_vanguard() {
  timed "$1/vanguard.log" "$vanguard" mesh -p "$1/$2" --out "$1/out" \
    --write lb8.ugrid --layers no --threads "$threads" --timeline ||
    { tail -5 "$1/vanguard.log" >&2; return 1; }
  check_workers "$1/out/$2.report.json" 1 "$threads"
  within_threads "$1/vanguard.log" "$threads"
  local seconds
  if [ "$threads" = 1 ]; then
    seconds=$(get "$1/out/$2.timeline.json" \
      '(.columns | index("cpu")) as $i | [.spans[][$i]] | add')
  else
    seconds=$(get "$1/out/$2.report.json" .seconds.fill)
  fi
  echo "$seconds $(peak_mb "$1/vanguard.log.time")" >> "$1/vanguard.runs"
}
run_tetgen() {
  timed "$1/tetgen.log" "$tetgen" $TETGEN_OPTIONS "$1/peer.smesh" ||
    { tail -5 "$1/tetgen.log" >&2; return 1; }
  within_threads "$1/tetgen.log" 1
  echo "$(awk -v threads="$threads" '/^Total running seconds/ { t = $NF }
    /^Output seconds/ { o = $NF }
    /(User|System) time/ { cpu += $NF }
    /Elapsed/ { n = split($NF, part, ":")
                for (i = 1; i <= n; i++) wall = 60 * wall + part[i] }
    END { print (t - o) * (threads > 1 && wall > cpu ? wall / cpu : 1) }' \
    "$1/tetgen.log" "$1/tetgen.log.time") \
    $(peak_mb "$1/tetgen.log.time")" >> "$1/tetgen.runs"
}
hxt() {   # hxt FOLDER NAME SCRIPT
  local got
  timed "$1/$2.log" "$gmsh" -3 -algo hxt -nt "$threads" -format msh22 -bin \
    -o "$1/$2.msh" "$1/$3" || { tail -5 "$1/$2.log" >&2; return 1; }
  got=$(sed -n 's/.*max\. \([0-9]*\) thread.*/\1/p' "$1/$2.log")
  [ "$got" = "$threads" ] ||
    die "$1/$2.log: gmsh had $got threads instead of $threads"
  within_threads "$1/$2.log" "$threads"
  got=Wall
  [ "$threads" != 1 ] || got=CPU
  echo "$(sed -n "s/.*Done meshing 3D (.*$got \([0-9.]*\)s.*/\1/p" \
    "$1/$2.log") $(peak_mb "$1/$2.log.time")" >> "$1/$2.runs"
}

prepare_peers() {
  "$helper" prepare "$1/out/$2.lb8.ugrid" "$1/out/$2.resolved.deck" "$1/peer" \
    > "$1/peer.log"
  "$tetgen" "$1/peer.b.node" >> "$1/peer.log"
  mv "$1/peer.b.1.node" "$1/peer.b.node"
  mv "$1/peer.b.1.ele" "$1/peer.b.ele"
  "$helper" view "$1/peer"
}

# Median, minimum and maximum of column $2 of file $1.
spread() {
  sort -g -k "$2,$2" "$1" | awk -v c="$2" '{ v[NR] = $c } END {
    m = NR % 2 ? v[(NR + 1) / 2] : (v[NR / 2] + v[NR / 2 + 1]) / 2
    print m, v[1], v[NR] }'
}

# Ratio of rate $1 to the highest rate in the other files, or "-".
ratio() {
  local rate=$1
  shift
  { cat "$@" 2> /dev/null || true; } | awk -v a="$rate" '$1 > b { b = $1 }
    END { if (b > 0) printf "%.2f", a / b; else print "-" }'
}

# One line of the table: row FOLDER CASE MESHER
row() {
  local d=$1 s=$1/$3.judge check=-
  read -r med lo hi <<< "$(spread "$d/$3.runs" 1)"
  read -r mb _ _ <<< "$(spread "$d/$3.runs" 2)"
  if [ -n "$meshcheck" ]; then
    check=OK
    "$meshcheck" "$d/$3.lb8.ugrid" > "$d/$3.meshcheck" 2>&1 || check=FAIL
  fi
  local cells rate tet hxt
  cells=$(field "$s" cells)
  rate=$(awk -v n="$cells" -v t="$med" 'BEGIN { print (t > 0 ? n / t : 0) }')
  echo "$rate" > "$d/$3.rate"
  tet=$(ratio "$rate" "$d"/tetgen.rate)
  hxt=$(ratio "$rate" "$d"/hxt*.rate)
  awk -v case="$2" -v who="$3" -v cells="$cells" -v med="$med" -v lo="$lo" \
    -v hi="$hi" -v rate="$rate" -v tet="$tet" -v hxt="$hxt" -v mb="$mb" \
    -v check="$check" '
    { f[$1] = $2 }
    END {
      ok = f["valid"] == 1 ? (f["kept"] == 1 ? "yes" : "not kept") : "NO"
      printf "| %s | %s | %d | %.2f (%.2f-%.2f) | %d | %s | %s | %d | %.0f " \
             "| %.1f / %.1f | %.3f | %.4f | %.1f | %.3f | %s | %s |\n",
        case, who, cells, med, lo, hi, rate, tet, hxt, mb,
        mb * 1048576 / cells, f["angle_min"], f["angle_max"], f["below_20"],
        f["radius_ratio"], f["edges_within"], f["edge_mean"], ok, check
    }' "$s"
}

judge() {
  case $3 in
    vanguard) mesh=$1/out/$2.lb8.ugrid ;;
    tetgen) mesh=$1/peer.1 ;;
    hxt*) mesh=$1/$3.msh ;;
  esac
  "$helper" judge "$mesh" "$1/out/$2.lb8.ugrid" "$1/out/$2.resolved.deck" \
    "$1/$3.lb8.ugrid" > "$1/$3.judge"
}

one_case() {
  local name=$1 demo n=$runs d=$work/$1
  demo=$(case_demo "$name")
  [ $quick = 0 ] && ! is_large "$name" || n=1
  rm -rf "$d"
  mkdir -p "$d/out"
  "$vanguard" demo "$demo" --cells "$(case_cells "$name")" --out "$d" \
    > "$d/demo.log"
  local stem=$demo meshers=(vanguard)
  for ((i = 0; i < n; i++)); do
    run_vanguard "$d" "$stem" || die "$name: vanguard failed, see above"
    [ $no_peers = 0 ] || continue
    [ $i -gt 0 ] || prepare_peers "$d" "$stem"
    run_tetgen "$d" || echo "$name: TetGen failed" >&2
    hxt "$d" hxt peer.geo || echo "$name: HXT failed" >&2
    hxt "$d" hxt-ext peer.ext.geo || echo "$name: HXT failed" >&2
  done
  for p in tetgen hxt hxt-ext; do
    if [ -s "$d/$p.runs" ]; then meshers=("$p" "${meshers[@]}"); fi
  done
  for p in "${meshers[@]}"; do
    judge "$d" "$stem" "$p"
    row "$d" "$name" "$p" | say
  done
  find "$d" -size +10M -delete   # large meshes would fill the disk
}

[ -z "$out" ] || : > "$out"
say << END
$(about_machine)
TetGen $(tetgen_version) $TETGEN_OPTIONS, gmsh $("$gmsh" --version 2>&1 | tail -1) HXT -nt $threads; threads of Vanguard and HXT: $threads, of TetGen: 1.

| case | mesher | cells | volume stage, s (min-max) | cells/s | / TetGen | / HXT | peak MB | B/cell | dihedral min / max | % < 20 | radius ratio | % edges in [0.7, 1.5] | edge / target | valid | meshcheck |
|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|
END
for name in "${cases[@]}"; do one_case "$name"; done
