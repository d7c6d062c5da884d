# SPDX-License-Identifier: LGPL-3.0-or-later
# Files of 4-byte reals: a cube so far from the origin that rounding flattens
# its cells is not written, by any number of ranks, nor is any other file of
# that run.
needs tetgen
cat >far.obj <<'END'
v 1000000 0 0
v 1000001 0 0
v 1000001 1 0
v 1000000 1 0
v 1000000 0 1
v 1000001 0 1
v 1000001 1 1
v 1000000 1 1
f 1 3 2
f 1 4 3
f 5 6 7
f 5 7 8
f 1 2 6
f 1 6 5
f 2 3 7
f 2 7 6
f 3 4 8
f 3 8 7
f 4 1 5
f 4 5 8
END
vanguard mesh -q -p far --farfield none --hmax 0.1 --write lb8.ugrid,lb4.ugrid
exits 1
says err "4-byte reals of a .lb4.ugrid the mesh would have"
says err "flat or inverted cells, the first tetrahedron"
says err "write 8-byte reals, as in .lb8.ugrid"
absent far.lb4.ugrid
absent far.lb8.ugrid
vanguard mesh -q -p far --farfield none --hmax 0.1 --write lb8.ugrid
exits 0
sed 's/v 100000/v /' far.obj >near.obj
vanguard mesh -q -p near --farfield none --hmax 0.1 --write lb4.ugrid
exits 0
vanguard check -q near.lb4.ugrid
exits 0
lacks out "mirrored"

# Such a file from elsewhere: two tetrahedra on the same side of their face,
# where rounding moved the tip of one through it.
le() {
  for v; do
    # shellcheck disable=SC2059 # bytes
    printf "$(printf '\\x%02x\\x%02x\\x%02x\\x%02x' $((v & 255)) \
      $((v >> 8 & 255)) $((v >> 16 & 255)) $((v >> 24 & 255)))"
  done
}
one=0x3f800000 half=0x3f000000
{
  le 5 6 0 2 0 0 0
  le 0 0 0 $one 0 0 0 $one 0 0 0 $one 0 0 $half
  le 1 2 4 2 3 4 3 1 4 2 1 5 3 2 5 1 3 5
  le 1 1 1 1 1 1
  le 1 2 3 4 2 1 3 5
} >bad.lb4.ugrid
vanguard check -q bad.lb4.ugrid
exits 1
says out "mirrored on reading: 1"
says err "the mesh is not valid (inverted cells: 1)"
says err "write 8-byte reals, as in .lb8.ugrid"
vanguard check -q --json bad.lb4.ugrid
exits 1
says out '"cells_turned": 1'
