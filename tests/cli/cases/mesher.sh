# SPDX-License-Identifier: LGPL-3.0-or-later
# Other meshers in the leaves: TetGen, a plug-in, and faulty plug-ins. The
# files are the same for any number of threads. A resumed run checks the
# mesher.
needs tetgen
plugins=$(dirname "$program")/../tests/unit
vanguard demo sphere --cells 20000 --out p
exits 0

for threads in 1 2; do
  vanguard mesh -q -p p/sphere -t $threads --mesher tetgen --leaf-cells 5000 \
    --write lb8.ugrid --out t$threads
  exits 0
  says out "subdomains filled by the selected mesher"
  lacks out "filled by the built-in mesher instead"
done
same t1/sphere.lb8.ugrid t2/sphere.lb8.ugrid
says t1/sphere.resolved.deck "tetgen"
says t1/sphere.report.json '"subdomains_by_other_mesher"'
vanguard check -q t1/sphere.lb8.ugrid
exits 0

# HXT fills where gmsh is available, and is clearly refused elsewhere.
vanguard mesh -q -p p/sphere --mesher hxt --leaf-cells 5000 \
  --write lb8.ugrid --out h
if [ "$status" = 0 ]; then
  says out "subdomains filled by the selected mesher"
  vanguard check -q h/sphere.lb8.ugrid
  exits 0
else
  says err "libgmsh.so.4.8"
  says err "Debian: libgmsh4.8"
fi

# The kernel fills the leaves that a plug-in does not fill: here all of them,
# so nothing differs.
vanguard mesh -q -p p/sphere --leaf-cells 5000 --write lb8.ugrid --out b
exits 0
for name in star bad_5 bad_9; do
  if [ ! -e "$plugins/mesher_$name.so" ]; then
    echo "no plug-ins are built here"
    break
  fi
  vanguard mesh -q -p p/sphere --mesher "$plugins/mesher_$name.so" \
    --leaf-cells 5000 --write lb8.ugrid --out "$name"
  exits 0
  says out "subdomains filled by the built-in mesher instead:"
  same b/sphere.lb8.ugrid $name/sphere.lb8.ugrid
done
says bad_5/sphere.report.json '"subdomains_crashed": '
[ ! -e "$plugins/mesher_bad_2.so" ] || {
  vanguard mesh -q -p p/sphere --mesher "$plugins/mesher_bad_2.so" \
    --write lb8.ugrid --out v
  exits 1
  says err "made for version 2"
  absent v/sphere.lb8.ugrid
}

# Refusals.
vanguard mesh -q -p p/sphere --mesher ./none.so --write lb8.ugrid --out n
exits 1
says err "mesher ./none.so: it cannot be loaded"
vanguard mesh -q -p p/sphere --mesher tetgne --out n
exits 2
says err "unknown mesher 'tetgne'"

# A run begun with another mesher is a different run.
vanguard mesh -q -p p/sphere --mesher tetgen --leaf-cells 5000 \
  --write lb8.ugrid --out r --run-dir run --keep-run
exits 0
vanguard mesh -q -p p/sphere --mesher tetgen --leaf-cells 5000 \
  --write lb8.ugrid --out r2 --run-dir run --keep-run --resume
exits 0
same r/sphere.lb8.ugrid r2/sphere.lb8.ugrid
says out "subdomains filled by the selected mesher"
vanguard mesh -q -p p/sphere --leaf-cells 5000 --write lb8.ugrid --out r3 \
  --run-dir run --resume
exits 1
says err "mesher"
