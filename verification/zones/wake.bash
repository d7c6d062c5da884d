# SPDX-License-Identifier: LGPL-3.0-or-later
# shellcheck shell=bash disable=SC2154
# Half of the ONERA M6 with the wake behind its sharp trailing edge: layers on
# wing and wake, and a generated symmetry plane that is cut along the wake.

wake() {
  local file=$data/field/onera_m6_sharp_te.stp.gz
  if [ ! -f "$file" ]; then
    echo "SKIP: there is no $file (--data)"
    return
  fi
  gunzip -c "$file" >wing.stp || return
  printf 'Wake\n\nwakes\npatch  kind   length  alpha\n*      sheet  0.5     3.09\n' \
    >wake.deck
  "$vanguard" mesh -q wing.stp --deck wake.deck --half y --hmin 4 \
    --surface-size 20 --walls '*' --first 0.02 --layer-count 12 --cells mixed \
    --farfield-lengths 10 --write foam,b8.ugrid --out mesh >mesh.log ||
    { bad "vanguard mesh"; return; }
  # Shares of the faces with all layers, the last one away from free edges.
  awk '$2 ~ /^wake1(_back)?$/ && NF > 8 { print "  full layers on", $2,
         $4, "%, off free edges", $NF, "%"; n++; low += $4 < 95 || $NF < 99 }
       END { exit !(n == 2 && !low) }' mesh.log || bad "the layers"
  "$vanguard" check mesh/wing.b8.ugrid >check.log || bad "vanguard check"
  awk '$6 == "wake1" { print "  triangles of the wake:", $2; n = $2 == $3 && $2 == $4 }
       END { exit !n }' check.log || bad "the wake"
  cd mesh/wing.openfoam && sound
}
