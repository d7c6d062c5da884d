#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# verification/formats/run.sh: compares the contents of the files as other
# programs read them with those of the .b8.ugrid of the same run as `vanguard
# check` reads it: cells of each kind, faces of each patch by name, the volume.
#
# usage: verification/formats/run.sh [--build DIR | --vanguard PROGRAM]
#            [--quick] [--data DIR] [--work DIR]
#   --quick  only the demo wing-half with few layers, all kinds of cells;
#            otherwise with many layers, and DLR-F6 (from --data) with layers
#   --work   scratch folder, kept (default: a temporary one, removed)
# Clients and Debian packages: gmsh (gmsh) for .msh, .mesh; cgnscheck
# (cgns-convert); checkMesh, gmshToFoam and fluent3DMeshToFoam (openfoam) for
# .openfoam, .msh, .fluent.msh; cs_preprocess (code-saturne-bin) for .msh and
# .cgns; FreeFem++ (freefem++ libfreefem++) for .mesh, .meshb; and in Python VTK
# (python3-vtk9) for .vtu, .cgns, .openfoam, .fluent.msh; meshio
# (python3-meshio) for .msh, .meshb, .ugrid, .su2, .vtu; PETSc
# (python3-petsc4py) and Netgen (python3-netgen) for .msh. Nothing is installed:
# clients that are absent are omitted, with a message. The guide's table of
# programs (docs/guide/other_tools.md) states what this script shows; files that
# a client cannot read are tried too, and fail the run when they can be read.
# Exit status: 0 as stated, 1 a difference, 2 usage, 77 no client is installed.
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
readers=$here/readers.py
kinds='tetrahedra|pyramids|prisms|hexahedra'
# The first Python that has the library of a client of readers.py.
python_for() {
  local p
  for p in python3 /usr/bin/python3; do
    "$p" "$readers" has "$1" 2>/dev/null && echo "$p" && return
  done
  return 1
}
saturne=$(command -v cs_preprocess || ls /usr/lib/code_saturne/cs_preprocess \
  2>/dev/null)
# Debian's FreeFem++ does not look where its modules are.
export FF_LOADPATH=${FF_LOADPATH:-/usr/lib/freefem++}

# --- findings, one per line: "tetrahedra N", ..., "patch NAME N", "volume V"
# with five digits, sorted; kinds without cells are omitted ---

# of `vanguard check --json`
of_check() {
  awk '{ gsub("[,\"]", "") }
       $1 ~ /^(tetrahedra|pyramids|prisms|hexahedra):$/ && $2 > 0 {
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
       END { split("4 tetrahedra 7 pyramids 6 prisms 5 hexahedra", k)
         for (i = 1; i < 8; i += 2) if (cell[k[i]]) print k[i + 1], cell[k[i]]
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
         if (type == "PENTA_6") print "prisms", n
         if (type == "HEXA_8") print "hexahedra", n }
       /checking BC / { split($0, q, "\""); bc = q[2] }
       bc && / Range=/ && !/Element/ { gsub("[^0-9]+", " "); split($0, r, " ")
         print "patch", bc, r[2] - r[1] + 1; bc = "" }'
}

# of cs_preprocess
of_saturne() {
  awk '/Number of elements +(tetra4|pyramid5|penta6|hexa8)/ {
         sub("tetra4", "tetrahedra"); sub("pyramid5", "pyramids")
         sub("penta6", "prisms"); sub("hexa8", "hexahedra"); print $4, $NF }
       /^ *Group "/ { split($0, q, "\""); if (q[2] !~ /^[0-9]+$/) g = q[2] }
       /^ *Family [0-9]+$/ { g = "" }
       /Number of boundary faces :/ && !/Main/ && g { print "patch", g, $NF }' |
    sort -u
}

# of checkMesh
of_foam() {
  awk '/^ *(tetrahedra|pyramids|prisms|hexahedra):/ && $2 > 0 {
         print substr($1, 1, length($1) - 1), $2 }
       /Patch +Faces +Points/ { table = 1; next }
       table && NF > 3 { print "patch", $1, $2; next }
       { table = 0 }
       /Total volume/ { sub(".*Total volume = ", ""); sub(/\. .*/, "")
         printf "volume %.5g\n", $0 }'
}

