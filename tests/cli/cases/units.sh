# SPDX-License-Identifier: LGPL-3.0-or-later
# The unit of the mesh: declared, converted or not known; lengths with units give
# the same bytes as numbers in the unit of the mesh.

# ball FACTOR: an octahedron with corners at that distance
ball() { octahedron | awk -v f="$1" '$1 == "v" { $2 *= f; $3 *= f; $4 *= f } 1'; }
ball 1000 >mm.obj
ball 1 >m.obj

mesh() { vanguard mesh -q --write b8.ugrid --farfield-lengths 3 "$@"; }
remesh="--remesh-surface yes"
# shellcheck disable=SC2086
{
  mesh mm.obj $remesh --surface-size 300 --out number
  exits 0
  says out "unit of length                   not known"
  grep -q '"unit": null' number/mm.report.json || fail "a unit in JSON"
  for size in 300mm 30cm 0.3m 3e-4km; do
    mesh mm.obj $remesh --unit mm --surface-size $size --out "with"
    exits 0
    same number/mm.b8.ugrid with/mm.b8.ugrid
  done
  says out "the coordinates of mm.obj are taken to be in mm (unit)"
  says out "unit of length                   mm"
  grep -q '"unit": "mm"' with/mm.report.json || fail "no unit in JSON"

  # the resolved deck has numbers
  grep -q "km" with/mm.resolved.deck && fail "a unit in the resolved deck"
  mesh mm.obj --deck with/mm.resolved.deck --out again
  exits 0
  same number/mm.b8.ugrid again/mm.b8.ugrid

  # conversion
  mesh m.obj $remesh --surface-size 0.3 --out metres
  exits 0
  mesh mm.obj $remesh --file-unit mm --unit m --surface-size 300mm --out converted
  exits 0
  says out "were converted from mm (file_unit) to m (unit): its length 2000 \
becomes 2"
  same metres/m.b8.ugrid converted/mm.b8.ugrid

  # not known: both readings and the remedy
  mesh mm.obj $remesh --surface-size 300mm --out none
  exits 1
  says err "surface_size is 300mm, but the unit of the mesh is not known, since \
mm.obj states none: add --unit mm if its coordinates are in millimetres \
(surface_size is then 300), --unit m if they are in metres (0.3)"
  absent none/mm.b8.ugrid
}

# Tables and decks keep the unit, in both forms, whatever the order.
cat >table.deck <<'END'
lengths with units
hmin   unit  hmax
1mm    m     2.5m

farfield
kind   lengths x     y  z
sphere 3       10mm  0  -1e-2m

sources
kind   h0    x0     r0
sphere 50mm  1.2in  0.25foot
END
vanguard deck --deck table.deck --json
exits 0
cp out table.json.deck
says out '"hmin": "1mm"'
says out '"x0": "1.2inch"'
vanguard deck --deck table.json.deck
exits 0
says out "0.25foot"
echo '{ "settings": { "hmin": "30" } }' >number.deck
vanguard deck --deck number.deck
exits 1
says err 'settings.hmin: must be a number, or a string with a unit as in "30mm"'
sed -e 's/1mm /0.001/; s/2.5m/2.5/; s/10mm/0.01/; s/-1e-2m/-0.01/' \
  -e 's/50mm/0.05/; s/1.2in/0.03048/; s/0.25foot/0.0762/' table.deck >plain.deck
for deck in plain table table.json; do
  mesh m.obj --deck $deck.deck --out $deck
  exits 0
done
same plain/m.b8.ugrid table/m.b8.ugrid
same plain/m.b8.ugrid table.json/m.b8.ugrid

# Conditions between settings hold in the unit of the mesh.
mesh m.obj --unit m --hmin 30mm --hmax 0.02 --out none
exits 2
says err "hmin 0.03 is larger than hmax 0.02"
mesh m.obj --unit m --hmin 30mm --hmax 40 --out ok
exits 0

# values that are no lengths
for value in mm 30mmm 1e3.5m -1mm 30nm; do
  mesh m.obj --unit m --hmin "$value" --out none
  exits 2
  says err "hmin "
done
mesh m.obj --unit m --growth 2mm --out none
exits 2
says err "growth must be a number, not '2mm'"
mesh m.obj --unit m --hmin 12345678901mm --out none
exits 2
says err "at most 10 digits"

# scale does not change coordinates, and says so before the run
vanguard check -q mm.obj --scale 0.001
exits 0
says out "note: scale 0.001 multiplies target edge lengths, not coordinates: the \
surface keeps its length of 2000"
