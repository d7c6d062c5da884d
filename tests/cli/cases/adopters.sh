# SPDX-License-Identifier: LGPL-3.0-or-later
# Examples for users of other projects, from geometry to a file that the client
# reads: CEASIOMpy (BREP parts to SU2), OpenVSP (.stp), ESP (.egads). gmsh unites
# the parts, and meshio reads the meshes, if they are installed.
export VANGUARD=$program
omitted=
python=
for try in python3 /usr/bin/python3; do
  ! "$try" -c 'import numpy' 2>/dev/null || { python=$try; break; }
done
[ -n "$python" ] || skip "numpy is not installed (python3-numpy)"
vanguard check "$here/../cad/box.step"
[ $status = 0 ] || skip "this build cannot read CAD"
reader=
for try in python3 /usr/bin/python3; do
  ! "$try" -c 'import meshio' 2>/dev/null || { reader=$try; break; }
done

# read_by_meshio FILE CELLS: meshio finds this many cells of three dimensions.
read_by_meshio() {
  [ -n "$reader" ] || { omitted="$omitted meshio"; return; }
  "$reader" - "$1" >out 2>err <<'END'
import meshio, sys
mesh = meshio.read(sys.argv[1])
print(sum(len(c.data) for c in mesh.cells
          if c.type in ("tetra", "wedge", "pyramid")), "cells")
END
  says out "$2 cells"
}

# cells REPORT: the number of cells of a run.
cells() {
  "$python" -c 'import json, sys
print(json.load(open(sys.argv[1]))["mesh"]["cells"])' "$1"
}

# --- CEASIOMpy: overlapping solids ---
if ! command -v gmsh >/dev/null; then
  omitted="$omitted gmsh"
else
  mkdir parts
  part() {
    printf 'SetFactory("OpenCASCADE");\n%s\n' "$2" >part.geo
    gmsh part.geo -0 -v 2 -o "parts/$1.brep" >gmsh.log 2>&1
  }
  part Fuselage1 'Cylinder(1) = {-2, 0, 0, 6, 0, 0, 0.5};'
  part Wing1 'Box(1) = {0, 0, -0.1, 1.2, 3, 0.2};'
  part Wing1_mirrored 'Box(1) = {0, -3, -0.1, 1.2, 3, 0.2};'
  exists parts/Wing1_mirrored.brep
  "$python" "$here/../../examples/ceasiompy/rans_mesh.py" parts rans \
    --reynolds 1e6 --length 1.2 --farfield 4 --set surface_size=0.4 \
    --set y_plus=0 --set first=0.01 --set layer_count=3 --set reynolds=0 \
    --set reference_length=0 --set surface_tolerance=0.01 --set growth=1.5 \
    >out 2>err
  status=$?
  exits 0
  says out "rans/aircraft.su2: markers"
  grep MARKER_TAG rans/aircraft.su2 | sort >tags
  is tags <<'END'
MARKER_TAG= Farfield
MARKER_TAG= Fuselage1
MARKER_TAG= Wing1
MARKER_TAG= Wing1_mirrored
END
  # The faces of a marker lie where its part does.
  "$python" - rans/aircraft.su2 <<'END' || fail "faces of other parts"
import sys
import numpy as np
lines = open(sys.argv[1]).read().splitlines()
at = next(i for i, l in enumerate(lines) if l.startswith("NPOIN="))
n = int(lines[at].split("=")[1].split()[0])
x = np.array([l.split()[:3] for l in lines[at + 1:at + 1 + n]], float)
used = {}
for i, l in enumerate(lines):
    if l.startswith("MARKER_TAG="):
        k = int(lines[i + 1].split("=")[1])
        ids = {int(v) for f in lines[i + 2:i + 2 + k] for v in f.split()[1:]}
        used[l.split()[1]] = x[sorted(ids)]
assert used["Wing1"][:, 1].min() > 0.4 and used["Wing1"][:, 1].max() > 2.99
assert used["Wing1_mirrored"][:, 1].max() < -0.4
assert abs(used["Fuselage1"][:, 1]).max() < 0.51
assert np.linalg.norm(used["Farfield"], axis=1).min() > 10
END
  read_by_meshio rans/aircraft.su2 "$(cells rans/aircraft.report.json)"
  "$python" "$here/../../examples/ceasiompy/rans_mesh.py" empty rans \
    --reynolds 1e6 --length 1 >out 2>err
  status=$?
  exits 1
  says err "no .brep in empty"
fi

# --- OpenVSP: a STEP file with the suffix .stp; sharp and blunt trailing edges
# are kept as feature curves ---
cp "$here/../cad/wing.step" wing.stp
vanguard mesh -q -p wing.stp --half y --layers yes --first 0.05 \
  --layer-count 4 --cells mixed --write su2 --out vsp --farfield-lengths 4 \
  --surface-size 80 --edges-per-turn 8 --surface-tolerance 2
exits 0
read_by_meshio vsp/wing.su2 "$(cells vsp/wing.report.json)"
"$python" - vsp/wing.report.json <<'END' || fail "feature curves are lost"
import json, sys
remesh = json.load(open(sys.argv[1]))["remesh"]
before, after = remesh["line_length"]
assert remesh["lines"] > 0 and abs(after - before) < 1e-3 * before
END

# --- ESP: an .egads file ---
vanguard mesh -q -p "$here/../cad/box.egads" --write b8.ugrid,su2 --out esp \
  --farfield-lengths 4 --surface-size 0.3
exits 0
read_by_meshio esp/box.su2 "$(cells esp/box.report.json)"
vanguard check -q esp/box.b8.ugrid
exits 0
[ -z "$omitted" ] || echo "omitted, not installed: $omitted"
