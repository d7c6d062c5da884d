# SPDX-License-Identifier: LGPL-3.0-or-later
# Edge lengths from a file: the mesh of a first run, with a size at each of
# its points, controls the next run; and invalid files are refused.
needs mpi
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 \
  OMPI_MCA_rmaps_base_oversubscribe=1 OMPI_MCA_hwloc_base_binding_policy=none

vanguard demo box --cells 20000 --out .
exits 0
vanguard mesh -q -p box --write mesh --out first
exits 0

# sol FILE INSIDE: a size at each vertex of first/box.mesh, INSIDE near the
# middle of the cube and large elsewhere.
sol() {
  awk -v inside="$2" '
    BEGIN { print "MeshVersionFormatted 2\nDimension 3\nSolAtVertices" }
    at && n < count {
      d = ($1 - .5) ^ 2 + ($2 - .5) ^ 2 + ($3 - .5) ^ 2
      print (d < .01 ? inside : 0.5)
      n++
    }
    is_count { count = $1; print count "\n1 1"; at = 1; is_count = 0 }
    $1 == "Vertices" { is_count = 1 }
    END { print "End" }' first/box.mesh >"$1"
}
cells() {
  sed -n 's/.*"cells": \([0-9]*\).*/\1/p' "$1" | sort -n | tail -1
}

sol first/box.sol 0.006
vanguard mesh -q -p box --write b8.ugrid --out plain
exits 0
vanguard mesh -q -p box --write b8.ugrid --sizes first/box.sol --out finer \
  --threads 1
exits 0
says out "points were read from first/box.sol"
plain=$(cells plain/box.report.json) finer=$(cells finer/box.report.json)
[ "$finer" -gt $((plain * 3 / 2)) ] ||
  fail "$finer cells with sizes, $plain without"

# the deck names the files used, and the run is the same for threads and ranks
says finer/box.resolved.deck first/box.sol
vanguard mesh -q -p box --deck finer/box.resolved.deck --out again --threads 3
exits 0
cmp finer/box.b8.ugrid again/box.b8.ugrid || fail "threads differ"
if mpirun -n 2 true >/dev/null 2>&1; then
  ASAN_OPTIONS=$ASAN_OPTIONS:detect_leaks=0 mpirun -n 2 "$program" mesh -q -p box \
    --deck finer/box.resolved.deck --out ranks >out 2>err
  cmp finer/box.b8.ugrid ranks/box.b8.ugrid || fail "ranks differ"
fi

points=$(awk '/SolAtVertices/ { getline; print $1; exit }' first/box.sol)

# the mesh is measured in the metric of the sizes: with those of the deck, which
# the run used, most edges are as requested; without the file, there are no such
# figures
vanguard check -q finer/box.b8.ugrid --sizes first/box.sol --deck box.deck
exits 0
says out "note: sizes at $points points were read from first/box.sol"
within=$(sed -n 's/.*between 0.7 and 1.4 \([0-9]*\)\..*/\1/p' out)
[ "${within:-0}" -ge 95 ] || fail "$within % of the edges have a length near 1"
vanguard check -q finer/box.b8.ugrid --json --sizes first/box.sol
exits 0
says out '"histogram_mean_ratio"'
vanguard check -q plain/box.b8.ugrid --json --sizes first/box.sol
coarse=$(sed -n 's/.*"length_max": \([0-9]*\)\..*/\1/p' out)
[ "${coarse:-0}" -ge 4 ] || fail "a mesh without the sizes has lengths to $coarse"
vanguard check -q finer/box.b8.ugrid --json --deck finer/box.resolved.deck
exits 0
grep -q '"metric"' out && fail "figures in the metric without a request"
vanguard check -q finer/box.b8.ugrid --sizes nowhere.sol
exits 1
says err "nowhere.sol"

# VTK files have their own points
cat >one.vtu <<'END'
<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian">
<UnstructuredGrid><Piece NumberOfPoints="1" NumberOfCells="0">
<PointData><DataArray type="Float64" Name="size" format="ascii">0.006
</DataArray></PointData>
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">
.5 .5 .5</DataArray></Points></Piece></UnstructuredGrid></VTKFile>
END
vanguard mesh -q -p box --write b8.ugrid --sizes one.vtu --out vtk
exits 0
vtk=$(cells vtk/box.report.json)
[ "$vtk" -gt $((plain * 3 / 2)) ] || fail "$vtk cells with a .vtu, not $plain"
vanguard mesh -q -p box --write vtu --out vtk
exits 0
vanguard mesh -q -p box --sizes vtk/box.vtu --out no
exits 1
says err "vtk/box.vtu: there is no array 'size' in <PointData>"

