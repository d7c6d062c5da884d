# SPDX-License-Identifier: LGPL-3.0-or-later
# Inner surfaces: patches of a box with fluid on both sides.
needs tetgen

# shellcheck source=tests/cli/duct.bash
. "$here/duct.bash"

# A fin that stands on a wall, a free plate that ends on a line of the fin, and
# a wall across, each with free edges or without.
fin="fin 4 4  0.5 0.25 0  0 0.5 0  0 0 0.5"
plate="plate 2 4  0.5 0.25 0.25  0.25 0 0  0 0.5 0"
duct fin "$fin"
duct both "$fin" "$plate"
duct across "mid 8 8  0.5 0 0  0 1 0  0 0 1"
valid fin --baffles fin
valid both --baffles 'fin,plate'
valid across --baffles 7

# The patches of both sides, and the note on them.
vanguard mesh both.stl --flow internal --baffles fin,plate --hmax 0.12 \
  --write b8.ugrid,vtu,su2 --out named
exits 0
says out "inner surfaces: 52 triangles"
says out "patch 7 fin is an inner surface (baffles); its back is patch 9 fin_back"
for name in fin fin_back plate plate_back; do
  says named/both.su2 "MARKER_TAG= $name"
done

# The deck with all settings makes the same mesh.
vanguard mesh both.stl --deck named/both.resolved.deck --quiet --out again \
  --write b8.ugrid
exits 0
same named/both.b8.ugrid again/both.b8.ugrid

# Triangles of a patch that disagree are turned.
awk '/^solid/ { in_fin = /fin/ } /facet normal/ { n++; k = 0 }
  /vertex/ && in_fin && n % 2 { line[k++] = $0
    if (k == 3) print line[0] "\n" line[2] "\n" line[1]
    next } { print }' fin.stl >turned.stl
valid turned --baffles fin
vanguard check turned.stl --flow internal --baffles fin
exits 0
says out "16 triangles of inner surfaces were turned, the first one near (0.5, "
vanguard check fin.stl --flow internal --baffles fin
exits 0
lacks out "turned"

# In an external flow: a disk behind a box, with layers on the box.
duct disk "disk 4 4  1.5 0.25 0.25  0 0.5 0  0 0 0.5"
vanguard mesh disk.stl --flow external --baffles disk --walls 'w*' \
  --first 0.02 --farfield-lengths 4 --quiet --write b8.ugrid --out ext
exits 0
vanguard check ext/disk.b8.ugrid
exits 0

# The two halves on both sides of the wall across are separate.
vanguard check o_across/across.b8.ugrid
says out "connected regions: 2"

vanguard check across.stl --flow internal --baffles mid
exits 0
says out "inner surfaces seal off from the rest: 1;"

# A sheet that misses a wall by rounding is refused; a narrow gap has a note.
duct missed "fin 4 4  0.5 0.25 1e-13  0 0.5 0  0 0 0.5"
vanguard check missed.stl --flow internal --baffles fin
exits 1
says err "patch 7 fin, an inner surface, nearly touches patch 1 w1: "
says err "the narrowest one of 1e-13 near (0.5, "
duct narrow "fin 4 4  0.5 0.25 1e-5  0 0.5 0  0 0 0.5"
vanguard check narrow.stl --flow internal --baffles fin
exits 0
says out "gaps next to inner surfaces that are narrower than 1e-3 of the edges"

# Same bytes with threads and in any decomposition.
ways="advancing octree"
vanguard --version --verbose
grep -q "METIS" out && ways="$ways discrete"
for way in $ways; do
  for threads in 1 3; do
    vanguard mesh both.stl --flow internal --quiet --baffles fin,plate \
      --decompose $way --leaf-cells 1500 --hmax 0.08 --threads $threads \
      --write b8.ugrid --out $way$threads
    exits 0
  done
  same ${way}1/both.b8.ugrid ${way}3/both.b8.ugrid
  vanguard check ${way}1/both.b8.ugrid
  exits 0
done

# --- layers ------------------------------------------------------------------

