#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# verification/formats/run.sh: compares the contents of the files as other
# programs read them with those of the .b8.ugrid of the same run as `vanguard
# check` reads it: cells of each kind, faces of each patch by name, the volume.
#
# usage: verification/formats/run.sh [--build DIR | --vanguard PROGRAM]
#            [--quick] [--data DIR] [--work DIR]
#   --quick  only the demo wing-half with few layers, tetrahedra and mixed;
#            otherwise with many layers, and DLR-F6 (from --data) with layers
#   --work   scratch folder, kept (default: a temporary one, removed)
# Clients: gmsh, which reads .msh, prints the volume and saves the mesh as text
# of version 2.2; cgnscheck and VTK's reader (python3-vtk9) for .cgns;
# fluent3DMeshToFoam and checkMesh for .fluent.msh. Clients that are not
# installed are omitted, with a message.
# Exit status: 0 equal, 1 a difference, 2 usage, 77 no client is installed.
set -uo pipefail
shopt -s lastpipe   # keep variables set by `compare` at the end of a pipe
export LC_ALL=C

here=$(cd "$(dirname "$0")" && pwd)
vanguard=$here/../../build/release/bin/vanguard work='' data='' quick=0

usage() { sed -n '2,/^# Exit status/p' "$0" | sed 's/^# \{0,1\}//'; }

while [ $# -gt 0 ]; do
  case $1 in
    --build) vanguard=$2/bin/vanguard; shift ;;
    --vanguard) vanguard=$2; shift ;;
    --data) data=$2; shift ;;
    --work) work=$2; shift ;;
    --quick) quick=1 ;;
    -h|--help) usage; exit 0 ;;
    *) usage >&2; exit 2 ;;
  esac
  shift
done
vanguard=$(realpath "$vanguard") || exit 2
[ -x "$vanguard" ] || { echo "no program $vanguard: build it first" >&2
  exit 2; }
if [ -z "$work" ]; then
  work=$(mktemp -d "${TMPDIR:-/tmp}/vanguard-formats.XXXXXX")
  trap 'rm -rf "$work"' EXIT
fi
mkdir -p "$work" || exit 2

failed=0 clients=0

# The environment of Debian's OpenFOAM; its script prints warnings.
if command -v fluent3DMeshToFoam >/dev/null && [ -z "${WM_PROJECT_DIR:-}" ]
then
  set +u
  # shellcheck disable=SC1090
  . "${FOAM_BASHRC:-/usr/share/openfoam/etc/bashrc}" 2>/dev/null
  set -u
fi
python=
for p in python3 /usr/bin/python3; do
  [ -z "$python" ] && "$p" -c 'import vtkmodules.vtkIOCGNSReader' 2>/dev/null &&
    python=$p
done

# --- findings, one per line: "tetrahedra N", ..., "patch NAME N", "volume V"
# with five digits, sorted; kinds without cells are omitted ---

# of `vanguard check --json`
of_check() {
  awk '{ gsub("[,\"]", "") }
       $1 ~ /^(tetrahedra|pyramids|prisms):$/ && $2 > 0 {
         print substr($1, 1, length($1) - 1), $2 }
       $1 == "id:" { id = $2 }
       $1 == "name:" { name = NF > 1 ? $2 : "patch_" id }
       $1 == "faces:" { print "patch", name, $2 }
       $1 == "volume:" { printf "volume %.5g\n", $2 }' | sort
}

# of a .msh, version 2.2
of_gmsh() {
  awk '$1 ~ /^\$/ { section = $1; next }
       section == "$PhysicalNames" && $1 == 2 {
         gsub("\"", ""); name[$2] = $3 }
       section == "$Elements" && NF > 4 {
         if ($2 == 2 || $2 == 3) face[$4]++
         else cell[$2]++ }
       END { split("4 tetrahedra 7 pyramids 6 prisms", k)
         for (i = 1; i < 6; i += 2) if (cell[k[i]]) print k[i + 1], cell[k[i]]
         for (p in face) print "patch", name[p], face[p] }' "$1"
  awk '/Mesh volume/ { printf "volume %.5g\n", $NF }' "$2"
}

