#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-3.0-or-later
"""Solver cases for a mesh of Vanguard: external flow with SU2 or OpenFOAM,
complete enough to start the solver. Needs the standard library only.

    vanguard mesh -p wing --cells mixed --write su2,foam --out results
    vanguard-solvers su2 results/wing.report.json --mach 0.3 --alpha 2 \\
        --reynolds 5e6 --length 1
    vanguard-solvers openfoam results/wing.report.json --alpha 2 --speed 50 \\
        --reynolds 5e6 --length 1

The conditions of the patches are those of the report. su2 writes STEM.cfg next
to STEM.su2; openfoam adds 0, constant and system to STEM.openfoam. Existing
files are kept. Settings of both are a start for a first iteration on a mesh
with layers at y+ 1; compare them with the manual of the solver.
"""
import argparse
import json
import math
import os
import re
import sys


class SolverError(Exception):
    """A case that cannot be written; the message says why."""


# --- patches -----------------------------------------------------------------

def word(patch):
    """The name of a patch in the files of SU2 and OpenFOAM."""
    name = re.sub(r"[^A-Za-z0-9_.-]", "_", patch["name"])
    return name or f"patch_{patch['id']}"


def kind(patch):
    """wall, slip, symmetry or far."""
    usm3d, fun3d = patch["usm3d"], patch["fun3d"]
    if usm3d in (4, 41, 44) or (fun3d or 0) in range(4000, 4111):
        return "wall"
    if usm3d in (5, 55) or fun3d == 3000:
        return "slip"
    if usm3d == 1 or (fun3d or 0) in range(6661, 6664):
        return "symmetry"
    if usm3d in (0, 3) or fun3d in (5000, 5025, 5050):
        return "far"
    raise SolverError(
        f"patch {patch['id']} ({patch['name']}) has the condition {usm3d} "
        f"(FUN3D {fun3d}), which is not one of external flow: wall 4, inviscid "
        "wall 5, symmetry 1, farfield 3; set it in the deck, or write the case "
        "of this flow yourself")


class Flow:
    """The free stream. alpha: angle of attack [degrees]; axis of lift z (or y).
    reynolds is based on `length`; area and length are in the unit of the
    mesh."""

    def __init__(self, reynolds, length, alpha=0.0, mach=0.3, speed=1.0,
                 area=1.0, lift="z", iterations=1000):
        if not (reynolds > 0 and length > 0 and area > 0 and speed > 0
                and mach > 0 and iterations >= 1 and lift in "yz"):
            raise SolverError("reynolds, length, area, speed, mach and "
                              "iterations must be positive, lift y or z")
        self.reynolds, self.length, self.alpha = reynolds, length, alpha
        self.mach, self.speed, self.area = mach, speed, area
        self.lift, self.iterations = lift, iterations

    def directions(self):
        """Unit vectors of drag and lift."""
        c, s = (f(math.radians(self.alpha)) for f in (math.cos, math.sin))
        if self.lift == "z":
            return (c, 0.0, s), (-s, 0.0, c)
        return (c, s, 0.0), (-s, c, 0.0)


class Mesh:
    """The report of a run, and the files next to it."""

    def __init__(self, report):
        end = ".report.json"
        if not report.endswith(end):
            raise SolverError(f"{report}: expected a file PROJECT{end}")
        try:
            with open(report) as f:
                self.report = json.load(f)
        except (OSError, ValueError) as error:
            raise SolverError(f"{report}: {error}") from None
        if not self.report.get("ok"):
            raise SolverError(f"{report}: this run has failed")
        self.stem = report[:-len(end)]
        self.title = self.report["title"]
        self.names = {"wall": [], "slip": [], "symmetry": [], "far": []}
        for patch in self.report["patches"]:
            if patch["faces"] and word(patch) not in self.names[kind(patch)]:
                self.names[kind(patch)].append(word(patch))


def _write(path, text):
    """Existing files are kept. Returns whether the file was written."""
    if os.path.exists(path):
        return False
    os.makedirs(os.path.dirname(path) or ".", exist_ok=True)
    with open(path, "w") as f:
        f.write(text)
    return True


# --- SU2 ---------------------------------------------------------------------

def su2(mesh, flow):
    """Write STEM.cfg; returns its path. STEM.su2 must exist."""
    path = mesh.stem + ".su2"
    if not os.path.exists(path):
        raise SolverError(f"{path} does not exist; mesh with --write su2")
    with open(path) as f:
        tags = [line.split("=")[1].strip() for line in f
                if line.startswith("MARKER_TAG")]
    known = [name for names in mesh.names.values() for name in names]
    if sorted(set(tags)) != sorted(known):
        raise SolverError(f"{path}: markers {sorted(tags)} are not the patches "
                          f"of the report, {sorted(known)}")
    cfg = mesh.stem + ".cfg"
    if not _write(cfg, _su2_text(mesh, flow)):
        raise SolverError(f"{cfg} exists and is not overwritten")
    return cfg


