#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# verification/layers/search.sh: layers with random settings, to find settings
# that break them.
#
# usage: verification/layers/search.sh [--data DIR] [--build DIR] [--runs N]
#          [--seed S] [--meshcheck PROGRAM] [--keep DIR]
#   --data       folder of real geometry (verification/fetch.md); without it
#                only the demo shapes
#   --build      build folder with bin/vanguard, preferably of preset asan
#                (default build/asan)
#   --runs       number of runs (default 100)
#   --seed       seed of the first run; run i has seed S + i - 1 (default 1), so
#                that each run can be repeated separately
#   --meshcheck  another checker: PROGRAM -q MESH.b8.ugrid
#   --keep       folder for failed runs (default: none)
# A run succeeds if it ends with status 0 and a valid mesh, with status 1 and a
# message, or with status 4 because no layers grow; it fails if a signal, a sanitizer or the time limit ends it. Prints
# a line per failed run. Exit status: 0 none failed, 1 some failed, 2 usage.
set -uo pipefail
export LC_ALL=C ASAN_OPTIONS=detect_leaks=1 UBSAN_OPTIONS=halt_on_error=1

root=$(cd "$(dirname "$0")/../.." && pwd)
data='' build=$root/build/asan runs=100 seed=1 meshcheck='' keep=''
LIMIT_S=900

usage() { sed -n '2,/^# per run/p' "$0" | sed 's/^# \{0,1\}//'; }

while [ $# -gt 0 ]; do
  case $1 in
    --data|--build|--runs|--seed|--meshcheck|--keep)
      [ $# -gt 1 ] || { usage >&2; exit 2; }
      declare "${1#--}=$2"
      shift ;;
    -h|--help) usage; exit 0 ;;
    *) usage >&2; exit 2 ;;
  esac
  shift
done
vanguard=$build/bin/vanguard
[ -x "$vanguard" ] || { echo "no program $vanguard: build it first" >&2
                        exit 2; }
work=$(mktemp -d "${TMPDIR:-/tmp}/vanguard-search.XXXXXX")
trap 'rm -rf "$work"' EXIT

# name, file below --data or demo, patches that are walls, length
surfaces="
box demo all 1
sphere demo all 2
wing demo - 1
wing-half demo - 1
wing-sharp demo - 1
wing-sharp-half demo - 1
"
[ -z "$data" ] || surfaces+="
onera_m6 transport/onera_m6_sharp_te_farfield.lb8.ugrid.xz 3-12 0.646
30p30n   highlift/30p30n_swept_wing_in_box_coarse.lb8.ugrid.xz 1-10 1000
dlr_f6   transport/dlr_f6_wbnp_half_coarse.lb8.ugrid.xz 1-123 141.2
tmx1242  supersonic/tmx1242_wing_body.lb8.ugrid.xz all 9
low_boom supersonic/low_boom_sst_full.lb8.ugrid.xz all 20
p180     bizjet/p180_avanti_full.lb8.ugrid.xz all 1.14
"