# of cgnscheck -v, which prints no volume
of_cgnscheck() {
  awk '/checking element set/ { set = $4; gsub("\"", "", set) }
       /Element Set Type/ { sub(".*=", ""); type = $0 }
       /Element Range=/ { gsub("[^0-9]+", " "); split($0, r, " ")
         n = r[2] - r[1] + 1
         if (type == "TETRA_4") print "tetrahedra", n
         if (type == "PYRA_5") print "pyramids", n
         if (type == "PENTA_6") print "prisms", n }
       /checking BC / { split($0, q, "\""); bc = q[2] }
       bc && / Range=/ && !/Element/ { gsub("[^0-9]+", " "); split($0, r, " ")
         print "patch", bc, r[2] - r[1] + 1; bc = "" }'
}

cat > "$work/read_cgns.py" <<'END'
import sys
from vtkmodules.vtkFiltersVerdict import vtkCellSizeFilter
from vtkmodules.vtkIOCGNSReader import vtkCGNSReader

kinds = {10: "tetrahedra", 14: "pyramids", 13: "prisms"}
reader = vtkCGNSReader()
reader.SetFileName(sys.argv[1])
reader.UpdateInformation()
reader.EnableAllBases()
reader.LoadBndPatchOn()
reader.Update()
zone = reader.GetOutput().GetBlock(0).GetBlock(0)
cells, patches = zone.GetBlock(0), zone.GetBlock(1)
n = dict.fromkeys(kinds, 0)
for i in range(cells.GetNumberOfCells()):
    n[cells.GetCellType(i)] += 1
for code in kinds:
    if n[code]:
        print(kinds[code], n[code])
for i in range(patches.GetNumberOfBlocks()):
    print("patch", patches.GetMetaData(i).Get(patches.NAME()),
          patches.GetBlock(i).GetNumberOfCells())
size = vtkCellSizeFilter()
size.SetInputData(cells)
size.Update()
# the reader keeps CGNS's order of prism nodes, which VTK reads as inverted
volume = size.GetOutput().GetCellData().GetArray("Volume")
print("volume %.5g" % sum(abs(volume.GetValue(i))
                          for i in range(cells.GetNumberOfCells())))
END

# of checkMesh
of_foam() {
  awk '/^ *(tetrahedra|pyramids|prisms):/ && $2 > 0 {
         print substr($1, 1, length($1) - 1), $2 }
       /Patch +Faces +Points/ { table = 1; next }
       table && NF > 3 { print "patch", $1, $2; next }
       { table = 0 }
       /Total volume/ { sub(".*Total volume = ", ""); sub(/\. .*/, "")
         printf "volume %.5g\n", $0 }'
}