def _su2_text(mesh, flow):
    names = mesh.names
    viscous = bool(names["wall"])
    walls = names["wall"] + names["slip"]

    def markers(option, found, after=""):
        return [f"{option}= ( " + ", ".join(n + after for n in found) +
                " )"] if found else []

    lines = [
        f"% {mesh.title}: a first iteration, written by vanguard-solvers",
        f"SOLVER= {'RANS' if viscous else 'EULER'}",
        *(["KIND_TURB_MODEL= SA"] if viscous else []),
        f"MACH_NUMBER= {flow.mach:.10g}",
        f"AOA= {flow.alpha if flow.lift == 'z' else 0.0:.10g}",
        f"SIDESLIP_ANGLE= {0.0 if flow.lift == 'z' else flow.alpha:.10g}",
        "FREESTREAM_TEMPERATURE= 288.15",
        *([f"REYNOLDS_NUMBER= {flow.reynolds:.10g}",
           f"REYNOLDS_LENGTH= {flow.length:.10g}"] if viscous else []),
        f"REF_LENGTH= {flow.length:.10g}",
        f"REF_AREA= {flow.area:.10g}",
        *markers("MARKER_HEATFLUX", names["wall"], ", 0.0"),
        *markers("MARKER_EULER", names["slip"]),
        *markers("MARKER_SYM", names["symmetry"]),
        *markers("MARKER_FAR", names["far"]),
        *markers("MARKER_PLOTTING", walls),
        *markers("MARKER_MONITORING", walls),
        "NUM_METHOD_GRAD= WEIGHTED_LEAST_SQUARES",
        "CONV_NUM_METHOD_FLOW= ROE",
        "MUSCL_FLOW= YES",
        "SLOPE_LIMITER_FLOW= VENKATAKRISHNAN",
        "TIME_DISCRE_FLOW= EULER_IMPLICIT",
        *(["CONV_NUM_METHOD_TURB= SCALAR_UPWIND",
           "TIME_DISCRE_TURB= EULER_IMPLICIT"] if viscous else []),
        "CFL_NUMBER= 5.0",
        "LINEAR_SOLVER= FGMRES",
        "LINEAR_SOLVER_PREC= ILU",
        "LINEAR_SOLVER_ERROR= 1E-4",
        "LINEAR_SOLVER_ITER= 10",
        f"ITER= {flow.iterations}",
        f"MESH_FILENAME= {os.path.basename(mesh.stem)}.su2",
        "MESH_FORMAT= SU2",
        "OUTPUT_FILES= ( RESTART, PARAVIEW, SURFACE_PARAVIEW )"]
    return "\n".join(lines) + "\n"


# --- OpenFOAM ----------------------------------------------------------------

def openfoam(mesh, flow):
    """Complete STEM.openfoam for simpleFoam with the Spalart-Allmaras model;
    returns its path. The mesh must exist."""
    case = mesh.stem + ".openfoam"
    boundary = os.path.join(case, "constant", "polyMesh", "boundary")
    if not os.path.exists(boundary):
        raise SolverError(f"{case} has no mesh; mesh with --write foam")
    # Vanguard's own control files are the minimum for OpenFOAM's mesh tools.
    for name in ("controlDict", "fvSchemes", "fvSolution"):
        path = os.path.join(case, "system", name)
        if os.path.exists(path) and _is_minimal(path):
            os.remove(path)
    for name, text in _foam_files(mesh, flow, _foam_types(boundary)).items():
        _write(os.path.join(case, name), text)
    return case


def _is_minimal(path):
    """Whether this is Vanguard's control file, without anything for a solver."""
    with open(path, errors="replace") as f:
        return not re.search(r"\bfunctions\b|div\(phi,U\)|\bSIMPLE\b", f.read())


def _foam_types(path):
    """Type of each patch in the file boundary."""
    with open(path, errors="replace") as f:
        return dict(re.findall(r"(\S+)\s*\{\s*type\s+(\w+);", f.read()))


