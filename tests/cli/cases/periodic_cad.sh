# SPDX-License-Identifier: LGPL-3.0-or-later
# Periodic patches of CAD models: a passage that is 1/7 of a turn, a channel
# that is periodic in three directions, and ends without corners.
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 \
  OMPI_MCA_rmaps_base_oversubscribe=1 \
  OMPI_MCA_hwloc_base_binding_policy=none \
  PRTE_MCA_rmaps_default_mapping_policy=:oversubscribe \
  PRTE_MCA_hwloc_default_binding_policy=none
cad=$here/../cad
vanguard check "$cad/box.step"
[ $status = 0 ] || skip "this build cannot read CAD"

# shellcheck source=tests/cli/sector.bash
. "$here/sector.bash"

# mesh FILE OPTION...: meshes a CAD file with its deck.
mesh() {
  local file=$1 name=${1%.*}
  shift
  cp "$cad/$file" .
  vanguard mesh "$file" --flow internal --quiet --write b8.ugrid --out "$name" \
    "$@"
  exits 0
  vanguard check "$name/$name.b8.ugrid"
  exits 0
  says out "valid"
}

# report NAME EXPRESSION: a value of the JSON report is as the jq expression says.
report() {
  if command -v jq >/dev/null; then
    jq -e "$2" "$1/$1.report.json" >out || fail "$1: $2: $(cat out)"
  fi
}

deck passage "patch image" "3 4"
mesh passage.step --surface-size 0.25 --surface-tolerance 0.01 \
  --edges-per-turn 12 --walls 1,2,5,6,7 --first 5e-3
report passage '.periodic[0] | .kind == "rotation" and .turns_per_circle == 7 and
  .centre == [0, 0, 0] and .axis == [0, 0, 1] and .triangles > 50'
report passage '.periodic_distance == 0'

deck channel "patch image" "3 4" "2 5" "1 7"
options=(--surface-size 0.2 --surface-tolerance 0.01 --edges-per-turn 12 --walls 6
  --first 5e-3)
mesh channel.brep "${options[@]}"
report channel '[.periodic[].translation | map(. * 1e12 | round / 1e12)] ==
  [[2, 0, 0.3], [0, 1, 0], [0, 0, 0.8]]'
report channel '.periodic_distance == 0'
if mpirun -n 2 true >/dev/null 2>&1; then
  ASAN_OPTIONS=$ASAN_OPTIONS:detect_leaks=0 mpirun -n 2 "$program" mesh \
    channel.brep --flow internal --quiet --write b8.ugrid --out two \
    "${options[@]}" >out 2>err || fail "two ranks: $(cat err)"
  same channel/channel.b8.ugrid two/channel.b8.ugrid
fi

deck pipe "patch image" "2 3"
mesh pipe.brep --surface-size 0.2 --surface-tolerance 0.01 --edges-per-turn 12
report pipe '(.periodic[0].translation | map(. * 1e12 | round / 1e12)) ==
  [0, 0, -1.5] and .periodic_distance == 0'

# refused DECK_LINE... : the model is refused, with the place in `err`.
refused() {
  deck passage "$@"
  vanguard check passage.step --flow internal
  exits 1
}
refused "patch image angle ux uy uz" "3 4 52 0 0 1"
says err "patches 3 and 4 do not match by the rotation by 52 degrees"
says err "the largest distance is 0.00997, at ("
refused "patch image tx ty tz" "3 5 1 0 0"
says err "the largest distance is 1.16, at ("
