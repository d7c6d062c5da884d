# SPDX-License-Identifier: LGPL-3.0-or-later
"""Tests the module `vanguard` with the installed library. test_vanguard.py FOLDER
VANGUARD: folder for output, program for comparison."""
import importlib
import json
import os
import subprocess
import sys
import threading
import types

import numpy as np
import vanguard


def cube(n):
    """Returns points, triangles and patches 10 to 15 of a cube with n x n squares
    per side. Normals point inwards."""
    number, points, triangles, patches = {}, [], [], []

    def point(x):
        if x not in number:
            number[x] = len(points)
            points.append(x)
        return number[x]

    for face in range(6):
        a, b, d = face // 2, (face // 2 + 1) % 3, (face // 2 + 2) % 3
        for i in range(n * n):
            corner = []
            for k in range(4):
                x = [0.0] * 3
                x[a] = float(face % 2)
                x[b] = (i % n + (k in (1, 2))) / n
                x[d] = (i // n + (k > 1)) / n
                corner.append(point(tuple(x)))
            for t in ((0, 1, 2), (0, 2, 3)):
                t = [corner[k] for k in t]
                triangles.append(t if face % 2 == 0 else [t[0], t[2], t[1]])
                patches.append(10 + face)
    return np.array(points), np.array(triangles), np.array(patches)


def refused(kind, word, function, *arguments, **named):
    try:
        function(*arguments, **named)
    except (vanguard.Error, ValueError) as error:
        assert isinstance(error, ValueError) or error.kind == kind, error
        assert word in str(error), error
        return error
    raise AssertionError("not refused: %s" % word)


def volume(mesh):
    x = mesh.points[mesh.tetrahedra.astype(np.int64)]
    e = x[:, 1:] - x[:, :1]
    return np.linalg.det(e).sum() / 6


def test_settings():
    names = {s["name"]: s for s in vanguard.settings()}
    assert names["growth"]["least"] == 1 and names["hmax"]["most"] is None
    assert "mixed" in names["cells"]["words"]
    with vanguard.Job() as job:
        job.set(growth=1.35, surface_sizes=False, walls=[3, 4])
        assert float(job.get("growth")) == 1.35
        assert job.get("surface_sizes") == "no"
        assert job.get("walls") == "3,4"
        refused("input", "did you mean 'growth'", job.set, growht=2)
        refused("input", "above 1", job.set, growth=0.5)
        refused("usage", "vanguard_surface", job.mesh)
    refused("", "closed", job.set, growth=1.2)


def test_arrays():
    points, triangles, patches = cube(6)
    job = vanguard.Job()
    refused("", "[n][3]", job.surface, points[:, :2], triangles)
    refused("", "negative", job.surface, points, triangles - 1)
    refused("", "expected integers", job.surface, points, triangles * 1.0)
    refused("input", "triangle 0", job.surface, points[:1], triangles)
    job.surface(points, triangles, patches)
    mesh = job.mesh()
    assert abs(volume(mesh) - 1) < 1e-12
    assert mesh.tetrahedra.max() == len(mesh.points) - 1
    assert len(mesh.triangles) == len(triangles)
    assert sorted({p["id"] for p in mesh.patches}) == list(range(10, 16))
    n_cell = n_own = 0
    for piece in mesh.pieces():
        n_cell += len(piece["tetrahedra"])
        n_own += len(piece["own"])
        own = mesh.points[piece["own_at"]:piece["own_at"] + len(piece["own"])]
        assert np.array_equal(own, piece["points"][piece["own"]])
    assert n_cell == len(mesh.tetrahedra) and n_own == len(mesh.points)
    before = mesh.points.copy()
    job.set(hmax=0.1)
    other = job.mesh()
    assert len(other.points) > len(before)
    refused("", "another mesh", lambda: mesh.quality)
    assert np.array_equal(mesh.points, before)   # a copy, hence unchanged


def test_layers():
    points, triangles, patches = cube(6)
    job = vanguard.Job()
    job.surface(points, triangles, patches)
    for id in range(10, 16):
        job.patch(id, bc=4 if id == 14 else 1, name="p%d" % id)
    job.set(cells="mixed", layers=True, first=0.01)
    mesh = job.mesh()
    assert len(mesh.prisms) and len(mesh.walls) == 1
    assert abs(mesh.walls[0]["first"][1] - 0.01) < 1e-3
    assert mesh.patches[mesh.walls[0]["patch"]]["name"] == "p14"
    w = mesh.wall_points
    assert (mesh.points[w["point"], 2] == 0).all() and len(w["point"]) == 49
    got = w["first"][w["level"] > 0]
    assert got.min() == mesh.walls[0]["first"][0]
    assert (w["level"] <= w["wanted"]).all() and (w["asked"] == 0.01).all()
    assert vanguard.causes()[6] == "collision" and w["cause"].max() < 10
    data = mesh.to_meshio_dict()
    kinds = [kind for kind, cells in data["cells"]]
    assert kinds[0] == "tetra" and "wedge" in kinds and "quad" in kinds
    for (kind, cells), patch in zip(data["cells"], data["cell_data"]["patch"]):
        assert len(cells) == len(patch)
    cells, types, x = mesh.to_vtk_arrays()
    assert len(types) == len(mesh.tetrahedra) + len(mesh.pyramids) + len(
        mesh.prisms)
    assert len(cells) == 5 * (types == 10).sum() + 6 * (
        types == 14).sum() + 7 * (types == 13).sum()


def client(name):
    """An optional module; None, with a message, if it is not installed."""
    try:
        return importlib.import_module(name)
    except ImportError:
        print("omitted: %s is not installed" % name)
        return None


def layered(points, triangles, patches):
    job = vanguard.Job()
    job.surface(points, triangles, patches)
    for id in range(10, 16):
        job.patch(id, bc=4 if id == 14 else 1, name="p%d" % id)
    job.set(cells="mixed", layers=True, first=0.01)
    return job.mesh()


def cell_volumes(points, cells):
    """Volumes of meshio's cells by tetrahedra: positive in its node order, which
    is that of Gmsh. tests/cli/python/meshio_files.py asks VTK and Gmsh."""
    split = {"tetra": [[0, 1, 2, 3]], "pyramid": [[0, 1, 2, 4], [0, 2, 3, 4]],
             "wedge": [[0, 1, 2, 3], [2, 1, 4, 3], [2, 4, 5, 3]]}
    for kind, nodes in cells:
        for corner in split.get(kind, ()):
            x = points[np.asarray(nodes, np.int64)[:, corner]]
            yield kind, np.linalg.det(x[:, 1:] - x[:, :1]) / 6


def same_again(mesh, data):
    """The boundary, read back as a surface, gives the same mesh."""
    job = vanguard.Job()
    job.surface_of(data)
    job.set(layers="no")
    other = vanguard.Job()
    other.surface(mesh.points[:mesh.triangles.max() + 1], mesh.triangles, [
        [p["id"] for p in mesh.patches][k] for k in mesh.triangle_patches])
    other.set(layers="no")
    again = job.mesh()
    assert np.array_equal(again.points, other.mesh().points)
    assert sorted(p["id"] for p in again.patches) == list(range(10, 16))


def test_meshio(folder):
    mesh = layered(*cube(6))
    total = 0
    for kind, v in cell_volumes(mesh.points, mesh.to_meshio_dict()["cells"]):
        assert v.min() > 0, kind
        total += v.sum()
    assert abs(total - 1) < 1e-9
    meshio = client("meshio")
    if not meshio:
        refused_import("meshio", mesh.to_meshio)
        return
    path = os.path.join(folder, "round.vtu")
    mesh.to_meshio().write(path)
    back = meshio.read(path)
    assert np.array_equal(back.points, mesh.points)
    assert np.array_equal(back.cells_dict["tetra"], mesh.tetrahedra)
    assert len(back.cells_dict["wedge"]) == len(mesh.prisms)
    tets = vanguard.Job()
    tets.surface(*cube(6))
    tets = tets.mesh()
    same_again(tets, tets.to_meshio())
    path = os.path.join(folder, "round_tets.vtu")
    tets.to_meshio().write(path)
    same_again(tets, meshio.read(path))


class Grid:
    """Stands in for pyvista.UnstructuredGrid: keeps what it is given."""

    def __init__(self, cells, types, points):
        self.cells, self.celltypes, self.points = cells, types, points
        self.cell_data, self.n_cells = {}, len(types)
        self.cells_dict, at = {}, 0
        for kind in types:
            width = {5: 3, 9: 4, 10: 4, 13: 6, 14: 5}[kind]
            assert cells[at] == width
            self.cells_dict.setdefault(kind, []).append(
                cells[at + 1:at + 1 + width])
            at += 1 + width
        assert at == len(cells)


def test_sheets():
    """Two triangles in a cube are faces between two cells."""
    points, triangles, patches = (np.array(a) for a in cube(6))
    n, half = len(points), points.max() / 2
    plate = half * np.array([[.6, .6, 1], [1.4, .6, 1], [1.4, 1.4, 1],
                             [.6, 1.4, 1]])
    job = vanguard.Job()
    job.surface(np.concatenate([points, plate]),
                np.concatenate([triangles, [[n, n + 1, n + 2],
                                            [n, n + 2, n + 3]]]),
                np.concatenate([patches, [20, 20]]))
    job.set(sheets="20", flow="internal", layers=False)
    mesh = job.mesh()
    assert [s["id"] for s in mesh.sheets] == [20]
    assert mesh.sheet_triangles.shape == (2, 3)
    assert not mesh.sheet_numbers.any()
    assert 20 not in [p["id"] for p in mesh.patches]
    for face in mesh.sheet_triangles:
        assert np.isin(mesh.tetrahedra, face).sum(axis=1).tolist().count(3) == 2


def test_zones():
    """A cube in a cube is a zone of the cells."""
    points, triangles, patches = (np.array(a) for a in cube(6))
    inner, faces, _ = (np.array(a) for a in cube(3))
    size = points.max()
    job = vanguard.Job()
    job.surface(np.concatenate([points, size / 4 + inner / 2]),
                np.concatenate([triangles, len(points) + faces]),
                np.concatenate([patches, np.full(len(faces), 20)]))
    job.set(zone_interfaces="20", flow="internal", layers=False)
    job.add("zones", name="core", x=size / 2, y=size / 2, z=size / 2,
            kind="porous")
    mesh = job.mesh()
    assert [z["name"] for z in mesh.zones] == ["zone_1", "core"]
    assert [z["kind"] for z in mesh.zones] == ["fluid", "porous"]
    zone = mesh.cell_zones()
    assert len(zone) == len(mesh.tetrahedra)
    middle = mesh.points[mesh.tetrahedra].mean(axis=1)
    inside = (abs(middle - size / 2) < size / 4).all(axis=1)
    assert (inside == (zone == 1)).all()
    assert not len(mesh.cell_zones("prisms"))


def test_pyvista_arrays():
    """The arrays for pyvista, whether or not it is installed."""
    mesh = layered(*cube(6))
    before = sys.modules.get("pyvista")
    sys.modules["pyvista"] = types.SimpleNamespace(UnstructuredGrid=Grid)
    try:
        grid, both = mesh.to_pyvista(), mesh.to_pyvista(boundary=True)
    finally:
        if before:
            sys.modules["pyvista"] = before
        else:
            del sys.modules["pyvista"]
    n = len(mesh.tetrahedra) + len(mesh.pyramids) + len(mesh.prisms)
    assert grid.n_cells == n == len(grid.cell_data["patch"])
    assert not grid.cell_data["patch"].any()
    assert np.array_equal(both.cells_dict[5], mesh.triangles)
    assert np.array_equal(both.cells_dict[9], mesh.quadrilaterals)
    ids = np.array([p["id"] for p in mesh.patches])
    assert np.array_equal(both.cell_data["patch"][n:], ids[np.concatenate(
        [mesh.triangle_patches, mesh.quadrilateral_patches])])


def test_pyvista():
    mesh = layered(*cube(6))
    pyvista = client("pyvista")
    if not pyvista:
        refused_import("pyvista", mesh.to_pyvista)
        return
    grid = mesh.to_pyvista()
    n = len(mesh.tetrahedra) + len(mesh.pyramids) + len(mesh.prisms)
    assert grid.n_cells == n and not grid.cell_data["patch"].any()
    sizes = grid.compute_cell_sizes()
    assert sizes["Volume"].min() > 0 and abs(sizes["Volume"].sum() - 1) < 1e-9
    both = mesh.to_pyvista(boundary=True)
    assert both.n_cells == n + len(mesh.triangles) + len(mesh.quadrilaterals)
    assert set(both.cell_data["patch"]) == {0} | set(range(10, 16))
    tets = vanguard.Job()
    tets.surface(*cube(6))
    tets = tets.mesh()
    same_again(tets, tets.to_pyvista(boundary=True))
    box = vanguard.Job()
    box.surface_of(pyvista.Sphere())
    box.set(flow="internal", farfield="none")
    assert len(box.mesh().tetrahedra) > 100


def refused_import(name, function):
    try:
        function()
    except ImportError as error:
        assert name + " is not installed" in str(error), error
        return
    raise AssertionError("%s is not missed" % name)


def test_sizes():
    points, triangles, patches = cube(12)
    job = vanguard.Job()
    job.surface(points, triangles, patches)
    plain = len(job.mesh().tetrahedra)
    job.size_points([[0.5, 0.5, 0.5]], [0.006])
    finer = len(job.mesh().tetrahedra)
    assert finer > 1.5 * plain
    refused("input", "point 1", job.size_points, [[0, 0, 0]], [-1])
    job.size_function(lambda x, y, z: 0.006 + 0.2 * (
        (x - 0.5)**2 + (y - 0.5)**2 + (z - 0.5)**2)**0.5)
    assert len(job.mesh().tetrahedra) > 1.5 * plain

    def broken(x, y, z):
        raise KeyError("lost")

    job.size_function(broken)
    try:
        job.mesh()
        raise AssertionError("an error of a size function is lost")
    except KeyError:
        pass
    job.size_function(None)
    assert len(job.mesh().tetrahedra) == plain


def test_metrics():
    points, triangles, patches = cube(12)
    job = vanguard.Job()
    job.surface(points, triangles, patches)
    corners = [[i & 1, i >> 1 & 1, i >> 2] for i in range(8)]
    tets = [[0, 1, 3, 7], [0, 3, 2, 7], [0, 2, 6, 7], [0, 6, 4, 7],
            [0, 4, 5, 7], [0, 5, 1, 7]]
    tensor = np.diag([100., 100., 1600.])
    six = [100, 0, 0, 100, 0, 1600]

    def flatness():
        mesh = job.mesh()
        x = mesh.points[mesh.tetrahedra]
        middle = (abs(x - 0.5) < 0.25).all(axis=(1, 2))
        d = abs(x[middle][:, 1:] - x[middle][:, :1]).mean(axis=(0, 1))
        return d[2] / d[0]

    assert flatness() > 0.8
    job.metric_points(corners, [tensor] * 8, tets)
    one = flatness()
    assert one < 0.5
    job.metric_points(corners, [six] * 8, tets)
    assert flatness() == one
    grid = np.stack(np.meshgrid(*[np.linspace(0, 1, 9)] * 3), -1)
    job.metric_points(grid.reshape(-1, 3), [six] * 729)
    assert flatness() < 0.7
    job.metric_function(lambda x, y, z: tensor)
    one = flatness()
    assert one < 0.5
    job.metric_function(lambda x, y, z: six)
    assert flatness() == one
    job.metric_function(None)
    assert flatness() > 0.8
    refused("input", "point 1", job.metric_points, [[0, 0, 0]], [[1] * 6])
    tensor[0, 1] = 1
    for metrics, what in ([tensor], "point 1 is not symmetric"), (
            [[1, 2]], "[n][6]"), ([six] * 2, "2 metrics for 1 points"):
        try:
            job.metric_points([[0, 0, 0]], metrics)
            raise AssertionError("no error: %s" % what)
        except ValueError as error:
            assert what in str(error), error
    for result in (None, 1.0, "abc", [[1, 2], [3, 4]]):
        job.metric_function(lambda x, y, z: result)
        try:
            job.mesh()
            raise AssertionError("no error for %r" % (result,))
        except TypeError as error:
            assert "the metric function returned" in str(error), error


def test_size_function_without_result():
    """The first bad result ends the run with one error, and standard error stays
    empty: ctypes reports every result that it cannot convert."""
    script = """if True:
        import sys, vanguard
        sys.path.insert(0, sys.argv[1])
        from test_vanguard import cube
        calls = []
        job = vanguard.Job()
        job.surface(*cube(6))
        for result in (None, "0.1", [1], object()):
            del calls[:]
            def size(x, y, z):
                calls.append(x)
                return result
            job.size_function(size)
            try:
                job.mesh()
                print("no error for", result)
            except TypeError as error:
                print(len(calls), error)
        def breaks(x, y, z):
            return None + x
        job.size_function(breaks)
        try:
            job.mesh()
        except TypeError as error:
            print("own:", error)
    """
    ran = subprocess.run(
        [sys.executable, "-c", script, os.path.dirname(__file__)],
        capture_output=True, text=True, timeout=120)
    lines = ran.stdout.splitlines()
    assert ran.returncode == 0 and not ran.stderr, ran.stderr[:500]
    assert len(lines) == 5, lines
    for line in lines[:4]:
        assert line.startswith("1 the size function returned"), line
        assert "must return a number above 0" in line, line
    assert lines[4].startswith("own: unsupported operand"), lines[4]


def test_one_call_at_a_time():
    """A callback and a second thread are refused, and the run continues."""
    points, triangles, patches = cube(6)
    job = vanguard.Job()
    job.surface(points, triangles, patches)
    calls = [job.close, job.mesh, lambda: job.set(growth=1.3),
             lambda: job.get("growth"), lambda: job.surface(points, triangles),
             lambda: job.size_points([[0, 0, 0]], [1]),
             lambda: job.deck("A deck"), lambda: job.open("x"),
             lambda: job.patch(10, name="a"), lambda: job.size_function(None),
             lambda: job.metric_function(None),
             lambda: job.metric_points([[0, 0, 0]], [[1, 0, 0, 1, 0, 1]])]
    refusals = []

    def try_all():
        for call in calls:
            refusals.append(refused("busy", "in use by another call", call))

    def progress(phase, done, expected):
        if not refusals:
            try_all()
            other = threading.Thread(target=try_all)
            other.start()
            other.join()

    mesh = job.mesh(progress)
    assert len(refusals) == 2 * len(calls)
    assert isinstance(refusals[0], vanguard.Busy)
    assert abs(volume(mesh) - 1) < 1e-12 and job.get("growth") == "1.2"

    def close(phase, done, expected):
        job.close()

    refused("busy", "in use by another call", job.mesh, close)
    assert "no surface" not in refused(
        "input", "above 1", job.set, growth=0.5).args[0]
    again = job.mesh()
    assert np.array_equal(again.points, mesh._arrays[0])
    job.close()
    job.close()


def test_progress():
    points, triangles, patches = cube(6)
    job = vanguard.Job()
    job.surface(points, triangles, patches)
    phases = []
    job.mesh(lambda phase, done, expected: phases.append(phase))
    assert phases[0] in ("read", "surface check"), phases
    assert phases[-1] == "mesh check", phases
    refused("stopped", "interrupted", job.mesh,
            lambda phase, done, expected: phase == "load estimate")
    try:
        job.mesh(lambda phase, done, expected: 1 / 0)
        raise AssertionError("an error of a progress function is lost")
    except ZeroDivisionError:
        pass
    error = refused("geometry", "the surface is open", open_cube(job).mesh)
    assert "open" in error.details


def open_cube(job):
    points, triangles, patches = cube(6)
    job.surface(points, triangles[:-1], patches[:-1])
    job.set(farfield="none")
    return job


def test_threads():
    points, triangles, patches = cube(8)
    found = [None] * 3

    def work(i):
        job = vanguard.Job()
        job.surface(points, triangles, patches)
        found[i] = job.mesh().points

    threads = [threading.Thread(target=work, args=(i,)) for i in range(3)]
    for t in threads:
        t.start()
    for t in threads:
        t.join()
    assert np.array_equal(found[0], found[1])
    assert np.array_equal(found[0], found[2])


def test_surfaces():
    points, triangles, patches = cube(8)
    with vanguard.Job() as job:
        refused("usage", "no report", job.report)
        job.surface(points, triangles, patches)
        domain = job.check()
        assert domain.flow == "internal" and not domain.has_farfield
        assert len(domain.triangles) == len(triangles), domain
        assert [p["id"] for p in domain.patches] == list(range(10, 16))
        assert job.report()["flow"]["kind"] == "internal"
        job.surface(points, triangles[:, ::-1], patches)
        whole = job.check()
        assert whole.flow == "external" and whole.has_farfield
        alone = job.make_surface()
        assert not alone.has_farfield and "external" in repr(alone)
        assert alone.triangle_patches.max() < len(alone.patches) < len(
            whole.patches)
        job.surface(points, triangles[:-1], patches[:-1])
        refused("geometry", "open", job.check)
        assert job.boundary().n_open_edge == 3
        assert not job.report()["ok"]
    assert whole.points[whole.triangles].shape[1:] == (3, 3)


def test_forecast(folder, program):
    """The counts are those of `vanguard plan`, and about those of the mesh."""
    points, triangles, patches = cube(8)
    with vanguard.Job() as job:
        refused("usage", "no surface", job.forecast)
        job.surface(points, triangles, patches)
        job.set(hmax=0.05)
        refused("input", "0 ranks", job.forecast, 0)
        phases = []
        f = job.forecast(2, 2, lambda phase, *unused: phases.append(phase))
        assert phases[-1] == "forecast" and "fill" not in phases
        assert (f.ranks, f.threads) == (2, 2) and f.seconds > 0
        assert f.n_tet == f.n_cell > f.n_point and f.n_wall_point == 0
        assert f.memory == f.stages[f.peak_stage] == max(f.stages.values())
        assert f.memory > f.memory_shared > 0 and f.bytes_written > 1e5
        assert "cells" in repr(f) and not hasattr(f, "memory_fill")
        assert len(job.boundary().triangles) == len(triangles)
        assert job.report()["ok"]
        try:
            job.forecast(progress=lambda *unused: True)
            assert False, "not stopped"
        except vanguard.Stopped:
            pass
        made = job.mesh()
        assert 0.8 < f.n_cell / len(made.tetrahedra) < 1.25, f
        made.write(os.path.join(folder, "forecast"), "lb8.ugrid")
        stem = os.path.join(folder, "forecast.lb8.ugrid")
        planned = json.loads(subprocess.run(
            [program, "plan", "-q", "-p", stem, "-j", "-n", "2", "-t", "2"],
            stdout=subprocess.PIPE, check=True).stdout)
        job.open(stem)
        f = job.forecast(2, 2)
        assert f.n_cell == planned["mesh"]["cells"]
        assert f.n_point == planned["mesh"]["points"]
        assert f.bytes_written == sum(planned["files"].values())


def test_read(folder):
    points, triangles, patches = cube(8)
    job = vanguard.Job()
    job.surface(points, triangles, patches)
    made = job.mesh()
    assert made.report()["mesh"]["valid"] and "Volume mesh" in made.report(
        "text")
    made.write(os.path.join(folder, "read"), "lb8.ugrid")
    read = vanguard.read(os.path.join(folder, "read.lb8.ugrid"))
    assert np.array_equal(read.points, made.points)
    assert np.array_equal(read.tetrahedra, made.tetrahedra)
    assert np.array_equal(read.triangle_patches, made.triangle_patches)
    assert read.quality["is_valid"] == 1
    assert abs(read.quality["volume"] - made.quality["volume"]) < 1e-12
    refused("usage", "read from a file", read.write, os.path.join(folder, "x"))
    refused("io", "nowhere", vanguard.read, "/nowhere/mesh.ugrid")


def test_hexahedra(folder):
    """A bar of three hexahedra in a file."""
    at = [(x, y, z) for x in range(4) for y in (0, 1) for z in (0, 1)]
    number = {p: i + 1 for i, p in enumerate(at)}

    def corners(*of):
        return [number[p] for p in of]

    hexes, quads = [], []
    for x in range(3):
        low, high = x, x + 1
        hexes.append(corners(
            (low, 0, 0), (high, 0, 0), (high, 1, 0), (low, 1, 0),
            (low, 0, 1), (high, 0, 1), (high, 1, 1), (low, 1, 1)))
        a = hexes[-1]
        quads += [[a[k] for k in side] for side in (
            (0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (2, 6, 7, 3))]
        if x == 0:
            quads.append([a[k] for k in (0, 3, 7, 4)])
        if x == 2:
            quads.append([a[k] for k in (1, 5, 6, 2)])
    path = os.path.join(folder, "bar.lb8.ugrid")
    with open(path, "wb") as f:
        np.array([len(at), 0, len(quads), 0, 0, 0, 3], "<i4").tofile(f)
        np.array(at, "<f8").tofile(f)
        for block in quads, [1] * len(quads), hexes:
            np.array(block, "<i4").tofile(f)
    mesh = vanguard.read(path)
    assert np.array_equal(mesh.hexahedra, np.array(hexes) - 1)
    assert mesh.counts.n_hex == 3 and not len(mesh.prisms)
    assert "3 hexahedra" in repr(mesh)
    assert mesh.quality["is_valid"] == 1
    assert abs(mesh.quality["volume"] - 3) < 1e-12
    (piece,) = mesh.pieces()
    assert np.array_equal(piece["hexahedra"], mesh.hexahedra)
    cells, types, unused = mesh.to_vtk_arrays()
    assert (types == 12).all() and len(cells) == 27
    assert ("hexahedron", 3) in [
        (kind, len(nodes)) for kind, nodes in mesh.to_meshio_dict()["cells"]]


def test_same_as_program(folder, program):
    """A project with layers, for which TetGen is used too, gives the same bytes."""
    stem = os.path.join(folder, "demo", "wing-half")
    quiet = {"stdout": subprocess.DEVNULL, "check": True}
    subprocess.run([program, "demo", "wing-half", "--out",
                    os.path.dirname(stem)], **quiet)
    subprocess.run([program, "mesh", "-q", "-p", stem, "-o", folder, "--write",
                    "b8.ugrid"], **quiet)
    with open(os.path.join(folder, "wing-half.b8.ugrid"), "rb") as f:
        theirs = f.read()
    job = vanguard.Job()
    job.open(stem)
    job.mesh().write(os.path.join(folder, "own"), "b8.ugrid")
    with open(os.path.join(folder, "own.b8.ugrid"), "rb") as f:
        assert f.read() == theirs


if __name__ == "__main__":
    assert vanguard.prepare()
    for name, test in list(globals().items()):
        if name.startswith("test_"):
            test(*sys.argv[1:1 + test.__code__.co_argcount])
    print("vanguard", vanguard.library_version(), "works from Python")
