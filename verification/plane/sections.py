#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""verification/plane/sections.py: writes the section of a wing in its symmetry
plane as a plane section of Vanguard (.dat, docs/reference/formats.md 3.4).

usage: sections.py SURFACE.lb8.ugrid[.xz] SYMMETRY NAME=TAG,... ... >section.dat

SYMMETRY is the tag of the symmetry plane. Each NAME=TAG,... is an element with
the tags of its faces. The edges that an element shares with the symmetry plane
form a closed curve, which is written in Selig's order: x along the stream, y
up (z of the wing), from the rearmost point along the upper side.
Exit status: 0, or 1 with a message.
"""
import array
import lzma
import sys


def fail(message):
    sys.exit("sections.py: " + message)


def surface(path):
    """Points, triangles and their tags of a little-endian UGRID file."""
    with (lzma.open if path.endswith(".xz") else open)(path, "rb") as stream:
        data = stream.read()

    def values(kind, n, at):
        block = array.array(kind, data[at:at + n * array.array(kind).itemsize])
        if sys.byteorder == "big":
            block.byteswap()
        if len(block) != n:
            fail(path + " is cut off")
        return block

    n, tri, quad = values("i", 7, 0)[:3]
    x = values("d", 3 * n, 28)
    v = values("i", 3 * tri, 28 + 24 * n)
    tag = values("i", tri, 28 + 24 * n + 12 * tri + 16 * quad)
    return ([x[3 * i:3 * i + 3] for i in range(n)],
            [[p - 1 for p in v[3 * i:3 * i + 3]] for i in range(tri)], tag)


def follower(triangles, tags, symmetry, wall):
    """The next point of each point along the edges of wall and symmetry."""
    plane = set()
    for v, tag in zip(triangles, tags):
        if tag == symmetry:
            plane.update(frozenset((v[k], v[k - 1])) for k in range(3))
    return {v[k - 1]: v[k] for v, tag in zip(triangles, tags) if tag in wall
            for k in range(3) if frozenset((v[k], v[k - 1])) in plane}


def curve(points, after, name):
    """The closed curve from its rearmost point, counter-clockwise."""
    if not after:
        fail(f"element {name} has no edge in the symmetry plane")
    start = max(after, key=lambda p: points[p][0])
    loop = [start]
    while (p := after.get(loop[-1])) != start:
        if p is None or len(loop) > len(after):
            fail(f"the edges of element {name} do not form a closed curve")
        loop.append(p)
    if len(loop) != len(after):
        fail(f"the edges of element {name} form several curves")
    xy = [(points[p][0], points[p][2]) for p in loop]
    area = sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(xy, xy[1:] + xy[:1]))
    return xy if area > 0 else xy[:1] + xy[:0:-1]


def main(arguments):
    if len(arguments) < 3:
        sys.exit(__doc__)
    points, triangles, tags = surface(arguments[0])
    for element in arguments[2:]:
        name, _, wall = element.partition("=")
        wall = {int(tag) for tag in wall.split(",")}
        xy = curve(points, follower(triangles, tags, int(arguments[1]), wall),
                   name)
        print(name)
        for p in xy + xy[:1]:
            print("%.17g %.17g" % p)


if __name__ == "__main__":
    main(sys.argv[1:])
