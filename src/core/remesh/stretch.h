/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/remesh/stretch.h: feature curves along which edges are longer than
 * across them (stretched), and the resulting metric around them. Private to
 * core/remesh.
 *
 * On a curve the target length along it is a multiple of the size, limited such
 * that the sagitta stays within the tolerance. Away from the curve this length
 * decreases by growth - 1 per unit length, while sizes grow, until both are
 * equal. The nearest place of a curve determines the ratio. If several curves
 * request different directions, they reduce each other's ratio, so that at a
 * corner of two curves edges have the same length along both. */
#ifndef VG_CORE_REMESH_STRETCH_H
#define VG_CORE_REMESH_STRETCH_H

#include "core/remesh/work.h"
#include "core/search/box_tree.h"

struct vg_stretch_place {
  double x[3], way[3]; /* A place on a curve, and the direction of the curve
                          there. */
  double at, along;    /* Arc length; target length along the curve. */
};

struct vg_stretch_run {    /* Part of a curve between consecutive places. */
  size_t first, n;         /* Range of its places; n is at least 2. */
  struct vg_box_tree tree; /* Segments between its places, in order. */
  double by, most;         /* Stretching ratio; largest `along`. */
};

struct vg_stretch {
  const double *by; /* [3 n_tri] Stretching ratios of the half-edges of the
                       reference, equal on both sides of an edge; 1 or less: not
                       stretched. Borrowed. */
  double slope, h_max;
  size_t n_run, cap_run, n_place, cap_place;
  struct vg_stretch_run *run;
  struct vg_stretch_place *place;
};

/** Build the runs from s->by, for the feature curves and sizes of w. O(n).
 * VG_ERR_INPUT, VG_ERR_MEMORY. */
vg_status vg_stretch_make(struct vg_stretch *s, const struct vg_tris *w,
                          struct vg_error *err);

void vg_stretch_release(struct vg_stretch *s);

/** The form at x, for vg_tris.form; `stretch` is a struct vg_stretch. O(log n)
 * for each run near x. */
void vg_stretch_form(const void *stretch, const double x[3], double size,
                     double form[6]);

#endif
