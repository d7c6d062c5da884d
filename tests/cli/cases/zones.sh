# SPDX-License-Identifier: LGPL-3.0-or-later
# Zones of cells, which interfaces enclose.
needs tetgen
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 \
  OMPI_MCA_rmaps_base_oversubscribe=1 \
  OMPI_MCA_hwloc_base_binding_policy=none \
  PRTE_MCA_rmaps_default_mapping_policy=:oversubscribe \
  PRTE_MCA_hwloc_default_binding_policy=none

# shellcheck source=tests/cli/duct.bash
. "$here/duct.bash"

# cube NAME AT SIZE N: the sides of a cube, as sheets for duct.
cube() {
  awk -v id="$1" -v o="$2" -v s="$3" -v n="$4" 'BEGIN {
    p = o + s
    print id, n, n, o, o, o, 0, s, 0, s, 0, 0
    print id, n, n, o, o, p, s, 0, 0, 0, s, 0
    print id, n, n, o, o, o, s, 0, 0, 0, 0, s
    print id, n, n, o, p, o, 0, 0, s, s, 0, 0
    print id, n, n, o, o, o, 0, 0, s, 0, s, 0
    print id, n, n, p, o, o, 0, s, 0, 0, 0, s }'
}

# A cube in a cube in the box, and a plane across the box.
mapfile -t outer < <(cube rot 0.25 0.5 4)
mapfile -t inner < <(cube in 0.375 0.25 2)
duct one "${outer[@]}"
duct two "${outer[@]}" "${inner[@]}"
duct mid "mid 8 8  0.5 0 0  0 1 0  0 0 1"

valid one --zone-interfaces rot
says out "1 fluid            3,798         0.875 "
says out "2 fluid              556         0.125 "
says out "  rot"
says out "connected regions: 1"

# Names, kinds and sizes by the table; the same by the column role.
zones() {
  printf 'z\n\nzones\nname x y z kind hmax mesh\n'
  printf 'far 0.01 0.01 0.01 fluid 0 auto\nrotor 0.26 0.26 0.26 rotating 0 auto\n'
  printf 'core 0.5 0.5 0.5 %s auto\n' "$1"
}
zones "porous 0.05" >two.deck
valid two --zone-interfaces rot,in
grep -q '^zone 2 rotating [0-9]* 0 0 0 rotor$' o_two/two.sheets ||
  fail "the sidecar has no rotor"
says out "0.109375 "
says out "porous "
cp two.stl role.stl
{ zones "porous 0.05"; printf '\npatches\nid role\nrot interface\nin interface\n'; } \
  >role.deck
valid role
same o_two/two.b8.ugrid o_role/role.b8.ugrid
same o_two/two.sheets o_role/role.sheets
vanguard mesh two.stl --deck o_two/two.resolved.deck --flow internal --quiet \
  --write b8.ugrid --out again
exits 0
same o_two/two.b8.ugrid again/two.b8.ugrid

# Small sizes in a zone, which grow outside of it.
mapfile -t fine < <(cube rot 0.2 0.6 12)
duct fine "${fine[@]}"
for h in 0 0.03; do
  printf 'z\n\nzones\nname x y z hmax\nrot 0.5 0.5 0.5 %s\n' $h >fine.deck
  vanguard mesh fine.stl --flow internal --zone-interfaces rot --quiet --hmax 0.12 \
    --write b8.ugrid --out fine$h
  exits 0
  awk '/^zone 2/ { print $4 }' fine$h/fine.sheets >cells$h
done
[ "$(cat cells0.03)" -gt "$((2 * $(cat cells0)))" ] ||
  fail "hmax of a zone has no effect"

# A size that is not met, and one that is.
for h in 1e-9 0.25; do
  printf 'z\n\nzones\nname x y z hmax\ncore 0.5 0.5 0.5 %s\n' $h >two.deck
  vanguard mesh two.stl --flow internal --zone-interfaces rot,in \
    --write b8.ugrid --out size$h
  exits 0
  cp out out$h
done
cp out1e-9 out
says out "zone core requests a size of 1e-09, but its edges have a mean length"
says out "next to it has edges of up to 0."
grep -q '"hmax_missed": true' size1e-9/two.report.json || fail "no hmax_missed"
cp out0.25 out
lacks out "requests a size"
grep -q '"hmax_missed": false' size0.25/two.report.json || fail "hmax_missed"

