#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# FreeFem++ (Debian freefem++ and libfreefem++ 4.11+dfsg1-3): where are the
# modules?
#
# The program of the package 4.11 calls itself 4.9 and searches its modules in
# /usr/lib/ff++/4.9/lib, but the package installs them in /usr/lib/freefem++.
# `load "msh3"`, without which no mesh in 3D can be read, fails until
# FF_LOADPATH names the folder.
#
# Output seen:
#   without FF_LOADPATH: Load error : msh3
#   with it:             1 tetrahedron
. "$(dirname "$(realpath "$0")")/install.sh"
install freefem++=4.11+dfsg1-3 libfreefem++=4.11+dfsg1-3
work

cat > one.mesh <<'END'
MeshVersionFormatted 2
Dimension 3
Vertices
4
0 0 0 1
1 0 0 1
0 1 0 1
0 0 1 1
Tetrahedra
1
1 2 3 4 1
Triangles
4
1 3 2 1
1 2 4 1
2 3 4 1
3 1 4 1
End
END
printf '%s\n' 'load "msh3"' 'mesh3 Th = readmesh3("one.mesh");' \
  'cout << Th.nt << " tetrahedron" << endl;' > read.edp
unset FF_LOADPATH
if FreeFem++ -nw -v 0 read.edp > log.without 2>&1; then
  changed "the modules are found"
fi
echo "without FF_LOADPATH: $(grep -a -m1 'Load error' log.without)"
FF_LOADPATH=/usr/lib/freefem++ FreeFem++ -nw -v 0 read.edp > log.with 2>&1 ||
  changed "FF_LOADPATH does not help"
echo "with it:             $(grep -a tetrahedron log.with)"
grep -qa '^1 tetrahedron' log.with || changed "no tetrahedron"
