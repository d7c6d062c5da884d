# SPDX-License-Identifier: LGPL-3.0-or-later
"""Meshes passed to meshio and VTK, as VTK and Gmsh see them: volume of every
cell, number of cells, names. meshio_files.py FOLDER"""
import importlib
import os
import sys

import numpy as np
import vanguard
from shapes import cube, layered, run

NAMES = ["p10", "p11", "p12", "p13", "p14", "p15"]


def modules():
    """Exit with status 77 if a module is missing."""
    found = []
    for name, package in (("meshio", "python3-meshio"), ("vtk", "python3-vtk9"),
                          ("gmsh", "python3-gmsh")):
        try:
            found.append(importlib.import_module(name))
        except ImportError:
            print("%s is not installed (%s)" % (name, package))
            sys.exit(77)
    return found


meshio, vtk, gmsh = modules()
numpy_support = importlib.import_module("vtk.util.numpy_support")


def mixed():
    """A mesh with all kinds of cells and faces."""
    job = vanguard.Job()
    job.surface(*cube(6))
    for id in range(10, 16):
        job.patch(id, bc=4 if id in (14, 11) else 1, name="p%d" % id)
    job.set(cells="mixed", layers=True, first=0.01)
    mesh = job.mesh()
    assert len(mesh.pyramids) and len(mesh.prisms) and len(mesh.quadrilaterals)
    return mesh


MESH = mixed()


def check_vtk(grid, what, mesh=MESH):
    """VTK's kinds of cells and its volumes."""
    measure = vtk.vtkCellSizeFilter()
    measure.SetInputData(grid)
    measure.Update()
    out = measure.GetOutput()
    volume = numpy_support.vtk_to_numpy(out.GetCellData().GetArray("Volume"))
    kinds = np.array([out.GetCellType(i) for i in range(out.GetNumberOfCells())])
    for kind, n in ((10, len(mesh.tetrahedra)), (14, len(mesh.pyramids)),
                    (13, len(mesh.prisms))):
        assert (kinds == kind).sum() == n, (what, kind)
        assert not n or volume[kinds == kind].min() > 0, (
            what, kind, (volume[kinds == kind] <= 0).sum())
    # VTK divides a warped quadrilateral differently on its two sides.
    assert abs(volume.sum() - 1) < 0.01, (what, volume.sum())
    return kinds, out.GetCellData()


def read_vtk(reader, path):
    reader.SetFileName(path)
    reader.Update()
    return reader.GetOutput()


def test_vtk_files(folder):
    for form, suffix, reader in (
            ("vtu", ".vtu", vtk.vtkXMLUnstructuredGridReader()),
            ("vtk42", ".vtk", vtk.vtkUnstructuredGridReader()),
            ("vtk51", ".vtk", vtk.vtkUnstructuredGridReader())):
        for entities in False, True:
            path = os.path.join(folder, form + suffix)
            MESH.to_meshio(entities=entities).write(path, file_format=form)
            kinds, data = check_vtk(read_vtk(reader, path), path)
            patch = numpy_support.vtk_to_numpy(data.GetArray("patch"))
            assert not patch[(kinds != 5) & (kinds != 9)].any()
            for index, p in enumerate(MESH.patches):
                for kind, of in ((5, MESH.triangle_patches),
                                 (9, MESH.quadrilateral_patches)):
                    assert ((patch == p["id"]) & (kinds == kind)).sum() == (
                        of == index).sum(), (path, p)


def test_own_vtu_agrees(folder):
    """The library's own file has the same volumes, in the same order."""
    MESH.write(os.path.join(folder, "own"), ["vtu"])
    grid = read_vtk(vtk.vtkXMLUnstructuredGridReader(),
                    os.path.join(folder, "own.vtu"))
    check_vtk(grid, "own.vtu")


def test_vtk_arrays():
    cells, types, points = MESH.to_vtk_arrays()
    grid = vtk.vtkUnstructuredGrid()
    x = vtk.vtkPoints()
    x.SetData(numpy_support.numpy_to_vtk(points, deep=1))
    grid.SetPoints(x)
    at = 0
    for kind in types:
        n = int(cells[at])
        grid.InsertNextCell(int(kind), n, [int(i) for i in
                                           cells[at + 1:at + 1 + n]])
        at += 1 + n
    assert at == len(cells)
    check_vtk(grid, "to_vtk_arrays")


