# bench/common.sh: what the scripts of bench/ and verification/ share. Sourced
# by bash with `root` set; `script` is the caller's name in messages.
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

# 0 when the case is one of `cases`, names or patterns, or there are none.
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

# make_programs BUILD NAME...: build what is not there yet.
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

# work_folder NAME: $work is made, a temporary one when it is not given.
work_folder() {
  if [ -z "${work:-}" ]; then
    work=$(mktemp -d "${TMPDIR:-/tmp}/vanguard-$1.XXXXXX")
    trap 'rm -rf "$work"' EXIT
  fi
  mkdir -p "$work"
}

# Standard output, and the file --out as well.
say() { if [ -n "$out" ]; then tee -a "$out"; else cat; fi; }

# calc EXPRESSION [NAME=VALUE...]: by awk.
calc() {
  local text=$1 set=()
  shift
  for word; do set+=(-v "$word"); done
  awk "${set[@]}" "BEGIN { print $text }"
}
holds() { awk "BEGIN { exit !($*) }"; }   # holds 1.02 '<=' 1.1
