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
        value \$internalField;
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

# flow_through REGION INFLOW OUTFLOW SPEED [SLIP]: the laminar flow, in the folder
# flow.REGION: U, and phi, the volume that passes each face. The density is 1 kg/m3,
# so that the mass is the same number. The patches SLIP have no friction.
flow_through() {
  mkdir -p "flow.$1/constant" && cp -r "constant/$1/polyMesh" "flow.$1/constant" ||
    return
  cd "flow.$1" || return
  dictionary 0/U volVectorField <<END
dimensions [0 1 -1 0 0 0 0];
internalField uniform ($4 0 0);
boundaryField
{
    ".*" { type noSlip; }
    "${5:-none}" { type slip; }
    $2 { type fixedValue; value uniform ($4 0 0); }
    $3 { type inletOutlet; inletValue uniform (0 0 0); value uniform ($4 0 0); }
}
END
  dictionary 0/p volScalarField <<END
dimensions [0 2 -2 0 0 0 0];
internalField uniform 0;
boundaryField
{
    ".*" { type zeroGradient; }
    $3 { type fixedValue; value uniform 0; }
}
END
  flow_settings 0.005
  run 600 simpleFoam && residuals
  cd ..
}

# fluid REGION INFLOW KELVIN PRANDTL: its fields and settings, with the flow of
# flow_through.
fluid() {
  cp "flow.$1/100/U" "0/$1/"
  sed 's/^dimensions .*/dimensions [1 0 -1 0 0 0 0];/' "flow.$1/100/phi" >"0/$1/phi"
  pressure "0/$1/p" calculated
  pressure "0/$1/p_rgh" fixedValue
  dictionary "0/$1/T" volScalarField <<END
dimensions [0 0 0 1 0 0 0];
internalField uniform $3;
boundaryField
{
    ".*" { type zeroGradient; }
    $2 { type fixedValue; value uniform $3; }
$(coupled '".*_to_.*"' fluidThermo)
}
END
  dictionary "constant/$1/turbulenceProperties" <<<'simulationType laminar;'
  dictionary "constant/$1/thermophysicalProperties" <<END
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
    transport { mu 0.005; Pr $4; }
}
END
  dictionary "system/$1/fvSchemes" <<'END'
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
  dictionary "system/$1/fvSolution" <<'END'
solvers
{
    "h.*" { solver PBiCGStab; preconditioner DILU; tolerance 1e-10; relTol 0; }
}
PIMPLE { frozenFlow yes; nNonOrthogonalCorrectors 0; }
END
}

# solid REGION KELVIN: its fields and settings.
solid() {
  dictionary "0/$1/T" volScalarField <<END
dimensions [0 0 0 1 0 0 0];
internalField uniform $2;
boundaryField
{
    ".*" { type zeroGradient; }
$(coupled '".*_to_.*"' solidThermo)
}
END
  pressure "0/$1/p" calculated
  dictionary "constant/$1/thermophysicalProperties" <<'END'
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
  dictionary "system/$1/fvSchemes" <<'END'
ddtSchemes { default Euler; }
gradSchemes { default Gauss linear; }
divSchemes { default none; }
laplacianSchemes { default none; laplacian(alpha,h) Gauss linear limited 0.5; }
interpolationSchemes { default linear; }
snGradSchemes { default limited 0.5; }
END
  dictionary "system/$1/fvSolution" <<'END'
solvers { "h.*" { solver PCG; preconditioner DIC; tolerance 1e-12; relTol 0; } }
PIMPLE { nNonOrthogonalCorrectors 0; }
END
}

# heat_at NAME REGION PATCH: an entry of controlDict that writes the heat through a
# wall.
heat_at() {
  cat <<END
    $1
    {
        type wallHeatFlux;
        libs (fieldFunctionObjects);
        region $2;
        patches ($3);
        writeControl timeStep;
        writeInterval 25;
    }
END
}

# outflow_at NAME REGION PATCH: entries that write the mean temperature of the mass
# that leaves, and the mass.
outflow_at() {
  local name=$1 operation=weightedAverage field=T
  for _ in 1 2; do
    cat <<END
    $name
    {
        type surfaceFieldValue;
        libs (fieldFunctionObjects);
        region $2;
        regionType patch;
        name $3;
        operation $operation;
        weightField phi;
        fields ($field);
        writeFields no;
        writeControl timeStep;
        writeInterval 25;
    }
END
    name=$1_mass operation=sum field=phi
  done
}

# all_regions "FLUIDS" "SOLIDS" END_S STEP_S: settings of all regions, with the
# entries of the input as functions.
all_regions() {
  dictionary constant/g uniformDimensionedVectorField <<'END'
dimensions [0 1 -2 0 0 0 0];
value (0 0 0);
END
  dictionary constant/regionProperties <<<"regions ( fluid ($1) solid ($2) );"
  dictionary system/fvSchemes </dev/null
  dictionary system/fvSolution <<<'PIMPLE { nOuterCorrectors 1; }'
  dictionary system/controlDict <<END
application chtMultiRegionFoam;
startFrom startTime;
startTime 0;
stopAt endTime;
endTime $3;
deltaT $4;
writeInterval 1000;
adjustTimeStep no;
functions
{
$(cat)
}
END
}

# last_values FILE...: the last number of each file, in one line.
last_values() { awk 'FNR == 1 { n++ } !/^#/ { last[n] = $NF }
  END { for (i = 1; i <= n; i++) printf "%s ", last[i]; print "" }' "$@"; }

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
  flow_through air x-min x-max 1 '[yz]-.*' || return
  fluid air x-min 300 0.7
  solid fins 300
  dictionary constant/fins/fvOptions <<'END'
heat
{
    type scalarSemiImplicitSource;
    selectionMode all;
    volumeMode absolute;
    injectionRateSuSp { h (100 0); }
}
END
  { heat_at heat_of_air air air_to_fins
    heat_at heat_of_fins fins fins_to_air
    outflow_at outflow air x-max
  } | all_regions air fins 8 0.02
  run 600 chtMultiRegionFoam || return
  # 1 kg/s with 100 J/(kg K) become 1 K warmer by 100 W.
  last_values postProcessing/{air/heat_of_air,fins/heat_of_fins,air/outflow}/*/*.dat \
    >values
  awk 'function near(x, to) { return x > .99 * to && x < 1.01 * to }
       { print "  heat into the fluid, out of the solid: " $1, $2
         print "  temperature of the outflow above that of the inflow: " $3 - 300
         exit !(near($1, 100) && near(-$2, 100) && near($3 - 300, 1)) }' values ||
    bad "the heat is not 100 W"
}