def check_gmsh(path, mesh=MESH, names=NAMES):
    """Volumes by Gmsh's Jacobians, and the faces of each physical group."""
    gmsh.open(path)
    total = 0
    for kind, n in ((4, len(mesh.tetrahedra)), (7, len(mesh.pyramids)),
                    (6, len(mesh.prisms))):
        tags = gmsh.model.mesh.getElementsByType(kind)[0]
        assert len(tags) == n, (path, kind)
        if n:
            at, weight = gmsh.model.mesh.getIntegrationPoints(kind, "Gauss4")
            det = gmsh.model.mesh.getJacobians(kind, at)[1]
            assert det.min() > 0, (path, kind)
            total += (det.reshape(n, -1) * weight).sum()
    # The quadrature is not exact on Gmsh's pyramids.
    assert abs(total - 1) < 0.01, (path, total)
    groups = {gmsh.model.getPhysicalName(dim, tag): (dim, tag)
              for dim, tag in gmsh.model.getPhysicalGroups()}
    assert sorted(groups) == sorted(names + ["fluid"]), groups
    assert groups["fluid"][0] == 3
    assert groups["fluid"][1] > max(groups[name][1] for name in names)
    for patch, name in zip(mesh.patches, names):
        dim, tag = groups[name]
        assert dim == 2 and (tag == patch["id"] or patch["id"] < 1)
        n = sum(len(part) for entity in
                gmsh.model.getEntitiesForPhysicalGroup(dim, tag)
                for part in gmsh.model.mesh.getElements(2, entity)[1])
        index = mesh.patches.index(patch)
        assert n == (mesh.triangle_patches == index).sum() + (
            mesh.quadrilateral_patches == index).sum(), (path, name)
    gmsh.clear()


def test_gmsh(folder):
    gmsh.initialize()
    gmsh.option.setNumber("General.Verbosity", 2)
    for form, entities in (("gmsh22", False), ("gmsh22", True), ("gmsh", True)):
        path = os.path.join(folder, "%s_%d.msh" % (form, entities))
        MESH.to_meshio(entities=entities).write(path, file_format=form)
        check_gmsh(path)


def test_gmsh_names(folder):
    """Equal names, missing names, the name of the cells, ids below 1."""
    points, triangles, patches = cube(4)
    given = ["wall", "wall", "", 'a "b"', "fluid", "wall_12"]
    for shift in 0, -12:
        job = vanguard.Job()
        job.surface(points, triangles, patches + shift)
        for i, name in enumerate(given):
            job.patch(10 + shift + i, name=name, bc=1)
        mesh = job.mesh()
        first = 10 if not shift else 1
        names = list(mesh.to_meshio_dict()["field_data"])
        assert len(set(names)) == 7 and names[0] == "wall", names
        assert not any('"' in name for name in names), names
        numbers = [n for n, dim in mesh.to_meshio_dict()["field_data"].values()]
        assert numbers == list(range(first, first + 7)), numbers
        for form, entities in ("gmsh22", False), ("gmsh", True):
            path = os.path.join(folder, "names.msh")
            mesh.to_meshio(entities=entities).write(path, file_format=form)
            gmsh.open(path)
            found = [gmsh.model.getPhysicalName(*group)
                     for group in gmsh.model.getPhysicalGroups()]
            assert sorted(found) == sorted(names), (found, names)
            gmsh.clear()


def test_tiny_patches(folder):
    """More patches than points: version 4.1 cannot have a point of each, so
    that meshio refuses it, and 2.2 works."""
    points, triangles, unused = cube(1)
    job = vanguard.Job()
    job.surface(points, triangles, np.arange(1, 13))
    job.set(hmax=10)
    mesh = job.mesh()
    data = mesh.to_meshio_dict(entities=True)
    if len(mesh.points) < 13:
        assert "gmsh:dim_tags" not in data["point_data"]
    path = os.path.join(folder, "tiny.msh")
    mesh.to_meshio().write(path, file_format="gmsh22")
    check_gmsh(path, mesh, ["patch_%d" % i for i in range(1, 13)])


def test_every_writer(folder):
    """Every writer of meshio that takes prisms takes ours; some lack pyramids.
    Several have tables of the integer types that they know."""
    mesh, tried = layered(), 0
    assert not len(mesh.pyramids)
    for form, suffix in (
            ("abaqus", ".inp"), ("ansys", ".msh"), ("avsucd", ".avs"),
            ("dolfin-xml", ".xml"), ("hmf", ".hmf"), ("med", ".med"),
            ("mdpa", ".mdpa"), ("medit", ".mesh"), ("medit", ".meshb"),
            ("nastran", ".bdf"), ("netgen", ".vol"), ("permas", ".post"),
            ("tecplot", ".dat"), ("vtk", ".vtk"), ("vtu", ".vtu"),
            ("xdmf", ".xdmf")):
        if form not in meshio._helpers._writer_map:
            continue
        try:
            mesh.to_meshio().write(os.path.join(folder, "all" + suffix),
                                   file_format=form)
            tried += 1
        except ModuleNotFoundError as error:
            print("%s is omitted: %s" % (form, error))
    assert tried > 8, tried


def test_surface_of_files(folder):
    """The boundary of a file gives the same surface again."""
    job = vanguard.Job()
    job.surface(*cube(6))
    mesh = job.mesh()
    for form, entities in ("gmsh", True), ("vtu", False):
        path = os.path.join(folder, "again." + form)
        mesh.to_meshio(entities=entities).write(path, file_format=form)
        job = vanguard.Job()
        job.surface_of(meshio.read(path, file_format=form))
        again = job.mesh()
        assert [p["id"] for p in again.patches] == list(range(10, 16))
        assert len(again.triangles) == len(mesh.triangles)
        assert again.quality["volume"] > 0.99


if __name__ == "__main__":
    run(globals(), *sys.argv[1:])
