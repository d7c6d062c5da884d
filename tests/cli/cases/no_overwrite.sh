# SPDX-License-Identifier: LGPL-3.0-or-later
# An input file is never overwritten: reported before anything is computed.
vanguard demo box --cells 2000 --out a
vanguard mesh -q -p a/box --out b --write b8.ugrid
exits 0

mkdir c
cp a/box.lb8.ugrid a/box.mapbc c
vanguard mesh -q -p c/box --write lb8.ugrid,cogsg
exits 1
says err "writing lb8.ugrid would overwrite the input c/box.lb8.ugrid"
says err "--out DIR"
same a/box.lb8.ugrid c/box.lb8.ugrid
absent c/box.cogsg

# Also through a link.
mkdir d
ln -s ../c/box.lb8.ugrid d/box.lb8.ugrid
vanguard mesh -q -p c/box --out d --write lb8.ugrid
exits 1
says err "would overwrite the input"
same a/box.lb8.ugrid c/box.lb8.ugrid

# A .mapbc that lacks a patch cannot replace that of the mesh.
grep -v '^6 ' a/box.mapbc >c/box.mapbc
vanguard mesh -q -p c/box
exits 1
absent c/box.cogsg

# A surface next to the input would be a second surface of the project. It can
# be written to another folder.
mkdir stl
cp a/box.* stl
for suffix in stl tri obj; do
  vanguard mesh -q -p stl/box --write b8.ugrid,$suffix
  exits 1
  says err "writing stl/box.$suffix next to the input stl/box.lb8.ugrid would"
  absent stl/box.b8.ugrid stl/box.$suffix
done
(cd stl && ! "$program" mesh -q -p box --write obj 2>/dev/null) ||
  fail "a second surface in the current folder"
vanguard mesh -q -p stl/box --out stl/.. --write stl
exits 0
exists box.stl
vanguard check -q stl/box
exits 0

# Files without names and conditions get a .mapbc, but not in place of an input.
for form in lb8.ugrid meshb; do
  vanguard mesh -q -p a/box --write $form --out named_$form
  exits 0
  says named_$form/box.mapbc "[written by vanguard mesh]"
done
vanguard mesh -q -p a/box --write vtu --out unnamed
absent unnamed/box.mapbc
cp a/box.mapbc given.mapbc
vanguard mesh -q -p a/box --write b8.ugrid
exits 0
same a/box.mapbc given.mapbc
rm a/box.b8.ugrid

vanguard mesh -q -p a/box --out e --write nonsense
exits 2
says err "unknown format 'nonsense'"
vanguard mesh -q -p a/none
exits 1
says err "no project found"
cp a/box.lb8.ugrid a/box.b8.ugrid
vanguard mesh -q -p a/box --out e
exits 1
says err "could be the surface; give the complete name of one"

# A folder with the name of an output file: all files are written, or none.
# For a requested file this is checked beforehand; for an additional file,
# before anything is moved to its place.
cp a/box.lb8.ugrid g.lb8.ugrid
for suffix in cogsg report.json; do
  mkdir -p f/g.$suffix
  vanguard mesh -q -p g.lb8.ugrid --out f
  exits 1
  says err "f/g.$suffix: a folder exists where a file must be written"
  [ "$(ls -A f)" = g.$suffix ] || fail "left behind: $(ls -A f)"
  rmdir f/g.$suffix
done
