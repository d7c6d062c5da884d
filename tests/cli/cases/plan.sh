# SPDX-License-Identifier: LGPL-3.0-or-later
# A recorded run simulated on other machines: text, JSON, figure and messages.
cat >r.timeline.json <<'END'
{"vanguard_timeline": 1,
"facts": {"title": "box", "ranks": 1, "threads": 1, "cells": 4000,
 "points": 900, "digest": "", "seconds_read": 1, "seconds_cut_fill": 9,
 "seconds_write": 1, "seconds_total": 11},
"columns": ["path", "after", "kind", "rank", "thread", "home", "start", "end",
 "cpu", "estimate", "cells", "bytes_in", "bytes_out"],
"spans": [
["0J", "", "J",0,0,0,0,1,1,0,0,0,0],
["0.1L","0J","L",0,0,0,1,3,2,1000,1000,0,0],
["0.2L","0J","L",0,0,0,3,5,2,1000,1000,0,0],
["0.3L","0J","L",0,0,0,5,7,2,1000,1000,0,0],
["0.4L","0J","L",0,0,0,7,9,2,1000,1000,0,0]
]}
END

vanguard plan --replay r.timeline.json --ranks 1:4:x2 --threads 1,2
exits 0
says out "1 rank x 1 thread, 5 tasks, 4,000 cells; cut and fill 9.000 s"
says out "replayed 11.000 s, measured 11.000 s (+0.0 %)"
says out "      1       1       1     11.000      1.00       100.0      5.000"
says out "outside the tasks, on one core: 1.400 s serial, 0.000 s parallel within a node, 0.600 s parallel over all"
says out "      2       1       2      6.700      1.64        82.1      4.700"
says out "      4       2       8      4.475      2.46        30.7      4.475"
[ "$(grep -c '^ *[0-9][0-9]* *[0-9][0-9]* *[0-9][0-9]* ' out)" = 6 ] || fail "not 6 rows"

# The serial part can be left out; a faster core takes less time.
vanguard plan -r r.timeline.json -n 4 --serial 0 --rate 2 -j
exits 0
says out '"seconds": 1.5'
says out '"serial": 0.0'
says out '"error_percent": '

# With slow links all work stays on the home rank.
vanguard plan -r r.timeline.json -n 2 --latency 0.5 --serial 0
says out "      2       1       2      6.0"
vanguard plan -r r.timeline.json -n 2 --latency 0.5 --serial 0 \
  --ranks-per-node 2
says out "      2       1       2      5.0"

# A timeline with loops: the threads of a rank share the 0.75 s of its join.
sed -e 's/"bytes_out"\]/"bytes_out", "loops"]/' -e 's/0,0\],$/0,0,0],/' \
  -e 's/0,0\]$/0,0,0]/' -e 's/0,1,1,0,0,0,0,0\]/0,1,1,0,0,0,0,0.75]/' \
  r.timeline.json >l.timeline.json
vanguard plan -r l.timeline.json -n 1 -t 1,4 --serial 0
exits 0
says out "idle threads of a rank share: 0.750 s"
says out "      1       1       1      9.000      1.00       100.0      3.000"
says out "      1       4       4      2.438      3.69        92.3      2.438"
vanguard plan -r l.timeline.json -n 1 -t 4 --serial 0 --loop-threads 3 -j
exits 0
says out '"seconds": 2.5,'
says out '"loops": 0.75'

vanguard plan -r r.timeline.json --plot speedup.svg
exits 0
says out "    512       1     512"
says speedup.svg ">ideal<"

# Leaves assigned statically to two workers: the first leaf, which is long,
# goes with the third. The timeline holds the key of the assignment, unless an
# older version wrote it.
vanguard plan -r r.timeline.json -n 2 --schedule cyclic
exits 1
says err "of the trace has no 'work'"
sed -e 's/"bytes_out"\]/"bytes_out", "work"]/' -e 's/0,0\],$/0,0,2.5],/' \
  -e 's/0,0\]$/0,0,1]/' -e '/"0.1L"/s/,1,3,2,/,1,3,6,/' \
  r.timeline.json >w.timeline.json
