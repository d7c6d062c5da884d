# SPDX-License-Identifier: LGPL-3.0-or-later
# Layers on a body without conditions, and as AFLR's files request them.
corners=("1 0 0" "0 1 0" "0 0 1" "-1 0 0" "0 -1 0" "0 0 -1")
facet() {
  echo " facet normal 0 0 0"; echo "  outer loop"
  for corner; do echo "   vertex ${corners[corner]}"; done
  echo "  endloop"; echo " endfacet"
}
{
  echo "solid upper"
  facet 0 1 2; facet 1 3 2; facet 3 4 2; facet 4 0 2
  echo "endsolid upper"; echo "solid lower"
  facet 1 0 5; facet 3 1 5; facet 4 3 5; facet 0 4 5
  echo "endsolid lower"
} >body.stl

# Requested: layers on the whole body, not on the farfield.
vanguard mesh -q -p body --first 0.01
exits 0
says out "2 patches with layers but without a boundary condition"
lacks out "inviscid"
says body.mapbc "4"
rm body.mapbc
says out "no patch has a boundary condition: layers grow on the whole body"
lacks out "not viscous"
[ "$(grep -c '"wall_by": "body"' body.report.json)" = 2 ] ||
  fail "not both patches of the body are walls"
sed -n '/^layers$/,/^$/p' body.resolved.deck >rows
[ "$(grep -c yes rows)" = 2 ] || fail "the resolved deck does not list them"
vanguard mesh -q -p body --deck body.resolved.deck --out again
exits 0
same body.b8.ugrid again/body.b8.ugrid

# One half alone is too steep for layers.
vanguard mesh -q -p body --first 0.01 --slip 2 --out slip
exits 4
[ "$(grep -c '"wall_by"' slip/body.report.json)" = 1 ] ||
  fail "a slip patch has layers"

# A range of walls that includes the added farfield: no layers grow on it.
vanguard mesh -q -p body --first 0.01 --walls 1-3 --out far
exits 1
says err "walls: patch 3 is the farfield that was added to the surface"
says err "Patches: 1 upper (no condition), 2 lower (no condition)"
printf 't\nlayers\nid grow\n3 yes\n' >far.deck
vanguard mesh -q -p body --first 0.01 --deck far.deck --out far
exits 1
says err "layers: patch 3 is the farfield that was added"

# Patches by name, in lists and tables.
vanguard mesh -q -p body --first 0.01 --walls "1,low*" --out byname
exits 0
same body.b8.ugrid byname/body.b8.ugrid
vanguard mesh -q -p body --first 0.01 --walls "*" --out byname
exits 0
same body.b8.ugrid byname/body.b8.ugrid
vanguard mesh -q -p body --first 0.01 --walls 1 --out one
vanguard mesh -q -p body --first 0.01 --slip '"lower"' --out byname
exits 4
same one/body.b8.ugrid byname/body.b8.ugrid
printf 't\nlayers\nid grow\nl?wer no\n' >low.deck
vanguard mesh -q -p body --first 0.01 --deck low.deck --out byname
exits 4
same one/body.b8.ugrid byname/body.b8.ugrid
printf 't\npatches\nid name\nlower keel\n' >low.deck
vanguard mesh -q -p body --first 0.01 --deck low.deck --slip keel --out keel
exits 4
same one/body.b8.ugrid keel/body.b8.ugrid
says keel/body.resolved.deck '2   -   keel'
vanguard mesh -q -p body --first 0.01 --walls uper --out byname
exits 1
says err "walls: no patch of the surface is named 'uper'; did you mean 'upper'?"
printf 't\nlayers\nid first\n2 0.01\n*er 0.02\n' >low.deck
vanguard mesh -q -p body --deck low.deck --out byname
exits 1
says err "layers: patch 2 lower is listed twice, as 2 and as *er"

# Not requested: no layers.
vanguard mesh -q -p body --out none
exits 0
absent none/body.wall.vtu

