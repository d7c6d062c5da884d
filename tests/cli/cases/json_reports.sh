# SPDX-License-Identifier: LGPL-3.0-or-later
# What programs rely on: every exit status, and JSON reports, also of failures,
# that follow their schemas.
needs metis
command -v python3 >/dev/null || skip "python3 is not installed"
schemas=$here/../../share/schema
octahedron >octa.obj
head -n -1 octa.obj >open.obj
vanguard demo box --cells 2000 --out p
vanguard demo wing-half --cells 30000 --out p
vanguard demo sphere --cells 20000 --out p
vanguard demo aerofoil --cells 3000 --out p
cat >one.vtu <<'END'
<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian">
<UnstructuredGrid><Piece NumberOfPoints="1" NumberOfCells="0">
<PointData><DataArray type="Float64" Name="size" format="ascii">0.1
</DataArray></PointData>
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">
.5 .5 .5</DataArray></Points></Piece></UnstructuredGrid></VTKFile>
END
n=0

# reports KIND STATUS ARGS...: the JSON output becomes KIND.N.json.
reports() {
  kind=$1 expected=$2
  shift 2
  vanguard "$@"
  [ "$status" = "$expected" ] || fail "$*: exit status $status, not $expected"
  n=$((n + 1))
  cp out $kind.$n.json
}
box="mesh -q --json -p p/box"
# shellcheck disable=SC2086 # lists of words
{
reports report 0 $box --out one
reports report 2 $box --hmin 2 --out no
reports report 1 mesh -q --json -p nosuch.stl
reports report 1 mesh -q --json -p open.obj --farfield none
reports report 4 mesh -q --json -p p/wing-half --layer-count 5 --cells mixed \
  --max-top-ratio 1.001 --out wing
reports report 0 mesh -q --json -p p/sphere --decompose octree --subdomains 4 \
  --solver-parts 3 --timeline --out sphere
reports report 0 mesh -q --json -p octa.obj --remesh-surface yes --out octa \
  --farfield-lengths 4
reports check 0 check -q --json p/box.lb8.ugrid
reports check 0 check -q --json p/wing-half.lb8.ugrid --deck p/wing-half.deck
reports check 0 check -q --json one/box.b8.ugrid
reports check 0 check -q --json one/box.b8.ugrid --sizes one.vtu
reports check 0 check -q --json wing/wing-half.b8.ugrid
reports check 0 check -q --json octa.obj --against octa.obj
reports check 1 check -q --json open.obj --farfield none
reports check 1 check -q --json nosuch.stl
: >empty.stl
reports check 1 check -q --json empty.stl
reports report 0 mesh -q --json -p p/aerofoil --out foil
reports check 0 check -q --json p/aerofoil.dat --deck p/aerofoil.deck
}
# 2: wrong usage. Without a command to report on, nothing is on standard output.
for words in "mesh --no-such -p p/box" "mesh -p p/box --growth 0.5" \
  "check --json" "deck a b" "nosuch" "plan --json"; do
  # shellcheck disable=SC2086 # a list of words
  vanguard $words
  exits 2
  [ ! -s out ] || fail "output of $words"
done
grep -q '"complexity"' check.*.json || fail "no figures in the metric"
grep -q '"error_kind": "geometry"' report.*.json || fail "no kind geometry"
grep -q '"error_kind": "input"' check.*.json || fail "no kind input"
# The report file is the same document.
python3 -c 'import json, sys
a, b = (json.load(open(f)) for f in sys.argv[1:])
assert a.keys() == b.keys() and a["mesh"] == b["mesh"] and a["ok"]' \
  report.1.json one/box.report.json || fail "the report file differs"
for kind in report check; do
  python3 "$here/json_schema.py" "$schemas/$kind.schema.json" $kind.*.json >out
  status=$?
  [ $status != 77 ] || skip "python3-jsonschema is not installed"
  exits 0
done

# The checker notices a member without description, and a wrong type.
python3 - <<'END'
import json
report = json.load(open("check.8.json"))
report["shiny"] = 1
json.dump(report, open("new.json", "w"))
report["ok"] = "yes"
json.dump(report, open("wrong.json", "w"))
END
python3 "$here/json_schema.py" "$schemas/check.schema.json" new.json >out
status=$?
exits 1
says out ".shiny is not in"
python3 "$here/json_schema.py" "$schemas/check.schema.json" wrong.json >out
status=$?
exits 1
says out "['ok']"
