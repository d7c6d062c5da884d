# SPDX-License-Identifier: LGPL-3.0-or-later
# Sheets: patches that become named faces between cells.
needs tetgen

# shellcheck source=tests/cli/duct.bash
. "$here/duct.bash"

# A disk in the box, a plane across it, and sheets that cross and end on a wall.
duct disk "disk 4 4  0.5 0.25 0.25  0 0.5 0  0 0 0.5"
duct across "mid 8 8  0.5 0 0  0 1 0  0 0 1"
duct both "fin 4 4  0.5 0.25 0  0 0.5 0  0 0 0.5" \
  "plate 2 4  0.5 0.25 0.25  0.25 0 0  0 0.5 0"
valid disk --sheets disk
says out "7            32            32            32       0.25  disk"
says out "connected regions: 1"
lacks out "coincident"
valid across --sheets 7
says out "7           128           128           128          1  mid"
says out "connected regions: 1"
valid both --sheets fin,plate
says out "8            16            16            16      0.125  plate"

# Behind a baffle, and as the column role says.
valid both --baffles fin --sheets plate
says out "fin_back"
says out "8            16            16            16      0.125  plate"
cp both.stl roles.stl
printf 'roles\n\npatches\nid role\nfin baffle\nplate sheet\n' >roles.deck
valid roles
same o_both/both.b8.ugrid o_roles/roles.b8.ugrid
same o_both/both.sheets o_roles/roles.sheets

# The deck with all settings makes the same mesh.
vanguard mesh roles.stl --deck o_roles/roles.resolved.deck --quiet --out again \
  --flow internal --write b8.ugrid
exits 0
same o_roles/roles.b8.ugrid again/roles.b8.ugrid

# Layers on walls that no sheet touches.
valid disk --sheets disk --walls 'w*' --first 0.004 --cells mixed
says out "7            32            32            32       0.25  disk"

# Values of the table layers for a side without layers are not ignored in silence.
cp disk.stl idle.stl
printf 'idle\n\nlayers\nid first count\nw1 2e-3 -\ndisk 1e-3 4\n' >idle.deck
vanguard plan idle.stl --flow internal --sheets disk --walls 'w*' --first 0.004
exits 0
says out "no layers grow on patch 7 disk (first, count), so that these columns"
says out "set the column grow to yes, or name the patch in walls"
printf 'idle\n\nlayers\nid grow first\ndisk no 1e-3\n' >idle.deck
vanguard plan idle.stl --flow internal --sheets disk --walls 'w*' --first 0.004
exits 0
lacks out "have no effect"

# Slivers are not remeshed around inner surfaces unless this is requested.
awk '$1 == "vertex" { $2 *= 12 } { print }' disk.stl >long.stl
vanguard plan long.stl --flow internal --sheets disk
exits 0
says out "a surface with inner surfaces is not remeshed"
says out "--remesh-surface yes remeshes walls and inner surfaces"
lacks out "the surface was remeshed"

# Layers on both sides of a baffle that a sheet continues.
valid both --baffles fin --sheets plate --walls 'w*,fin' --first 0.004 \
  --cells mixed
says out "fin_back"
says out "8            16            16            16      0.125  plate"

# A sheet that is numbered before the baffle changes nothing for its layers.
duct order "disk 4 4  0.25 0.25 0.25  0 0.5 0  0 0 0.5" \
  "fin 4 4  0.5 0.25 0  0 0.5 0  0 0 0.5"
valid order --baffles fin --sheets disk --first 0.004
says out "7            32            32            32       0.25  disk"
vanguard mesh order.stl --flow internal --baffles fin --sheets disk --walls fin \
  --first 0.004 --layer-count 5 --write b8.ugrid --out order
exits 0
[ -n "$(full out fin)" ] && [ -n "$(full out fin_back)" ] ||
  fail "layers of a baffle after a sheet"
lacks out "disk_back"
vanguard check order.stl --flow internal --baffles fin --sheets disk
exits 0
lacks out "disk_back"
vanguard check order.stl --flow internal --baffles fin --sheets disk --json
exits 0
lacks out "disk_back"
vanguard mesh order.stl --flow internal --baffles fin --sheets disk \
  --walls disc_back --first 0.004