# A zone that walls and a plane enclose; layers on the walls end at the plane.
valid mid --zone-interfaces mid --walls 'w*' --first 0.004 --cells mixed
says out "0.5 "
says out "connected regions: 1"

# Layers on both sides of interfaces: cells of each zone, and all layers.
for cells in tets mixed hex; do
  valid two --zone-interfaces rot,in --walls '*' --first 0.004 --cells $cells
  says out "1 fluid "
  says out "0.109375 "
  says out "connected regions: 1"
  valid mid --zone-interfaces mid --walls 'mid_back,w1' --first 0.004 \
    --cells $cells
  says out "0.5 "
done
vanguard mesh two.stl --flow internal --zone-interfaces rot,in --walls 'rot,in' \
  --first 0.004 --layer-count 4 --hmax 0.12 --write b8.ugrid --out full
exits 0
for patch in rot rot_back in in_back; do
  [ "$(full out $patch)" = 100.00 ] || fail "layers of $patch"
done
lacks out "seal off"

# Solids have no cells unless they are asked for.
zones "solid 0" >two.deck
valid two --zone-interfaces rot,in
lacks out "solid"
says out "816"
says out "0.0625  in;"
sed 's/solid 0 auto/solid 0 yes/' two.deck >t && mv t two.deck
valid two --zone-interfaces rot,in
says out "solid"
zones "porous 0" | sed 's/rotating 0 auto/solid 0 no/' >two.deck
valid two --zone-interfaces rot,in
says out "connected regions: 2"
says out "  far"
says out "  core"

# Names without the table; the interface becomes a wall.
rm two.deck
vanguard mesh two.stl --flow internal --zone-interfaces rot,in --write b8.ugrid \
  --out names
exits 0
says out "zone 2 rot: fluid"
says out "zone 3 in: fluid"
printf 'z\n\nzones\nname x y z kind\ncore 0.5 0.5 0.5 solid\n' >two.deck
vanguard mesh two.stl --flow internal --zone-interfaces rot,in --out solid \
  --write foam --quiet
exits 0
grep -A2 '^ *in$' solid/two.openfoam/constant/polyMesh/boundary >out
says out "wall;"

# --- ranks, threads, decompositions, a stop --------------------------------------

zones "porous 0.05" >two.deck
ways="advancing octree"
vanguard --version --verbose
grep -q "METIS" out && ways="$ways discrete"
for way in $ways; do
  for threads in 1 3; do
    vanguard mesh two.stl --flow internal --quiet --zone-interfaces rot,in \
      --decompose $way --leaf-cells 2000 --hmax 0.07 --threads $threads \
      --write b8.ugrid,vtu,msh --out $way$threads
    exits 0
  done
  for file in b8.ugrid sheets vtu msh; do
    same ${way}1/two.$file ${way}3/two.$file
  done
  vanguard check ${way}1/two.b8.ugrid
  exits 0
  says out "0.109375 "
  for threads in 1 3; do
    vanguard mesh two.stl --flow internal --quiet --zone-interfaces rot,in \
      --walls 'rot,in,w*' --first 0.004 --cells mixed --decompose $way \
      --leaf-cells 2000 --hmax 0.07 --threads $threads \
      --write b8.ugrid,vtu,msh --out layers$way$threads
    exits 0
  done
  for file in b8.ugrid sheets vtu msh; do
    same layers${way}1/two.$file layers${way}3/two.$file
  done
  vanguard check layers${way}1/two.msh
  exits 0
  says out "0.109375 "
done
if mpirun -n 2 true >/dev/null 2>&1; then
  ASAN_OPTIONS=$ASAN_OPTIONS:detect_leaks=0 mpirun -n 2 "$program" mesh \
    two.stl --flow internal --quiet --zone-interfaces rot,in --leaf-cells 2000 \
    --hmax 0.07 --threads 1 --write b8.ugrid,vtu,msh --out ranks >out 2>err ||
    fail "two ranks: $(cat err)"
  for file in b8.ugrid sheets vtu msh; do
    same advancing1/two.$file ranks/two.$file
  done
  ASAN_OPTIONS=$ASAN_OPTIONS:detect_leaks=0 mpirun -n 2 "$program" mesh \
    two.stl --flow internal --quiet --zone-interfaces rot,in \
    --walls 'rot,in,w*' --first 0.004 --cells mixed --leaf-cells 2000 \
    --hmax 0.07 --threads 1 --write b8.ugrid,vtu,msh --out ranks >out 2>err ||
    fail "two ranks: $(cat err)"
  for file in b8.ugrid sheets vtu msh; do
    same layersadvancing1/two.$file ranks/two.$file
  done
