/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/remesh/sizes.h: sizes from the shape of a surface. Private to
 * core/remesh. */
#ifndef VG_CORE_REMESH_SIZES_H
#define VG_CORE_REMESH_SIZES_H

#include "core/remesh/curves.h"
#include "core/sizing/sizing.h"

#define VG_SIZES_CHORD 0.6 /* of the tolerance: sagitta of an arc */

struct vg_sizes_options {
  double per_turn;     /* Edges around a full circle. */
  double chord;        /* Largest sagitta of an edge over its arc. */
  double strip;        /* Size at a strip divided by its width. */
  double h_min, h_max; /* Finite bounds; h_min is 0 if it underflows. */
  double h_shape;      /* Least size from curvature and strips. */
  double growth;
  const double *cap;         /* [n_tri] Largest size on each triangle; may be
                                NULL. INFINITY: on an outer boundary, where the
                                sagitta is not limited. */
  const double *point_cap;   /* [n_point] Largest size at each point; may be
                                NULL. */
  const double *across;      /* [n_patch] Edges across strips; NULL: 1. */
  const uint32_t *tri_patch; /* [n_tri] Patch of each triangle, for `across`. */
  struct vg_stop stop;
};

/** Fill r->size (and the tree) from the curvature of faces and feature curves,
 * and from the width of strips between two curves. O(n). VG_ERR_MEMORY,
 * VG_ERR_STOPPED. */
vg_status vg_sizes_make(struct vg_ref *r, const struct vg_curves *c,
                        const struct vg_sizes_options *o, struct vg_error *err);

/** Number of levels with enlarged sizes with which remeshing in the metric of a
 * field begins. The triangles of a coarse input are needles in a stretched
 * metric whose directions differ between their corners. They are therefore
 * first remeshed with larger sizes of the field, which are halved from level to
 * level. 0 without a field, or if the surface has about the number of triangles
 * that the field requests. O(n) */
int vg_sizes_levels(const struct vg_ref *r, const struct vg_sizing *field,
                    double h_max);

#endif
