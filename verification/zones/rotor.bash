# SPDX-License-Identifier: LGPL-3.0-or-later
# shellcheck shell=bash disable=SC2154
# A rotor in its zone, of the example: a flow of 1 m/s along x at a Reynolds
# number of 70 at the tips, laminar.

rotor_fields() {
  dictionary 0/U volVectorField <<'END'
dimensions [0 1 -1 0 0 0 0];
internalField uniform (1 0 0);
boundaryField
{
    x-min { type fixedValue; value uniform (1 0 0); }
    x-max { type inletOutlet; inletValue uniform (0 0 0); value $internalField; }
    "[yz]-.*" { type slip; }
    "blades.*" { type fixedValue; value uniform (0 0 0); }
}
END
  dictionary 0/p volScalarField <<'END'
dimensions [0 2 -2 0 0 0 0];
internalField uniform 0;
boundaryField
{
    x-max { type fixedValue; value uniform 0; }
    ".*" { type zeroGradient; }
}
END
}

# flow_settings NU [CORRECTORS [ITERATIONS]]: simpleFoam for a laminar flow, with
# 0 corrections of the pressure for cells that are not orthogonal, 100 iterations.
flow_settings() {
  printf 'transportModel Newtonian;\nnu %s;\n' "$1" |
    dictionary constant/transportProperties
  dictionary constant/turbulenceProperties <<<'simulationType laminar;'
  dictionary system/controlDict <<END
application simpleFoam;
startFrom startTime;
startTime 0;
stopAt endTime;
endTime ${3:-100};
deltaT 1;
writeInterval ${3:-100};
END
  dictionary system/fvSchemes <<'END'
ddtSchemes { default steadyState; }
gradSchemes { default Gauss linear; }
divSchemes
{
    default none;
    div(phi,U) bounded Gauss linearUpwind grad(U);
    div((nuEff*dev2(T(grad(U))))) Gauss linear;
}
laplacianSchemes { default Gauss linear limited 0.5; }
interpolationSchemes { default linear; }
snGradSchemes { default limited 0.5; }
END
  dictionary system/fvSolution <<END
solvers
{
    p { solver GAMG; smoother GaussSeidel; tolerance 1e-9; relTol 0.05; }
    U { solver PBiCGStab; preconditioner DILU; tolerance 1e-12; relTol 0.05; }
}
SIMPLE { consistent yes; nNonOrthogonalCorrectors ${2:-0}; }
relaxationFactors { equations { U 0.8; } }
END
}

# The name of each field with its initial residual in the first and in the last
# iteration, before corrections.
residuals() {
  awk '/^Time = / { split("", seen) }
       /Initial residual/ && !seen[$4]++ { sub(",", "", $8)
         if (!($4 in first)) first[$4] = $8; last[$4] = $8 }
       END { for (f in last) print f, first[f], last[f] }' simpleFoam.log |
    sed 's/,//g' | sort | tee residuals | sed 's/^/  residual of /'
  [ "$(wc -l <residuals)" = 4 ] || bad "the fields"
  awk '$3 > 1e-3 { exit 1 }' residuals || bad "the residuals are above 1e-3"
}

rotor() {
  "$vanguard" demo rotor --cells 30000 --out demo >/dev/null || bad "the demo"
  "$vanguard" mesh -q -p demo/rotor --write foam --out mesh >/dev/null ||
    bad "vanguard mesh"
  cd mesh/rotor.openfoam || return
  sound
  rotor_fields
  flow_settings 0.005
  # The file of docs/guide/zones.md.
  sed -n '/MRFProperties/,/^The steady/s/^    //p' "$here/../../docs/guide/zones.md" |
    dictionary constant/MRFProperties
  run 600 simpleFoam || return
  residuals
  # The speed of the blades, of which the tips are at the radius 0.22.
  awk '/blades/ { on = 1 } on && /^\(/ && NF == 3 {
         gsub(/[()]/, ""); v = sqrt($2 * $2 + $3 * $3); if (v > most) most = v }
       END { print "  largest speed of the blades: " most
             exit !(most > 1.9 && most < 2.2) }' 100/U ||
    bad "the blades do not turn"
}
