/* layers/grow/direct.h: what the files about directions share. Private to
 * direct.c (first directions), bend.c (bent apart) and lift.c (lengths, first
 * points, columns made alike). */
#ifndef VG_LAYERS_GROW_DIRECT_H
#define VG_LAYERS_GROW_DIRECT_H

#include "layers/grow/grow_parts.h"

#define VG_GRAIN 2048
#define VG_VISIBILITY_KEPT                                                     \
  0.6 /* L6: share of the first visibility that turning leaves */
#define VG_CAP_NOISY 4 /* bit of vg_layer_work.cap */

/** Directions before and after a sweep over all columns. */
struct vg_dir_sweep {
  struct vg_layer_work *w;
  double (*scratch)[3]; /* [worker][max_valence] */
  double (*from)[3], (*to)[3];
  const uint32_t *list;   /* columns to treat, NULL: all */
  uint8_t *moves, *moved; /* [n_column] moves in this sweep, in the last */
};

/** Scratch alone; from and to as dir is now (memory is the caller's to free
 * with vg_dir_sweep_free, also on failure); exchange from and to. */
vg_status vg_dir_sweep_scratch(struct vg_layer_work *w, struct vg_dir_sweep *t,
                               struct vg_error *err);
vg_status vg_dir_sweep_new(const struct vg_layer_work *w,
                           struct vg_dir_sweep *t, struct vg_error *err);
void vg_dir_sweep_swap(struct vg_dir_sweep *t);
void vg_dir_sweep_free(struct vg_dir_sweep *t);

/** Slide normals at column i; their number. */
int vg_slide_normals(const struct vg_layer_work *w, size_t i, double n[2][3]);

/** Into the slide plane, or along the curve of two: zero components stay zero
 * to the last bit for planes normal to an axis. */
void vg_constrain(int n_slide, double n[2][3], double v[3]);

/** Normals of the faces of column i that say where the wall looks: not of
 * virtual ones, nor of noisy caps where there is better. Their number. */
int vg_face_normals(const struct vg_layer_work *w, size_t i, double (*n)[3]);

double vg_least_visibility(int k, const double (*n)[3], const double v[3]);

#endif
