# SPDX-License-Identifier: LGPL-3.0-or-later
# Bodies that intersect are united, unless they are wrapped; the files are the
# same for any number of ranks.
needs wrap
octahedron >two.obj
octahedron | sed 's/^g .*/g other/' | awk '$1 == "v" { print "v", $2 + 0.7, $3,
  $4; next } $1 == "f" { print "f", $2 + 6, $3 + 6, $4 + 6; next } { print }' \
  >>two.obj
vanguard check two.obj
exits 0
says out "were united: 2 shells became 1, 16 triangles became"
vanguard mesh -q -p two.obj --wrap 0.2 --out one
exits 0
says out "note: the surface was wrapped: 16 triangles replaced by"
says out "patches left without triangles: 0"
says one/two.resolved.deck "wrap"
vanguard check one/two.b8.ugrid
exits 0
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 \
  OMPI_MCA_rmaps_base_oversubscribe=1 OMPI_MCA_hwloc_base_binding_policy=none
if mpirun -n 2 true >/dev/null 2>&1; then
  ASAN_OPTIONS=$ASAN_OPTIONS:detect_leaks=0 mpirun -n 3 "$program" mesh -q -p two.obj --wrap 0.2 \
    --test-node-ranks 2 --out three >out 2>err
  status=$?
  exits 0
  same one/two.b8.ugrid three/two.b8.ugrid
fi
# an outer boundary is kept, and refused where a body intersects it
printf '1 5000 far\n' >two.mapbc
sed -i '1i 1' two.mapbc
vanguard mesh -q -p two.obj --wrap 0.2 --out far
exits 1
says err "outer boundary"
rm two.mapbc
vanguard mesh -q -p two.obj --wrap 1e-6 --out small
exits 1
says err "in the unit of the surface?"
absent small/two.b8.ugrid
# a wrap that enters through a hole would have fluid inside; closing it works
octahedron | grep -v '^f 1 3 5' >open.obj
vanguard mesh -q -p open.obj --wrap 0.1 --out hollow
exits 1
says err "close_holes yes"
absent hollow/open.b8.ugrid
vanguard mesh -q -p open.obj --wrap 0.1 --close-holes yes --out closed
exits 0
# a patch that walls name does not disappear without a message
octahedron >nested.obj
octahedron | awk '$1 == "v" { print "v", $2 / 4, $3 / 4, $4 / 4; next }
  $1 == "f" { print "f", $2 + 6, $3 + 6, $4 + 6; next } { print "g inner" }' \
  >>nested.obj
vanguard mesh -q -p nested.obj --flow external --wrap 0.2 --walls 1-2 \
  --out lost
exits 1
says err "nothing is left of patch 2"

# A size that is large compared with the body.
octahedron >octa.obj
vanguard check -q octa.obj --wrap 50
exits 1
says err "since the body is only 2 long; take a smaller size"

# A narrow hole and an inner wall leave one reading each: the remedy is applied
# unless repair is no. The mesh is that of the option, for any number of ranks.
octahedron | sed '/^f 1 3 5$/d' >hole.obj
printf 'v %s\n' "0.37 0.315 0.315" "0.315 0.37 0.315" "0.315 0.315 0.37" \
  >>hole.obj
printf 'f %s\n' "1 3 8" "1 8 7" "3 5 9" "3 9 8" "5 1 7" "5 7 9" >>hole.obj
octahedron >wall.obj
echo "f 1 3 2" >>wall.obj
for name in hole wall; do
  vanguard mesh -q -p $name.obj --repair no --out none
  exits 1
  vanguard check -q $name.obj
  exits 1
  remedy=$(sed -n 's/.*\(--[a-z-]* [a-z0-9.]*\) \(closes\|puts\).*/\1/p' err)
  vanguard mesh -q -p $name.obj --out by_itself
  exits 0
  says out "$remedy"
  says out "the program does this by itself"
  # shellcheck disable=SC2086 # an option and its value
  vanguard mesh -q -p $name.obj $remedy --out by_option
  exits 0
  lacks out "the program does this by itself"
  same by_itself/$name.b8.ugrid by_option/$name.b8.ugrid
  mpirun -n 2 true >/dev/null 2>&1 || continue
  ASAN_OPTIONS=$ASAN_OPTIONS:detect_leaks=0 mpirun -n 3 "$program" mesh -q \
    -p $name.obj --test-node-ranks 2 --out by_ranks >out 2>err
  status=$?
  exits 0
  same by_itself/$name.b8.ugrid by_ranks/$name.b8.ugrid
done

# A wrap that may be a room around bodies is left to the user: houses that cross
# the floor of a tunnel, one with a sheet.
box() { # X0 Y0 Z0 X1 Y1 Z1 POINTS_BEFORE
  echo "$1 $2 $3 $4 $5 $6 $7" | awk '{
    for (i = 0; i < 8; i++)
      print "v", (i % 2 ? $4 : $1), (int(i / 2) % 2 ? $5 : $2), (i > 3 ? $6 : $3)
    split("1 3 4 2 5 6 8 7 1 2 6 5 3 7 8 4 1 5 7 3 2 4 8 6", f, " ")
    for (i = 1; i < 24; i += 4) {
      print "f", $7 + f[i], $7 + f[i + 1], $7 + f[i + 2]
      print "f", $7 + f[i], $7 + f[i + 2], $7 + f[i + 3] } }'
}
{ box 0 0 0 10 4 4 0; box 2 1 -0.2 3 3 1 8; box 4 1 -0.2 5 3 1 16
  box 6 1 -0.2 7 3 1 24; echo "v 2.5 1 1.5"; echo "f 13 14 33"; } >room.obj
vanguard mesh -q -p room.obj --out room
exits 1
says err "puts a closed surface around it"
exists room/room.defects.vtu
absent room/room.b8.ugrid
