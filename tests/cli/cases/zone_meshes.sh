# SPDX-License-Identifier: LGPL-3.0-or-later
# Meshes with a mesh of its own for each zone.
needs tetgen

# shellcheck source=tests/cli/duct.bash
. "$here/duct.bash"

# box ID OX OY OZ SX SY SZ N: the sides of a box, as sheets for duct.
box() {
  awk -v id="$1" -v x="$2" -v y="$3" -v z="$4" -v a="$5" -v b="$6" -v c="$7" \
    -v n="$8" 'BEGIN {
    print id, n, n, x, y, z, 0, b, 0, a, 0, 0
    print id, n, n, x, y, z + c, a, 0, 0, 0, b, 0
    print id, n, n, x, y, z, a, 0, 0, 0, 0, c
    print id, n, n, x, y + b, z, 0, 0, c, a, 0, 0
    print id, n, n, x, y, z, 0, 0, c, 0, b, 0
    print id, n, n, x + a, y, z, 0, b, 0, 0, 0, c }'
}

# A box in a box, and a plane that divides what is around them.
mapfile -t outer < <(box rot .25 .25 .25 .5 .5 .5 4)
mapfile -t inner < <(box in .375 .375 .375 .25 .25 .25 2)
duct two "${outer[@]}" "${inner[@]}"
printf 'z\n\nzones\nname x y z kind\nfar .01 .01 .01 fluid\n' >two.deck
printf 'rotor .26 .26 .26 rotating\ncore .5 .5 .5 porous\n' >>two.deck
valid two --zone-interfaces rot,in --walls 'rot,in,w*' --first 0.004 \
  --cells mixed --write b8.ugrid,zones.su2
lacks out "has no zones"

# --- zones.su2 -------------------------------------------------------------------

head -5 o_two/two.zones.su2 >out
says out "% CONFIG_LIST= ( far.cfg, rotor.cfg, core.cfg )"
says out "% MARKER_ZONE_INTERFACE= ( rot, rot_back, "
says out "NZONE= 3"
if /usr/bin/python3 -c 'import numpy' 2>/dev/null; then
  /usr/bin/python3 "$here/zones_su2.py" o_two/two.zones.su2 >out 2>err ||
    fail "zones.su2: $(cat err)"
  awk '{ print $1, $3 }' out >volumes
  printf 'far 0.875\nrotor 0.109375\ncore 0.015625\n' >expected
  same volumes expected
else echo "python3-numpy is not installed: zones.su2 is not read back"; fi
vanguard convert -q o_two/two.b8.ugrid back.zones.su2
exits 0
same back.zones.su2 o_two/two.zones.su2
absent back.sheets
lacks out "has no zones"
lacks out "are lost in"
mv two.deck two.txt
vanguard mesh two.stl --flow internal --quiet --baffles rot,in \
  --write zones.su2 --out no
exits 1
says err "no interface makes zones"
absent no
vanguard mesh two.stl --flow internal --quiet --sheets rot,in --hmax 0.12 \
  --write b8.ugrid --out one
exits 0
vanguard convert -q one/two.b8.ugrid one.zones.su2
exits 1
says err "the mesh has no zones"
absent one.zones.su2

# --- interfaces with two sides -----------------------------------------------------

mv two.txt two.deck
vanguard convert o_two/two.b8.ugrid slide.b8.ugrid --double-interfaces 'rot*'
exits 0
says out "has two sides, the back is patch"
says out "copies of points follow the others"
vanguard check slide.b8.ugrid
exits 0
says out "validity: valid"
says out "connected regions: 2"
says out " 0.109375 "
says out "  rotor"
says out "  rot_back"
vanguard convert -q o_two/two.b8.ugrid slide.fluent.msh --double-interfaces 'rot*'
exits 0
grep '^(45 ' slide.fluent.msh >out
says out "interface rot)"
says out "interface rot_back)"
vanguard convert -q o_two/two.b8.ugrid all.zones.su2 --double-interfaces '*'
exits 0
head -5 all.zones.su2 >out
grep '^% MARKER_ZONE_INTERFACE= ' all.zones.su2 >out
says out "rot, rot_back"
says out "in, in_back"
vanguard convert -q o_two/two.b8.ugrid slide --form foam --double-interfaces 'rot*'
exits 0
grep -A5 '^ *rot$' slide.openfoam/constant/polyMesh/boundary >out
says out "cyclicAMI;"
says out "neighbourPatch  rot_back;"
if command -v checkMesh >/dev/null; then
  # shellcheck source=tests/cli/openfoam.bash
  . "$here/openfoam.bash"
  load_openfoam
  (cd slide.openfoam && checkMesh) >out 2>err
  says out "Mesh OK."
