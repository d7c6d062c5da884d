# SPDX-License-Identifier: LGPL-3.0-or-later
# A symmetry plane that noise tilts out of its axis has FUN3D's code of a slip
# wall, which is a note.
box() { # box Y: a box whose plane y = 0 has a corner at Y
  cat <<END
8 12 0 0 0 0 0
0 0 0
1 0 0
1 1 0
0 1 0
0 0 1
1 $1 1
1 1 1
0 1 1
1 2 3
1 3 4
5 7 6
5 8 7
1 6 2
1 5 6
4 3 7
4 7 8
1 4 8
1 8 5
2 6 7
2 7 3
1 1 1 1 2 2 1 1 1 1 1 1
END
}
printf '%s\n' "title" "title" "title" \
  "1 4 4 0 0 wall" "2 1 1 0 0 mirror" >plane.mapbc
cp plane.mapbc noise.mapbc
box 0 >plane.ugrid
box 1e-6 >noise.ugrid
vanguard check plane.ugrid
lacks out "deviate"
vanguard check noise.ugrid
says out "patch 2 (mirror) is a symmetry plane (1), but its points deviate by 1e-06"
says out "3000, instead of 6662"
vanguard check --json noise.ugrid
says out "instead of 6662"
