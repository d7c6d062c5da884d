# SPDX-License-Identifier: LGPL-3.0-or-later
# Viscous layers: which patches are walls, heights, limits, files, errors.
vanguard demo box --cells 2000 --out p
exits 0

# Walls given by a list. The report has tables, the JSON all figures.
vanguard mesh -q -p p/box --walls 5 --first 1e-3 --out one
exits 0
exists one/box.wall.vtu one/box.cogsg one/box.b8.ugrid
says out "validity: valid"
says out "requested        min       mean        max  error %"
lacks out "y+:"
vanguard mesh -q -p p/box --walls 5 --y-plus 1 --reynolds 1e5 \
  --reference-length 2 --json --threads 2 --out two
exits 0
for key in columns wall_triangles percent_full percent_any first_requested \
  first_error_percent levels growth y_plus fewer_by_cause proximity \
  columns_per_second cells_per_second limits_met seconds; do
  says out "\"$key\""
done
says out '"wall_by": "setting"'
says out '"limits_met": true'
says out "y+ 1 at Reynolds number 100000, based on the length 2: first height"
grep -q '"tetrahedra_if_subdivided": [1-9]' out || fail "no layer cells"

# The resolved deck repeats the run byte by byte, for any number of threads.
vanguard mesh -q -p p/box --deck two/box.resolved.deck --threads 1 --out again
exits 0
for suffix in b8.ugrid cogsg bc wall.vtu; do
  same two/box.$suffix again/box.$suffix
done
vanguard check -q two/box.cogsg
exits 0
says out "validity: valid"

# max_cells includes the cells of the layers, for both kinds of cells.
for kind in tets mixed; do
  vanguard mesh -q -p p/box --walls 5 --first 1e-3 --cells $kind --out all \
    --write b8.ugrid
  exits 0
  n_all=$(sed -n '/"mesh": {/,$p' all/box.report.json | sed -n \
    's/.*"cells": \([0-9]*\).*/\1/p' | head -1)
  vanguard mesh -q -p p/box --walls 5 --first 1e-3 --cells $kind --out just \
    --write b8.ugrid --max-cells "$n_all"
  exits 0
  vanguard mesh -q -p p/box --walls 5 --first 1e-3 --cells $kind --out over \
    --write b8.ugrid --max-cells $((n_all - 1))
  exits 1
  says err "the mesh has $n_all cells, "
  says err "of them in layers; $((n_all - 1)) are allowed (max_cells)"
  absent over/box.b8.ugrid
done
vanguard mesh -q -p p/box --walls 5 --first 1e-3 --out over --max-cells 100
exits 1
says err "the layers alone have"

# No layers grow unless requested; --layers no overrides everything.
vanguard mesh -q -p p/box --out plain
exits 0
absent plain/box.wall.vtu
vanguard mesh -q -p p/box --walls 5 --first 1e-3 --layers no --out no
exits 0
absent no/box.wall.vtu
same plain/box.b8.ugrid no/box.b8.ugrid

# A viscous condition without a first height grows no layers, but is reported.
sed 's/^5 *3 *3/5 4 4/' p/box.mapbc >viscous.mapbc
mkdir viscous
cp p/box.lb8.ugrid p/box.deck viscous
cp viscous.mapbc viscous/box.mapbc
vanguard mesh -q -p viscous/box --out v1
exits 0
says out "no layers grow on 1 viscous wall (patch 5), because no first height"
same plain/box.b8.ugrid v1/box.b8.ugrid
vanguard mesh -q -p viscous/box --first 1e-3 --out v2
exits 0
same one/box.b8.ugrid v2/box.b8.ugrid
says v2/box.report.json '"wall_by": "condition"'
vanguard mesh -q -p viscous/box --first 1e-3 --slip 5 --out v3
exits 1
says err "no patch is known to be a wall"

# A first height or a reference length in another unit is the first note.
vanguard mesh -q -p p/box --walls 5 --first 1e-9 --layer-count 3 --out tiny
says out "are both in the same unit?"
[[ $(grep -m1 note: out) = *"same unit?"* ]] || fail "not the first note"
vanguard mesh -q -p p/box --walls 5 --y-plus 1 --reynolds 5e6 \
  --reference-length 1e-3 --layer-count 3 --out tiny
