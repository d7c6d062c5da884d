#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-2-Clause
"""Meshes a wing-like body given as arrays. Run it as a script, or as a notebook
in editors that use `# %%` as cell marks (VS Code, Jupytext, Spyder)."""
# %% A surface: a triangulated ellipsoid, all of it patch 1.
import numpy as np
import vanguard

n, m = 24, 48
u = np.linspace(0, np.pi, n + 1)[1:-1]
v = np.linspace(0, 2 * np.pi, m, endpoint=False)
rings = np.stack([np.outer(np.cos(u), np.ones(m)),
                  0.5 * np.outer(np.sin(u), np.cos(v)),
                  0.2 * np.outer(np.sin(u), np.sin(v))], axis=2)
points = np.concatenate([rings.reshape(-1, 3), [[1, 0, 0], [-1, 0, 0]]])
nose, tail = len(points) - 2, len(points) - 1
i, j = np.meshgrid(np.arange(n - 2), np.arange(m), indexing="ij")
a, b = (i * m + j).ravel(), (i * m + (j + 1) % m).ravel()
ring, other = np.arange(m), (np.arange(m) + 1) % m
triangles = np.concatenate([
    np.stack([a, a + m, b], axis=1), np.stack([b, a + m, b + m], axis=1),
    np.stack([np.full(m, nose), ring, other], axis=1),
    np.stack([np.full(m, tail), (n - 2) * m + other,
              (n - 2) * m + ring], axis=1)])

# %% Settings are those of the deck. A farfield is added around the body.
job = vanguard.Job()
job.surface(points, triangles, np.ones(len(triangles)), name="ellipsoid")
job.patch(1, bc=4, name="hull")
job.set(cells="mixed", layers="yes", first=1e-3, ratio=1.3,
        farfield_lengths=5)
job.size_points([[1.5, 0, 0]], [0.03])       # finer in the wake

# %% The mesh, as arrays.
mesh = job.mesh(lambda phase, done, expected: None)
print(len(mesh.points), "points,", len(mesh.tetrahedra), "tetrahedra,",
      len(mesh.prisms), "prisms,", len(mesh.pyramids), "pyramids")
print("patches:", [(p["id"], p["name"]) for p in mesh.patches])
for note in mesh.notes:
    print("note:", note)

# %% Quality of layers and cells.
for wall in mesh.walls[:1]:
    print("first heights %.2g to %.2g, %d to %d layers" % (
        wall["first"][0], wall["first"][2], wall["level"][0],
        wall["level"][2]))
print("dihedral angles of the field: %.1f to %.1f degrees" % (
    mesh.quality["angle_min"], mesh.quality["angle_max"]))

# %% Export: files, meshio.Mesh(**data), pyvista.UnstructuredGrid(*grid).
mesh.write("ellipsoid", "b8.ugrid,vtu")
data = mesh.to_meshio_dict()
grid = mesh.to_vtk_arrays()
print([(kind, len(cells)) for kind, cells in data["cells"]])
