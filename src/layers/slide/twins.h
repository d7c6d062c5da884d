/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* layers/slide/twins.h: columns that slide in periodic patches. The columns of
 * the second patch of a pair are the images of those of the first one, their
 * twins. Uses core, columns.h. */
#ifndef VG_LAYERS_SLIDE_TWINS_H
#define VG_LAYERS_SLIDE_TWINS_H

#include "core/periodic/periodic.h"
#include "layers/columns/columns.h"

struct vg_twins {
  size_t n;                        /* Pairs. */
  const struct vg_periodic *pair;  /* [n] borrowed. */
  struct vg_periodic_match *match; /* [n] points and faces of the surface. */
  uint32_t (*patch)[2];            /* [n] indices in surface->patch of the patch
                                      and of its image. */
  uint32_t **column; /* [n][n_column] twin in the image of each column that
                        slides in the patch; the column itself on the axis of a
                        rotation; VG_NO_INDEX for other columns. */
};
#define VG_TWINS_INIT                                                          \
  {                                                                            \
    0                                                                          \
  } /* releasing this is a no-op */

/** Matches the points and faces of the pairs of a surface. The pairs must match
 * to rounding (VG_ERR_GEOMETRY). *t is valid without columns until
 * vg_twins_find. VG_ERR_MEMORY. */
vg_status vg_twins_open(const struct vg_mesh *surface, size_t n,
                        const struct vg_periodic *pair, struct vg_twins *t,
                        struct vg_error *err);

/** Sets is_image of the points that are images of others to 1. */
void vg_twins_mark_images(const struct vg_twins *t, size_t n_point,
                          uint8_t *is_image);

/** Finds the twins, and sets c->is_twin of both. Columns of one root have their
 * twins in the same order.
 * @param alone  [n_column] set to 1 for columns without twins at roots of
 *               periodic patches: a point and its partner have different
 *               numbers of columns; otherwise unchanged */
vg_status vg_twins_find(struct vg_twins *t, const struct vg_mesh *surface,
                        struct vg_columns *c, uint8_t *alone,
                        struct vg_error *err);

/** Pair of which patch (an index in surface->patch) is the image, or t->n. */
size_t vg_twins_image(const struct vg_twins *t, uint32_t patch);

void vg_twins_release(struct vg_twins *t);

#endif