# metrics: the size 0.02 across x and 0.1 along y and z, near the middle of the
# cube; in the order of Medit, and in another one
metrics() {
  awk -v row="$2" -v bad="${3:-}" -v coarse="${4:-100 0 100 0 0 100}" '
    BEGIN { print "MeshVersionFormatted 2\nDimension 3\nSolAtVertices" }
    at && n < count {
      n++
      fine = ($1 - .5) ^ 2 < .01
      print (bad && n == 17 ? bad : fine ? row : coarse)
    }
    is_count { count = $1; print count "\n1 3"; at = 1; is_count = 0 }
    $1 == "Vertices" { is_count = 1 }
    END { print "End" }' first/box.mesh >first/box.sol
}
metrics first/box.sol "2500 0 100 0 0 100"
vanguard plan -p box --sizes first/box.sol --surface-sizes no
exits 0
says out "metrics at $points points were read from first/box.sol"
metrics first/box.sol "2500 0 100 0 0 100" "100 200 100 0 0 100"
vanguard mesh -q -p box --sizes first/box.sol --out no
exits 1
says err "first/box.sol: the metric at point 17, ("
says err "), is not positive; its eigenvalues must be 1 / length^2, above 0"
metrics first/box.sol "1562500 0 100 0 0 100"
vanguard plan -p box --sizes first/box.sol --surface-sizes no
says out "have an aspect above 100 (aspect_max)"
metrics first/box.sol "2500 30 0 100 0 100" "" "100 0 0 100 0 100"
vanguard plan -p box --sizes first/box.sol
exits 1
says err "set metric_order to upper"
vanguard plan -p box --sizes first/box.sol --metric-order upper
exits 0

# refused: a negative size, a wrong number of points, a .sol without its mesh,
# an unknown format
sol first/box.sol -0.006
vanguard mesh -q -p box --sizes first/box.sol --out no
exits 1
says err "first/box.sol: the edge length at point "
says err "), is -0.006; it must be above 0 and finite"
printf 'MeshVersionFormatted 2\nDimension 3\nSolAtVertices\n1\n1 1\n0.1\nEnd\n' \
  >first/box.sol
vanguard mesh -q -p box --sizes first/box.sol --out no
exits 1
says err "first/box.sol has 1 sizes, but first/box.mesh has $points points"
cp first/box.sol lone.sol
vanguard mesh -q -p box --sizes lone.sol --out no
exits 1
says err "there is no lone.mesh"
vanguard mesh -q -p box --sizes first/box.mesh --out no
exits 1
says err "sizes can be read from"
vanguard mesh -q -p box --sizes nowhere.sol --out no
exits 1
says err "nowhere.sol"
[ ! -e no/box.cogsg ] || fail "a refused run wrote a mesh"

# Files that are damaged, or contain other values than announced.
vtu() { # NUMBERS: a .vtu with them as the sizes of its 4 points
  cat <<END
<?xml version="1.0"?>
<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian">
<UnstructuredGrid><Piece NumberOfPoints="4" NumberOfCells="0">
<PointData><DataArray type="Float64" Name="size" format="ascii">
$1</DataArray></PointData>
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">
-9 -9 -9 9 0 0 0 9 0 0 0 9</DataArray></Points></Piece></UnstructuredGrid>
</VTKFile>
END
}
vtu "1 1 1 1 2 2 2 2" >two.vtu
vanguard plan -q -n 1 box --sizes two.vtu
exits 1
says err "two.vtu: array 'size' has more than 4 numbers"
for bytes in 200 300; do
  vtu "1 1 1 1" | head -c $bytes >cut.vtu
  vanguard plan -q -n 1 box --sizes cut.vtu
  exits 1
  says err "cut.vtu: truncated: the file does not end with </VTKFile>"
done
printf '%s\n' "MeshVersionFormatted 2" "Dimension 3" Vertices 1 "0 0 0 1" End \
  >point.mesh
printf '%s\n' "MeshVersionFormatted 2" "Dimension 3" SolAtVertices 1 "1 1" 1 End \
  >point.sol
vanguard plan -q -n 1 box --sizes point.sol
exits 1
says err "point.sol: the mesh of these sizes cannot be read: point.mesh: no tri"
