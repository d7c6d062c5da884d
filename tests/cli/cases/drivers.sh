# SPDX-License-Identifier: LGPL-3.0-or-later
# The driver: cases are made, run here, submitted to Slurm and PBS (simulated by
# programs of the same names), stopped, resumed and collected.
command -v python3 >/dev/null || skip "python3 is not installed"
export VANGUARD=$program PYTHONDONTWRITEBYTECODE=1
driver=$here/../../share/drivers/vanguard_cases.py
vanguard demo box --cells 3000 --out in

# cases ARGS...: the driver, as `vanguard`.
cases() {
  $driver "$@" >out 2>err
  status=$?
}

# --- every script can be started by its name ---
for script in "$here"/../../examples/{,*/}*.py "$here"/../../share/drivers/*.py
do
  [ -x "$script" ] || fail "$script has no run bit"
  [ "$(head -1 "$script")" = "#!/usr/bin/env python3" ] ||
    fail "$script does not name its interpreter"
done

# --- cases that cannot be made: a message, and no folder ---
cases make runs/a in/nosuch.stl
exits 1
says err "in/nosuch.stl: this file does not exist"
cases make runs/a in/box.lb8.ugrid --set growht=1.3
exits 1
says err "box.deck: settings.growht: unknown name; did you mean 'growth'?"
absent runs/a runs/a.new
cases submit runs/a
exits 1
says err "not a case"

# --- here ---
cases make runs/a in/box.lb8.ugrid --set growth=1.3 --set write=vtu
exits 0
exists runs/a/box.deck runs/a/box.mapbc
cases make runs/b in/box.lb8.ugrid --set hmax=0.1 --set write=b8.ugrid
cases make runs/bad in/box.lb8.ugrid --set max_cells=10
cases make runs/a in/box.lb8.ugrid
exits 1
says err "runs/a exists"
cases state runs/a runs/b
is out <<'END'
case=a  state=made
case=b  state=made
END
cases submit runs/a runs/b runs/bad
exits 1
says out "case=a  state=done"
says out "case=b  state=done"
says out "case=bad  state=failed"
exists runs/a/out/box.vtu runs/b/out/box.b8.ugrid
cases collect runs/a runs/b runs/bad --csv table.csv
exits 1
says out "error="
says table.csv "case,state,status,points,cells,valid,angle_min"
grep -q '^b,done,0,[0-9]*,[0-9]*,True,' table.csv || fail "$(cat table.csv)"
touch -d '1 hour ago' runs/a/out/box.vtu
cases submit runs/a          # it is done and does not run again
exits 0
[ -n "$(find runs/a/out/box.vtu -mmin +30)" ] || fail "a done case ran again"

# --- queues: sbatch and qsub keep the script, which the test then runs ---
mkdir bin
cat >bin/sbatch <<'END'
#!/bin/bash
[ "$1" = --parsable ] && grep -q '^#SBATCH --ntasks=2$' "$2" || exit 1
realpath "$2" >"$QUEUE/script"
echo PENDING >"$QUEUE/state"
echo "77;cluster"
END
cat >bin/squeue <<'END'
#!/bin/bash
[ "$*" = "-h -j 77 -o %T" ] || exit 1
cat "$QUEUE/state" 2>/dev/null
END
cat >bin/qsub <<'END'
#!/bin/bash
grep -q '^#PBS -l select=2:ncpus=2:mpiprocs=1:ompthreads=2$' "$1" || exit 1
realpath "$1" >"$QUEUE/script"
echo Q >"$QUEUE/state"
echo 88.server
END
cat >bin/qstat <<'END'
#!/bin/bash
[ "$*" = "-f 88.server" ] && [ -s "$QUEUE/state" ] || exit 153
echo "    job_state = $(cat "$QUEUE/state")"
END
chmod +x bin/*
export PATH=$PWD/bin:$PATH QUEUE=$PWD/queue
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
mkdir queue

# starts WORD: the job in the queue runs, in the state that the queue shows.
starts() {
  echo "$1" >queue/state
  (
    cd /
    export ASAN_OPTIONS=$ASAN_OPTIONS:detect_leaks=0   # of Open MPI
    echo "$BASHPID" >"$QUEUE/pid"
    exec bash "$(cat "$QUEUE/script")"
  ) >>"$2/run.log" 2>&1
  : >queue/state
}
launcher=
! timeout 20 mpirun --oversubscribe -n 2 true >/dev/null 2>&1 || launcher=1
[ -n "$launcher" ] || skip "mpirun does not start here"
needs mpi

cases make runs/s in/box.lb8.ugrid --set write=b8.ugrid
cases submit --queue slurm --ranks 2 runs/s
exits 0
says out "state=queued"
cases submit --queue slurm --ranks 2 runs/s   # it is not submitted twice
says out "state=queued"
echo RUNNING >queue/state
cases state runs/s
says out "state=running"
starts RUNNING runs/s
cases state runs/s
says out "state=done"
exists runs/s/out/box.b8.ugrid
says runs/s/run.log "exit status 0"

# Stopped by PBS at the time limit, and resumed by another submission.
vanguard demo sphere --cells 300000 --out in
cases make runs/p in/sphere.lb8.ugrid --set write=b8.ugrid --set leaf_cells=20000
cases submit --queue pbs --ranks 2 --threads 2 --nodes 2 runs/p
exits 0
says out "state=queued"
starts R runs/p &
waiting=$!
for _ in $(seq 1000); do
  [ "$(find runs/p/run.store/records -type f 2>/dev/null | wc -l)" -lt 3 ] ||
    break
  sleep 0.01
done
kill -TERM "$(cat queue/pid)"
wait $waiting
cases state runs/p
says out "state=stopped"
absent runs/p/out/sphere.b8.ugrid
cases submit --queue pbs --ranks 2 --threads 2 --nodes 2 runs/p
says out "state=queued"
starts R runs/p
cases collect runs/p
exits 0
says out "state=done"
says out "valid=True"
exists runs/p/out/sphere.b8.ugrid
