# SPDX-License-Identifier: LGPL-3.0-or-later
"""Reads a .zones.su2 as SU2 does, zone by zone, without Vanguard, and checks
cells, faces and interfaces.

zones_su2.py FILE.zones.su2: for each zone, in its order, a line with its name,
the number of its cells, and its volume. Any failure ends with a message."""
import re
import sys
from collections import Counter

import numpy as np

# VTK's kinds: number of nodes, and faces with normals out of the cell.
KINDS = {
    5: (3, None),
    9: (4, None),
    10: (4, ((0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3))),
    12: (8, ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5),
             (2, 3, 7, 6), (3, 0, 4, 7))),
    13: (6, ((0, 1, 2), (3, 5, 4), (0, 3, 4, 1), (1, 4, 5, 2), (2, 5, 3, 0))),
    14: (5, ((0, 3, 2, 1), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4))),
}


def value(lines, key):
    """The number after a keyword, which SU2 seeks from the current line on."""
    for line in lines:
        if line.startswith(key):
            return int(line[len(key):])
    sys.exit("no " + key)


def elements(lines, n):
    """The nodes of n elements, with their kinds."""
    out = []
    for _ in range(n):
        word = [int(w) for w in next(lines).split()]
        out.append((word[0], tuple(word[1:1 + KINDS[word[0]][0]])))
    return out


def read_zone(lines, number):
    """Cells, points and markers of the next zone."""
    assert value(lines, "IZONE=") == number
    assert value(lines, "NDIME=") == 3
    cells = elements(lines, value(lines, "NELEM="))
    n = value(lines, "NPOIN=")
    points = np.array([[float(w) for w in next(lines).split()[:3]]
                       for _ in range(n)])
    markers = {}
    for _ in range(value(lines, "NMARK=")):
        name = next(lines).removeprefix("MARKER_TAG= ").strip()
        assert name not in markers, "marker " + name + " occurs twice"
        markers[name] = elements(lines, value(lines, "MARKER_ELEMS="))
    return cells, points, markers


def check_zone(cells, points, markers):
    """Each face has two cells, or a cell and a marker. Returns the volume."""
    faces = Counter()
    used = np.zeros(len(points), bool)
    volume = 0.0
    for kind, node in cells:
        used[list(node)] = True
        own = 0.0
        for face in KINDS[kind][1]:
            corner = tuple(node[k] for k in face)
            faces[frozenset(corner)] += 1
            x = points[list(corner)] - points[node[0]]
            for k in range(1, len(corner) - 1):
                own += np.dot(x[0], np.cross(x[k], x[k + 1])) / 6
        assert own > 0, f"a cell of volume {own}"
        volume += own
    assert used.all(), "a point without a cell"
    for name, elems in markers.items():
        for _, node in elems:
            assert faces[frozenset(node)] == 1, "a face of " + name
            faces[frozenset(node)] += 1
    assert set(faces.values()) == {2}, "a face without a marker"
    return volume


def triangles(points, elems):
    """The triangles of a marker by coordinates."""
    return Counter(frozenset(points[k].tobytes() for k in node)
                   for _, node in elems)


def main():
    with open(sys.argv[1], encoding="ascii") as file:
        text = file.readlines()
    comment = {m[1]: m[2].split(", ") for m in
               (re.match(r"% ([A-Z_]+)= \( (.*) \)", t) for t in text[:9]) if m}
    lines = iter(text)
    zones = [read_zone(lines, k + 1) for k in range(value(lines, "NZONE="))]
    names = [c.removesuffix(".cfg") for c in comment["CONFIG_LIST"]]
    assert len(names) == len(zones)
    for name, zone in zip(names, zones):
        print(name, len(zone[0]), f"{check_zone(*zone):.9g}")
    pairs = comment.get("MARKER_ZONE_INTERFACE", [])
    assert len(set(pairs)) == len(pairs) and len(pairs) % 2 == 0
    for a, b in zip(pairs[::2], pairs[1::2]):
        side = [[triangles(z[1], z[2][name]) for z in zones if name in z[2]]
                for name in (a, b)]
        assert [len(s) for s in side] == [1, 1], f"{a}, {b}: not in one zone"
        assert side[0] == side[1], f"{a} and {b} differ"


main()
