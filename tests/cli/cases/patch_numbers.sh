# SPDX-License-Identifier: LGPL-3.0-or-later
# Numbers of patches: CGNS keeps them, and a .mapbc next to a format whose
# numbers are only an order is matched by name.
needs tetgen

# shellcheck source=tests/cli/duct.bash
. "$here/duct.bash"

# A .mapbc with numbers that are not the order of the solids.
lines() {
  printf '#box\n#bc.map\nPatch BC Family #surf surfIDs Family\n#--\n'
  printf '%s\n' "$@"
}
duct box "disk 2 2  0.5 0.25 0.25  0 0.5 0  0 0 0.5"
lines "21 3 3 0 0 w6" "2 4 4 0 0 w5" "3 5 5 0 0 w4" "5 1 1 0 0 w3" \
  "7 4 4 0 0 w2" "11 3 3 0 0 w1" >box.mapbc
conditions() {
  grep -E '^ +[0-9]+ .*; ' out | sed 's/;.*//' | awk '{ print $NF, $3 }' | sort
}
cat >expected <<'END'
w1 3
w2 4
w3 1
w4 5
w5 4
w6 3
END
vanguard mesh box.stl --flow internal --quiet --sheets disk --hmax 0.3 \
  --write b8.ugrid,msh --out o
exits 0
for form in b8.ugrid msh; do
  vanguard check o/box.$form
  exits 0
  conditions | diff expected - || fail "$form: conditions differ"
done

# CGNS with numbers of its own, and the .mapbc of the .ugrid next to it.
vanguard convert o/box.msh c.cgns
if [ "$status" = 0 ]; then
  cp o/box.mapbc c.mapbc
  vanguard check c.cgns
  exits 0
  conditions | diff expected - || fail "CGNS: conditions differ"
  says out "  disk"
  vanguard convert c.cgns c.openfoam
  exits 0
  awk '/^    w/ { name = $1 } /type/ { print name, $2 }' \
    c.openfoam/constant/polyMesh/boundary | tr -d ';' >out
  says out "w2 wall"
  says out "w3 symmetryPlane"
  says out "w6 patch"
  vanguard convert c.cgns c.b8.ugrid
  exits 0
  same c.b8.ugrid o/box.b8.ugrid
  # Names of another mesh.
  sed 's/w6/outlet/' o/box.mapbc >c.mapbc
  vanguard check c.cgns
  exits 1
  says err "patch 6 is 'outlet' here but 'w6' in the mesh"
  vanguard convert c.cgns d.b8.ugrid
  exits 1
  absent d.b8.ugrid
  sed 's/w[0-9]$//' o/box.mapbc >c.mapbc
  vanguard check c.cgns
  exits 0
  conditions | diff expected - || fail "numbers alone: conditions differ"
else says err "HDF5"; fi

# Surfaces: by name, or an error that names both readings.
vanguard convert box.stl b.obj
exits 0
cp box.mapbc b.mapbc
for file in box.stl b.obj; do
  vanguard convert $file s_$file.tri
  exits 0
  awk '$6 ~ /^w/ { print $6, $2 }' s_$file.mapbc | sort | diff expected - ||
    fail "$file: conditions differ"
done
lines "1 4 4 0 0 w1" "2 4 4 0 0 hub" >b.mapbc
vanguard check b.obj
exits 1
says err "b.mapbc: patch 2 is 'hub' here but 'w2' in the mesh"
