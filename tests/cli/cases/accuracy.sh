# SPDX-License-Identifier: LGPL-3.0-or-later
# Discretisation errors in the report of the check: layers of all kinds of cells
# on a plate, walls by setting, meshes without walls, invalid meshes.
command -v python3 >/dev/null || skip "python3 is not installed"
schemas=$here/../../share/schema
vanguard demo box --cells 4000 --out p
exits 0
for cells in tets mixed hex; do
  vanguard mesh -q -p p/box --walls 5 --first 2e-4 --ratio 1.2 --cells $cells \
    --write b8.ugrid --out $cells
  exits 0
  vanguard check -q --json $cells/box.b8.ugrid --walls 5 --accuracy
  exits 0
  cp out $cells.json
  vanguard check -q $cells/box.b8.ugrid --walls 5 --accuracy
  exits 0
  says out "wall profile: y+ is 1 at 0.0002; "
  says out "structured plate"
  says out "patch 5"
done
python3 - <<'END' || fail "errors out of range"
import json

for name in "tets", "mixed", "hex":
    report = json.load(open(name + ".json"))["accuracy"]
    for kind in "points", "cells":
        for row in report[kind]["fields"]:
            if row["field"] == "degree 1":
                for scheme in "least_squares", "weighted_least_squares":
                    assert row["errors"][scheme]["max"] < 1e-10, row
        assert report[kind]["deficient_stencils"] == 0
    layers = [row for row in report["points"]["fields"]
              if row["field"] == "wall profile"
              and row["zone"] == "y+ 0 to 1000"][0]
    got = layers["errors"]["weighted_least_squares"]["l2"]
    plate = report["structured"][0]["points"]["weighted_least_squares"]["l2"]
    # The plate is flat, so that points have the errors of the structured mesh
    # but for the irregular cells above the layers.
    assert got < 1.3 * plate, (name, got, plate)
END

# The settings of the call scale y+: the height of y+ 1, or the flow.
vanguard check -q hex/box.b8.ugrid --walls 5 --accuracy --first 4e-4
exits 0
says out "wall profile: y+ is 1 at 0.0004; "
vanguard check -q hex/box.b8.ugrid --walls 5 --accuracy --reynolds 1e5 \
  --reference-length 1
exits 0
cp out flow.txt
vanguard check -q hex/box.b8.ugrid --walls 5 --accuracy --reynolds 1e6 \
  --reference-length 1
exits 0
[ "$(grep "y+ is 1 at" out)" != "$(grep "y+ is 1 at" flow.txt)" ] ||
  fail "y+ does not depend on the Reynolds number"

# No walls: functions without walls only. No option: no errors.
vanguard check -q hex/box.b8.ugrid --accuracy
exits 0
says out "no walls: no wall profile"
vanguard check -q hex/box.b8.ugrid --walls 5
exits 0
if grep -q "accuracy" out; then fail "accuracy without request"; fi
vanguard check -q hex/box.b8.ugrid --walls 99 --accuracy
exits 1
says err "walls: "

# With a schema for the JSON.
python3 "$here/json_schema.py" "$schemas/check.schema.json" \
  hex.json >out
status=$?
[ $status = 77 ] || exits 0

# A length with a unit is converted, or needs the unit of the mesh.
vanguard check -q hex/box.b8.ugrid --walls 5 --accuracy --first 1mm --unit m
exits 0
says out "y+ is 1 at 0.001"
vanguard check -q hex/box.b8.ugrid --walls 5 --accuracy --first 1mm
exits 1
says err "first is a length with a unit, but the unit of the mesh is not known"

# A surface has no cells.
vanguard check -q p/box.lb8.ugrid --accuracy
exits 1
says err "needs a mesh with cells"
