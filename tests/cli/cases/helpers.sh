# SPDX-License-Identifier: LGPL-3.0-or-later
# The helper programs: their interface on the command line, and runs without
# them and with unusable ones.
bin=$(dirname "$program")
export VANGUARD_HELPERS=$PWD/empty
mkdir empty

# Boundary recovery only needs TetGen for some surfaces.
vanguard demo box --cells 2000 --out p
vanguard mesh -q -p p/box --write lb8.ugrid --out none
exits 0
says none/box.resolved.deck "vanguard-tetgen (none)"
says none/box.report.json '"vanguard-tetgen": null'
vanguard mesh -q -p p/box --mesher tetgen --write lb8.ugrid --out n
exits 1
says err "mesher tetgen: vanguard-tetgen, the helper program with TetGen, is not in"
says err "VANGUARD_HELPERS"
absent n/box.lb8.ugrid
octahedron >body.obj
vanguard mesh -q -p body.obj --wrap 0.2 --out n
exits 1
says err "vanguard-wrap, the helper program with CGAL, is not in"

# A program that is no helper.
printf '#!/bin/sh\necho it is another program\n' >empty/vanguard-tetgen
chmod +x empty/vanguard-tetgen
vanguard mesh -q -p p/box --mesher tetgen --write lb8.ugrid --out n
exits 1
says err "cannot be used"
# Without it, another mesh might be made.
vanguard mesh -q -p p/box --write lb8.ugrid --out n
exits 1
says err "installed but cannot be used"
absent n/box.lb8.ugrid
vanguard --version --verbose
rm empty/vanguard-tetgen
[ -x "$bin/vanguard-tetgen" ] || skip "built without vanguard-tetgen"

# The option has precedence over the variable, and the folder may have blanks.
mkdir "a folder"
ln -s "$bin/vanguard-tetgen" "a folder/vanguard-tetgen"
vanguard mesh -q -p p/box --helpers "a folder" --mesher tetgen \
  --write lb8.ugrid --out with
exits 0
says with/box.report.json '"vanguard-tetgen": "TetGen'
says with/box.resolved.deck "vanguard-tetgen (TetGen"
lacks with/box.resolved.deck "a folder"
says out "subdomains filled by the selected mesher: 1,"

# A run with another helper is another run.
vanguard mesh -q -p p/box --helpers "a folder" --write lb8.ugrid --out r \
  --run-dir run --keep-run
exits 0
vanguard mesh -q -p p/box --write lb8.ugrid --out r2 --run-dir run --resume
exits 1
says err "vanguard-tetgen was"

# A helper that is killed while it works, as if memory had run out, ends the run.
# The repeated run has the same mesh.
mkdir mortal
cat >mortal/vanguard-tetgen <<END
#!/bin/sh
if [ -e "$PWD/kill" ]; then
  "$bin/vanguard-tetgen" --serve </dev/null
  kill -KILL \$\$
fi
exec "$bin/vanguard-tetgen" --serve
END
chmod +x mortal/vanguard-tetgen
for turn in dies resumes; do
  rm -f kill
  resume=
  if [ $turn = dies ]; then touch kill; else resume=--resume; fi
  vanguard mesh -q -p p/box --helpers mortal --mesher tetgen --leaf-cells 500 \
    --write lb8.ugrid --out mortal --run-dir kept $resume
  [ $turn = resumes ] && exits 0 && break
  exits 1
  says err "tetgen ended without an answer"
  says err "finished tasks are kept in kept"
  absent mortal/box.lb8.ugrid
done
vanguard mesh -q -p p/box --helpers "a folder" --mesher tetgen --leaf-cells 500 \
  --write lb8.ugrid --out straight
exits 0
same straight/box.lb8.ugrid mortal/box.lb8.ugrid

# Ranks must have the same helpers, also on one node.
if mpirun -n 2 true >/dev/null 2>&1; then
  mpirun -n 1 "$program" mesh -q -p p/box --write lb8.ugrid --out d : \
    -n 1 env VANGUARD_HELPERS= "$program" mesh -q -p p/box --write lb8.ugrid \
    --out d >out 2>err
  status=$?
  exits 1
  says err "uses another vanguard-tetgen (TetGen"
  absent d/box.lb8.ugrid
fi

# The helper by itself: it introduces itself, answers through pipes and ends
# with its input. The job is a tetrahedron with one triangle.
"$bin/vanguard-tetgen" --version >out
says out "message format 3"
"$bin/vanguard-tetgen" </dev/null | head -c 8 >out
says out VGHELPER
"$bin/vanguard-tetgen" --what 2>err </dev/null
status=$?
exits 2
says err "helper program of Vanguard"
