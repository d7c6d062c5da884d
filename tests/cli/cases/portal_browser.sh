# SPDX-License-Identifier: LGPL-3.0-or-later
# The portal's page in a browser: twenty runs started, stopped and resumed by
# clicks; their meshes equal those of the command line. Needs Debian's
# chromium.
browser=$(command -v chromium) || skip "no chromium"
python=$(command -v /usr/bin/python3) || skip "no Python"

mkdir root
"$program" demo box --cells 1500000 --out root >out 2>err
"$program" serve --port 0 --root root --jobs 2 >url 2>err &
server=$!
stop_all() {
  local file pid
  kill $server 2>/dev/null
  for file in root/vanguard-runs/*/run.json; do   # left behind by a failure
    pid=$(sed -n 's/.*"pid": \([0-9]*\).*/\1/p' "$file")
    [ "${pid:-0}" -gt 1 ] || continue
    ! grep -qs "$PWD" "/proc/$pid/cmdline" || kill -9 -- "-$pid" 2>/dev/null
  done
}
trap stop_all EXIT
for _ in $(seq 100); do
  [ ! -s url ] && kill -0 $server 2>/dev/null || break
  sleep 0.1
done
! grep -q libmicrohttpd err || skip "$(cat err)"
timeout 60 "$browser" --headless --no-sandbox --disable-gpu --dump-dom \
  --user-data-dir="$PWD/profile" about:blank >blank 2>browser.log ||
  skip "chromium does not start here: $(tail -1 browser.log)"

timeout 1400 "$python" "$here/portal_browser.py" "$browser" "$(cat url)" \
  box.lb8.ugrid "${VG_PORTAL_RUNS:-20}" "$PWD/portal.png" >out 2>err
status=$?
exits 0
cat out
says out "${VG_PORTAL_RUNS:-20} runs started"
read -r _ _ _ stopped _ resumed _ <out
# On a busy machine, some runs end before the browser has shown them as active.
least=3
[ "$stopped" -ge $least ] && [ "$resumed" -ge $least ] ||
  fail "only $stopped runs were stopped and $resumed resumed while active"
[ "$(wc -c <portal.png)" -gt 30000 ] || fail "the picture is blank"

"$program" mesh -q -p root/box --threads 1 --leaf-cells 12000 \
  --write b8.ugrid --out plain >out 2>err
for run in root/vanguard-runs/[0-9]*/; do
  same plain/box.b8.ugrid "$run/mesh/box.b8.ugrid"
done
kill $server
wait $server
status=$?
exits 0
