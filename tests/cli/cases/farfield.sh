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
