#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Error of linear interpolation on meshes by `vanguard metric` and on uniform
ones: a front of width 0.02, the surface of a sphere, in the unit cube.

interpolation.py --vanguard PROGRAM FOLDER

Each cycle gives the exact values at the points to `vanguard metric` and meshes
by its metric. The error is measured in L2 with 20 random points per cell. Needs
numpy. Fails if the error on adapted meshes does not fall like cells^(-2/3)
within 0.1 in the exponent, or exceeds a tenth of that on a uniform mesh.
"""
import argparse
import math
import os
import subprocess
import sys

import numpy as np

WIDTH, RADIUS, CENTRE, CYCLES, POINTS = 0.02, 0.8, -0.2, 6, 20


def front(x):
    return np.tanh((np.sqrt(((x - CENTRE) ** 2).sum(-1)) - RADIUS) / WIDTH)


def read(path):
    """Points and tetrahedra of a Medit text file."""
    words = open(path).read().split()

    def section(name, width, kind):
        at = words.index(name)
        n = int(words[at + 1])
        flat = np.array(words[at + 2:at + 2 + n * width], kind)
        return flat.reshape(n, width)[:, :-1]

    return section("Vertices", 4, float), section("Tetrahedra", 5, int) - 1


def error_of(point, tet):
    random = np.random.default_rng(1)
    corner = point[tet]
    value = front(corner)
    volume = np.abs(np.linalg.det(corner[:, 1:] - corner[:, :1])) / 6
    square = np.zeros(len(tet))
    for _ in range(POINTS):
        weight = random.dirichlet([1, 1, 1, 1], len(tet))
        at = np.einsum("ij,ijk->ik", weight, corner)
        square += (front(at) - (weight * value).sum(1)) ** 2 / POINTS
    return math.sqrt((volume * square).sum())


def write_solution(path, point):
    with open(path, "w") as out:
        out.write("MeshVersionFormatted 2 Dimension 3\nSolAtVertices\n"
                  f"{len(point)}\n1 1\n")
        out.writelines(f"{v:.17g}\n" for v in front(point))
        out.write("End\n")


def main():
    arguments = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    arguments.add_argument("--vanguard", required=True)
    arguments.add_argument("folder")
    given = arguments.parse_args()
    os.makedirs(given.folder, exist_ok=True)
    program = os.path.abspath(given.vanguard)
    os.chdir(given.folder)

    def vanguard(*words):
        subprocess.run([program, *words], check=True,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    with open("adapt.deck", "w") as deck:
        deck.write("Adaptation\ngrowth surface_sizes remesh_surface\n"
                   "2 no yes\n")
    failures = 0
    print("  cells requested     made  error adapted  uniform  ratio  exponent")
    before = None
    for cells in (10000, 20000, 40000, 80000, 160000):
        vanguard("demo", "box", "--cells", str(cells), "--out", f"u{cells}")
        vanguard("mesh", "-q", "-p", f"u{cells}/box", "--write", "mesh", "--out", "m")
        uniform = error_of(*read("m/box.mesh"))
        for _ in range(CYCLES):
            point, tet = read("m/box.mesh")
            write_solution("m/box.sol", point)
            vanguard("metric", "-q", "m/box.sol", "--cells", str(cells),
                     "--out", "next.solb")
            vanguard("mesh", "-q", "-p", f"u{cells}/box", "--deck", "adapt.deck",
                     "--sizes", "next.solb", "--write", "mesh", "--out", "m")
        point, tet = read("m/box.mesh")
        error, exponent = error_of(point, tet), None
        if before:
            exponent = math.log(error / before[1]) / math.log(
                len(tet) / before[0])
        print(f"{cells:17} {len(tet):8} {error:14.5f} {uniform:8.5f} "
              f"{uniform / error:6.1f}  "
              + (f"{exponent:8.2f}" if exponent else "       -"), flush=True)
        failures += error > 0.1 * uniform
        before = (len(tet), error)
        if cells == 40000:
            middle = before
    total = math.log(before[1] / middle[1]) / math.log(before[0] / middle[0])
    failures += abs(total + 2 / 3) > 0.1
    print(f"exponent from 40,000 cells on: {total:.2f}, theory -0.67")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
