# SPDX-License-Identifier: LGPL-3.0-or-later
# Complete cases for SU2 and OpenFOAM: SU2's by its grammar and its markers,
# OpenFOAM's by a first iteration of simpleFoam, if it is installed.
command -v python3 >/dev/null || skip "python3 is not installed"
solvers=$here/../../share/drivers/vanguard_solvers.py
flow="--reynolds 1e6 --length 1 --alpha 2"
vanguard demo wing-half --cells 30000 --out in
vanguard mesh -q -p in/wing-half --cells mixed --scale 2 --layer-count 6 \
  --write su2 --out case
exits 0
octahedron >octa.obj
vanguard mesh -q -p octa.obj --remesh-surface yes --surface-size 0.2 \
  --farfield-lengths 4 --walls body --first 0.01 --layer-count 5 --cells mixed \
  --write foam --out case
exits 0

# --- SU2 ---
# shellcheck disable=SC2086 # a list of words
$solvers su2 case/wing-half.report.json $flow --mach 0.5 >out 2>err
status=$?
exits 0
is out <<'END'
case/wing-half.cfg
END
python3 - case/wing-half.cfg case/wing-half.su2 >out 2>&1 <<'END'
# SU2's grammar: comments, and OPTION= VALUE or OPTION= ( LIST ), each option once.
import re, sys
options = {}
for line in open(sys.argv[1]):
    line = line.split("%")[0].strip()
    if not line:
        continue
    m = re.fullmatch(r"([A-Z_]+)\s*=\s*(\( [^()]+ \)|[^\s(),]+)", line)
    assert m, line
    assert m[1] not in options, line
    value = m[2]
    options[m[1]] = (value.strip("() ").split(", ") if value[0] == "("
                     else value)
tags = [l.split("=")[1].strip() for l in open(sys.argv[2])
        if l.startswith("MARKER_TAG")]
given = options["MARKER_HEATFLUX"][::2] + options["MARKER_SYM"] + \
    options["MARKER_FAR"]
assert sorted(given) == sorted(tags), (given, tags)
assert set(options["MARKER_HEATFLUX"][1::2]) == {"0.0"}
assert set(options["MARKER_MONITORING"]) <= set(tags)
assert options["SOLVER"] == "RANS" and options["AOA"] == "2"
assert float(options["REYNOLDS_NUMBER"]) == 1e6
assert float(options["MACH_NUMBER"]) == 0.5
assert options["MESH_FILENAME"] == "wing-half.su2"
print("markers:", *sorted(tags))
END
status=$?
exits 0
says out "markers: "
# shellcheck disable=SC2086 # a list of words
$solvers su2 case/wing-half.report.json $flow >out 2>err
status=$?
exits 1
says err "wing-half.cfg exists and is not overwritten"

# --- conditions of internal flow; no mesh; a bad number ---
# shellcheck disable=SC2086 # a list of words
$solvers su2 case/octa.report.json $flow >out 2>err
says err "mesh with --write su2"
$solvers su2 case/wing-half.report.json --reynolds 0 --length 1 >out 2>err
says err "must be positive"
sed 's/"fun3d": 4000/"fun3d": 7011/; s/"usm3d": 4,/"usm3d": 1001,/' \
  case/wing-half.report.json >case/odd.report.json
# shellcheck disable=SC2086 # a list of words
$solvers su2 case/odd.report.json $flow >out 2>err
says err "has the condition 1001 (FUN3D 7011), which is not one of external"

# --- OpenFOAM ---
# shellcheck disable=SC2086 # a list of words
$solvers openfoam case/octa.report.json $flow --speed 50 --iterations 2 \
  >out 2>err
status=$?
exits 0
foam=case/octa.openfoam
exists $foam/0/{U,p,nut,nuTilda} $foam/system/{controlDict,fvSchemes,fvSolution} \
  $foam/constant/{transportProperties,turbulenceProperties}
says $foam/system/controlDict "simpleFoam"
says $foam/0/U "freestreamValue uniform (49.96954135 0 1.744974835)"
if ! command -v simpleFoam >/dev/null; then
  echo "simpleFoam is not installed: its first iteration is omitted"
else
  # shellcheck source=tests/cli/openfoam.bash
  . "$here/openfoam.bash"
  load_openfoam
  (cd $foam && checkMesh) >out 2>err
  says out "Mesh OK."
  (cd $foam && simpleFoam) >out 2>err
  status=$?
  exits 0
  says out "Time = 2"
  grep -q "Solving for nuTilda, Initial residual" out || fail "no turbulence"
  lacks out "nan"
  exists $foam/2/U
fi
