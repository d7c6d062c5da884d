#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-2-Clause
"""Writes a metric for the points of a mesh: metric.py STEM.mesh -> STEM.sol

It stands for the metric of an adaptation code: cells are thin across a shock,
here the surface of a sphere of radius 0.7, and long along it. STEM.mesh is a
Medit text file.
"""
import math
import sys

ACROSS, ALONG, GROWTH = 0.01, 0.12, 0.25  # edge lengths; growth of the first
RADIUS = 0.7


def points(path):
    words = iter(open(path).read().split())
    for word in words:
        if word == "Vertices":
            break
    n = int(next(words))
    for _ in range(n):
        x, y, z, _ = (float(next(words)) for _ in range(4))
        yield x, y, z


def metric(p):
    """M = across^-2 n n' + along^-2 (I - n n'), the lower half by rows."""
    r = math.hypot(*p)
    n = [c / r for c in p] if r > 1e-9 else [1, 0, 0]
    across = min(ACROSS + GROWTH * abs(r - RADIUS), ALONG)
    a, b = across ** -2, ALONG ** -2
    return [(a - b) * n[i] * n[j] + (b if i == j else 0)
            for i in range(3) for j in range(i + 1)]


stem = sys.argv[1].rsplit(".", 1)[0]
rows = [" ".join("%.9g" % m for m in metric(p)) for p in points(sys.argv[1])]
with open(stem + ".sol", "w") as out:
    out.write("MeshVersionFormatted 2\nDimension 3\nSolAtVertices\n%d\n1 3\n"
              % len(rows))
    out.write("\n".join(rows) + "\nEnd\n")
