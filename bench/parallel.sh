#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# bench/parallel.sh: the cost of cutting, and the effect of ranks and threads.
#
# usage: bench/parallel.sh [--quick] [--scale X] [--runs N] [--data DIR]
#          [--aircraft NAME] [--leaf-cells LIST] [--build DIR] [--work DIR]
#          [--out FILE] [--json FILE] [PART...]
#   --quick       all cases at a twentieth of their size, one run
#   --scale       all numbers of cells times X (default 1)
#   --runs        runs of each case; medians are shown (default 3)
#   --data        folder of real geometry (verification/fetch.md) with the
#                 aircraft for the parts two and model
#   --aircraft    aircraft of the part two (default dlr_f6_medium)
#   --leaf-cells  sizes for the part leaf
#   --build       build folder (default build/release, built if missing)
#   --work        scratch folder, kept (default: a temporary one, removed)
#   --out         write the tables to FILE too
#   --json        all runs and figures as one JSON file
#   PART          price two balance leaf memory model replay
#
#   price         CPU time with 64 leaves over CPU time uncut, one thread, box
#                 5 M
#   two           start to files closed: 2 ranks, or 2 threads, compared with
#                 the best single thread, cut or uncut: box 10 M, sphere 12 M,
#                 aircraft; and the forecast of vanguard plan for two workers
#                 from the timeline of one
#   balance       maximum over mean of the times of workers, 8 leaves per worker
#   leaf          time, memory and forecast for 64 workers, by leaf size
#   memory        memory of the largest rank, by number of ranks
#   model         forecasts from the load estimate compared with timelines of
#                 one thread: box and sphere 5 M, sonic boom in a metric 1.5 M,
#                 DLR-F6 with layers, three leaf sizes
#   replay        box 23 M and sphere 12 M, cut for 64 workers: additional time
#                 of cutting; replays of their timelines on 1 to 512 threads;
#                 box 100 M on 512 from its estimate alone
#
# Runs that are compared alternate, so that other load on the machine affects
# all of them equally; wall / CPU in the JSON shows how much. The machine should
# be quiet: the load before the runs is in the heading. For the equality of
# files and the memory of a large mesh see verification/parallel.
# Exit status: 0 done, 1 the balance misses its limit or a run failed, 2 usage.
# Needs: jq, time, openmpi-bin.
set -euo pipefail

root=$(cd "$(dirname "$0")/.." && pwd)
# shellcheck source=bench/common.sh
. "$root/bench/common.sh"
# shellcheck source=bench/aircraft.sh
. "$root/bench/aircraft.sh"
build=$root/build/release
work='' json='' data='' aircraft=dlr_f6_medium quick=0 scale=1 runs=3
leaf_cells='20000 50000 100000 150000 300000 600000'
project='' options=()
take_options "scale runs data aircraft leaf-cells build work out json" \
  quick "$@"
if [ "$quick" = 1 ]; then
  runs=1 scale=$(calc "$scale / 20") aircraft=dlr_f6_coarse
  leaf_cells='10000 20000 50000'
fi
to_measure parallel
rows=$work/rows.json figures=$work/figures.json
: > "$rows"
: > "$figures"

cells() { calc "int($1 * $scale)"; }
fmt() { printf "%.${2:-2}f" "$1"; }

