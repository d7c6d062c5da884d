/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Private to core/front: distances from a region in a metric
 * (region_metric.c). Each plane and wall has its own spacing there. */
#ifndef VG_CORE_FRONT_REGION_PARTS_H
#define VG_CORE_FRONT_REGION_PARTS_H

#include "core/front/region.h"

/** Is any part of the triangle within most[i * step] of plane i, and within
 * VG_BEYOND_WALLS times that beyond wall i - n_plane? step: 0 or 1. middle out:
 * mean of the corners of that part. */
int vg_region_reaches(const struct vg_region *r, const double *const corner[3],
                      const double *most, int step, double middle[3]);

/** Length of the longest edge of a triangle. */
double vg_region_longest(const double *const corner[3]);

/** vg_region_spacing and vg_region_spacing_within in a metric. */
double vg_region_widest(const struct vg_region *r,
                        const struct vg_sizing *sizing, const double x[3]);
void vg_region_widest_within(const struct vg_region *r,
                             const struct vg_sizing *sizing, const double lo[3],
                             const double hi[3], double *least, double *most);

/** Is x within `reach` spacings of all planes, and of the inner side of all
 * walls? */
int vg_region_near_in_metric(const struct vg_region *r,
                             const struct vg_sizing *sizing, const double x[3],
                             double reach);

/** The same for any point of a triangle. Without is_sure, additional triangles
 * may be reported. */
int vg_region_meets_in_metric(const struct vg_region *r,
                              const struct vg_sizing *sizing,
                              const double *const corner[3], double reach,
                              int is_sure);
int vg_region_cache_meets_in_metric(const struct vg_region_cache *cache,
                                    const uint32_t v[3], double reach,
                                    int is_sure);

/** Is a corner of a cell within r->reach spacings of all planes? */
int vg_region_has_corner_in_metric(const struct vg_region *r,
                                   const struct vg_sizing *sizing,
                                   const double *const corner[4]);

#endif
