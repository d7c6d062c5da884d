#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-2-Clause
"""Writes wing_body.d3m and wing_body.mapbc: a faceted wing-body half model.

Every patch is planar, so the project needs no .front. Lengths are in metres.
The body lies along x, the span along y, and y = 0 is the symmetry plane.
usage: wing_body.py [FOLDER]
"""
import os
import sys

points = []
curves = {}  # (lower point, higher point) -> number
patches = []  # name, class, condition, curves
sources = []  # group, point, spacing, second point or None, spacing, an


def point(x, y, z):
    points.append((x, y, z))
    return len(points)


def loop(corners):
    """The signed curves around a patch; new ones are numbered on the way."""
    signed = []
    for a, b in zip(corners, corners[1:] + corners[:1]):
        key = (min(a, b), max(a, b))
        number = curves.setdefault(key, len(curves) + 1)
        signed.append(number if a < b else -number)
    return signed


def patch(name, meshing_class, condition, corners, inward):
    """A planar patch; its normal is turned to have the sign of `inward`."""
    normal = [0.0, 0.0, 0.0]
    for a, b in zip(corners, corners[1:] + corners[:1]):
        p, q = points[a - 1], points[b - 1]
        for k in range(3):
            i, j = (k + 1) % 3, (k + 2) % 3
            normal[k] += p[i] * q[j] - p[j] * q[i]
    if sum(n * i for n, i in zip(normal, inward)) < 0:
        corners = corners[::-1]
    patches.append((name, meshing_class, condition, loop(corners)))


def node(group, p, spacing, intensity):
    sources.append((group, p, spacing, None, spacing, intensity))


def line(group, p, spacing, q, end):
    sources.append((group, points[p - 1], spacing, points[q - 1], end, 1))


# The body: a nose tip, two equal rings of corners, a tail tip.
ring = [(0, .5), (.25, .5), (.5, .2), (.5, 0), (.5, -.2), (.25, -.5), (0, -.5)]
nose, tail = point(0, 0, 0), point(11, 0, .2)
front = [point(2.5, y, z) for y, z in ring]
back = [point(8.5, y, z) for y, z in ring]

# The wing: a six-sided section, scaled from root to tip.
section = [(0, 0), (.3, .04), (.7, .04), (1, 0), (.7, -.04), (.3, -.04)]
root = [point(4 + 2.5 * x, .5, 2.5 * z) for x, z in section]
tip = [point(6 + 1.0 * x, 4, 1.0 * z) for x, z in section]

# The box of the farfield; 1 and 2 are where the symmetry plane is divided.
upstream, downstream = point(-60, 0, 0), point(70, 0, 0)
near = [point(x, 0, z) for x, z in
        [(-60, 60), (70, 60), (70, -60), (-60, -60)]]
far = [point(x, 60, z) for x, z in
       [(-60, 60), (70, 60), (70, -60), (-60, -60)]]

out = [(0, .2, 1), (0, 1, 1), (0, 1, 0), (0, 1, -1), (0, .2, -1)]
sides = [[0, 1], [1, 2], [2, 3, 4], [4, 5], [5, 6]]
names = ["top", "shoulder", "side", "chine", "belly"]
for corners, inward, name in zip(sides, out, names):
    patch("nose_" + name, 2, 4, [nose] + [front[i] for i in corners], inward)
    patch("tail_" + name, 2, 4, [tail] + [back[i] for i in corners], inward)
    if name != "side":
        patch("body_" + name, 2, 4, [front[i] for i in corners] +
              [back[i] for i in corners[::-1]], inward)
patch("body_side_upper", 2, 4, [front[2], front[3]] + root[:4] +
      [back[3], back[2]], (0, 1, 0))
patch("body_side_lower", 2, 4, [front[4], front[3], root[0], root[5], root[4],
                                root[3], back[3], back[4]], (0, 1, 0))

for i, (side, z) in enumerate([("front_upper", 1), ("mid_upper", 1),
                               ("rear_upper", 1), ("rear_lower", -1),
                               ("mid_lower", -1), ("front_lower", -1)]):
    j = (i + 1) % 6
    patch("wing_" + side, 2, 4, [root[i], root[j], tip[j], tip[i]], (0, 0, z))
patch("wing_tip", 2, 4, tip, (0, 1, 0))

patch("symmetry_upper", 1, 1, [upstream, near[0], near[1], downstream, tail,
                               back[0], front[0], nose], (0, 1, 0))
