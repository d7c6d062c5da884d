# SPDX-License-Identifier: LGPL-3.0-or-later
"""Case `python` of faults.py: library.py STEM."""
import sys

import numpy as np
import vanguard

points = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)],
                  float)
triangles = np.array([[0, 1, 3], [0, 3, 2], [4, 7, 5], [4, 6, 7], [0, 5, 1],
                      [0, 4, 5], [1, 7, 3], [1, 5, 7], [3, 6, 2], [3, 7, 6],
                      [2, 4, 0], [2, 6, 4]])
try:
    job = vanguard.Job()
    job.surface(points, triangles, np.arange(12) // 2 + 1, name="cube")
    job.set(hmax=0.3)
    mesh = job.mesh()
    print(len(mesh.points), len(mesh.tetrahedra))
    mesh.write(sys.argv[1], "b8.ugrid")
except (vanguard.Error, MemoryError) as error:
    sys.exit("library.py: %s" % error)
