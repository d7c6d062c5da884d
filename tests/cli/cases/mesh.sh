# SPDX-License-Identifier: LGPL-3.0-or-later
# A demo meshed: files, report, check, and the run repeated from its deck.
vanguard demo box --cells 3000 --out p
exits 0
exists p/box.lb8.ugrid p/box.mapbc p/box.deck
vanguard demo box --out p
exits 1
says err "exists and is not overwritten"

cp p/box.mapbc mapbc.before
vanguard mesh -p p/box
exits 0
exists p/box.cogsg p/box.bc p/box.b8.ugrid p/box.resolved.deck \
  p/box.report.json
same p/box.mapbc mapbc.before
says out "validity: valid"
says out "p/box.mapbc  (input, kept)"
says err "read"
[ "$(ls -A p | grep -c '^\.')" = 0 ] || fail "a hidden folder is left behind"
says p/box.report.json '"ok": true'
says p/box.report.json '"valid": true'

# --quiet shows no progress; --json prints the content of the report file.
vanguard mesh -q -p p/box --json --out json
exits 0
is err </dev/null
says out '"valid": true'

# The resolved deck repeats the run byte by byte, whatever the defaults.
vanguard mesh -q -p p/box --out tuned --growth 1.4 --hmax 0.2 \
  --write b8.ugrid,cogsg,vtu,fun3d.mapbc,meshb
exits 0
exists tuned/box.vtu tuned/box.surface.vtu tuned/box.fun3d.mapbc \
  tuned/box.meshb tuned/box.mapbc
vanguard mesh -q -p p/box --deck tuned/box.resolved.deck --out again
exits 0
for suffix in b8.ugrid cogsg bc mapbc vtu meshb resolved.deck; do
  same tuned/box.$suffix again/box.$suffix
done

# The same in place: the deck is an input then and is not overwritten.
(cd again && cp ../p/box.lb8.ugrid . && cp box.resolved.deck keep)
vanguard mesh -q -p again/box --deck again/box.resolved.deck
exits 0
same again/box.resolved.deck again/keep
same tuned/box.b8.ugrid again/box.b8.ugrid

vanguard check -q p/box.b8.ugrid
exits 0
says out "validity: valid"
says out "Smallest dihedral angle of each cell (degrees)"
says out "Worst cells"
vanguard check -q p/box.cogsg --json --deck p/box.resolved.deck
exits 0
says out '"valid": true'
says out '"percent_within"'
vanguard check -q p/box.lb8.ugrid
exits 0
says out "no defects"
says out "Flow within the given outer boundary"

vanguard mesh -q -p p/box --out limited --max-cells 100
exits 1
says err "raise the limit"
absent limited/box.b8.ugrid limited/box.cogsg

# The boundary of a volume mesh can be the input surface of another run.
mkdir volume
cp p/box.b8.ugrid volume/old.b8.ugrid
vanguard mesh -q -p volume/old.b8.ugrid --out anew
exits 0
says out "is a volume mesh: its boundary is used as the surface"
says out "6 patches have no boundary condition"
exists anew/old.b8.ugrid

# A cell count that the geometry does not allow is reported as such.
vanguard demo sphere --cells 1000 --out small
exits 0
says out "1,000 cells were requested, but the geometry needs more"
vanguard demo sphere --cells 100000 --out enough
exits 0
lacks out "asked for"
