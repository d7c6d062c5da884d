# SPDX-License-Identifier: LGPL-3.0-or-later
# A mesh that does not fit into memory is refused before its fill, with the
# figure and a remedy; the limit does not change the mesh.
vanguard demo box --cells 200000 --out .
exits 0
vanguard mesh -q -p box --write b8.ugrid --max-memory 0.02 --out small
exits 1
says err "cells outside the layers and need at least 0."
says err "GB on each node in the mesh check, but --max-memory allows 0.02 GB; \
use larger sizes or more nodes"
absent small/box.b8.ugrid
for limit in 2 0; do
  vanguard mesh -q -p box --write b8.ugrid --max-memory $limit --out "m$limit"
  exits 0
done
same m0/box.b8.ugrid m2/box.b8.ugrid

# 1.4 billion cells that no machine of this size has the memory for
vanguard mesh -q -p box --hmax 0.0018 --surface-sizes no --max-memory 20 \
  --write b8.ugrid --out large
exits 1
says err "the mesh would have about 1."
says err "e+09 cells outside the layers and need at least 3"
absent large/box.b8.ugrid

# A source over the whole domain that requests billions of cells is refused
# before the tasks are forecast, which would take minutes.
vanguard demo sphere --cells 20000 --out .
cat >source.deck <<'END'
A source over the whole domain
hmax
2.6

farfield
kind
none

sources
kind    h0    h1    r0
sphere  0.04  0.04  20
END
vanguard mesh -q -p sphere --deck source.deck --surface-sizes no --max-memory 20 \
  --write b8.ugrid --out large
exits 1
says err "e+09 cells outside the layers and need at least 9"
absent large/sphere.b8.ugrid
