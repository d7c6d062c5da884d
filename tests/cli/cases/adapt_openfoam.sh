# SPDX-License-Identifier: LGPL-3.0-or-later
# The example of vanguard adapt with OpenFOAM, a few steps of it: two cycles,
# the second from the fields of the first.
command -v rhoCentralFoam >/dev/null || skip "OpenFOAM is not installed"
cp -r "$here/../../examples/adaptation/wedge/." .
python3 wedge.py
sed -i 's/2000/20/; s/1400/10/' case/system/controlDict

vanguard adapt wedge.deck --cycles 2
exits 0
says out "wedge:areaAverage(pMean)"
says adapt/cycle-2/case/log.mapFields "interpolating p"
says adapt/adapt.csv ',"wedge:areaAverage(pMean)"'
exists adapt/cycle-2/solution.vtu adapt/cycle-2/case/constant/polyMesh/points
awk -F, 'NR > 1 && !($11 > 1.5 && $11 < 3.5) { exit 1 }' adapt/adapt.csv ||
  fail "no pressure on the wedge"

# What the script refuses.
vanguard adapt wedge.deck --cycles 1 --out b -- --write lb8.ugrid
exits 1
says err "add foam to the setting write"
vanguard adapt wedge.deck --cycles 1 --out c --solver "openfoam.sh none"
exits 1
says err "none is no case: it has no folder system"
sed -i 's/rhoCentralFoam/noSuchFoam/' case/system/controlDict
vanguard adapt wedge.deck --cycles 1 --out d
exits 1
says err "openfoam.sh: noSuchFoam ended with status 127"