# compare CLIENT [volume|ids|solid]: findings on standard input. Without a word
# there is no volume; "ids": patches are called tag_ID; "solid": no patches.
# Remarks of readers.py are shown.
compare() {
  local want=$d/findings remark
  case ${2:-} in
    volume) ;;
    ids) want=$d/ids ;;
    solid) grep -v '^patch' "$want" > "$want.solid"; want=$want.solid ;;
    *) grep -v '^volume' "$want" > "$want.no_volume"; want=$want.no_volume ;;
  esac
  sort > "$d/$1.all"
  remark=$(grep -E '^(negative|reals)' "$d/$1.all" | tr '\n' ' ')
  [ -z "$remark" ] || echo "  $1: $remark"
  grep -vE '^(negative|reals)' "$d/$1.all" > "$d/$1.findings"
  if diff "$want" "$d/$1.findings" > "$d/$1.diff"; then
    echo "  $1: the same"
  else
    echo "  $1: FAIL, < vanguard, > $1"
    head -10 "$d/$1.diff" | sed 's/^/    /'
    failed=1
  fi
}

# refuses CLIENT COMMAND...: the command must fail.
refuses() {
  local client=$1
  shift
  if "$@" > "$d/log.refuses" 2>&1; then
    echo "  $client: FAIL: it accepts the file; correct the guide"
    failed=1
  else
    echo "  $client: refused, as the guide says"
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
  gmsh "$stem.mesh" -save -format msh22 -o "$d/back.msh" > "$d/log.mesh" 2>&1
  if [ "$1" = tets ]; then
    "$vanguard" check -j "$d/back.msh" 2>/dev/null | of_check |
      grep -v '^patch' | compare gmsh.mesh solid
  else
    refuses gmsh.mesh grep -qE '^[0-9]+ (6|7) ' "$d/back.msh"
  fi
  rm -f "$d/back.msh"
}

ask_cgns() {
  has cgnscheck || return
  cgnscheck -v "$stem.cgns" > "$d/log.cgnscheck" 2>&1
  grep -a ERROR "$d/log.cgnscheck" && { echo "  cgnscheck: FAIL"; failed=1; }
  of_cgnscheck < "$d/log.cgnscheck" | compare cgnscheck
}

# foam_case NAME COMMAND FILE: a converter to OpenFOAM, then checkMesh.
foam_case() {
  mkdir -p "$d/foam/constant"
  cp -r "$stem.openfoam/system" "$d/foam/"
  (cd "$d/foam" && "$2" "$3" && checkMesh) > "$d/log.$1" 2>&1 ||
    { echo "  $1: FAIL: $(tail -1 "$d/log.$1")"; failed=1; }
  sed -n '/^Mesh stats/,$p' "$d/log.$1" | of_foam | compare "$1" volume
  rm -rf "$d/foam"
}

ask_foam() {
  has fluent3DMeshToFoam || return
  foam_case fluent3DMeshToFoam fluent3DMeshToFoam "$stem.fluent.msh"
  checkMesh -case "$stem.openfoam" > "$d/log.case" 2>&1
  of_foam < "$d/log.case" | compare checkMesh volume
  command -v gmsh >/dev/null || return
  gmsh "$stem.msh" -save -format msh41 -o "$d/text.msh" > /dev/null 2>&1
  if [ "$1" = hex ]; then   # it mistakes thin, warped hexahedra for inverted
    mkdir -p "$d/foam/constant"
    cp -r "$stem.openfoam/system" "$d/foam/"
    gmshToFoam -case "$d/foam" "$d/text.msh" > "$d/log.gmshToFoam" 2>&1
    refuses gmshToFoam sh -c "! grep -q '^Inverting' '$d/log.gmshToFoam'"
    rm -rf "$d/foam"
  else foam_case gmshToFoam gmshToFoam "$d/text.msh"
  fi
  mkdir -p "$d/foam/constant"
  cp -r "$stem.openfoam/system" "$d/foam/"
  refuses "gmshToFoam.binary" gmshToFoam -case "$d/foam" "$stem.msh"
  rm -rf "$d/foam" "$d/text.msh"
}

