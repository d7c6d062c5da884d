#!/bin/bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# Checks on bare Debian 12 systems what a new user types. A bare system holds
# apt and the packages that apt needs, nothing else.
#   system 1, as root               README.md, command by command; installation
#   system 1, as an ordinary user   both commands of bootstrap.sh in the other
#                                   order; the packages are installed, but
#                                   there is no sudo
#   system 2                        the .deb packages, built in system 1
# bare.sh SOURCE CACHE
#   SOURCE  git repository, whose HEAD is cloned
#   CACHE   folder that keeps the bare system, Debian's packages and the objects
#           of the compiler for the next run on this machine
# The systems are folders in memory (5 GB), entered by chroot. This takes root
# and the right to mount, and fails without them.
set -euo pipefail
source=$(realpath "$1")
mkdir -p "$2"
cache=$(realpath "$2")
here=$(dirname "$(realpath "$0")")
started=$SECONDS

fail() {
  echo "bare.sh: $*" >&2
  exit 1
}

say() {
  echo "-- $* ($((SECONDS - started)) s)"
}

if [ -z "${VG_BARE_NAMESPACE:-}" ]; then
  [ "$(id -u)" = 0 ] || fail "the check of bare systems needs root, for" \
    "chroot. Run it as root, or in a virtual machine"
  unshare --mount true 2>/dev/null || fail "this machine refuses mount" \
    "namespaces, which the check of bare systems needs for chroot. In a" \
    "container, add the capability SYS_ADMIN"
  command -v mmdebstrap >/dev/null || fail "mmdebstrap is missing: apt-get" \
    "install mmdebstrap"
  # All mounts below vanish with the namespace.
  VG_BARE_NAMESPACE=1 exec unshare --mount --propagation private \
    "$here/$(basename "$0")" "$source" "$cache"
fi

systems=$cache/systems
mkdir -p "$systems" "$cache/archives" "$cache/objects"
mount -t tmpfs -o size=8g,mode=755 bare "$systems"

# The bare system, made once a day: Debian updates its packages.
tar=$cache/bookworm-$(date +%F).tar
if [ ! -s "$tar" ]; then
  rm -f "$cache"/bookworm-*.tar
  TMPDIR=$systems mmdebstrap --quiet --mode=root --variant=apt --format=tar \
    --aptopt='Acquire::Languages "none"' bookworm "$tar.part"
  mv "$tar.part" "$tar"
  say "a bare system was made: $(du -h "$tar" | cut -f1)"
fi

# Where apt finds Debian's packages on this machine.
share_apt() {
  rm -f "$1"/etc/apt/sources.list
  (cd / && tar -cf - etc/apt/apt.conf.d etc/apt/sources.list* \
    etc/apt/auth.conf.d etc/resolv.conf etc/hosts 2>/dev/null || true) |
    tar -C "$1" -xf - --exclude='*docker*' --exclude='*packagekit*' \
      --exclude='*appstream*'
  # Packages of others need keys that a bare system lacks.
  find "$1/etc/apt/sources.list.d" -type f ! -name 'debian*' -delete
}

# new_system NAME: a bare system in $systems/NAME.
new_system() {
  local root=$systems/$1

  mkdir "$root"
  tar -C "$root" -xf "$tar"
  share_apt "$root"
  echo force-unsafe-io >"$root/etc/dpkg/dpkg.cfg.d/memory"
  mount --rbind /dev "$root/dev"
  mount -t proc proc "$root/proc"
  mount --rbind /sys "$root/sys"
  mkdir -p "$root/var/cache/apt/archives" "$root/host"
  mount --bind "$cache/archives" "$root/var/cache/apt/archives"
}

# inside NAME USER COMMAND...: with the environment of a new login.
inside() {
  local root=$systems/$1 user=$2 home=/home/newcomer

  shift 2
  [ "$user" != root ] || home=/root
  chroot --userspec="$user" "$root" env -i HOME="$home" USER="$user" \
    PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin \
    DEBIAN_FRONTEND=noninteractive \
    CMAKE_C_COMPILER_LAUNCHER="${launcher:-}" \
    CMAKE_CXX_COMPILER_LAUNCHER="${launcher:-}" \
    CCACHE_DIR=/objects CCACHE_BASEDIR="$home" CCACHE_NOHASHDIR=1 \
    CCACHE_SLOPPINESS=locale \
    bash -euo pipefail -c "cd; $*"
}

