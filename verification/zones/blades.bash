# SPDX-License-Identifier: LGPL-3.0-or-later
# shellcheck shell=bash disable=SC2154
# The half domain of AFLR3's two rotor blades with their wakes: layers on the blades
# and on both sides of the wakes, which share edges with the blades, with each other,
# with the farfield and with three symmetry planes.

# write_deck: roles and conditions of the patches; the file's settings give the first
# height of the blades, but not that of the wakes, which AFLR3 deletes.
write_deck() {
  cat >blades.deck <<'END'
Two rotor blades and their wakes

patches
id         bc  role
Blade*     4   wall
Wake*      -   sheet
Sym*       1   -
FarField*  3   -

layers
id     first
Wake*  0.0001
END
}

# coverage LOG: full layers on 99 % of the faces of the blades, and of those of the
# wakes that no free edge limits, in the last column.
coverage() {
  awk '/Coverage of the wall faces/ { is_on = 1 }
       is_on && $2 ~ /^Blade[12]$/ { n++; low += $4 < 99 }
       is_on && $2 ~ /^Wake/ { n++; low += $NF < 99 }
       is_on && $2 ~ /^(Blade|Wake)/ {
         print "  full layers on", $2, $4, "%, off free edges", $NF, "%" }
       is_on && $1 == "all" { exit }
       END { exit !(n == 10 && !low) }' "$1"
}

blades() {
  local from=$data/sheets/two_blade_wake_sym name=two_blade_wake_sym
  if [ ! -f "$from.surf.xz" ]; then
    echo "SKIP: there is no $from.surf.xz (--data)"
    return
  fi
  xz -dc "$from.surf.xz" >$name.surf && cp "$from.tags" . && write_deck || return
  timeout 900 "$vanguard" mesh -q $name.surf --deck blades.deck --flow internal \
    --walls 'Blade*,Wake*' --cells mixed --write b8.ugrid --out mesh >mesh.log ||
    { bad "vanguard mesh"; return; }
  coverage mesh.log || bad "the layers"
  "$vanguard" check mesh/$name.b8.ugrid >check.log || bad "vanguard check"
  awk '$6 ~ /^Wake/ { print "  triangles of " $6 ":", $2
                      n += $2 == $3 && $2 == $4 }
       END { exit n != 4 }' check.log || bad "the wakes"
  [ -z "$meshcheck" ] || run 300 "$meshcheck" mesh/$name.b8.ugrid
}