ask_saturne() {
  [ -n "$saturne" ] || { echo "  code_saturne is not installed: omitted"
    return; }
  clients=$((clients + 1))
  for suffix in msh cgns; do
    (cd "$d" && "$saturne" --out saturne "$stem.$suffix") > "$d/log.saturne" 2>&1
    of_saturne < "$d/log.saturne" | compare "code_saturne.$suffix"
    rm -rf "$d/saturne"
  done
}

# freefem FILE: tetrahedra and volume.
freefem() {
  printf '%s\n' 'load "msh3"' "mesh3 Th = readmesh3(\"$1\");" \
    'real v = int3d(Th)(1.);' 'cout.precision(5);' \
    'cout << "tetrahedra " << Th.nt << endl << "volume " << v << endl;' \
    > "$d/read.edp"
  FreeFem++ -nw -v 0 "$d/read.edp"
}

ask_freefem() {
  has FreeFem++ || return
  for suffix in mesh meshb; do
    if [ "$1" = tets ]; then
      freefem "$stem.$suffix" 2>/dev/null | grep -aE '^(tetrahedra|volume) ' |
        compare "FreeFem++.$suffix" solid
    else
      refuses "FreeFem++.$suffix" freefem "$stem.$suffix"
    fi
  done
}

# library CLIENT SUFFIX [volume|ids|solid]
library() {
  local p
  p=$(python_for "$1") || { echo "  $1 is not installed: omitted"; return; }
  clients=$((clients + 1))
  "$p" "$readers" "$1" "$stem.$2" 2> "$d/log.$1" |
    grep -E "^($kinds|kind|patch|volume|negative|reals) " |
    compare "$1.$2" "${3:-}"
}

ask_libraries() {
  local p
  library vtk-vtu vtu solid
  library vtk-cgns cgns volume
  library vtk-foam openfoam volume
  library vtk-fluent fluent.msh solid
  library meshio msh volume
  library meshio b8.ugrid ids
  library meshio meshb ids
  library meshio su2 ids
  library meshio vtu solid
  library petsc msh volume
  if p=$(python_for meshio); then
    refuses meshio.cgns "$p" "$readers" meshio "$stem.cgns"
  fi
  if p=$(python_for petsc); then
    refuses petsc.cgns "$p" "$readers" petsc "$stem.cgns"
  fi
  if p=$(python_for netgen) && command -v gmsh >/dev/null; then
    gmsh "$stem.msh" -save -format msh22 -o "$stem.text.msh" > /dev/null 2>&1
    library netgen text.msh
    rm -f "$stem.text.msh"
  fi
  if command -v gmsh >/dev/null; then
    refuses gmsh.meshb sh -c \
      "gmsh '$stem.meshb' -save -o '$d/x.msh' 2>&1 | grep -q tetrahedra"
  fi
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
    --write b8.ugrid,mapbc,msh,cgns,fluent.msh,foam,su2,vtu,mesh,meshb "$@" \
    > "$d/log.mesh" 2>&1 ||
    { echo "  FAIL: $(grep -a '^vanguard:' "$d/log.mesh" | tail -1)"
      failed=1; return; }
  stem=$(ls "$d"/*.b8.ugrid)
  stem=${stem%.b8.ugrid}
  "$vanguard" check -j "$stem.b8.ugrid" 2>/dev/null | of_check > "$d/findings"
  "$vanguard" check -j "$stem.b8.ugrid" 2>/dev/null |
    sed 's/"name": .*/"name": ,/; s/^ *"id": \(.*\),/"id": tag_\1/' | of_check |
    sed 's/patch_tag_/tag_/' > "$d/ids"
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
  ask_foam "$cells"
  ask_saturne
  ask_freefem "$cells"
  ask_libraries
  rm -rf "$stem".*
}

"$vanguard" demo wing-half --cells 20000 --out "$work/demo" >/dev/null ||
  exit 1
first=()
[ $quick = 0 ] || first=(--first 0.004)
for cells in tets mixed hex; do
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
  for cells in tets mixed hex; do
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
