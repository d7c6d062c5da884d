/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/input/periodic.h: periodic patches of the table `periodic`. */
#ifndef VG_RUN_INPUT_PERIODIC_H
#define VG_RUN_INPUT_PERIODIC_H

#include "core/periodic/periodic.h"
#include "run/input/input.h"

/** VG_ERR_UNSUPPORTED if the table has rows and a setting changes the surface:
 * periodic patches keep their triangles. */
vg_status vg_periodic_refuse(const struct vg_boundary *b, struct vg_error *err);

/** Finds or checks the transforms of all pairs on the closed surface, and moves
 * the points of each second patch to the images of those of the first.
 *
 * @param n_moved  out: points that moved
 *
 * VG_ERR_INPUT for patches that the surface does not have, or that are named
 * twice. VG_ERR_GEOMETRY for patches that do not match: the message has the
 * largest distance and its place. */
vg_status vg_periodic_settle(struct vg_boundary *b, size_t *n_moved,
                             struct vg_error *err);

/** Whether the patch with this number is in a pair of b. */
int vg_periodic_has(const struct vg_boundary *b, int32_t id);

/** Largest distance between a point and its image in a finished mesh, as a
 * share of the pair's extent. S103. */
#define VG_PERIODIC_EXACT 1e-10

/** Checks the pairs of b on the boundary m of a mesh, with its points.
 *
 * @param distance  out: the largest distance over all pairs
 *
 * VG_ERR_GEOMETRY if points or faces have no partner. */
vg_status vg_periodic_verify(const struct vg_boundary *b,
                             const struct vg_mesh *m, double *distance,
                             struct vg_error *err);

#endif
