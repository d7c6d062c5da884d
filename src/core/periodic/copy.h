/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/periodic/copy.h: gives a patch the triangles of another one.
 *
 * The triangles of the second patch of a pair are replaced by the images of
 * those of the first. Around the second patch, the other triangles change along
 * the common border: points of both borders that correspond are joined, other
 * images are inserted, and other points are removed.
 *
 *     other patches     o-----o-----o          o-----o-----o
 *                       | \ / | \ / |          | \ /|\ / \ |
 *     border            a--b--c--d--e   ->     a--p--q--r--e
 *                         second patch           images
 *
 * Corners, at which the other patches meet or a feature edge ends, must have
 * corresponding corners. */
#ifndef VG_CORE_PERIODIC_COPY_H
#define VG_CORE_PERIODIC_COPY_H

#include "core/periodic/periodic.h"

struct vg_periodic_copied {
  size_t n_joined, n_inserted, n_removed; /* points of the border */
  uint32_t *origin; /* [n_tri] owned: the former triangle of each one: itself,
                       the one it was cut from, or its original in the patch */
};
#define VG_PERIODIC_COPIED_INIT                                                \
  {                                                                            \
    0                                                                          \
  } /* releasing this is a no-op */

void vg_periodic_copied_release(struct vg_periodic_copied *c);

/** Finds the transform of p by vg_periodic_find, and then from the corners of
 * the borders, which are exact on triangulations of CAD.
 *
 * @param is_found  out: 0: there is no transform
 * VG_ERR_GEOMETRY: a border touches itself. VG_ERR_MEMORY. O(n log n). */
vg_status vg_periodic_find_corners(const struct vg_mesh *m,
                                   struct vg_periodic *p, int *is_found,
                                   struct vg_error *err);

/** Replaces the triangles of p->image. Other triangles keep their order,
 * followed by those inserted at the border and by the images.
 *
 * @param m          triangles only, consistently oriented
 * @param tolerance  largest distance of the image of a corner from its corner
 * @param out        released first
 *
 * VG_ERR_GEOMETRY, with m untouched: the borders do not correspond; the message
 * has the largest distance and its place. VG_ERR_MEMORY: untouched.
 * O(n log n). */
vg_status vg_periodic_copy(struct vg_mesh *m, const struct vg_periodic *p,
                           double tolerance, struct vg_periodic_copied *out,
                           struct vg_error *err);

#endif
