# SPDX-License-Identifier: LGPL-3.0-or-later
# shellcheck shell=bash disable=SC2154
# A baffle with layers across the lower half of a duct, and a sheet with layers
# behind it: a laminar flow of 1 m/s along x at a Reynolds number of 50.

baffle_fields() {
  dictionary 0/U volVectorField <<'END'
dimensions [0 1 -1 0 0 0 0];
internalField uniform (1 0 0);
boundaryField
{
    w5 { type fixedValue; value uniform (1 0 0); }
    w6 { type inletOutlet; inletValue uniform (0 0 0); value $internalField; }
    "w[1-4]" { type slip; }
    "fin.*" { type noSlip; }
}
END
  dictionary 0/p volScalarField <<'END'
dimensions [0 2 -2 0 0 0 0];
internalField uniform 0;
boundaryField
{
    w6 { type fixedValue; value uniform 0; }
    ".*" { type zeroGradient; }
}
END
}

# The flow through the sheet, from the face zone; the pressure on both sides of
# the baffle.
baffle_functions() {
  cat >>system/controlDict <<'END'
functions
{
    through
    {
        type surfaceFieldValue; libs (fieldFunctionObjects);
        writeControl timeStep; writeInterval 1; log false; writeFields false;
        regionType faceZone; name disk; operation sum; fields (phi);
    }
    front
    {
        $through; regionType patch; name fin; operation areaAverage; fields (p);
    }
    back { $front; name fin_back; }
}
END
}

# last NAME: the last value of a function.
last() { tail -n 1 "postProcessing/$1/0/surfaceFieldValue.dat" | awk '{ print $2 }'; }

baffle() {
  # shellcheck source=tests/cli/duct.bash
  . "$here/../../tests/cli/duct.bash"
  duct baffle "fin 8 4  0.375 0 0  0 1 0  0 0 0.5" \
    "disk 8 8  0.625 0 0  0 1 0  0 0 1"
  "$vanguard" mesh -q baffle.stl --flow internal --baffles fin --sheets disk \
    --walls fin,disk --first 0.01 --layer-count 4 --cells mixed --hmax 0.08 \
    --write foam --out mesh >/dev/null || bad "vanguard mesh"
  cd mesh/baffle.openfoam || return
  sound
  baffle_fields
  flow_settings 0.02
  baffle_functions
  run 600 simpleFoam || return
  residuals
  # All of the 1 m3/s passes the sheet, and the baffle is in its way.
  echo "  flow through the sheet: $(last through); pressure on the baffle:" \
    "$(last front) and $(last back)"
  awk -v q="$(last through)" 'BEGIN { if (q < 0) q = -q
    exit !(q > 0.999 && q < 1.001) }' || bad "the flow through the sheet"
  awk -v a="$(last front)" -v b="$(last back)" 'BEGIN { d = a - b
    if (d < 0) d = -d; exit !(d > 1) }' || bad "the pressure on both sides"
}
