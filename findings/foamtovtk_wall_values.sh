#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# OpenFOAM 1912 (Debian openfoam 1912.200626-1+b1): wall values in foamToVTK's
# internal.vtu, read with VTK 9.1 (Debian python3-vtk9).
#
# A field that exists on walls only, as wallShearStress, is 0 in all cells and on
# all other patches. In the file of the wall (boundary/floor.vtp) its point values
# are those of the wall everywhere. In internal.vtu they are so inside the wall
# only: where the wall meets other patches, they are means with the zeros of
# those. At a symmetry plane the skin friction is halved.
#
# Output seen, for a field of 1 on the wall:
#   internal.vtu: inside 1, next to a patch 0.255, next to a symmetry plane 0.5
#   floor.vtp:    inside 1, next to a patch 1, next to a symmetry plane 1
. "$(dirname "$(realpath "$0")")/install.sh"
install openfoam=1912.200626-1+b1 \
  python3-vtk9=9.1.0+really9.1.0+dfsg2-5+deb12u1
work
openfoam

control
mkdir 0
{
  foam_head dictionary blockMeshDict
  cat <<'END'
vertices ((0 0 0) (4 0 0) (4 1 0) (0 1 0) (0 0 1) (4 0 1) (4 1 1) (0 1 1));
blocks (hex (0 1 2 3 4 5 6 7) (4 4 4) simpleGrading (1 1 1));
boundary
(
    inlet { type patch; faces ((0 4 7 3)); }
    outlet { type patch; faces ((1 2 6 5)); }
    floor { type wall; faces ((0 1 5 4)); }
    top { type patch; faces ((3 7 6 2)); }
    back { type symmetryPlane; faces ((0 3 2 1)); }
    front { type symmetryPlane; faces ((4 5 6 7)); }
);
END
} >system/blockMeshDict
{
  foam_head volScalarField shear
  cat <<'END'
dimensions [0 0 0 0 0 0 0];
internalField uniform 0;
boundaryField
{
    floor { type calculated; value uniform 1; }
    "inlet|outlet|top" { type calculated; value uniform 0; }
    "back|front" { type symmetryPlane; }
}
END
} >0/shear
blockMesh >log.blockMesh
foamToVTK -time 0 >log.foamToVTK
values() { # FILE READER
  /usr/bin/python3 - "$1" "$2" <<'END'
import sys

from vtkmodules import vtkIOXML

reader = getattr(vtkIOXML, sys.argv[2])()
reader.SetFileName(sys.argv[1])
reader.Update()
grid = reader.GetOutput()
shear = grid.GetPointData().GetArray("shear")
at = {(2, 0, 0.5): "inside", (0, 0, 0.5): "next to a patch",
      (2, 0, 0): "next to a symmetry plane"}
print(", ".join(sorted(f"{at[grid.GetPoint(i)]} {shear.GetValue(i):.3g}"
                       for i in range(grid.GetNumberOfPoints())
                       if grid.GetPoint(i) in at)))
END
}
inner=$(values VTK/*_0/internal.vtu vtkXMLUnstructuredGridReader)
wall=$(values VTK/*_0/boundary/floor.vtp vtkXMLPolyDataReader)
echo "internal.vtu: $inner"
echo "floor.vtp:    $wall"
[ "$inner" = "inside 1, next to a patch 0.255, next to a symmetry plane 0.5" ] ||
  changed "$inner"
[ "$wall" = "inside 1, next to a patch 1, next to a symmetry plane 1" ] ||
  changed "$wall"
