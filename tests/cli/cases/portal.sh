# SPDX-License-Identifier: LGPL-3.0-or-later
# vanguard serve, queried by curl: access, refused paths, runs, stops and
# resumes, a portal that dies, jobs, sweeps. Needs curl.
command -v curl >/dev/null || skip "no curl"
servers=()
stop_all() {
  local file pid
  for pid in "${servers[@]}"; do kill "$pid" 2>/dev/null; done
  for file in */vanguard-runs/*/run.json; do   # left behind by a failure
    [ -e "$file" ] || continue
    pid=$(sed -n 's/.*"pid": \([0-9]*\).*/\1/p' "$file")
    [ "${pid:-0}" -gt 1 ] || continue
    ! grep -qs "$PWD" "/proc/$pid/cmdline" || kill -9 -- "-$pid" 2>/dev/null
  done
}
trap stop_all EXIT

# serve NAME OPTION...: starts a portal of the folder NAME; its address in
# $url, its process in $server.
serve() {
  local name=$1
  shift
  rm -f "$name.url"
  "$program" serve --port 0 --root "$name" "$@" >"$name.url" 2>"$name.err" &
  server=$!
  servers+=($server)
  for _ in $(seq 100); do
    ! [ -s "$name.url" ] || break
    kill -0 $server 2>/dev/null || break
    sleep 0.1
  done
  url=$(cat "$name.url")
  origin=${url%/*/}
}

mkdir -p mine other
"$program" demo box --cells 2000 --out mine >out 2>err
"$program" demo box --cells 300000 --out mine/large >out 2>err
serve mine --max-upload 100000
grep -q 'portal' mine.err && grep -q libmicrohttpd mine.err &&
  skip "$(cat mine.err)"
[ -n "$url" ] || fail "no address: $(cat mine.err)"

# asks STATUS CURL-ARGUMENT...: the response body in `body`.
asks() {
  local expected=$1 got
  shift
  got=$(curl -s --max-time 60 -o body -w '%{http_code}' "$@")
  [ "$got" = "$expected" ] || fail "status $got, not $expected, of $*"
}
# posts STATUS PATH CURL-ARGUMENT...: a POST like those of the page.
posts() { asks "$1" -X POST -H "Origin: $origin" "${@:3}" "$url$2"; }

# --- access

asks 200 "$url"
says body 'box.lb8.ugrid'
asks 403 "$origin/"
asks 403 "$origin/00000000000000000000000000000000/"
asks 403 -H "Host: evil.example" "$url"
asks 200 -H "Host: localhost:1" "$url"
asks 403 -X POST "${url}runs" -d project=box.lb8.ugrid
asks 403 -X POST -H "Origin: http://evil.example" "${url}runs" -d project=x
asks 403 -X POST -H "Origin: null" "${url}runs" -d project=x
asks 405 -X DELETE "$url"
[ "$(stat -c %a mine/vanguard-runs/portal.url)" = 600 ] || fail "portal.url is readable by others"
[ "$(cat mine/vanguard-runs/portal.url)" = "$url" ] || fail "another address"
lacks "/proc/$server/cmdline" "${url: -20:10}"

# bound to this machine alone
port=${origin##*:}
hex=$(printf '%04X' "$port")
grep -q "0100007F:$hex 00000000:0000 0A" /proc/net/tcp || fail "not on loopback"
! grep -q "00000000:$hex 00000000:0000 0A" /proc/net/tcp || fail "the portal listens on all interfaces"
! grep -qs ":$hex [0:]* 0A" /proc/net/tcp6 || fail "the portal listens on IPv6"
for address in $(hostname -I 2>/dev/null); do
  case $address in 127.*|*:*) continue ;; esac
  ! (: <"/dev/tcp/$address/$port") 2>/dev/null || fail "the portal can be reached at $address"
done

# two users with a portal each; neither can access the other's folder
first=$url
serve other
[ -n "$url" ] || fail "no second portal: $(cat other.err)"
token=${first%/}
asks 403 "$origin/${token##*/}/"
token=${url%/}
asks 403 "${first%/*/}/${token##*/}/"
kill "$server"
wait "$server"
status=$?
exits 0
absent other/vanguard-runs/portal.url
url=$first origin=${first%/*/} server=${servers[0]}
"$program" serve --port 0 --root mine >out 2>err
status=$?
exits 1
says err "another portal uses"
vanguard serve --port "$port" --root other
exits 1
says err "cannot listen on port $port of 127.0.0.1"
vanguard serve --root nothing
exits 1
vanguard serve --jobs 0
exits 2

# --- paths and sizes

ln -s "$PWD/other" mine/away
echo SECRET >other/secret.stl
ln -s "$PWD/other/secret.stl" mine/link.stl
asks 200 "$url?project=link.stl"
says body "is outside the folder"
for path in ../other/secret.stl away/secret.stl "$PWD/other/secret.stl" \
    link.stl vanguard-runs/../../other/secret.stl; do
  posts 400 runs --data-urlencode "project=$path"
  lacks body SECRET
done
posts 400 runs -d project=box.lb8.ugrid -d s.sizes=/etc/passwd
posts 400 runs -d project=box.lb8.ugrid -d s.mesher=./it.so
says body "plug-in"
posts 400 runs -d project=box.lb8.ugrid -d s.growth=0.3
says body "growth is 0.3; it must be above 1"
command -v sbatch >/dev/null ||
  posts 400 runs -d project=box.lb8.ugrid -d where=slurm
asks 404 --path-as-is "${url}runs/1/file/../../../box.lb8.ugrid"

head -c 150000 /dev/zero >big.stl
head -c 300000 /dev/zero >bigger.stl
posts 413 upload -F "file=@bigger.stl"
posts 400 upload -F "file=@big.stl"
says body "--max-upload"
absent mine/big.stl
curl -s -o body -X POST -H "Origin: $origin" -H "Transfer-Encoding: chunked" \
  -F "file=@bigger.stl" "${url}upload"
says body "--max-upload"
[ -z "$(find mine -name '*bigger*')" ] || fail "an upload left files behind"
octahedron >octa.obj
posts 303 upload -F folder= -F "file=@octa.obj"
same octa.obj mine/octa.obj
posts 400 upload -F "file=@octa.obj"
says body "already exists"
posts 400 upload -F "folder=away" -F "file=@big.stl;filename=x.obj"
posts 400 upload -F "file=@octa.obj;filename=.profile"
[ "$(ls other)" = "secret.stl
vanguard-runs" ] || fail "other has $(ls other)"

# endless request headers
head -c 60000 /dev/zero | tr '\0' x >long
code=$(curl -s -o /dev/null -w '%{http_code}' -H "X: $(cat long)" "$url")
[[ $code = 4* || $code = 000 ]] || fail "a long header: $code"
many=()
for k in $(seq 100); do many+=(-H "X-$k: 1"); done
asks 431 "${many[@]}" "$url"
asks 200 "$url"

# --- runs

# state ID: of run ID; await ID STATE SECONDS
state() {
  curl -s "${url}runs.json" >runs.json
  tr -d '\n' <runs.json | sed 's/},/},\n/g' |
    sed -n "s/.*\"id\": $1,.*\"state\": \"\([a-z]*\)\".*/\1/p"
}
await() {
  local s=''
  for _ in $(seq $(($3 * 10))); do
    s=$(state "$1")
    [ "$s" != "$2" ] || return 0
    sleep 0.1
  done
  fail "run $1 is $s, not $2: $(tail -3 "mine/vanguard-runs/000$1/output.log")"
}

posts 303 runs -d project=box.lb8.ugrid -d s.hmax=0.2 \
  --data-urlencode "title=<b>&"
await 1 done 60
asks 200 "${url}runs"
says body '&lt;b&gt;&amp;'
lacks body '<b>&'
asks 200 "${url}runs/1/file/mesh/box.report.html"
says body 'Vanguard mesh report'
curl -s -D head -o body "${url}runs/1/file/mesh/box.report.html"
says head 'sandbox allow-scripts'
asks 200 "${url}runs/1/log"
says body 'hmax                 0.2'
"$program" mesh -q -p mine/box --hmax 0.2 --out plain >out 2>err
asks 200 "${url}runs/1/file/mesh/box.b8.ugrid"
same body plain/box.b8.ugrid
posts 400 runs -d project=box.lb8.ugrid -d s.farfield_size=1 -d ranks=0

# --- looks: the surface, its check and a forecast, by processes of their own

# look KIND FIELD...: starts a look and waits; its state and result in `body`.
look() {
  local id kind=$1
  shift
  posts 200 "looks/$kind" "$@"
  id=$(sed -n 's/{"id":\([0-9]*\)}/\1/p' body)
  for _ in $(seq 300); do
    asks 200 "${url}looks/$id"
    grep -q '"state":"running"' body || break
    sleep 0.1
  done
  look=$id
}
look view -d project=box.lb8.ugrid
says body '"state":"done"'
says body '"ok":true'
says body '"name":"1 '
asks 200 "${url}looks/$look/scene"
[ "$(wc -c <body)" -gt 300 ] || fail "the scene has $(wc -c <body) bytes"
asks 404 "${url}looks/$look/look.deck"
asks 404 --path-as-is "${url}looks/$look/../../lock"
look check -d project=box.lb8.ugrid -d s.layers=yes -d s.first=1e-3 \
  -d s.walls=1
says body '"layers":true'
look plan -d project=box.lb8.ugrid -d ranks=2
says body '"cells":'
says body '"memory_bytes":'
lacks body '"nodes"'
posts 400 looks/check -d project=box.lb8.ugrid -d s.y_plus=x
says body '"field":"s.y_plus"'
# the view is independent of wrong fields
look view -d project=box.lb8.ugrid -d s.y_plus=x
says body '"ok":true'
# a refused surface has a view, and its defects have coordinates
grep -v 'f 1 3 5' octa.obj >mine/open.obj
look view -d project=open.obj
says body '"ok":false'
says body '"open edge":3'
says body '"at":['
asks 200 "${url}looks/$look/scene"
echo junk >mine/junk.stl
look view -d project=junk.stl
says body '"state":"failed"'
says body "expected 'solid'"
asks 404 "${url}looks/$look/scene"
posts 400 looks/view -d project=away/secret.stl
asks 403 -X POST "${url}looks/view" -d project=box.lb8.ugrid
asks 403 "$origin/looks/$look"
rm mine/open.obj mine/junk.stl

# --- results of run 1 in the page

says runs.json '"valid": true'
asks 200 "${url}?report=1"
says body '<iframe title="Report of run 1" src="runs/1/file/mesh/box.report.html"'
asks 200 "${url}runs/1/picture/0"
[ "$(head -c 4 body | tail -c 3)" = PNG ] || fail "the picture is no PNG"
asks 200 "${url}runs/1/picture/1"
curl -s -D head -o run.tar "${url}runs/1/archive.tar"
says head 'filename="vanguard-0001.tar"'
mkdir unpacked
tar -xf run.tar -C unpacked
same plain/box.b8.ugrid unpacked/vanguard-0001/mesh/box.b8.ugrid
same mine/vanguard-runs/0001/run.log unpacked/vanguard-0001/run.log
asks 404 "${url}?report=77"
asks 404 "${url}?sweep=1"
echo "notes" >notes.txt
posts 303 upload -F "file=@notes.txt"
curl -s -o body "${url}?uploaded=notes.txt"
says body 'it is not a project'

# a run that fails gives the reason
posts 303 runs -d project=octa.obj -d farfield.kind=none -d s.max_cells=1
await 2 failed 60
says runs.json '1 are allowed'

# stopped after a task is kept and resumed: the same bytes; a second run waits
slow=(-d project=large/box.lb8.ugrid -d s.threads=1 -d s.leaf_cells=15000
  -d s.write=b8.ugrid)
kept() { find "mine/vanguard-runs/$1/kept" -type f 2>/dev/null | wc -l; }
until_kept() {
  for _ in $(seq 600); do
    [ "$(kept "$1")" -lt 6 ] || return 0
    [[ $(state "${1#000}") = @(queued|submitted|pending|running) ]] || break
    sleep 0.1
  done
  fail "run $1 keeps nothing"
}
# Runs are held in mid-work, so that none ends before it is stopped.
signal() { # SIGNAL RUN
  kill "-$1" -- "-$(sed -n 's/.*"pid": \([0-9]*\).*/\1/p' \
    "mine/vanguard-runs/$2/run.json")"
}
hold() { until_kept "$1"; signal STOP "$1"; }
posts 303 runs "${slow[@]}"
posts 303 runs "${slow[@]}"
[ "$(state 4)" = queued ] || fail "two runs work at the same time"
hold 0003
posts 303 runs/3/stop
signal CONT 0003
await 3 stopped 30
says runs.json 'finished tasks are stored'
# the next run begins by itself; it survives when its portal dies
hold 0004
kill -9 "$server"
wait "$server" 2>/dev/null
serve mine
asks 200 "${url}runs"
signal CONT 0004
posts 303 runs/3/resume
await 3 done 120
await 4 done 120
"$program" mesh -q -p mine/large/box --threads 1 --leaf-cells 15000 \
  --write b8.ugrid --out whole >out 2>err
same whole/box.b8.ugrid mine/vanguard-runs/0003/mesh/box.b8.ugrid
same whole/box.b8.ugrid mine/vanguard-runs/0004/mesh/box.b8.ugrid
absent mine/vanguard-runs/0003/kept

# the portal is ended while a run works: the run continues, and the next
# portal shows it
posts 303 runs "${slow[@]}"
hold 0005
kill "$server"
wait "$server"
status=$?
exits 0
says mine.err "1 run still waiting or running"
serve mine
[[ $(state 5) = @(running|done) ]] || fail "run 5 is $(state 5)"
posts 303 runs/5/stop
signal CONT 0005
await 5 stopped 30

# a sweep
posts 303 runs -d project=box.lb8.ugrid -d what=sweep -d sweep.threads=1,2
await 6 done 60
asks 200 "${url}runs/6/file/sweep/sweep.csv"
asks 200 "${url}runs"
says body 'sweep.csv'
asks 200 "${url}?sweep=6"
says body 'src="runs/6/file/sweep/speedup.svg"'
[ "$(grep -o '<th scope="row">' body | wc -l)" = 2 ] || fail "not two cases"
asks 200 "${url}?compare=1&compare=4"
says body '<code>leaf_cells</code></th><td>300000</td><td>15000</td>'

# on ranks: mpirun passes the stop signal on
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 \
  OMPI_MCA_rmaps_base_oversubscribe=1
kill "$server"
wait "$server"
ASAN_OPTIONS=$ASAN_OPTIONS:detect_leaks=0 serve mine   # MPI itself leaks
posts 303 runs "${slow[@]}" -d ranks=2
if timeout 20 mpirun -n 2 true >/dev/null 2>&1; then
  until_kept 0007
  posts 303 runs/7/stop
  await 7 stopped 60
  says runs.json 'finished tasks are stored'
  posts 303 runs/7/resume
  await 7 done 120
  same whole/box.b8.ugrid mine/vanguard-runs/0007/mesh/box.b8.ugrid
fi
kill "$server"
wait "$server"

# --- jobs, with a fake Slurm

mkdir -p bin
cat >bin/sbatch <<'END_SBATCH'
#!/bin/bash
# Records its arguments, and starts the script in the background.
echo "sbatch $*" >>"$FAKE/calls"
env | grep -E '^(PROJECT|OUT|RUN_DIR|OPTIONS|VANGUARD)=' >>"$FAKE/calls"
echo "sbatch: a word of warning" >&2
setsid bash "${@: -1}" >>output.log 2>&1 </dev/null &
echo $! >"$FAKE/job.pid"
echo 4711
END_SBATCH
cat >bin/squeue <<'END_SQUEUE'
#!/bin/bash
! kill -0 "$(cat "$FAKE/job.pid")" 2>/dev/null || echo "4711 RUNNING"
END_SQUEUE
cat >bin/scancel <<'END_SCANCEL'
#!/bin/bash
echo "scancel $*" >>"$FAKE/calls"
kill "$(cat "$FAKE/job.pid")"
END_SCANCEL
chmod +x bin/*
export FAKE=$PWD PATH=$PWD/bin:$PATH
serve mine
posts 303 runs "${slow[@]}" -d where=slurm -d ranks=1 -d cpus=1 \
  -d time=01:00:00 -d partition=big
until_kept 0008
kill -STOP -- "-$(cat job.pid)" # as above
await 8 running 30
says calls "--nodes 1 --ntasks-per-node 1 --cpus-per-task 1 --time=01:00:00 --partition=big vanguard.sbatch"
says calls "PROJECT=$PWD/mine/large/box.lb8.ugrid"
posts 303 runs/8/stop
for _ in $(seq 300); do
  ! grep -q scancel calls || break
  sleep 0.1
done
kill -CONT -- "-$(cat job.pid)"
await 8 stopped 30
says calls "scancel --batch --signal=TERM 4711"
posts 303 runs/8/resume
await 8 done 120
same whole/box.b8.ugrid mine/vanguard-runs/0008/mesh/box.b8.ugrid

# deleted runs are gone, links in them are not followed
ln -s "$PWD/other" mine/vanguard-runs/0006/away
asks 403 -X POST "${url}runs/6/delete"
posts 303 runs/6/delete
absent mine/vanguard-runs/0006
[ -e other/secret.stl ] || fail "a link was followed"
asks 404 "${url}?sweep=6"
