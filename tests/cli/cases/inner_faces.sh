# SPDX-License-Identifier: LGPL-3.0-or-later
# Faces between two cells that a file lists, as gmsh does for the interface of
# two volumes: they are sheets, and no part of the boundary.
needs metis
cat >two.msh <<'END'
$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
4
2 1 "outer"
2 2 "interface"
3 3 "low"
3 4 "high"
$EndPhysicalNames
$Nodes
5
1 0 0 0
2 1 0 0
3 0 1 0
4 0 0 1
5 1 1 1
$EndNodes
$Elements
9
1 2 2 1 1 1 3 2
2 2 2 1 1 1 2 4
3 2 2 1 1 1 4 3
4 2 2 1 2 2 3 5
5 2 2 1 2 2 5 4
6 2 2 1 2 3 4 5
7 2 2 2 3 2 3 4
8 4 2 3 1 1 2 3 4
9 4 2 4 2 2 3 4 5
$EndElements
END

vanguard check two.msh
exits 0
says out "2             1             1             1      0.866  interface"
says out "outer"
vanguard check --json two.msh
exits 0
says out '"inner_faces": 1'
says out '"cells_behind": 1'

vanguard partition -n 2 two.msh
exits 0
says out "note: two.msh: 1 triangles lie between two cells; they are sheets"
exists two.part.2
vanguard partition -n 2 --write foam two.msh
exits 0
says two.openfoam/constant/polyMesh/boundary "outer"
lacks two.openfoam/constant/polyMesh/boundary "interface"
says two.openfoam/constant/polyMesh/faceZones "interface"

# The boundary of this mesh is a closed surface.
vanguard mesh -q -p two.msh --farfield none --layers no --write lb8.ugrid \
  --out mesh
exits 0
vanguard check mesh/two.lb8.ugrid
exits 0
lacks out "lie between"

# Listed from both sides, in different patches.
sed 's/^9$/10/; s/^8 4 2/10 2 2 5 3 2 4 3\n8 4 2/' two.msh >both.msh
vanguard check both.msh
exits 0
says out "1 boundary faces lie between two cells and are"
says out "(patches: patch 5 (1))"