exits 1
says err "walls: no patch of the surface is named 'disc_back'"
says err "7 disk (no condition), 8 fin (no condition), 9 fin_back (no condition)"
lacks err "disk_back ("

# --- layers on sheets --------------------------------------------------------

# Sheets that are free, across, before and behind a baffle, and that meet.
duct tall "tall 8 6  0.5 0 0  0 1 0  0 0 0.75"
for cells in tets mixed hex; do
  set -- --first 0.004 --cells $cells
  valid disk --sheets disk --walls disk "$@" # two edges are cut
  says out "7            36            36            36       0.25  disk"
  lacks out "coincident"
  valid across --sheets mid --walls '*' "$@"
  says out "7           128           128           128          1  mid"
  says out "connected regions: 1"
  valid both --sheets fin,plate --walls '*' "$@"
  says out "8            18            18            18      0.125  plate"
  valid both --sheets fin,plate --walls 'w*,plate' "$@"
  valid both --baffles fin --sheets plate --walls '*' "$@"
  says out "8            18            18            18      0.125  plate"
  valid both --sheets fin --baffles plate --walls '*' "$@"
  valid tall --sheets tall --walls tall_back "$@"
  says out "7            96            96            96       0.75  tall"
done

# All faces but those at the free edge have all layers, with requests by side;
# the deck with all settings makes the same mesh.
cat >tall.deck <<'END'
sheet

sheets  walls
tall    tall

layers
id        first  count
tall      0.004  6
tall_back 0.008  3
END
vanguard mesh tall.stl --flow internal --hmax 0.12 --write b8.ugrid --out tall
exits 0
for patch in tall tall_back; do
  [ "$(full out $patch)" = 83.33 ] || fail "layers of $patch"
done
says out "patch 8 tall_back stands for its back in lists and tables"
vanguard mesh tall.stl --deck tall/tall.resolved.deck --quiet --write b8.ugrid \
  --out tall_again
exits 0
same tall/tall.b8.ugrid tall_again/tall.b8.ugrid
same tall/tall.sheets tall_again/tall.sheets
rm tall.deck
vanguard mesh tall.stl --flow internal --sheets tall --walls tall \
  --slip tall_back --first 0.004 --hmax 0.12 --write b8.ugrid --out one
exits 0
[ -n "$(full out tall)" ] && [ -z "$(full out tall_back)" ] ||
  fail "layers of one side of a sheet"
vanguard check one/tall.b8.ugrid
exits 0
says out "7            96            96            96       0.75  tall"

# A sheet ends in a side of the duct in which columns of the floor slide; near
# the floor they stay below it. The floor has all layers where there is room.
duct side "disk 4 4  0.5 0 0.25  0 0.5 0  0 0 0.5"
duct low "disk 4 8  0.25 0 0.125  0.5 0 0  0 1 0"
for cells in tets mixed; do
  valid side --sheets disk --walls w1 --first 0.004 --cells $cells
  says out "7            32            32            32       0.25  disk"
  valid low --sheets disk --walls w1 --first 0.02 --cells $cells
  says out "7            64            64            64        0.5  disk"
done
for threads in 1 3; do
  vanguard mesh side.stl --flow internal --sheets disk --walls w1 \
    --first 0.004 --hmax 0.12 --threads $threads --write b8.ugrid \
    --out side$threads
  exits 0
  [ "$(full out w1)" = 100.00 ] || fail "layers next to a sheet"
done
same side1/side.b8.ugrid side3/side.b8.ugrid

# The example: a disk in front of a sphere.
vanguard demo disk --cells 20000 --out demo
exits 0
vanguard mesh -p demo/disk --quiet --write b8.ugrid
exits 0
vanguard check demo/disk.b8.ugrid
exits 0
says out "  disk"
says out "connected regions: 1"

