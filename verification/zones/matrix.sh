#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# verification/zones/matrix.sh: inner surfaces in all combinations.
#
# usage: verification/zones/matrix.sh [--vanguard PROGRAM] [--meshcheck PROGRAM]
#                                     [--work DIR] [--out FILE]
#   --vanguard   the program (default build/release/bin/vanguard)
#   --meshcheck  an independent judge of NAME.b8.ugrid, exit status 0: valid;
#                not of meshes with baffles, whose points are doubled
#   --work       scratch folder, kept (default: a temporary one, removed)
#   --out        write the table to FILE too
#
# A surface in a box: a baffle, a sheet or an interface; whose edges are free,
# end on walls, on another inner surface (T) or on a symmetry plane, or that
# crosses the box; without layers, and with layers on both sides as
# tetrahedra, prisms and hexahedra; in the three decompositions. Each of these
# meshes must be valid according to `vanguard check` (and to the judge), the
# areas of both sides equal, and its bytes the same with three threads, on two
# ranks, and after a run that was killed and resumed.
# Exit status: 0 all passed, 1 a failure, 2 usage.
set -uo pipefail

root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=bench/common.sh
. "$root/bench/common.sh"
# shellcheck source=tests/cli/duct.bash
. "$root/tests/cli/duct.bash"
vanguard=$root/build/release/bin/vanguard meshcheck='' work=''
take_options "vanguard meshcheck work out" "" "$@"
need jq jq
vanguard=$(realpath "$vanguard")
[ -z "$meshcheck" ] || meshcheck=$(realpath "$meshcheck")
[ -z "$out" ] || { out=$(realpath "$out"); : >"$out"; }
work_folder matrix
cd "$work" || exit 2

# Names of the ends, and their surfaces.
duct free "in 6 6  0.5 0.25 0.25  0 0.5 0  0 0 0.5"
duct walls "in 8 4  0.5 0 0.25  0 1 0  0 0 0.5"
duct across "in 8 8  0.5 0 0  0 1 0  0 0 1"
duct junction "in 4 4  0.5 0.25 0  0 0.5 0  0 0 0.5" \
  "other 2 4  0.5 0.25 0.25  0.25 0 0  0 0.5 0"
duct symmetry "in 4 4  0.5 0 0.25  0 0.5 0  0 0 0.5"
printf 'box\n\npatches\nid bc\nw3 1\nw1 4\nw2 4\nw4 4\nw5 4\nw6 4\n' >symmetry.deck

n_run=0 n_bad=0
# bad TEXT: count a failure and name the mesh.
bad() {
  n_bad=$((n_bad + 1))
  echo "FAIL $mesh: $1" >&2
}

# make FOLDER OPTION...: the mesh of this combination.
make() {
  local to=$1
  shift
  n_run=$((n_run + 1))
  timeout 120 "$vanguard" mesh "$end.stl" "${options[@]}" --quiet \
    --write b8.ugrid --out "$to" "$@" >"$to.log" 2>&1
}

same() {   # same FOLDER TEXT
  cmp -s "a/$end.b8.ugrid" "$1/$end.b8.ugrid" || bad "other bytes $2"
}

# Kill the run after a part of its time, and resume it.
resumed() {
  local pid
  "$vanguard" mesh "$end.stl" "${options[@]}" --quiet \
    --write b8.ugrid --out d --run-dir run >d.log 2>&1 &
  pid=$!
  sleep "$(calc "0.02 * (1 + $n_run % 12)")"
  kill -KILL "$pid" 2>/dev/null
  wait "$pid" 2>/dev/null
  if [ ! -e "d/$end.b8.ugrid" ]; then
    rm -rf d
    if [ -d run ]; then set -- --run-dir run --resume; else set --; fi
    make d "$@" || bad "not resumed: $(tail -1 d.log)"
  fi
  same d "after a run that was killed"
}

# Areas of both sides of a patch, from the report of check: equal, or listed
# once as a sheet.
sides() {
  awk -v a="$1" -v b="$1_back" '
    NF > 4 { for (i = 1; i <= NF; i++) { if ($i == a) x = $(i - 1)
                                         if ($i == b) y = $(i - 1) } }
    END { exit !(x != "" && (y == "" || x == y)) }' check.log
}

one() {
  mesh="$role, $end, $layers, $decompose"
  rm -rf a b c d run ./*.log
  if ! make a; then
    bad "$(tail -1 a.log)"
    return
  fi
  "$vanguard" check "a/$end.b8.ugrid" >check.log 2>&1 || bad "not valid"
  sides in || bad "areas of the sides"
  if [ -n "$meshcheck" ] && [ "$role" != baffles ]; then
    "$meshcheck" "a/$end.b8.ugrid" >judge.log 2>&1 || bad "the judge: $(tail -1 judge.log)"
  fi
  make b --threads 3 && same b "with three threads" || bad "three threads"
  if command -v mpirun >/dev/null; then
    n_run=$((n_run + 1))
    timeout 120 mpirun -n 2 --oversubscribe --bind-to none "$vanguard" mesh \
      "$end.stl" "${options[@]}" --quiet --write b8.ugrid --out c \
      >c.log 2>&1 && same c "on two ranks" || bad "two ranks: $(tail -1 c.log)"
  fi
  resumed
}

ways="advancing octree"
! "$vanguard" --version --verbose | grep -q METIS || ways="$ways discrete"
{
  echo "| role | ends | layers | meshes | failures |"
  echo "|---|---|---|---|---|"
} | say
for role in baffles sheets zone-interfaces; do
  for end in free walls across junction symmetry; do
    # An interface separates zones: it ends on walls all around.
    [ $role != zone-interfaces ] || [ $end = across ] || continue
    for layers in no tets mixed hex; do
      before=$n_bad from=$n_run
      for decompose in $ways; do
        inner=in
        [ $end != junction ] || inner=in,other
        options=(--flow internal --$role $inner --hmax 0.12 --leaf-cells 1500
                 --decompose "$decompose")
        [ $layers = no ] ||
          options+=(--walls "$inner" --first 0.004 --layer-count 5 --cells $layers)
        one
      done
      echo "| ${role%s} | $end | $layers | $((n_run - from)) |" \
        "$((n_bad - before)) |" | say
    done
  done
done
echo "$n_run runs, $n_bad failures" | say
[ $n_bad = 0 ]
