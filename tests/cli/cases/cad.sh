# SPDX-License-Identifier: LGPL-3.0-or-later
# From CAD to a mesh with one command. The output reports what was read,
# healed and assumed. The files are the same for any number of ranks.
cad=$here/../cad
vanguard check "$cad/wing.step" --remesh-surface no
if grep -q "cannot read CAD" err; then
  exits 1
  skip "built without Open CASCADE"
fi
exits 0
says out "no defects"
says out "note: CAD: lengths are in mm, the file's unit"
says out "trailing edge"
vanguard check --json "$cad/doubled.brep" --remesh-surface no
exits 0
says out "CAD: face 7 at (0.5, 0, 1.5) duplicates face 3 and was dropped"

# A face of a solid is kept although another one is near: without it, the solid
# would be open.
sed 's/3\.)/5.E-5)/; s/(3\.,/(5.E-5,/' "$cad/box.step" >plate.step
vanguard check plate.step --remesh-surface no
exits 0
lacks out "duplicates"
says out "patches                                6"
says out "closed"
says out "volume 0.0001,"

# a number of faces for which Open CASCADE's own way of orienting them takes
# forever
awk -v n=27 -f "$cad/facets.awk" </dev/null >facets.step
vanguard check -q facets.step --remesh-surface no
exits 0
says out "patches                            4,374"
says out "closed"
says out "no defects"

# a file with more faces than fit into memory is refused before Open CASCADE
# reads it
awk 'BEGIN { print "ISO-10303-21;"
             for (i = 1; i <= 300001; i++) print "#" i "=FACE_SURFACE();"
             print "END-ISO-10303-21;" }' >million.step
vanguard check -q million.step
exits 1
says err "it has 300001 faces"
says err "STL or OBJ"

# settings of the deck apply to a check too
printf 'metres\nunit cad_patches\nm layer\n' >m.deck
vanguard check -d m.deck "$cad/wing.step" --remesh-surface no
exits 0
says out "were converted to m"
says out "SKIN"
says out "to 1.1 2.5 0.0597046"

# one command; names in every output; any number of ranks
cp "$cad/wing.step" .
set -- -q -p wing.step --y-plus 1 --reynolds 5e6 --reference-length 1000 \
  --walls 1-5 --cad-angle 25 --leaf-cells 20000 --edges-per-turn 6 \
  --surface-size 400 --surface-tolerance 20 --growth 2 --hmin 25
vanguard mesh "$@" --out one
exits 0
says out "smallest angle"
says one/wing.mapbc "trailing_edge"
says one/wing.resolved.deck "cad_angle"
says out "note: points projected onto the CAD model: "
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 \
  OMPI_MCA_rmaps_base_oversubscribe=1 OMPI_MCA_hwloc_base_binding_policy=none
if mpirun -n 2 true >/dev/null 2>&1; then
  ASAN_OPTIONS=$ASAN_OPTIONS:detect_leaks=0 mpirun -n 3 "$program" mesh "$@" --test-node-ranks 2 \
    --out three >out 2>err
  status=$?
  exits 0
  same one/wing.b8.ugrid three/wing.b8.ugrid
  same one/wing.cogsg three/wing.cogsg
  says out "note: CAD: lengths are in mm"
fi

# the surface alone: remeshed, projected back to faces and curves, names kept;
# the distance between CAD and the new triangles is less than that of the
# tessellation
set -- -q "$cad/wing.step" --edges-per-turn 8 --surface-size 200 --hmin 10
vanguard surface "$@" --out new
exits 0
says out "projected onto the CAD model: "
says out "rejected 0, too far away 0"
says new/wing.mapbc "trailing_edge"
says new/wing.surface.json '"on_curves": '
awk '/from CAD before projection/ { before = $9 + 0 }
     /from CAD after projection/ { exit !($9 + 0 < before) }' out ||
  fail "farther from CAD than before"
vanguard check -q new/wing.lb8.ugrid
exits 0
says out "no defects"
vanguard surface "$@" --out again -t 2
same new/wing.lb8.ugrid again/wing.lb8.ugrid
# a complete run remeshes too, unless it is switched off
grep -qE "remesh_surface|yes" one/wing.resolved.deck || fail "not resolved"
vanguard mesh -q -p "$cad/box.step" --remesh-surface no --out plain
exits 0
lacks out "remeshed:"

# Solids as zones: the same bytes on any number of ranks, and rows of the table
# zones by the names of solids.
cp "$cad/peg.brep" peg.brep
cat >peg.deck <<'END'
Solids as zones

