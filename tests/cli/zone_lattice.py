# SPDX-License-Identifier: LGPL-3.0-or-later
"""Draws zones at random: boxes of blocks of a lattice, later ones over earlier
ones, so that zones are inside each other, touch in faces, edges and points,
end at the walls, and are thin.

zone_lattice.py SEED NAME: writes NAME.stl, a closed box with a solid for each
wall (w1 to w6; w3 is the plane y = 0) and for each pair of neighbouring labels
(i_A_B), and NAME.volumes: the sorted volumes of the zones, one a line."""
import random
import sys
from itertools import product

N = 5     # blocks in each direction
FINE = 3  # triangles of interfaces: this many per block and direction


def touches_in_points(label):
    """Do interfaces or walls meet in a corner of blocks, without a common edge
    there? Such surfaces are refused."""
    for corner in product(range(N + 1), repeat=3):
        near = {s: label.get(tuple(c + min(k, 0) for c, k in zip(corner, s)), -1)
                for s in product((-1, 1), repeat=3)}
        edges = []  # of the faces at the corner: pairs of directions
        for s, d in product(near, range(3)):
            other = tuple(-k if a == d else k for a, k in enumerate(s))
            if s[d] < 0 and near[s] != near[other]:
                edges.append({(a, s[a]) for a in range(3) if a != d})
        while len(edges) > 1:
            first = edges.pop()
            joined = [e for e in edges if e & first]
            if not joined:
                return True
            edges.remove(joined[0])
            edges.append(joined[0] | first)
    return False


def draw(rng):
    """The coordinates of the lattice, and the label of each block."""
    axis = []
    for _ in range(3):
        step = [rng.choice((1.0, 0.7, 0.15)) for _ in range(N)]
        axis.append([sum(step[:k]) / sum(step) for k in range(N + 1)])
    label = dict.fromkeys(product(range(N), repeat=3), 0)
    for k in range(1, rng.randint(2, 5)):
        lo = [rng.randrange(N) for _ in range(3)]
        hi = [rng.randint(a + 1, min(N, a + 3)) for a in lo]
        for block in product(*(range(a, b) for a, b in zip(lo, hi))):
            label[block] = k
    return axis, label


def regions(label):
    """Blocks that are connected through faces of equal label."""
    seen, out = set(), []
    for start in label:
        if start in seen:
            continue
        stack, part = [start], []
        seen.add(start)
        while stack:
            block = stack.pop()
            part.append(block)
            for d, step in product(range(3), (-1, 1)):
                near = tuple(b + step * (k == d) for k, b in enumerate(block))
                if near in label and near not in seen and \
                        label[near] == label[block]:
                    seen.add(near)
                    stack.append(near)
        out.append(part)
    return out


def faces(axis, label):
    """Rectangles of the patches: name, direction, and corner blocks."""
    for block, d in product(label, range(3)):
        before = tuple(b - (k == d) for k, b in enumerate(block))
        if before not in label:
            yield f"w{2 * d + 1}", d, block, block[d]
        elif label[before] != label[block]:
            a, b = sorted((label[before], label[block]))
            yield f"i_{a}_{b}", d, block, block[d]
        if block[d] == N - 1:
            yield f"w{2 * d + 2}", d, block, N


def triangles(axis, d, block, plane):
    """FINE x FINE rectangles of a face, as two triangles each."""
    u, v = (d + 1) % 3, (d + 2) % 3

    def corner(i, j):
        x = [0.0, 0.0, 0.0]
        x[d] = axis[d][plane]
        for a, n in ((u, i), (v, j)):
            lo, hi = axis[a][block[a]], axis[a][block[a] + 1]
            x[a] = hi if n == FINE else lo + (hi - lo) * n / FINE
        return x

    for i, j in product(range(FINE), repeat=2):
        a, b = corner(i, j), corner(i + 1, j)
        c, e = corner(i + 1, j + 1), corner(i, j + 1)
        yield a, b, c
        yield a, c, e


def main():
    rng = random.Random(int(sys.argv[1]))
    axis, label = draw(rng)
    while touches_in_points(label):
        axis, label = draw(rng)
    patch = {}
    for name, d, block, plane in faces(axis, label):
        patch.setdefault(name, []).extend(triangles(axis, d, block, plane))
    with open(sys.argv[2] + ".stl", "w", encoding="ascii") as out:
        for name in sorted(patch):
            print("solid", name, file=out)
            for tri in patch[name]:
                print("facet normal 0 0 0\nouter loop", file=out)
                for x in tri:
                    print("vertex", *(f"{c:.17g}" for c in x), file=out)
                print("endloop\nendfacet", file=out)
            print("endsolid", name, file=out)
    size = [[hi - lo for lo, hi in zip(a, a[1:])] for a in axis]
    volumes = sorted(sum(size[0][i] * size[1][j] * size[2][k]
                         for i, j, k in part) for part in regions(label))
    with open(sys.argv[2] + ".volumes", "w", encoding="ascii") as out:
        print(*(f"{v:.5g}" for v in volumes), sep="\n", file=out)


main()