# Both return the result in $REPLY: a subshell would repeat the same numbers.
pick() { shift $((RANDOM % $#)); REPLY=$1; }

# A random number between two, uniform in its logarithm.
draw() {
  local r=$((RANDOM * 32768 + RANDOM))
  REPLY=$(awk -v a="$1" -v b="$2" -v r=$r \
    'BEGIN { print exp(log(a) + (log(b) - log(a)) * r / 1073741824) }')
}

# Add an option with probability 1/2: may --option draw 1 2, may --option pick a
# b
may() {
  local option=$1
  shift
  ((RANDOM % 2)) || return 0
  "$@"
  options+=("$option" "$REPLY")
}

# prepare NAME FILE WALLS LENGTH: the project and its options
options=()
prepare() {
  options=(--layers yes)
  if [ "$2" = demo ]; then
    rm -f "$work/$1".*
    "$vanguard" demo "$1" --cells 20000 --out "$work" > "$work/demo.log" ||
      return 1
  else
    xz -dc "$data/$2" > "$work/$1.lb8.ugrid" || return 1
    if [ "$3" = all ]; then options+=(--farfield sphere)
    else options+=(--farfield none); fi
  fi
  case $3 in -|all) ;; *) options+=(--walls "$3") ;; esac
}

settings() {   # settings LENGTH
  draw 1e-8 1e-1
  options+=(--first "$(awk -v l="$1" -v f="$REPLY" 'BEGIN { print l * f }')")
  case $((RANDOM % 3)) in
    0) draw 1.0001 3
       options+=(--ratio "$REPLY") ;;
    1) draw 0.001 0.9
       options+=(--rate1 "$REPLY")
       draw 0.0001 0.3
       options+=(--rate2 "$REPLY") ;;
    2) pick 1 2 3 10 40 200 250
       options+=(--layer-count "$REPLY") ;;
  esac
  may --layer-cap pick 0 1 1.05 1.3 2
  may --fan-angle pick 20 25 45 60 100 179
  may --layer-slope draw 0.01 10
  may --layer-jump pick 1 1.5 3 1000
  may --layer-gap draw 0.01 0.49
  may --layer-end draw 0.05 5
  may --layer-smooth pick 0 1 5 300
  may --constant-layers pick 1 2 10 100
  may --surface-swap pick yes no
  may --leaf-cells pick 0 20000 100000
  may --cells pick tets mixed hex
  may --threads pick 1 2
}

is_bad=''
try() {   # try NAME: sets $is_bad to the reason of a failure
  local status mesh=$work/out/$1.b8.ugrid
  is_bad=''
  rm -rf "$work/out"
  timeout -k 10 "$LIMIT_S" "$vanguard" mesh -q -p "$work/$1" \
    --out "$work/out" --write b8.ugrid --max-cells 5000000 "${options[@]}" \
    > "$work/log" 2>&1
  status=$?
  if grep -aqE "Sanitizer|runtime error" "$work/log"; then
    is_bad="sanitizer"
  elif [ $status = 1 ]; then
    grep -aq "^vanguard:\|error" "$work/log" || is_bad="no message"
    ! grep -aq "please report" "$work/log" || is_bad="a fault of its own"
  elif [ $status = 4 ]; then
    grep -aq "^limit not met: .* layers are requested" "$work/log" ||
      is_bad="status 4"
  elif [ $status != 0 ]; then is_bad="status $status"
  elif ! "$vanguard" check -q "$mesh" > "$work/check" 2>&1; then
    is_bad="not valid"
  elif [ -n "$meshcheck" ] && [[ ${options[*]} != *"--cells "[mh]* ]] &&
       ! "$meshcheck" -q "$mesh" > "$work/check" 2>&1; then
    is_bad="not valid by the other judge"
  fi
}

n_bad=0 n_refused=0
mapfile -t lines < <(grep . <<< "$surfaces")
for ((i = 0; i < runs; i++)); do
  RANDOM=$((7919 * (seed + i)))   # neighbouring seeds give similar numbers
  pick "${lines[@]}"
  read -r name file walls length <<< "$REPLY"
  prepare "$name" "$file" "$walls" "$length" || {
    echo "cannot make $name" >&2; exit 2; }
  settings "$length"
  try "$name"
  ! grep -aq "^vanguard:" "$work/log" || n_refused=$((n_refused + 1))
  [ -n "$is_bad" ] || continue
  n_bad=$((n_bad + 1))
  echo "seed $((seed + i)): $is_bad: $name ${options[*]}"
  if [ -n "$keep" ]; then
    mkdir -p "$keep"
    cp "$work/log" "$keep/$((seed + i)).log"
  fi
done
echo "$runs runs, $n_refused refused, $n_bad bad"
[ $n_bad = 0 ]
