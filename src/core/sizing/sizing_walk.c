/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Searches in the hierarchy of samples, with four lanes. If the processor has
 * AVX2, eight lanes take an eighth less time for the whole field. */
#include "base/wide.h"

#define WIDTH 4
#define TARGET
#define ABOVE vg_bvh_above_narrow
#define BELOW vg_bvh_below_narrow
#include "core/sizing/sizing_walk_lanes.h"

double vg_bvh_above(const struct vg_bvh *t, const double lo[3],
                    const double hi[3], double below,
                    struct vg_bvh_reach *reach, uint32_t *hint)
{
#ifdef VG_WIDE
  if (VG_IS_WIDE) return vg_bvh_above_wide(t, lo, hi, below, reach, hint);
#endif
  return vg_bvh_above_narrow(t, lo, hi, below, reach, hint);
}

double vg_bvh_below(const struct vg_bvh *t, const double x[3], double above,
                    double enough, struct vg_bvh_reach *reach, double *by)
{
#ifdef VG_WIDE
  if (VG_IS_WIDE) return vg_bvh_below_wide(t, x, above, enough, reach, by);
#endif
  return vg_bvh_below_narrow(t, x, above, enough, reach, by);
}

double vg_bvh_knee(const struct vg_bvh *t, double by)
{
  return by * (1 + (double)t->offset - VG_BVH_KNEE * (double)t->slope);
}

double vg_bvh_falls(const struct vg_bvh *t, double by, double v, double far)
{
  double slope = (double)t->slope, more = (double)t->steep - slope;
  double over = v - vg_bvh_knee(t, by);

  if (over > 0) far -= over / slope;
  return by > 0 && far > 0 ? more * far : 0;
}
