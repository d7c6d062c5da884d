#!/bin/bash
# Installs the build tree and builds a stranger's program against it, with
# CMake and with pkg-config. consumer.sh BUILD_DIR FOLDER CMAKE CC
set -eu
build=$1 folder=$2 cmake=$3 cc=$4
here=$(dirname "$(realpath "$0")")

rm -rf "$folder"
mkdir -p "$folder"
DESTDIR='' "$cmake" --install "$build" --prefix "$folder/prefix" >/dev/null

# A sanitizer of the library must be in the program too.
flags=$(sed -n 's/^CMAKE_C_FLAGS:STRING=//p' "$build/CMakeCache.txt")

"$cmake" -S "$here/consumer" -B "$folder/build" -DCMAKE_C_COMPILER="$cc" \
  -DCMAKE_C_FLAGS="$flags" -DCMAKE_PREFIX_PATH="$folder/prefix" >/dev/null
"$cmake" --build "$folder/build" >/dev/null
"$folder/build/consumer"

pc=$(dirname "$(find "$folder/prefix" -name vanguard.pc)")
export PKG_CONFIG_PATH=$pc
# shellcheck disable=SC2046,SC2086 # lists of words
"$cc" $flags $(pkg-config --cflags vanguard) "$here/consumer/consumer.c" \
  -o "$folder/by_pkg_config" $(pkg-config --libs vanguard) \
  -Wl,-rpath,"$(pkg-config --variable=libdir vanguard)"
"$folder/by_pkg_config"

# The example of a mesher, against the installed header; run by the program.
# shellcheck disable=SC2046 # a list of words
"$cc" -shared -fPIC -Wall -Wextra -Werror $(pkg-config --cflags vanguard) \
  "$here/../../examples/mesher_plugin/star.c" -o "$folder/star.so"
cd "$folder"
prefix/bin/vanguard demo box --cells 1000 --out . >/dev/null
prefix/bin/vanguard mesh -q -p box --mesher ./star.so --write lb8.ugrid \
  --out meshed >report
grep -q 'parts filled by the other mesher 1:' report
prefix/bin/vanguard check -q meshed/box.lb8.ugrid >/dev/null

"$folder/prefix/bin/vanguard" --version
