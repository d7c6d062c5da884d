# SPDX-License-Identifier: LGPL-3.0-or-later
# shellcheck shell=bash disable=SC2154
# A passage of a turbine, of the example, between cyclic patches: a laminar flow
# that enters with 1 m/s along the axis, at a Reynolds number of 500.

passage_fields() {
  dictionary 0/U volVectorField <<'END'
dimensions [0 1 -1 0 0 0 0];
internalField uniform (1 0 0);
boundaryField
{
    inflow { type fixedValue; value uniform (1 0 0); }
    outflow { type inletOutlet; inletValue uniform (0 0 0); value $internalField; }
    "hub|casing|blade|tip" { type noSlip; }
    "lo|hi" { type cyclic; }
}
END
  dictionary 0/p volScalarField <<'END'
dimensions [0 2 -2 0 0 0 0];
internalField uniform 0;
boundaryField
{
    outflow { type fixedValue; value uniform 0; }
    "inflow|hub|casing|blade|tip" { type zeroGradient; }
    "lo|hi" { type cyclic; }
}
END
}

passage() {
  "$vanguard" demo passage --out demo >/dev/null || bad "the demo"
  "$vanguard" mesh -q -p demo/passage --cells mixed --write foam --out mesh \
    >/dev/null || bad "vanguard mesh"
  cd mesh/passage.openfoam || return
  sound
  passage_fields
  flow_settings 0.002 1 150
  run 3000 simpleFoam || return
  residuals
  # The blade turns the flow by more than half of the 45 degrees of its camber line,
  # in the mean over the outflow with its boundary layers. The middle of the outflow
  # is at the angle 1.1 / 2.8 about the axis.
  run 60 postProcess -func 'patchAverage(name=outflow,U)' -latestTime || return
  awk '!/^#/ { gsub(/[()]/, ""); x = $2; t = $3 * cos(1.1 / 2.8) - $4 * sin(1.1 / 2.8) }
       END { angle = atan2(t, x) * 180 / atan2(0, -1)
             print "  mean angle of the outflow (degrees): " angle
             exit !(angle > 25 && angle < 45) }' \
    postProcessing/patchAverage*/*/*.dat || bad "the flow is not turned"
}