else echo "mpirun does not work here: ranks are omitted"; fi

# An interface around a body leaves the flow domain to the search: the body is
# in open air, and the zone around it.
duct air "rot 6 6  -.5 -.5 -.5  2 0 0  0 2 0" "rot 6 6  -.5 -.5 1.5  2 0 0  0 2 0" \
  "rot 6 6  -.5 -.5 -.5  2 0 0  0 0 2" "rot 6 6  -.5 1.5 -.5  2 0 0  0 0 2" \
  "rot 6 6  -.5 -.5 -.5  0 2 0  0 0 2" "rot 6 6  1.5 -.5 -.5  0 2 0  0 0 2"
vanguard mesh air.stl --zone-interfaces rot --quiet --layers no \
  --farfield-lengths 3 --growth 1.6 --write b8.ugrid --out air
exits 0
says out "External flow around 1 closed body; farfield added"
vanguard check air/air.b8.ugrid
exits 0
says out "valid"

# A run that is killed, and resumed with other threads.
set -- mesh two.stl --flow internal --quiet --zone-interfaces rot,in \
  --walls 'rot,in,w*' --first 0.004 --cells mixed --leaf-cells 2000 --hmax 0.07 --write b8.ugrid,vtu,msh --out resumed \
  --run-dir run
"$program" "$@" -t 1 >out 2>err </dev/null &
job=$!
while kill -0 $job 2>/dev/null; do
  [ "$(find run/records -type f 2>/dev/null | wc -l)" -lt 2 ] || break
  sleep 0.005
done
kill -KILL $job 2>/dev/null
if wait $job 2>/dev/null; then echo "it ended before it was killed"; fi
absent resumed/two.b8.ugrid
vanguard "$@" -t 2 --resume
exits 0
for file in b8.ugrid sheets vtu msh; do
  same layersadvancing1/two.$file resumed/two.$file
done

# --- formats ---------------------------------------------------------------------

vanguard mesh two.stl --flow internal --quiet --zone-interfaces rot,in --hmax 0.12 \
  --write b8.ugrid,msh,mesh,meshb,fluent.msh,vtu,su2,foam --out all
exits 0
vanguard check --json all/two.b8.ugrid
exits 0
says out '"kind": "rotating"'
grep -q '<td>rotor</td><td>rotating</td>' all/two.report.html ||
  fail "the page has no zones"
for form in msh meshb; do
  vanguard check all/two.$form
  exits 0
  says out "0.109375 "
done
vanguard check all/two.msh
says out "  rotor"
vanguard convert all/two.b8.ugrid back.msh
exits 0
same back.msh all/two.msh
vanguard convert all/two.b8.ugrid back.vtu
exits 0
grep -qa 'Name="zone"' back.vtu || fail "a .vtu without zones"
vanguard convert all/two.b8.ugrid back.su2
exits 0
same back.sheets all/two.sheets
vanguard convert all/two.b8.ugrid back.lb8.ugrid
exits 0
vanguard convert back.lb8.ugrid once.fluent.msh
exits 0
same once.fluent.msh all/two.fluent.msh
grep '^(45 ' all/two.fluent.msh >out
says out "fluid rotor)"
says out "interior interior_rotor)"
vanguard convert all/two.b8.ugrid lost.cogsg
exits 0
says out "has no zones"

# Parts of a solver.
vanguard partition all/two.msh -n 2 --write vtu,part --out part
exits 0
grep -qa 'Name="zone"' part.vtu || fail "a .vtu of parts without zones"
grep -q '^zone [0-9]* fluid [0-9]* 0 0 0 rotor$' part.sheets ||
  fail "the sheets of parts have no zones"