[[ $(grep -m1 note: out) = *"is it in the unit of the surface?"* ]] ||
  fail "no first note about the reference length"
vanguard mesh -q -p p/box --walls 5 --first 1e-3 --out plausible
lacks out "is it in the unit of the surface"
lacks out "same unit"

# A first height above all edge lengths leaves no layer: a limit that is not
# met.
vanguard mesh -q -p p/box --walls 5 --first 10 --out high
exits 4
says out "(first height exceeds layer_end times the edge length)"
says err "patch 5 z-min: layers are requested, but the patch has no layers"

# Values for a single patch. A limit that cannot be met: all files are
# written, the patch is named, and the status is 4.
cp p/box.deck own.deck
printf '\nlayers\nid grow first min_full\n5 yes 3e-2 99\n6 yes - -\n' >>own.deck
vanguard mesh -q -p p/box --deck own.deck --first 2e-2 --layer-count 80 \
  --ratio 1.2 --out limit
exits 4
exists limit/box.b8.ugrid limit/box.wall.vtu limit/box.report.json
says err "limit not met: patch 5 z-min: min_full is 99 %, reached "
lacks err "patch 6"
says limit/box.report.json '"limits_met": false'
says limit/box.report.json '"limit": "min_full"'
vanguard mesh -q -p p/box --deck own.deck --first 1e-3 --out met
exits 0

# Typing errors and impossible requests.
refuse() { # TEXT OPTIONS...
  local text=$1
  shift
  vanguard mesh -q -p p/box --out refused "$@"
  exits "${wrong:-1}"
  says err "$text"
  absent refused/box.b8.ugrid
}
refuse "the first height is not known; give --first" --layers yes --walls 5
refuse "walls: the surface has no patch 77" --walls 77 --first 1
refuse "walls: the surface has no patch in the range 77-99" --walls 77-99 --first 1
wrong=2 refuse "'3-x' is not a list of patches" --walls 3-x --first 1
wrong=2 refuse "'3-1' is not a list of patches" --walls 3-1 --first 1
refuse "patch 5 is in both lists" --walls 5 --slip 4-6 --first 1
wrong=2 refuse "the first height, 0.1, exceeds layer_total, 0.01" --walls 5 \
  --first 0.1 --layer-total 0.01
wrong=2 refuse "y_plus requires reynolds" --walls 5 --y-plus 1
refuse "layers are requested, but no patch is known to be a wall" \
  --layers yes --first 1e-3
refuse "name the walls with --walls" --layers yes --first 1e-3
refuse "5 z-min (bc 3)" --layers yes --first 1e-3
refuse "are already higher than the total height 0.001" --walls 5 --first 1e-3 \
  --layer-count 10 --layer-total 1e-3
refuse "above layer_cap 1.3; request more layers" --walls 5 --first 1e-3 \
  --layer-count 3 --layer-total 0.1
refuse "a .cogsg can hold only tetrahedra" --walls 5 --first 1e-3 --cells mixed \
  --write cogsg
refuse "no VGRID source has a first height" --walls 5 --first 1e-3 \
  --layer-sources yes
printf 't\nlayers\nid first\n66 1e-3\n' >slip.deck
refuse "layers: the surface has no patch 66" --deck slip.deck --walls 5 \
  --first 1
printf 't\nwalls first\n5 1e-3\n\nlayers\nid grow\n5 no\n' >slip.deck
refuse "the table layers has grow no" --deck slip.deck
refuse "no patch is known to be a wall" --first 1e-3
# Of two options, neither replaces the other in silence.
for pair in "--first 1e-3 --y-plus 0" "--leaf-cells 1000 --bisections 2"; do
  # shellcheck disable=SC2086 # options and values
  vanguard mesh -q -p p/box $pair --out pair
  exits 2
  says err "are both given, and one would replace the other; give one"
done

# Without layers a limit could never be checked, so it is refused.
refuse "no patch is known to be a wall" --first 1e-3 --min-full 98
refuse "the first height is not known" --walls 5 --min-full 98
refuse "layers is no, but a limit on layers is set" --layers no --min-full 98
printf 't\nlayers\nid min_any\n5 98\n' >slip.deck
refuse "layers is no, but a limit on layers is set" --layers no --deck slip.deck
printf 't\nlayers\nid min_full\n6 98\n' >slip.deck
refuse "patch 6 has a limit on layers, but it is not a wall" --deck slip.deck --walls 5 \
  --first 1e-3
