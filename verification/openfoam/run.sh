#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# verification/openfoam/run.sh: does OpenFOAM accept the meshes, and does a
# solver converge on them?
#
# usage: verification/openfoam/run.sh [--build DIR | --vanguard PROGRAM]
#            [--work DIR] [--cells tets|mixed|hex|both] [--iterations N]
#            [--project STEM | --case DIR] [--deck FILE] [--alpha DEGREES]
#            [--model SpalartAllmaras|kOmegaSST] [--data IGNORED]
#   --build       folder of a build, with bin/vanguard (default build/release)
#   --work        scratch folder, kept (default: a temporary one, removed)
#   --cells       cells of the layers (default both): mixed with y+ 1, checked
#                 and solved; the same with tets, checked; and tets with a first
#                 height for wall functions, checked and solved. hex: as mixed
#   --wall-first  that height (default 0.004)
#   --iterations  iterations of simpleFoam (default 300); 0: checkMesh only
#   --project     mesh this project (default: the demo wing-half), with the deck
#                 and conditions that `vanguard mesh -p` finds
#   --deck        settings for that project
#   --case        use an existing OpenFOAM mesh instead: a folder with
#                 constant/polyMesh, which is copied, checked and solved
#   --options     more options for `vanguard mesh`, one string
# Chord 1, speed 1 along x turned by alpha (default 2) towards z, Reynolds
# number 5 million (--reynolds).
# Exit status: 0 all checks passed, 1 a failure, 2 usage, 77 no OpenFOAM.
set -uo pipefail
export LC_ALL=C

here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
build=$root/build/release vanguard='' work='' cells=both iterations=300
project='' case='' deck='' options='' alpha=2 reynolds=5e6 wall_first=0.004
model=SpalartAllmaras
LIMIT_S=7200

usage() { sed -n '2,/^# Exit status/p' "$0" | sed 's/^# \{0,1\}//'; }

while [ $# -gt 0 ]; do
  case $1 in
    --build|--vanguard|--work|--cells|--iterations|--project|--case|--deck|\
    --options|--alpha|--reynolds|--model|--wall-first|--data)
      [ $# -gt 1 ] || { usage >&2; exit 2; }
      name=${1#--}
      [ "$name" = data ] || declare "${name//-/_}=$2"
      shift ;;
    -h|--help) usage; exit 0 ;;
    *) usage >&2; exit 2 ;;
  esac
  shift
done
case $cells in
  both) kinds='mixed tets tets-wall' ;;
  mixed|hex) kinds=$cells ;;
  tets) kinds='tets tets-wall' ;;
  *) usage >&2; exit 2 ;;
esac
case $model in
  SpalartAllmaras|kOmegaSST) ;;
  *) usage >&2; exit 2 ;;
esac
[ -z "$case" ] || kinds=given
[ -n "$vanguard" ] || vanguard=$build/bin/vanguard

# The environment of OpenFOAM: either set already, or that of Debian's package,
# whose script prints warnings about omitted parts.
if ! command -v checkMesh > /dev/null; then
  echo "SKIP: no OpenFOAM (checkMesh is not in PATH)"
  exit 77
fi
if [ -z "${WM_PROJECT_DIR:-}" ]; then
  set +u
  # shellcheck disable=SC1090
  . "${FOAM_BASHRC:-/usr/share/openfoam/etc/bashrc}" 2> /dev/null
  set -u
fi
if ! checkMesh -help > /dev/null 2>&1; then
  echo "SKIP: OpenFOAM does not start; source its etc/bashrc first"
  exit 77
fi
if [ -z "$case" ] && [ ! -x "$vanguard" ]; then
  echo "no program $vanguard: build it first" >&2
  exit 2
fi
if [ -z "$work" ]; then
  work=$(mktemp -d "${TMPDIR:-/tmp}/vanguard-foam.XXXXXX")
  trap 'rm -rf "$work"' EXIT
fi
mkdir -p "$work" || exit 2

failed=0
bad() { echo "  FAIL: $*"; failed=1; }

# --- the mesh ---

# Sets `mesh`, a folder with constant/polyMesh.
make_mesh() {
  local kind=$1 input=$project more=()
  if [ "$kind" = given ]; then
    mesh=$case
    return 0
  fi
  if [ -z "$input" ]; then
    input=$work/demo/wing-half
    [ -e "$input.deck" ] ||
      "$vanguard" demo -c 100000 -o "$work/demo" wing-half > "$work/log.demo" ||
      { bad "vanguard demo: $(tail -1 "$work/log.demo")"; return 1; }
  fi
  [ -z "$deck" ] || more+=(--deck "$deck")
  [ "$kind" != tets-wall ] || more+=(--first "$wall_first")
  # shellcheck disable=SC2086
  "$vanguard" mesh -q -p "$input" --out "$work/$kind/mesh" --write foam \
    --cells "${kind%-wall}" "${more[@]}" $options \
    > "$work/$kind/log.mesh" 2>&1 ||
    { bad "vanguard mesh: $(grep -a '^vanguard:' "$work/$kind/log.mesh" |
        tail -1)"; return 1; }
  mesh=$(find "$work/$kind/mesh" -maxdepth 1 -name '*.openfoam' | head -1)
  [ -n "$mesh" ] || { bad "vanguard mesh wrote no OpenFOAM case"; return 1; }
}

