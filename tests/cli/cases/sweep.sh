# SPDX-License-Identifier: LGPL-3.0-or-later
# A grid of runs: tables, figures, digests, failures. A small program stands
# in for vanguard mesh, so that times and digests are known.
cat >fake <<'END'
#!/bin/bash
# mesh -p P --threads T --leaf-cells C --timeline -o DIR ...
ranks=${RANKS:-1} threads=1 leaf=0 dir=. wrong=0 way=advancing
[ "$1" = mesh ] || exit 2
while [ $# -gt 0 ]; do
  case $1 in
    --threads) threads=$2; shift ;;
    --leaf-cells) leaf=$2; shift ;;
    --bisections) leaf=$((2 ** $2)); shift ;;
    --decompose) way=$2; leaf=$((leaf + ${#2})); shift ;;
    --subdomains) leaf=$((leaf + 1000 * $2)); shift ;;
    -o) dir=$2; shift ;;
    --wrong) wrong=1 ;;
    --fail-at) [ "$threads" = "$2" ] && {
      echo "vanguard: no memory for $2 threads" >&2
      echo "prun: a rank has ended" >&2
      exit 3
    }; shift ;;
  esac
  shift
done
echo "progress"
n=$((ranks * threads))
decomposition='' cells=0
case $way in
  advancing) cells=1500 ;;
  *) cells=750 decomposition=', "subdomains": {"count": 5, "coarse_seconds": 1,
    "deal_seconds": 0.5, "smooth_seconds": 0.25, "divide_seconds": 0}' ;;
esac
digest=$leaf$((wrong * n))
echo "mesh $digest" >"$dir/box.cogsg"
cat >"$dir/box.timeline.json" <<JSON
{"vanguard_timeline": 1, "facts": {"title": "box", "ranks": $ranks,
 "threads": $threads, "cells": 3000, "points": 600, "digest": "",
 "seconds_read": 1, "seconds_cut_fill": $((8 / n)),
 "seconds_total": $((8 / n + 1))},
"columns": ["path", "after", "kind", "rank", "thread", "home", "start", "end",
 "cpu", "estimate", "cells", "bytes_in", "bytes_out"],
"spans": [
["0.0L","","L",0,0,0,0,$((n > 1 ? 8 / n : 4)),4,1000,$cells,0,0],
["0.1L","","L",$((ranks - 1)),$((threads - 1)),0,$((n > 1 ? 0 : 4)),$((8 / n)),4,1000,$cells,0,0]
]}
JSON
cat >"$dir/box.report.json" <<JSON
{"ok": true, "mesh": {"angle_min": 12.5, "angle_min_p1": 31.5},
 "peak_memory_bytes": 5e6,
 "partition": {"leaves": 2, "balance": 1.125, "near_interfaces": {"cells": 70,
  "angle_min": 12.5, "angle_min_p1": 30.25}$decomposition},
 "files": [{"path": "$dir/box.cogsg", "bytes": 9, "xxh3": "$digest"},
  {"path": "$dir/box.report.json", "bytes": 1, "xxh3": "$RANDOM"}]}
JSON
END
chmod +x fake
sweep() { vanguard sweep --program ./fake --launcher "env RANKS={ranks}" "$@"; }

sweep -p box --leaf-cells 100,200 -n 1,2 -t 1:4:x2 -o s
exits 0
says err "12 of 12: c200-n2-t4"
says out "12 of 12 cases done; tables and figures in s"
says out "Digests agree: equal mesh options gave identical files (10 compared)"
says out "c100-n2-t1     2       1      5.00     1.80    90.0     4.00"
[ "$(wc -l <s/sweep.csv)" = 13 ] || fail "not 13 lines"
says s/sweep.csv '"c200-n2-t4",,200,2,4,8,1,done,0,2,'
says s/sweep.json '"digests": "agree"'
says s/sweep.json '"angle_min": 12.5'
exists s/speedup.svg s/phases.svg s/c100-n1-t1.timeline.svg \
  s/c200-n2-t4.sizes.svg s/c100-n1-t1/run.log s/c100-n1-t1/box.report.json
absent s/c100-n1-t1/box.cogsg
says s/speedup.svg "200 cells per leaf, 2 ranks"
says s/speedup.svg "100 cells per leaf, model"
says s/c100-n1-t1/run.log progress

# Ways to decompose, each with every number of subdomains: cells relative to
# those of the advancing partition with the same number. The options replace a
# list in the deck.
sweep -p box --decompose advancing,discrete --subdomains 4,16 -t 1,2 -o ways
exits 0
says out "8 of 8 cases done"
says out "discrete-p16-n1-t2"
says out "cells / adv."
[ "$(grep -c '^discrete-p4-n1-t. .* 0.5000  *30.25  *31.50$' out)" = 2 ] ||
  fail "no ratio and angles of discrete: $(cat out)"
