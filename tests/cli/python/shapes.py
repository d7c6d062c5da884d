# SPDX-License-Identifier: LGPL-3.0-or-later
"""Surfaces for the tests of the module vanguard."""
import numpy as np
import vanguard


def cube(n):
    """Points, triangles and patches 10 to 15 of a unit cube with n x n squares
    per side. The triangles are counter-clockwise seen from inside."""
    points, triangles, patches = [], [], []
    i, j = np.meshgrid(np.arange(n), np.arange(n), indexing="ij")
    corner = (i * (n + 1) + j).ravel()
    a, b, c, d = corner, corner + n + 1, corner + n + 2, corner + 1
    u, v = np.meshgrid(*[np.arange(n + 1) / n] * 2, indexing="ij")
    for face in range(6):
        axis = face // 2
        x = np.empty((u.size, 3))
        x[:, axis], x[:, axis - 2], x[:, axis - 1] = (face % 2, u.ravel(),
                                                      v.ravel())
        t = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
        triangles.append((t if face % 2 == 0 else t[:, ::-1]) +
                         len(points) * u.size)
        points.append(x)
        patches.append(np.full(len(t), 10 + face))
    x, index = np.unique(np.concatenate(points), axis=0, return_inverse=True)
    return x, index.reshape(-1)[np.concatenate(triangles)], np.concatenate(
        patches)


def job_of(n, **settings):
    job = vanguard.Job()
    job.surface(*cube(n))
    job.set(**settings)
    return job


def layered(n=6, **settings):
    """Prisms on patch 14; with other settings also pyramids."""
    job = job_of(n, cells="mixed", layers=True, first=0.01, **settings)
    for id in range(10, 16):
        job.patch(id, bc=4 if id == 14 else 1, name="p%d" % id)
    return job.mesh()


def run(tests, *arguments):
    """Call the functions test_... of a module in their order."""
    for name, test in list(tests.items()):
        if name.startswith("test_"):
            test(*arguments[:test.__code__.co_argcount])
