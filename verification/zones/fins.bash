# SPDX-License-Identifier: LGPL-3.0-or-later
# shellcheck shell=bash disable=SC2154
# A solid with fins, of the example, heated by 100 W, in a laminar flow of 1 m/s along
# x at a Reynolds number of 80: a region of OpenFOAM for each zone. Properties are
# constant, so that the flow does not depend on the temperature: simpleFoam makes it,
# and chtMultiRegionFoam keeps it (frozenFlow). With its own equations of flow,
# chtMultiRegionFoam of Debian's OpenFOAM 1912 diverges on tetrahedra: its function
# fvc::reconstruct is wrong there, see docs/guide/zones.md.

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

# The flow around the fins, in the folder flow: U, and phi, the volume that passes
# each face. The density is 1 kg/m3, so that the mass is the same number.
air_flow() {
  mkdir -p flow/constant && cp -r constant/air/polyMesh flow/constant || return
  cd flow || return
  dictionary 0/U volVectorField <<'END'
dimensions [0 1 -1 0 0 0 0];
internalField uniform (1 0 0);
boundaryField
{
    x-min { type fixedValue; value uniform (1 0 0); }
    x-max { type inletOutlet; inletValue uniform (0 0 0); value $internalField; }
    "[yz]-.*" { type slip; }
    air_to_fins { type noSlip; }
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
  flow_settings 0.005
  run 600 simpleFoam && residuals
  cd ..
}

air_fields() {
  cp flow/100/U 0/air/
  sed 's/^dimensions .*/dimensions [1 0 -1 0 0 0 0];/' flow/100/phi >0/air/phi
  pressure 0/air/p calculated
  pressure 0/air/p_rgh fixedValue
  dictionary 0/air/T volScalarField <<END
dimensions [0 0 0 1 0 0 0];
internalField uniform 300;
boundaryField
{
    x-min { type fixedValue; value uniform 300; }
    x-max { type zeroGradient; }
    "[yz]-.*" { type zeroGradient; }
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
    equationOfState { rho 1; }
    thermodynamics { Cp 100; Hf 0; }
    transport { mu 0.005; Pr 0.7; }
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
endTime 8;
deltaT 0.02;
writeInterval 300;
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
    outflow
    {
        type surfaceFieldValue;
        libs (fieldFunctionObjects);
        region air;
        regionType patch;
        name x-max;
        operation weightedAverage;
        weightField phi;
        fields (T);
        writeFields no;
        writeControl timeStep;
        writeInterval 25;
    }
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
  air_flow || return
  air_fields
  fins_fields
  air_settings
  fins_settings
  both_settings
  run 600 chtMultiRegionFoam || return
  # The last integral over the interface, from either side, and the temperature of
  # the outflow, which 1 kg/s with 100 J/(kg K) leave 1 K warmer.
  awk 'FNR == 1 { n++ } !/^#/ { last[n] = $NF }
       function near(x, to) { return x > .99 * to && x < 1.01 * to }
       END { print "  heat into the fluid, out of the solid: " last[1], last[2]
             print "  temperature of the outflow above that of the inflow: " \
               last[3] - 300
             exit !(near(last[1], 100) && near(-last[2], 100) &&
                    near(last[3] - 300, 1)) }' \
    postProcessing/air/heat/*/*.dat postProcessing/fins/*/*/*.dat \
    postProcessing/air/outflow/*/*.dat || bad "the heat is not 100 W"
}
