# SPDX-License-Identifier: LGPL-3.0-or-later
# bench/common.sh: functions shared by the scripts of bench/ and verification/.
# Sourced by bash with `root` set; `script` is the caller's name in messages.
# shellcheck shell=bash
export LC_ALL=C
script=${0#"$root"/}
cases=() out=''

# The comment at the top of the script.
usage() { sed -n '2,/^[^#]/p' "$0" | sed -n 's/^# \{0,1\}//p'; }
die() { echo "$script: $*" >&2; exit 1; }
skip() { echo "SKIP: $*"; exit 77; }

# take_options "NAME..." "FLAG..." ARGUMENT...: --NAME VALUE into variables of
# these names (- as _), --FLAG as 1, words into `cases`.
take_options() {
  local values=" $1 " flags=" $2 " name
  shift 2
  while [ $# -gt 0 ]; do
    name=${1#--}
    case $1 in
      -h|--help) usage; exit 0 ;;
      -*)
        if [[ $1 == --* && $values == *" $name "* ]] && [ $# -gt 1 ]; then
          printf -v "${name//-/_}" %s "$2"
          shift
        elif [[ $1 == --* && $flags == *" $name "* ]]; then
          printf -v "${name//-/_}" 1
        else
          usage >&2
          exit 2
        fi ;;
      *) cases+=("$1") ;;
    esac
    shift
  done
}

# 0 if the case matches one of `cases` (names or patterns), or `cases` is empty.
wanted() {
  local pattern
  [ ${#cases[@]} -gt 0 ] || return 0
  for pattern in "${cases[@]}"; do
    # shellcheck disable=SC2254 # a pattern
    case $1 in $pattern) return 0 ;; esac
  done
  return 1
}

need() {   # need PROGRAM PACKAGE
  command -v "$1" > /dev/null || [ -x "$1" ] ||
    die "$1 is not installed: apt-get install $2"
}

# make_programs BUILD NAME...: build the programs that do not exist yet.
make_programs() {
  local build=$1 name
  shift
  for name; do
    if [ ! -x "$build/bin/$name" ]; then
      cmake -S "$root" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release >&2
      cmake --build "$build" >&2
      return
    fi
  done
}

# work_folder NAME: make the folder $work, a temporary one by default.
work_folder() {
  if [ -z "${work:-}" ]; then
    work=$(mktemp -d "${TMPDIR:-/tmp}/vanguard-$1.XXXXXX")
    trap 'rm -rf "$work"' EXIT
  fi
  mkdir -p "$work"
}

# to_measure NAME: prepare run_mesh: `vanguard` in $build, and $work.
to_measure() {
  need jq jq
  need /usr/bin/time time
  need mpirun openmpi-bin
  make_programs "$build" vanguard
  vanguard=$build/bin/vanguard
  work_folder "$1"
}

# What a published table must name: the program, the commit and the machine.
about_machine() {
  local commit
  commit=$(git -C "$root" rev-parse --short=8 HEAD 2>/dev/null || echo "")
  [ -z "$commit" ] || git -C "$root" diff --quiet HEAD 2>/dev/null ||
    commit="$commit with changes"
  echo "Vanguard $("$build/bin/vanguard" --version | awk 'NR == 1 { print $2 }')" \
    "(${commit:-no commit}), $(uname -m), $(nproc --all) cores," \
    "$(date -u +%Y-%m-%d)."
}

# Print to standard output, and to the file --out.
say() { if [ -n "$out" ]; then tee -a "$out"; else cat; fi; }

# calc EXPRESSION [NAME=VALUE...]: evaluate with awk.
calc() {
  local text=$1 set=()
  shift
  for word; do set+=(-v "$word"); done
  awk "${set[@]}" "BEGIN { print $text }"
}
holds() { awk "BEGIN { exit !($*) }"; }   # holds 1.02 '<=' 1.1

# Open MPI requires two variables to run as root.
if [ "$(id -u)" = 0 ]; then
  export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
fi

# launch RANKS THREADS COMMAND...: bound to cores if there are enough. One rank
# needs no launcher.
launch() {
  local ranks=$1 threads=$2 binding=()
  shift 2
  if [ "$ranks" = 1 ]; then
    "$@"
    return
  fi
  if [ $((ranks * threads)) -le "$(nproc)" ]; then
    binding=(--map-by "slot:PE=$threads" --bind-to core)
  else
    binding=(--oversubscribe --bind-to none)
  fi
  mpirun -n "$ranks" "${binding[@]}" "$@"
}

# digest FOLDER: digest of all result files that contain no times.
digest() {
  (cd "$1" && find . -type f ! -name '*.json' ! -name '*.html' \
    ! -name '*.deck' -print0 | sort -z | xargs -0r sha256sum | sha256sum |
    cut -c1-16)
}

# Seconds of processor time that the host has taken from this virtual machine.
stolen() {
  awk -v hz="$(getconf CLK_TCK)" '$1 == "cpu" { print $9 / hz }' /proc/stat
}

# check_workers REPORT RANKS THREADS: end the script if the run of a
# .report.json had another number of ranks or of threads than was requested.
check_workers() {
  local had
  had=$(jq -r '.partition | "\(.ranks) x \(.threads)"' "$1")
  [ "$had" = "$2 x $3" ] ||
    die "$1: $had ranks x threads instead of the requested $2 x $3"
}

# run_mesh VANGUARD FOLDER RANKS THREADS OPTION...: vanguard mesh with a
# timeline, timed. FOLDER/row.json: wall, cpu (user and system time of all
# ranks), stolen (the share of all cores that the host took meanwhile), peak_mb
# (of the largest process), and figures of report and timeline.
# The status is that of the mesher; its output is in FOLDER/log.
run_mesh() {
  local vanguard=$1 d=$2 ranks=$3 threads=$4 status=0 report record host
  shift 4
  rm -rf "$d"
  mkdir -p "$d/out"
  # Time the whole command: the time of a launcher includes its ranks.
  local script_text
  script_text=$(declare -f launch)
  host=$(stolen)
  /usr/bin/time -o "$d/time" -f '%e %U %S %M' bash -c "$script_text
    launch \"\$@\"" - "$ranks" "$threads" "$vanguard" mesh --quiet --out \
    "$d/out" --threads "$threads" --timeline "$@" > "$d/log" 2>&1 || status=$?
  [ $status = 0 ] || return $status
  host=$(calc "($(stolen) - $host) / $(nproc)")
  report=$(echo "$d"/out/*.report.json)
  check_workers "$report" "$ranks" "$threads"
  record=$(echo "$d"/out/*.timeline.json)
  cp "$record" "$d/record.json"
  jq -n -c --slurpfile r "$report" --slurpfile t "$record" \
    --arg time "$(tail -1 "$d/time")" --arg options "$*" \
    --argjson stolen "$host" '
    ($time | split(" ") | map(tonumber)) as $s | $r[0].partition as $p |
    {ranks: $t[0].facts.ranks, threads: $t[0].facts.threads,
     options: $options, wall: $s[0], cpu: ($s[1] + $s[2]),
     stolen: (if $s[0] > 0 then $stolen / $s[0] else 0 end),
     peak_mb: ($s[3] / 1024), cells: $t[0].facts.cells,
     points: $t[0].facts.points, estimate: $p.estimate, leaves: $p.leaves,
     cuts: $p.cuts, tasks: ($t[0].spans | length),
     zone_share: ($p.separator_cells / $t[0].facts.cells),
     busy: $p.busy, imbalance: $p.imbalance,
     memory_mb: ($p.memory_of_all_ranks_bytes / 1048576),
     angle_min: ($r[0].field // $r[0].mesh).angle_min,
     valid: $r[0].mesh.valid,
     seconds: ($t[0].facts | with_entries(select(.key | startswith("seconds_"))
               | .key |= ltrimstr("seconds_")))}' > "$d/row.json"
}
get() { jq -r "$2" "$1"; }   # get FILE EXPRESSION
median() { sort -g | awk '{ v[NR] = $1 } END {
  print NR % 2 ? v[(NR + 1) / 2] : (v[NR / 2] + v[NR / 2 + 1]) / 2 }'; }