# Objects are compiled once for all builds: the compiler cache of this machine,
# with its libraries, works in the bare system without being installed there.
share_objects() {
  local root=$systems/$1

  launcher=
  command -v ccache >/dev/null || return 0
  mount --bind / "$root/host"
  mkdir -p "$root/objects" "$root/launch"
  mount --bind "$cache/objects" "$root/objects"
  chmod -R a+rwX "$cache/objects"
  printf '#!/bin/sh\numask 0\nexec %s --library-path %s %s "$@"\n' \
    /host/lib64/ld-linux-x86-64.so.2 /host/lib/x86_64-linux-gnu \
    "/host$(command -v ccache)" >"$root/launch/ccache"
  chmod +x "$root/launch/ccache"
  launcher=/launch/ccache
}

# clone NAME FOLDER USER
clone() {
  git clone -q --no-hardlinks "$source" "$systems/$1$2/vanguard"
  chroot "$systems/$1" chown -R "$3:" "$2/vanguard"
}

# The commands that the README shows, except for the whole test suite.
commands_of_readme() {
  sed -n 's/^    //p' "$source/README.md" |
    grep -E '^(\./bootstrap\.sh|vanguard|export|cmake) ' |
    grep -v '^./bootstrap.sh test' | sed 's/ *# .*//'
}

few='unit\.test_(table|heap|ugrid|insert|cad)$|cli\.(mesh|usage)$'
system=source
new_system $system
share_objects $system
say "system 1, as root: the README, command by command"
clone $system /root root
mapfile -t commands < <(commands_of_readme)
[ "${#commands[@]}" -ge 4 ] || fail "the README shows ${#commands[@]} commands"
inside $system root "cd vanguard; $(for command in "${commands[@]}"; do
  printf 'echo %q\n%s\n' "\$ $command" "$command"
done)" >"$systems/log" 2>&1 ||
  fail "a command of the README failed: $(tail -40 "$systems/log")"
grep -h '^\$ ' "$systems/log"
! grep -n 'warning:' "$systems/log" || fail "the build prints warnings"
[ -s "$systems/$system/root/vanguard/build/demo/wing.vtu" ] ||
  fail "demo left no build/demo/wing.vtu"

say "system 1, as root: installation"
inside $system root "cmake --install vanguard/build/release --prefix /opt/v" \
  >"$systems/log" 2>&1 || fail "cmake --install: $(tail "$systems/log")"
inside $system root "/opt/v/bin/vanguard --version
  /opt/v/bin/vanguard check -q vanguard/examples/wing_from_cad/wing.step" \
  >"$systems/log" 2>&1 || fail "installed program: $(tail "$systems/log")"

say "system 1, as root: tests after demo"
inside $system root "cd vanguard; VG_TESTS='$few' ./bootstrap.sh test" \
  >"$systems/log" 2>&1 || fail "bootstrap.sh test: $(tail -40 "$systems/log")"
grep 'tests passed' "$systems/log"

say "system 1, as an ordinary user without sudo: tests, then demo"
chroot "$systems/$system" useradd --create-home newcomer
clone $system /home/newcomer newcomer
inside $system newcomer "cd vanguard
  VG_TESTS='$few' ./bootstrap.sh test; ./bootstrap.sh demo" \
  >"$systems/log" 2>&1 || fail "as a user: $(tail -40 "$systems/log")"
grep 'tests passed' "$systems/log"

say "system 1: the .deb packages"
inside $system root "apt-get -qq install -y --no-install-recommends dpkg-dev \
    file >/dev/null
  cd vanguard
  cmake --preset package -G Ninja
  cmake --build --preset package
  cd build/package; cpack" >"$systems/log" 2>&1 ||
  fail "packages: $(tail -40 "$systems/log")"
launcher=
new_system packages
cp "$systems/$system"/root/vanguard/build/package/*.deb "$systems/packages/root"

say "system 2: the .deb packages"
cp "$here/installed.sh" "$systems/packages/root"
inside packages root "apt-get -qq update
  apt-get -qq install -y ./*.deb >/dev/null
  ./installed.sh" >"$systems/log" 2>&1 ||
  fail "packages: $(tail -40 "$systems/log")"
tail -n 4 "$systems/log"
say "bare systems: all commands worked"
