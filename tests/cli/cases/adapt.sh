# SPDX-License-Identifier: LGPL-3.0-or-later
# vanguard adapt: cycles of mesh, solver and metric. A shell script stands for
# the solver: its solution is a front of width 0.05, the surface of a sphere.
vanguard demo box --cells 5000 --out .
exits 0
cat >solve.sh <<'END'
#!/bin/bash
# Leaves solution.csv, and the number of points as an output quantity.
set -eu
echo "$VANGUARD_CYCLE of $VANGUARD_CYCLES, after '${VANGUARD_PREVIOUS##*/}'"
[ ! -e fail ] || { echo "the flow diverges"; exit 3; }
cd "$VANGUARD_FOLDER"
awk '
  BEGIN { print "\"PointID\",\"x\",\"y\",\"z\",\"q\"" }
  at && n < count {
    t = (sqrt(($1 + .2) ^ 2 + ($2 + .2) ^ 2 + ($3 + .2) ^ 2) - .8) / .05
    e = exp(-2 * (t < 0 ? -t : t)); f = (1 - e) / (1 + e)
    printf "%d,%s,%s,%s,%.12g\n", n, $1, $2, $3, t < 0 ? -f : f
    n++
  }
  is_count { count = $1; at = 1; is_count = 0 }
  $1 == "Vertices" { is_count = 1 }
  END { printf "\"points\", %d\n1/points,%.9g\n", n, 1 / n >"outputs.csv" }' \
  "$VANGUARD_STEM.mesh" >solution.csv
END
chmod +x solve.sh
{
  cat box.deck
  printf '\nwrite remesh_surface\nmesh,b8.ugrid yes\n'
  printf '\nadapt\nsolver field cycles cells\n./solve.sh q 2 5000\n'
} >loop.deck
mv loop.deck box.deck

vanguard adapt box.deck -o a
exits 0
says err "cycle 2 of 2: solver"
says out "1/points"
exists a/adapt.html a/adapt.csv a/cycle-1/box.mesh a/cycle-2/metric.vtu
says a/cycle-2/solver.log "2 of 2, after 'cycle-1'"
says a/adapt.html "<svg"
says out "note: cycle 2: 1.9 times the requested cells: hmax, sources"
lines=$(wc -l <a/adapt.csv)
[ "$lines" = 3 ] || fail "adapt.csv has $lines lines"

# The same command repeats nothing; more cycles continue the loop.
stamp=$(stat -c %Y.%i a/cycle-*/box.mesh)
vanguard adapt box.deck -o a
exits 0
lacks err "cycle"
vanguard adapt box.deck -o a --cycles 3 --json
exits 0
lacks err "cycle 2"
says err "cycle 3 of 3: metric"
says out '"requested_cells": 10000.0'
[ "$stamp" = "$(stat -c %Y.%i a/cycle-[12]/box.mesh)" ] ||
  fail "a mesh was repeated"

# Another loop in the same folder is refused.
vanguard adapt box.deck -o a --field r
exits 1
says err "is the record of a loop with another field"

# Files that are found next to the surface belong to the loop, too.
cp box.lb8.ugrid near.lb8.ugrid
printf 'near\n\nhmax\n0.3\n' >near.deck
near() { # CYCLES
  vanguard adapt -q -p near -o n --solver ./solve.sh --field q --cells 2000 \
    --cycles "$1" -- --write mesh,b8.ugrid
}
near 1
exits 0
cp near.deck near.deck.first
printf 'near\n\nhmax\n0.25\n' >near.deck
for cycles in 1 2; do
  near $cycles
  exits 1
  says err "is the record of a loop with another deck; give another folder"
done
cp near.deck.first near.deck
cp box.mapbc near.mapbc
near 2
exits 1
says err "is the record of a loop with another mapbc; give another folder"
absent n/cycle-2
rm near.mapbc
near 2
exits 0

# A loop that fails, and one that is killed at any step, end with the same
# meshes.
touch fail
vanguard adapt box.deck -o b --cycles 3 -q
exits 1
says err "cycle 1: the solver ended with status 3: the flow diverges"
rm fail
for i in 1 2 3; do
  "$program" adapt box.deck -o b --cycles 3 -q >/dev/null 2>&1 &
  loop=$!
  sleep 0.$((i * 3))
  kill -9 "$loop" 2>/dev/null
  wait "$loop" 2>/dev/null
  sleep 1 # its mesher ends
done
vanguard adapt box.deck -o b --cycles 3 -q
exits 0
for i in 1 2 3; do same "a/cycle-$i/box.b8.ugrid" "b/cycle-$i/box.b8.ugrid"; done