# once NAME RANKS THREADS OPTION...: a run of `project`; adds its row to all
# rows and keeps its timeline.
once() {
  local name=$1 ranks=$2 threads=$3
  shift 3
  run_mesh "$vanguard" "$work/$name" "$ranks" "$threads" -p "$project" \
    "${options[@]}" "$@" ||
    die "$name failed: $(grep -a '^vanguard' "$work/$name/log" | tail -1)"
  jq -c --arg part "$part" --arg name "$name" \
    '{part: $part, name: $name} + .' "$work/$name/row.json" >> "$rows"
  echo "$part $name: $(get "$work/$name/row.json" '"\(.wall) s"')" >&2
  find "$work/$name/out" -type f ! -name '*.json' -size +1M -delete
}
middle() {   # middle NAME KEY: median over the runs so far
  jq -r --arg part "$part" --arg name "$1" \
    "select(.part == \$part and .name == \$name) | $2" "$rows" | median
}
# figure NAME VALUE [BAR]: add a figure to the JSON.
figure() {
  jq -n -c --arg part "$part" --arg name "$1" --argjson value "$2" \
    --arg bar "${3:-}" '$ARGS.named' >> "$figures"
}
forecast() {   # forecast RECORD RANKS THREADS EXPRESSION
  "$vanguard" plan --replay "$1" --ranks "$2" --threads "$3" --json |
    jq -r ".forecast[0] | $4"
}

part_price() {
  local n ratio fill
  n=$(cells 5000000)
  demo_project box "$n" "$work/input"
  for ((i = 0; i < runs; i++)); do
    once whole 1 1 --leaf-cells 0
    once cut 1 1 --leaf-cells $((n / 64))
  done
  ratio=$(calc "$(middle cut .cpu) / $(middle whole .cpu)")
  fill=$(calc "$(middle cut .seconds.cut_fill) / \
    $(middle whole .seconds.cut_fill)")
  figure box "$ratio" '<= 1.10'
  say << ROW

## Price of cutting (limit: CPU ratio at most 1.10)

| case | cells | leaves | zones, % of cells | CPU uncut, s | CPU cut, s | ratio | ratio of cutting and filling, wall |
|---|---|---|---|---|---|---|---|
| box | $(middle cut .cells) | $(middle cut .leaves) | $(fmt "$(calc "100 * $(middle cut .zone_share)")" 1) | $(fmt "$(middle whole .cpu)") | $(fmt "$(middle cut .cpu)") | $(fmt "$ratio" 3) | $(fmt "$fill" 3) |
ROW
}

