# SPDX-License-Identifier: LGPL-3.0-or-later
# vanguard metric: the metric of the next mesh from a solution. A front is
# resolved in a few cycles; every format of solutions gives the same metric;
# invalid solutions are refused.
vanguard demo box --cells 20000 --out .
exits 0
vanguard mesh -q -p box --write mesh,vtu --out 1
exits 0

# front MESH: a value at each vertex of a .mesh, a front of width 0.05 that is
# the surface of a sphere.
front() {
  awk '
    at && n < count {
      t = (sqrt(($1 + .2) ^ 2 + ($2 + .2) ^ 2 + ($3 + .2) ^ 2) - .8) / .05
      e = exp(-2 * (t < 0 ? -t : t)); f = (1 - e) / (1 + e)
      printf "%s %s %s %.12g\n", $1, $2, $3, t < 0 ? -f : f
      n++
    }
    is_count { count = $1; at = 1; is_count = 0 }
    $1 == "Vertices" { is_count = 1 }' "$1"
}
sol() {
  front "$1.mesh" >values
  {
    echo "MeshVersionFormatted 2 Dimension 3 SolAtVertices"
    echo "$(wc -l <values) 1 1"
    awk '{ print $4 }' values
    echo End
  } >"$1.sol"
}

# Three cycles: the mesh has the requested size, and edges of a tenth of the
# first ones at the front.
cat >adapt.deck <<'END'
Adaptation
growth  surface_sizes  remesh_surface
2       no             yes
END
for k in 1 2 3; do
  sol "$k/box"
  vanguard metric -q "$k/box.sol" --cells 20000 --out "$k.solb"
  exits 0
  says out "  expected cells   20,0"
  exists "$k.solb" "$k.meshb"
  vanguard mesh -q -p box --deck adapt.deck --sizes "$k.solb" --write mesh \
    --out "$((k + 1))"
  exits 0
done
cells=$(sed -n 's/.* cells expected, \([0-9,]*\) generated/\1/p' out | tr -d ,)
[ "$cells" -gt 16000 ] && [ "$cells" -lt 24000 ] || fail "$cells cells"

# The same metric from a .sol, a .csv and a .vtu, and by text and binary files.
vanguard metric 1/box.sol --cells 5000 --out a.sol --json
exits 0
says out '"layer_cells": 0'
front 1/box.mesh >values
{
  echo '"PointID","x","y","z","Ma", p'
  awk '{ print NR - 1 ", " $1 "," $2 "," $3 "," $4 "," NR }' values
} >s.csv
vanguard metric s.csv --field Ma --mesh 1/box.mesh --cells 5000 --out b.sol
exits 0
same a.sol b.sol
same a.mesh b.mesh
{ # the points and cells of the .vtu, and two arrays in text
  n=$(wc -l <values)
  echo '<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian">'
  echo "<UnstructuredGrid><Piece NumberOfPoints=\"$n\" NumberOfCells=\"CELLS\">"
  echo '<PointData><DataArray type="Float64" Name="U" NumberOfComponents="3" format="ascii">'
  awk '{ print 3 * $4, $4, 0 }' values
  echo '</DataArray></PointData>'
  echo '<CellData><DataArray type="Float64" Name="p" format="ascii">'
  echo '</DataArray></CellData>'
  echo '<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">'
  awk '{ print $1, $2, $3 }' values
  echo '</DataArray></Points><Cells><DataArray type="Int64" Name="connectivity" format="ascii">'
  awk 'at && n < count { print $1 - 1, $2 - 1, $3 - 1, $4 - 1; n++ }
    is_count { count = $1; at = 1; is_count = 0 }
    $1 == "Tetrahedra" { is_count = 1 }' 1/box.mesh | tee tets
  echo '</DataArray><DataArray type="Int64" Name="offsets" format="ascii">'
  awk '{ print 4 * NR }' tets
  echo '</DataArray><DataArray type="UInt8" Name="types" format="ascii">'
  awk '{ print 10 }' tets
  echo '</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>'
} | sed "s/CELLS/$(awk 'is { print; exit } $1 == "Tetrahedra" { is = 1 }' \
  1/box.mesh)/" >s.vtu
