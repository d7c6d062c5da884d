# SPDX-License-Identifier: LGPL-3.0-or-later
# shellcheck shell=bash disable=SC2154
# The meshes and the solutions: folders NAME-SCALE and NAME-SCALE-ANGLE.

# mesh_of NAME SCALE: a folder NAME-SCALE with the mesh of OpenFOAM. The patch of the
# section is wall.
mesh_of() {
  [ ! -d "$1-$2/constant" ] || return 0
  "mesh_of_$1" "$2" && cp -r "$1.tmp" "$1-$2" && rm -rf "$1.tmp" &&
    (cd "$1-$2" && checkMesh >checkMesh.log 2>&1
     grep -q 'Mesh OK' checkMesh.log || grep '\*\*' checkMesh.log
     :)
}

# The section of NACA's formula with a sharp trailing edge, with the deck of this folder.
section() {
  [ -f naca.dat ] ||
    { "$vanguard" demo aerofoil --out demo >/dev/null &&
        { echo wall; tail -n +2 demo/aerofoil.dat; } >naca.dat &&
        cp "$here/naca.deck" .; }
}

mesh_of_vanguard() {
  section || return
  "$vanguard" mesh -q -p naca --scale "$1" --section-width "$width" \
    --write foam,su2 --out "v$1" >/dev/null || return
  rm -rf vanguard.tmp
  cp -r "v$1/naca.openfoam" vanguard.tmp
}

# The layers of gmsh are 2 % of the chord thick, as the boundary layer is at the trailing
# edge, with Vanguard's first height and growth. Its field grows such that the numbers of
# cells are about the same.
mesh_of_gmsh() {
  local first ratio growth
  [ -f "v$1/naca.su2" ] || mesh_of_vanguard "$1" || return
  read -r first ratio growth < <(awk -v s="$1" 'BEGIN {
    printf "%.12g %.12g %.12g\n", 4.45688e-6 * s, 1.2 ^ s, 1 + 0.089 * s ^ 1.1 }')
  python3 "$here/gmsh.py" section "v$1/naca.su2" "g$1.geo" "$first" "$ratio" 0.02 \
    "$growth" 500 || return
  gmsh -2 "g$1.geo" -o "g$1.2.msh" >"g$1.log" 2>&1 || return
  python3 "$here/gmsh.py" extrude "g$1.2.msh" "g$1.msh" || return
  rm -rf gmsh.tmp
  mkdir gmsh.tmp
  ( cd gmsh.tmp && control 1 wall 1 0 && schemes upwind && solvers &&
      gmshToFoam "../g$1.msh" >gmshToFoam.log 2>&1 &&
      sed -i '/^ *\(back\|front\)$/,/type/s/type.*/type empty;/
              /^ *wall$/,/type/s/type.*/type wall;/' constant/polyMesh/boundary )
}

# solve MESH ALPHA [FROM]: second order in MESH-ALPHA. It starts with the solution FROM,
# or else with a potential flow and first order.
solve() {
  local c s start=0
  [ ! -f "$1-$2/solved" ] || return 0
  rm -rf "$1-$2"
  cp -r "$1" "$1-$2" && cd "$1-$2" || return
  read -r c s < <(stream "$2")
  external_fields "$c" "$s"
  solvers
  control "$iterations" wall "$c" "$s"
  schemes upwind
  if [ -n "${3:-}" ]; then
    mapFields -consistent -sourceTime latestTime "../$3" >map.log 2>&1
  else
    start=600
    control $start wall "$c" "$s"
    potentialFoam >potentialFoam.log 2>&1 && simpleFoam >upwind.log 2>&1
  fi
  schemes linearUpwind
  control $((start + iterations)) wall "$c" "$s"
  simpleFoam >simpleFoam.log 2>&1 && touch solved
  local ended=$?
  cd ..
  return $ended
}