# --- checkMesh ---

# Checks that viscous layers always fail: cells a thousand times wider than
# high, and the determinant of their faces, which is also near zero in every
# corner cell with two faces on the boundary.
INHERENT='High aspect ratio|small determinant'
# Checks of quality that only -allGeometry makes.
QUALITY='interpolation weight|volume ratio|flatness|Concave|small angle'
# Tetrahedra between the centre of a cell and the triangles of its faces, for
# particles, in thin hexahedra: their faces are more warped than they are high.
WARPED='decomposition tets'

check_mesh() {
  local log=$d/log.checkMesh all=$d/log.checkMesh.all line quality=$QUALITY
  [ "$kind" != hex ] || quality="$QUALITY|$WARPED"
  (cd "$d" && timeout $LIMIT_S checkMesh) > "$log" 2>&1 ||
    { bad "checkMesh: exit status $?"; return; }
  (cd "$d" && timeout $LIMIT_S checkMesh -allGeometry -allTopology) \
    > "$all" 2>&1 || { bad "checkMesh -allGeometry: exit status $?"; return; }
  rm -rf "$d/constant/polyMesh/sets"
  awk '/^ *(cells|points|hexahedra|prisms|pyramids|tetrahedra|polyhedra):/ {
         if ($2 > 0) printf "%s %s, ", $2, substr($1, 1, length($1) - 1) }
       END { print "" }' "$log" | sed 's/^/  /; s/, $//'
  grep -aE 'Max aspect ratio|non-orthogonality Max|Max skewness' "$all" |
    sed 's/^ *\**/  /'
  for log in "$log" "$all"; do
    case $log in *.all) line='-allGeometry -allTopology' ;; *) line='' ;; esac
    if grep -aq '^Mesh OK' "$log"; then
      echo "  checkMesh${line:+ $line}: Mesh OK"
      continue
    fi
    grep -a '^ *\*\*\*' "$log" | grep -aE "$INHERENT" |
      sed "s/^ *\**/  checkMesh${line:+ $line}, thin cells: /"
    grep -a '^ *\*\*\*' "$log" | grep -aE "$quality" |
      sed "s/^ *\**/  checkMesh${line:+ $line}, quality: /"
    grep -a '^ *\*\*\*' "$log" | grep -avE "$INHERENT|$quality" \
      > "$log.errors"
    while read -r line; do bad "checkMesh: ${line#\*\*\*}"; done \
      < "$log.errors"
    grep -aq '^Failed [0-9]* mesh checks' "$log" || bad "checkMesh ended early"
  done
}

# --- the case ---

header() {
  printf 'FoamFile\n{\n    version 2.0;\n    format ascii;\n'
  printf '    class %s;\n    object %s;\n}\n' "$1" "$2"
}

