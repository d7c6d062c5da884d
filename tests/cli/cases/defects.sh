# SPDX-License-Identifier: LGPL-3.0-or-later
# A surface that cannot bound a mesh is reported, drawn and refused. The input
# is a unit tetrahedron as text without its slanted face.
cat >open.ugrid <<'END'
4 3 0 0 0 0 0
0 0 0  1 0 0  0 1 0  0 0 1
1 2 3  1 4 2  1 3 4
1 2 3
END
vanguard check -q open.ugrid --defects shown.vtu
exits 1
says out "open edges: 3"
says out "(not closed)"
says err "open: the surface is open: 1 rim"
says err "close-holes yes"
exists shown.vtu
vanguard check -q --json open.ugrid
exits 1
says out '"open edge": 3'
vanguard mesh -q -p open --farfield none
exits 1
says out "open edges: 3"
says err "the surface is open"
exists open.defects.vtu
absent open.cogsg open.b8.ugrid open.resolved.deck open.report.json

# An open tube is a body or a duct: the message names the options for both, and
# each of them works.
awk 'BEGIN { n = 12; print "g wall"
  for (i = 0; i < 2 * n; i++)
    print "v", cos(i % n * 6.2831853 / n), sin(i % n * 6.2831853 / n),
      9 * int(i / n)
  for (i = 1; i <= n; i++) {
    k = i % n + 1
    print "f", i, k, n + i; print "f", k, n + k, n + i } }' >tube.obj
vanguard check -q tube.obj
exits 1
says err "close-holes yes --flow external (a body)"
says err "close-holes yes --flow internal (a duct)"
for flow in external internal; do
  vanguard check -q tube.obj --close-holes yes --flow $flow
  exits 0
  lacks out "lie in no plane"
done
# A wavy rim has a cap, which the report mentions.
awk '/^v/ && $4 > 8 { $4 += 2 * cos(2 * atan2($3, $2)) } { print }' tube.obj \
  >wavy.obj
vanguard check -q wavy.obj --close-holes yes --flow external
exits 0
says out "caps on rims that lie in no plane, such as the common rim of two missing sides: 1"

# A plane sheet bounds no volume, whatever closes its rim.
cat >sheet.ugrid <<'END'
4 2 0 0 0 0 0
0 0 1  2 0 2  0 1 1  2 1 2
1 2 4  1 4 3
1 1
END
for option in "" "--close-holes yes" "--half z" "--flow internal"; do
  # shellcheck disable=SC2086 # an option and its value
  vanguard mesh -q -p sheet $option
  exits 1
  says err "all triangles lie in one plane: such a surface bounds no volume"
  lacks err "close-holes"
done

# Two tetrahedra that intersect are united.
cat >cross.ugrid <<'END'
8 8 0 0 0 0 0
0 0 0  1 0 0  0 1 0  0 0 1
0.1 0.1 0.1  1.1 0.1 0.1  0.1 1.1 0.1  0.1 0.1 1.1
1 3 2  1 2 4  1 4 3  2 3 4
5 7 6  5 6 8  5 8 7  6 7 8
1 1 1 1 2 2 2 2
END
vanguard check -q cross.ugrid
if grep -q "needs vanguard-wrap" err; then
  exits 1
else
  exits 0
  says out "were united: 2 shells became 1"
  says out "no defects"
fi

# A duplicate triangle, the second one reversed and in another solid: one
# finding, which the repair removes.
octahedron >twice.obj
printf 'g copy\nf 3 1 5\n' >>twice.obj
vanguard check -q twice.obj
exits 0
says out "repaired: 1 duplicate or degenerate triangles removed"
lacks out "self-intersection"
lacks out "non-manifold"
printf 't\nrepair\nno\n' >twice.deck
vanguard mesh -q -p twice.obj
exits 1
says out "duplicate triangles: 1"
lacks out "self-intersection"
lacks out "non-manifold"

# Two bodies that share a wall; without the wall they have a single skin.
{ octahedron
  echo "v 2 2 2"
  echo "g second"
  printf 'f %s\n' "1 5 3" "1 3 7" "3 5 7" "5 1 7"
} >wall.obj
vanguard check -q wall.obj
exits 0
says out "repaired: 2 triangles of walls shared by touching bodies removed"
vanguard mesh -q -p wall.obj --out united
exits 0
says out "note: 2 triangles of walls shared by touching bodies were removed"
vanguard check -q united/wall.b8.ugrid
exits 0
printf 't\nrepair\nno\n' >wall.deck
vanguard mesh -q -p wall.obj
exits 1
says out "triangles of shared walls: 1"
says out "unite the bodies, or use --wrap"
lacks out "self-intersection"

# Three lines for each kind of defect, however many there are.
octahedron | head -12 >lines.obj
vanguard check -q lines.obj
exits 1
says out "open edges: 5"
says out "... and 2 more"

# A patch whose boundary condition is missing.
cat >tet.ugrid <<'END'
4 4 0 0 0 0 0
0 0 0  1 0 0  0 1 0  0 0 1
1 2 3  1 4 2  1 3 4  2 4 3
1 2 3 4
END
vanguard check -q tet.ugrid
exits 0
printf '3\n1 4000 wall\n2 6662 symm\n3 5000 far\n' >tet.mapbc
vanguard check -q tet.ugrid
exits 1
says out "patches without boundary condition: 1"
vanguard mesh -q -p tet
exits 1
says out "patches without boundary condition: 1"

# The deck may supply it, but not for a patch that does not exist.
printf 't\npatches\nid bc name\n4 5000 "far two"\n' >tet.deck
vanguard mesh -q -p tet --out done
exits 0
says done/tet.mapbc "far_two"
says done/tet.resolved.deck "4   3   \"far two\""
printf 't\npatches\nid bc\n4 4100\n' >tet.deck
vanguard mesh -q -p tet --out more --write fun3d.mapbc
exits 0
says more/tet.resolved.deck "4   4100"
vanguard mesh -q -p tet --deck more/tet.resolved.deck --out again \
  --write fun3d.mapbc
same more/tet.fun3d.mapbc again/tet.fun3d.mapbc
says again/tet.fun3d.mapbc "4100"
printf 't\npatches\nid bc\n7 5000\n' >tet.deck
vanguard mesh -q -p tet
exits 1
says err "the surface has no patch 7"

for file in truncated.lb8.ugrid empty.stl noise.tri; do
  head -c 40 /dev/zero >$file
  vanguard check -q $file
  exits 1
  says err "vanguard: $file"
done
vanguard check -q absent.stl
exits 1
says err "absent.stl"
vanguard check -q usage.unknown
exits 1

# Names that are not UTF-8 do not break the JSON.
printf 't\npatches\nid bc name\n4 3 Fl\374gel\n' >tet.deck
vanguard mesh -q -p tet --json --out latin
exits 0
says out '"Fl?gel"'
