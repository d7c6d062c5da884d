# SPDX-License-Identifier: LGPL-3.0-or-later
# Two runs that write the same names into a folder: the second is refused. The
# hidden folder of a run that was killed is removed by the next run, which says
# so. The folder of a run that is alive stays.
vanguard demo box --cells 200000 --out p
vanguard demo box --cells 2000 --out small
vanguard demo box --cells 2000 --out other
for file in other/box.*; do mv "$file" "other/pot.${file#other/box.}"; done
hidden=o/.vanguard-box

# start ARGS...: a run in the background that has locked its hidden folder.
start() {
  "$program" "$@" >out 2>err </dev/null &
  job=$!
  for _ in $(seq 3000); do
    [ ! -e $hidden/new ] || break
    sleep 0.01
  done
  exists $hidden/new
}

# killed ARGS...: a run that ends by SIGKILL while it writes files.
killed() {
  start "$@"
  for _ in $(seq 3000); do
    [ -z "$(ls -A $hidden/new 2>/dev/null)" ] || break
    sleep 0.01
  done
  kill -KILL $job
  wait $job 2>/dev/null
  exists $hidden/lock
}

killed mesh -q -t 1 -p p/box --out o --run-dir run
vanguard mesh -q -t 1 -p p/box --out o --run-dir run --resume
exits 0
says out "note: removed $hidden ("
says out "the incomplete files of a run that was killed"
absent $hidden
[ "$(ls -A o)" = "$(cd o && ls -A box.*)" ] || fail "other files: $(ls -A o)"

# Runs of other projects, and the JSON report, mention it too.
rm -rf o
killed mesh -q -t 1 -p p/box --out o
vanguard mesh -q --json -p other/pot --out o
exits 0
says out "removed $hidden ("
absent $hidden

# A run that is alive keeps its folder and completes. A second one with the same
# names is refused, and one with other names is not.
rm -rf o
start mesh -q -t 1 -p p/box --out o
kill -STOP $job
"$program" mesh -q -p small/box --out o --write vtu >other.out 2>&1
status=$?
exits 1
says other.out "o: another run is writing box.* to this folder"
says other.out "host $(hostname), process $job, started 2"
"$program" surface -q small/box --out o >other.out 2>&1
status=$?
exits 1
says other.out "process $job, started 2"
"$program" mesh -q -p other/pot --out o --write vtu >other.out 2>&1 ||
  fail "$(cat other.out)"
lacks other.out ".vanguard-"
exists $hidden/lock o/pot.vtu
kill -CONT $job
wait $job
status=$?
exits 0
absent $hidden
exists o/box.b8.ugrid

# A folder without a lock, and folders with other names, stay.
mkdir -p o/.vanguard-Ab3dEf/files o/.vanguard-notes
vanguard mesh -q -p small/box --out o
exits 0
lacks out ".vanguard-"
exists o/.vanguard-Ab3dEf/files o/.vanguard-notes
