# SPDX-License-Identifier: LGPL-3.0-or-later
# The hidden folder of a run that was killed is removed by the next run, which
# says so. The folder of a run that is alive stays.
vanguard demo box --cells 200000 --out p
vanguard demo box --cells 2000 --out small

# hidden: the hidden folders in o.
hidden() { find o -maxdepth 1 -name '.vanguard-*' 2>/dev/null; }

# start ARGS...: a run in the background whose hidden folder is locked.
start() {
  "$program" "$@" >out 2>err </dev/null &
  job=$!
  for _ in $(seq 3000); do
    left=$(hidden)
    if [ -n "$left" ] && [ -e "$left/lock" ]; then break; fi
    sleep 0.01
  done
  left=$(hidden)
  [ -n "$left" ] || fail "no hidden folder"
}

# killed ARGS...: a run that ends by SIGKILL while it writes. Sets $left.
killed() {
  start "$@"
  kill -KILL $job
  wait $job 2>/dev/null
  exists "$left/lock"
}

killed mesh -q -t 1 -p p/box --out o --run-dir run
vanguard mesh -q -t 1 -p p/box --out o --run-dir run --resume
exits 0
says out "note: removed $left ("
says out "the incomplete files of a run that was killed"
[ -z "$(hidden)" ] || fail "left behind: $(hidden)"
[ "$(ls -A o)" = "$(cd o && ls -A box.*)" ] || fail "other files: $(ls -A o)"

# vanguard surface and the JSON report mention it too.
rm -rf o
killed mesh -q -t 1 -p p/box --out o
vanguard mesh -q --json -p small/box --out o
exits 0
says out "removed $left ("
[ -z "$(hidden)" ] || fail "left behind: $(hidden)"

# A run that is alive keeps its folder, and completes.
rm -rf o
start mesh -q -t 1 -p p/box --out o
kill -STOP $job
"$program" mesh -q -p small/box --out o --write vtu >other 2>&1 ||
  fail "$(cat other)"
lacks other ".vanguard-"
exists "$left/lock"
kill -CONT $job
wait $job
status=$?
exits 0
[ -z "$(hidden)" ] || fail "left behind: $(hidden)"

# It is not certain that a run on another host has ended, until its folder has
# not changed for a day.
rm -rf o
killed mesh -q -t 1 -p p/box --out o
printf 'elsewhere\n1\n' >"$left/lock"
vanguard mesh -q -p small/box --out o
exits 0
says out "note: $left ("
says out "but that run was on another host; remove it if no run writes to"
exists "$left"
find "$left" -exec touch -d '2 days ago' {} +
vanguard mesh -q -p small/box --out o
exits 0
says out "note: removed $left ("
absent "$left"

# A folder without a lock, and folders with other names, stay.
mkdir -p o/.vanguard-Ab3dEf o/.vanguard-notes o/.vanguard-Ab3dEf/files
vanguard mesh -q -p small/box --out o
exits 0
says out "note: o/.vanguard-Ab3dEf ("
says out "it has no lock that this user can open"
lacks out ".vanguard-notes"
exists o/.vanguard-Ab3dEf/files o/.vanguard-notes
