# SPDX-License-Identifier: LGPL-3.0-or-later
# Conditions of patches that have none.
needs hdf5

# quad NAME A B C D: a face of a box as two triangles of an ASCII STL
quad() {
  local name=$1 v
  shift
  echo "solid $name"
  for v in "$1;$2;$3" "$1;$3;$4"; do
    echo "facet normal 0 0 0"
    echo "outer loop"
    echo "$v" | tr ';' '\n' | sed 's/^/vertex /'
    echo "endloop"
    echo "endfacet"
  done
  echo "endsolid $name"
}
duct() {
  quad inlet "0 0 0" "0 0 1" "0 1 1" "0 1 0"
  quad outlet "2 0 0" "2 1 0" "2 1 1" "2 0 1"
  quad front "0 0 0" "2 0 0" "2 0 1" "0 0 1"
  quad rest "0 1 0" "0 1 1" "2 1 1" "2 1 0"
  quad rest "0 0 0" "0 1 0" "2 1 0" "2 0 0"
  quad rest "0 0 1" "2 0 1" "2 1 1" "0 1 1"
}
duct >duct.stl

# Inlet and outlet of an internal flow keep their roles in every format.
vanguard mesh -q duct.stl --surface-swap no \
  --write cogsg,b8.ugrid,cgns,foam,fluent.msh,su2 --out a
exits 0
says out "note: patch 1 (inlet) has no boundary condition and is written as \
inflow (1001, FUN3D 7011) because of its name"
says out "outflow (1002, FUN3D 5051) because of its name"
grep -q '^ *1  *1001 .*inlet' a/duct.mapbc || fail "no inflow in a .mapbc"
grep -q '^ *2  *1002 .*outlet' a/duct.mapbc || fail "no outflow in a .mapbc"
grep -A4 inlet a/duct.openfoam/constant/polyMesh/boundary | grep -q "inflow" ||
  fail "no inflow in the boundary of OpenFOAM"
grep -q "pressure-inlet inlet" a/duct.fluent.msh || fail "no inlet for Fluent"
grep -q "BCTunnelInflow" a/duct.cgns || fail "no inflow in CGNS"
grep -q "BCTunnelOutflow" a/duct.cgns || fail "no outflow in CGNS"

# The resolved deck has these conditions and gives the same mesh.
vanguard mesh -q duct.stl --deck a/duct.resolved.deck --write b8.ugrid --out b
exits 0
same a/duct.b8.ugrid b/duct.b8.ugrid