two_case() {   # two_case NAME: rows of `project`
  local one best r t w error
  for ((i = 0; i < runs; i++)); do
    once "$1-1x1" 1 1
    once "$1-uncut" 1 1 --leaf-cells 0
    once "$1-2x1" 2 1
    once "$1-1x2" 1 2
  done
  one=$(middle "$1-1x1" .wall)
  best=$(printf '%s\n' "$one" "$(middle "$1-uncut" .wall)" | sort -g | head -1)
  for how in 2x1 1x2; do
    r=${how%x*} t=${how#*x}
    w=$(middle "$1-$how" .wall)
    error=$(calc "100 * ($(forecast "$work/$1-1x1/record.json" "$r" "$t" \
      .seconds) / $(middle "$1-$how" .seconds.total) - 1)")
    figure "$1 $how" "$(calc "$best / $w")" '>= 1.75'
    figure "$1 $how forecast error percent" "$error"
    echo "| $1 | $(middle "$1-$how" .cells) | $how | $(fmt "$one") |" \
      "$(fmt "$(middle "$1-uncut" .wall)") | $(fmt "$w") |" \
      "$(fmt "$(calc "$best / $w")") | $(fmt "$(calc "$one / $w")") |" \
      "$(fmt "$(calc "$(middle "$1-$how" .cpu) / $w")") |" \
      "$(fmt "$(calc "100 * $(middle "$1-$how" .stolen)")" 1) |" \
      "$(fmt "$(middle "$1-$how" .imbalance)" 3) | $(fmt "$error" 1) |" | say
  done
}
part_two() {
  say << 'ROW'

## Two cores (limit: speed-up at least 1.75)

| case | cells | ranks x threads | 1x1, s | 1x1 uncut, s | s | speed-up against the better | against 1x1 | cores in use | taken by the host, % | imbalance | forecast off by, % |
|---|---|---|---|---|---|---|---|---|---|---|---|
ROW
  demo_project box "$(cells 10000000)" "$work/input"
  two_case box
  demo_project sphere "$(cells 12000000)" "$work/input"
  two_case sphere
  if [ -n "$data" ] && aircraft "$data" "$aircraft" "$work/input"; then
    two_case "$aircraft"
  else
    echo "no aircraft: --data DIR" >&2
  fi
}

part_balance() {
  say << 'ROW'

## Balance at 8 leaves per worker (limit: 1.05)

| case | ranks x threads | cells | leaves | busy, % | imbalance | bar | forecast for 16 workers: imbalance |
|---|---|---|---|---|---|---|---|
ROW
  local name how n leaf most kept
  for name in sphere wing; do
    n=$(cells 2000000)
    [ $name = wing ] || n=$(cells 6000000)
    demo_project $name "$n" "$work/input"
    once $name-probe 1 1
    leaf=$(calc "int($(middle $name-probe .estimate) / 16)")
    for how in 2x1 1x2; do
      once $name-$how ${how%x*} ${how#*x} --leaf-cells "$leaf"
      figure "$name $how" "$(middle $name-$how .imbalance)" '<= 1.05'
    done
    once $name-fine 1 1 --leaf-cells $((leaf / 8))
    for how in 2x1 1x2; do
      most=$(middle $name-$how .imbalance) kept=kept
      holds "$most" '<=' 1.05 || { kept=missed; failed=1; }
      echo "| $name | $how | $(middle $name-$how .cells) |" \
        "$(middle $name-$how .leaves) |" \
        "$(fmt "$(calc "100 * $(middle $name-$how .busy)")" 1) |" \
        "$(fmt "$most" 3) | $kept |" \
        "$(fmt "$(forecast "$work/$name-fine/record.json" 16 1 .imbalance)" 3) |" |
        say
    done
  done
}

part_leaf() {
  local name size id
  say << 'ROW'

## Leaf sizes

| case | leaf cells | leaves | zones, % of cells | 1x1, s | CPU, s | peak MB | 1x2, s | smallest angle | forecast, 64 workers: speed-up |
|---|---|---|---|---|---|---|---|---|---|
ROW
  for name in box sphere; do
    demo_project $name "$(cells 5000000)" "$work/input"
    for ((i = 0; i < runs; i++)); do
      for size in $leaf_cells; do
        once "$name-$size" 1 1 --leaf-cells "$size"
        once "$name-$size-1x2" 1 2 --leaf-cells "$size"
      done
    done
    for size in $leaf_cells; do
      id=$name-$size
      echo "| $name | $size | $(middle "$id" .leaves) |" \
        "$(fmt "$(calc "100 * $(middle "$id" .zone_share)")" 1) |" \
        "$(fmt "$(middle "$id" .wall)") | $(fmt "$(middle "$id" .cpu)") |" \
        "$(fmt "$(middle "$id" .peak_mb)" 0) |" \
        "$(fmt "$(middle "$id-1x2" .wall)") |" \
        "$(fmt "$(middle "$id" .angle_min)") |" \
        "$(fmt "$(forecast "$work/$id/record.json" 64 1 .speedup)" 1) |" | say
    done
  done
}

part_memory() {
  local n name shared per
  say << 'ROW'

## Memory of the largest rank (limit: 1.3 x 150 B x cells / ranks + shared part)

| case | ranks | cells | peak MB | all ranks, MB | shared part, MB | beside it, B per cell of a rank | bar, MB |
|---|---|---|---|---|---|---|---|
ROW
  for name in box sphere; do
    demo_project $name "$(cells 10000000)" "$work/input"
    for n in 1 2 4; do once $name-$n $n 1; done
    # peak = shared + per cells / ranks, through 1 and 4 ranks
    per=$(calc "($(middle $name-1 .peak_mb) - $(middle $name-4 .peak_mb)) * \
      1048576 / (0.75 * $(middle $name-1 .cells))")
    shared=$(calc "$(middle $name-1 .peak_mb) - \
      $per * $(middle $name-1 .cells) / 1048576")
    figure "$name shared MB" "$shared"
    for n in 1 2 4; do
      figure "$name $n ranks peak MB" "$(middle $name-$n .peak_mb)"
      echo "| $name | $n | $(middle $name-$n .cells) |" \
        "$(fmt "$(middle $name-$n .peak_mb)" 0) |" \
        "$(fmt "$(middle $name-$n .memory_mb)" 0) | $(fmt "$shared" 0) |" \
        "$(fmt "$per" 0) | $(fmt "$(calc "$shared + 1.3 * 150 / 1048576 * \
          $(middle $name-$n .cells) / $n")" 0) |" | say
    done
  done
}

# model_row NAME LEAF_CELLS: run and forecast `project`.
model_row() {
  local id=$1-$2 on=(-n 1 -t '2,4,8,16,32,64' --serial 0 --json)
  once "$id" 1 1 --leaf-cells "$2"
  "$vanguard" plan --replay "$work/$id/record.json" "${on[@]}" \
    > "$work/replay.json"
  "$vanguard" plan -p "$project" "${options[@]}" -q --leaf-cells "$2" \
    "${on[@]}" > "$work/plan.json"
  jq -r --slurpfile r "$work/replay.json" --slurpfile p "$work/plan.json" \
    --arg name "$1" --arg leaf "$2" '
    def f($d): . * pow(10; $d) | round / pow(10; $d);
    def off($a; $b): 100 * ($b / $a - 1) |
      (if . >= 0 then "+" else "" end) + "\(f(1))";
    $r[0].forecast as $a | [$p[0].forecast[].tasks] as $b |
    "| \($name) | \($leaf) | \(off(.cells; $p[0].mesh.cells)) | " +
    "\(.leaves) / \([$p[0].tree.nodes[] | select(.leaf)] | length) | " +
    "\($a[0].work | f(2)) / \($p[0].one_core.tasks | f(2)) | " +
    "\(100 * $a[0].cuts | f(1)) / \(100 * $b[0].cuts | f(1)) | " +
    "\(100 * $a[0].cuts_extra | f(1)) / " +
    "\(100 * $b[0].cuts_extra | f(1)) | " +
    ([range(6) | "\($a[.].speedup | f(2)) / \($b[.].speedup | f(2)) "] |
     join("| ")) + "| \(off($a[5].speedup; $b[5].speedup)) |"' \
    "$work/$id/row.json" | say
}
part_model() {
  local name leaf
  say << 'ROW'

## Forecasts from the load estimate and timelines of one thread (made / forecast)

| case | leaf cells | cells off by, % | leaves | tasks, s | cuts, % | extra, % | speed-up on 1 x 2 | 1 x 4 | 1 x 8 | 1 x 16 | 1 x 32 | 1 x 64 | 1 x 64 off by, % |
|---|---|---|---|---|---|---|---|---|---|---|---|---|---|
ROW
  for name in box sphere boom dlr_f6_coarse; do
    case $name in
      boom)
        demo_project boom "$(cells 1500000)" "$work/input"
        options=(--layers no) ;;
      dlr*)
        if [ -z "$data" ] || ! aircraft "$data" $name "$work/input"; then
          echo "no $name: --data DIR" >&2
          continue
        fi ;;
      *) demo_project $name "$(cells 5000000)" "$work/input" ;;
    esac
    for leaf in 28000 50000 100000; do model_row $name $leaf; done
  done
}

