# SPDX-License-Identifier: LGPL-3.0-or-later
# A command that is killed before any of its file calls at the end leaves all
# old files, or all new ones: the next command completes or undoes its moves.
needs metis
[ -n "${VG_KILL_LIBRARY:-}" ] || skip "kill_at is not built"

vanguard demo box --cells 400 --out p
vanguard mesh -q -p p/box --out m --write b8.ugrid
exits 0

# write N FOLDER: a set of files, an OpenFOAM case among them.
write() {
  vanguard partition -q m/box.b8.ugrid -n "$1" --write part,vtu,foam \
    --out "$2/box"
}
mkdir old
write 2 old
exits 0
echo "of somebody else" >old/box.openfoam/constant/polyMesh/blockMeshDict
echo "of somebody else" >old/box.other
cp -a old new
write 3 new
exits 0
echo "of somebody else" |
  is new/box.openfoam/constant/polyMesh/blockMeshDict

n_old=0 n_new=0
for ((at = 1; at < 400; at++)); do
  rm -rf o
  cp -a old o
  ASAN_OPTIONS=$ASAN_OPTIONS:verify_asan_link_order=0 VG_KILL_AT=$at \
    LD_PRELOAD=$VG_KILL_LIBRARY "$program" partition -q m/box.b8.ugrid -n 3 \
    --write part,vtu,foam --out o/box >out 2>err
  status=$?
  [ $status != 0 ] || break
  exits 137
  # A command that ends before it writes.
  vanguard partition -q m/box.b8.ugrid -n 99999999 --out o/box
  exits 1
  says err "solver partitions were requested"
  if diff -r old o >differences; then n_old=$((n_old + 1))
  elif diff -r new o >>differences; then n_new=$((n_new + 1))
  else fail "killed before call $at: $(cat differences)"
  fi
done 2>/dev/null
exits 0
diff -r new o || fail "an undisturbed command"
[ $n_old -ge 10 ] && [ $n_new -ge 10 ] ||
  fail "killed with old files left $n_old times, with new ones $n_new times"
