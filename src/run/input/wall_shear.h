/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/input/wall_shear.h: the skin friction on the walls of a flow solution, at
 * any point near them. Uses run/input/input.h. */
#ifndef VG_RUN_INPUT_WALL_SHEAR_H
#define VG_RUN_INPUT_WALL_SHEAR_H

#include "run/input/input.h"

struct vg_wall_shear; /* Opaque, read-only: threads may share it. */

/** Reads the file of the setting `first_from`, if any, into r->shear.
 *
 * The file is a .vtu or .vtp, or a folder of them, with a point array: the skin
 * friction coefficient c_f = tau_w / (rho U^2 / 2), or a vector whose length it
 * is, or a wall shear stress that `first_scale` turns into it. Walls are the
 * faces of the file, or without any the boundary of its cells, whose values are
 * not zero: solvers write zero on other boundaries and inside.
 *
 * VG_ERR_INPUT, VG_ERR_FORMAT: no such array, with the names of those that
 * there are; two arrays with usual names; values that are negative or not
 * finite; no walls. VG_ERR_MEMORY. */
vg_status vg_read_shear(struct vg_read *r, struct vg_error *err);

/** Accepts NULL. */
void vg_wall_shear_free(struct vg_wall_shear *w);

/** Name of the array; owned by w. */
const char *vg_wall_shear_field(const struct vg_wall_shear *w);

/** Smallest box around the walls. */
void vg_wall_shear_box(const struct vg_wall_shear *w, double lo[3],
                       double hi[3]);

/** Whether the walls have the orientation of a surface, by a sample of its
 * triangles and the nearest wall of each: the area of those that agree less
 * that of the others, over their sum, from -1 to 1. Triangles that are nearly
 * normal to the nearest wall do not count.
 *
 * @param on  [m->n_tri] 1: the triangle counts
 *
 * O(n_tri + log n) for n walls. */
double vg_wall_shear_side(const struct vg_wall_shear *w,
                          const struct vg_mesh *m, const uint8_t *on);

/** Skin friction coefficient at the point of the walls nearest to x,
 * interpolated between its corners; negative if that point is farther away than
 * a quarter of the longer of `edge` and the longest edge of its triangle, of
 * which at most 4 times `edge` counts: walls in another unit are not near.
 *
 * @param normal  of the surface at x; walls that face the other way count only
 *                if no other wall is that near
 * @param side    1, -1: walls have the orientation of the surface, or the
 *                opposite one; 0: orientations do not count */
double vg_wall_shear_at(const struct vg_wall_shear *w, const double x[3],
                        const double normal[3], int side, double edge);

#endif
