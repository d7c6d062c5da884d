# SPDX-License-Identifier: LGPL-3.0-or-later
# vanguard convert: every format that is read to every format that is written.
# What a format holds comes back; what it cannot hold is reported.
cgns=cgns
"$program" --version --verbose | grep -q 'HDF5  *not in this build' && cgns=

# A prism, a tetrahedron above it, a pyramid on a side of it.
cat >mixed.ugrid <<'END'
8 8 2 1 1 1 0
0 0 0
1 0 0
0 1 0
0 0 1
1 0 1
0 1 1
0.3 0.3 2
0.5 -1 0.5
1 2 3
4 5 7
5 6 7
6 4 7
1 2 8
2 5 8
5 4 8
4 1 8
2 3 6 5
3 1 4 6
1 7 7 7 2 2 2 2 9 9
4 5 6 7
1 4 8 2 5
1 2 3 4 5 6
END
cat >mixed.mapbc <<'END'
4
1 4000 wing
2 6662 left side
7 5000 farfield
9 3000 end
END

# facts FILE: cells, volume, numbers of faces of the patches.
facts() {
  vanguard check --json "$1"
  [ "$status" = 0 ] || fail "check $1"
  sed -n 's/^ *"\(tetrahedra\|pyramids\|prisms\|faces\|volume\)": /\1 /p' out |
    sed 's/\(volume 1.[0-9]\{6\}\)[0-9]*/\1/; s/,$//'
}
named() { sed -n 's/^ *"\(name\|usm3d\)": //p' out; }

facts mixed.ugrid >want
named >want.names
says want "volume 1."
says want.names '"left side"'

forms="ugrid r8.ugrid b8.ugrid64 mesh meshb msh $cgns"
for from in $forms; do
  vanguard convert mixed.ugrid "a.$from"
  exits 0
  for to in $forms; do
    vanguard convert "a.$from" "b.$to"
    exits 0
    facts "b.$to" >got
    diff want got || fail "$from to $to"
    rm -f b.*
  done
  for to in su2 vtu fluent.msh openfoam; do
    vanguard convert "a.$from" "b.$to"
    exits 0
    exists "b.$to"
    rm -rf b.*
  done
  for to in stl obj tri; do
    vanguard convert "a.$from" "b.$to"
    exits 0
    says out "the 3 cells are omitted"
    rm -rf b.*
  done
  rm -f a.*
done

# A compressed file is read as a whole, a plain one in slices: the same bytes.
vanguard convert mixed.ugrid a.lb8.ugrid
gzip -k a.lb8.ugrid
mkdir whole sliced
for to in b8.ugrid lb4.ugrid r8.ugrid b8.ugrid64 vtu su2 msh $cgns cogsg; do
  vanguard convert a.lb8.ugrid.gz "whole/m.$to"
  sed 's,whole/,,' out >want.out
  vanguard convert a.lb8.ugrid "sliced/m.$to"
  sed 's,sliced/,,' out | sed 's/^a.lb8.ugrid:/a.lb8.ugrid.gz:/' |
    diff want.out - || fail "the report on $to"
  diff -r whole sliced || fail "$to in slices differs"
done
rm -r a.* whole sliced

# Names and conditions: in a .mapbc where the format has patch numbers.
vanguard convert mixed.ugrid to/a.lb8.ugrid
exits 1
mkdir to
vanguard convert mixed.ugrid to/a.lb8.ugrid
exits 0
says out "to/a.mapbc"
facts to/a.lb8.ugrid >/dev/null
named | tr ' ' _ >got.names
tr ' ' _ <want.names | diff - got.names || fail "names and conditions of a .ugrid"
vanguard convert mixed.ugrid to/a.lb8.ugrid # the .mapbc of convert is replaced
exits 0
lacks out "not overwritten"
echo "mine" >to/b.mapbc
vanguard convert mixed.ugrid to/b.msh
exits 0
says out "to/b.mapbc exists and is not overwritten"
says out ".msh has no boundary conditions: those of 4 patches are lost"
says out "patch 2 is called left_side instead of 'left side'"
echo "mine" | is to/b.mapbc
vanguard convert --mapbc to/a.mapbc mixed.ugrid to/c.obj
exits 0
says out ".obj has no boundary conditions: those of 4 patches are lost"
says to/c.obj "g wing"
vanguard convert mixed.ugrid to/c.stl
says out "2 are written as two triangles each"
vanguard convert mixed.ugrid to/c.su2
says out ".su2 has no boundary conditions"
says to/c.su2 "MARKER_TAG= farfield"
vanguard convert mixed.ugrid to/c.fluent.msh
says out "written as the types of .fluent.msh"
vanguard convert mixed.ugrid to/c.vtu
says out "the 4 patches are omitted"
vanguard convert mixed.ugrid to/c.b4.ugrid
says out "rounded to 4-byte reals"
vanguard convert --json mixed.ugrid to/d.cgns
[ -z "$cgns" ] || says out '"format": "cgns"'

# The form of OUT by --form.
vanguard convert --form foam-ascii mixed.ugrid to/e
exits 0
exists to/e.openfoam/constant/polyMesh/boundary
says to/e.openfoam/constant/polyMesh/points "ascii"
vanguard convert --form b8.ugrid mixed.ugrid to/e
exits 0
exists to/e.b8.ugrid

# Surfaces.
octahedron >body.obj
for to in stl tri mesh meshb msh b8.ugrid; do
  vanguard convert body.obj "s.$to"
  exits 0
  vanguard convert "s.$to" back.obj
  exits 0
  vanguard check back.obj
  says out "  boundary triangles                     8"
  rm -f s.* back.obj
done
vanguard convert body.obj s.fluent.msh
exits 1
says err "no cells"
absent s.fluent.msh

# VGRID's files, with the number of layer tetrahedra.
cat >tet.ugrid <<'END'
4 4 0 1 0 0 0
0 0 0
1 0 0
0 1 0
0 0 1
1 2 3
1 4 2
1 3 4
2 4 3
1 1 1 2
1 2 3 4
END
vanguard convert tet.ugrid v.cogsg
exits 0
says out "2 patches without a condition are inviscid walls (5) in the .mapbc"
exists v.cogsg v.bc v.mapbc
vanguard convert v.cogsg v2.lb8.ugrid
exits 0
facts v2.lb8.ugrid >got
says got "tetrahedra 1"

# Wrong usage.
vanguard convert mixed.ugrid
exits 2
vanguard convert mixed.ugrid x.foo
exits 2
says err "known formats are"
vanguard convert --form foo mixed.ugrid x
exits 2
vanguard convert mixed.ugrid ./mixed.ugrid
exits 2
says err "this is the input"
vanguard convert absent.ugrid x.msh
exits 1
absent x.msh x.mapbc
vanguard convert mixed.ugrid x.cogsg
exits 1
absent x.cogsg x.bc x.mapbc

# Wrong suffixes and names are wrong usage, and a device is no file.
vanguard convert mixed x.stl
exits 2
says err "give the complete name of a file, not the stem of a project"
vanguard convert mixed.nosuch x.stl
exits 2
vanguard convert mixed.ugrid x.nosuch
exits 2
mkfifo pipe
vanguard convert mixed.ugrid pipe --form su2
exits 2
says err "pipe: not a regular file"
absent pipe.su2
vanguard convert mixed.ugrid x.cogsg
exits 1
says err "x.cogsg: the format holds only"
lacks err "x.cogsg.cogsg"
