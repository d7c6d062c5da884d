#!/bin/sh
# Builds and runs Vanguard on a fresh Debian 12 with one command:
#   ./bootstrap.sh demo   build, mesh the built-in example, show the report
#   ./bootstrap.sh test   build, run the whole test suite
# Both install missing packages first (as root, or with sudo).
set -eu
cd "$(dirname "$0")"

packages="cmake ninja-build gcc g++ pkg-config libtet1.5-dev zlib1g-dev \
libjansson-dev libcmocka-dev liblapacke-dev libopenmpi-dev openmpi-bin \
libhwloc-dev libxxhash-dev libmetis-dev libhdf5-dev libocct-data-exchange-dev \
libocct-ocaf-dev libcgal-dev libmicrohttpd-dev"

install_missing() {
  missing=
  for package in "$@"; do
    state=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null) ||
      state=
    [ "$state" = installed ] || missing="$missing $package"
  done
  [ -n "$missing" ] || return 0
  echo "installing:$missing"
  as_root=
  if [ "$(id -u)" != 0 ]; then
    command -v sudo >/dev/null || {
      echo "bootstrap.sh: not root and no sudo; install:$missing" >&2
      exit 1
    }
    as_root=sudo
  fi
  $as_root apt-get -qq update
  # shellcheck disable=SC2086 # a list of words
  DEBIAN_FRONTEND=noninteractive $as_root apt-get -qq install -y \
    --no-install-recommends $missing >/dev/null
}

# VG_DATA_DIR is taken from the environment, or else from an earlier configure
# run. Without it, tests that need real geometry are skipped.
build() {
  cmake --preset release -G Ninja ${VG_DATA_DIR:+-DVG_DATA_DIR="$VG_DATA_DIR"} \
    >/dev/null
  cmake --build --preset release --target "$1"
}

case "${1:-}" in
demo)
  # shellcheck disable=SC2086
  install_missing $packages
  build vanguard_program
  rm -rf build/demo
  ./build/release/bin/vanguard demo wing --cells 600000 --out build/demo
  ./build/release/bin/vanguard mesh -p build/demo/wing \
    --write cogsg,b8.ugrid,vtu
  echo
  echo "Open build/demo/wing.vtu and, for the layers on the wing," \
    "build/demo/wing.wall.vtu in ParaView."
  ;;
test)
  # shellcheck disable=SC2086
  install_missing $packages python3-numpy
  build all
  ctest --preset release
  ;;
*)
  sed -n '2,5s/^# *//p' "$0" >&2
  exit 2
  ;;
esac
