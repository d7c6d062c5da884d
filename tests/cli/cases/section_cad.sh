# SPDX-License-Identifier: LGPL-3.0-or-later
# Plane sections from the curves of CAD files: wires and faces, several
# elements, the plane y = 0, and refusals.
cad=$here/../cad
vanguard check "$cad/box.step"
[ $status = 0 ] || skip "this build cannot read CAD"

# A wire in STEP and IGES, and a face in BREP.
layers="--y-plus 1 --reynolds 6e6 --reference-length 1 --min-full 100"
for file in section.step section.iges section.brep; do
  vanguard check -q "$cad/$file" --cad-section yes
  exits 0
  says out "$file: plane section"
  says out "section aerofoil: chord 1, trailing edge at (1, 0) sharp"
  vanguard mesh -q -p "$cad/$file" --cad-section yes $layers \
    --write su2,b8.ugrid --out "${file#*.}"
  exits 0
  vanguard check -q "${file#*.}/section.b8.ugrid"
  exits 0
  says out "validity: valid"
done
says step/section.su2 "MARKER_TAG= aerofoil"

# A rerun from the resolved deck is the same.
vanguard mesh -q -p "$cad/section.step" --deck step/section.resolved.deck \
  --out again
exits 0
same step/section.su2 again/section.su2

# Slat and blunt flap in the plane y = 0.
vanguard check -q "$cad/elements.step" --cad-section yes
exits 0
says out "section element_1: chord 1"
says out "trailing edge at (1.5, -0.1) blunt, 0.005 wide"
vanguard mesh -q -p "$cad/elements.step" --cad-section yes --layers no \
  --farfield c --out elements --write b8.ugrid
exits 0

# Without the option, the errors name it.
vanguard mesh -q -p "$cad/section.step" --out x
exits 1
says err "only 2 curves"
says err "give --cad-section yes"
vanguard mesh -q -p "$cad/section.brep" --out defects
exits 1
says err "the option --cad-section yes"
vanguard mesh -q -p "$cad/box.step" --cad-section yes --out x
exits 1
says err "in no plane z = constant or y = constant"
vanguard mesh -q -p "$cad/plate_with_hole.brep" --cad-section yes --out x
exits 1
says err "face 1 has 2 wires"
vanguard surface -q "$cad/section.step" --cad-section yes --out x
exits 1
says err "is a plane section"
absent x
