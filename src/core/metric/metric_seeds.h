/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/metric/metric_seeds.h: sparse points throughout a void, in a metric. */
#ifndef VG_CORE_METRIC_METRIC_SEEDS_H
#define VG_CORE_METRIC_METRIC_SEEDS_H

#include <stddef.h>

#include "base/status.h"
#include "core/front/region.h"
#include "core/sizing/sizing.h"

/* Least distance of seeds from the points that bound the void, and of seeds
 * from each other when they are inserted, in the metric. */
#define VG_SEED_DISTANCE 1 /* K54 */

struct vg_metric_seeds {
  size_t n, cap;
  double (*x)[3]; /* [n] Owned by the caller: free. */
};

/** Seeds within the bounding box of the points x: about one for 16 points of
 * the mesh (K49), even where the metric is stretched. They keep the distance
 * VG_SEED_DISTANCE from the points x, but not from each other. Cells between
 * seeds are so small that the metric changes little over them, while cells
 * between the points of a boundary alone extend across regions of different
 * metrics, whose connections later insertions do not repair.
 *
 * @param x       [n] the points that bound the void
 * @param region  NULL, or the region along which points are placed: the seeds
 *                lie within its band VG_BAND_PLACE
 * @param out     starts empty; some seeds may lie outside the void
 *
 * VG_ERR_MEMORY. Deterministic. */
vg_status vg_metric_seeds(size_t n, const double (*x)[3],
                          const struct vg_sizing *sizing,
                          const struct vg_region *region,
                          struct vg_metric_seeds *out, struct vg_error *err);

#endif