patch("symmetry_lower", 1, 1, [upstream, near[3], near[2], downstream, tail,
                               back[6], front[6], nose], (0, 1, 0))
patch("inflow", 1, 3, [upstream, near[0], far[0], far[3], near[3]], (1, 0, 0))
patch("outflow", 1, 3, [downstream, near[1], far[1], far[2], near[2]],
      (-1, 0, 0))
patch("ceiling", 1, 3, [near[0], near[1], far[1], far[0]], (0, 0, -1))
patch("floor", 1, 3, [near[3], near[2], far[2], far[3]], (0, 0, 1))
patch("side", 1, 3, far, (0, -1, 0))

# Spacings of edges, in metres.
line("leading_edge", root[0], .03, tip[0], .02)
line("trailing_edge", root[3], .03, tip[3], .02)
line("wing_tip", tip[0], .02, tip[3], .02)
for i in (1, 2, 4, 5):
    line("wing", root[i], .08, tip[i], .05)
line("junction", root[0], .03, root[3], .03)
for i in (0, 2, 4, 6):
    line("body", front[i], .12, back[i], .12)
    line("nose", nose, .04, front[i], .12)
    line("tail", back[i], .12, tail, .04)
for x in (-58, 68):
    for y in (2, 58):
        for z in (-58, 58):
            node("farfield", (x, y, z), 20, 8)

folder = sys.argv[1] if len(sys.argv) > 1 else os.path.dirname(
    os.path.abspath(__file__))
with open(os.path.join(folder, "wing_body.d3m"), "w") as f:
    f.write("#VGRID VERSION\n3.6\n#Project Name\nwing_body\n#\n")
    for name, value in [("grid", 1), ("rate1", .18), ("rate2", .005),
                        ("delt1", 1e-5), ("nlayr", 60), ("rstrt", 0),
                        ("ifact", 1.4), ("vfact", 1), ("strch", 0),
                        ("npoli", len(points)), ("nline", len(curves)),
                        ("nptch", len(patches)), ("ms", len(sources)),
                        ("ni", 20), ("mboun", 250000), ("mpoin", 2500000)]:
        f.write("%16s (%s)\n" % (value, name))
    f.write("#\n#No.              X-coor            Y-Coor            "
            "Z-Coor\n")
    for i, p in enumerate(points):
        f.write("%-17d%18.10g%18.10g%18.10g\n" % (i + 1, *p))
    f.write("#\n")
    for (a, b), number in sorted(curves.items(), key=lambda item: item[1]):
        f.write("%8d%8d%8d%8d\n\n" % (number, 2, a, b))
    f.write("#\n")
    for i, (name, meshing_class, _, signed) in enumerate(patches):
        f.write("%8d%8d%8d%8d%8d %s\n" % (i + 1, 1, len(signed), 0,
                                          meshing_class, name))
        f.write("%24s" % "" + "".join("%8d" % c for c in signed) + "\n\n")
    f.write("#\n")
    for i, (group, p, s, q, e, intensity) in enumerate(sources):
        f.write("source_number    %-17d%s\n" % (i + 1, group))
        f.write("%-17d%-17d (type, stretching)\n" % (1 if q else 0, 0))
        f.write("%-17d%-17d%-17d (an bn alpha)\n" % (intensity, 0, 0))
        for spacing, name in (s, "point 1"), (e, "point 2"):
            f.write("%-17g%-17g (S SP %s)\n" % (spacing, spacing, name))
            f.write("%-17g%-17g%-17g (delta1 rate1 rate2)\n" %
                    (1e-5, .18, .005))
        f.write("%-17d%-17d%-17d (U)\n" % (1, 0, 0))
        f.write("%-17d%-17d%-17d (P)\n" % (0, 0, 0))
        f.write("%-17.10g%-17.10g%-17.10g (point 1)\n" % p)
        f.write("%-17.10g%-17.10g%-17.10g (point 2)\n\n" % (q or p))
with open(os.path.join(folder, "wing_body.mapbc"), "w") as f:
    f.write("#Thu Jan  1 00:00:00 1970\n#bc.map\nPatch #        BC             "
            "Family   #surf   surfIDs         Family\n"
            "#---------------------------------------------------------\n")
    for i, (name, _, condition, _) in enumerate(patches):
        f.write("%-8d%8d%8d%8d%8d        %s\n" % (i + 1, condition, condition,
                                                  0, 0, name))
