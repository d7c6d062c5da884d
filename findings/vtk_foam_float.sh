#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# VTK 9.1 (Debian python3-vtk9 9.1.0+really9.1.0+dfsg2-5+deb12u1), the reader of
# ParaView, and OpenFOAM 1912 (Debian 1912.200626-1+b1): thin cells.
#
# OpenFOAM stores coordinates as 8-byte reals, and checkMesh accepts a layer of
# 1e-8 at x = 1. vtkOpenFOAMReader rounds coordinates to 4-byte reals: both
# sides of the layer are at x = 1, and its cells have no volume.
#
# Output seen:
#   checkMesh: Mesh OK., Total volume = 1e-08
#   VTK:       float coordinates, width 0, volume 0
. "$(dirname "$(realpath "$0")")/install.sh"
install openfoam=1912.200626-1+b1 \
  python3-vtk9=9.1.0+really9.1.0+dfsg2-5+deb12u1
work
openfoam

block 1 1.00000001 1
checkMesh > log.checkMesh
total=$(sed -n 's/.*Total volume = \([^ ]*\)\. .*/\1/p' log.checkMesh)
echo "checkMesh: $(grep -E 'Mesh OK|Failed' log.checkMesh), Total volume = $total"
touch case.foam
found=$(/usr/bin/python3 - <<'END'
from vtkmodules.vtkFiltersVerdict import vtkCellSizeFilter
from vtkmodules.vtkIOGeometry import vtkOpenFOAMReader

reader = vtkOpenFOAMReader()
reader.SetFileName("case.foam")
reader.Update()
grid = reader.GetOutput().GetBlock(0)
x = grid.GetBounds()
size = vtkCellSizeFilter()
size.SetInputData(grid)
size.Update()
print(grid.GetPoints().GetData().GetDataTypeAsString(), "coordinates, width",
      f"{x[1] - x[0]:g}, volume",
      f"{size.GetOutput().GetCellData().GetArray('Volume').GetValue(0):g}")
END
)
echo "VTK:       $found"
awk -v v="$total" 'BEGIN { exit !(v > 0.9e-8 && v < 1.1e-8) }' ||
  changed "checkMesh: $total"
[ "$found" = "float coordinates, width 0, volume 0" ] || changed "VTK: $found"
