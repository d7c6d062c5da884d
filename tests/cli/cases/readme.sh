# The tour of the README works as a newcomer would type it (with fewer cells).
corners=("1 0 0" "0 1 0" "0 0 1" "-1 0 0" "0 -1 0" "0 0 -1")
facet() {
  echo " facet normal 0 0 0"; echo "  outer loop"
  for corner; do echo "   vertex ${corners[corner]}"; done
  echo "  endloop"; echo " endfacet"
}
{
  echo "solid fuselage"
  facet 0 1 2; facet 1 3 2; facet 3 4 2; facet 4 0 2
  echo "endsolid fuselage"; echo "solid wing"
  facet 1 0 5; facet 3 1 5; facet 4 3 5; facet 0 4 5
  echo "endsolid wing"
} >plane.stl

cp "$here/../cad/wing.step" .
sed 's/solid [a-z]*/&2/; /vertex/ s/vertex \([-0-9]*\)/vertex \1.7/' plane.stl |
  cat plane.stl - >parts.stl

n=0
while IFS= read -r line; do
  line=${line%%#*}
  line=${line//100000/10000}
  line=${line/ wing.step --/ wing.step --edges-per-turn 6 --growth 2 \
    --surface-size 400 --surface-tolerance 20 --hmin 25 --}
  read -ra words <<<"$line"
  "$program" "${words[@]:1}" >out 2>err
  status=$?
  # features that this build lacks
  ! grep -qE "cannot read CAD|cannot wrap" err || status=0
  [ "$status" = 0 ] || fail "$line: exit status $status"
  n=$((n + 1))
done < <(sed -n 's/^    \(vanguard .*\)/\1/p' "$here/../../README.md")
[ "$n" -ge 9 ] || fail "only $n commands in the README"
same work/sphere.b8.ugrid again/sphere.b8.ugrid
exists plane.deck plane.b8.ugrid plane.vtu plane.surface.vtu
says plane.deck 'fuselage'

# The deck in the README can be read, too.
sed -n '/^    Plane at Mach/,/^\[docs/p' "$here/../../README.md" |
  sed -n 's/^    //p;/^$/p' >tour.deck
vanguard mesh -q -p plane.stl --deck tour.deck --out tour
exits 0
says tour/plane.mapbc "fuselage"
