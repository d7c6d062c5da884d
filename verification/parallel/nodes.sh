#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# verification/parallel/nodes.sh: runs on several nodes, and nodes that are lost.
#
# usage: verification/parallel/nodes.sh [--quick] [--vanguard PROGRAM]
#          [--nodes LIST] [--rounds N] [--silence S] [--rate RATE] [--work DIR]
#          [CASE...]
#   --quick     one round, two nodes, a smaller wing
#   --vanguard  the program (default build/release/bin/vanguard)
#   --nodes     numbers of nodes (default "2 4")
#   --rounds    repetitions of the cases with a lost node (default 10)
#   --silence   --rank-silence of these runs (default 6)
#   --rate      limit of each link, as of tc-tbf(8), e.g. 100mbit
#   --work      scratch folder, kept (default: a temporary one, removed)
#   CASE        layers metric link node rank (default: all)
#
# A node is a network namespace with a host name of its own. A virtual bridge
# connects the nodes:
#
#     node0 --+-- node1        one rank on each node; Open MPI uses TCP, and
#             |                starts the ranks through an agent that enters
#     node2 --+-- node3        the namespace
#
# layers, metric: all files of a run on N nodes are those of one rank. link, node,
# rank: when the first tasks are kept, the link of the last node is cut, or all
# its processes are killed with the link down, or its rank is stopped (SIGSTOP).
# The other ranks must end within the silence and a minute and name the silent
# rank. The run is then resumed on another number of nodes and must write the
# bytes of one rank.
# Exit status: 0 all of this holds, 1 a failure, 2 usage, 77 no root, iproute2,
# Open MPI or network namespaces.
set -euo pipefail

root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=bench/common.sh
. "$root/bench/common.sh"
vanguard=$root/build/release/bin/vanguard
work='' nodes='' rounds='' silence=6 rate='' quick=0 cases=()
take_options "vanguard nodes rounds silence rate work" quick "$@"
cells=400000              # of layers; a run that loses a node must last longer
if [ "$quick" = 1 ]; then nodes=${nodes:-2} rounds=${rounds:-1} cells=200000; fi
: "${nodes:=2 4}" "${rounds:=10}"
[ -x "$vanguard" ] || die "no program $vanguard: build it first"
vanguard=$(realpath "$vanguard")
[ "$(id -u)" = 0 ] || skip "needs root"
command -v ip > /dev/null || skip "needs iproute2"
mpirun --version 2> /dev/null | grep -q "Open MPI" || skip "needs Open MPI"

# --- nodes -------------------------------------------------------------------

n_made=0                  # nodes that exist
for n in $nodes; do n_max=$((n > ${n_max:-0} ? n : ${n_max:-0})); done
name=vg$$                 # of the namespaces: ${name}n0, ...; ${name}s: bridge

inside() { ip netns exec "$name$1" "${@:2}"; }   # inside nK COMMAND...
pids() { ip netns pids "${name}n$1" 2> /dev/null || true; }

remove_nodes() {
  local k p
  for ((k = 0; k < n_made; k++)); do
    for p in $(pids $k); do kill -KILL "$p" 2> /dev/null || true; done
  done
  sleep 0.2
  for ((k = 0; k < n_made; k++)); do
    ip netns del "${name}n$k" 2> /dev/null || true
    rm -rf "/etc/netns/${name}n$k"
  done
  ip netns del "${name}s" 2> /dev/null || true
  n_made=0
}

make_bridge() {
  ip netns add "${name}s" && inside s ip link add br0 type bridge &&
    inside s ip link set br0 up
}

