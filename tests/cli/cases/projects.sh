# SPDX-License-Identifier: LGPL-3.0-or-later
# All commands accept a project by its stem, with -p, and by its .d3m.
needs metis
vanguard demo box --cells 2000 --out p
vanguard check -q p/box
exits 0
cp out expected
vanguard check -q -p p/box
exits 0
is out <expected
vanguard check -q -p p/box p/box
exits 2
says err "only one file is accepted"
vanguard surface -q -p p/box --out s
exits 0
exists s/box.lb8.ugrid

# The volume mesh of a project: the .cogsg, of which the layers are known.
vanguard partition -q -p p/box -n 4
exits 1
says err "p/box: there is no such file, and no volume mesh of a project"
says err "'vanguard mesh -p p/box' generates them"
absent p/box.part.4
vanguard mesh -q p/box
exits 0
vanguard partition -q p/box.cogsg -n 4 --out expected
exits 0
for project in p/box "-p p/box"; do
  rm -f p/box.part.4
  # shellcheck disable=SC2086
  vanguard partition -q $project -n 4
  exits 0
  says out "p/box.cogsg: solver partition"
  says out "note: p/box.b8.ugrid is also a volume mesh"
  same p/box.part.4 expected.part.4
done
vanguard partition -q p/box.b8.ugrid -n 4
exits 0
lacks out "note:"

# A VGRID project by its .d3m.
project=$here/../../examples/wing_body/wing_body
[ -e "$project.d3m" ] || skip "no example with a .d3m"
cp "$project".* .
vanguard check -q wing_body
sed 1d out >expected
vanguard check -q wing_body.d3m
exits 0
sed 1d out | diff expected - || fail "the reports differ"
vanguard partition -q wing_body.d3m -n 2
exits 1
says err "there is neither wing_body.cogsg nor wing_body.b8.ugrid"
for command in check mesh plan surface; do
  vanguard $command -q nosuch.d3m
  exits 1
  says err "nosuch.d3m: this file does not exist"
done