def _foam_files(mesh, flow, types):
    drag, lift = flow.directions()
    u = "({:.10g} {:.10g} {:.10g})".format(*(flow.speed * d for d in drag))
    nu = flow.speed * flow.length / flow.reynolds
    names = mesh.names

    def header(form, name):
        return (f"FoamFile {{ version 2.0; format ascii; class {form}; "
                f"object {name}; }}\n\n")

    def field(name, form, dimensions, value, wall, slip, far):
        text = {**{n: wall for n in names["wall"]},
                **{n: slip for n in names["slip"]},
                **{n: far for n in names["far"]},
                **{n: f"type {types[n]};" for n in names["symmetry"]}}
        patches = "".join(f"    {n} {{ {t} }}\n" for n, t in text.items())
        return (header(form, name) + f"dimensions {dimensions};\n"
                f"internalField uniform {value};\n"
                f"boundaryField\n{{\n{patches}}}\n")

    def scalar(name, dimensions, value, wall, far="freestream"):
        return field(name, "volScalarField", dimensions, f"{value:.10g}", wall,
                     "type zeroGradient;", f"type {far}; freestreamValue uniform "
                     f"{value:.10g}; value uniform {value:.10g};")

    def vector(values):
        return "({:.10g} {:.10g} {:.10g})".format(*values)

    walls = " ".join(names["wall"] + names["slip"])
    return {
        "0/U": field("U", "volVectorField", "[0 1 -1 0 0 0 0]", u,
                     "type noSlip;", "type slip;",
                     f"type freestreamVelocity; freestreamValue uniform {u}; "
                     f"value uniform {u};"),
        "0/p": scalar("p", "[0 2 -2 0 0 0 0]", 0.0, "type zeroGradient;",
                      "freestreamPressure"),
        "0/nut": scalar("nut", "[0 2 -1 0 0 0 0]", nu / 5,
                        "type nutUSpaldingWallFunction; value uniform 0;"),
        "0/nuTilda": scalar("nuTilda", "[0 2 -1 0 0 0 0]", 3 * nu,
                            "type fixedValue; value uniform 0;"),
        "constant/transportProperties":
            header("dictionary", "transportProperties") +
            f"transportModel Newtonian;\nnu {nu:.10g};\n",
        "constant/turbulenceProperties":
            header("dictionary", "turbulenceProperties") +
            "simulationType RAS;\nRAS { RASModel SpalartAllmaras; "
            "turbulence on; printCoeffs off; }\n",
        "system/controlDict": header("dictionary", "controlDict") + f"""\
application simpleFoam;
startFrom startTime;
startTime 0;
stopAt endTime;
endTime {flow.iterations};
deltaT 1;
writeControl timeStep;
writeInterval {flow.iterations};
purgeWrite 1;
writeFormat binary;
writePrecision 8;
runTimeModifiable true;
functions
{{
    forces
    {{
        type forceCoeffs; libs (forces); patches ({walls});
        writeControl timeStep; writeInterval 1;
        rho rhoInf; rhoInf 1; magUInf {flow.speed:.10g};
        lRef {flow.length:.10g}; Aref {flow.area:.10g};
        CofR (0 0 0); pitchAxis (0 1 0);
        dragDir {vector(drag)}; liftDir {vector(lift)};
    }}
}}
""",
        "system/fvSchemes": header("dictionary", "fvSchemes") + FV_SCHEMES,
        "system/fvSolution": header("dictionary", "fvSolution") + FV_SOLUTION}


FV_SCHEMES = """\
ddtSchemes { default steadyState; }
gradSchemes
{
    default Gauss linear;
    limited cellLimited Gauss linear 1;
    grad(U) $limited;
    grad(nuTilda) $limited;
}
divSchemes
{
    default none;
    div(phi,U) bounded Gauss linearUpwind limited;
    div(phi,nuTilda) bounded Gauss upwind;
    div((nuEff*dev2(T(grad(U))))) Gauss linear;
}
laplacianSchemes { default Gauss linear limited 0.33; }
interpolationSchemes { default linear; }
snGradSchemes { default limited 0.33; }
wallDist { method meshWave; }
"""

FV_SOLUTION = """\
solvers
{
    p
    {
        solver GAMG; smoother DICGaussSeidel;
        tolerance 1e-9; relTol 0.05; maxIter 100;
    }
    "(U|nuTilda)"
    {
        solver PBiCGStab; preconditioner DILU;
        tolerance 1e-12; relTol 0.05; maxIter 100;
    }
}
SIMPLE
{
    consistent yes; // SIMPLEC: cells of a thin layer move together
    nNonOrthogonalCorrectors 0;
    pRefCell 0;
    pRefValue 0;
}
relaxationFactors
{
    equations { U 0.8; nuTilda 0.7; }
}
"""


def main(words=None):
    p = argparse.ArgumentParser(
        description=__doc__.split("\n\n")[0],
        formatter_class=argparse.ArgumentDefaultsHelpFormatter)
    p.add_argument("solver", choices=("su2", "openfoam"))
    p.add_argument("report", help="PROJECT.report.json of the run")
    p.add_argument("--reynolds", type=float, required=True,
                   help="Reynolds number, based on --length")
    p.add_argument("--length", type=float, required=True,
                   help="reference length [unit of the mesh]")
    p.add_argument("--alpha", type=float, default=0.0,
                   help="angle of attack [degrees]")
    p.add_argument("--mach", type=float, default=0.3, help="su2: Mach number")
    p.add_argument("--speed", type=float, default=1.0,
                   help="openfoam: speed of the free stream [m/s]")
    p.add_argument("--area", type=float, default=1.0,
                   help="reference area [unit of the mesh, squared]")
    p.add_argument("--lift", choices=("y", "z"), default="z",
                   help="axis of lift at alpha 0")
    p.add_argument("--iterations", type=int, default=1000)
    a = vars(p.parse_args(words))
    write = {"su2": su2, "openfoam": openfoam}[a.pop("solver")]
    report = a.pop("report")
    try:
        print(write(Mesh(report), Flow(**a)))
        return 0
    except SolverError as error:
        print(f"vanguard-solvers: {error}", file=sys.stderr)
        return 1


if __name__ == "__main__":
    sys.exit(main())
