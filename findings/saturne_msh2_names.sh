#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# code_saturne 6.0.2 (Debian 6.0.2-2) and gmsh 4.8.4 (Debian 4.8.4+ds2-3): names
# of groups in version 2.2.
#
# Version 2.2 of the Gmsh format has the same section $PhysicalNames as version
# 4.1. code_saturne's preprocessor reads it in version 4.1 only: from a file of
# version 2.2 groups have numbers, and a case that selects faces by name finds
# none.
#
# Output seen, for one surface group 7 "wall":
#   version 4.1: "7" "wall"
#   version 2.2: "7"
. "$(dirname "$(realpath "$0")")/install.sh"
install code-saturne-bin=6.0.2-2 gmsh=4.8.4+ds2-3
work

cat > one.geo <<'END'
Point(1) = {0, 0, 0, 9}; Point(2) = {1, 0, 0, 9}; Point(3) = {0, 1, 0, 9};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 1};
Curve Loop(1) = {1, 2, 3}; Plane Surface(1) = {1};
e[] = Extrude {0, 0, 1} { Surface{1}; };
Physical Surface("wall", 7) = {1};
Physical Volume("fluid", 9) = {1};
END
# groups VERSION: the groups that contain boundary faces.
groups() {
  gmsh one.geo -3 -format "msh$1" -o "one$1.msh" > log.gmsh
  grep -q '^2 7 "wall"' "one$1.msh" || changed "gmsh writes no name"
  /usr/lib/code_saturne/cs_preprocess --out saturne "one$1.msh" > log.saturne
  awk '/^ *Group "/ { g = g " " $2 } /^ *Family [0-9]+$/ { g = "" }
    /Number of boundary faces :/ && g { print substr(g, 2) }' log.saturne
}
new=$(groups 41)
old=$(groups 22)
echo "version 4.1: $new"
echo "version 2.2: $old"
[ "$new" = '"7" "wall"' ] && [ "$old" = '"7"' ] || changed "$new, $old"
