#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-2-Clause
"""CEASIOMpy's step from the parts of an aircraft to a RANS mesh: a folder of BREP
files in, an SU2 mesh out, whose markers are the names of the files and Farfield.

    rans_mesh.py PARTS OUT --y-plus 1 --reynolds 8e6 --length 3.5

PARTS/NAME.brep is one solid, such as those that CEASIOMpy exports from CPACS for
fuselages, wings and pylons; the solids overlap. The program gmsh unites them
(Open CASCADE), and Vanguard meshes the union: the surface with all points on the
CAD faces, the viscous layers and the volume. This replaces gmsh's surface mesh,
Pentagrow and TetGen. OUT gets aircraft.su2, the report and the intermediate
files. --set NAME=VALUE passes further settings of the run deck.

A face of the union belongs to the part that its points are nearest to.
"""
import argparse
import glob
import json
import os
import shutil
import subprocess
import sys

import numpy as np


def run(*words):
    """Run a program; its last line of error output is the message."""
    try:
        ran = subprocess.run(words, capture_output=True, text=True)
    except FileNotFoundError:
        sys.exit(f"rans_mesh: {words[0]} is not installed")
    if ran.returncode not in (0, 4):   # 4: a limit on the layers is not met
        lines = (ran.stderr or ran.stdout).strip().splitlines() or [""]
        sys.exit(f"rans_mesh: {os.path.basename(words[0])}: {lines[-1]}")
    return ran.stdout


def unite(parts, out):
    """Unite the solids with gmsh; returns the path of the BREP file."""
    lines = ['SetFactory("OpenCASCADE");']
    for i, part in enumerate(parts):
        lines.append(f'v{i}() = ShapeFromFile("{os.path.abspath(part)}");')
    if len(parts) > 1:
        rest = ", ".join(f"v{i}()" for i in range(1, len(parts)))
        lines.append("BooleanUnion{ Volume{v0()}; Delete; }"
                     f"{{ Volume{{{rest}}}; Delete; }}")
    script = os.path.join(out, "unite.geo")
    with open(script, "w") as f:
        f.write("\n".join(lines) + "\n")
    path = os.path.join(out, "aircraft.brep")
    run("gmsh", script, "-0", "-v", "2", "-o", path)
    if not os.path.exists(path):
        sys.exit("rans_mesh: gmsh could not unite the parts")
    return path


def triangles(vanguard, path, out):
    """Tessellation of a CAD file: triangles [n][3][3] and their patches [n]."""
    folder = os.path.join(out, "tessellation")
    stem = os.path.splitext(os.path.basename(path))[0]
    for old in glob.glob(os.path.join(folder, stem + ".*")):
        os.remove(old)
    run(vanguard, "surface", "-q", path, "--remesh-surface", "no", "--write",
        "tri", "--out", folder)
    with open(os.path.join(folder, stem + ".tri")) as f:
        n_point, n_tri = (int(v) for v in f.readline().split())
        values = np.array(f.read().split(), float)
    point = values[:3 * n_point].reshape(-1, 3)
    rest = values[3 * n_point:].astype(int)
    return point[rest[:3 * n_tri].reshape(-1, 3) - 1], rest[3 * n_tri:]


def distance(x, triangle):
    """Distance of the point x to the nearest of the triangles [n][3][3]."""
    a, edge = triangle[:, 0], np.roll(triangle, -1, axis=1) - triangle
    normal = np.cross(edge[:, 0], edge[:, 1])
    length = np.linalg.norm(normal, axis=1)
    good = length > 0
    unit = normal[good] / length[good, None]
    height = np.einsum("ij,ij->i", x - a[good], unit)
    foot = x - height[:, None] * unit
    inside = np.ones(good.sum(), bool)
    for k in range(3):
        side = np.cross(edge[good, k], foot - triangle[good, k])
        inside &= np.einsum("ij,ij->i", side, unit) >= 0
    best = np.abs(height[inside]).min(initial=np.inf)
    for k in range(3):   # the edges
        e = edge[:, k]
        t = np.einsum("ij,ij->i", x - triangle[:, k], e)
        t = np.clip(t / np.maximum(np.einsum("ij,ij->i", e, e), 1e-300), 0, 1)
        gap = x - triangle[:, k] - t[:, None] * e
        best = min(best, np.linalg.norm(gap, axis=1).min())
    return best


