#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# gmsh 4.8.4 (Debian 4.8.4+ds2-3) and meshio (Debian python3-meshio 7.0.0-3):
# prisms and pyramids in Medit's .mesh.
#
# gmsh reads tetrahedra and hexahedra of a .mesh and skips the sections Prisms
# and Pyramids. It prints no warning and ends with status 0: the cells are
# missing in the mesh that it saves. meshio reads them.
#
# Output seen, for a tetrahedron, a prism and a pyramid:
#   gmsh:   status 0, 1 element, no warning
#   meshio: pyramid tetra wedge
. "$(dirname "$(realpath "$0")")/install.sh"
install gmsh=4.8.4+ds2-3 python3-meshio=7.0.0-3
work

cat > three.mesh <<'END'
MeshVersionFormatted 2
Dimension 3
Vertices
8
0 0 0 1
1 0 0 1
0 1 0 1
0 0 1 1
1 0 1 1
0 1 1 1
0.5 -1 0.5 1
0 0 2 1
Tetrahedra
1
4 5 6 8 1
Prisms
1
1 2 3 4 5 6 1
Pyramids
1
1 2 5 4 7 1
End
END
status=0
gmsh three.mesh -save -format msh22 -o back.msh > log.gmsh 2>&1 || status=$?
elements=$(sed -n '/^\$Elements/{n;p}' back.msh)
warning=$(grep -aciE 'warning|error' log.gmsh || :)
echo "gmsh:   status $status, $elements element, $warning warnings"
kinds=$(/usr/bin/python3 -c 'import meshio
print(*sorted(c.type for c in meshio.read("three.mesh").cells))')
echo "meshio: $kinds"
[ "$status $elements $warning" = "0 1 0" ] || changed "gmsh"
[ "$kinds" = "pyramid tetra wedge" ] || changed "meshio: $kinds"
