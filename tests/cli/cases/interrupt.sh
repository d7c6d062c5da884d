# SPDX-License-Identifier: LGPL-3.0-or-later
# Ctrl-C ends a run cleanly: a message, status 1, and no partial files. The
# signal is sent when the work has begun, before the fill.
needs mpi
vanguard demo box --cells 400000 --out p

# signalled SIGNAL STAGE COMMAND...: runs the command and sends SIGNAL $late s
# after the stage has begun. If $again is set, the signal is sent once more
# $again s later; if $stands is set, the process is suspended for $stands s in
# between.
late=0 again= stands=
signalled() {
  signal=$1 stage=$2
  shift 2
  rm -f err
  "$@" >out 2>err </dev/null &
  job=$!
  for _ in $(seq 600); do
    ! grep -qs "^$stage" err || break
    sleep 0.05
  done
  sleep $late
  kill "-$signal" $job 2>/dev/null
  if [ -n "$again" ]; then
    sleep "$again"
    [ -z "$stands" ] || { kill -STOP $job; sleep "$stands"; }
    kill "-$signal" $job 2>/dev/null
    [ -z "$stands" ] || kill -CONT $job
  fi
  wait $job
  status=$?
}

signalled INT "sizing field" "$program" mesh -p p/box --out o
exits 1
says err "interrupted; nothing was written"
[ -z "$(ls -A o)" ] || fail "left behind: $(ls -A o)"

# Two signals at nearly the same time, as timeout(1) sends them, count as one.
again=0.02
signalled TERM "sizing field" "$program" mesh -p p/box --out o
again=
exits 1
says err "interrupted; nothing was written"
[ -z "$(ls -A o)" ] || fail "left behind: $(ls -A o)"

# SIGHUP stops the run as well; under nohup the run continues.
signalled HUP "sizing field" "$program" mesh -p p/box --out n
exits 1
says err "interrupted; nothing was written"
[ -z "$(ls -A n)" ] || fail "left behind: $(ls -A n)"
vanguard demo box --cells 30000 --out f
signalled HUP "sizing field" nohup "$program" mesh -p f/box --out n
exits 0
exists n/box.b8.ugrid

# A file size limit acts like a full disk.
status=$(ulimit -f 200; "$program" mesh -p f/box --out fo >out 2>err; echo $?)
exits 1
says err "a limit of the shell (ulimit -f)"
[ -z "$(ls -A fo)" ] || fail "left behind: $(ls -A fo)"

# Stopped while it starts, MPI included: the same message.
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 \
  OMPI_MCA_rmaps_base_oversubscribe=1
launcher=
! timeout 20 mpirun -n 2 true >/dev/null 2>&1 || launcher="mpirun -n 2"
# shellcheck disable=SC2016 # for the shell that becomes the program
for launch in "" "$launcher"; do
  rm -f pid
  timeout 60 $launch bash -c '[ "${OMPI_COMM_WORLD_RANK:-0}" != 0 ] ||
    echo $$ >pid; exec "$@"' - "$program" mesh -p p/box --out o >out 2>err &
  job=$!
  for _ in $(seq 2000); do
    caught=0
    [ ! -s pid ] ||
      caught=$(sed -n 's/^SigCgt:[^0-9a-f]*//p' "/proc/$(cat pid)/status")
    # SIGUSR1 caught by vanguard and not by the shell before it
    if [ $((0x${caught:-0} & 0x200)) != 0 ]; then
      kill -USR1 "$(cat pid)"
      break
    fi
    sleep 0.002
  done
  wait $job
  status=$?
  exits 1
  says err "interrupted; nothing was written"
  lacks err "sizing field"
done

# Sizes far too fine for any machine, so that the work would take an hour. It
# stops in every stage: the sizing field and the load of a plan, and a
# farfield.
unset OMPI_MCA_rmaps_base_oversubscribe
cat >fine.deck <<'END'
Far too fine

sources
kind    x0   y0   z0   r0   h0
sphere  0.5  0.5  0.5  0.4  2e-5
END
octahedron >octa.obj

# stopped STAGE ARGS...: SIGTERM in the middle of the stage.
late=0.3
stopped() {
  stage=$1
  shift
  signalled TERM "$stage" timeout -k 20 60 "$program" "$@"
  exits 1
  says err "vanguard: interrupted; nothing was written"
}

stopped "sizing field" plan -p p/box --deck fine.deck --farfield none
stopped farfield plan -p octa --farfield-spacing 0.03
stopped farfield mesh -p octa --farfield-spacing 0.03 --out o
[ -z "$(ls -A o)" ] || fail "left behind: $(ls -A o)"

# Remeshing stops too: the sizes request millions of triangles.
stopped "surface remeshing" surface octa.obj --surface-size 1e-3 --out o
stopped "surface remeshing" mesh -p octa.obj --remesh-surface yes \
  --surface-size 1e-3 --out o
[ -z "$(ls -A o)" ] || fail "left behind: $(ls -A o)"

# A run that checks for signals only rarely is ended after two seconds, and
# leaves nothing behind: this sizing field takes an hour.
start=$(date +%s%N)
stopped "sizing field" mesh -p p/box --deck fine.deck --farfield none --out o
[ $(($(date +%s%N) - start)) -lt 20000000000 ] || fail "it did not stop"
[ -z "$(ls -A o)" ] || fail "left behind: $(ls -A o)"

# A second signal one second later, before the run has ended (a busy machine,
# simulated by a suspended process): the same message and status, not the
# status of the signal.
late=0 again=0.01 stands=1.2
signalled TERM "sizing field" "$program" mesh -p p/box --deck fine.deck \
  --farfield none --out o
exits 1
says err "interrupted; nothing was written"
[ -z "$(ls -A o)" ] || fail "left behind: $(ls -A o)"