vanguard metric s.vtu --field U:2 --cells 5000 --out c.sol
exits 0
same a.sol c.sol
vanguard metric s.vtu --field U:2 --cells 5000
exits 0
exists s.metric.vtu
vanguard metric s.vtu --field U:2,U:mag,U:1 --cells 5000 --norm max --json
exits 0
says out '"U:mag",'
vanguard mesh -q -p box --deck adapt.deck --sizes a.sol --write mesh --out d
exits 0
vanguard mesh -q -p box --deck adapt.deck --sizes s.metric.vtu --write mesh \
  --out e
exits 0

# A case of OpenFOAM with values in the cells: the last time, or a given one,
# in text and binary.
vanguard mesh -q -p box --write mesh,foam-ascii --out c1
exits 0
same 1/box.mesh c1/box.mesh
mkdir c1/box.openfoam/0 c1/box.openfoam/12
awk 'is == "Vertices" && NF == 4 { x[++n] = $1; y[n] = $2; z[n] = $3 }
  is == "Tetrahedra" && NF == 5 {
    sx = sy = sz = 0
    for (i = 1; i <= 4; i++) { sx += x[$i]; sy += y[$i]; sz += z[$i] }
    t = (sqrt((sx / 4 + .2) ^ 2 + (sy / 4 + .2) ^ 2 + (sz / 4 + .2) ^ 2) - .8) / .05
    e = exp(-2 * (t < 0 ? -t : t)); f = (1 - e) / (1 + e)
    printf "%.12g\n", t < 0 ? -f : f
  }
  NF == 1 && !/^[0-9]/ { is = $1 }' 1/box.mesh >cells
{
  echo "FoamFile { version 2.0; format ascii; class volScalarField; object Ma; }"
  echo "dimensions [0 0 0 0 0 0 0]; // none"
  echo "internalField nonuniform List<scalar>"
  wc -l <cells
  echo "("
  cat cells
  echo ");"
  echo "boundaryField { \".*\" { type zeroGradient; } }"
} >c1/box.openfoam/12/Ma
sed 's/nonuniform.*/uniform 1;/; 4,$d' c1/box.openfoam/12/Ma \
  >c1/box.openfoam/0/Ma
# The same values as a cell array of a .vtu.
awk '{ print } /Name="p"/ { while ((getline line <"cells") > 0) print line }' \
  s.vtu >t.vtu
vanguard metric t.vtu --field p --cells 5000
exits 0
says out "  expected cells   5,0"
vanguard metric c1/box.openfoam/ --field Ma --cells 5000
exits 0
says out "  expected cells   5,0"
exists c1/box.metric.vtu
vanguard metric c1/box.openfoam/12 --field Ma --cells 5000 --out g.vtu
exits 0
same c1/box.metric.vtu g.vtu
vanguard mesh -q -p box --write foam --out c2
exits 0
cp -r c1/box.openfoam/12 c2/box.openfoam
gzip c2/box.openfoam/12/Ma c2/box.openfoam/constant/polyMesh/owner
vanguard metric c2/box.openfoam --field Ma --cells 5000 --out h.vtu
exits 0
same g.vtu h.vtu

# Bounds that leave no choice are noted.
vanguard metric s.csv --field Ma --mesh 1/box.mesh --cells 100000 --h-min 0.1 \
  --out f.vtu
exits 0
says out "times the requested number of cells"

# refused TEXT ARGS...
refused() {
  text=$1
  shift
  vanguard metric "$@"
  [ "$status" != 0 ] || fail "accepted: $*"
  says err "$text"
  absent z.vtu z.solb z.meshb
}
refused "its point arrays are: U; its cell arrays are: p" s.vtu --cells 10 --field q --out z.vtu
# A mesh that moves: the points of the time.
mkdir c2/box.openfoam/12/polyMesh
cp c1/box.openfoam/constant/polyMesh/points c2/box.openfoam/12/polyMesh
vanguard metric c2/box.openfoam --field Ma --cells 5000 --out i.vtu
exits 0
same h.vtu i.vtu
awk '/^\([-0-9. e+]*\)$/ { gsub(/[()]/, ""); print "(" 3 * $1, 3 * $2, 3 * $3 ")"; next }
  { print }' c1/box.openfoam/constant/polyMesh/points \
  >c2/box.openfoam/12/polyMesh/points
