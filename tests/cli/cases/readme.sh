# SPDX-License-Identifier: LGPL-3.0-or-later
# The commands of the README work as a newcomer would type them (coarser), and
# its figures are those of the guide, which cli.guide holds against the report.
root=$(realpath "$here/../..")
ln -s "$root/examples" examples
readme=$root/README.md
page=$root/docs/guide/wing_from_cad.md

n=0
while IFS= read -r line; do
  line=${line%%#*}
  read -ra words <<<"$line"
  [ "${words[1]}" = check ] || words+=(--scale 2)
  "$program" "${words[@]:1}" >out 2>err
  status=$?
  # features that this build lacks
  ! grep -q "cannot read CAD" err || skip "built without CAD"
  [ "$status" = 0 ] || fail "$line: exit status $status"
  n=$((n + 1))
done < <(sed -n 's/^    \(vanguard .*\)/\1/p' "$readme")
[ "$n" -ge 3 ] || fail "only $n commands in the README"
exists wing/wing.b8.ugrid wing/wing.fun3d.mapbc wing/wing.report.html \
  wing/wing.resolved.deck

# The deck in it is that of the example.
sed -n '/^    Swept wing/,/^[A-Z]/p' "$readme" | sed -n 's/^    //p;/^$/p' |
  sed '$d' >shown.deck
same shown.deck examples/wing_from_cad/half_wing.deck

# Figures: "| name | value |" here, "| name | key | value | ..." there.
n=0
while IFS='|' read -r _ name value _; do
  [ "$name" != " figure " ] || continue
  grep -qF "|$name|" "$page" && grep -F "|$name|" "$page" | grep -qF "|$value|" ||
    fail "the guide has no '$name' of$value"
  n=$((n + 1))
done < <(sed -n '/^| figure | value |/,/^$/p' "$readme" | grep '[0-9]')
[ "$n" -ge 6 ] || fail "only $n figures in the README"