else echo "OpenFOAM is not installed: checkMesh is omitted"; fi
vanguard convert o_two/two.b8.ugrid no.b8.ugrid --double-interfaces wing
exits 1
says err "wing"
absent no.b8.ugrid
vanguard convert one/two.b8.ugrid no.b8.ugrid --double-interfaces rot
exits 1
says err "has no interfaces between zones"

# An interface that is not doubled connects the zones again.
mapfile -t plane < <(box rot .25 .25 .25 .5 .5 .5 4)
duct mid "mid 8 8  0.5 0 0  0 1 0  0 0 1" "cut 8 8  0 0.5 0  1 0 0  0 0 1"
vanguard mesh mid.stl --flow internal --quiet --zone-interfaces mid,cut \
  --hmax 0.2 --remesh-surface yes --write b8.ugrid --out mid
exits 0
vanguard convert mid/mid.b8.ugrid no.b8.ugrid --double-interfaces mid
exits 0
vanguard check no.b8.ugrid
exits 0
says out "connected regions: 2"

# --- zones of a volume mesh as input -----------------------------------------------

for form in b8.ugrid msh; do
  vanguard convert -q o_two/two.b8.ugrid again_$form.$form
  exits 0
  vanguard mesh again_$form.$form --hmax 0.12 --quiet --write b8.ugrid \
    --out again
  exits 0
  says out "with the faces between its zones"
  vanguard check again/again_$form.b8.ugrid
  exits 0
  for zone in "1 fluid .* far" " 0.109375 .* rotor" " 0.015625 .* core"; do
    grep -q -- "$zone" out || fail "$form: no zone $zone"
  done
done
# Faces between zones that are in no sheet.
grep -v '^sheet\|^interface\|^[0-9]' again_b8.ugrid.sheets >t
mv t again_b8.ugrid.sheets
vanguard mesh again_b8.ugrid.b8.ugrid --hmax 0.12 --quiet --write b8.ugrid \
  --out again
exits 0
says out "is an interface"
grep -q '^interface .* far_to_rotor$' again/again_b8.ugrid.sheets ||
  fail "no interface of two zones"

# A mesh of Gmsh.
if command -v gmsh >/dev/null; then
  printf '%s\n' 'SetFactory("OpenCASCADE");' 'Box(1) = {0,0,0,1,1,1};' \
    'Box(2) = {0,0,1,1,1,1};' 'Box(3) = {0.3,0.3,0.3,0.3,0.3,0.3};' \
    'BooleanFragments{ Volume{1:3}; Delete; }{}' \
    'Physical Volume("upper") = {2};' 'Physical Volume("lower") = {4};' \
    'Physical Volume("core") = {3};' 'Mesh.MeshSizeMax = 0.3;' \
    'Mesh.SaveAll = 1;' >g.geo
  gmsh -3 -v 0 -o g.msh g.geo >out 2>&1 || fail "gmsh"
  vanguard mesh g.msh --quiet --write b8.ugrid,zones.su2 --out gmsh
  exits 0
  vanguard check gmsh/g.b8.ugrid
  exits 0
  says out "upper_to_lower"
  for zone in " 1  .* upper" " 0.973 .* lower" " 0.027 .* core"; do
    grep -q -- "$zone" out || fail "gmsh: no zone $zone"
  done
  head -5 gmsh/g.zones.su2 >out
  says out "CONFIG_LIST= ( upper.cfg, lower.cfg, core.cfg )"
else echo "gmsh is not installed: its mesh is omitted"; fi

# --- partitions --------------------------------------------------------------------