vanguard plan -r w.timeline.json -n 2 --serial 0
exits 0
says out "      2       1       2      7.000 "
vanguard plan -r w.timeline.json -n 2 --serial 0 --schedule cyclic
exits 0
says out "Forecast, leaves assigned in turn"
says out "      2       1       2      9.000 "
vanguard plan -r w.timeline.json -n 2 --serial 0 --schedule cyclic -j
says out '"cyclic": true'

vanguard plan
exits 2
says err "no run given"
vanguard plan -r r.timeline.json -n 4:2
exits 2
says err "--ranks takes numbers from 1"
vanguard plan -r r.timeline.json -n 1,2x
exits 2
says err "not '2x'"
vanguard plan -r none.timeline.json
exits 1
says err "none.timeline.json"
sed 's/"0.3L","0J"/"0.3L","0K"/' r.timeline.json >bad.timeline.json
vanguard plan -r bad.timeline.json
exits 1
says err "bad.timeline.json: task '0.3L' of the trace was created by '0K'"
echo '{"ok": true}' >report.json
vanguard plan -r report.json
exits 1
says err "report.json: not a timeline of vanguard mesh"

# Before anything is meshed: the same tree as that of the run, and nothing is
# written.
vanguard demo box --cells 60000 --out p
before=$(ls -A p)
vanguard plan -q -p p/box --leaf-cells 8000 -n 1,2,8 -t 1,2 --write vtu,cogsg
exits 0
is err </dev/null
[ "$(ls -A p)" = "$before" ] || fail "plan wrote files into the project folder"
says out "Expected mesh"
says out "7 cuts into 8 leaves; 0 edge separators and 7 face separators"
says out "    0.1: "
says out "Best: "
says out "40,000       "
grep -q "^  vtu  *[0-9.]* MB" out || fail "the size of the .vtu is not reported"
grep -q "^      8       2      16 " out || fail "no row of 8 x 2"
vanguard plan -q -p p/box --leaf-cells 8000 -n 2 -j --serial 0
exits 0
cp out plan.json
says plan.json '"leaves": 8'
says plan.json '"path": "0.1.1.1"'
says plan.json '"best_leaf_cells"'
vanguard mesh -q -p p/box --leaf-cells 8000 --out m --json
exits 0
says out '"pencils": 0'
says out '"tiles": 7'

# The cells and points of a plan and of a mesh agree within 6 %, the error of
# the estimate.
figures() { sed -n 's/^ *"\(cells\|points\)": \([0-9][0-9.]*\).*/\1 \2/p' "$1" |
  sort -u -k1,1; }
figures plan.json >planned
vanguard check m/box.b8.ugrid --json
exits 0
figures out | paste -d ' ' planned - >both
[ "$(wc -l <both)" = 2 ] || fail "no cells and points to compare"
awk '$1 != $3 || $2 / $4 < 0.94 || $2 / $4 > 1.06 { exit 1 }' both ||
  fail "plan and mesh differ: $(cat both)"

# The memory of a rank is that of the stage that needs most. Another thread needs
# memory in the fill and in the mesh check.
vanguard plan -q -p p/box --leaf-cells 8000 -n 1,4 -t 1,2 -j
exits 0
jq -e '.memory.shared > 0 and ([.forecast[] | .memory_bytes ==
  ([.memory_stages[]] | max)] | all)' out >same || fail "not the largest stage"
jq -e '.forecast | (.[0].memory_stages.fill < .[2].memory_stages.fill) and
  (.[0].memory_stages.check < .[2].memory_stages.check) and
  (.[0].memory_stages.sizes == .[2].memory_stages.sizes)' out >threads ||
  fail "the memory does not depend on the threads"
