# SPDX-License-Identifier: LGPL-3.0-or-later
# Cut, filled and written by threads and ranks: the same files for any number
# of both, in any order, and after a resume; refusals; a stop that leaves no
# partial files.
needs metis mpi
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 \
  OMPI_MCA_rmaps_base_oversubscribe=1 \
  OMPI_MCA_hwloc_base_binding_policy=none \
  PRTE_MCA_rmaps_default_mapping_policy=:oversubscribe \
  PRTE_MCA_hwloc_default_binding_policy=none
has_mpirun=0
! mpirun -n 2 true >/dev/null 2>&1 || has_mpirun=1
[ $has_mpirun = 1 ] || echo "no mpirun that starts here: threads only"

# ranks N ARGS...: as vanguard, under mpirun. Memory that MPI itself does not
# free is not a leak of Vanguard.
ranks() {
  local n=$1
  shift
  ASAN_OPTIONS=$ASAN_OPTIONS:detect_leaks=0 mpirun -n "$n" "$program" "$@" >out 2>err
  status=$?
}

# Names and digests of all files that the run in folder $1 wrote, except the
# timeline of its tasks, which holds times.
digests() {
  sed -n '/timeline.json/d
    s,.*"path": ".*/\([^/]*\)".*,\1,p
    s/.*"xxh3": "\(.*\)".*/  \1/p' "$1"/*.report.json
}

# agrees FOLDER [WITH]: the files of FOLDER equal those of folder WITH (one).
agrees() {
  local with=${2:-one}
  exits 0
  digests "$1" >"$1.digests"
  same "$with.digests" "$1.digests"
  cmp -s "$with"/*.b8.ugrid "$1"/*.b8.ugrid || fail "$1: the mesh differs"
}

# The part of a report about the fill, without its times.
counts() {
  sed -n '/^  "fill": {/,/^  }/p' "$1"/*.report.json | grep -v ': [0-9]*[.]'
}

vanguard demo box --cells 30000 --out p
cut="-q -p p/box --leaf-cells 5000 --write cogsg,b8.ugrid,vtu,pvtu"

# shellcheck disable=SC2086 # lists of options
{
vanguard mesh $cut -t 1 --out one --timeline
exits 0
digests one >one.digests
[ "$(grep -c '^  [0-9a-f]\{32\}$' one.digests)" -ge 9 ] ||
  fail "too few digests: $(cat one.digests)"
exists one/box.{cogsg,bc,mapbc,b8.ugrid,vtu,surface.vtu,pvtu} one/box_0.vtu \
  one/box.timeline.json
says out "1 rank x 1 thread;"
says one/box.report.json '"leaves": '
says one/box.pvtu 'Source="box_0.vtu"'
vanguard check -q one/box.b8.ugrid
exits 0

vanguard mesh $cut -t 2 --out two
agrees two
vanguard mesh $cut -t 2 --shuffle-tasks 7 --out shuffled
agrees shuffled
absent two/box.timeline.json

if [ $has_mpirun = 1 ]; then
  ranks 2 mesh $cut -t 1 --out ranks2
  agrees ranks2
  says out "2 ranks x 1 thread;"
  ranks 3 mesh $cut -t 2 --out ranks3
  agrees ranks3

  # Formats that need the whole mesh in one process: rank 0 writes them.
  whole="-q -p p/box --leaf-cells 3000 --solver-parts 3 \
    --write foam,meshb,ugrid,b8.ugrid"
  # shellcheck disable=SC2086 # words
  vanguard mesh $whole -t 1 --out whole1
  exits 0
  for n in 2 3; do
    # shellcheck disable=SC2086 # words
    ranks $n mesh $whole -t 1 --out whole$n
    exits 0
    for file in box.meshb box.ugrid box.b8.ugrid \
      box.openfoam/constant/cellDecomposition \
      box.openfoam/constant/polyMesh/{points,faces,owner,neighbour,boundary}
    do
      same whole1/$file whole$n/$file
    done
    [ "$(ls -A whole1)" = "$(ls -A whole$n)" ] ||
      fail "other files: $(ls -A whole$n)"
  done
fi

# Where the void is cut, and how often.
vanguard mesh -q -p p/box --bisections 2 --json --out levels
exits 0
says out '"pencils": 1,'
says out '"leaves": 4,'
# four tiles, and more where subdomains were connected across them
grep -q '"tiles": [4-7],' out || fail "not 4 to 7 tiles"
vanguard mesh -q -p p/box -L 2 --split-direction 3 --constant-direction yes \
  --json --out slabs
exits 0
says out '"pencils": 0,'
says out '"tiles": 3,'
vanguard mesh -q -p p/box --leaf-cells 0 --json --out uncut
exits 0
says out '"leaves": 1,'
says out '"cuts": 0,'
vanguard mesh -q -p p/box --constant-direction yes --out none
exits 2
says err "constant_direction requires a split_direction of 1, 2 or 3"

# The cells of leaves, fragments and cuts, plus those added by repairs, add up
# to the mesh.
parts=$(sed -n '/"leaf_cells": \[/,/\]/s/^ *\([0-9]*\),*$/\1/p
  s/.*"\(fragment_cells\|separator_cells\|repair_cells\)": \([-0-9]*\).*/\2/p' \
  two/box.report.json | paste -sd+)
cells=$(sed -n '/^  "mesh": {/,/^  }/s/^    "cells": \([0-9]*\).*/\1/p' two/box.report.json)
[ "$((parts))" = "$cells" ] || fail "the parts have $parts cells, the mesh $cells"
grep -q '"repair_cells": -*[1-9]' two/box.report.json || fail "no repair"

# Small voids that are filled as one leaf are counted separately.
vanguard demo sphere --cells 60000 --out p
vanguard mesh -q -p p/sphere --leaf-cells 6000 --json --out fragments
exits 0
fragments=$(sed -n 's/.*"fragment_leaves": \([0-9]*\).*/\1/p' out)
cells=$(sed -n 's/.*"fragment_cells": \([0-9]*\).*/\1/p' out)
least=$(sed -n '/"leaf_cells"/{n;s/[^0-9]//g;p}' out)
[ "$((fragments == 0))" = "$((cells == 0))" ] || fail "$fragments fragments: $cells cells"
[ "$least" -ge 300 ] || fail "a leaf of $least cells"

# Kept tasks are found again by another number of workers.
vanguard mesh -q -p p/box --resume
exits 2
says err "--resume requires the --run-dir of the run"
vanguard mesh $cut --run-dir none --resume --out none
exits 1
says err "none: this run directory does not exist"
absent none/box.b8.ugrid
vanguard mesh $cut -t 2 --run-dir run --keep-run --out kept
agrees kept
exists run/run.txt
vanguard mesh $cut --run-dir run --out kept
exits 1
says err "resume it, remove the directory to start again, or choose another one"
vanguard mesh $cut --run-dir run --resume --hmax 0.2 --out other
exits 1
says err "run: cannot be resumed: input or options have changed; its run was"
says err ", is 0.2; restore the old values"
lacks err "threads was"
absent other/box.b8.ugrid
# A setting that leaves the isotropic region unchanged, but affects the mesh.
vanguard mesh $cut --run-dir run --resume --edges-per-turn 20 --out other
exits 1
says err "edges_per_turn was 24, is 20; restore the old values"
vanguard mesh $cut --run-dir run --resume --keep-run --schedule cyclic \
  --max-cells 9000000 --write b8.ugrid --out free
exits 0
lacks out "tasks reused from run: 0"
cmp kept/box.b8.ugrid free/box.b8.ugrid || fail "the files differ from those before"
if [ $has_mpirun = 1 ]; then
  ranks 2 mesh $cut -t 1 --run-dir run --resume --keep-run --out resumed
  agrees resumed
  lacks out "tasks reused from run: 0"
fi
vanguard mesh $cut -t 1 --run-dir run --resume --out again
agrees again
says out "tasks reused from run: "
lacks out "tasks reused from run: 0"
absent run

# Kept outcomes are reported as if they had been made in this run.
counts one >one.counts
[ "$(wc -l <one.counts)" -ge 10 ] || fail "no counts: $(cat one.counts)"
for folder in kept again; do
  counts $folder >counts
  same one.counts counts
done
}

