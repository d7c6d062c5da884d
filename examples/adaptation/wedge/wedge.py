#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-2-Clause
"""Writes wedge.stl: the air above a wedge of 15 degrees in a supersonic flow.

                                top
        (-0.4, 1) +---------------------------+ (1.2, 1)
                  |                           |
            inlet |                    .  '   | outlet
                  |             . '    wedge  + (1.2, 0.32)
     (-0.4, 0)    +-----------+'
                     floor   (0, 0)

The domain is 0.1 thick, between two planes of symmetry, back and front.
"""
import math

HEIGHT, BEFORE, AFTER, WIDTH, ANGLE = 1.0, 0.4, 1.2, 0.1, math.radians(15)
corner = [(-BEFORE, 0.0), (0.0, 0.0), (AFTER, AFTER * math.tan(ANGLE)),
          (AFTER, HEIGHT), (-BEFORE, HEIGHT)]
side = ["floor", "wedge", "outlet", "top", "inlet"]


def facet(out, a, b, c):
    out.write("facet normal 0 0 0\nouter loop\n")
    for p in (a, b, c):
        out.write("vertex %.17g %.17g %.17g\n" % p)
    out.write("endloop\nendfacet\n")


def solid(out, name, triangles):
    out.write("solid %s\n" % name)
    for t in triangles:
        facet(out, *t)
    out.write("endsolid %s\n" % name)


with open("wedge.stl", "w") as out:
    n = len(corner)
    for k in range(n):
        (x, y), (u, v) = corner[k], corner[(k + 1) % n]
        a, b = (x, y, 0.0), (u, v, 0.0)
        c, d = (u, v, WIDTH), (x, y, WIDTH)
        solid(out, side[k], [(a, b, c), (a, c, d)])
    for name, z, turn in (("back", 0.0, 1), ("front", WIDTH, 0)):
        p = [(x, y, z) for x, y in corner]
        fan = [(p[1], p[k], p[k + 1]) for k in (2, 3)] + [(p[1], p[4], p[0])]
        solid(out, name, [t[::-1] if turn else t for t in fan])