# Same bytes with threads and in any decomposition.
ways="advancing octree"
vanguard --version --verbose
grep -q "METIS" out && ways="$ways discrete"
for way in $ways; do
  for threads in 1 3; do
    vanguard mesh both.stl --flow internal --quiet --baffles fin \
      --sheets plate --decompose $way --leaf-cells 1500 --hmax 0.08 \
      --threads $threads --write b8.ugrid --out $way$threads
    exits 0
  done
  same ${way}1/both.b8.ugrid ${way}3/both.b8.ugrid
  same ${way}1/both.sheets ${way}3/both.sheets
  vanguard check ${way}1/both.b8.ugrid
  exits 0
  says out "8            16            16            16      0.125  plate"
  for threads in 1 3; do
    vanguard mesh both.stl --flow internal --quiet --sheets fin,plate \
      --walls '*' --first 0.004 --decompose $way --leaf-cells 1500 --hmax 0.08 \
      --threads $threads --write b8.ugrid,msh --out layers$way$threads
    exits 0
  done
  for file in b8.ugrid sheets msh; do
    same layers${way}1/both.$file layers${way}3/both.$file
  done
  vanguard check layers${way}1/both.msh
  exits 0
  says out "8            18            18            18      0.125  plate"
done

# --- half models -------------------------------------------------------------

# wedge NAME Y: half a wing with a sharp trailing edge, cut at y = 0, and a wake
# from there, whose inner edge is at Y, as NAME.stl.
wedge() {
  awk -v inner="$2" 'function at(s, t, k) {
      return sprintf("%.17g", (1 - s) * (1 - t) * p[0, k] + s * (1 - t) * p[1, k] \
                     + s * t * p[2, k] + (1 - s) * t * p[3, k])
    }
    function corner(s, t) { print "vertex", at(s, t, 0), at(s, t, 1), at(s, t, 2) }
    function facet(a, b, c, d, e, f) {
      print "facet normal 0 0 0\nouter loop"
      corner(a, b); corner(c, d); corner(e, f)
      print "endloop\nendfacet"
    }
    function sheet(x,   i, j, q) {
      split(x, q, " ")
      for (i = 0; i < 12; i++) p[int(i / 3), i % 3] = q[i + 1]
      for (j = 0; j < 1; j += h) for (i = 0; i < 1; i += h) {
        facet(i, j, i + h, j, i + h, j + h)
        facet(i, j, i + h, j + h, i, j + h)
      }
    }
    BEGIN {
      h = 0.125
      print "solid wing"
      sheet("0 0 0  0 1 0  .5 1 .1  .5 0 .1")
      sheet(".5 0 .1  .5 1 .1  1 1 0  1 0 0")
      sheet("0 0 0  .5 0 -.1  .5 1 -.1  0 1 0")
      sheet(".5 0 -.1  1 0 0  1 1 0  .5 1 -.1")
      sheet("0 1 0  .5 1 -.1  1 1 0  .5 1 .1")
      print "endsolid wing\nsolid wake"
      sheet("1 " inner " 0  2 " inner " 0  2 1 0  1 1 0")
      print "endsolid wake"
    }' >"$1.stl"
}

# half OPTION...: a mesh with a symmetry plane that is cut along the wake.
half() {
  vanguard mesh wedge.stl --half y --farfield-lengths 5 --quiet \
    --write b8.ugrid --out half "$@"
  exits 0
  vanguard check half/wedge.b8.ugrid
  exits 0
  says out "valid"
  says out "6662"
}

wedge wedge 0
half --sheets wake
says out "2           128           128           128          1  wake"
half --baffles wake
says out "wake_back"
for cells in tets mixed; do
  half --sheets wake --walls wing,wake --first 0.002 --cells $cells
  says out "2           128           128           128          1  wake"
  lacks out "coincident"
done
wedge beyond -0.125
vanguard mesh beyond.stl --half y --sheets wake --out no
exits 1
says err "2 wake, an inner surface, reaches beyond the symmetry plane y = 0 at ("
says err "-0.125, 0); cut it off at the plane"
absent no

# --- formats -----------------------------------------------------------------

vanguard mesh both.stl --flow internal --quiet --sheets fin,plate --hmax 0.12 \
  --write b8.ugrid,msh,meshb,fluent.msh,vtu,foam --out all
exits 0
vanguard check --json all/both.b8.ugrid
exits 0
says out '"cells_behind": 32'
for form in msh meshb; do
  vanguard check all/both.$form
  exits 0
  says out "7            32            32            32       0.25  "