# Layers of prisms, expanded by the rank that writes them.
vanguard demo wing-half --cells 250000 --out p
layered="-q -p p/wing-half --layer-count 5 --cells mixed --leaf-cells 40000"
layered="$layered --write b8.ugrid,pvtu,vtu"
# shellcheck disable=SC2086
{
vanguard mesh $layered -t 1 --out wing
exits 0
says out "prisms"
digests wing >wing.digests
exists wing/wing-half.wall.vtu
if [ $has_mpirun = 1 ]; then ranks 2 mesh $layered -t 1 --out wing2
else vanguard mesh $layered -t 2 --out wing2; fi
agrees wing2 wing
}

# SIGTERM or SIGUSR1 in the middle of the fill; then the rest of the run.
vanguard demo box --cells 400000 --out p4
for directory in "" "--run-dir r4"; do
  rm -f err
  # shellcheck disable=SC2086
  "$program" mesh -p p4/box --leaf-cells 20000 -t 2 --out o4 $directory \
    >out 2>err &
  pid=$!
  for _ in $(seq 600); do
    ! grep -qs '^fill' err || break
    sleep 0.02
  done
  # a batch system may send its warning more than once; SIGTERM ends a process
  # at the second
  if [ -n "$directory" ]; then
    for _ in 1 2 3; do
      kill -USR1 $pid 2>/dev/null
      sleep 0.02
    done
  else
    kill -TERM $pid 2>/dev/null
  fi
  wait $pid
  status=$?
  exits 1
  [ -z "$(ls -A o4)" ] || fail "left behind: $(ls -A o4)"
  [ -n "$directory" ] || says err "interrupted; nothing was written"
done
says err "stopped; finished tasks are kept in r4"
says err "--resume"
