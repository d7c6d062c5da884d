# SPDX-License-Identifier: LGPL-3.0-or-later
# Without a command, with help, with a typing error: texts and exit status.
vanguard
exits 2
is err <<'END'
Usage: vanguard COMMAND [OPTION...]
Vanguard generates volume meshes for aerodynamics from closed surfaces: viscous
layers on the walls, tetrahedra elsewhere.

  mesh      generate the volume mesh of a project on threads and MPI ranks
  surface   remesh a surface to target edge lengths
  check     check a surface or a volume mesh
  partition partition a volume mesh for a parallel flow solver
  convert   write a mesh or a surface in another format
  metric    make the metric of the next mesh from a flow solution
  adapt     run cycles of mesh, flow solver and metric
  plan      forecast cells, memory and time of a run
  sweep     mesh with various subdomain sizes, ranks and threads; compare
  serve     start, monitor and resume runs from a browser
  deck      write a run deck with all defaults
  demo      write a complete example project

'vanguard COMMAND --help' lists the options of a command, 'vanguard --version'
shows the version. On several nodes: 'mpirun -n RANKS vanguard mesh -p PROJECT'.
Exit status: 0 success, 1 failure, 2 wrong usage, 4 finished, but a limit on the
layers is not met or runs of a sweep differ.
END
cp err usage
vanguard --help
exits 0
is out <usage

vanguard --version
exits 0
is out <<'END'
vanguard 0.2.0
Licence LGPL-3.0-or-later: https://www.gnu.org/licenses/lgpl-3.0.html
END

vanguard chekc
exits 2
is err <<'END'
vanguard: unknown command 'chekc'; did you mean 'check'?
END

vanguard help chekc
exits 2
says err "did you mean 'check'?"

for command in mesh surface check partition convert sweep serve plan deck demo; do
  vanguard $command --help
  exits 0
  says out "Usage: vanguard $command [OPTION...]"
  cp out help
  vanguard help $command
  exits 0
  is out <help
  vanguard $command --no-such-option
  exits 2
  says err "--no-such-option"
done

# Help by -h, and suggestions for unknown options. The value of an option is
# not taken for one.
for command in mesh check sweep deck; do
  vanguard $command --help
  cp out help
  vanguard $command -h
  exits 0
  is out <help
done
vanguard mesh --grwoth 1.2 -p x
exits 2
is err <<'END'
vanguard mesh: unknown option '--grwoth'; did you mean '--growth'?
END
vanguard check x --jsn
exits 2
says err "unknown option '--jsn'; did you mean '--json'?"
vanguard mesh --farfield_lengths=3 x
exits 2
says err "unknown option '--farfield_lengths'; did you mean '--farfield-lengths'?"
vanguard mesh -growth 1.2 x
exits 2
says err "unknown option '-growth'; did you mean '--growth'?"
vanguard mesh -p --grwoth
exits 1
says err "--grwoth: there is no such file, and no project found"
vanguard mesh --quiet=x -p x
exits 2
vanguard mesh -p x -- --grwoth
exits 2
says err "only one project is accepted"

vanguard mesh
exits 2
says err "no project given; use -p PROJECT"
vanguard mesh -p x --growth 0.5
exits 2
says err "growth is 0.5; it must be above 1"
vanguard mesh -p x --max-cells 2.5
exits 2
says err "max_cells must be an integer, not '2.5'"
vanguard mesh -p x --max-cells 2.5e6 --leaf-cells 1e5
exits 1
says err "no project found"
vanguard mesh -p x --farfield sphree
exits 2
says err "did you mean 'sphere'?"
for command in mesh plan; do
  vanguard $command -p x --write nonsense
  exits 2
  says err "write: unknown format 'nonsense'"
  vanguard $command -p x --walls 3-a
  exits 2
  says err "walls: '3-a' is not a list of patches"
done
vanguard plan --replay x --target 5
exits 2
says err "takes no settings, deck or target"
vanguard check
exits 2
vanguard demo
exits 2
vanguard demo box --cells many
exits 2

# A file or a folder that does not exist. A project is found by its stem.
for command in mesh plan surface deck check; do
  vanguard $command nosuch.stl
  exits 1
  says err "vanguard: nosuch.stl: this file does not exist"
  lacks err "nosuch.stl."
  vanguard $command no/such
  exits 1
  says err "vanguard: no/such: the folder no does not exist"
done
vanguard check nosuch
exits 1
says err "vanguard: nosuch: there is no such file, and no project found"

# A failure to write standard output is an error, and reported.
if [ -w /dev/full ]; then
  vanguard demo box --cells 500 --out full
  for call in "demo --list" --help --version "help mesh" "mesh --help" \
    "mesh --usage" deck "deck --json" "deck --schema" "plan -q -j full/box"; do
    # shellcheck disable=SC2086
    "$program" $call >/dev/full 2>err
    status=$?
    exits 1
    says err "standard output could not be written completely"
    lacks err "memory"
  done
