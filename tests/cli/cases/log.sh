# SPDX-License-Identifier: LGPL-3.0-or-later
# --log holds everything printed, and versions, host, ranks and threads,
# settings, and the phases. Existing files are not lost.
vanguard demo box --cells 2000 --out .
exits 0
vanguard mesh -q -p box --out o --hmax 0.3 --threads 2 --log run.log
exits 0
says run.log "vanguard 0.2.0, source "
says run.log "command  vanguard mesh -q -p box --out o --hmax 0.3"
says run.log "1 rank, 1 on this node"
says run.log "threads  2 per rank"
says run.log "  hmax                 0.3"
says run.log "  MPI "
says run.log "  glibc "
for phase in read 'surface check' 'sizing field' 'load estimate' fill \
  'interface repair' numbering 'mesh check' write; do
  grep -qE "^ *[0-9.]+ s  $phase" run.log || fail "no phase $phase"
done
says run.log "exit status 0 after"
# the report, word by word
sed -n '/^Vanguard demo: box/,/^  o\/box.report.json/p' run.log >logged
cat out >printed
is logged <printed

# a failure is logged too, and the next run replaces the log
vanguard mesh -q -p nothing --log run.log
exits 1
says run.log "vanguard: nothing: there is no such file"
says run.log "exit status 1 after"
lacks run.log "hmax"

# a file that is not a log is refused
cp box.deck mine
vanguard mesh -q -p box --out o --log mine
exits 1
says err "mine: this file exists and is not a log"
same box.deck mine
vanguard mesh -q -p box --out o --log no/where.log
exits 1
says err "no/where.log: the log cannot be written"
vanguard mesh -q -p box --out o --json --log run.log
exits 0
says run.log "validity: valid"

vanguard --version --verbose
exits 0
says out "vanguard 0.2.0"
says out "vanguard-tetgen"
# Every library has its version, or is not in this build.
for library in MPI METIS TetGen CGAL "Open CASCADE" HDF5 hwloc xxHash jansson \
  zlib LAPACKE libmicrohttpd glibc; do
  grep -qE "^  $library +([^ ].*)?([0-9]+\.[0-9]+|not in this build|not found)" \
    out || fail "no $library"
done
grep -qE '^  hwloc +[0-9]+\.[0-9]+\.[0-9]+$' out || fail "no hwloc"
grep -qE '^source   [0-9a-f]{64}$' out || fail "no digest of the source"