says ways/sweep.csv '"discrete-p4-n1-t1",,,1,1,1,1,done,0,9,'
says ways/sweep.csv ',discrete,'
says ways/sweep.json '"near_angle_min_p1": 30.25'
says ways/sweep.json '"cells_ratio": 0.5'
says ways/sweep.json '"decomposition_seconds": 1.75'
says ways/sweep.json '"balance": 1.125'
says ways/speedup.svg "discrete, 16 subdomains"
vanguard sweep -p box --decompose advancing,metis
exits 2
says err "--decompose takes advancing, discrete or octree, separated by commas, not 'metis'"

# If no case has one worker, the case with the fewest is the reference.
sweep -p box -n 2 -t 1,2 -o f
exits 0
says out "n2-t1     2       1      5.00     2.00   100.0     4.00"
says out "n2-t2     2       2      3.00     3.33    83.3     2.00"
exists f/speedup.svg
says f/speedup.svg "relative to n2-t1: 5 s"

# Bisections in addition to leaf sizes, repeats, meshes kept, nothing but JSON
# on stdout.
sweep -p box -L 3:4 --leaf-cells 100 --repeat 2 -o k --keep -q -j
exits 0
exists k/L3-n1-t1-r2/box.cogsg
says out '"case": "c100-n1-t1-r2"'
says err "6 of 6 cases done"
lacks err "1 of 6: "

# A failed case is reported with its reason and does not end the sweep; files
# of an earlier sweep are not taken for its result.
sweep -p box --leaf-cells 100 -t 1,2,4 -o s -- --fail-at 2
exits 1
says out "failed, status 3: no memory for 2 threads"
says out "2 of 3 cases done"
says s/sweep.csv ',failed,3,'
absent s/c100-n1-t2/box.report.json

vanguard sweep -q -p box -o bad -- --no-such-option
exits 1
says out "failed, status 2: unknown option '--no-such-option'"

# Files that differ are a separate kind of error.
sweep -p box --leaf-cells 100 -n 1,2 -o w -- --wrong
exits 4
says out "Digests DIFFER: box.cogsg differs between c100-n1-t1 and c100-n2-t1"
says w/sweep.json '"digests": "differ"'

# A program that does not exist.
vanguard sweep -p box --program ./none -o none
exits 1
says out "failed, status 127: cannot start ./none"

# A launcher's own message is printed between rules.
cat >launch <<'END'
#!/bin/bash
printf '%s\n' started ------ "No slots for $1." "Ask for fewer." ------
exit 1
END
chmod +x launch
vanguard sweep -p box -n 3 --launcher "./launch {ranks}x{threads}" -o none
exits 1
says out "failed, status 1: No slots for 3x1."

# On a stop signal the run is stopped too, and the results so far are shown.
cat >slow <<'END'
#!/bin/bash
trap 'echo "vanguard: stopped"; exit 1' TERM
for _ in $(seq 200); do sleep 0.1; done
END
chmod +x slow
"$program" sweep -p box --program ./slow -t 1,2 -o stop >out 2>err &
pid=$!
for _ in $(seq 100); do
  [ ! -e stop/n1-t1/run.log ] || break
  sleep 0.05
done
sleep 0.3
kill -TERM $pid
wait $pid
status=$?
exits 1
says out "failed, status 1: stopped"
says out "n1-t2     1       2 not run"
says err "interrupted during n1-t1"

# Lists from the deck of the project, or from another deck; options override
# them.
vanguard demo box --cells 2000 --out p
cat >>p/box.deck <<'END'

sweep
ranks  threads  leaf_cells  repeat
1,2    1:4:x2   100         2
END
sweep -p p/box -o d
exits 0
says out "12 of 12 cases done"
says d/sweep.csv '"c100-n2-t4-r2"'
sweep -p p/box -o d -t 1 -L 3 --repeat 1
exits 0
says out "2 of 2 cases done"
says d/sweep.csv '"L3-n2-t1"'
printf 'Sizes\n\nsweep
bisections
3:5\n' >levels.deck
sweep -p p/box --deck levels.deck -o d
exits 0
says out "3 of 3 cases done"
says out "L5-n1-t1 "
printf 'Sizes\n\nsweep\nleaf_cells\nmany\n' >bad.deck
sweep -p p/box --deck bad.deck -o d
exits 1
says err "bad.deck: sweep: leaf_cells takes numbers such as 1,2,4 or ranges"
says err "not 'many'"
# Other commands ignore these lists; a second line is an error.
vanguard mesh -q -p p/box --out m
exits 0
says m/box.resolved.deck "1:4:x2"
printf '1 1 1 1\n' >>p/box.deck
vanguard mesh -q -p p/box --out m
exits 1
says err "the table 'sweep' takes only one line of values"

vanguard sweep
exits 2
says err "no project given"
vanguard sweep -p box -n 0
exits 2
says err "--ranks takes numbers from 1"
vanguard sweep -p box --leaf-cells many
exits 2
says err "not 'many'"
