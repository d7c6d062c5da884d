#!/bin/bash
# SPDX-License-Identifier: LGPL-3.0-or-later
# A lost link between two nodes: nodes.sh PROGRAM [SECONDS]. The nodes are
# network namespaces with host names of their own, connected by a virtual link
# that is cut when the first tasks are kept. All ranks must end within the
# silence of SECONDS (default 10) and a minute, name the silent rank, and the
# resumed run must write the bytes of an undisturbed one. Needs root, iproute2
# and Open MPI; otherwise it is skipped (77).
set -u
program=$(realpath "${1:?usage: nodes.sh PROGRAM [SECONDS]}")
silence=${2:-10}
skip() { echo "skipped: $*"; exit 77; }
[ "$(id -u)" = 0 ] || skip "needs root"
command -v ip >/dev/null || skip "needs iproute2"
mpirun --version 2>/dev/null | grep -q "Open MPI" || skip "needs Open MPI"

work=$(mktemp -d)
clean() {
  for k in 0 1; do
    for p in $(ip netns pids vgtest$k 2>/dev/null); do kill -KILL "$p"; done
  done
  sleep 0.2
  ip netns del vgtest0 2>/dev/null
  ip netns del vgtest1 2>/dev/null
  rm -rf "$work" /etc/netns/vgtest0 /etc/netns/vgtest1
}
trap clean EXIT
cd "$work" || exit 1
if ! { ip netns add vgtest0 && ip netns add vgtest1 &&
  ip link add vglink0 type veth peer name vglink1; } 2>err; then
  skip "no network namespaces: $(cat err)"
fi
for k in 0 1; do
  mkdir -p /etc/netns/vgtest$k
  printf '127.0.0.1 localhost\n10.98.0.1 vgtest0\n10.98.0.2 vgtest1\n' \
    >/etc/netns/vgtest$k/hosts
  ip link set vglink$k netns vgtest$k
  ip netns exec vgtest$k ip addr add 10.98.0.$((k + 1))/24 dev vglink$k
  ip netns exec vgtest$k ip link set vglink$k up
  ip netns exec vgtest$k ip link set lo up
done
cat >agent <<'END'
#!/bin/bash
host=$1
shift
exec ip netns exec "$host" unshare -u sh -c "hostname $host; exec sh -c '$*'"
END
chmod +x agent

export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
# on_nodes COMMAND...: one rank on each node.
on_nodes() {
  ip netns exec vgtest0 unshare -u sh -c "hostname vgtest0; exec mpirun \
    --mca plm_rsh_agent $work/agent --mca plm_rsh_no_tree_spawn 1 \
    --mca btl tcp,self --mca btl_tcp_if_include 10.98.0.0/24 \
    --mca oob_tcp_if_include 10.98.0.0/24 -H vgtest0,vgtest1 -wdir $work \
    -x OMPI_ALLOW_RUN_AS_ROOT -x OMPI_ALLOW_RUN_AS_ROOT_CONFIRM $*"
}

"$program" demo sphere --cells 400000 --out p >/dev/null || exit 1
mesh="mesh -q -p p/sphere --leaf-cells 20000 -t 1 --write b8.ugrid"
# shellcheck disable=SC2086 # words
"$program" $mesh --out whole >/dev/null || exit 1
on_nodes true >/dev/null 2>err || skip "mpirun does not start: $(head -3 err)"

on_nodes "$program $mesh --out cut --run-dir run --rank-silence $silence" \
  >out 2>err </dev/null &
job=$!
while kill -0 $job 2>/dev/null &&
  [ "$(find run/records -type f 2>/dev/null | wc -l)" -lt 3 ]; do
  sleep 0.01
done
kill -0 $job 2>/dev/null || { echo "the run ended too early"; cat err; exit 1; }
ip netns exec vgtest0 ip link set vglink0 down
start=$(date +%s)
# ranks: processes that run the program.
ranks() {
  for k in 0 1; do
    for p in $(ip netns pids vgtest$k); do
      [ "$(readlink "/proc/$p/exe")" != "$program" ] || echo "$p"
    done
  done
}
while [ -n "$(ranks)" ] &&
  [ $(($(date +%s) - start)) -lt $((silence + 60)) ]; do
  sleep 0.2
done
seconds=$(($(date +%s) - start))
echo "all ranks ended $seconds s after the link was cut"
grep "no sign of life" err
kill -0 $job 2>/dev/null && echo "mpirun itself still waits for the lost node"
bad=0
[ "$seconds" -lt $((silence + 60)) ] || { echo "FAILED: ranks go on"; bad=1; }
grep -q "rank 1 on vgtest1 has given no sign of life" err ||
  { echo "FAILED: the silent rank is not named"; bad=1; }
# shellcheck disable=SC2086 # words
"$program" $mesh --out cut --run-dir run --resume >out 2>err || { cat err; bad=1; }
grep 'tasks reused' out
cmp whole/sphere.b8.ugrid cut/sphere.b8.ugrid || bad=1
exit $bad