done

# From format to format, with their names.
vanguard convert all/both.msh back.lb8.ugrid
exits 0
says out "48 triangles of sheets are in back.sheets"
same back.sheets all/both.sheets
vanguard convert back.lb8.ugrid once.msh
exits 0
same once.msh all/both.msh
vanguard convert all/both.b8.ugrid o.su2
exits 0
same o.sheets all/both.sheets
vanguard convert all/both.b8.ugrid o.stl
exits 0
says out "48 triangles of sheets are omitted"

# In the same way next to a .vtu of a partition.
vanguard partition all/both.msh -n 2 --write vtu --out part
exits 0
says out "part.sheets"
same part.sheets all/both.sheets

# A .sheets of an earlier mesh is removed, one that Vanguard did not write stays.
duct plain
vanguard mesh plain.stl --flow internal --quiet --hmax 0.3 --write msh --out o
exits 0
for form in su2 vtu; do
  vanguard convert all/both.msh stale.$form
  exists stale.sheets
  vanguard convert o/plain.msh stale.$form
  exits 0
  absent stale.sheets
done
echo "my sheets" >mine.sheets
vanguard convert all/both.msh mine.su2
exits 0
says out "mine.sheets exists, is not a file of Vanguard"
says out "48 triangles of sheets are lost"
vanguard convert o/plain.msh mine.vtu
exits 0
echo "my sheets" | is mine.sheets
vanguard mesh both.stl --flow internal --quiet --sheets fin,plate --hmax 0.2 \
  --write su2,cogsg,pvtu --out lost
exits 0
for form in cogsg pvtu; do
  says out ".$form has no faces between cells: 48 triangles of sheets are not"
done
lacks out ".su2 has no faces"

# A number that a patch has.
sed 's/^sheet 7 /sheet 2 /' all/both.sheets >part.sheets
cp all/both.b8.ugrid part.b8.ugrid
vanguard check part.b8.ugrid
exits 1
says err "part.sheets:4: the number 2 of a sheet is the number of a patch"

# A file of an earlier mesh is removed, one of another mesh refused.
exists all/both.sheets
vanguard mesh both.stl --flow internal --quiet --baffles fin,plate --hmax 0.12 \
  --write b8.ugrid --out all
exits 0
absent all/both.sheets
cp back.sheets all
mv all/back.sheets all/both.sheets
vanguard check all/both.b8.ugrid
exits 1
says err "these sheets belong to a mesh of"

# Zones of Fluent: 48 faces between cells in zones of their own.
grep -A1 '^(45 (.* interior ' all/both.fluent.msh >out
says out "interior fin)"
says out "interior plate)"

# Sections of CGNS.
vanguard convert once.msh c.cgns
if [ "$status" = 0 ]; then
  vanguard check c.cgns
  exits 0
  says out "  fin"
  if command -v cgnscheck >/dev/null; then
    cgnscheck c.cgns >out 2>&1
    says out 'checking subregion "plate+faces"'
    lacks out "ERROR"
    [ "$(grep WARNING out | sort | uniq -c | sort -n | xargs)" = "1 WARNING:16 \
elements have invalid dimension 1 WARNING:32 elements have invalid dimension 3 \
WARNING:dataclass not given" ] || fail "cgnscheck has other warnings"
  else echo "cgnscheck is not installed: its check is omitted"; fi
else says err "HDF5"; fi

# gmsh finds no element twice and no point without elements.
if command -v gmsh >/dev/null; then
  gmsh -check once.msh >out 2>&1
  lacks out "Warning"
  lacks out "Error"
else echo "gmsh is not installed: its check is omitted"; fi

# OpenFOAM reads the zones, and makes baffles of one.
if command -v createBaffles >/dev/null; then
  # shellcheck source=tests/cli/openfoam.bash
  . "$here/openfoam.bash"
  load_openfoam
  cat >all/createBafflesDict <<'END'
FoamFile { version 2.0; format ascii; class dictionary; object createBafflesDict; }
internalFacesOnly true;
baffles { plate { type faceZone; zoneName plate; patches {
  master { name plate_a; type wall; } slave { name plate_b; type wall; } } } }
