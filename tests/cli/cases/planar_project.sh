# SPDX-License-Identifier: LGPL-3.0-or-later
# A .d3m of planar patches meshes without a .front.
cat >T1.d3m <<'END'
#VGRID VERSION
3.6
#Project Name
T1
#
               0 (grid)
            0.15 (rate1)
            0.02 (rate2)
           0.001 (delt1)
             100 (nlayr)
               0 (rstrt)
               1 (ifact)
               1 (vfact)
               0 (strch)
               4 (npoli)
               6 (nline)
               4 (nptch)
               1 (ms)
              20 (ni)
          250000 (mboun)
         2500000 (mpoin)
#
#No.              X-coor            Y-Coor            Z-Coor
1                0.0000000e+00    0.0000000e+00    0.0000000e+00
2                1.0000000e+00    0.0000000e+00    0.0000000e+00
3                0.0000000e+00    1.0000000e+00    0.0000000e+00
4                0.0000000e+00    0.0000000e+00    1.0000000e+00
#
       1       2       1       2

       2       2       2       3

       3       2       1       3

       4       2       1       4

       5       2       2       4

       6       2       3       4
#
       1       1       3       0       2 viscous_surface
                               1       2      -3

       2       1       3       0       1 char_in/outflow
                               4      -5      -1

       3       1       3       0       1 char_in/outflow
                               3       6      -4

       4       1       3       0       1 char_in/outflow
                               5      -6      -2
#
source_number    1                all
0                0                                 (type, stretching)
1                0                0                (an bn alpha)
0.2              0.2                               (S SP point 1)
0.001            0.15             0.02             (delta1 rate1 rate2)
0.2              0.2                               (S SP point 2)
0.001            0.15             0.02             (delta1 rate1 rate2)
1                0                0                (U)
0                0                0                (P)
0                0                0                (point 1)
0                0                0                (point 2)
END
vanguard mesh -q -p T1
exits 0
says out "validity: valid"
vanguard mesh -q -p T1 --deck T1.resolved.deck --out again
exits 0
same T1.b8.ugrid again/T1.b8.ugrid
vanguard mesh -q -p T1 --scale 0.5 --out fine
exits 0
[ "$(stat -c %s fine/T1.b8.ugrid)" -gt "$(stat -c %s T1.b8.ugrid)" ] ||
  fail "a smaller scale made no finer mesh"

# A stretched source has larger cells along its vector P, if strch is 1.
awk '/\(type, stretching\)/ { $0 = "0 1" } /S SP point 1/ { $0 = "0.2 0.4" }
  /\(P\)/ { $0 = "1 0 0" } { print }' T1.d3m >off.d3m
sed 's/ 0 (strch)/ 1 (strch)/' off.d3m >on.d3m
for name in off on; do
  vanguard plan -p $name --json
  exits 0
  cp out $name.json
done
vanguard mesh -q -p off --out off
exits 0
same T1.b8.ugrid off/off.b8.ugrid
expected() {
  sed -n 's/^ *"cells": \([0-9]*\).*/\1/p' "$1" | head -n 1
}
[ "$(expected on.json)" -lt $(($(expected off.json) * 2 / 3)) ] ||
  fail "strch 1: $(expected on.json) cells, strch 0: $(expected off.json)"

# A rate that is given leaves the other rate of the .d3m.
cp "$here/../../examples/wing_body/wing_body.d3m" .
vanguard mesh -q -p wing_body --scale 3 --rate2 0.01 --out rates
exits 0
resolved() {   # the value of a setting, in the line below its name
  awk -v name="$1" 'k { print $k; exit }
    { for (i = 1; i <= NF; i++) if ($i == name) k = i }' \
    rates/wing_body.resolved.deck
}
rates="$(resolved rate1) $(resolved rate2)"
[ "$rates" = "0.18 0.01" ] || fail "rates '$rates' instead of 0.18 and 0.01"