# A signal ends the step that is running, with the programs of its script.
cat >slow.sh <<'END'
#!/bin/bash
sh -c 'echo $$ >is-running; exec sleep 60'
END
chmod +x slow.sh
"$program" adapt -p box.lb8.ugrid -o s --field q --solver ./slow.sh -q \
  >out 2>err &
loop=$!
for _ in $(seq 200); do [ ! -s is-running ] || break; sleep 0.1; done
kill -TERM "$loop"
wait "$loop"
status=$?
exits 1
says err "interrupted in cycle 1; the same command continues"
for _ in $(seq 50); do
  kill -0 "$(cat is-running)" 2>/dev/null || break
  sleep 0.1
done
! kill -0 "$(cat is-running)" 2>/dev/null || fail "the solver still runs"

# A mesh that fails because of the geometry is tried with other metrics, and the
# record says so; no other failure selects another metric.
cat >stand-in <<END
#!/bin/bash
case "\$*" in
  *cycle-2/metric.vtu*--out*|*cycle-2/metric-2.vtu*--out*) ;;
  mesh*cycle-2/metric.vtu*|mesh*cycle-2/metric-2.vtu*)
    echo "{\"error_kind\": \"\$KIND\"}"
    echo "vanguard: no mesh here\$MORE" >&2; exit 1 ;;
esac
exec "$program" "\$@"
END
chmod +x stand-in
export KIND=memory MORE
MORE="; $(printf 'a patch, %.0s' $(seq 60))and the remedy"
vanguard adapt box.deck -o c --program ./stand-in
exits 1
says err "no mesh: no mesh here; a patch, a patch"
says err "a patch, and the remedy; the log is $PWD/c/cycle-2/mesh.log"
lacks out "note:" # there is no mesh that could miss a limit
lacks c/adapt.json "does not meet a limit"
MORE=""
export KIND=geometry
vanguard adapt box.deck -o c --program ./stand-in
exits 0
says err "cycle 2: no mesh: no mesh here; attempt 3"
says out "that of attempt 3 has growth 1.2 and aspect_max 5"
says c/adapt.html "has growth 1.2 and aspect_max 5"

# Settings.
vanguard adapt -p box.lb8.ugrid -o d
exits 1
says err "no solver"
vanguard adapt -p box.lb8.ugrid -o d1 --solver "./x 'a b"
exits 1
says err "a quote in the command ./x 'a b is not closed"
lacks err "cycle 1"
vanguard adapt -p box.lb8.ugrid -o d2 --solver true
exits 1
says err "nothing to adapt to: give the fields"
vanguard adapt -p box.lb8.ugrid -o d --solver true --field q -- --write mesh
exits 1
says err "the solver left no solution.vtu"
vanguard adapt -p box.lb8.ugrid -o e --solver ./none --field q
exits 1
says err "cannot start ./none"
for wrong in "--norm 0" "--norm 17" "--aspect-max 0.5" "--metric-growth 0.9" \
    "--h-min 1 --h-max 0.1" "--cells 0"; do
  # shellcheck disable=SC2086 # options are words
  vanguard adapt box.deck -o w $wrong
  exits 1
  says err "adapt: "
  absent w
done
vanguard adapt box.deck -o w -- --out x
exits 2
says err "--out after '--' would override"

# The folder of a cycle is repeated with all later ones.
rm -r a/cycle-2
vanguard adapt box.deck -o a --cycles 3
exits 0
lacks err "cycle 1"
says err "cycle 3 of 3: solver"
for i in 1 2 3; do same "a/cycle-$i/box.b8.ugrid" "b/cycle-$i/box.b8.ugrid"; done
cp box.deck other.deck
echo >>other.deck
vanguard adapt -p box.lb8.ugrid -d other.deck -o a
exits 1
vanguard demo aerofoil --out s2
vanguard adapt -p s2/aerofoil.dat --solver true --field p -o w
exits 1
says err "is a plane section, on which metrics do not act"
vanguard adapt box.deck -o d --cycles 0.5
exits 2
vanguard adapt
exits 2
says err "no project given"
printf 'drag,0.02\ndrag,0.03\n' >twice
vanguard adapt -p box.lb8.ugrid -o f --field q --cycles 1 \
  --solver "cp twice /dev/null"
exits 1
cat >bad.sh <<'END'
#!/bin/bash
cp twice "$VANGUARD_FOLDER/outputs.csv"
touch "$VANGUARD_FOLDER/solution.vtu"
END
chmod +x bad.sh
vanguard adapt -p box.lb8.ugrid -o f --field q --cycles 1 --solver ./bad.sh
exits 1
says err "is the record of a loop with another solver"
vanguard adapt -p box.lb8.ugrid -o g --field q --cycles 1 --solver ./bad.sh
exits 1
says err "outputs.csv, line 2: 'drag' occurs twice"