# On walls only, where they touch a sheet or not; on a sheet that stands on
# walls; where sheets meet; on everything. All faces of the tall sheet but those
# at its free edge have all layers.
duct free "disk 4 4  0.5 0.25 0.25  0 0.5 0  0 0 0.5"
duct tall "tall 8 6  0.5 0 0  0 1 0  0 0 0.75"
valid free --baffles disk --walls 'w*' --first 0.004
valid fin --baffles fin --walls 'w*' --first 0.004
valid both --baffles fin,plate --first 0.004 --cells mixed
valid both --baffles fin,plate --walls '*' --first 0.004 --cells hex
vanguard mesh tall.stl --flow internal --baffles tall --first 0.004 \
  --layer-count 5 --hmax 0.12 --write b8.ugrid --out tall
exits 0
for patch in tall tall_back; do
  [ "$(full out $patch)" = 83.33 ] || fail "layers of $patch"
done
vanguard check tall/tall.b8.ugrid
exits 0

# Hexahedra on both sides of a baffle: the same quadrilaterals, of which some
# triangles are left; check accepts their common points.
for threads in 1 3; do
  vanguard mesh tall.stl --flow internal --baffles tall --first 0.008 --quiet \
    --layer-count 6 --hmax 0.12 --cells hex --threads $threads \
    --write b8.ugrid --out hex$threads
  exits 0
done
same hex1/tall.b8.ugrid hex3/tall.b8.ugrid
vanguard check hex1/tall.b8.ugrid
exits 0
awk '$1 == 7 { front = $2 } $1 == 8 { back = $2 }
  END { exit !(front == 56 && back == 56) }' out ||
  fail "faces of the sides: $(cat out)"

# A sheet without layers ends in a side of the duct in which columns of the
# floor slide: the side is remeshed around it, and the floor has all layers.
duct side "fin 4 4  0.5 0 0.25  0 0.5 0  0 0 0.5"
vanguard mesh side.stl --flow internal --baffles fin --walls w1 --first 0.004 \
  --hmax 0.12 --write b8.ugrid --out side
exits 0
[ "$(full out w1)" = 100.00 ] || fail "layers next to a slit"
vanguard check side/side.b8.ugrid
exits 0
says out "valid"

# The back is as the front, unless a list or a row of the table names it.
cat >tall.deck <<'END'
sheet

layers
id count
tall 6
tall_back 3
END
vanguard mesh tall.stl --flow internal --baffles tall --walls 'tall,w1'   --first 0.004 --hmax 0.12 --write b8.ugrid --out sides
exits 0
[ "$(full out tall)" = 83.33 ] && [ "$(full out tall_back)" = 83.33 ] ||
  fail "layers of both sides"
mkdir rerun
cp tall.stl rerun
cp sides/tall.resolved.deck rerun/tall.deck
vanguard mesh rerun/tall.stl --write b8.ugrid --out resolved
exits 0
same sides/tall.b8.ugrid resolved/tall.b8.ugrid
sed -i s/tall_back/tall_front/ tall.deck
vanguard mesh tall.stl --flow internal --baffles tall --first 0.004
exits 1
says err "no patch of the surface is named 'tall_front'"
rm tall.deck
vanguard mesh tall.stl --flow internal --baffles tall --slip tall_back   --first 0.004 --hmax 0.12 --write b8.ugrid --out one
exits 0
[ -n "$(full out tall)" ] && [ -z "$(full out tall_back)" ] ||
  fail "layers of one side"
vanguard check one/tall.b8.ugrid
exits 0

# A role of the table patches does the same as the list, and its deck as well.
cat >list.deck <<'END'
sheet

baffles  walls
tall     tall

layers
id        first  count
tall      0.004  6
tall_back 0.008  3
END
sed '/^baffles/,/^tall/d' list.deck >role.deck
printf '\npatches\nid role\ntall baffle\n\nwalls\ntall\n' >>role.deck
for by in list role; do
  vanguard mesh tall.stl --deck $by.deck --flow internal --hmax 0.12 \
    --write b8.ugrid --out $by
  exits 0
  [ "$(full out tall)" = 83.33 ] && [ "$(full out tall_back)" = 83.33 ] ||
    fail "layers by $by.deck"
done
same list/tall.b8.ugrid role/tall.b8.ugrid
vanguard mesh tall.stl --deck role/tall.resolved.deck --quiet --write b8.ugrid \
  --out role_again
