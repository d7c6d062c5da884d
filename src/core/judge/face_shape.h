/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/judge/face_shape.h: area vectors and centres as in OpenFOAM: a
 * quadrilateral consists of the triangles around the mean of its corners, a
 * cell of the pyramids from its faces to the mean of their centres. */
#ifndef VG_CORE_JUDGE_FACE_SHAPE_H
#define VG_CORE_JUDGE_FACE_SHAPE_H

struct vg_face_shape {
  double area[3], centre[3];
};

/** Area vector and centre of a triangle (n 3) or quadrilateral (n 4).
 * Thread-safe; constant cost. */
void vg_face_shape(const double x[4][3], int n, struct vg_face_shape *out);

/** Centre of a cell with these faces, whose area vectors all point outward or
 * all inward. Returns three times its volume, negative if they point inward.
 * Thread-safe; constant cost. */
double vg_faces_middle(const struct vg_face_shape *shape, int n_face,
                       double at[3]);

#endif
