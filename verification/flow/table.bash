# SPDX-License-Identifier: LGPL-3.0-or-later
# shellcheck shell=bash disable=SC2154
# The table of the results, and the judgement.

# reference ALPHA: lift and drag of CFL3D with Spalart-Allmaras at Mach 0.15 on NASA's
# Turbulence Modeling Resource, https://turbmodels.larc.nasa.gov/naca0012_val_sa.html.
reference() {
  case $1 in
    0) echo 0 0.00819 ;;
    10) echo 1.0909 0.01231 ;;
    15) echo 1.5461 0.02124 ;;
    *) echo 0 0 ;;
  esac
}

# row MESH ALPHA: cells, iterations, lift and drag as means of the last 200 iterations
# with their deviations in per cent, half the range of drag in them in per cent, and the
# last initial residuals of p and Ux.
row() {
  local cells lift drag
  cells=$(awk '$1 == "cells:" { print $2 }' "$1/checkMesh.log")
  read -r lift drag < <(reference "$2")
  awk '/^Time = / { split("", seen) }
       /Initial residual/ { f = $4; sub(",", "", f); r = $8; sub(",", "", r)
         if (!seen[f]++) last[f] = r }
       END { print last["p"], last["Ux"] }' "$1-$2/simpleFoam.log" |
    cat - "$1-$2"/postProcessing/forces/*/coefficient.dat |
    awk -v name="$1" -v cells="$cells" -v lift="$lift" -v drag="$drag" '
      function off(x, to) { return to ? sprintf("%+.2f", 100 * (x / to - 1)) : "-" }
      NR == 1 { p = $1; u = $2; next }
      !/^#/ { d[$1] = $2; l[$1] = $4; n = $1 }
      END { low = high = d[n]
        for (i = n - 199; i <= n; i++) { dm += d[i] / 200; lm += l[i] / 200
          if (d[i] < low) low = d[i]; if (d[i] > high) high = d[i] }
        sub("-", " | ", name)
        printf "| %s | %d | %d | %.4f | %s | %.5f | %s | %.2f | %.0e | %.0e |\n",
          name, cells, n, lm, off(lm, lift), dm, off(dm, drag),
          50 * (high - low) / dm, p, u }'
}

table() {
  echo '| mesh | scale | cells | iterations | lift | off, % | drag | off, % | range, % | residual of p | of Ux |'
  echo '|---|---|---|---|---|---|---|---|---|---|---|'
  local name s
  for name; do
    for s in "${level[@]}"; do row "$name-$s" "$angle"; done
  done
}

# judge TABLE: lift and drag of Vanguard come closer from level to level, to within 2 %.
judge() {
  awk -F' *[|] *' '
    function size(x) { return x < 0 ? -x : x }
    $2 == "vanguard" {
      if (n++ && (size($7) > lift || size($9) > drag)) bad = 1
      lift = size($7); drag = size($9) }
    END { if (n && (bad || lift > 2 || drag > 2)) {
        print "FAILED: not monotone, or not within 2 %"; exit 1 }
      print "good" }' "$1"
}
