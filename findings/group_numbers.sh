#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# OpenFOAM 1912 (Debian 1912.200626-1+b1), code_saturne 6.0.2 (Debian 6.0.2-2)
# and gmsh 4.8.4 (Debian 4.8.4+ds2-3): names of physical groups.
#
# Physical groups of a Gmsh file are numbered per dimension: a surface group 1
# and a volume group 1 are different groups, and gmsh keeps both names.
# gmshToFoam and code_saturne's preprocessor look up a name by the number alone.
# gmshToFoam gives the cell zone the name of the surfaces, code_saturne gives
# the surfaces the name of the cells.
#
# Output seen, for the groups 2 1 "wall" and 3 1 "fluid":
#   gmsh:         2 1 "wall"  3 1 "fluid"
#   gmshToFoam:   Writing zone 0 to cellZone wall and cellSet
#   code_saturne: Group "fluid" of 4 boundary faces, no Group "wall"
. "$(dirname "$(realpath "$0")")/install.sh"
install openfoam=1912.200626-1+b1 code-saturne-bin=6.0.2-2 gmsh=4.8.4+ds2-3
work
openfoam

cat > one.geo <<'END'
SetFactory("Built-in");
Point(1) = {0, 0, 0, 9}; Point(2) = {1, 0, 0, 9};
Point(3) = {0, 1, 0, 9}; Point(4) = {0, 0, 1, 9};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 1};
Line(4) = {1, 4}; Line(5) = {2, 4}; Line(6) = {3, 4};
Curve Loop(1) = {1, 2, 3}; Plane Surface(1) = {1};
Curve Loop(2) = {1, 5, -4}; Plane Surface(2) = {2};
Curve Loop(3) = {2, 6, -5}; Plane Surface(3) = {3};
Curve Loop(4) = {3, 4, -6}; Plane Surface(4) = {4};
Surface Loop(1) = {1, 2, 3, 4}; Volume(1) = {1};
Physical Surface("wall", 1) = {1, 2, 3, 4};
Physical Volume("fluid", 1) = {1};
END
gmsh one.geo -3 -format msh41 -o one.msh > log.gmsh
gmsh one.msh -save -format msh41 -o again.msh >> log.gmsh
echo "gmsh:         $(grep -A2 '^2$' again.msh | grep '"' | tr '\n' ' ')"
grep -q '^2 1 "wall"' again.msh && grep -q '^3 1 "fluid"' again.msh ||
  changed "gmsh does not keep both names"

control
gmshToFoam one.msh > log.gmshToFoam 2>&1
zone=$(grep 'to cellZone' log.gmshToFoam)
echo "gmshToFoam:   $zone"
[[ $zone = *"cellZone wall "* ]] || changed "the cell zone has another name"

/usr/lib/code_saturne/cs_preprocess --out saturne one.msh > log.saturne
faces=$(awk '/^ *Group "/ { g = g " " $2 } /^ *Family [0-9]+$/ { g = "" }
  /Number of boundary faces :/ && g { print g, $NF }' log.saturne)
echo "code_saturne: groups and number of boundary faces: $faces"
[[ $faces = *'"fluid" '* && $faces != *'"wall"'* ]] ||
  changed "code_saturne calls the faces $faces"
