# SPDX-License-Identifier: LGPL-3.0-or-later
# Meshes in two dimensions from plane sections: cells, angles and patches, the
# formats, the same bytes for all threads and ranks, families, and refusals.
vanguard demo aerofoil --out d
exits 0
says out "Next: vanguard mesh -p d/aerofoil"
formats=su2,msh,foam,b8.ugrid,fun3d.mapbc
vanguard --version --verbose
if grep -qE "HDF5 +not in" out; then cgns=; else cgns=,cgns; fi
vanguard mesh -q -p d/aerofoil --out a --write $formats$cgns \
  --min-full 100 --threads 1
exits 0
says out "trailing edge at (1, 0) sharp, 1 corners"
says out "triangles with an angle below 10, 20, 30 degrees: 0 0 0"
says a/aerofoil.su2 "NDIME= 2"
says a/aerofoil.su2 "MARKER_TAG= NACA_0012"
says a/aerofoil.su2 "MARKER_TAG= farfield"
says a/aerofoil.msh "2 3 \"fluid\""
says a/aerofoil.fun3d.mapbc "6663"
grep -c "type  *empty" a/aerofoil.openfoam/constant/polyMesh/boundary >count
[ "$(cat count)" = 2 ] || fail "not two empty patches"
says a/aerofoil.report.json '"plane": {'

# Every rank and every thread gives the same files.
vanguard mesh -q -p d/aerofoil --out b --write $formats$cgns \
  --min-full 100 --threads 3
exits 0
for file in su2 msh b8.ugrid mapbc resolved.deck wall.vtu ${cgns#,}; do
  same a/aerofoil.$file b/aerofoil.$file
done
same a/aerofoil.openfoam/constant/polyMesh/faces \
  b/aerofoil.openfoam/constant/polyMesh/faces

# The checks of the mesh one cell thick.
vanguard check -q a/aerofoil.b8.ugrid
exits 0
says out "validity: valid"
vanguard check -q d/aerofoil.dat --deck d/aerofoil.deck
exits 0
grep -qE "^ +126 .* NACA_0012$" out || fail "no edges of the element"
says out "vanguard mesh accepts this section"
grep -qE "needle|narrow strip|triangles" out && fail "check describes the strip"
vanguard check -q d/aerofoil.dat --deck d/aerofoil.deck --json
exits 0
grep -q needles out && fail "check describes the strip"

# Cells across a blunt trailing edge; the plane of FUN3D.
vanguard demo aerofoil-blunt --out d
exits 0
vanguard mesh -q -p d/aerofoil-blunt --out e --te-cells 9 --section-axis y \
  --section-width 0.5 --write su2,b8.ugrid,fun3d.mapbc
exits 0
says out "blunt, 0.00252 wide (0.252 % of the chord), 2 corners"
says e/aerofoil-blunt.fun3d.mapbc "6662"
awk '/NPOIN/ { n = $2; next } n > 0 { n--; if ($1 == 1 && $2 > -0.0013 &&
     $2 < 0.0013) on++ } END { exit on != 10 }' e/aerofoil-blunt.su2 ||
  fail "not 9 edges across the trailing edge"

# A family: half the edges, four times the cells.
cells()
{
  sed -n 's/^NELEM= //p' "$1"
}
for scale in 1 0.5; do
  vanguard mesh -q -p d/aerofoil --out f$scale --write su2 --scale $scale \
    --scale-layers even
  exits 0
done
awk -v a="$(cells f1/aerofoil.su2)" -v b="$(cells f0.5/aerofoil.su2)" \
  'BEGIN { exit !(b / a > 3.8 && b / a < 4.2) }' || fail "not a family"

# Two elements, without layers, in a box; a source refines the wake.
cat >two.dat <<'END'
main
1 0
0.5 0.1
0.2 0.08
0 0
0.2 -0.08
0.5 -0.1
1 0
flap
1.5 -0.1
1.3 -0.05
1.1 -0.08
1.3 -0.12
1.5 -0.1
END
cat >two.deck <<'END'
two elements

layers
no

farfield
kind  lengths
box   10

sources
kind  x0   y0    z0  x1  y1    z1  h0    r0
line  1.5  -0.1  0   4   -0.1  0   0.05  0.1
END
vanguard mesh -q -p two.dat --out g --write su2
exits 0
says g/two.su2 "MARKER_TAG= flap"
says out "quadrilaterals                         0"

# A C, half a circle upstream and straight sides downstream.
vanguard mesh -q -p d/aerofoil --farfield c --farfield-size 5 --out c \
  --write su2,b8.ugrid --min-full 100
exits 0
vanguard check -q c/aerofoil.b8.ugrid
exits 0
says out "validity: valid"
awk '/^NPOIN/ { n = $2; next } n > 0 { n--; x = $1 - 0.5
       if (x > 4.999999) right = 1
       if (x < -4.99999) left = 1
       bad += x > 5.000001 || (x < 0 && x * x + $2 * $2 > 25.001) ||
              $2 * $2 > 25.001 }
     END { exit bad || !right || !left }' c/aerofoil.su2 || fail "not a C"

