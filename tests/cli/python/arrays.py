# SPDX-License-Identifier: LGPL-3.0-or-later
"""Arrays of a mesh outlive mesh and job."""
import gc

import numpy as np
from shapes import cube, job_of, layered, run

FACES = ("triangles", "triangle_patches", "quadrilaterals",
         "quadrilateral_patches")


def numbers(mesh):
    """All arrays of a mesh by name."""
    names = ("points", "tetrahedra", "pyramids", "prisms") + FACES
    found = {name: getattr(mesh, name) for name in names}
    for i, piece in enumerate(mesh.pieces()):
        found.update({"%s of piece %d" % (name, i): a
                      for name, a in piece.items() if isinstance(a, np.ndarray)})
    found.update(mesh.wall_points)
    return found


def test_memory_is_owned():
    for name, a in numbers(layered()).items():
        while a.base is not None:
            a = a.base
            assert isinstance(a, np.ndarray), name + " is a view"
        assert a.flags.owndata, name


def reuse_memory():
    for n in (4, 6, 8):
        job_of(n, hmax=0.2).mesh()


def test_empty_arrays():
    job = job_of(4)
    for empty in ([], np.zeros((0, 3))):
        job.size_points([[0, 0, 0]], [0.01])
        job.size_points(empty, [])


def test_after_the_job():
    mesh = layered()
    found = numbers(mesh)
    before = {name: a.copy() for name, a in found.items()}
    job = mesh._job
    job.surface(*cube(8))
    job.set(cells="tets", layers=False)
    job.mesh()
    job.close()
    del job, mesh
    gc.collect()
    reuse_memory()
    for name, a in found.items():
        assert np.array_equal(a, before[name]), name


def test_of_a_temporary():
    triangles = job_of(6).mesh().triangles
    gc.collect()
    reuse_memory()
    again = job_of(6).mesh()
    assert np.array_equal(triangles, again.triangles)
    assert triangles.max() < again.counts.n_boundary_point


def test_pieces_after_the_next():
    mesh = layered()
    pieces = list(mesh.pieces())
    total = sum(len(piece["prisms"]) for piece in pieces)
    assert total == len(mesh.prisms)
    for piece in pieces:
        for kind in ("tetrahedra", "prisms"):
            if len(piece[kind]):
                assert piece[kind].max() < len(piece["points"])
        assert np.array_equal(mesh.points[piece["ids"]], piece["points"])


def test_iteration_across_a_mesh():
    """The iterator must not return a piece of a mesh that is gone."""
    mesh = layered()
    pieces = mesh.pieces()
    first = next(pieces)["points"].copy()
    mesh._job.mesh()
    try:
        next(pieces)
        raise AssertionError("a piece of a mesh that is gone")
    except ValueError as error:
        assert "another mesh" in str(error), error
    del pieces
    assert len(first)
    pieces = layered().pieces()
    next(pieces)
    del pieces
    gc.collect()


if __name__ == "__main__":
    run(globals())