# Cells that are not together in the file: in another order there.
if command -v gmsh >/dev/null; then
  awk '$1 == "Tetrahedra" { n = 1 } n && NF == 5 { $5 = 1 + (i++ % 2) } { print }' \
    all/two.mesh >mixed.mesh
  vanguard partition mixed.mesh -n 2 --write part --out no
  exits 1
  says err "cells of its zones are not together"
  vanguard convert mixed.mesh sorted.mesh
  exits 0
  vanguard partition sorted.mesh -n 2 --write part --out sorted
  exits 0
fi

# CGNS: a region and a family for each zone.
vanguard convert all/two.b8.ugrid c.cgns
if [ "$status" = 0 ]; then
  vanguard check c.cgns
  exits 0
  says out "2 rotating"
  says out "  rotor"
  if command -v cgnscheck >/dev/null; then
    cgnscheck c.cgns >out 2>&1
    says out 'checking subregion "rotor+cells"'
    lacks out "ERROR"
  else echo "cgnscheck is not installed: its check is omitted"; fi
else says err "HDF5"; fi

if command -v gmsh >/dev/null; then
  gmsh -check back.msh >out 2>&1
  lacks out "Warning"
  lacks out "Error"
else echo "gmsh is not installed: its check is omitted"; fi

# OpenFOAM makes a region of each zone.
if command -v splitMeshRegions >/dev/null; then
  # shellcheck source=tests/cli/openfoam.bash
  . "$here/openfoam.bash"
  load_openfoam
  (cd all/two.openfoam && checkMesh) >out 2>err
  says out "Mesh OK."
  (cd all/two.openfoam && splitMeshRegions -cellZones -overwrite) >out 2>err
  for zone in far rotor core; do
    (cd all/two.openfoam && checkMesh -region $zone) >out 2>err
    says out "Mesh OK."
  done
else echo "OpenFOAM is not installed: its programs are omitted"; fi

# The examples.
vanguard demo rotor --cells 20000 --out demo
exits 0
vanguard mesh -p demo/rotor --quiet --write b8.ugrid
exits 0
vanguard check demo/rotor.b8.ugrid
exits 0
says out "rotating"
says out "blades_back"
vanguard demo fins --cells 20000 --out demo
exits 0
vanguard mesh -p demo/fins --quiet --write b8.ugrid
exits 0
vanguard check demo/fins.b8.ugrid
exits 0
says out "2 solid"
says out " 0.03584 "
says out "  fins"

vanguard demo exchanger --cells 1000 --out demo
exits 0
says out "the geometry needs more"
vanguard mesh -p demo/exchanger --quiet --cells mixed --write b8.ugrid,foam
exits 0
vanguard check demo/exchanger.b8.ugrid
exits 0
says out "validity: valid"
for zone in "1 fluid .* cold" "2 solid .* pipe" "3 fluid .* hot"; do
  grep -q "$zone" out || fail "exchanger: $zone"
done
# partition: the cells of a zone with a small weight count less
vanguard partition -q --json demo/exchanger.b8.ugrid -n 4 --zone-weights pipe=0.01
exits 0
cp out light.json
vanguard partition -q --json demo/exchanger.b8.ugrid -n 4
exits 0
if command -v jq >/dev/null; then
  jq -e -n --slurpfile a light.json --slurpfile b out \
    '$a[0].solver_parts.balance < 1.02 and $b[0].solver_parts.balance < 1.02 and
     $a[0].solver_parts.most_cells != $b[0].solver_parts.most_cells' >same ||
    fail "zone-weights: $(cat light.json)"
fi
vanguard partition -q demo/exchanger.b8.ugrid -n 4 --zone-weights wall=0.01
exits 1
says err "has no zone 'wall'"
vanguard partition -q demo/exchanger.b8.ugrid -n 4 --zone-weights pipe=0
exits 2
says err "must be a number from 0.001 to 1000"
if command -v jq >/dev/null; then
  jq -e '([.layers.patches[] | .name] | sort) ==
    ["casing", "pipe_inside_back", "pipe_outside_back"]' \
    demo/exchanger.report.json >out || fail "exchanger: layers"
