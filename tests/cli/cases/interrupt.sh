# Ctrl-C ends cleanly: a message, status 1, and nothing half-written. Sent
# when the work has begun, with the whole fill still to come.
vanguard demo box --cells 400000 --out p

# signalled SIGNAL STAGE COMMAND...: sent $late s after the stage has begun, and
# once more $again s later if that is set, or after it has stood still for
# $stands s from then on.
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

signalled INT sizes "$program" mesh -p p/box --out o
exits 1
says err "interrupted; nothing was written"
[ -z "$(ls -A o)" ] || fail "left behind: $(ls -A o)"

# Told twice at nearly the same time, as timeout(1) does: that is one wish.
again=0.02
signalled TERM sizes "$program" mesh -p p/box --out o
again=
exits 1
says err "interrupted; nothing was written"
[ -z "$(ls -A o)" ] || fail "left behind: $(ls -A o)"

# The terminal goes away: the same; under nohup the run goes on.
signalled HUP sizes "$program" mesh -p p/box --out n
exits 1
says err "interrupted; nothing was written"
[ -z "$(ls -A n)" ] || fail "left behind: $(ls -A n)"
vanguard demo box --cells 30000 --out f
signalled HUP sizes nohup "$program" mesh -p f/box --out n
exits 0
exists n/box.b8.ugrid

# A limit of the size of files is like a full disk.
status=$(ulimit -f 200; "$program" mesh -p f/box --out fo >out 2>err; echo $?)
exits 1
says err "File too large"
[ -z "$(ls -A fo)" ] || fail "left behind: $(ls -A fo)"

# Told to stop while it starts, MPI included: the same message.
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
    # SIGUSR1, by vanguard and not by the shell before it
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
  lacks err "sizes"
done

# Sizes far too fine for any machine: what would take an hour stops, wherever
# it is: the field of sizes and the load of a plan, and a farfield.
unset OMPI_MCA_rmaps_base_oversubscribe
cat >fine.deck <<'END'
Far too fine

sources
kind    x0   y0   z0   r0   h0
sphere  0.5  0.5  0.5  0.4  2e-5
END
octahedron >octa.obj

# stopped STAGE ARGS...: told to stop in the midst of the stage.
late=0.3
stopped() {
  stage=$1
  shift
  signalled TERM "$stage" timeout -k 20 60 "$program" "$@"
  exits 1
  says err "vanguard: interrupted; nothing was written"
}

stopped sizes plan -p p/box --deck fine.deck --farfield none
stopped farfield plan -p octa --farfield-spacing 0.03
stopped farfield mesh -p octa --farfield-spacing 0.03 --out o
[ -z "$(ls -A o)" ] || fail "left behind: $(ls -A o)"

# So does a surface that is made anew: millions of triangles are asked for.
stopped remesh surface octa.obj --surface-size 1e-3 --out o
stopped remesh mesh -p octa.obj --remesh-surface yes --surface-size 1e-3 --out o
[ -z "$(ls -A o)" ] || fail "left behind: $(ls -A o)"

# A run that looks only now and then is ended two seconds later, and leaves
# nothing: this field of sizes takes an hour.
start=$(date +%s%N)
stopped sizes mesh -p p/box --deck fine.deck --farfield none --out o
[ $(($(date +%s%N) - start)) -lt 20000000000 ] || fail "it did not stop"
[ -z "$(ls -A o)" ] || fail "left behind: $(ls -A o)"

# Told once more a second later, while it has not ended yet (a busy machine,
# played by a process that stands still): the same message and status, not the
# signal's own.
late=0 again=0.01 stands=1.2
signalled TERM sizes "$program" mesh -p p/box --deck fine.deck \
  --farfield none --out o
exits 1
says err "interrupted; nothing was written"
[ -z "$(ls -A o)" ] || fail "left behind: $(ls -A o)"