# Field $1, class $2, dimensions $3, value $4, then one entry per kind of
# patch: viscous wall $5, slip wall $6, far field $7.
field() {
  header "$2" "$1"
  cat << END
dimensions $3;
internalField uniform $4;
boundaryField
{
END
  awk -v viscous="$5" -v slip="$6" -v far="$7" '
    $1 == "{" { name = last }
    $1 == "type" { type[name] = $2 }
    $1 == "physicalType" { physical[name] = $2 }
    $1 == "startFace" { order[++n] = name }
    { last = $1 }
    END {
      for (i = 1; i <= n; i++) {
        p = order[i]
        if (type[p] ~ /^symmetry/) text = "type " type[p] ";"
        else if (physical[p] ~ /^inviscidWall/) text = slip
        else if (type[p] ~ /^wall/) text = viscous
        else text = far
        sub(/;;$/, ";", text)
        printf "    %s { %s }\n", p, text
      }
    }' "$d/constant/polyMesh/boundary"
  echo '}'
}

# Names of the walls with forces, for controlDict.
walls() {
  awk '$1 == "{" { name = last } $1 == "type" && $2 == "wall;" { print name }
    { last = $1 }' "$d/constant/polyMesh/boundary" | tr '\n' ' '
}

write_fields() {
  local u nut k omega
  mkdir -p "$d/0"
  u="($ux 0 $uz)"
  field U volVectorField '[0 1 -1 0 0 0 0]' "$u" 'type noSlip;' 'type slip;' \
    "type freestreamVelocity; freestreamValue uniform $u; value uniform $u;" \
    > "$d/0/U"
  field p volScalarField '[0 2 -2 0 0 0 0]' 0 'type zeroGradient;' \
    'type zeroGradient;' \
    'type freestreamPressure; freestreamValue uniform 0; value uniform 0;' \
    > "$d/0/p"
  # Spalding's law is valid from the wall to a y+ of several hundred.
  nut=$(awk -v n="$nu" 'BEGIN { printf "%.10g", n / 5 }')
  field nut volScalarField '[0 2 -1 0 0 0 0]' "$nut" \
    'type nutUSpaldingWallFunction; value uniform 0;' 'type zeroGradient;' \
    "type freestream; freestreamValue uniform $nut; value uniform $nut;" \
    > "$d/0/nut"
  if [ "$model" = SpalartAllmaras ]; then
    nut=$(awk -v n="$nu" 'BEGIN { printf "%.10g", 3 * n }')
    field nuTilda volScalarField '[0 2 -1 0 0 0 0]' "$nut" \
      'type fixedValue; value uniform 0;' 'type zeroGradient;' \
      "type freestream; freestreamValue uniform $nut; value uniform $nut;" \
      > "$d/0/nuTilda"
    return
  fi
  # 0.1 % of turbulence and an eddy viscosity of a fifth of the laminar one.
  k=1.5e-6
  omega=$(awk -v k=$k -v n="$nut" 'BEGIN { printf "%.10g", k / n }')
  field k volScalarField '[0 2 -2 0 0 0 0]' $k \
    'type kqRWallFunction; value uniform 0;' 'type zeroGradient;' \
    "type freestream; freestreamValue uniform $k; value uniform $k;" > "$d/0/k"
  field omega volScalarField '[0 0 -1 0 0 0 0]' "$omega" \
    "type omegaWallFunction; value uniform $omega;" 'type zeroGradient;' \
    "type freestream; freestreamValue uniform $omega; value uniform $omega;" \
    > "$d/0/omega"
}

write_constant() {
  { header dictionary transportProperties
    echo "transportModel Newtonian; nu $nu;"; } \
    > "$d/constant/transportProperties"
  { header dictionary turbulenceProperties
    echo "simulationType RAS;"
    echo "RAS { RASModel $model; turbulence on; printCoeffs off; }"; } \
    > "$d/constant/turbulenceProperties"
}

# Area and chord 1: coefficients per square chord.
write_system() {
  mkdir -p "$d/system"
  { header dictionary controlDict
    cat << END
application simpleFoam;
startFrom startTime; startTime 0;
stopAt endTime; endTime $iterations;
deltaT 1; writeControl timeStep;
writeInterval $((iterations > 0 ? iterations : 1));
purgeWrite 1;
writeFormat binary; writePrecision 8; timeFormat general; timePrecision 8;
runTimeModifiable false;
functions
{
    forces
    {
        type forceCoeffs; libs (forces); patches ($(walls));
        writeControl timeStep; writeInterval 1;
        rho rhoInf; rhoInf 1; magUInf 1; lRef 1; Aref 1;
        CofR (0.25 0 0); pitchAxis (0 1 0);
        dragDir ($ux 0 $uz);
        liftDir ($(awk -v z="$uz" 'BEGIN { print -z }') 0 $ux);
    }
    wall { type yPlus; libs (fieldFunctionObjects); writeControl onEnd; }
}
END
  } > "$d/system/controlDict"
  { header dictionary fvSchemes
    cat << 'END'
ddtSchemes { default steadyState; }
gradSchemes
{
    default Gauss linear;
    limited cellLimited Gauss linear 1;
    grad(U) $limited;
    grad(nuTilda) $limited;
    grad(k) $limited;
    grad(omega) $limited;
}
divSchemes
{
    default none;
    div(phi,U) bounded Gauss linearUpwind limited;
    turbulence bounded Gauss upwind;
    div(phi,nuTilda) $turbulence;
    div(phi,k) $turbulence;
    div(phi,omega) $turbulence;
    div((nuEff*dev2(T(grad(U))))) Gauss linear;
}
laplacianSchemes { default Gauss linear limited 0.33; }
interpolationSchemes { default linear; }
snGradSchemes { default limited 0.33; }
wallDist { method meshWave; }
END
  } > "$d/system/fvSchemes"
  { header dictionary fvSolution
    cat << 'END'
solvers
{
    p
    {
        solver GAMG; smoother DICGaussSeidel;
        tolerance 1e-9; relTol 0.05; maxIter 100;
    }
    "(U|nuTilda|k|omega)"
    {
        solver PBiCGStab; preconditioner DILU;
        tolerance 1e-12; relTol 0.05; maxIter 100;
    }
}
SIMPLE
{
    consistent yes; nNonOrthogonalCorrectors 0; pRefCell 0; pRefValue 0;
}
relaxationFactors
{
    equations { U 0.8; nuTilda 0.7; k 0.7; omega 0.7; }
}
END
  } > "$d/system/fvSolution"
}

# --- the solver ---

# SIMPLEC ("consistent"): the cells of a column of layers move together, which
# SIMPLE does not take into account; over a blunt base at y+ 1 its pressures
# oscillate more with every iteration. The initial state is the wind everywhere,
# not potential flow, which has pressure spikes at sharp edges.

# First and last initial residual of a variable: "1.00e+00 3.21e-04".
residual() {
  awk -v v="Solving for $2," '
    index($0, v) { sub(/.*Initial residual = /, ""); sub(/,.*/, "")
                   r[++n] = $0 + 0 }
    END { if (!n) { print "- -"; exit }
          # The first few iterations are not representative: use the largest
          # residual of the first ten, and the mean of the last ten.
          for (i = 1; i <= 10 && i <= n; i++) if (r[i] > a) a = r[i]
          m = n < 10 ? n : 10
          for (i = n - m + 1; i <= n; i++) b += r[i] / m
          printf "%.2e %.2e\n", a, b }' "$1"
}

# Required reduction of the residuals.
FALL_U=10 FALL_P=5

solve() {
  local log=$d/log.simpleFoam v first last need
  write_fields
  write_constant
  (cd "$d" && timeout $LIMIT_S simpleFoam) > "$log" 2>&1 ||
    { bad "simpleFoam: exit status $?: $(tail -1 "$log")"; return; }
  grep -aq '^End' "$log" || { bad "simpleFoam ended early"; return; }
  echo "  simpleFoam, $model, $iterations iterations:" \
    "$(awk '/ExecutionTime/ { t = $3 } END { print t }' "$log") s"
  for v in Ux Uy Uz p nuTilda k omega; do
    read -r first last < <(residual "$log" $v)
    [ "$first" != - ] || continue
    case $v in p) need=$FALL_P ;; U?) need=$FALL_U ;; *) need=1 ;; esac
    printf '  residual %-8s %s to %s\n' "$v" "$first" "$last"
    awk -v a="$first" -v b="$last" -v f=$need \
      'BEGIN { exit !(b > 0 && b * f < a) }' ||
      [ "$iterations" -lt 100 ] || bad "residual of $v does not fall"
  done
  forces
  awk '/^ *patch .* y\+/ { sub(/^ */, ""); print "  " $0 }' "$log"
}

