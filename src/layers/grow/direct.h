/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* layers/grow/direct.h: data shared by the files about directions. Private to
 * direct.c (first directions), bend.c (bending) and lift.c (lengths, first
 * points, evening out of columns). */
#ifndef VG_LAYERS_GROW_DIRECT_H
#define VG_LAYERS_GROW_DIRECT_H

#include "layers/grow/grow_parts.h"

#define VG_GRAIN 2048
/* L6: share of the initial visibility that is kept when a column is turned. */
#define VG_VISIBILITY_KEPT 0.6
#define VG_CAP_NOISY 4 /* Bit of vg_layer_work.cap. */

/** Directions before and after a sweep over all columns. */
struct vg_dir_sweep {
  struct vg_layer_work *w;
  double (*scratch)[3]; /* [worker][max_valence] face normals. */
  double (*from)[3], (*to)[3];
  const uint32_t *list;   /* Columns to process; NULL: all. */
  uint8_t *moves, *moved; /* [n_column] 1: moves in this sweep, moved in the
                             last one. */
};

/** Allocates only the scratch; allocates from and to, initialised with the
 * current directions (freed by the caller with vg_dir_sweep_free, also on
 * failure); exchanges from and to. */
vg_status vg_dir_sweep_scratch(struct vg_layer_work *w, struct vg_dir_sweep *t,
                               struct vg_error *err);
vg_status vg_dir_sweep_new(const struct vg_layer_work *w,
                           struct vg_dir_sweep *t, struct vg_error *err);
void vg_dir_sweep_swap(struct vg_dir_sweep *t);
void vg_dir_sweep_free(struct vg_dir_sweep *t);

/** Normals of the slide patches at column i; returns their number. */
int vg_slide_normals(const struct vg_layer_work *w, size_t i, double n[2][3]);

/** Projects v into the slide plane, or onto the intersection of two. For planes
 * normal to an axis, zero components stay exactly zero. */
void vg_constrain(int n_slide, double n[2][3], double v[3]);

/** Normals of the faces of column i that are meaningful, which excludes virtual
 * faces, and noisy caps if there are others. Returns their number. */
int vg_face_normals(const struct vg_layer_work *w, size_t i, double (*n)[3]);

double vg_least_visibility(int k, const double (*n)[3], const double v[3]);

#endif