# compare CLIENT [volume]: findings on standard input, with the volume if
# "volume" is given.
compare() {
  local want=$d/findings
  if [ $# = 1 ]; then
    grep -v '^volume' "$want" > "$want.no_volume"
    want=$want.no_volume
  fi
  sort > "$d/$1.findings"
  if diff "$want" "$d/$1.findings" > "$d/$1.diff"; then
    echo "  $1: the same"
  else
    echo "  $1: FAIL, < vanguard, > $1"
    head -10 "$d/$1.diff" | sed 's/^/    /'
    failed=1
  fi
}

has() {
  if command -v "$1" >/dev/null; then clients=$((clients + 1)); return 0; fi
  echo "  $1 is not installed: omitted"
  return 1
}

# --- the clients ---

ask_gmsh() {
  has gmsh || return
  printf 'Merge "%s";\nPlugin(MeshVolume).Dimension = 3;\n%s' "$stem.msh" \
    'Plugin(MeshVolume).Run;' > "$d/volume.geo"
  gmsh "$stem.msh" -save -format msh22 -o "$d/back.msh" > "$d/log.gmsh" 2>&1 &&
    gmsh -parse_and_exit "$d/volume.geo" > "$d/log.volume" 2>&1 ||
    { echo "  gmsh: FAIL: $(tail -1 "$d/log.gmsh")"; failed=1; return; }
  # gmsh integrates with one point, which is exact only for tetrahedra
  if [ "$1" = tets ]; then
    of_gmsh "$d/back.msh" "$d/log.volume" | compare gmsh volume
  else
    of_gmsh "$d/back.msh" /dev/null | compare gmsh
  fi
  # and Vanguard reads the file that gmsh saved
  "$vanguard" check -j "$d/back.msh" 2>/dev/null | of_check |
    compare back.msh volume
  rm -f "$d/back.msh"
}

ask_cgns() {
  if has cgnscheck; then
    cgnscheck -v "$stem.cgns" > "$d/log.cgnscheck" 2>&1
    grep -a ERROR "$d/log.cgnscheck" && { echo "  cgnscheck: FAIL"; failed=1; }
    of_cgnscheck < "$d/log.cgnscheck" | compare cgnscheck
  fi
  if [ -n "$python" ]; then
    clients=$((clients + 1))
    "$python" "$work/read_cgns.py" "$stem.cgns" | compare vtk volume
  else
    echo "  VTK's reader (python3-vtk9) is not installed: omitted"
  fi
}

ask_foam() {
  has fluent3DMeshToFoam || return
  mkdir -p "$d/foam/constant"
  cp -r "$stem.openfoam/system" "$d/foam/"
  (cd "$d/foam" && fluent3DMeshToFoam "$stem.fluent.msh" && checkMesh) \
    > "$d/log.foam" 2>&1 ||
    { echo "  fluent3DMeshToFoam: FAIL: $(tail -1 "$d/log.foam")"; failed=1; }
  of_foam < "$d/log.foam" | compare fluent volume
  rm -rf "$d/foam"
}

# --- the meshes ---

# check_case NAME PROJECT CELLS OPTIONS...
check_case() {
  local name=$1 project=$2 cells=$3
  shift 3
  d=$work/$name-$cells
  mkdir -p "$d"
  echo "$name, $cells"
  "$vanguard" mesh -q -p "$project" --out "$d" --cells "$cells" \
    --write b8.ugrid,mapbc,msh,cgns,fluent.msh,foam,su2 "$@" \
    > "$d/log.mesh" 2>&1 ||
    { echo "  FAIL: $(grep -a '^vanguard:' "$d/log.mesh" | tail -1)"
      failed=1; return; }
  stem=$(ls "$d"/*.b8.ugrid)
  stem=${stem%.b8.ugrid}
  "$vanguard" check -j "$stem.b8.ugrid" 2>/dev/null | of_check > "$d/findings"
  grep -vc patch "$d/findings" | grep -qv '^[01]$' ||
    { echo "  FAIL: nothing found in the .b8.ugrid"; failed=1; return; }
  awk '$1 == "patch" { p++; f += $3; next }
       { printf "%s %s, ", $2, $1 }
       END { printf "%d patches with %d faces\n", p, f }' "$d/findings" |
    sed 's/^/  /'
  for suffix in msh cgns; do
    "$vanguard" check -j "$stem.$suffix" 2>/dev/null | of_check |
      compare "vanguard.$suffix" volume
  done
  ask_gmsh "$cells"
  ask_cgns
  ask_foam
  rm -rf "$stem".*
}

"$vanguard" demo wing-half --cells 20000 --out "$work/demo" >/dev/null ||
  exit 1
first=()
[ $quick = 0 ] || first=(--first 0.004)
for cells in tets mixed; do
  check_case wing "$work/demo/wing-half" $cells "${first[@]}"
done
# patches without conditions and names
mkdir -p "$work/bare"
cp "$work/demo/wing-half.lb8.ugrid" "$work/bare/"
check_case bare "$work/bare/wing-half.lb8.ugrid" mixed --layers yes \
  --walls 1-3 --first 0.004 --farfield none
f6=$data/transport/dlr_f6_wbnp_half_coarse.lb8.ugrid.xz
if [ $quick = 0 ] && [ -e "$f6" ]; then
  xz -dc "$f6" > "$work/f6.lb8.ugrid"
  for cells in tets mixed; do
    check_case dlr_f6 "$work/f6.lb8.ugrid" $cells --layers yes --walls 1-123 \
      --reynolds 3e6 --reference-length 141.2 --y-plus 1
  done
elif [ $quick = 0 ]; then
  echo "no $f6: DLR-F6 omitted (verification/fetch.md has the source)"
fi
[ $failed = 1 ] && exit 1
[ $clients -gt 0 ] || { echo "SKIP: none of the clients is installed"
  exit 77; }
echo good