# Means over the last 20 iterations, and their variation.
forces() {
  local file
  file=$(find "$d/postProcessing/forces" -name 'coefficient*.dat' | head -1)
  [ -n "$file" ] || { bad "no forces"; return; }
  awk '/^#/ { if ($2 == "Time") for (i = 3; i <= NF; i++) col[$i] = i - 1
              next }
    { n++; d[n] = $col["Cd"]; l[n] = $col["Cl"] }
    END { m = n < 20 ? n : 20
      for (i = n - m + 1; i <= n; i++) {
        D += d[i] / m; L += l[i] / m
        if (i == n - m + 1 || d[i] < a) a = d[i]
        if (i == n - m + 1 || d[i] > b) b = d[i] }
      printf "  forces per square chord: drag %.5f, lift %.5f", D, L
      printf " (drag wanders by %.1e)\n", b - a
      # A diverged solution can have forces of any size.
      exit !(D * D + L * L < 1e4) }' "$file" || bad "forces out of bounds"
}

read -r ux uz nu < <(awk -v a="$alpha" -v re="$reynolds" 'BEGIN {
  r = a * atan2(0, -1) / 180
  printf "%.10g %.10g %.10g\n", cos(r), sin(r), 1 / re }')
for kind in $kinds; do
  echo "$kind"
  d=$work/$kind/run
  rm -rf "${work:?}/$kind"
  mkdir -p "$d/constant"
  mesh=''
  make_mesh "$kind" || continue
  cp -r "$mesh/constant/polyMesh" "$d/constant/" || { bad "no mesh"; continue; }
  write_system
  check_mesh
  # OpenFOAM's operators limit the non-orthogonality, the angle between a face
  # normal and the line of its cells, to 87 degrees; tetrahedra at y+ 1 have
  # 89.99, and SIMPLE diverges on them with any relaxation.
  [ "$iterations" = 0 ] || [ "$kind" = tets ] || solve
done
[ $failed = 0 ] && echo "good"
exit $failed