def owners(vanguard, union, parts, out):
    """The part of each patch of the union, as {patch: name}."""
    surface = {os.path.splitext(os.path.basename(p))[0]:
               triangles(vanguard, p, out)[0] for p in parts}
    triangle, patch = triangles(vanguard, union, out)
    area = np.linalg.norm(np.cross(triangle[:, 1] - triangle[:, 0],
                                   triangle[:, 2] - triangle[:, 0]), axis=1)
    found = {}
    for k in np.unique(patch):
        mine = np.flatnonzero(patch == k)
        most = mine[np.argsort(-area[mine])[:5]]   # the largest triangles
        sums = {name: sum(distance(triangle[i].mean(axis=0), t) for i in most)
                for name, t in surface.items()}
        found[int(k)] = min(sums, key=sums.get)
    return found


def rename(path, names):
    """Rename the markers of an SU2 mesh; those of the same name become one."""
    faces = {}
    fresh = path + ".new"
    with open(path) as old, open(fresh, "w") as new:
        for line in old:
            if line.startswith("NMARK="):
                break
            new.write(line)
        for line in old:
            if line.startswith("MARKER_TAG="):
                tag = line.split("=")[1].strip()
                into = faces.setdefault(names.get(tag, tag), [])
            elif not line.startswith("MARKER_ELEMS="):
                into.append(line)
        new.write(f"NMARK= {len(faces)}\n")
        for name, lines in faces.items():
            new.write(f"MARKER_TAG= {name}\nMARKER_ELEMS= {len(lines)}\n")
            new.writelines(lines)
    os.replace(fresh, path)
    return list(faces)


def settings(a):
    s = {"cells": "mixed", "write": "su2", "layers": "yes", "y_plus": a.y_plus,
         "reynolds": a.reynolds, "reference_length": a.length, "half": a.half}
    for pair in a.set:
        name, unused, text = pair.partition("=")
        try:
            s[name] = json.loads(text)
        except ValueError:
            s[name] = text
    return s


def main():
    p = argparse.ArgumentParser(
        description=__doc__.split("\n\n")[0],
        formatter_class=argparse.ArgumentDefaultsHelpFormatter)
    p.add_argument("parts", help="folder with one NAME.brep per part")
    p.add_argument("out", help="folder for the results")
    p.add_argument("--y-plus", type=float, default=1.0)
    p.add_argument("--reynolds", type=float, required=True,
                   help="Reynolds number, based on --length")
    p.add_argument("--length", type=float, required=True,
                   help="reference length [unit of the parts]")
    p.add_argument("--half", choices=("no", "y"), default="no",
                   help="y: the parts are one half of a symmetric aircraft")
    p.add_argument("--farfield", type=float, default=10.0,
                   help="radius of the farfield [lengths of the aircraft]")
    p.add_argument("--set", action="append", default=[], metavar="NAME=VALUE")
    a = p.parse_args()
    vanguard = os.environ.get("VANGUARD") or shutil.which("vanguard")
    parts = sorted(glob.glob(os.path.join(a.parts, "*.brep")))
    if not vanguard or not parts:
        sys.exit("rans_mesh: the program vanguard was not found; set VANGUARD"
                 if not vanguard else f"rans_mesh: no .brep in {a.parts}")
    os.makedirs(a.out, exist_ok=True)

    union = unite(parts, a.out)
    owner = owners(vanguard, union, parts, a.out)
    deck = os.path.join(a.out, "aircraft.deck")
    with open(deck, "w") as f:
        json.dump({"title": "Aircraft of " + ", ".join(sorted(set(
                       owner.values())))[:60], "settings": settings(a),
                   "farfield": {"kind": "sphere", "lengths": a.farfield},
                   "patches": [{"id": k, "bc": 4, "name": f"patch_{k}"}
                               for k in owner]}, f, indent=2)
    run(vanguard, "mesh", "-q", "-p", union, "--deck", deck, "--out", a.out)
    names = {f"patch_{k}": name for k, name in owner.items()}
    names["farfield"] = "Farfield"
    markers = rename(os.path.join(a.out, "aircraft.su2"), names)
    print(f"{os.path.join(a.out, 'aircraft.su2')}: markers", *markers)


if __name__ == "__main__":
    main()
