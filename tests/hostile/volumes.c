/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Volume meshes that are well-formed files but wrong. All are made from the
 * unit tetrahedron with its four faces, or from two tetrahedra that share a
 * face. */
#include "hostile.h"

#define T1 "0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
#define FACES "1 2 3\n1 4 2\n1 3 4\n2 4 3\n1 1 1 1\n"
/* Faces of T1 and of a second tetrahedron 2 4 3 5 on its slanted face. */
#define FACES2 "1 2 3\n1 4 2\n1 3 4\n2 3 5\n2 5 4\n4 5 3\n1 1 1 2 2 2\n"

const struct hostile hostile_volumes[] = {
  { .file = "face_missing.ugrid",
    .phrase = "not valid",
    .text = "4 3 0 1 0 0 0\n" T1 "1 2 3\n1 4 2\n1 3 4\n1 1 1\n1 2 3 4\n" },
  { .file = "cell_twice.ugrid",
    .phrase = "not valid",
    .text = "4 4 0 2 0 0 0\n" T1 FACES "1 2 3 4\n1 2 3 4\n" },
  { .file = "loose_face.ugrid",
    .phrase = "not valid",
    .text = "7 5 0 1 0 0 0\n" T1 "5 5 5\n6 5 5\n5 6 5\n"
            "1 2 3\n1 4 2\n1 3 4\n2 4 3\n5 6 7\n1 1 1 1 1\n1 2 3 4\n" },
  { .file = "flat_cell.ugrid",
    .phrase = "not valid",
    .text = "4 4 0 1 0 0 0\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n" FACES "1 2 3 4\n" },
  { .file = "point_twice_in_cell.ugrid",
    .phrase = "not valid",
    .text = "4 4 0 1 0 0 0\n" T1 FACES "1 2 3 3\n" },
  { .file = "cells_overlap.ugrid",
    .phrase = "not valid",
    .text = "5 6 0 2 0 0 0\n" T1 ".1 .1 .1\n" FACES2 "1 2 3 4\n2 4 3 5\n" },
  { .file = "face_twice.ugrid",
    .phrase = "not valid",
    .text = "4 5 0 1 0 0 0\n" T1 "1 2 3\n1 4 2\n1 3 4\n2 4 3\n2 4 3\n"
            "1 1 1 1 1\n1 2 3 4\n" },
  { .file = "three_cells_on_face.ugrid",
    .phrase = "not valid",
    .text = "6 6 0 3 0 0 0\n" T1 "1 1 1\n2 2 2\n" FACES2
            "1 2 3 4\n2 4 3 5\n2 4 3 6\n" },
  { .file = "gap_in_boundary.mesh",
    .phrase = "not valid",
    .text = "MeshVersionFormatted 2 Dimension 3 Vertices 4 0 0 0 0 1 0 0 0 "
            "0 1 0 0 0 0 1 0 Triangles 1 1 2 3 1 Tetrahedra 1 1 2 3 4 0 "
            "End\n" },
  { .file = "no_boundary.mesh",
    .phrase = "not valid",
    .text = "MeshVersionFormatted 2 Dimension 3 Vertices 4 0 0 0 0 1 0 0 0 "
            "0 1 0 0 0 0 1 0 Tetrahedra 1 1 2 3 4 0 End\n" },
  { .file = "far_away.ugrid",
    .phrase = "beyond 1e+15",
    .text = "4 4 0 1 0 0 0\n0 0 0\n1e300 0 0\n0 1e300 0\n0 0 1e300\n" FACES
            "1 2 3 4\n" },
  { 0 }
};
