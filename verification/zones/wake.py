#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""A wake sheet behind the sharp trailing edge of a wing.

    wake.py WING.stl OUT.stl --angle DEGREES --length L

The trailing edge consists of the edges whose two triangles have nearly opposite
normals. The sheet begins with these edges and their points, and continues in the
plane of x and z at the given angle, with rows that become longer by a tenth, up to
three times the mean edge. OUT.stl has the solids wing and wake.
"""
import argparse
import collections
import math


def read(path):
    """Points and triangles of an .stl in text form."""
    number, point, corner = {}, [], []
    with open(path, encoding="ascii") as lines:
        for line in lines:
            word = line.split()
            if not word or word[0] != "vertex":
                continue
            x = tuple(float(w) for w in word[1:])
            if x not in number:
                number[x] = len(point)
                point.append(x)
            corner.append(number[x])
    return point, [corner[i:i + 3] for i in range(0, len(corner), 3)]


def normal(point, t):
    a, b, c = (point[v] for v in t)
    u = [b[k] - a[k] for k in range(3)]
    v = [c[k] - a[k] for k in range(3)]
    n = [u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3]
         for k in range(3)]
    size = math.hypot(*n)
    return [x / size for x in n] if size else n


def trailing_edge(point, triangle):
    """The points of the trailing edge in their order."""
    normals = [normal(point, t) for t in triangle]
    faces = collections.defaultdict(list)
    for i, t in enumerate(triangle):
        for k in range(3):
            faces[frozenset((t[k], t[(k + 1) % 3]))].append(normals[i])
    beside = collections.defaultdict(list)
    for edge, n in faces.items():
        if len(n) == 2 and sum(p * q for p, q in zip(*n)) < -0.5:
            a, b = edge
            beside[a].append(b)
            beside[b].append(a)
    ends = sorted(p for p in beside if len(beside[p]) == 1)
    if len(ends) != 2 or any(len(b) > 2 for b in beside.values()):
        raise SystemExit("the trailing edge is not a single line")
    line = [min(ends, key=lambda p: point[p][1])]
    while len(line) == 1 or line[-1] not in ends:
        line += [p for p in beside[line[-1]] if p not in line[-2:]]
    return line


def rows(edge, length):
    """Distances of the rows from the trailing edge."""
    row = [0]
    while row[-1] < length:
        row.append(row[-1] + edge * min(1.1**len(row), 3))
    return [length / row[-1] * x for x in row]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("wing")
    parser.add_argument("out")
    parser.add_argument("--angle", type=float, default=0)
    parser.add_argument("--length", type=float, required=True)
    option = parser.parse_args()
    point, triangle = read(option.wing)
    line = [point[p] for p in trailing_edge(point, triangle)]
    edge = sum(math.dist(p, q) for p, q in zip(line, line[1:])) / (len(line) - 1)
    to = (math.cos(math.radians(option.angle)), 0,
          math.sin(math.radians(option.angle)))
    grid = [[tuple(p[k] + d * to[k] for k in range(3)) for p in line]
            for d in rows(edge, option.length)]
    wake = []
    for a, b in zip(grid, grid[1:]):
        for i in range(len(line) - 1):
            wake += [(a[i], b[i], b[i + 1]), (a[i], b[i + 1], a[i + 1])]
    wing = [[point[v] for v in t] for t in triangle]
    with open(option.out, "w", encoding="ascii") as out:
        for name, solid in (("wing", wing), ("wake", wake)):
            print("solid", name, file=out)
            for t in solid:
                print("facet normal 0 0 0\nouter loop", file=out)
                for x in t:
                    print("vertex %.17g %.17g %.17g" % x, file=out)
                print("endloop\nendfacet", file=out)
            print("endsolid", name, file=out)


if __name__ == "__main__":
    main()
