# SPDX-License-Identifier: LGPL-3.0-or-later
# A body alone gets a farfield; a half body gets a symmetry plane too.
octahedron >octa.obj
vanguard mesh -q -p octa --farfield-lengths 4 --growth 1.5
exits 0
says out "External flow around 1 closed body; farfield added."
says out "added: farfield"
says out "validity: valid"
says octa.mapbc "farfield"
says octa.resolved.deck "sphere  4"
vanguard mesh -q -p octa --deck octa.resolved.deck --out again
exits 0
same octa.b8.ugrid again/octa.b8.ugrid
says out "Evidence: given by the setting flow external"

# Half of the body, cut at y = 0.
sed -e '/^v 0 -1 0/d' -e '/^f/d' octa.obj >half.obj
cat >>half.obj <<'END'
f 1 3 4
f 3 2 4
f 3 1 5
f 2 3 5
END
vanguard mesh -q -p half --farfield box --farfield-lengths 3 --growth 1.5
exits 0
says out "added: symmetry plane y = 0"
says out "added: farfield"
says out "validity: valid"
says half.mapbc "symmetry"

# An edge length in the wrong unit is refused before it fills the memory.
vanguard demo sphere --cells 2000 --out unit
for option in --farfield-spacing --hmax; do
  vanguard mesh -q -p unit/sphere --farfield sphere $option 1e-3
  exits 1
  says err "check that its spacing and hmax are in the unit of the surface"
done

# A boundary along the Mach cone, around the whole body and half of it. The
# resolved deck has the extents that were not given.
vanguard mesh -q -p octa --farfield mach --farfield-mach 1.6 \
  --farfield-radial 2 --growth 1.5 --out boom
exits 0
says out "External flow around 1 closed body; farfield added."
says out "validity: valid"
says boom/octa.resolved.deck "1.6   0.5       1           2       1   0   0"
vanguard mesh -q -p octa --deck boom/octa.resolved.deck --out boom_again
exits 0
same boom/octa.b8.ugrid boom_again/octa.b8.ugrid
says out "Evidence: given by the setting flow external"
vanguard mesh -q -p half --farfield mach --farfield-mach 1.6 \
  --farfield-radial 2 --growth 1.5 --out boom_half
exits 0
says out "added: symmetry plane y = 0"
says out "added: farfield"
says out "validity: valid"

# A domain that is too small names the point and the remedy, which works.
vanguard mesh -q -p octa --farfield mach --farfield-mach 1.6 \
  --farfield-radial 0.5 --out small
exits 1
says err "of the body is 1 from the axis"
says err "increase radial to 0.561 or more"
absent small/octa.b8.ugrid
vanguard mesh -q -p octa --farfield mach --farfield-mach 1.6 \
  --farfield-radial 0.561 --out small
exits 0
vanguard mesh -q -p octa --farfield-mach 1.6
exits 2
says err "mach is given, but kind is auto; set kind to mach"
printf 't\nfarfield\nkind mach ux uy uz\nmach 2 1 0.1 0\n' >cross.deck
vanguard mesh -q -p half --deck cross.deck --out cross
exits 1
says err "crosses the symmetry plane of the half model; uy must be 0"