fi

# Names and values that are empty or unknown.
vanguard demo nosuch
exits 2
says err "unknown example 'nosuch'"
vanguard check ""
exits 1
says err "the name of the project is empty"
for list in "" b8.ugrid,,vtu b8.ugrid, ,vtu; do
  vanguard mesh box "--write=$list"
  exits 2
  says err "write: the list has an empty entry"
done
vanguard mesh box --farfield cube
exits 2
says err "--farfield: kind cannot be 'cube'"
vanguard mesh box --farfield-lengths -1
exits 2
says err "--farfield-lengths: lengths is -1"

# Decks in JSON that are no object, or have a setting in place of a table.
vanguard demo box --cells 500 --out json
for text in '[]' ' [1, 2]'; do
  echo "$text" >json/array.deck
  vanguard check -q json/box --deck json/array.deck
  exits 1
  says err "json/array.deck: a JSON deck is an object"
done
printf '[draft]\n\ngrowth\n1.3\n' >json/title.deck
vanguard check -q json/box --deck json/title.deck
exits 0
echo '{"layers": true}' >json/table.deck
vanguard check -q json/box --deck json/table.deck
exits 1
says err "the setting of this name is a member of 'settings'"

# A refused run leaves no folder.
vanguard mesh -q json/box --max-cells 10 --out refused
exits 1
says err "the mesh would have about"
absent refused

# Conflicting settings: wrong usage if options cause the conflict, bad input
# if the deck alone does.
vanguard demo box --cells 2000 --out p
vanguard check -q p/box
exits 0
says out "p/box"

# Every format in one list.
vanguard mesh -q -p p/box --out all --write "stl,tri,obj,mesh,meshb,fluent.msh,\
msh,b8.ugrid,lb8.ugrid,b4.ugrid,lb4.ugrid,r8.ugrid,lr8.ugrid,r4.ugrid,\
lr4.ugrid,b8l.ugrid,lb8l.ugrid,b8.ugrid64,lb8.ugrid64,ugrid,cogsg,openfoam,su2,\
vtu,pvtu,mapbc,fun3d.mapbc"
exits 0
for form in stl tri obj mesh meshb fluent.msh msh b8.ugrid lb8.ugrid b4.ugrid \
  lb4.ugrid r8.ugrid lr8.ugrid r4.ugrid lr4.ugrid b8l.ugrid lb8l.ugrid \
  b8.ugrid64 lb8.ugrid64 ugrid cogsg openfoam/constant/polyMesh/points su2 vtu \
  pvtu mapbc fun3d.mapbc; do
  exists all/box.$form
done
vanguard mesh -q -p p/box --write foam,openfoam
exits 2
says err "give only one of them"
for command in mesh plan; do
  vanguard $command -q -p p/box --constant-direction yes
  exits 2
  says err "constant_direction requires a split_direction"
done
printf 'A deck\nconstant_direction\nyes\n' >bad.deck
vanguard mesh -q -p p/box --deck bad.deck
exits 1
says err "bad.deck: constant_direction requires a split_direction"
printf 'A deck\nwrite\nnonsense\n' >bad.deck
vanguard mesh -q -p p/box --deck bad.deck
exits 1
says err "bad.deck:3: write: unknown format 'nonsense'"

# The other files of a run are checked before its input is read.
echo "not a surface" >p/broken.stl
vanguard mesh -q -p p/broken.stl --run-dir nowhere --resume
exits 1
says err "nowhere: this run directory does not exist"
absent nowhere
mkdir empty
vanguard mesh -q -p p/broken.stl --run-dir empty --resume
exits 1
says err "empty: the directory holds no run to resume"
if [ "$(id -u)" = 0 ]; then
  echo "a folder that cannot be written: not tested as root"
else
  mkdir -m 555 closed
  vanguard mesh -q -p p/broken.stl --out closed
  exits 1
  says err "closed: cannot write in this folder: Permission denied"
fi

# Files that are not surfaces, and paths that are not folders.
: >wing.x_t
for command in check mesh; do
  vanguard $command -q wing.x_t
  exits 1
  says err "wing.x_t: this is the native format of a CAD system; export"
done
: >wing.txt
vanguard mesh -q wing.txt
exits 1
says err "wing.txt: unknown suffix; known"
vanguard mesh -q -p p
exits 1
says err "p: this is a folder; give the stem of a project"
vanguard mesh -q -p p/box --out wing.txt
exits 1
says err "wing.txt: cannot create this folder: Not a directory"
