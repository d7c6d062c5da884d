/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/periodic/periodic_pairs.h: periodic patches of the table `periodic`. */
#ifndef VG_RUN_PERIODIC_PERIODIC_PAIRS_H
#define VG_RUN_PERIODIC_PERIODIC_PAIRS_H

#include "base/stop.h"
#include "core/periodic/periodic.h"
#include "run/settings/settings.h"

struct vg_pairs {
  size_t n;
  struct vg_periodic *pair; /* [n] owned */
};
#define VG_PAIRS_INIT                                                          \
  {                                                                            \
    0                                                                          \
  } /* releasing this is a no-op */

void vg_pairs_release(struct vg_pairs *list);

/** Finds or checks the transforms of all rows of s on the closed surface m, and
 * moves the points of each second patch to the images of those of the first.
 *
 * @param list     replaced
 * @param n_moved  out: points that moved
 * @param is_changed  out: points moved or were renumbered, so that those of
 * both patches are in the same order
 *
 * VG_ERR_INPUT for patches that the surface does not have, or that are named
 * twice. VG_ERR_GEOMETRY for patches that do not match: the message has the
 * largest distance and its place. */
vg_status vg_pairs_settle(const struct vg_settings *s, struct vg_mesh *m,
                          struct vg_pairs *list, size_t *n_moved,
                          int *is_changed, struct vg_error *err);

/** Finds or takes the transforms of all rows of s on a surface whose patches
 * need not have matching triangles.
 *
 * @param chord  distance within which the triangles approximate the shape, as a
 *               share of the extent of a pair
 * @param list   replaced
 *
 * VG_ERR_INPUT as vg_pairs_settle. VG_ERR_GEOMETRY for patches whose shapes
 * differ: the message has the largest distance and its place. */
vg_status vg_pairs_locate(const struct vg_settings *s, const struct vg_mesh *m,
                          double chord, int threads, const struct vg_stop *stop,
                          struct vg_pairs *list, struct vg_error *err);

/** Replaces the triangles of the second patch of each pair by the images of
 * those of the first one (core/periodic/copy.h).
 *
 * @param origin     out: [m->n_tri] owned by the caller: the former triangle of
 *                   each one; replaces NULL
 * @param n_changed  out: points inserted into borders or removed from them
 *
 * VG_ERR_GEOMETRY as vg_periodic_copy; m may then have changed in part. */
vg_status vg_pairs_copy(const struct vg_pairs *list, struct vg_mesh *m,
                        uint32_t **origin, size_t *n_changed,
                        struct vg_error *err);

#define VG_BC_PERIODIC 6100 /* FUN3D's code, also written as USM3D's. */

/** Gives the patches of the table `periodic` that have no condition the
 * condition VG_BC_PERIODIC. Names and numbers that m does not have are left to
 * vg_pairs_settle. VG_ERR_INPUT for a patch with another condition. */
vg_status vg_pairs_give_conditions(const struct vg_settings *s,
                                   struct vg_mesh *m, struct vg_error *err);

/** Whether the patch with this number is in a pair. */
int vg_pairs_have(const struct vg_pairs *list, int32_t id);

/** Checks the pairs on the boundary m of a mesh, with its points.
 *
 * @param remedy    end of the message
 * @param distance  out: the largest distance over all pairs
 *
 * VG_ERR_GEOMETRY if points or faces have no partner. */
vg_status vg_pairs_verify(const struct vg_pairs *list, const struct vg_mesh *m,
                          const char *remedy, double *distance,
                          struct vg_error *err);

#endif