vanguard plan -q -p p/box --leaf-cells 8000 -n 1
says out "Memory of a rank with 1 x 1"
says out "  one copy per node "

# One leaf if requested; an impossible target, and a possible one.
vanguard plan -q -p p/box --leaf-cells 0 -n 1
says out "0 cuts into 1 leaf"
vanguard plan -q -p p/box --target 0.001 -n 1,2
exits 0
says out "No machine in the list takes 0.001 s or less."
vanguard plan -q -p p/box --target 1000 -n 1,2
says out "Best: 1 rank x 1 thread"

vanguard plan -p p/box -r r.timeline.json
exits 2
says err "either a project or --replay"
vanguard plan -r r.timeline.json --rates r.timeline.json
exits 2
says err "uses the times of its timeline"
vanguard plan -r r.timeline.json --leaf-cells 5
exits 2
says err "takes no settings"
vanguard plan -p p/none
exits 1
says err "p/none"
vanguard plan -p p/box --growth 0.5
exits 2
vanguard plan -p p/box --depth x
exits 2
says err "--depth takes an integer of at least 0, not 'x'"

# Times of this machine, from a run on it.
vanguard mesh p/box --leaf-cells 500 --timeline --write cogsg --out m2
exits 0
vanguard plan -q -p p/box -n 1 --rates m2/box.timeline.json
exits 0
says out "Task times, fitted to m2/box.timeline.json"
says out "us per face of the front"
vanguard plan -q -p p/box -n 1 --rates p/none
exits 1
says err "p/none"

# The limiting factor of each phase is named, and with the cores of a node the
# command to start it.
vanguard plan -q -p p/box --leaf-cells 8000 -n 1,2 --cores 6
exits 0
says out "limited by"
says out "cut+fill"
says out "Start: mpirun -n "
grep -q "^      2       6      12 " out || fail "no row of two nodes as 2 x 6"
grep -q "^     12       1      12 " out || fail "no row of two nodes as 12 x 1"
vanguard plan -q -p p/box --leaf-cells 8000 -n 2 --cores 6 -j
exits 0
says out '"limited_by": '
says out '"ranks_per_node": '
vanguard plan -q -p p/box --cores 6 -t 2
exits 2
says err "omit --threads and --ranks-per-node"

# Sizes that depend on the direction. A thin sheet of flat cells has more leaves in
# its octree of sizes than the mesh has points, and the octree needs most of the
# memory.
mkdir thin
cp p/box.lb8.ugrid thin/thin.lb8.ugrid
cat >thin/thin.deck <<'END'
thin
flow     remesh_surface surface_sizes hmax
internal yes            no            0.15

farfield
kind
none

sources
kind x0 y0 z0   x1 y1 z1   h0  stretch ux uy uz
box  0  0  0.45 1  1  0.55 0.05 0.05   0  0  1
END
one_thread() { # COMMAND [OPTION...]: cells and memory by one thread
  vanguard "$1" -q --json -p thin/thin --write b8.ugrid --report-html no "${@:2}"
  exits 0
  cp out "$1.json"
}
one_thread plan -n 1 -t 1
one_thread mesh --threads 1 --out m3
jq -es '.[0].mesh.cells / .[1].mesh.cells | . > 0.85 and . < 1.15' \
  plan.json mesh.json >near || fail "cells in a metric are not those forecast"
jq -es '.[0].memory.shared / (.[1].memory_bytes | .surface + .sizes) |
  . > 0.85 and . < 1.15' plan.json mesh.json >near ||
  fail "the octree in a metric is not that forecast"
# Resident memory, unless a sanitizer needs most of it.
grep -q __asan_init "$program" ||
  jq -es '.[0].forecast[0].memory_bytes / .[1].peak_memory_bytes |
    . > 0.75 and . < 1.25' plan.json mesh.json >near ||
  fail "the memory in a metric is not that forecast"