# .tags: a wall, its first height and the number of its layers.
mkdir aflr
cp body.stl aflr
cat >aflr/body.tags <<'END'
# id group visc recon rebuild fixed source trans delete spacing thickness layers
1 upper 1 1 0 0 0 0 0 0.02 0 3
2 lower 1 1 0 0 0 0 0 0.02 0 3
END
vanguard mesh -q -p aflr/body
exits 0
exists aflr/body.wall.vtu
grep -A4 '"first_requested"' aflr/body.report.json | grep -q '"min": 0.02' ||
  fail "not the height of the .tags"
grep -A4 '"levels"' aflr/body.report.json | grep -q '"max": 3.0' ||
  fail "not the number of the .tags"
says aflr/body.report.json '"wall_by": "condition"'
# Options override the file.
vanguard mesh -q -p aflr/body --first 0.01 --layer-count 2 --out given
exits 0
grep -A4 '"first_requested"' given/body.report.json | grep -q '"min": 0.01' ||
  fail "the .tags won over --first"

# An AFLR .bc found by its name; it is an input that a .cogsg would overwrite.
rm aflr/body.tags
printf 'upper -1 0.02\nlower -1 0.02\n' >aflr/body.bc
vanguard mesh -q -p aflr/body
exits 1
says err "would overwrite the input"
vanguard mesh -q -p aflr/body --write b8.ugrid
exits 0
grep -A4 '"first_requested"' aflr/body.report.json | grep -q '"min": 0.02' ||
  fail "not the height of the .bc"

# A .surf: layers where the flag is -1, first heights by point, between 0.01
# and 0.02.
mkdir surf
cat >surf/body.surf <<'END'
8 0 6
1 0 0 0.01
0 1 0 0.01
0 0 1 0.02
-1 0 0 0.01
0 -1 0 0.01
0 0 -1 0.01
1 2 3 1 7 -1
2 4 3 1 7 -1
4 5 3 1 7 -1
5 1 3 1 7 -1
2 1 6 2 7 -1
4 2 6 2 7 -1
5 4 6 2 7 -1
1 5 6 2 7 -1
END
vanguard mesh -q -p surf/body --out by_point
exits 0
grep -A4 '"first_requested"' by_point/body.report.json | grep -q '"max": 0.02' ||
  fail "not the heights of the .surf"
grep -A4 '"first_requested"' by_point/body.report.json | grep -q '"min": 0.01' ||
  fail "not the heights of the .surf"
vanguard mesh -q -p surf/body --deck by_point/body.resolved.deck --out again
exits 0
same by_point/body.b8.ugrid again/body.b8.ugrid
vanguard mesh -q -p surf/body --first 0.03125 --out one_height
exits 0
grep -A4 '"first_requested"' one_height/body.report.json |
  grep -q '"max": 0.03125' || fail "--first did not win over the .surf"

# Sliver triangles on a wall are removed before layers grow, and only then.
cat >needle.obj <<'END'
v 1 0 0
v 0 1 0
v 0 0 1
v -1 0 0
v 0 -1 0
v 0 0 -1
v 0.999 0 0.001
f 1 2 7
f 7 2 3
f 2 4 3
f 4 5 3
f 5 1 7
f 5 7 3
f 2 1 6
f 4 2 6
f 5 4 6
f 1 5 6
END
vanguard mesh -q -p needle --first 0.001 --out swapped
exits 0
says out "needles from 2 to 0"
says swapped/needle.report.json '"wall_triangles": 8'
vanguard mesh -q -p needle --deck swapped/needle.resolved.deck --out again
exits 0
same swapped/needle.b8.ugrid again/needle.b8.ugrid
vanguard mesh -q -p needle --first 0.001 --surface-swap no --out as_given
exits 0
lacks out "swaps and"
says as_given/needle.report.json '"wall_triangles": 10'
vanguard mesh -q -p needle --out isotropic
exits 0
lacks out "swaps and"
says out "needle, patch 1, face"
says isotropic/needle.report.json '"needles": 2'
