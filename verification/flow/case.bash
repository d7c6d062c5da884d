# SPDX-License-Identifier: LGPL-3.0-or-later
# shellcheck shell=bash disable=SC2154
# The settings of simpleFoam for a flow of speed 1 past a chord of 1: Spalart-Allmaras
# without trip (noft2), as OpenFOAM has it. The mesh is one chord wide.
reynolds=6e6 width=1 iterations=600

# dictionary FILE [CLASS]: a file of OpenFOAM with the entries of the input.
dictionary() {
  mkdir -p "$(dirname "$1")"
  printf 'FoamFile { version 2.0; format ascii; class %s; object %s; }\n' \
    "${2:-dictionary}" "$(basename "$1")" >"$1"
  cat >>"$1"
}

# field NAME CLASS DIMENSIONS VALUE: the entries of the input are those of patches.
# The planes are empty.
field() {
  { printf 'dimensions [%s];\ninternalField uniform %s;\nboundaryField\n{\n' "$3" "$4"
    printf '    "back|front" { type empty; }\n'
    cat
    printf '}\n'
  } | dictionary "0/$1" "$2"
}

# stream ALPHA_DEG: the components of a unit vector at this angle of attack.
stream() { awk -v a="$1" 'BEGIN { a *= atan2(0, -1) / 180
  printf "%.12g %.12g\n", cos(a), sin(a) }'; }

# external_fields COS SIN: a section in a uniform stream. At the farfield the flow
# enters with the values of the stream and leaves with those of the field; nuTilda of
# the stream is 3 nu, as in the reference.
external_fields() {
  local nu
  nu=$(awk -v r="$reynolds" 'BEGIN { printf "%.12g", 1 / r }')
  field U volVectorField '0 1 -1 0 0 0 0' "($1 $2 0)" <<END
    farfield { type freestreamVelocity; freestreamValue uniform ($1 $2 0); }
    ".*" { type noSlip; }
END
  field p volScalarField '0 2 -2 0 0 0 0' 0 <<'END'
    farfield { type freestreamPressure; freestreamValue uniform 0; }
    ".*" { type zeroGradient; }
END
  field nuTilda volScalarField '0 2 -1 0 0 0 0' "$(awk -v n="$nu" 'BEGIN { print 3 * n }')" <<'END'
    farfield { type freestream; freestreamValue $internalField; }
    ".*" { type fixedValue; value uniform 0; }
END
  field nut volScalarField '0 2 -1 0 0 0 0' "$(awk -v n="$nu" 'BEGIN { print 0.210438 * n }')" <<'END'
    farfield { type freestream; freestreamValue $internalField; }
    ".*" { type fixedValue; value uniform 0; }
END
  printf 'transportModel Newtonian;\nnu %s;\n' "$nu" |
    dictionary constant/transportProperties
  dictionary constant/turbulenceProperties <<'END'
simulationType RAS;
RAS { RASModel SpalartAllmaras; turbulence on; printCoeffs off; }
END
}

# schemes KIND: upwind, or linearUpwind of second order, for velocity and turbulence.
schemes() {
  local flow=upwind turbulence=upwind
  [ "$1" = upwind ] || flow='linearUpwind grad(U)' turbulence='limitedLinear 1'
  dictionary system/fvSchemes <<END
ddtSchemes { default steadyState; }
gradSchemes { default Gauss linear; }
divSchemes
{
    default none;
    div(phi,U) bounded Gauss $flow;
    div(phi,nuTilda) bounded Gauss $turbulence;
    div((nuEff*dev2(T(grad(U))))) Gauss linear;
}
laplacianSchemes { default Gauss linear corrected; }
interpolationSchemes { default linear; }
snGradSchemes { default corrected; }
wallDist { method meshWave; }
END
}

solvers() {
  dictionary system/fvSolution <<'END'
solvers
{
    "p|Phi"
    {
        solver GAMG; smoother DICGaussSeidel; tolerance 1e-12; relTol 0.05;
        nCellsInCoarsestLevel 50; maxIter 50;
    }
    "U|nuTilda" { solver PBiCGStab; preconditioner DILU; tolerance 1e-14; relTol 0.05; }
}
potentialFlow { nNonOrthogonalCorrectors 5; }
SIMPLE { consistent yes; nNonOrthogonalCorrectors 0; }
relaxationFactors { equations { U 0.9; nuTilda 0.8; } }
END
}

# control ITERATIONS PATCH COS SIN: and the coefficients of PATCH.
control() {
  dictionary system/controlDict <<END
application simpleFoam;
startFrom latestTime;
startTime 0;
stopAt endTime;
endTime $1;
deltaT 1;
writeInterval $1;
purgeWrite 1;
writePrecision 12;
functions
{
    forces
    {
        type forceCoeffs; libs (forces); log no;
        writeControl timeStep; writeInterval 1;
        patches ($2); rho rhoInf; rhoInf 1; magUInf 1; lRef 1; Aref $width;
        CofR (0.25 0 0); liftDir (-$4 $3 0); dragDir ($3 $4 0); pitchAxis (0 0 1);
    }
}
END
}
