#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# PETSc 3.18.5 (Debian python3-petsc4py 3.18.5-1): Gmsh files with prisms.
#
# If a file has tetrahedra and prisms, DMPlex takes the prisms for "tensor"
# prisms of cohesive zones, whose side faces are of another kind than
# quadrilaterals. It refuses a conforming mesh with a pyramid next to a prism. The option
# -dm_plex_gmsh_hybrid 0 makes them ordinary prisms.
#
# Output seen, for a prism, a pyramid on one side, a tetrahedron on top:
#   default:                  error
#   -dm_plex_gmsh_hybrid 0:   3 cells, volume 1.0000
. "$(dirname "$(realpath "$0")")/install.sh"
install python3-petsc4py=3.18.5-1
work

cat > two.msh <<'END'
$MeshFormat
2.2 0 8
$EndMeshFormat
$Nodes
8
1 0 0 0
2 1 0 0
3 0 1 0
4 0 0 1
5 1 0 1
6 0 1 1
7 0.5 -1 0.5
8 0 0 2
$EndNodes
$Elements
3
1 6 2 1 1 1 2 3 4 5 6
2 7 2 1 1 1 2 5 4 7
3 4 2 1 1 4 5 6 8
$EndElements
END
cat > read.py <<'END'
import sys

from petsc4py import PETSc

for name, value in (o.split("=") for o in sys.argv[1:]):
    PETSc.Options().setValue(name, value)
dm = PETSc.DMPlex().createFromFile("two.msh", "mesh")
first, end = dm.getHeightStratum(0)
volume = sum(dm.computeCellGeometryFVM(c)[0] for c in range(first, end))
print(f"{end - first} cells, volume {volume:.4f}")
END
if /usr/bin/python3 read.py > log.default 2>&1; then
  changed "the default reads the mesh: $(cat log.default)"
fi
echo "default:                  error"
found=$(/usr/bin/python3 read.py dm_plex_gmsh_hybrid=0 2>&1 | tail -1)
echo "-dm_plex_gmsh_hybrid 0:   $found"
[ "$found" = "3 cells, volume 1.0000" ] || changed "$found"
