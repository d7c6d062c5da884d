#!/bin/bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# Runs one case: run.sh CASE PROGRAM FOLDER. The case is a shell script that
# is sourced in an empty FOLDER and uses the functions below. Every failed
# expectation is shown; the case fails if one did. `skip` skips it (77).
set -u
case_file=$(realpath "$1")
program=$(realpath "$2")
folder=$3
here=$(dirname "$(realpath "$0")") # for cases
export here
failures=0

rm -rf "$folder"
mkdir -p "$folder"
cd "$folder" || exit 1
unset VANGUARD_HELPERS
export LC_ALL=C COLUMNS=80 ASAN_OPTIONS="${ASAN_OPTIONS:-}"

# vanguard ARGS...: output in files out and err, exit status in $status.
vanguard() {
  "$program" "$@" >out 2>err
  status=$?
  ! grep -qaE "$strange" out err || fail "a number in the answer is wrong"
}
# Not a number, or nearly 2^64, unless it is quoted from the input.
strange="(^|[^a-zA-Z'(])-?(nan|inf)([^a-zA-Z'._]|\$)|\(-?(nan|inf)[^a-zA-Z)]"
strange="$strange|18446744073709"

fail() {
  failures=$((failures + 1))
  echo "FAILED: $*"
  echo "--- out"; head -40 out 2>/dev/null
  echo "--- err"; head -40 err 2>/dev/null
}

# exits N: the last status.
exits() { [ "$status" = "$1" ] || fail "exit status $status, not $1"; }

# says FILE TEXT: FILE (out, err, or any) holds TEXT, a fixed string.
says() { grep -qF -- "$2" "$1" || fail "$1 lacks '$2'"; }

# lacks FILE TEXT: the opposite.
lacks() { ! grep -qF -- "$2" "$1" || fail "$1 has '$2'"; }

# is FILE: FILE is exactly standard input.
is() { diff -u - "$1" || fail "$1 is not as expected"; }

exists() { for f; do [ -e "$f" ] || fail "$f is absent"; done; }
absent() { for f; do [ ! -e "$f" ] || fail "$f exists"; done; }
same() { cmp "$1" "$2" || fail "$1 and $2 differ"; }
# octahedron: a body with its corners at distance 1, as an .obj of one group.
octahedron() {
  printf 'v %s\n' "1 0 0" "-1 0 0" "0 1 0" "0 -1 0" "0 0 1" "0 0 -1"
  echo "g body"
  printf 'f %s\n' "1 3 5" "3 2 5" "2 4 5" "4 1 5" "3 1 6" "2 3 6" "4 2 6" \
    "1 4 6"
}

skip() { echo "skipped: $*"; exit 77; }

# needs PART...: skip the case in a build without one of the parts (tetgen,
# wrap, metis, mpi, hdf5).
needs() {
  local part parts
  parts=$("$program" --version --verbose)
  for part; do
    case $part in
      tetgen | wrap) [[ $parts != *"vanguard-$part not found"* ]] ;;
      metis) [[ ! $parts =~ METIS\ +not\ in ]] ;;
      mpi) [[ ! $parts =~ MPI\ +not\ in ]] ;;
      hdf5) [[ ! $parts =~ HDF5\ +not\ in ]] ;;
    esac || skip "built without $part"
  done
}

# python FILE ARGS...: run python/FILE with the module vanguard of this build:
# output in files out and err, exit status in $status. Status 77 skips the case.
python() {
  local try python='' build=${program%/bin/*} file=$1 preload
  shift
  for try in python3 /usr/bin/python3; do
    ! "$try" -c 'import numpy' 2>/dev/null || { python=$try; break; }
  done
  [ -n "$python" ] || skip "NumPy is not installed (python3-numpy)"
  # A sanitizer of the library must be loaded first. Python itself has leaks.
  # LD_PRELOAD takes a list with spaces, not with line ends.
  preload=$(ldd "$build/lib/libvanguard.so.1" |
    awk '/lib[at]san|libubsan/ { sanitizer = sanitizer $3 " " }
      /libstdc/ { library = $3 }
      END { if (sanitizer) print sanitizer library }')
  PYTHONPATH=$build:$here/python VANGUARD_LIBRARY=$build/lib/libvanguard.so.1 \
    PYTHONDONTWRITEBYTECODE=1 LD_PRELOAD=$preload \
    ASAN_OPTIONS=$ASAN_OPTIONS:detect_leaks=0 "$python" "$here/python/$file" "$@" >out 2>err
  status=$?
  [ $status != 77 ] || skip "$(cat out)"
}

# shellcheck source=/dev/null
. "$case_file"
[ "$failures" = 0 ]
