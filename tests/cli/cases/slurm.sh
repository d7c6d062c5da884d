# SPDX-License-Identifier: LGPL-3.0-or-later
# The batch script under plain bash, with a program whose end is known, and
# with vanguard mesh: stopped by the signal that Slurm sends, then continued.
script=$here/../../share/slurm/vanguard.sbatch
unset SLURM_JOB_ID SLURM_NTASKS SLURM_CPUS_PER_TASK SLURM_JOB_NUM_NODES
cat >fake <<'END_FAKE'
#!/bin/bash
# mesh ... --run-dir DIR ...: waits; on a stop signal it keeps its finished
# work
dir=.
echo "called: $*"
while [ $# -gt 0 ]; do
  [ "$1" != --run-dir ] || dir=$2
  shift
done
mkdir -p "$dir"
[ ! -e fails ] || exit 4
trap 'echo "vanguard: stopped"; touch "$dir/run.txt"; exit 1' USR1
touch ready
for _ in $(seq 100); do [ ! -e quick ] || break; sleep 0.1; done
rm -r "$dir"
END_FAKE
chmod +x fake

# batch SIGNAL VARIABLE...: runs the script and sends it the signal when the
# program is ready ("-": none).
batch() {
  local signal=$1 pid
  shift
  rm -f ready
  env OUT=o "$@" bash "$script" >out 2>err &
  pid=$!
  if [ "$signal" != - ]; then
    for _ in $(seq 200); do [ ! -e ready ] || break; sleep 0.05; done
    kill "-$signal" $pid
  fi
  wait $pid
  status=$?
}

batch - PROJECT=
exits 2
says err "no project given"

batch USR1 PROJECT=in/box VANGUARD=./fake CPUS=3 OPTIONS="--hmax 2"
exits 75
says out "called: mesh -p in/box --out o --threads 3 --run-dir o/box.run --hmax 2"
says out "asked to stop (limit)"
says out "the same command resumes from o/box.run"
exists o/box.run/run.txt
touch quick
batch - PROJECT=in/box VANGUARD=./fake
exits 0
says out "continuing from o/box.run"
says out "--run-dir o/box.run --resume"
absent o/box.run
rm quick

batch TERM PROJECT=in/box VANGUARD=./fake
exits 75
says out "asked to stop (cancelled)"
touch fails
batch - PROJECT=in/box VANGUARD=./fake RUN_DIR=elsewhere
exits 4
exists elsewhere
rm fails

# The job is requeued, but not forever.
mkdir bin
printf '#!/bin/bash\necho "scontrol $*"\n' >bin/scontrol
chmod +x bin/scontrol
batch USR1 PROJECT=in/box VANGUARD=./fake SLURM_JOB_ID=7 PATH="$PWD/bin:$PATH"
exits 75
says out "scontrol requeue 7"
says out "requeued"
batch USR1 PROJECT=in/box VANGUARD=./fake SLURM_JOB_ID=7 \
  SLURM_RESTART_COUNT=20 PATH="$PWD/bin:$PATH"
exits 75
lacks out "scontrol requeue"

# Several ranks: with separate cores, or with shared cores if there are too
# few.
printf '#!/bin/bash\necho "mpirun $*"\n' >bin/mpirun
chmod +x bin/mpirun
batch - PROJECT=in/box NTASKS=2 CPUS=9999 PATH="$PWD/bin:$PATH"
exits 0
says out "mpirun -n 2 --oversubscribe --bind-to none vanguard mesh"
batch - PROJECT=in/box SLURM_NTASKS=8 SLURM_CPUS_PER_TASK=4 \
  SLURM_JOB_NUM_NODES=2 PATH="$PWD/bin:$PATH"
exits 0
says out "mpirun -n 8 --map-by slot:PE=4 --bind-to core vanguard mesh"
printf '#!/bin/bash\necho "srun $*"\n' >bin/srun
chmod +x bin/srun
batch - PROJECT=in/box LAUNCHER="srun --mpi=pmix" PATH="$PWD/bin:$PATH"
exits 0
says out "srun --mpi=pmix --ntasks 1 --cpus-per-task 1 --cpu-bind=cores"

# The real program: stopped when the first tasks are kept.
vanguard demo box --cells 600000 --out p
"$program" mesh -q -p p/box --out whole --threads 1 --leaf-cells 30000 \
  --write b8.ugrid >out 2>err
status=$?
exits 0
rm -rf o
env OUT=o PROJECT=p/box VANGUARD="$program" CPUS=1 \
  OPTIONS="--leaf-cells 30000 --write b8.ugrid" bash "$script" >out 2>err &
pid=$!
for _ in $(seq 600); do
  [ "$(find o -type f 2>/dev/null | wc -l)" -lt 5 ] || break
  sleep 0.05
done
kill -USR1 $pid
wait $pid
status=$?
exits 75
absent o/box.b8.ugrid
batch - PROJECT=p/box VANGUARD="$program" \
  OPTIONS="--leaf-cells 30000 --write b8.ugrid"
exits 0
says out "--resume"
same whole/box.b8.ugrid o/box.b8.ugrid
absent o/box.run

# The test under Slurm itself is verification/slurm.sh, which starts the
# daemons of Slurm. It runs only on request, since a test run should not start
# daemons.
if [ -z "${VG_TEST_SLURM:-}" ]; then
  echo "sbatch is not tested: set VG_TEST_SLURM=1 for it"
else
  ASAN_OPTIONS=$ASAN_OPTIONS:detect_leaks=0 "$here/../../verification/slurm.sh" \
    --vanguard "$program" --work slurm --cells 400000 >out 2>err
  status=$?
  if [ $status = 77 ]; then tail -1 out
  else
    exits 0
    says out "mpirun: requeued, continued"
  fi
fi
