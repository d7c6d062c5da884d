#!/bin/bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# Installs the build tree, then builds external programs against it with CMake
# and with pkg-config, and runs them: the examples, and consumer.c, which uses
# the whole library. The same for the Python module.
# consumer.sh BUILD_DIR FOLDER CMAKE CC
set -eu
build=$1 folder=$2 cmake=$3 cc=$4
here=$(dirname "$(realpath "$0")")
examples=$here/../../examples
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 \
  OMPI_MCA_rmaps_base_oversubscribe=1 OMPI_MCA_hwloc_base_binding_policy=none \
  PRTE_MCA_rmaps_default_mapping_policy=:oversubscribe \
  PRTE_MCA_hwloc_default_binding_policy=none

fail() {
  echo "consumer.sh: $*" >&2
  exit 1
}

rm -rf "$folder"
mkdir -p "$folder/files"
DESTDIR='' "$cmake" --install "$build" --prefix "$folder/prefix" >/dev/null
prefix=$folder/prefix

# --- installed files, and exported symbols of the library ---

headers=$(cd "$prefix/include" && find . -type f | LC_ALL=C sort)
[ "$headers" = "./vanguard/mesher.h
./vanguard/vanguard.h" ] ||
  fail "headers other than vanguard.h and mesher.h are installed: $headers"
library=$(find "$prefix" -name libvanguard.so)
nm -D --defined-only --with-symbol-versions "$library" |
  awk '$2 != "A" { print $3 }' | LC_ALL=C sort >"$folder/abi"
diff -u "$here/consumer/abi.list" "$folder/abi" ||
  fail "the symbols of the library differ from tests/cli/consumer/abi.list." \
    "Existing symbols must be kept; add new ones to the list"
sed -n '/^VANGUARD_API/ { /(/! N; s/\n/ /; s/^.*\(vanguard_[a-z_]*\)(.*/\1/p; }' \
  "$prefix/include/vanguard/vanguard.h" | LC_ALL=C sort >"$folder/declared"
sed -n 's/\(vanguard_.*\)@@.*/\1/p' "$folder/abi" |
  diff -u "$folder/declared" - || fail "declared and exported symbols differ"

# --- every link of an installed document has a target ---

find "$prefix/share/doc" -name '*.md' | while read -r page; do
  grep -oE '\]\([^) #]+' "$page" | sed 's/^](//' | grep -v '://' |
    while read -r target; do
      [ -e "$(dirname "$page")/$target" ] ||
        fail "$page links to $target, which is not installed"
    done || exit 1
done || exit 1

# A sanitizer of the library must also be in the program.
flags=$(sed -n 's/^CMAKE_C_FLAGS:STRING=//p' "$build/CMakeCache.txt")
sanitizers() {
  [[ $flags = *-fsanitize* ]]
}

# Libraries whose licences must not apply to program and library are in the
# helper programs: neither their files nor their symbols are in the others.
for file in "$library" "$prefix/bin/vanguard"; do
  needed=$(readelf -d "$file" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p')
  case $needed in
    *libtet* | *CGAL* | *libgmp.* | *libmpfr*) fail "$file needs $needed" ;;
  esac
  ! nm -C "$file" 2>/dev/null | grep -iE 'tetgen(io|mesh|behavior)|CGAL::' ||
    fail "$file contains TetGen or CGAL"
done

# The installation can be moved: its files find each other by relative paths,
# and none refers to the build tree.
find "$prefix" -type f \( -name 'lib*.so*' -o -perm -u+x ! -name '*.sbatch' \
    ! -name '*.py' ! -name '*.sh' \) |
  while IFS= read -r file; do
    paths=$(readelf -d "$file" | sed -n 's/.*R.*PATH.*\[\(.*\)\]/\1/p')
    case :$paths in
      *:/*) fail "$file searches absolute folders: $paths" ;;
    esac
    ! readelf -d "$file" | grep -q '(RPATH)' || sanitizers ||
      fail "$file has an RPATH, which wins over LD_LIBRARY_PATH"
  done

# --- by CMake: the examples, and a program in C and one in C++ ---

for project in "$here/consumer" "$examples"; do
  at=$folder/$(basename "$project")
  "$cmake" --no-warn-unused-cli -S "$project" -B "$at" -DCMAKE_C_COMPILER="$cc" \
    -DCMAKE_C_FLAGS="$flags" -DCMAKE_CXX_FLAGS="$flags" \
    -DCMAKE_PREFIX_PATH="$prefix" >/dev/null
  "$cmake" --build "$at" >/dev/null
done
"$folder/consumer/consumer" "$folder/files"
"$folder/consumer/consumer_cxx"

cd "$folder/files"
"$folder/examples/surface"
[ -s cube.vtu ] || fail "the example wrote no cube.vtu"
"$folder/examples/sizes" cube.lb8.ugrid 0.5 0.5 0.5 0.006 focus 2>/dev/null
[ -s focus.b8.ugrid ] || fail "the example wrote no focus.b8.ugrid"
if mpirun -n 2 true >/dev/null 2>&1; then
  # Memory that MPI itself does not free is not a leak of Vanguard.
  ASAN_OPTIONS=detect_leaks=0 mpirun -n 2 "$folder/examples/parallel" \
    cube.lb8.ugrid two
  "$prefix/bin/vanguard" mesh -q -p cube.lb8.ugrid -o one --write b8.ugrid \
    >/dev/null
  cmp one/cube.b8.ugrid two.b8.ugrid
else
  echo "mpirun does not start here: the parallel example is omitted"
fi

# --- by pkg-config ---

PKG_CONFIG_PATH=$(dirname "$(find "$prefix" -name vanguard.pc)")
export PKG_CONFIG_PATH
# shellcheck disable=SC2046,SC2086 # lists of words
"$cc" $flags $(pkg-config --cflags vanguard) "$examples/surface.c" \
  -o "$folder/by_pkg_config" $(pkg-config --libs vanguard)
env -u LD_LIBRARY_PATH "$folder/by_pkg_config" ||
  fail "a program of pkg-config does not find the library"

"$prefix/bin/vanguard" --version

# --- the drivers, found by the PATH, also through links ---

for driver in vanguard-cases vanguard-solvers; do
  usage=$(PATH="$prefix/bin:$PATH" "$driver" --help)
  [[ $usage == "usage: $driver "* ]] || fail "$driver: $usage"
done
"$prefix/bin/vanguard" demo box --cells 1000 --out driven >/dev/null
env -u VANGUARD "$prefix/bin/vanguard-cases" make driven/case \
  driven/box.lb8.ugrid --set hmax=1
env -u VANGUARD "$prefix/bin/vanguard-cases" submit driven/case >/dev/null
find "$prefix/share/doc" -name '*.py' ! -perm -u+x | while read -r script; do
  fail "$script has no run bit"
done

# --- the plug-in: a mesher that the program loads ---

# shellcheck disable=SC2046 # a list of words
"$cc" -shared -fPIC -Wall -Wextra -Werror $(pkg-config --cflags vanguard) \
  "$examples/mesher_plugin/star.c" -o "$folder/star.so"
"$prefix/bin/vanguard" demo box --cells 1000 --out plugin >/dev/null
"$prefix/bin/vanguard" mesh -q -p plugin/box --mesher ../star.so \
  --write lb8.ugrid --out meshed >report
grep -q 'subdomains filled by the selected mesher: 1,' report ||
  fail "the example of a mesher did not fill a box"
"$prefix/bin/vanguard" check -q meshed/box.lb8.ugrid >/dev/null

# --- by Python ---

python=
for try in python3 /usr/bin/python3; do
  ! "$try" -c 'import numpy' 2>/dev/null || { python=$try; break; }
done
if [ -z "$python" ]; then
  echo "Python is omitted: numpy is not installed (python3-numpy)"
elif sanitizers; then
  echo "Python is omitted: it is not built with the sanitizer"
else
  PYTHONPATH=$(dirname "$(find "$prefix" -name vanguard.py)")
  export PYTHONPATH
  "$python" "$here/consumer/test_vanguard.py" "$folder/files" \
    "$prefix/bin/vanguard"
  "$python" "$examples/notebook.py"
  # The wheel finds the library by the program on the PATH.
  unset PYTHONPATH
  if "$python" -c 'import venv, ensurepip, setuptools, wheel' 2>/dev/null; then
    "$python" -m venv --system-site-packages "$folder/venv"
    "$folder/venv/bin/pip" -q install --no-index --no-build-isolation \
      "$here/../.." >/dev/null
    found=$(cd / && PATH="$prefix/bin:$PATH" "$folder/venv/bin/python" -c \
      'import vanguard; print(vanguard.Job() and vanguard._find())')
    [ "$(realpath "$found")" = "$(realpath "$library")" ] ||
      fail "the wheel uses $found instead of $library"
  else
    echo "the wheel is omitted: Python has no setuptools, wheel or venv"
  fi
  [ -s ellipsoid.b8.ugrid ] || fail "the example wrote no ellipsoid.b8.ugrid"
fi
