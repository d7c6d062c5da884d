# SPDX-License-Identifier: LGPL-3.0-or-later
# Periodic patches in all formats that hold them: .cgns, .fluent.msh, .msh, and
# .periodic.cfg next to .su2 and .ugrid; with layers, a rotation and two
# translations.
needs tetgen hdf5
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 \
  OMPI_MCA_rmaps_base_oversubscribe=1 \
  OMPI_MCA_hwloc_base_binding_policy=none \
  PRTE_MCA_rmaps_default_mapping_policy=:oversubscribe \
  PRTE_MCA_hwloc_default_binding_policy=none

# shellcheck source=tests/cli/duct.bash
. "$here/duct.bash"
# shellcheck source=tests/cli/sector.bash
. "$here/sector.bash"

forms=b8.ugrid,msh,cgns,fluent.msh,su2
mesh() {
  local name=$1
  shift
  vanguard mesh "$name.stl" --flow internal --quiet --hmax 0.15 --first 0.004 \
    --cells mixed --write $forms "$@"
  exits 0
}
sector ring 7 0.3 0.08
deck ring "patch image" "lo hi"
mesh ring --walls in --out a
duct box
deck box "patch image" "w1 w2" "w3 w4"
mesh box --walls w5 --out a

grep MARKER a/ring.periodic.cfg >out
says out "MARKER_PERIODIC= ( lo, hi, 0, 0, 0, 0, 0, 51.42857142857"
grep MARKER a/box.periodic.cfg >out
says out "( w1, w2, 0, 0, 0, 0, 0, 0, 0, 0, 1, w3, w4, 0, 0, 0, 0, 0, 0, 0, 1, 0 )"

# Readers skip what they do not know.
for form in b8.ugrid msh cgns; do
  vanguard check a/ring.$form
  exits 0
  says out "valid"
done

# The same files on two ranks.
if mpirun -n 2 true >/dev/null 2>&1; then
  ASAN_OPTIONS=$ASAN_OPTIONS:detect_leaks=0 mpirun -n 2 "$program" mesh \
    ring.stl --flow internal --quiet --hmax 0.15 --first 0.004 --cells mixed \
    --write $forms --walls in --threads 1 --out ranks >out 2>err ||
    fail "two ranks: $(cat err)"
  for form in ${forms//,/ } periodic.cfg; do same a/ring.$form ranks/ring.$form; done
else echo "mpirun is not installed: the ranks are omitted"; fi

# Each pair of faces of the Fluent file has the transform between its points.
cat >pairs.py <<'EOF'
import math, re, sys

name, angle, shift = sys.argv[1], float(sys.argv[2]), eval(sys.argv[3])
text = open(name).read()
point, face, n_pair, kind = {}, {}, 0, {}
for head, body in re.findall(r"\((\d+ \([^()]*\))\(\n(.*?)\n\)\)", text, re.S):
    code, args = head.split(" ", 1)
    args = [int(a, 16) for a in args.strip("()").split()]
    rows = [line.split() for line in body.split("\n")]
    if code == "10":
        point = {i + 1: [float(x) for x in r] for i, r in enumerate(rows)}
    if code == "13":
        kind[args[0]] = args[3]
        for i, row in enumerate(rows):
            n = int(row[0]) if args[4] == 0 else args[4]
            first = 1 if args[4] == 0 else 0
            nodes = [int(v, 16) for v in row[first:first + n]]
            face[args[1] + i] = (args[0], nodes)
    if code == "18":
        first, last, zone, shadow = args
        assert kind[zone] == 12 and kind[shadow] == 8, kind
        assert last - first + 1 == len(rows) > 10
        for a, b in rows:
            za, a = face[int(a, 16)]
            zb, b = face[int(b, 16)]
            assert (za, zb) == (zone, shadow) and len(a) == len(b)
            c, s = math.cos(angle), math.sin(angle)
            d = shift[n_pair]
            for v in a:
                x, y, z = point[v]
                x, y, z = c * x - s * y + d[0], s * x + c * y + d[1], z + d[2]
                assert min(math.dist((x, y, z), point[w]) for w in b) < 1e-12
        n_pair += 1
assert n_pair == len(shift), n_pair
print("pairs match")
EOF
python3 pairs.py a/ring.fluent.msh 0.897597901025655 "[(0, 0, 0)]" >out
says out "pairs match"
python3 pairs.py a/box.fluent.msh 0 "[(0, 0, 1), (0, 1, 0)]" >out
says out "pairs match"

if command -v cgnscheck >/dev/null; then
  for case in ring box; do
    cgnscheck a/$case.cgns >out 2>&1
    says out 'checking connectivity "Periodic_2"'
    ! grep -i error out || fail "$case: errors of cgnscheck"
  done
else echo "cgnscheck is not installed: .cgns is omitted"; fi

cat >gmsh_pairs.py <<'EOF'
import sys
import gmsh

gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
gmsh.open(sys.argv[1])
tags, x, _ = gmsh.model.mesh.getNodes()
x = {t: x[3 * i:3 * i + 3] for i, t in enumerate(tags)}
n = 0
for _, surface in gmsh.model.getEntities(2):
    _, image, node, a = gmsh.model.mesh.getPeriodicNodes(2, surface)
    n += len(image) > 20
    for i, p in zip(image, node):
        y = [sum(a[4 * k + j] * x[p][j] for j in range(3)) + a[4 * k + 3]
             for k in range(3)]
        assert max(abs(y[k] - x[i][k]) for k in range(3)) < 1e-14
print(n, "periodic surfaces")
EOF
if /usr/bin/python3 -c "import gmsh" 2>/dev/null; then
  /usr/bin/python3 gmsh_pairs.py a/ring.msh >out
  says out "1 periodic surfaces"
  /usr/bin/python3 gmsh_pairs.py a/box.msh >out
  says out "2 periodic surfaces"
else echo "gmsh is not installed: .msh is omitted"; fi