END
  cp all/createBafflesDict all/both.openfoam/system
  (cd all/both.openfoam && checkMesh) >out 2>err
  says out "Mesh OK."
  grep -qE "fin +32 +25 +ok" out || fail "the zone fin has no 32 faces"
  (cd all/both.openfoam && createBaffles -overwrite) >out 2>err
  says out "Converted 16 faces into boundary faces in patches 2(plate_a plate_b)"
  vanguard mesh both.stl --flow internal --quiet --sheets fin,plate \
    --walls fin,plate --first 0.004 --layer-count 5 --hmax 0.12 --write foam \
    --out all
  exits 0
  cp all/createBafflesDict all/both.openfoam/system
  (cd all/both.openfoam && checkMesh) >out 2>err
  says out "Mesh OK."
  (cd all/both.openfoam && createBaffles -overwrite && checkMesh) >out 2>err
  says out "Converted 18 faces into boundary faces in patches 2(plate_a plate_b)"
  says out "Mesh OK."
else echo "OpenFOAM is not installed: its programs are omitted"; fi

# --- refused -----------------------------------------------------------------

vanguard mesh both.stl --flow internal --sheets fan
exits 1
says err "fan"
vanguard mesh both.stl --flow internal --baffles fin --sheets 7
exits 1
says err "patch 7 fin is a baffle by baffles, and a sheet by sheets"
vanguard mesh roles.stl --flow internal --sheets fin
exits 1
says err "patch 7 fin is a sheet by sheets, and a baffle by the table patches"
sed -i 's/plate sheet/plate wall/' roles.deck
vanguard mesh roles.stl --flow internal --sheets plate
exits 1
says err "patch 8 plate is a sheet by sheets, and a wall by the table patches"
vanguard mesh disk.stl --flow internal --sheets '1-7'
exits 1
says err "all triangles are in inner surfaces (sheets 1-7)"
duct cut "cut 2 2  0.3 0.3 0.8  0.4 0 0  0 0.4 0.5"
vanguard mesh cut.stl --flow internal --sheets cut
exits 1
says out "self-intersection: patch 2"
says out "set remesh_surface to yes, which cuts the inner surface there"
vanguard mesh disk.stl --flow internal --sheets disk \
  --write cogsg,stl --out none
exits 1
says err "write: none of these formats holds sheets"
vanguard convert once.msh lost.cogsg
exits 0
says out "48 triangles of sheets are lost"
absent lost.sheets
vanguard mesh disk.stl --flow internal --sheets disk --weld 1e-6
exits 1
says err "inner surfaces (sheets disk) cannot be combined with weld"

# A transparent surface of AFLR3: a unit cube with a sheet by its flag.
awk 'BEGIN {
  print 2, 6, 12
  for (i = 0; i < 8; i++) print i % 2, int(i / 2) % 2, int(i / 4)
  print ".3 .3 .5\n.7 .3 .5\n.3 .7 .5\n.7 .7 .5"
  print "9 10 12 2 7 -5\n9 12 11 2 7 -5"
  print "1 3 4 2 1 7 1\n5 6 8 7 1 7 1\n1 2 6 5 1 7 1"
  print "3 7 8 4 1 7 1\n1 5 7 3 1 7 1\n2 4 8 6 1 7 1"
}' >flags.surf
vanguard mesh flags.surf --flow internal --quiet --hmax 0.2 --remesh-surface yes \
  --write b8.ugrid --out flags
exits 0
says out "patch 2 is a sheet by the flag -5 of the .surf"
says out "inner surfaces: 16 triangles with fluid on both sides"
[ -e flags/flags.sheets ] || fail "no flags.sheets"
vanguard mesh flags.surf --flow internal --quiet --hmax 0.2 --remesh-surface yes \
  --baffles 2 --write b8.ugrid --out baffle
exits 0
says out "inner surfaces: 16 triangles with fluid on both sides"
absent baffle/flags.sheets
vanguard convert -q flags.surf flags.stl
exits 0
grep -c 'outer loop' flags.stl >out
says out 14
