/* core/surface/surface_quality.h: how good the triangles of a surface are. No
 * cell is better than a face of the surface that it stands on. */
#ifndef VG_CORE_SURFACE_SURFACE_QUALITY_H
#define VG_CORE_SURFACE_SURFACE_QUALITY_H

#include <stddef.h>

#include "core/mesh/mesh.h"

#define VG_WORST_FACES 10

struct vg_worst_face {
  size_t face;
  double angle, at[3]; /* smallest angle, degrees; middle */
  int is_cap;          /* three nodes nearly on a line; else two nearly at
                          one place */
};

struct vg_surface_quality {
  size_t n;                       /* triangles that can be measured */
  double angle_min, angle_min_p1; /* smallest angles, degrees: least, and what
                              1 % are below, to 0.1 */
  double below[4];                /* % with an angle below 5 10 20 30 degrees */
  double edge_mean;       /* edge length, over the edges of all triangles */
  double ratio_mean;      /* 2 r / R, 1 for an equilateral triangle */
  size_t n_cap, n_needle; /* slivers (VG_SWAP_SLIVER) */
  size_t n_worst;
  struct vg_worst_face worst[VG_WORST_FACES]; /* of the slivers, the smallest
                              angle first */
};

/** Measure the triangles of m; quadrilaterals do not count. Angles are for
 * reports only. O(n), no memory; re-entrant. */
void vg_surface_quality(const struct vg_mesh *m, struct vg_surface_quality *q);

/** Smallest angle, degrees, and 2 r / R of each triangle.
 * @param angle, ratio  out: [n_tri] each, or NULL */
void vg_surface_shapes(const struct vg_mesh *m, double *angle, double *ratio);

#endif