vanguard mesh -q -p p/box --first -1
exits 2
says err "first is -1; it must be at least 0"

# A whole domain without conditions: the user must name the walls.
mkdir bare
cp p/box.lb8.ugrid bare
vanguard mesh -q -p bare/box --farfield none --first 1e-3
exits 1
says err "no patch is known to be a wall"
vanguard mesh -q -p bare/box --farfield none --first 1e-3 --walls 5-5
exits 0
exists bare/box.wall.vtu

# Mixed cells: prisms, and no .cogsg by default.
vanguard mesh -q -p p/box --walls 5 --first 1e-3 --cells mixed --out mixed
exits 0
absent mixed/box.cogsg
exists mixed/box.b8.ugrid
says mixed/box.report.json '"prisms"'
grep -q '"prisms": [1-9]' mixed/box.report.json || fail "no prisms"
vanguard check -q mixed/box.b8.ugrid
exits 0
says out "validity: valid"

# Hexahedra on quadrilaterals of the wall: the same columns as with prisms, the same
# bytes for any number of threads, and no .cogsg.
thick="--walls 5 --first 0.02 --layer-count 8 --leaf-cells 1000"
vanguard mesh -q -p p/box $thick --cells mixed --out prisms
exits 0
parts='--solver-parts 3'
[[ $("$program" --version --verbose) =~ METIS\ +not\ in ]] && parts=
# shellcheck disable=SC2086 # a list of words
vanguard mesh -q -p p/box $thick --cells hex --threads 1 --out hex \
  --write b8.ugrid,foam,vtu $parts
exits 0
says out "% of the area of the walls; layer cells per point:"
says hex/box.report.html "wall area in quadrilaterals"
grep -q '"hexahedra": [1-9]' hex/box.report.json || fail "no hexahedra"
grep -q '"percent_wall_quadrilaterals": [1-9]' hex/box.report.json ||
  fail "no quadrilaterals"
for c in prisms hex; do   # locations and quality of the field; not its numbers
  sed -n '/^  "field": {/,/^  }/p' $c/box.report.json | grep -v '"cell": ' >$c.field
done
same prisms.field hex.field
vanguard check -q hex/box.b8.ugrid
exits 0
says out "validity: valid"
vanguard mesh -q -p p/box $thick --cells hex --threads 2 --out hex2
exits 0
same hex/box.b8.ugrid hex2/box.b8.ugrid
refuse "but cells is hex" $thick --cells hex --write cogsg

# The tail of a .ugrid is one integer.
vanguard mesh -q -p p/box --walls 5 --first 1e-3 --ugrid-tail yes --out tail
exits 0
[ $(($(stat -c %s tail/box.b8.ugrid) - $(stat -c %s one/box.b8.ugrid))) = 4 ] ||
  fail "the tail is not 4 bytes"

# An OpenFOAM case next to the other files replaces an earlier one.
for try in 1 2; do
  vanguard mesh -q -p p/box --walls 5 --first 1e-3 --cells mixed --out foam \
    --write foam,b8.ugrid
  exits 0
done
exists foam/box.openfoam/constant/polyMesh/owner foam/box.b8.ugrid
same foam/box.b8.ugrid mixed/box.b8.ugrid
[ "$(ls -A foam | grep -c '^\.')" = 0 ] || fail "a hidden folder is left behind"

# A first height in a unit other than that of the surface: no layers, and a
# question.
vanguard mesh -q -p p/box --walls 5 --first 100 --out huge
exits 4
says out "no layers on 1 of 1 walls (patch 5): the first height, 100"

# Without layers there are no shares to compare, and no limit is met.
for limit in min-full min-any min-height max-first-error max-top-ratio; do
  vanguard mesh -q -p p/box --walls 5 --first 100 --$limit 50 --out huge
  exits 4
  says err "limit not met: patch 5 z-min: ${limit//-/_} is 50"
  says err ", but the patch has no layers"
done
says huge/box.report.json '"percent_full": 0.0'
grep -q '"bare_faces": [1-9]' huge/box.report.json || fail "no bare faces"
grep -q '"size": [1-9]' huge/box.report.json || fail "no cause size"
says huge/box.report.json '"got": null'