# A tunnel, whose walls have layers if they are named.
for walls in "" "*"; do
  vanguard mesh -q -p d/aerofoil --farfield tunnel --farfield-size 2 --out t \
    --walls "$walls" --write su2,b8.ugrid,fun3d.mapbc --min-full 100
  exits 0
  for name in lower upper inlet outlet; do
    says t/aerofoil.su2 "MARKER_TAG= $name"
  done
  vanguard check -q t/aerofoil.b8.ugrid
  exits 0
  says out "validity: valid"
  if [ "$walls" ]; then code=4000; else code=3000; fi
  says t/aerofoil.fun3d.mapbc "2 $code lower"
done
sed "s/^NACA.*/lower/" d/aerofoil.dat >lower.dat
vanguard mesh -q -p lower.dat --layers no --farfield tunnel --out x
exits 1
says err "rename the element"
for name in farfield back front; do
  sed "s/^NACA.*/$name/" d/aerofoil.dat >$name.dat
  vanguard mesh -q -p $name.dat --layers no --out x
  exits 1
  says err "an element of the section has the name $name, which a s"
done
vanguard demo sphere --out d
vanguard mesh -q -p d/sphere --farfield c --out x
exits 1
says err "plane sections (.dat) only"

# Edges across the slot between two plates.
printf '%s\n' one "1 0.1" "0 0.1" "0 0" "1 0" two "1 -0.02" "0 -0.02" \
  "0 -0.12" "1 -0.12" >slot.dat
vanguard mesh -q -p slot.dat --layers no --gap-edges 4 --write su2 --out slot
exits 0
says out "the narrowest gap is 0.02 wide"
awk '/^NPOIN/ { n = $2; next }
     n-- > 0 && $1 > 0.45 && $1 < 0.55 && $2 > -0.021 && $2 < 0.001 { in_it++ }
     END { exit !(in_it > 70 && in_it < 130) }' slot/slot.su2 ||
  fail "not 4 edges across the slot"

# The corners of a plate of four points are kept: its walls have their area.
printf 'plate\n1 0.001\n0 0.001\n0 -0.001\n1 -0.001\n' >plate.dat
vanguard mesh -q -p plate.dat --layers no --out plate --write su2
exits 0
says out "4 corners"
awk '/^NPOIN/ { n = $2; i = 0; next } n > i { x[i] = $1; y[i++] = $2; next }
     /MARKER_TAG/ { on = $2 == "plate" }
     on && NF == 3 { area += x[$2] * y[$3] - x[$3] * y[$2] }
     END { area /= 2; area = area < 0 ? -area : area
           exit !(area > 0.002 - 1e-9 && area < 0.002 + 1e-9) }' \
  plate/plate.su2 || fail "the plate has another area"

# The wake follows the angle of attack in the plane: points are near the line at
# 8 degrees, and fewer are near that at -8 degrees.
wake() { # COLUMNS VALUES
  printf 'wake\n\nlayers\nno\n\nwakes\n%s\n%s\n' "$1" "$2" >wake.deck
  vanguard mesh -q -p d/aerofoil.dat --deck wake.deck --out w --write su2
}
wake "patch  length  alpha" "*  3  8"
exits 0
awk '/^NPOIN/ { n = $2; next } n-- > 0 && $1 > 1.5 && $1 < 3 {
       a = $2 - 0.14 * ($1 - 1); b = $2 + 0.14 * ($1 - 1)
       up += a * a < 0.01; down += b * b < 0.01 }
     END { exit !(up > 40 && up > 4 * down) }' w/aerofoil.su2 ||
  fail "the wake is not in the plane"
wake "patch  up  alpha" "*  z  8"
exits 1
says err "the column up names another axis"
wake "patch  stretch" "*  3"
exits 1
says err "cells of a section do not stretch"
wake "patch  beta" "*  3"
exits 1
says err "beta turns the stream out of this plane"

# Refusals leave nothing behind.
for gap in 0.000001 0.01; do
  awk -v gap=$gap '/^flap/ { on = 1 }
    on && NF == 2 { printf "%.9f %.9f\n", $1 + gap - 0.1, $2 + 0.08; next }
    1' two.dat >near.dat
  vanguard mesh -q -p near.dat --layers no --out n
  if [ $gap = 0.01 ]; then exits 0; else
    exits 1
    says err "the slot between section main and section flap at"
  fi
done
vanguard mesh -q -p d/aerofoil.dat --layers no --scale 50 --le-spacing 0 \
  --te-spacing 0 --edges-per-turn 5 --out m
exits 1
says err "edges with the scale 50; reduce scale"
vanguard mesh -q -p d/aerofoil --max-cells 2000 --out m
exits 1
says err "are allowed (max_cells)"
[ ! -e m ] || fail "a refused run left files"
vanguard mesh -q -p d/aerofoil --cells tets --write cogsg --out m
exits 1
says err "the mesh of a section has none"
vanguard sweep -q -p d/aerofoil --family hlpw:A-B --planned B -o m
exits 1
says err "leave --planned out"
vanguard surface -q d/aerofoil.dat --out s
exits 1
says err "is a plane section"
vanguard plan -q -p d/aerofoil
exits 1
says err "is a plane section"
vanguard mesh -q -p two.dat --out h --farfield none
exits 1
says err "farfield none is given"
vanguard mesh -q -p two.dat --out h --farfield-size 0.5
exits 1
says err "does not contain the section"
printf 'a\n1 0\n0.5 nan\n' >bad.dat
vanguard mesh -q -p bad.dat --out h
exits 1
says err "bad.dat:3: expected a point with two finite coordinates x y"
[ ! -e h ] || fail "a refused run left files"
