# SPDX-License-Identifier: LGPL-3.0-or-later
# The portal in a browser, from an uploaded STEP file to finished meshes:
# portal_case.py lists the steps. Needs Debian's chromium.
browser=$(command -v chromium) || skip "no chromium"
python=$(command -v /usr/bin/python3) || skip "no Python"

mkdir -p root files pictures
cp "$here/../cad/wing.step" files/
echo "not a project" >files/notes.txt
# Two octahedra that intersect, one without a face.
octahedron() {   # NAME X Y Z SIZE FIRST-POINT
  awk -v x="$2" -v y="$3" -v z="$4" -v s="$5" -v n="$6" -v name="$1" 'BEGIN {
    split("1 0 0 -1 0 0 0 1 0 0 -1 0 0 0 1 0 0 -1", v, " ")
    split("3 2 5 2 4 5 4 1 5 3 1 6 2 3 6 4 2 6 1 4 6", f, " ")
    for (i = 0; i < 6; i++)
      print "v", x + s * v[3 * i + 1], y + s * v[3 * i + 2], z + s * v[3 * i + 3]
    print "g", name
    for (i = 0; i < 7; i++)
      print "f", n + f[3 * i + 1], n + f[3 * i + 2], n + f[3 * i + 3] }'
}
{ octahedron large 0 0 0 1 0
  octahedron small 0.9 0.2 0.1 0.5 6
  echo "f 7 9 11"; } >files/open.obj
"$program" demo box --cells 20000 --out files >out 2>err
"$program" serve --port 0 --root root --jobs 2 >url 2>err &
server=$!
stop_all() {
  local file pid
  kill $server 2>/dev/null
  for file in root/vanguard-runs/*/run.json; do   # left behind by a failure
    [ -e "$file" ] || continue
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

timeout 1200 "$python" "$here/portal_case.py" "$browser" "$(cat url)" \
  "$PWD/files" "$PWD/pictures" >out 2>err
status=$?
[ $status = 0 ] || cat out err
[ -z "${VG_PORTAL_PICTURES:-}" ] || cp pictures/*.png "$VG_PORTAL_PICTURES"
exits 0
says out "stays_here"
for name in geometry wrong forecast runs compare report defects sweep narrow; do
  [ "$(wc -c <pictures/portal_$name.png)" -gt 20000 ] || fail "$name is blank"
done

# The stopped and resumed run has the mesh of an undisturbed one.
run=root/vanguard-runs/0001
"$program" mesh -q -p root/wing.step -d $run/run.deck --out plain >out 2>err
same plain/wing.b8.ugrid $run/mesh/wing.b8.ugrid
absent root/vanguard-runs/0002
kill $server
wait $server
status=$?
exits 0
