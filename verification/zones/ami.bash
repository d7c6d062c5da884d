# SPDX-License-Identifier: LGPL-3.0-or-later
# shellcheck shell=bash disable=SC2154
# The rotor of the example on a sliding interface: its zone turns by 0.4 radians
# in pimpleFoam, with the doubled interface as cyclicAMI. A flow of 1 m/s along x
# at a Reynolds number of 70 at the tips, laminar.

ami_fields() {
  rotor_fields
  # Patches of the type cyclicAMI need a condition of this name.
  sed -i 's/^    "\[yz\]-/    "rotor.*" { type cyclicAMI; }\n&/
          s/"blades.*" {.*/"blades.*" { type movingWallVelocity; value uniform (0 0 0); }/' 0/U
  sed -i 's/^    ".\*"/    "rotor.*" { type cyclicAMI; }\n    "(x-min|[yz]-.*|blades.*)"/' 0/p
}

ami_flow() {
  local side name

  dictionary system/controlDict <<END
application pimpleFoam;
startFrom startTime;
startTime 0;
stopAt endTime;
endTime 0.04;
deltaT 0.002;
writeInterval 20;
functions
{
$(for side in rotor rotor_back x-min x-max; do
    name=flow_${side//-/_}
    printf '%s { type surfaceFieldValue; libs (fieldFunctionObjects);
      regionType patch; name %s; operation sum; fields (phi);
      writeFields no; log no; }\n' "$name" "$side"
  done)
}
END
  dictionary system/fvSchemes <<'END'
ddtSchemes { default Euler; }
gradSchemes { default Gauss linear; }
divSchemes
{
    default none;
    div(phi,U) Gauss linearUpwind grad(U);
    div((nuEff*dev2(T(grad(U))))) Gauss linear;
}
laplacianSchemes { default Gauss linear limited 0.5; }
interpolationSchemes { default linear; }
snGradSchemes { default limited 0.5; }
END
  dictionary system/fvSolution <<'END'
solvers
{
    "(p|pcorr).*" { solver PCG; preconditioner DIC; tolerance 1e-9; relTol 0.001; }
    "U.*" { solver PBiCGStab; preconditioner DILU; tolerance 1e-10; relTol 0.01; }
}
PIMPLE { nOuterCorrectors 2; nCorrectors 2; nNonOrthogonalCorrectors 1; correctPhi yes; }
END
  dictionary constant/dynamicMeshDict <<'END'
dynamicFvMesh dynamicMotionSolverFvMesh;
motionSolverLibs (fvMotionSolvers);
motionSolver solidBody;
cellZone rotor;
solidBodyMotionFunction rotatingMotion;
origin (0.5 0.5 0.5);
axis (1 0 0);
omega 10;
END
}

# The least and the largest sum of the weights of a face, in the course of the
# rotation. At the start all are 1, since both sides have the same faces.
ami_weights() {
  grep -o 'sum(weights) min:[^ ]* max:[^ ]*' pimpleFoam.log |
    awk -F '[: ]' '{ n++; if (n == 1 || $3 < lo) lo = $3; if ($5 > hi) hi = $5 }
      END { printf "  sums of weights, %d times: %g to %g\n", n, lo, hi
            exit !(n > 20 && lo > 0.95 && hi < 1.05) }' ||
    bad "the weights of the interface"
}

# Sum of the fluxes through a patch at the end.
flux_of() { tail -n 1 "postProcessing/flow_$1"/0/surfaceFieldValue.dat | cut -f2; }

ami() {
  "$vanguard" demo rotor --cells 30000 --out demo_ami >/dev/null || bad "the demo"
  "$vanguard" mesh -q -p demo_ami/rotor --write b8.ugrid --out mesh_ami \
    >/dev/null || bad "vanguard mesh"
  "$vanguard" convert mesh_ami/rotor.b8.ugrid ami.openfoam --form foam \
    --double-interfaces rotor >/dev/null || bad "vanguard convert"
  cd ami.openfoam || return
  sound
  flow_settings 0.005
  ami_flow
  ami_fields
  run 600 pimpleFoam || return
  ami_weights
  awk -v a="$(flux_of rotor)" -v b="$(flux_of rotor_back)" \
    -v in_="$(flux_of x_min)" -v out="$(flux_of x_max)" 'BEGIN {
      printf "  flux in %g, out %g; through the sides of the interface %g, %g\n",
        in_, out, a, b
      d = (a + b) / in_; e = (in_ + out) / in_
      exit !(in_ < 0 && d * d < 1e-6 && e * e < 1e-6) }' ||
    bad "mass is lost"
}