vanguard metric c2/box.openfoam --field Ma --cells 5000 --out j.vtu
exits 0
! cmp -s i.vtu j.vtu || fail "the points of the time were not used"
cp c1/box.openfoam/constant/polyMesh/faces c2/box.openfoam/12/polyMesh
refused "the faces of the mesh change with time" c2/box.openfoam --cells 10 \
  --field Ma --out z.vtu
refused "neither an OpenFOAM case" c2 --cells 10 --field Ma --out z.vtu
refused "--cells 1e+30 is more than 1e+12" s.vtu --cells 1e30 --field U:2 \
  --out z.vtu
refused "it is linear" c1/box.openfoam/0 --cells 10 --field Ma --out z.vtu
refused "there is no field 'q'; its files are: Ma" c1/box.openfoam --cells 10 \
  --field q --out z.vtu
refused "--mesh is for a .csv" c1/box.openfoam --cells 10 --field Ma \
  --mesh 1/box.mesh --out z.vtu
refused "NAME:1 to NAME:3" s.vtu --cells 10 --field U --out z.vtu
refused "NAME:1 to NAME:3" s.vtu --cells 10 --field U:4 --out z.vtu
refused "give a field by --field" s.vtu --cells 10 --out z.vtu
refused "an empty name" s.vtu --cells 10 --field U:1,,U:2 --out z.vtu
refused "'U:3' gives no metric: it is linear" s.vtu --cells 10 --field U:3 \
  --out z.vtu
refused "would overwrite" s.vtu --cells 10 --field U:1 --out ./s.vtu
refused "would overwrite" 1/box.sol --cells 10 --out 1/box.sol
refused "its columns are: PointID, x, y, z, Ma, p" s.csv --cells 10 --field q \
  --mesh 1/box.mesh --out z.vtu
refused "by --mesh" s.csv --cells 10 --field Ma --out z.vtu
refused "points" s.csv --cells 10 --field Ma --mesh 2/box.mesh --out z.vtu
awk -F, 'NR == 5 { $3 = 7; OFS = "," } { print }' s.csv | tr ' ' , |
  sed 's/,,*/,/g' >moved.csv
refused "the y of point 4 is 7" moved.csv --cells 10 --field Ma \
  --mesh 1/box.mesh --out z.vtu
sed '7s/,[^,]*$//' s.csv >short.csv
refused "line 7: 5 columns" short.csv --cells 10 --field Ma \
  --mesh 1/box.mesh --out z.vtu
awk -F, 'NR == 4 { kept = $0; next } { print } NR == 5 { print kept }' s.csv |
  cut -d, -f1,5,6 >shuffled.csv
refused "line 4 has the PointID 3" shuffled.csv --cells 10 --field Ma \
  --mesh 1/box.mesh --out z.vtu
sed 's/appended/none/; s/<VTKFile /<VTKFile compressor="vtkLZ4DataCompressor" /' \
  s.vtu >lz4.vtu
refused "only zlib is supported" lz4.vtu --cells 10 --field U:1 --out z.vtu
cp 1/box.mesh z.mesh
refused "another mesh of this name, z.mesh" s.vtu --cells 10 --field U:1 \
  --out z.solb
refused "another mesh of this name, z.mesh" s.vtu --cells 10 --field U:1 \
  --out z.sol
rm z.mesh
refused "omit --field" 1/box.sol --cells 10 --field p --out z.vtu
refused "a solution is read from" box.lb8.ugrid --cells 10 --out z.vtu
sed 's/Float64" Name="U"/Float64" Name="V"/' s.vtu >renamed.vtu
refused "its point arrays are: V" renamed.vtu --cells 10 --field U:1 \
  --out z.vtu
vanguard metric s.vtu --field U:1
exits 2
vanguard metric s.vtu --field U:1 --cells -5
exits 2
vanguard metric s.vtu --field U:1 --cells 10 --h-min 2 --h-max 1
exits 2
