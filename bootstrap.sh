#!/bin/sh
# SPDX-License-Identifier: LGPL-3.0-or-later
# Builds and runs Vanguard on a fresh Debian 12 with one command:
#   ./bootstrap.sh demo   build, mesh the built-in example, show the report
#   ./bootstrap.sh test   build, run the whole test suite
# Both install missing packages first (as root, or with sudo). Without root they
# use the installed packages and name the missing ones. Further arguments go to
# CMake, such as -DVG_CAD=OFF. VG_TESTS=REGEX limits the tests to some names.
set -eu
cd "$(dirname "$0")"

required="cmake ninja-build gcc g++ pkg-config zlib1g-dev libjansson-dev \
liblapacke-dev libhwloc-dev libxxhash-dev"
optional="libopenmpi-dev openmpi-bin libmetis-dev libtet1.5-dev libcgal-dev \
libocct-data-exchange-dev libocct-ocaf-dev libhdf5-dev libmicrohttpd-dev"

# Prints those of the packages that are not installed.
missing_of() {
  for package in "$@"; do
    state=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null) ||
      state=
    [ "$state" = installed ] || printf ' %s' "$package"
  done
}

# need REQUIRED OPTIONAL (lists of packages)
need() {
  command -v dpkg-query >/dev/null || return 0   # not Debian: CMake reports
  # shellcheck disable=SC2086 # lists of words
  hard=$(missing_of $1) soft=$(missing_of $2)
  [ -n "$hard$soft" ] || return 0
  as_root=
  if [ "$(id -u)" != 0 ]; then
    as_root=sudo
    if ! command -v sudo >/dev/null || ! sudo -v 2>/dev/null; then
      without_root
      return 0
    fi
  fi
  echo "installing:$hard$soft"
  $as_root apt-get -qq update
  # shellcheck disable=SC2086
  DEBIAN_FRONTEND=noninteractive $as_root apt-get -qq install -y \
    --no-install-recommends $hard $soft >/dev/null
}

without_root() {
  if [ -n "$soft" ]; then
    echo "bootstrap.sh: built without the optional packages$soft" >&2
  fi
  [ -n "$hard" ] || return 0
  echo "bootstrap.sh: not root, and sudo is not available. Ask for these" \
    "packages:$hard" >&2
  exit 1
}

# VG_DATA_DIR is taken from the environment, or else from an earlier configure
# run. Without it, tests that need real geometry are skipped.
build() {
  target=$1
  shift
  mkdir -p build
  cmake --preset release -G Ninja ${VG_DATA_DIR:+-DVG_DATA_DIR="$VG_DATA_DIR"} \
    "$@" >build/configure.log 2>&1 || { cat build/configure.log >&2; exit 1; }
  sed -n '/^-- Parts of this build/,/^-- *$/p' build/configure.log
  cmake --build --preset release --target "$target"
}

command=${1:-}
[ $# = 0 ] || shift
case $command in
demo)
  need "$required" "$optional"
  build vanguard_run -DBUILD_TESTING=OFF "$@"
  rm -rf build/demo
  ./build/release/bin/vanguard demo wing --cells 600000 --out build/demo
  ./build/release/bin/vanguard mesh -p build/demo/wing \
    --write cogsg,b8.ugrid,vtu
  echo
  echo "Open build/demo/wing.vtu and, for the layers on the wing," \
    "build/demo/wing.wall.vtu in ParaView."
  ;;
test)
  need "$required libcmocka-dev" "$optional python3-numpy"
  build all -DBUILD_TESTING=ON "$@"
  ctest --preset release ${VG_TESTS:+-R "$VG_TESTS"}
  ;;
*)
  sed -n '3,8s/^# *//p' "$0" >&2
  exit 2
  ;;
esac