fi
if command -v checkMesh >/dev/null; then
  (cd demo/exchanger.openfoam && splitMeshRegions -cellZones -overwrite) >out 2>err
  for zone in hot pipe cold; do
    (cd demo/exchanger.openfoam && checkMesh -region $zone) >out 2>err
    says out "Mesh OK."
  done
fi

# --- refused ---------------------------------------------------------------------

# refused TEXT OPTION...: two.stl is refused with the text.
refused() {
  local text=$1
  shift
  vanguard mesh two.stl --flow internal --quiet "$@" --write b8.ugrid --out no
  exits 1
  says err "$text"
  absent no
}

rm two.deck
mapfile -t hole < <(cube rot 0.25 0.5 4 | sed 1d)
duct hole "${hole[@]}"
vanguard mesh hole.stl --flow internal --zone-interfaces rot --quiet --out no
exits 1
says err "rot encloses no zone"
says err "16 edges of interfaces are free, the first one from (0."
absent no

zones "porous 0" | sed 's/^far.*/far 2 0 0 fluid 0 auto/' >two.deck
refused "the seed point (2, 0, 0) of zone far is outside of the fluid" \
  --zone-interfaces rot,in
zones "porous 0" | sed 's/^far.*/far 0.25 0.5 0.5 fluid 0 auto/' >two.deck
refused "the seed point (0.25, 0.5, 0.5) of zone far is on a triangle" \
  --zone-interfaces rot,in
zones "porous 0" | sed 's/^far.*/far 0.3 0.3 0.3 fluid 0 auto/' >two.deck
refused "the seed points of far (0.3, 0.3, 0.3) and rotor (0.26, 0.26, 0.26)" \
  --zone-interfaces rot,in
zones "porous 0" | sed 's/^far/rotor/' >two.deck
refused "two rows have the name rotor" --zone-interfaces rot,in
zones "porous 0" >two.deck
refused "no patch is an interface"
zones "wet 0" >two.deck
refused "wet" --zone-interfaces rot,in
rm two.deck
refused "is a sheet by sheets, and an interface by zone_interfaces" --sheets in \
  --zone-interfaces rot,in
vanguard mesh two.stl --flow internal --zone-interfaces rot,in --write cogsg \
  --out no
exits 1
says err "none of these formats holds sheets"
absent no

# Two sides of the box are interfaces.
vanguard mesh one.stl --flow internal --zone-interfaces 'w1,w3,rot' --quiet --out no
exits 1
says err "These patches are inner surfaces and close nothing: "
says err "remove it from the list of baffles, sheets or zone_interfaces"

# Layers on a patch that bounds only a zone without cells.
printf 'z\n\nzones\nname x y z mesh\nout 0.1 0.1 0.1 no\n' >gone.deck
vanguard mesh one.stl --deck gone.deck --flow internal --zone-interfaces rot \
  --walls 'w1,rot' --first 0.002 --quiet --out no
exits 1
says err "w1, but none of its faces is left (a zone without cells, the repair"
says err "or mesh the zone (mesh yes in the table zones)"

# One side of the box, without which it looks like a half model.
for flow in internal external; do
  vanguard mesh one.stl --flow $flow --zone-interfaces 'w1,rot' --quiet --out no
  exits 1
  says err "patch 1 w1, an inner surface, has a triangle in the symmetry plane"
  says err "if it bounds the fluid, remove it from the list of baffles, sheets or"
done

# A damaged sidecar.
sed 's/^zone 2 rotating/zone 2 warm/' all/two.sheets >back.sheets
vanguard check back.lb8.ugrid
exits 1
says err "the kind of a zone is fluid, rotating, porous or solid, not warm"
sed 's/^zone 2 rotating [0-9]*/zone 2 rotating 5/' all/two.sheets >back.sheets
vanguard check back.lb8.ugrid
exits 1
says err "the zones do not have all"
awk '/^zone 1/ { n = $4; next } /^zone 2/ { $4 += n } { print }' all/two.sheets \
  >back.sheets
vanguard check back.lb8.ugrid
exits 1
says err "triangles of interfaces have one zone on both sides"
awk '$1 == "interface" && !n { $3--; n = 1; print; next }
  n == 1 { n = 2; next } { print }' all/two.sheets >back.sheets
vanguard check back.lb8.ugrid
exits 1
says err "1 faces between two zones are not in the interface between them"
