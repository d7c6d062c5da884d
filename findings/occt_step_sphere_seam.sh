#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# Open CASCADE 7.6.3 as gmsh uses it (Debian libocct-data-exchange-7.6 7.6.3+dfsg1-7,
# python3-gmsh 4.8.4+ds2-3): a union of two spheres, written to STEP and read again.
#
# The union of two unit spheres, of which one is moved by 1 along x, has the volume
# 9 pi / 4 = 7.069. Read from the STEP file that the same library wrote, it has 2.880: a
# ball is missing, without a warning. Moved along y or z, the union keeps its volume, as it
# does in a BREP file.
#
# Output seen:
#   x: 7.069, STEP 2.880, BREP 7.069
#   y: 7.069, STEP 7.069, BREP 7.069
#   z: 7.069, STEP 7.069, BREP 7.069
. "$(dirname "$(realpath "$0")")/install.sh"
install libocct-data-exchange-7.6=7.6.3+dfsg1-7 \
  python3-gmsh=4.8.4+ds2-3
work

cat > spheres.py <<'END'
import gmsh

def volume():
    occ.synchronize()
    return sum(occ.getMass(3, tag) for _, tag in gmsh.model.getEntities(3))

gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
occ = gmsh.model.occ
for axis, by in ("x", (1, 0, 0)), ("y", (0, 1, 0)), ("z", (0, 0, 1)):
    gmsh.model.add(axis)
    occ.fuse([(3, occ.addSphere(0, 0, 0, 1))], [(3, occ.addSphere(*by, 1))])
    line = f"{axis}: {volume():.3f}"
    gmsh.write("union.step")
    gmsh.write("union.brep")
    for kind in "step", "brep":
        gmsh.model.add(f"{axis} {kind}")
        occ.importShapes(f"union.{kind}")
        line += f", {kind.upper()} {volume():.3f}"
    print(line)
END
/usr/bin/python3 spheres.py | grep -a '^[xyz]: ' | tee seen
diff - seen <<'END'
x: 7.069, STEP 2.880, BREP 7.069
y: 7.069, STEP 7.069, BREP 7.069
z: 7.069, STEP 7.069, BREP 7.069
END
