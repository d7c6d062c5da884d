# Ctrl-C ends cleanly: a message, status 1, and nothing half-written. Sent
# when the work has begun, with the whole fill still to come.
vanguard demo box --cells 400000 --out p
"$program" mesh -p p/box --out o >out 2>err &
pid=$!
for _ in $(seq 600); do
  ! grep -q '^sizes' err || break
  sleep 0.05
done
kill -INT $pid 2>/dev/null
wait $pid
status=$?
exits 1
says err "interrupted; nothing was written"
[ -z "$(ls -A o)" ] || fail "left behind: $(ls -A o)"

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
