# SPDX-License-Identifier: LGPL-3.0-or-later
# A disk that is full after any number of bytes: all files of a run, or none,
# and the files of an earlier run stay.
needs metis
mkdir disk
mount -t tmpfs -o size=64k vanguard-test disk 2>err ||
  skip "a tmpfs cannot be mounted here (needs root): $(cat err)"
trap 'umount disk' EXIT

vanguard demo box --cells 2000 --out p
vanguard mesh -q -p p/box --out m --write b8.ugrid

# fits COMMAND...: tries the command on disks of growing size, until it fits.
fits() {
  for ((k = 8; k < 2000; k += k / 8 + 4)); do
    mount -o "remount,size=${k}k" disk
    vanguard "$@"
    [ "$status" != 0 ] || break
    exits 1
    says err "No space left on device"
    ls -A disk >left
    diff before left || fail "$* on a disk of $k kB left files"
  done
  exits 0
}

: >before
fits mesh -q -p p/box --out disk --write b8.ugrid,foam,vtu
exists disk/box.b8.ugrid disk/box.report.json
rm -r disk/box.*
fits partition -q m/box.b8.ugrid -n 3 --write part,vtu,foam --out disk/box
rm -r disk/box.*
fits convert -q m/box.b8.ugrid disk/box.msh
rm -r disk/box.*

# The old mesh stays when the new one does not fit.
mount -o remount,size=4000k disk
vanguard mesh -q -p p/box --out disk --write b8.ugrid,foam
exits 0
cp -a disk/. old
used=$(du -sk --apparent-size disk | cut -f1)
mount -o "remount,size=$((used + used / 2))k" disk
vanguard mesh -q -p p/box --out disk --write b8.ugrid,foam
exits 1
diff -r old disk || fail "the old files have changed"
