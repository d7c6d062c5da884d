# SPDX-License-Identifier: LGPL-3.0-or-later
# A closed surface without conditions and with normals out of the fluid: a
# room that contains a block is taken as a domain, with a note.
needs tetgen
cat >room.obj <<'END'
v 0 0 0
v 9 0 0
v 9 9 0
v 0 9 0
v 0 0 9
v 9 0 9
v 9 9 9
v 0 9 9
v 3 3 0
v 6 3 0
v 6 6 0
v 3 6 0
v 3 3 3
v 6 3 3
v 6 6 3
v 3 6 3
g walls
f 5 6 7
f 5 7 8
f 1 2 6
f 1 6 5
f 2 3 7
f 2 7 6
f 3 4 8
f 3 8 7
f 4 1 5
f 4 5 8
g floor
f 1 10 2
f 1 9 10
f 2 11 3
f 2 10 11
f 3 12 4
f 3 11 12
f 4 9 1
f 4 12 9
g block
f 13 15 14
f 13 16 15
f 9 14 10
f 9 13 14
f 10 15 11
f 10 14 15
f 11 16 12
f 11 15 16
f 12 13 9
f 12 16 13
END
vanguard mesh -q -p room
exits 0
says out "Flow within the given outer boundary"
says out "Evidence: its outer part is a box, or part of a sphere"
says out "the orientation of the whole surface was reversed"
lacks out "added: farfield"
says out "3 patches have no boundary condition"
says out "number 1 2 3"
says out "volume: sum of cells 702"
vanguard mesh -q -p room --deck room.resolved.deck --out again
exits 0
same room.b8.ugrid again/room.b8.ugrid
says out "Evidence: given by the setting flow internal"
vanguard check -q room.obj
exits 0
says out "Flow within the given outer boundary"
vanguard check -q room.obj --half yes
exits 0
says out "setting that has no effect because the surface is closed: half"

# The user can override this.
vanguard mesh -q -p room --farfield sphere --farfield-lengths 3 \
  --growth 1.5 --out outside
exits 0
says out "added: farfield"
says out "Evidence: given by the setting farfield sphere"

# A single brick gives no evidence: it is taken as a body, and the note
# explains how to change that.
sed -e '/^g floor/,$d' room.obj >brick.obj
printf 'f 1 3 2\nf 1 4 3\n' >>brick.obj
sed -i '/^v/{9,$d}' brick.obj
vanguard mesh -q -p brick --farfield-lengths 3 --growth 1.5
exits 0
says out "External flow around 1 closed body; farfield added."
says out "flow internal"

# The root of half a body is 1e-4 beyond 0, with a row of points next to it: it
# is moved to 0 if the row is clear of 0. A cap that is uneven at one point is
# removed as a whole, or refused.
half() { # half NAME ROOT CORNER ROW: half a box, 1 x 2 x 1
  {
    printf 'v 0 %s 0\nv 1 %s 0\nv 1 %s 1\nv 0 %s 1\n' "$2" "$3" "$2" "$2"
    printf 'v 0 %s 0\nv 1 %s 0\nv 1 %s 1\nv 0 %s 1\n' "$4" "$4" "$4" "$4"
    printf 'v 0 2 0\nv 1 2 0\nv 1 2 1\nv 0 2 1\n'
    printf 'g root\nf 1 2 3\nf 1 3 4\ng wall\n'
    printf 'f 9 11 10\nf 9 12 11\n'
    for i in 1 2 3 4 5 6 7 8; do
      j=$((i % 4 ? i + 1 : i - 3))
      printf 'f %d %d %d\nf %d %d %d\n' $i $((j + 4)) $j $i $((i + 4)) $((j + 4))
    done
  } >"$1.obj"
}
half near -1e-4 -1e-4 1e-7
vanguard check -q near.obj --half y
exits 0
says out "External flow around 1 closed body (half model, cut at y = -0.0001)"
half clear -1e-4 -1e-4 1e-3
vanguard check -q clear.obj --half y
exits 0
says out "half model, cut at y = 0)"
says out "is up to 0.0001 off the plane y = 0; it was moved into this plane"
half uneven 0 1.9e-3 1
vanguard check -q uneven.obj --half y
exits 0
says out "the flat cap at y = 0 (2 triangles)"
says out "is up to 0.0019 off the plane y = 0; it was moved into this plane"
half far 0 0.05 1
vanguard check -q far.obj --half y
exits 1
says err "has no flat cap at an end in y"
