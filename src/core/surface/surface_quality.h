/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/surface/surface_quality.h: quality of the triangles of a surface. A cell
 * cannot be better than the boundary face that it contains. */
#ifndef VG_CORE_SURFACE_SURFACE_QUALITY_H
#define VG_CORE_SURFACE_SURFACE_QUALITY_H

#include <stddef.h>

#include "core/mesh/mesh.h"

#define VG_WORST_FACES 10

struct vg_worst_face {
  size_t face;
  double angle, at[3]; /* Smallest angle in degrees; centroid. */
  int is_cap;          /* 1: three nodes nearly on a line (cap); 0: two nodes
                          nearly coincide (needle). */
};

struct vg_surface_quality {
  size_t n;                       /* Triangles with a positive area. */
  double angle_min, angle_min_p1; /* Smallest angles in degrees: the least, and
                                     the 1st percentile to 0.1. */
  double below[4];                /* Percentage of triangles with an angle below
                                     5, 10, 20 and 30 degrees. */
  double edge_mean;               /* Mean edge length over the edges of all
                                     triangles. */
  double ratio_mean;              /* Mean radius ratio 2 r / R; 1 for an
                                     equilateral triangle. */
  size_t n_cap, n_needle;         /* Number of slivers (VG_SWAP_SLIVER). */
  size_t n_worst;
  struct vg_worst_face worst[VG_WORST_FACES]; /* The worst slivers, by ascending
                                                 angle. */
};

/** Measure the triangles of m; quadrilaterals are ignored. Angles are for
 * reports only. O(n), no memory; re-entrant. */
void vg_surface_quality(const struct vg_mesh *m, struct vg_surface_quality *q);

/** Smallest angle in degrees and radius ratio 2 r / R of each triangle.
 *
 * @param angle, ratio  out: [n_tri] each; may be NULL */
void vg_surface_shapes(const struct vg_mesh *m, double *angle, double *ratio);

#endif
