# Ctrl-C ends cleanly: a message, status 1, and nothing half-written.
vanguard demo box --cells 600000 --out p
"$program" mesh -q -p p/box --out o >out 2>err &
pid=$!
sleep 1.5
kill -INT $pid 2>/dev/null
wait $pid
status=$?
exits 1
says err "interrupted; nothing was written"
[ -z "$(ls -A o)" ] || fail "left behind: $(ls -A o)"