zones
name     kind   mesh
solid_2  solid  yes
END
vanguard mesh -q -p peg.brep --cad-solids zones --hmax 1 --write b8.ugrid --out z1
exits 0
says out "given by the setting cad_solids zones"
says out "solid_1_to_solid_2 is an interface"
grep -q "1 fluid .* 7.21.* solid_1$" out || fail "no zone solid_1"
grep -q "2 solid .* 1.56.* solid_2$" out || fail "no zone solid_2"
vanguard check z1/peg.b8.ugrid
exits 0
says out "validity: valid"
if mpirun -n 2 true >/dev/null 2>&1; then
  ASAN_OPTIONS=$ASAN_OPTIONS:detect_leaks=0 mpirun -n 3 "$program" mesh -q \
    -p peg.brep --cad-solids zones --hmax 1 --write b8.ugrid --out z3 \
    --test-node-ranks 2 >out 2>err || fail "three ranks: $(cat err)"
  same z1/peg.b8.ugrid z3/peg.b8.ugrid
  same z1/peg.sheets z3/peg.sheets
fi
sed 's/solid_2/heater/' peg.deck >none.deck
vanguard mesh -q -p peg.brep -d none.deck --cad-solids zones --hmax 1 --out none
exits 1
says err "the zone heater has no point"
absent none
# Solids of one name.
if command -v gmsh >/dev/null; then
  printf '%s\n' 'SetFactory("OpenCASCADE");' 'Box(1) = {0,0,0,1,1,1};' \
    'Box(2) = {0,0,1,1,1,1};' >two.geo
  gmsh -0 -v 0 -o made.step two.geo >out 2>&1 || fail "gmsh"
  sed "s/'Open CASCADE STEP translator [^']*'/'wall'/g" made.step >two.step
  vanguard check -q two.step --cad-solids zones
  exits 0
  says out "several solids have the name wall: solid 2 is the zone wall_2"
  says out "wall_to_wall_2 is an interface"
else echo "gmsh is not installed: solids of one name are omitted"; fi
vanguard mesh -q -p "$cad/inside.brep" --cad-solids zones --hmax 1 --out none
exits 1
says err "overlap, so that a place would be in two zones"
vanguard mesh -q -p "$cad/box.brep" --cad-solids zones --hmax 1 --out none
exits 1
says err "zones need two that touch"

# options without effect are reported, impossible requests are refused
octahedron >body.obj
vanguard mesh -q -p body.obj --unit m --hmax 5 --out o
exits 0
says out "the coordinates of body.obj are taken to be in m (unit)"
vanguard mesh -q -p body.obj --cad-angle 9 --hmax 5 --out o
exits 0
says out "settings that have no effect because no CAD file was read: cad_angle"
vanguard mesh -q -p "$cad/box.brep" --unit m --hmax 3000mm --out b
exits 0
says out "has no unit of length: its numbers are taken to be in m (unit)"
vanguard mesh -q -p "$cad/box.brep" --hmax 3m --out none
exits 1
says err "the unit of the mesh is not known"
absent none/box.b8.ugrid
# the file states its unit, so that lengths with units need no setting
vanguard check -q "$cad/box.step" --surface-size 300mm
exits 0
says out "unit of length                   m"
vanguard check -q "$cad/box.step" --file-unit mm
exits 1
says err "remove file_unit"
vanguard check "$cad/edges.brep" --remesh-surface no
exits 1
says err "there are no faces in it"
# Text after the end mark of a STEP file belongs to another program.
{ cat "$cad/box.step"; printf '//+\nField[1] = Distance;\n'; } >more.step
vanguard check more.step --remesh-surface no
exits 0
says out "CAD: 25 bytes after the end mark END-ISO-10303-21; were not read"
says out "patches                                6"
head -c 9000 "$cad/wing.step" >cut.step
vanguard mesh -q -p cut.step --out c
exits 1
says err "cut.step: truncated"
absent c/cut.b8.ugrid
: >empty.step
vanguard check empty.step
exits 1
says err "empty.step"
vanguard check "$cad/crossing_faces.brep" --surface-size 1
exits 0
says out "were united: 2 shells became 1"
says out "volume 10.125,"
vanguard mesh -q -p wing.step --cad-angle 1 --cad-chord 1e-7 \
  --cad-seconds 0.3 --out y
exits 1
says err "time limit of 0.3 s"
