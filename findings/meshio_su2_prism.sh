#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# meshio (Debian python3-meshio 7.0.0-3) and VTK 9.1 (Debian python3-vtk9
# 9.1.0+really9.1.0+dfsg2-5+deb12u1): prisms of SU2.
#
# SU2's mesh format defines the nodes of its elements as VTK does. meshio
# permutes the nodes of prisms when it reads and writes VTK files, since its own
# order is that of Gmsh, but not when it reads SU2 files. A prism that is
# converted from .su2 to .vtu is therefore mirrored.
#
# Output seen, volumes computed by VTK:
#   prism in .vtu:                      0.5
#   the same nodes in .su2, to .vtu:   -0.5
. "$(dirname "$(realpath "$0")")/install.sh"
install python3-meshio=7.0.0-3 \
  python3-vtk9=9.1.0+really9.1.0+dfsg2-5+deb12u1
work

cat > one.vtu <<'END'
<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian">
<UnstructuredGrid><Piece NumberOfPoints="6" NumberOfCells="1">
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">
0 0 0  0 1 0  1 0 0  0 0 1  0 1 1  1 0 1
</DataArray></Points><Cells>
<DataArray type="Int64" Name="connectivity" format="ascii">
0 1 2 3 4 5</DataArray>
<DataArray type="Int64" Name="offsets" format="ascii">6</DataArray>
<DataArray type="UInt8" Name="types" format="ascii">13</DataArray>
</Cells></Piece></UnstructuredGrid></VTKFile>
END
cat > one.su2 <<'END'
NDIME= 3
NELEM= 1
13 0 1 2 3 4 5 0
NPOIN= 6
0 0 0 0
0 1 0 1
1 0 0 2
0 0 1 3
0 1 1 4
1 0 1 5
NMARK= 0
END
cat > volume.py <<'END'
import sys

from vtkmodules.vtkFiltersVerdict import vtkCellSizeFilter
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

reader = vtkXMLUnstructuredGridReader()
reader.SetFileName(sys.argv[1])
size = vtkCellSizeFilter()
size.SetInputConnection(reader.GetOutputPort())
size.Update()
print(f"{size.GetOutput().GetCellData().GetArray('Volume').GetValue(0):g}")
END
/usr/bin/python3 -c 'import meshio
meshio.write("back.vtu", meshio.read("one.su2"))' > log.meshio 2>&1
before=$(/usr/bin/python3 volume.py one.vtu)
after=$(/usr/bin/python3 volume.py back.vtu)
echo "prism in .vtu:                      $before"
echo "the same nodes in .su2, to .vtu:   $after"
[ "$before $after" = "0.5 -0.5" ] || changed "$before, $after"
