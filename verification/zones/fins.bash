# SPDX-License-Identifier: LGPL-3.0-or-later
# shellcheck shell=bash disable=SC2154
# A solid with fins, of the example, heated by 100 W, in a fluid at rest, whose box is
# kept at 300 K: a region of OpenFOAM for each zone. Solid and fluid are of no real
# material: heat spreads so fast that it leaves them as it comes after four seconds.

# coupled NAME KIND: the condition of temperature at the interface of a region.
coupled() {
  cat <<END
    $1
    {
        type compressible::turbulentTemperatureCoupledBaffleMixed;
        Tnbr T;
        kappaMethod $2;
        value uniform 300;
    }
END
}

# pressure FILE KIND: a field of pressure with one condition.
pressure() {
  dictionary "$1" volScalarField <<END
dimensions [1 -1 -2 0 0 0 0];
internalField uniform 1e5;
boundaryField { ".*" { type $2; value uniform 1e5; } }
END
}

air_fields() {
  dictionary 0/air/U volVectorField <<'END'
dimensions [0 1 -1 0 0 0 0];
internalField uniform (0 0 0);
boundaryField { ".*" { type noSlip; } }
END
  pressure 0/air/p calculated
  pressure 0/air/p_rgh fixedValue
  dictionary 0/air/T volScalarField <<END
dimensions [0 0 0 1 0 0 0];
internalField uniform 300;
boundaryField
{
    "[xyz]-.*" { type fixedValue; value uniform 300; }
$(coupled air_to_fins fluidThermo)
}
END
}

fins_fields() {
  dictionary 0/fins/T volScalarField <<END
dimensions [0 0 0 1 0 0 0];
internalField uniform 300;
boundaryField
{
$(coupled fins_to_air solidThermo)
}
END
  pressure 0/fins/p calculated
}

air_settings() {
  dictionary constant/g uniformDimensionedVectorField <<'END'
dimensions [0 1 -2 0 0 0 0];
value (0 0 0);
END
  dictionary constant/air/turbulenceProperties <<<'simulationType laminar;'
  dictionary constant/air/thermophysicalProperties <<'END'
thermoType
{
    type heRhoThermo; mixture pureMixture; transport const; thermo hConst;
    equationOfState rhoConst; specie specie; energy sensibleEnthalpy;
}
mixture
{
    specie { molWeight 28.9; }
    equationOfState { rho 0.1; }
    thermodynamics { Cp 1000; Hf 0; }
    transport { mu 0.02; Pr 1; }
}
END
  dictionary system/air/fvSchemes <<'END'
ddtSchemes { default Euler; }
gradSchemes { default Gauss linear; }
divSchemes
{
    default none;
    div(phi,K) Gauss linear;
    div(phi,h) Gauss upwind;
}
laplacianSchemes { default Gauss linear limited 0.5; }
interpolationSchemes { default linear; }
snGradSchemes { default limited 0.5; }
END
  dictionary system/air/fvSolution <<'END'
solvers
{
    "h.*" { solver PBiCGStab; preconditioner DILU; tolerance 1e-10; relTol 0; }
}
PIMPLE { frozenFlow yes; nNonOrthogonalCorrectors 0; }
END
}

fins_settings() {
  dictionary constant/fins/thermophysicalProperties <<'END'
thermoType
{
    type heSolidThermo; mixture pureMixture; transport constIso; thermo hConst;
    equationOfState rhoConst; specie specie; energy sensibleEnthalpy;
}
mixture
{
    specie { molWeight 27; }
    transport { kappa 50; }
    thermodynamics { Hf 0; Cp 90; }
    equationOfState { rho 1; }
}
END
  dictionary constant/fins/fvOptions <<'END'
heat
{
    type scalarSemiImplicitSource;
    selectionMode all;
    volumeMode absolute;
    injectionRateSuSp { h (100 0); }
}
END
  dictionary system/fins/fvSchemes <<'END'
ddtSchemes { default Euler; }
gradSchemes { default Gauss linear; }
divSchemes { default none; }
laplacianSchemes { default none; laplacian(alpha,h) Gauss linear limited 0.5; }
interpolationSchemes { default linear; }
snGradSchemes { default limited 0.5; }
END
  dictionary system/fins/fvSolution <<'END'
solvers { "h.*" { solver PCG; preconditioner DIC; tolerance 1e-12; relTol 0; } }
PIMPLE { nNonOrthogonalCorrectors 0; }
END
}

both_settings() {
  dictionary constant/regionProperties <<<'regions ( fluid (air) solid (fins) );'
  dictionary system/fvSchemes </dev/null
  dictionary system/fvSolution <<<'PIMPLE { nOuterCorrectors 1; }'
  dictionary system/controlDict <<'END'
application chtMultiRegionFoam;
startFrom startTime;
startTime 0;
stopAt endTime;
endTime 4;
deltaT 0.02;
writeInterval 200;
adjustTimeStep no;
functions
{
    heat
    {
        type wallHeatFlux;
        libs (fieldFunctionObjects);
        region air;
        patches (air_to_fins);
        writeControl timeStep;
        writeInterval 25;
    }
    heat_of_fins { $heat; region fins; patches (fins_to_air); }
}
END
}

fins() {
  "$vanguard" demo fins --cells 30000 --out demo >/dev/null || bad "the demo"
  sed -i 's/^fins  *0.*/&\nair 0.1 0.1 0.1 fluid auto/' demo/fins.deck
  "$vanguard" mesh -q -p demo/fins --write foam --out mesh >/dev/null ||
    bad "vanguard mesh"
  cd mesh/fins.openfoam || return
  sound
  run 60 splitMeshRegions -cellZones -overwrite || return
  sound -region air
  sound -region fins
  air_fields
  fins_fields
  air_settings
  fins_settings
  both_settings
  run 600 chtMultiRegionFoam || return
  # The last integral over the interface, from either side.
  awk 'FNR == 1 { n++ } !/^#/ { flux[n] = $NF }
       END { print "  heat into the fluid, out of the solid: " flux[1], flux[2]
             for (i in flux) if ((flux[i] < 0 ? -flux[i] : flux[i]) < 99 ||
                                 (flux[i] < 0 ? -flux[i] : flux[i]) > 101) bad = 1
             exit bad || n < 2 }' postProcessing/air/*/*/*.dat \
    postProcessing/fins/*/*/*.dat || bad "the heat is not 100 W"
}