vanguard partition -q o_two/two.b8.ugrid -n 4 --whole-zones rotor,3 --write part,vtu
exits 0
vanguard partition -q --json o_two/two.b8.ugrid -n 4 --whole-zones rotor
exits 0
awk '/^zone 2 rotating/ { print $4, $5, $6 }' o_two/two.sheets >n
# cells of each kind in the order of the zones: those of the rotor
awk 'FNR == NR { if ($1 == "zone") for (k = 0; k < 4; k++) {
    n[k] += $(4 + k); before[k] += $2 < 2 ? $(4 + k) : 0
    own[k] += $2 == 2 ? $(4 + k) : 0 }
    next }
  { c = FNR - 1
    for (k = 0; k < 4 && c >= n[k]; k++) c -= n[k]
    if (c >= before[k] && c < before[k] + own[k]) print $1 }' \
  o_two/two.sheets o_two/two.part.4 | sort -u >parts
[ "$(wc -l <parts)" = 1 ] || fail "the rotor is in the parts $(cat parts)"
vanguard partition -q o_two/two.b8.ugrid -n 4 --zone-weights core=2,3=1
exits 2
says err "occurs twice"
vanguard partition -q o_two/two.b8.ugrid -n 4 --whole-zones core,core
exits 2
says err "occurs twice"
vanguard partition -q o_two/two.b8.ugrid -n 4 --whole-zones wing
exits 1
says err "has no zone 'wing'"

# --- a thin zone with fine triangles -----------------------------------------------

mapfile -t thin < <(box plate .25 .25 .5 .5 .5 .01 60)
duct thin "${thin[@]}"
vanguard check thin.stl --flow internal --zone-interfaces plate
says out "zone plate is thin, with a mean width of 0.0096"
says out "hmin, the smallest edge, makes them larger"

# --- volumes of a surface of Gmsh ----------------------------------------------------

# Two unit cubes on each other: surfaces 1 to 11, of which 11 is between them. The
# second volume has the surfaces $1.
cubes() {
  awk -v upper="$1" '
    BEGIN {
      print "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n2"
      print "3 1 \"lower\"\n3 2 \"upper\"\n$EndPhysicalNames"
      print "$Entities\n0 0 11 2"
      for (i = 1; i <= 11; i++) print i, 0, 0, 0, 1, 1, 2, 0, 0
      print "1 0 0 0 1 1 1 1 1 6 1 2 3 4 5 11"
      print "2 0 0 1 1 1 2 1 2", split(upper, s), upper "\n$EndEntities"
      print "$Nodes\n1 12 1 12\n2 1 0 12"
      for (i = 1; i <= 12; i++) print i
      for (k = 0; k < 3; k++) print "0 0 " k "\n1 0 " k "\n1 1 " k "\n0 1 " k
      print "$EndNodes\n$Elements\n11 22 1 22"
      quad(1, 1, 4, 3, 2)
      quad(11, 5, 6, 7, 8)
      quad(10, 9, 10, 11, 12)
      for (l = 0; l < 2; l++)
        for (j = 0; j < 4; j++) {
          a = 4 * l + j + 1
          b = 4 * l + (j + 1) % 4 + 1
          quad(4 * l + 2 + j, a, b, b + 4, a + 4)
        }
      print "$EndElements"
    }
    function quad(s, a, b, c, d) {
      print 2, s, 2, 2
      print ++e, a, b, c
      print ++e, a, c, d
    }' >cubes.msh
}
cubes "6 7 8 9 10 -11"
vanguard mesh cubes.msh --quiet --hmax 0.3 --remesh-surface yes --write b8.ugrid \
  --out cubes
exits 0
says out "11 is an interface"
vanguard check cubes/cubes.b8.ugrid
exits 0
for zone in " fluid .* 1 .* lower" " fluid .* 1 .* upper"; do
  grep -q -- "$zone" out || fail "no zone $zone"
done
# A surface between two volumes that the second one does not name is a wall.
cubes "6 7 8 9 10"
vanguard mesh cubes.msh --quiet --flow internal --hmax 0.3 --out walls
exits 1
lacks out "is an interface"
says out "non-manifold edges: 4"
# Without one of its sides, no point in a volume is found.
cubes "6 7 8 -11"
vanguard mesh cubes.msh --quiet --hmax 0.3 --out no
exits 1
says err "the surfaces of volume 2 are not closed"
absent no