# replay_case NAME LEAF_CELLS: `project`, uncut and cut for 64 workers.
replay_case() {
  local name=$1 how added
  for ((i = 0; i < runs; i++)); do
    once "$name-uncut" 1 1 --leaf-cells 0
    once "$name" 1 1 --leaf-cells "$2"
  done
  added=$(calc "100 * ($(middle "$name" .seconds.cut_fill) / \
    $(middle "$name-uncut" .seconds.cut_fill) - 1)")
  figure "$name decomposing adds percent" "$added" '<= 10'
  for how in 1 2 4 8 16 32 64 128 256 512; do
    "$vanguard" plan --replay "$work/$name/record.json" --ranks 1 \
      --threads $how --serial 0 --json > "$work/tasks.json"
    "$vanguard" plan --replay "$work/$name/record.json" --ranks 1 \
      --threads $how --json > "$work/all.json"
    figure "$name $how" "$(get "$work/tasks.json" .forecast[0].speedup)"
    jq -r --slurpfile all "$work/all.json" --arg name "$name" \
      --arg cells "$(middle "$name" .cells)" --arg added "$(fmt "$added" 1)" '
      def f($d): . * pow(10; $d) | round / pow(10; $d);
      .forecast[0] | "| \($name) | \($cells) | \($added) | " +
        "\(100 * .cuts | f(1)) | \(100 * .cuts_extra | f(1)) | " +
        "\(.workers) | \(.seconds | f(2)) | \(.speedup | f(2)) | " +
        "\($all[0].forecast[0].speedup | f(2)) | \(.critical | f(2)) | " +
        "\(100 * .cuts_end / .seconds | f(1)) | \(.imbalance | f(3)) |"' \
      "$work/tasks.json" | say
  done
}
part_replay() {
  local n
  say << 'ROW'

## Forecasts from the timeline of one thread (limits: 45 at 64 workers, decomposing adds at most 10 %; PVGRID: 22.95 for the box, 15.47 for the sphere)

| case | cells | decomposing adds to the time uncut, % | cuts, % of the work | beyond the price of their cells in leaves, % | threads | s | speed-up of cutting and filling | speed-up of all, reading to files | critical path, s | cuts end at % of the time | imbalance |
|---|---|---|---|---|---|---|---|---|---|---|---|
ROW
  n=$(cells 23000000)
  demo_project box "$n" "$work/input"
  replay_case box "$(calc "int($n / 153)")"
  n=$(cells 12000000)
  demo_project sphere "$n" "$work/input"
  replay_case sphere "$(calc "int($n / 430)")"
  say << 'ROW'

## Forecasts before meshing (limit: 300 at 512 workers)

| case | cells expected | workers | cutting and filling, s | speed-up | of all | MB of a rank |
|---|---|---|---|---|---|---|
ROW
  n=$(cells 100000000)
  demo_project box "$n" "$work/input"
  "$vanguard" plan -p "$project" --ranks 64,512 --json --quiet \
    > "$work/plan.json"
  figure "box estimate 512" "$(get "$work/plan.json" \
    .forecast[1].tasks.speedup)" '>= 300'
  jq -r --arg n "$n" '
    def f($d): . * pow(10; $d) | round / pow(10; $d);
    .forecast[] | "| box | \($n) | \(.workers) | \(.tasks.seconds | f(2)) |"
      + " \(.tasks.speedup | f(1)) | \(.speedup | f(1)) |"
      + " \(.memory_bytes / 1048576 | f(0)) |"' "$work/plan.json" | say
}

[ -z "$out" ] || : > "$out"
failed=0 tried=0
say << HEAD
$(about_machine) Load before $(cut -d' ' -f1 /proc/loadavg); medians of $runs runs, sizes x $scale.
HEAD
for part in price two balance leaf memory model replay; do
  wanted "$part" || continue
  tried=1
  case $part in
    price) part_price ;;
    two) part_two ;;
    balance) part_balance ;;
    leaf) part_leaf ;;
    memory) part_memory ;;
    model) part_model ;;
    replay) part_replay ;;
  esac
done
[ $tried = 1 ] || die "no such part; see --help"
if [ -n "$json" ]; then
  jq -n --slurpfile figures "$figures" --slurpfile runs "$rows" \
    --arg scale "$scale" '{scale: $scale, $figures, $runs}' > "$json"
fi
exit $failed
