# SPDX-License-Identifier: LGPL-3.0-or-later
# Quality in the terms of solvers: in the reports of a run and of the check,
# and limits on it.
vanguard demo box --cells 4000 --out p
exits 0
vanguard mesh -q -p p/box --walls 5 --first 2e-3 --cells mixed --leaf-cells 1000 \
  --write b8.ugrid --out one
exits 0
says out "quality in the terms of solvers"
says out "non-orthogonality (degrees)"
says one/box.report.json '"limits_missed": []'
says one/box.report.html '<section id="solvers"'

# The check of the file, in one piece, finds the same as the run, in slices.
figures() {
  sed -n '/"solver_quality"/,/"histogram_non_orthogonality"/p' "$1" |
    sed 's/^ *//'
}
vanguard check -q --json one/box.b8.ugrid
exits 0
cp out check.json
figures check.json >check.txt
figures one/box.report.json >run.txt
[ "$(wc -l <run.txt)" -gt 15 ] || fail "no figures in the report of the run"
same check.txt run.txt
vanguard check -q one/box.b8.ugrid
exits 0
says out "Non-orthogonality of each face (degrees)"
says out "Worst orthogonal quality"

# The cells as a file for ParaView.
vanguard check -q one/box.b8.ugrid --vtu cells.vtu
exits 0
says out "quality of the cells: cells.vtu"
for name in non_orthogonality skewness orthogonal_quality; do
  grep -qa "Name=\"$name\"" cells.vtu || fail "no $name in cells.vtu"
done

# Limits that are met, and limits that are not.
vanguard check -q one/box.b8.ugrid --max-non-orthogonality 180 \
  --max-skewness 1e6 --min-face-weight 0 --min-orthogonal-quality 0
exits 0
vanguard check -q one/box.b8.ugrid --max-non-orthogonality 1 \
  --max-skewness 0.01 --min-face-weight 0.5 --min-orthogonal-quality 1
exits 4
says err "limit not met: mesh: max_non_orthogonality is 1 degrees, reached "
says err "max_skewness is 0.01, reached "
says err "min_face_weight is 0.5, reached "
says err "min_orthogonal_quality is 1, reached "
vanguard check -q --json one/box.b8.ugrid --max-skewness 0.01
exits 4
says out '"limit": "max_skewness"'
vanguard mesh -q -p p/box --walls 5 --first 2e-3 --cells mixed --leaf-cells 1000 \
  --write b8.ugrid --max-non-orthogonality 1 --out two
exits 4
says err "limit not met: mesh: max_non_orthogonality is 1 degrees, reached "
says two/box.report.json '"limit": "max_non_orthogonality"'
says two/box.report.html "1 limit on the mesh not met"
same one/box.b8.ugrid two/box.b8.ugrid
vanguard check -q one/box.b8.ugrid --min-orthogonal-quality 2
exits 2

# The median dual: on request, the same from slices and from the file.
absent_in() {
  if grep -q "$2" "$1"; then fail "$2 in $1"; fi
}
absent_in check.json median_dual
absent_in one/box.report.json '"median_dual": {'
dual() {
  sed -n '/"median_dual": {/,/"worst_volume_ratio"/p' "$1" | sed 's/^ *//'
}
vanguard check -q --json one/box.b8.ugrid --median-dual yes
exits 0
dual out >check.txt
vanguard mesh -q -p p/box --walls 5 --first 2e-3 --cells mixed --leaf-cells 1000 \
  --write b8.ugrid --median-dual yes --out three
exits 0
says out "orthogonality of the median dual (degrees; 90 is best)"
says three/box.report.html "Orthogonality of the median dual"
same one/box.b8.ugrid three/box.b8.ugrid
dual three/box.report.json >run.txt
[ "$(wc -l <run.txt)" -gt 40 ] || fail "no median dual in the report of the run"
same check.txt run.txt
vanguard check -q one/box.b8.ugrid --min-dual-orthogonality 0
exits 0
says out "orthogonality of the median dual (degrees; 90 is best)"
says out "Worst orthogonality of faces of the median dual"
vanguard check -q one/box.b8.ugrid --min-dual-orthogonality 89
exits 4
says err "limit not met: mesh: min_dual_orthogonality is 89 degrees, reached "

# A surface has no cells on which the limits could hold.
vanguard check -q p/box.lb8.ugrid --max-skewness 1
exits 0
says out "have no effect because there are no cells to judge: max_skewness"
