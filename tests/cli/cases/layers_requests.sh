# SPDX-License-Identifier: LGPL-3.0-or-later
# The request of a patch holds for this patch only, and the report measures each
# patch by its own request: a floor of three patches, the middle one with 4
# layers.
quad() {
  local corner
  for corner in "$1 $2 $3" "$1 $3 $4"; do
    echo " facet normal 0 0 0"; echo "  outer loop"
    for corner in $corner; do echo "   vertex ${corner//,/ }"; done
    echo "  endloop"; echo " endfacet"
  done
}
side() { echo "solid $1"; shift; quad "$@"; }
{
  side front 0,0,0 1,0,0 1,1,0 0,1,0; echo "endsolid front"
  side middle 1,0,0 2,0,0 2,1,0 1,1,0; echo "endsolid middle"
  side rear 2,0,0 3,0,0 3,1,0 2,1,0; echo "endsolid rear"
  for side in roof left right; do
    echo "solid $side"
    for x in 0,1 1,2 2,3; do
      a=${x%,*} b=${x#*,}
      case $side in
        roof) quad "$a,0,1" "$a,1,1" "$b,1,1" "$b,0,1" ;;
        left) quad "$a,0,0" "$a,0,1" "$b,0,1" "$b,0,0" ;;
        right) quad "$a,1,0" "$b,1,0" "$b,1,1" "$a,1,1" ;;
      esac
    done
    echo "endsolid $side"
  done
  side inlet 0,0,0 0,1,0 0,1,1 0,0,1; echo "endsolid inlet"
  side outlet 3,0,0 3,0,1 3,1,1 3,1,0; echo "endsolid outlet"
} >floor.stl
cat >count.deck <<'END'
one patch with a count
first  growth  min_full
1e-3   1.3     98

layers
id      grow  count
front   yes   -
middle  yes   4
rear    yes   -
END
run() {
  vanguard mesh -q -p floor --flow internal --cells mixed --remesh-surface yes \
    --surface-size 0.1 --slip roof,left,right "$@"
}
row() {   # row PATCH COLUMN: a column of the table of levels
  awk -v p="$1" -v k="$2" '$2 == p && NF == 9 { print $k; exit }' out
}

run --deck count.deck
exits 4
says out "full layers"
[ "$(row middle 7)/$(row middle 9)" = 4/4 ] ||
  fail "middle has $(row middle 7) to $(row middle 9) layers, not 4"
[ "$(row front 9)" -ge 14 ] && [ "$(row rear 9)" -ge 14 ] ||
  fail "front and rear have at most $(row front 9) and $(row rear 9) layers"
for patch in front rear; do
  full=$(row $patch 4)
  awk -v f="$full" 'BEGIN { exit !(f > 50 && f < 98) }' ||
    fail "$patch is reported as $full % full"
done
[ "$(row middle 4)" = 100.00 ] || fail "middle is not full"
grep -q "neighbour [1-9]" out || fail "no cause neighbour"

# The same request everywhere is met.
sed 's/^middle .*/middle yes -/' count.deck >same.deck
run --deck same.deck --out same
exits 0
! grep -q "neighbour [1-9]" out || fail "a neighbour limits equal requests"

# A total height is a maximum also where another patch has thinner layers, and a
# first height above it leaves no room.
cat >total.deck <<'END'
a total height between thinner layers
growth
1.3

layers
id      grow  first  total
front   yes   1e-4   -
middle  yes   1e-3   0.01
rear    yes   1e-4   -
END
run --deck total.deck --out total
exits 0
awk '/^  Total height \(length/ { on = 1 } on && $2 == "middle" { print $5
  exit }' out >most
awk '{ exit !(NF == 1 && $1 > 0.004 && $1 < 0.01001) }' most ||
  fail "the highest layers of middle are $(cat most), not 0.01 at most"
sed 's/1e-3   0.01/2e-2   0.01/' total.deck >room.deck
run --deck room.deck --out room
exits 1
says err "on patch 2 the first height, 0.02, exceeds the total height, 0.01"

# Different first heights: each patch has its own, in full.
cat >first.deck <<'END'
different first heights
growth  min_full
1.3     98

layers
id      grow  first
front   yes   1e-5
middle  yes   1e-3
rear    yes   1e-2
END
run --deck first.deck --out first
exits 0
