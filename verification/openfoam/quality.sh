#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# verification/openfoam/quality.sh: does OpenFOAM find the same quality as
# Vanguard's report, for layers of tetrahedra and of prisms?
#
# usage: verification/openfoam/quality.sh [--build DIR | --vanguard PROGRAM]
#            [--work DIR] [--cells N]
#   --build       folder of a build, with bin/vanguard (default build/release)
#   --work        scratch folder, kept (default: a temporary one, removed)
#   --cells       approximate number of cells outside the layers (default 20000)
# The figures of checkMesh -allGeometry are compared with those of the JSON
# report of the run: values must agree to three digits, and numbers of faces
# and cells beyond the limits exactly. Values below 1e-6, which cells with three
# faces on the boundary have, count as 0.
# Exit status: 0 all figures agree, 1 a difference, 2 usage, 77 no OpenFOAM.
set -uo pipefail
export LC_ALL=C

here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
build=$root/build/release vanguard='' work='' cells=20000

usage() { sed -n '2,/^# Exit status/p' "$0" | sed 's/^# \{0,1\}//'; }

while [ $# -gt 0 ]; do
  case $1 in
    --build|--vanguard|--work|--cells|--data)
      [ $# -gt 1 ] || { usage >&2; exit 2; }
      name=${1#--}
      [ "$name" = data ] || declare "${name//-/_}=$2"
      shift ;;
    -h|--help) usage; exit 0 ;;
    *) usage >&2; exit 2 ;;
  esac
  shift
done
[ -n "$vanguard" ] || vanguard=$build/bin/vanguard

if ! command -v checkMesh > /dev/null; then
  echo "SKIP: no OpenFOAM (checkMesh is not in PATH)"
  exit 77
fi
if [ -z "${WM_PROJECT_DIR:-}" ]; then
  set +u
  # shellcheck disable=SC1090
  . "${FOAM_BASHRC:-/usr/share/openfoam/etc/bashrc}" 2> /dev/null
  set -u
fi
if ! checkMesh -help > /dev/null 2>&1; then
  echo "SKIP: OpenFOAM does not start; source its etc/bashrc first"
  exit 77
fi
command -v python3 > /dev/null || { echo "SKIP: no python3"; exit 77; }
[ -x "$vanguard" ] ||
  { echo "no program $vanguard: build it first" >&2; exit 2; }
if [ -z "$work" ]; then
  work=$(mktemp -d "${TMPDIR:-/tmp}/vanguard-quality.XXXXXX")
  trap 'rm -rf "$work"' EXIT
fi
mkdir -p "$work" || exit 2

cat > "$work/compare.py" << 'END'
import json, re, sys

report = json.load(open(sys.argv[1]))["mesh"]["solver_quality"]
log = open(sys.argv[2], errors="replace").read()
beyond = report["beyond_limits"]
failed = 0


def number(pattern):
    found = re.search(pattern, log)
    return float(found.group(1)) if found else None


def row(name, ours, theirs, exact=False):
    global failed
    if theirs is None:
        same = False
    elif exact:
        same = ours == theirs
    else:
        small = abs(ours) < 1e-6 and abs(theirs) < 1e-6
        same = small or abs(ours - theirs) <= 5e-4 * abs(theirs)
    failed += not same
    print("| %s | %.8g | %s | %s |" % (
        name, ours, "none" if theirs is None else "%.8g" % theirs,
        "yes" if same else "NO"))


print("| figure | Vanguard | checkMesh | agree |\n|---|---|---|---|")
real = r"([-+0-9.e]+)"
row("non-orthogonality, largest", report["non_orthogonality_max"],
    number("non-orthogonality Max: " + real))
row("non-orthogonality, mean", report["non_orthogonality_mean"],
    number("non-orthogonality Max: .* average: " + real))
row("skewness, largest", report["skewness_max"],
    number("[Mm]ax skewness = " + real))
row("face weight, smallest", report["face_weight_min"],
    number(r"interpolation weight : minimum: " + real))
row("volume ratio, smallest", report["volume_ratio_min"],
    number(r"volume ratio : minimum: " + real))
row("determinant, smallest", report["determinant_min"],
    number(r"\(wellposedness\) : minimum: " + real))
row("faces above 70 degrees", beyond["non_orthogonality"],
    number(r"> 70 degrees\) faces: ([0-9]+)") or 0, True)
row("faces of skewness above 4", beyond["skewness"],
    number(r"Max skewness = .*?, ([0-9]+) highly skew") or 0, True)
row("faces of weight below 0.05", beyond["face_weight"],
    number(r"small interpolation weight \(< 0.05\) found, number of faces: "
           r"([0-9]+)") or 0, True)
row("faces of volume ratio below 0.01", beyond["volume_ratio"],
    number(r"small volume ratio \(< 0.01\) found, number of faces: "
           r"([0-9]+)") or 0, True)
row("cells of determinant below 0.001", beyond["determinant"],
    number(r"small determinant \(< 0.001\) found, number of cells: "
           r"([0-9]+)") or 0, True)
sys.exit(failed > 0)
END

"$vanguard" demo -c "$cells" -o "$work/demo" wing-half > "$work/log.demo" ||
  { echo "FAIL: vanguard demo"; exit 1; }
failed=0
for kind in tets mixed; do
  d=$work/$kind
  "$vanguard" mesh -q -p "$work/demo/wing-half" --out "$d" --write foam \
    --cells $kind > "$work/log.$kind" 2>&1 ||
    { echo "FAIL: vanguard mesh: $(tail -1 "$work/log.$kind")"; failed=1; continue; }
  (cd "$d/wing-half.openfoam" && timeout 3600 checkMesh -allGeometry) \
    > "$work/checkMesh.$kind" 2>&1 || { echo "FAIL: checkMesh"; failed=1; continue; }
  printf '\n## Layers of %s\n\n' "$kind"
  python3 "$work/compare.py" "$d/wing-half.report.json" \
    "$work/checkMesh.$kind" || failed=1
done
echo
if [ $failed = 0 ]; then echo "All figures agree."; else echo "FAIL: figures differ"; fi
exit $failed
