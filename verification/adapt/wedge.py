#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""The supersonic wedge by `vanguard adapt` and on uniform meshes, with OpenFOAM.

wedge.py --vanguard PROGRAM [--cycles N] [--sizes H,...] FOLDER

Errors are those of the mean pressure of the last 600 steps against the exact
solution, the mean of |p - p_exact| / p_behind: on the wedge by area, and in the domain by volume. A
uniform mesh with the error of the last adapted one would have as many cells as
the power law through the two finest uniform meshes says. Fails if that is less
than five times the cells of the adapted mesh. Needs rhoCentralFoam, numpy and
vtk; about ten minutes on one core.
"""
import argparse
import glob
import math
import os
import shutil
import subprocess
import sys

import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy

MACH, ANGLE, GAMMA = 2.5, math.radians(15), 1.4
EXAMPLE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..",
                       "examples", "adaptation", "wedge")


def shock():
    """Angle of the weak shock and pressure behind it (NACA report 1135, 1953,
    equations 128 and 138): bisection between the Mach angle and 60 degrees."""
    def turn(b):
        sine2 = (MACH * math.sin(b)) ** 2
        return 2 / math.tan(b) * (sine2 - 1) / (
            MACH ** 2 * (GAMMA + math.cos(2 * b)) + 2)

    low, high = math.asin(1 / MACH), math.radians(60)
    for _ in range(100):
        middle = (low + high) / 2
        low, high = (middle, high) if turn(middle) < math.tan(ANGLE) else (
            low, middle)
    normal2 = (MACH * math.sin(low)) ** 2
    return low, 1 + 2 * GAMMA / (GAMMA + 1) * (normal2 - 1)


def read(path, reader):
    reader.SetFileName(path)
    reader.Update()
    sizes = vtk.vtkCellSizeFilter()
    sizes.SetInputData(reader.GetOutput())
    sizes.Update()
    centres = vtk.vtkCellCenters()
    centres.SetInputData(sizes.GetOutput())
    centres.Update()
    data = sizes.GetOutput().GetCellData()
    return (vtk_to_numpy(centres.GetOutput().GetPoints().GetData()),
            vtk_to_numpy(data.GetArray("pMean")),
            lambda name: np.abs(vtk_to_numpy(data.GetArray(name))))


def errors(case):
    """Cells, error on the wedge, error in the domain."""
    angle, behind = shock()
    _, p, weight = read(glob.glob(case + "/VTK/*/boundary/wedge.vtp")[-1],
                        vtk.vtkXMLPolyDataReader())
    area = weight("Area")
    wall = (np.abs(p - behind) * area).sum() / area.sum() / behind
    x, p, weight = read(glob.glob(case + "/VTK/*/internal.vtu")[-1],
                        vtk.vtkXMLUnstructuredGridReader())
    exact = np.where(x[:, 1] < math.tan(angle) * x[:, 0], behind, 1)
    volume = weight("Volume")
    field = (np.abs(p - exact) * volume).sum() / volume.sum() / behind
    return len(p), wall, field


def row(name, case):
    made = errors(case)
    print(f"{name:>12} {made[0]:9} {made[1]:10.5f} {made[2]:10.5f}", flush=True)
    return made


def cells_of(uniform, error, which):
    """Cells of a uniform mesh with this error."""
    (n, e), (m, f) = [(u[0], u[which]) for u in sorted(uniform)[-2:]]
    slope = math.log(f / e) / math.log(m / n)
    return m * (error / f) ** (1 / slope)


def main():
    arguments = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    arguments.add_argument("--vanguard", required=True)
    arguments.add_argument("--cycles", type=int, default=3)
    arguments.add_argument("--sizes", default="0.05,0.032")
    arguments.add_argument("folder")
    given = arguments.parse_args()
    program = os.path.abspath(given.vanguard)
    shutil.copytree(EXAMPLE, given.folder, dirs_exist_ok=True)
    os.chdir(given.folder)
    subprocess.run([sys.executable, "wedge.py"], check=True)

    def adapt(out, cycles, *words):
        subprocess.run([program, "adapt", "wedge.deck", "-q", "--out", out,
                        "--cycles", str(cycles), *words], check=True,
                       stdout=subprocess.DEVNULL)

    print("        mesh     cells   on wedge   in domain")
    sizes = given.sizes.split(",")
    for h in sizes:
        adapt("uniform-" + h, 1, "--", "--surface-size", h, "--hmax", h)
    uniform = [row("h " + h, f"uniform-{h}/cycle-1/case") for h in sizes]
    adapt("adapted", given.cycles)
    for k in range(1, given.cycles + 1):
        last = row(f"cycle {k}", f"adapted/cycle-{k}/case")
    failed = 0
    for which, place in ((1, "on the wedge"), (2, "in the domain")):
        ratio = cells_of(uniform, last[which], which) / last[0]
        print(f"uniform meshes need {ratio:.1f} times the cells for the same "
              f"error {place}")
        failed |= ratio < 5
    return failed


if __name__ == "__main__":
    sys.exit(main())
