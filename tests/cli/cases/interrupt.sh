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