make_node() {
  local k=$1 i
  mkdir -p "/etc/netns/${name}n$k"
  { echo "127.0.0.1 localhost"
    for ((i = 0; i < n_max; i++)); do echo "10.98.0.$((i + 1)) ${name}n$i"; done
  } > "/etc/netns/${name}n$k/hosts"
  ip netns add "${name}n$k"
  n_made=$((k + 1))
  ip link add "$name.$k" type veth peer name "$name-$k"
  ip link set "$name.$k" netns "${name}n$k" name link0
  ip link set "$name-$k" netns "${name}s"
  inside s ip link set "$name-$k" master br0 up
  inside "n$k" ip addr add "10.98.0.$((k + 1))/24" dev link0
  inside "n$k" ip link set link0 up
  inside "n$k" ip link set lo up
  [ -z "$rate" ] || inside "n$k" tc qdisc add dev link0 root tbf \
    rate "$rate" burst 64kb latency 50ms
}

work_folder nodes
work=$(realpath "$work")
trap 'remove_nodes; case $work in /tmp/vanguard-nodes.*) rm -rf "$work" ;; esac' EXIT
cd "$work"
make_bridge 2> refusal || skip "no network namespaces: $(cat refusal)"
for ((k = 0; k < n_max; k++)); do make_node $k; done
cat > agent <<'END'
#!/bin/sh
host=$1
shift
exec ip netns exec "$host" unshare -u sh -c "hostname $host; exec sh -c '$*'"
END
chmod +x agent

# on_nodes N COMMAND...: one rank on each of N nodes.
on_nodes() {
  local n=$1 k hosts=''
  for ((k = 0; k < n; k++)); do hosts+=,${name}n$k; done
  inside n0 unshare -u sh -c "hostname ${name}n0; exec mpirun \
    --mca plm_rsh_agent $work/agent --mca plm_rsh_no_tree_spawn 1 \
    --mca btl tcp,self --mca btl_tcp_if_include 10.98.0.0/24 \
    --mca oob_tcp_if_include 10.98.0.0/24 -H ${hosts#,} -wdir $work \
    -x OMPI_ALLOW_RUN_AS_ROOT -x OMPI_ALLOW_RUN_AS_ROOT_CONFIRM ${*:2}"
}
on_nodes "$n_max" true > /dev/null 2> refusal ||
  skip "mpirun does not start on the nodes: $(head -3 refusal)"

# --- the same files ----------------------------------------------------------

bad=0
fail() { echo "FAILED $*"; bad=1; }

# same CASE A B: the files of both folders but reports, which have times.
same() {
  diff -rq -x '*.report.*' -x '*.html' -x '*.resolved.deck' "$2" "$3" ||
    fail "$1: other files"
}

# A wing with layers: all writers, all kinds of cells.
layers_mesh() {
  "$vanguard" demo wing-sharp-half --cells "$cells" --out layers > /dev/null
  mesh="mesh -q -p layers/wing-sharp-half -t 1 --leaf-cells 30000 --cells mixed
    --write b8.ugrid,lb8.ugrid,cgns,su2,vtu,pvtu,msh,fluent.msh,foam"
}

metric_mesh() {
  "$vanguard" demo sphere --cells 20000 --out metric > /dev/null
  "$vanguard" mesh -q -p metric/sphere --write mesh --out sizes > /dev/null
  # Sizes that grow away from the plane x = 0, smaller along x: size tensors.
  awk '/^Vertices/ { getline n; print "MeshVersionFormatted 2\nDimension 3\n" \
         "SolAtVertices\n" n "\n1 3"
         while (n-- > 0) { getline; h = 0.2 + 0.04 * ($1 < 0 ? -$1 : $1)
           a = 1 / (h * h); print a, 0, a / 4, 0, 0, a / 4 } print "End" }' \
    sizes/sphere.mesh > sizes/sphere.sol
  mesh="mesh -q -p metric/sphere -t 1 --leaf-cells 10000 --max-cells 4000000
    --sizes sizes/sphere.sol --write b8.ugrid,cgns"
}

