# SPDX-License-Identifier: LGPL-3.0-or-later
# The help of mesh has the twenty most used options first, and then a group for
# each subject, which lists the options of this subject.
vanguard mesh --help
exits 0
# The options of a group: its title, then lines up to an empty one.
group() { sed -n "/^ $1/,/^\$/p" out | grep -oE '^ +(-[a-z], )?--[a-z0-9-]+' |
  sed 's/.*--//' | tr '\n' ' '; }
[ "$(group 'Most used')" = "cells deck farfield first growth hmax layer-count \
layers out project ratio reference-length remesh-surface reynolds scale \
surface-size threads walls write y-plus " ] || fail "most used: $(group 'Most')"
[ "$(grep -nE '^ +--?[a-z]' out | head -1 | cut -d: -f1)" -lt 10 ] ||
  fail "the options do not come first"
expect() { [[ " $(group "$1")" = *" $2 "* ]] || fail "$1 lacks $2"; }
expect "The run" resume
expect "Edge lengths" hmin
expect "Surface and" half
expect "CAD" cad-chord
expect "Remeshing" edges-per-turn
expect "Plane sections" te-cells
expect "Outer" farfield-lengths
expect "Viscous" layer-max
expect "Limits" min-full
expect "Volume" optimise
expect "Domain" leaf-cells
expect "Output" report-html
# No group is empty, and no option is listed twice.
sed -n 's/^ \([A-Z].*:\)$/\1/p' out >titles
[ "$(wc -l <titles)" = 13 ] || fail "$(wc -l <titles) groups, not 13"
while read -r title; do
  [ -n "$(group "$title")" ] || fail "no options under '$title'"
done <titles
for command in mesh surface check plan; do
  vanguard $command --help
  grep -oE '^ +(-[a-z], )?--[a-z0-9-]+' out | sort | uniq -d >twice
  [ ! -s twice ] || fail "$command lists $(cat twice) twice"
done
