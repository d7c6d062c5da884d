# SPDX-License-Identifier: LGPL-3.0-or-later
# Sizes and surfaces are used as they are given: edges on a body inside a given
# domain, sizes of a .vtu like those of a .sol, and a surface to be repaired.

# box LO HI FIRST: points and triangles of a cube; normals point out of it
box() {
  awk -v lo="$1" -v hi="$2" -v n="$3" '
    function end(upper) { return upper ? hi : lo }
    BEGIN {
      for (i = 0; i < 8; i++)
        print "v", end(i % 2), end(int(i / 2) % 2), end(int(i / 4))
      k = split("1 3 2 2 3 4 5 6 7 6 8 7 1 2 5 2 6 5 3 7 4 4 7 8 1 5 3 3 5 7 " \
                "2 4 6 4 8 6", v, " ")
      for (i = 1; i <= k; i += 3)
        print "f", v[i] + n, v[i + 1] + n, v[i + 2] + n
    }'
}

# a cube of length 2 in a room of length 20: 0.04 is the largest edge of the
# body unless another one is requested
{ echo "g room"; box -10 10 0; echo "g body"; box -1 1 8; } >room.obj
vanguard surface -q room.obj --remesh-surface yes --surface-size 0.8 \
  --out large
exits 0
triangles() {
  sed -n 's/,//g; s/.*remeshed: triangles 24 -> \([0-9]*\);.*/\1/p' out
}
body=$(triangles)
[ "${body:-99999}" -lt 12000 ] || fail "$body triangles with edges of 0.8"
vanguard surface -q room.obj --remesh-surface yes --hmax 0.8 --out small
exits 0
default=$(triangles)
[ "${default:-0}" -gt $((body + 20000)) ] ||
  fail "$default triangles without a request for the body, $body with one"

# sizes at the corners of a cube of six tetrahedra
{
  printf 'MeshVersionFormatted 2\nDimension 3\nVertices\n8\n'
  for i in 0 1 2 3 4 5 6 7; do
    echo $((i % 2)) $((i / 2 % 2)) $((i / 4)) 0
  done
  printf 'Tetrahedra\n6\n'
  printf '%s 0\n' "1 2 4 8" "1 4 3 8" "1 3 7 8" "1 7 5 8" "1 5 6 8" "1 6 2 8"
  echo End
} >corner.mesh
sizes="0.05 0.1 0.05 0.1 0.05 0.1 0.05 0.1"
{
  printf 'MeshVersionFormatted 2\nDimension 3\nSolAtVertices\n8\n1 1\n'
  # shellcheck disable=SC2086
  printf '%s\n' $sizes
  echo End
} >corner.sol
cat >corner.vtu <<END
<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian">
<UnstructuredGrid><Piece NumberOfPoints="8" NumberOfCells="6">
<PointData><DataArray type="Float64" Name="size" format="ascii">
$sizes</DataArray></PointData>
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">
$(sed -n '5,12s/ 0$//p' corner.mesh)</DataArray></Points>
<Cells><DataArray type="Int64" Name="connectivity" format="ascii">
0 1 3 7 0 3 2 7 0 2 6 7 0 6 4 7 0 4 5 7 0 5 1 7</DataArray>
<DataArray type="Int64" Name="offsets" format="ascii">
4 8 12 16 20 24</DataArray>
<DataArray type="UInt8" Name="types" format="ascii">
10 10 10 10 10 10</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>
END
vanguard demo box --cells 4000 --out .
exits 0
for kind in sol vtu; do
  vanguard mesh -q -p box --write b8.ugrid --sizes "corner.$kind" --out "$kind"
  exits 0
done
same sol/box.b8.ugrid vtu/box.b8.ugrid

# half an octahedron, of which one triangle disagrees with the others, which
# point into the body
half() {
  printf 'v %s\n' "1 0 0" "-1 0 0" "0 1 0" "0 0 1" "0 0 -1"
  echo "g body"
  printf 'f %s\n' "3 1 4" "2 3 4" "1 3 5" "$1"
}
half "2 3 5" >half.obj
half "3 2 5" >agrees.obj
vanguard check -q half.obj
exits 0
says out "repaired: 1 triangles reversed for a consistent orientation"
cat >cone.deck <<'END'
Mach cones
farfield
kind  mach  radial
mach  1.6   3

sources
kind      h0    stretch
machcone  0.3   10
END
vanguard mesh -q half.obj --deck cone.deck --write b8.ugrid --out cone
exits 0
says out "note: 1 triangles were reversed for a consistent orientation"
grep "note: source 1: Mach cones at M 1.6 " out >place
vanguard mesh -q agrees.obj --deck cone.deck --write b8.ugrid --out cone
exits 0
grep "note: source 1: " out | is place
