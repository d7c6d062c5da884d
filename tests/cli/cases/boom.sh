# SPDX-License-Identifier: LGPL-3.0-or-later
# A sonic boom: the demo in two commands, sources along the Mach cones, and what
# they refuse.
needs tetgen
vanguard demo boom-half --cells 30000 --out p
exits 0
says out "Next: vanguard mesh -p p/boom-half"
says p/boom-half.deck "machcone"
vanguard mesh -q -p p/boom-half
exits 0
says out "(half model, cut at y = 0); symmetry plane and half a farfield added."
says out "note: source 1: Mach cones at M 1.6 with apexes from (-0.1, 0, 0) to (1.1, 0, 0), up to 2 from the axis"
says out "validity: valid"
says out "layer cells:"
lacks out "is limited everywhere"
vanguard demo boom --cells 40000 --out p
exits 0
vanguard mesh -q -p p/boom --layers no --out whole
exits 0
says out "External flow around 1 closed body; farfield added."
says out "apexes from (-0.1, 0, 0) to (1.1, 0, 0), up to 2 from the axis"
says out "validity: valid"

# The resolved deck has the place of the cones, and gives the same bytes.
vanguard mesh -q -p p/boom --layers no --deck whole/boom.resolved.deck \
  --out again
exits 0
same whole/boom.b8.ugrid again/boom.b8.ugrid

# Values that neither the source nor the farfield gives.
printf 't\nsources\nkind h0 stretch\nmachcone 0.1 10\n' >bare.deck
vanguard mesh -q -p p/boom.lb8.ugrid --deck bare.deck --out bare
exits 1
says err "source 1 (machcone) has no Mach number; give the column mach, or farfield mach"
printf 't\nsources\nkind h0 stretch mach\nmachcone 0.1 10 1.6\n' >bare.deck
vanguard mesh -q -p p/boom.lb8.ugrid --deck bare.deck --out bare
exits 1
says err "source 1 (machcone) has no radius; give the column r0"
printf 't\nsources\nkind h0 stretch mach r0\nmachcone 0.1 0.5 1.6 1\n' >bare.deck
vanguard mesh -q -p p/boom.lb8.ugrid --deck bare.deck --out bare
exits 1
says err "its stretching is below 1"
printf 't\nsources\nkind h0 stretch mach r0\nmachcone 0.1 10 0.9 1\n' >bare.deck
vanguard mesh -q -p p/boom.lb8.ugrid --deck bare.deck --out bare
exits 1
says err "mach of source 1 is 0.9; it must be above 1"
absent bare/boom.b8.ugrid
