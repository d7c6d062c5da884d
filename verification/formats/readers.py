#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Prints what other libraries find in a file that Vanguard has written.

usage: readers.py has CLIENT          exit status 0 if CLIENT can be used
       readers.py CLIENT FILE         findings on standard output
Clients: vtk-vtu vtk-cgns vtk-foam vtk-fluent meshio petsc netgen.

Findings are one per line: "tetrahedra N", "pyramids N", "prisms N", "patch NAME
N", "volume V" with five digits. Volumes of meshio are VTK's, of the mesh that
meshio writes as .vtu. vtk-foam and vtk-fluent also print "reals float" or
"reals double". run.sh compares all of this with `vanguard check`.
"""
import os
import sys
import tempfile

KINDS = {10: "tetrahedra", 14: "pyramids", 13: "prisms", 12: "hexahedra"}


def vtk_cells(grid):
    """Print kinds and volume of a vtkUnstructuredGrid."""
    from vtkmodules.vtkFiltersVerdict import vtkCellSizeFilter

    number = {}
    for i in range(grid.GetNumberOfCells()):
        kind = grid.GetCellType(i)
        number[kind] = number.get(kind, 0) + 1
    for code, n in number.items():
        print(KINDS.get(code, f"kind_{code}"), n)
    size = vtkCellSizeFilter()
    size.SetInputData(grid)
    size.Update()
    volume = size.GetOutput().GetCellData().GetArray("Volume")
    each = [volume.GetValue(i) for i in range(grid.GetNumberOfCells())]
    print(f"volume {sum(map(abs, each)):.5g}")
    wrong = sum(v < 0 for v in each)
    if wrong:
        print("negative", wrong)


def reals(grid):
    """Print the type of the coordinates."""
    print("reals", grid.GetPoints().GetData().GetDataTypeAsString())


def leaves(data, name=""):
    """All pairs of name and data set of a tree of blocks."""
    if not data.IsA("vtkMultiBlockDataSet"):
        yield name, data
        return
    for i in range(data.GetNumberOfBlocks()):
        block = data.GetBlock(i)
        info = data.GetMetaData(i)
        key = data.NAME()
        if block:
            yield from leaves(block, info.Get(key) if info and info.Has(key)
                              else name)


def vtk_vtu(path):
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(path)
    reader.Update()
    vtk_cells(reader.GetOutput())


def vtk_cgns(path):
    from vtkmodules.vtkIOCGNSReader import vtkCGNSReader

    reader = vtkCGNSReader()
    reader.SetFileName(path)
    reader.UpdateInformation()
    reader.EnableAllBases()
    reader.LoadBndPatchOn()
    reader.Update()
    zone = reader.GetOutput().GetBlock(0).GetBlock(0)
    vtk_cells(zone.GetBlock(0))
    for name, patch in leaves(zone.GetBlock(1)):
        print("patch", name, patch.GetNumberOfCells())


def vtk_foam(path):
    from vtkmodules.vtkIOGeometry import vtkOpenFOAMReader

    reader = vtkOpenFOAMReader()
    reader.SetFileName(os.path.join(path, [
        f for f in os.listdir(path) if f.endswith(".foam")][0]))
    reader.SetDecomposePolyhedra(0)
    reader.UpdateInformation()
    reader.EnableAllPatchArrays()
    reader.Update()
    for name, block in leaves(reader.GetOutput()):
        if block.IsA("vtkUnstructuredGrid"):
            vtk_cells(block)
            reals(block)
        else:
            print("patch", name.split("/")[-1], block.GetNumberOfCells())


def vtk_fluent(path):
    from vtkmodules.vtkIOGeometry import vtkFLUENTReader

    reader = vtkFLUENTReader()
    reader.SetFileName(path)
    reader.Update()
    for _, block in leaves(reader.GetOutput()):
        vtk_cells(block)
        reals(block)


def of_meshio(path):
    import meshio

    mesh = meshio.read(path)
    name = {int(v[0]): k for k, v in mesh.field_data.items() if v[1] == 2}
    key = next((k for k in ("gmsh:physical", "medit:ref", "ugrid:ref",
                            "su2:tag") if k in mesh.cell_data), None)
    count = {}
    for i, block in enumerate(mesh.cells):
        if block.type in ("triangle", "quad") and key:
            for tag in mesh.cell_data[key][i]:
                count[int(tag)] = count.get(int(tag), 0) + 1
    for tag, n in count.items():
        print("patch", name.get(tag, f"tag_{tag}"), n)
    solid = [(c.type, c.data.astype("int64")) for c in mesh.cells
             if c.type in ("tetra", "pyramid", "wedge", "hexahedron")]
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "back.vtu")
        meshio.write_points_cells(out, mesh.points, solid)
        vtk_vtu(out)


def of_petsc(path):
    from petsc4py import PETSc

    # without the first, mixed cells are refused; without the second, patches
    # have numbers instead of names
    PETSc.Options().setValue("dm_plex_gmsh_hybrid", "0")
    PETSc.Options().setValue("dm_plex_gmsh_use_regions", "1")
    dm = PETSc.DMPlex().createFromFile(path, "mesh")
    first, end = dm.getHeightStratum(0)
    number = {}
    for c in range(first, end):
        kind = int(dm.getCellType(c))
        number[kind] = number.get(kind, 0) + 1
    types = {6: "tetrahedra", 7: "hexahedra", 8: "prisms", 11: "pyramids"}
    for kind, n in number.items():
        print(types.get(kind, f"kind_{kind}"), n)
    volume = sum(dm.computeCellGeometryFVM(c)[0] for c in range(first, end))
    print(f"volume {volume:.5g}")
    for i in range(dm.getNumLabels()):
        name = dm.getLabelName(i)
        if name not in ("celltype", "depth", "fluid"):
            ids = dm.getLabel(name).getValueIS().getIndices()
            print("patch", name, dm.getStratumSize(name, int(ids[0])))


def of_netgen(path):
    from netgen.read_gmsh import ReadGmsh

    mesh = ReadGmsh(path)
    name = {2: "", 3: ""}
    number, faces = {}, {}
    for e in mesh.Elements3D():
        n = len(e.vertices)
        number[n] = number.get(n, 0) + 1
    for n, kind in ((4, "tetrahedra"), (5, "pyramids"), (6, "prisms"),
                    (8, "hexahedra")):
        if n in number:
            print(kind, number[n])
    for e in mesh.Elements2D():
        faces[e.index] = faces.get(e.index, 0) + 1
    for index, n in faces.items():
        print("patch", mesh.GetBCName(index - 1), n)


CLIENTS = {"vtk-vtu": (vtk_vtu, "vtkmodules.vtkIOXML"),
           "vtk-cgns": (vtk_cgns, "vtkmodules.vtkIOCGNSReader"),
           "vtk-foam": (vtk_foam, "vtkmodules.vtkIOGeometry"),
           "vtk-fluent": (vtk_fluent, "vtkmodules.vtkIOGeometry"),
           "meshio": (of_meshio, "meshio"), "petsc": (of_petsc, "petsc4py"),
           "netgen": (of_netgen, "netgen.read_gmsh")}

if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    if sys.argv[1] == "has":
        import importlib
        try:
            importlib.import_module(CLIENTS[sys.argv[2]][1])
            if sys.argv[2] == "meshio":
                importlib.import_module("vtkmodules.vtkIOXML")
        except ImportError:
            sys.exit(1)
    else:
        CLIENTS[sys.argv[1]][0](sys.argv[2])
