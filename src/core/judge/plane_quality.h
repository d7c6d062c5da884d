/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/judge/plane_quality.h: angles and edges of a mesh in two dimensions, for
 * reports. Uses core/mesh/plane_mesh.h. */
#ifndef VG_CORE_JUDGE_PLANE_QUALITY_H
#define VG_CORE_JUDGE_PLANE_QUALITY_H

#include "core/mesh/plane_mesh.h"

enum { VG_PLANE_LIMITS = 3 };
/* Degrees below which triangles are counted. */
static const double vg_plane_limit[VG_PLANE_LIMITS] = { 10, 20, 30 };

/** Angles in degrees. Of no cells, all figures are 0. */
struct vg_plane_report {
  size_t n_point, n_tri, n_quad;   /* Of the whole mesh. */
  size_t n_layer_tri;              /* Triangles within the layers. */
  size_t n_field;                  /* Triangles outside of the layers, for which
                                      the following figures are. */
  double angle_min, angle_max;     /* Extreme angles. */
  double angle_percentile;         /* First percentile of the smallest angle of
                                      each triangle. */
  double at[2];                    /* Centre of the triangle with angle_min. */
  size_t n_below[VG_PLANE_LIMITS]; /* Triangles with smaller angles. */
  double quad_min, quad_max;       /* Extreme angles of quadrilaterals. */
};

/** O(n log n). VG_ERR_MEMORY. */
vg_status vg_plane_judge(const struct vg_plane_mesh *m,
                         struct vg_plane_report *out, struct vg_error *err);

#endif