# same_files CASE: on one rank and on all numbers of nodes.
same_files() {
  local n started
  "${1}_mesh"
  # shellcheck disable=SC2086 # a list of words
  "$vanguard" $mesh --out "$1-one" > log 2>&1 || { cat log; fail "$1"; return; }
  for n in $nodes; do
    started=$(date +%s.%N)
    # shellcheck disable=SC2086
    on_nodes "$n" "$vanguard" $mesh --out "$1-$n" > log 2>&1 < /dev/null ||
      { cat log; fail "$1 on $n nodes"; continue; }
    same "$1 on $n nodes" "$1-one" "$1-$n"
    echo "$1: $n nodes, $(calc "b - a" "a=$started" "b=$(date +%s.%N)") s"
    rm -rf "$1-$n"
  done
}

# --- lost nodes --------------------------------------------------------------

# The processes of node K that run the program.
ranks_on() {
  local p
  for p in $(pids "$1"); do
    [ "$(readlink "/proc/$p/exe" 2> /dev/null)" != "$vanguard" ] || echo "$p"
  done
}

# lose CASE K: node K is lost.
lose() {
  case $1 in
    link) inside "n$2" ip link set link0 down ;;
    node) inside "n$2" ip link set link0 down
          # shellcheck disable=SC2046 # a list of numbers
          kill -KILL $(pids "$2") ;;
    rank) # shellcheck disable=SC2046
          kill -STOP $(ranks_on "$2") ;;
  esac
}

# The ranks on all of N nodes but the last.
others() {
  local k
  for ((k = 0; k < $1 - 1; k++)); do ranks_on $k; done
}

# lost_node CASE N M: on N nodes; resumed on M.
lost_node() {
  local last=$(($2 - 1)) started seconds job
  rm -rf run cut
  # shellcheck disable=SC2086 # a list of words
  on_nodes "$2" "$vanguard" $mesh --out cut --run-dir run \
    --rank-silence "$silence" > log 2>&1 < /dev/null &
  job=$!
  until [ "$(find run/records -type f 2> /dev/null | wc -l)" -ge 3 ] ||
    ! kill -0 $job 2> /dev/null; do sleep 0.01; done
  kill -0 $job 2> /dev/null || { cat log; fail "$1: ended too early"; return; }
  lose "$1" "$last"
  started=$(date +%s)
  while [ -n "$(others "$2")" ] &&
    [ $(($(date +%s) - started)) -lt $((silence + 60)) ]; do sleep 0.2; done
  seconds=$(($(date +%s) - started))
  [ "$seconds" -lt $((silence + 60)) ] || fail "$1: ranks go on"
  grep -q "rank $last on ${name}n$last has given no sign of life" log ||
    { cat log; fail "$1: rank $last is not named"; }
  remove_nodes          # ends what waits for the lost node, mpirun too
  wait $job 2> /dev/null || true
  make_bridge
  for ((k = 0; k < n_max; k++)); do make_node $k; done
  # shellcheck disable=SC2086
  on_nodes "$3" "$vanguard" $mesh --out cut --run-dir run --resume > log 2>&1 \
    < /dev/null || { cat log; fail "$1: not resumed"; return; }
  same "$1, resumed on $3 nodes" whole cut
  echo "$1: node $last of $2 lost, the others ended after $seconds s;" \
    "resumed on $3"
}

lost_nodes() {
  local round n m
  for ((round = 0; round < rounds; round++)); do
    for n in $nodes; do
      m=$((round % n_max + 1))
      lost_node "$1" "$n" "$((m == n ? m % n_max + 1 : m))"
    done
  done
}

for case in layers metric; do
  ! wanted $case || same_files $case
done
"$vanguard" demo sphere --cells 1000000 --out p > /dev/null
mesh="mesh -q -p p/sphere -t 1 --leaf-cells 10000 --write b8.ugrid"
# shellcheck disable=SC2086 # a list of words
"$vanguard" $mesh --out whole > /dev/null
for case in link node rank; do
  ! wanted $case || lost_nodes $case
done
exit $bad