exits 0
same role/tall.b8.ugrid role_again/tall.b8.ugrid
sed -i '/^walls/,$d' role.deck
vanguard mesh tall.stl --deck role.deck --flow internal --hmax 0.12 \
  --write b8.ugrid --out none
exits 0
says out "table that has no effect because no layers grow: layers"

# Same bytes with threads, in any decomposition.
for way in $ways; do
  for threads in 1 3; do
    vanguard mesh both.stl --flow internal --quiet --baffles fin,plate       --walls '*' --first 0.004 --decompose $way --leaf-cells 3000       --hmax 0.08 --threads $threads --write b8.ugrid --out layers$way$threads
    exits 0
  done
  same layers${way}1/both.b8.ugrid layers${way}3/both.b8.ugrid
  vanguard check layers${way}1/both.b8.ugrid
  exits 0
done

# --- refused -----------------------------------------------------------------

duct cut "cut 2 2  0.3 0.3 0.8  0.4 0 0  0 0.4 0.5"
vanguard mesh cut.stl --flow internal --baffles cut
exits 1
says out "self-intersection: patch 2"
duct out "out 2 2  2 0 0  1 0 0  0 1 0"
vanguard mesh out.stl --flow internal --baffles out
exits 1
says err "patch 7 out, an inner surface, is not in the fluid at (2."
vanguard mesh fin.stl --flow internal --baffles fan
exits 1
says err "fan"
vanguard mesh fin.stl --flow internal --baffles '1-7'
exits 1
says err "all triangles are in inner surfaces"
vanguard mesh fin.stl --flow internal --baffles fin --weld 1e-6
exits 1
says err "cannot be combined with weld"
vanguard mesh fin.stl --flow internal --baffles fin --mesher hxt
exits 1
says err "cannot be combined with mesher"
absent fin.b8.ugrid fin.cogsg

# Defects that a sheet brings in are listed, written, and in the JSON report.
duct inwall "twin 8 8  0 0 0  0 1 0  1 0 0"
vanguard check inwall.stl --flow internal --baffles twin --defects inwall.vtu
exits 1
says out "no defects without the inner surfaces"
says out "duplicate triangles: 128"
[ -s inwall.vtu ] || fail "inwall.vtu is missing"
vanguard check inwall.stl --flow internal --baffles twin --json
exits 1
says out '"kind": "duplicate triangle"'

# Points of sheets are not unused; names of backs differ from other names.
duct back "fin 4 4  0.5 0.25 0  0 0.5 0  0 0 0.5" \
  "fin_back 2 2  0.25 0.25 0.5  0 0.25 0  0 0 0.25"
vanguard check back.stl --flow internal --baffles 'fin*'
exits 0
lacks out "unused"
says out "patch 7 fin is an inner surface (baffles); its back is patch 9 fin_back_9"
vanguard check both.stl --flow external --baffles fin,plate --repair no
lacks out "unused"

# Messages name settings that exist and remedies that apply.
vanguard mesh fin.stl --flow internal --baffles fin --surface-swap yes
exits 1
says err "cannot be combined with surface_swap"
duct open "fin 4 4  0.5 0.25 0  0 0.5 0  0 0 0.5"
sed -i '/solid w6/,/endsolid w6/d' open.stl
vanguard check open.stl --baffles fin
exits 1
lacks err "wrap"
vanguard check o_fin/fin.b8.ugrid --baffles fin
exits 0
says out "baffles has no effect on a volume mesh"

# Without the option the fin is a defect.
vanguard mesh fin.stl --flow internal
exits 1
says err "16 defects"
says err "both sides of its open sheets, give --baffles 7"
vanguard check free.stl --flow internal
exits 1
says err "both sides of its open sheets, give --baffles 7"
vanguard check open.stl
exits 1
lacks err "baffles"

# One of two free sheets is not named.
duct two "disk 4 4  0.5 0.25 0.25  0 0.5 0  0 0 0.5" \
  "fin 4 4  0.25 0.25 0.25  0 0.5 0  0 0 0.5"
vanguard mesh two.stl --flow internal --baffles fin
exits 1
says err "both sides of its open sheets, add 7 to --baffles, --sheets or --zone-interfaces"
lacks err "half"
valid two --baffles fin,7
valid two --baffles fin --sheets 7
