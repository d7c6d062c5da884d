/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The exact field: sources, and growth of the spacing from the surface. */
#include "core/sizing/sizing_octree.h"

/* H6: sources count as finer than the surface if they are below this share of
 * the spacing that it allows. */
#define FINER 0.65

double vg_stat_clamp(const struct vg_stat *f, double h)
{
  h = h < f->h_max ? h : f->h_max;
  return h > f->h_min ? h : f->h_min;
}

/* Combine the bounds. If the upper bound is below the spacing of the sources,
 * it is the result, and the lower bound, which is the most expensive, is not
 * needed. */
double vg_stat_combine(const struct vg_stat *f, const double x[3],
                       double source, struct vg_bvh_reach *reach,
                       uint32_t *hint)
{
  double h = source < f->h_max ? source : f->h_max, most, by;

  if (!f->near) return vg_stat_clamp(f, h);
  most = vg_bvh_above(f->near, x, x, f->h_max, hint);
  if (most <= h) return vg_stat_clamp(f, most);
  h = vg_bvh_below(f->under, x, h, most, reach, &by);
  if (h < most && h < vg_bvh_knee(f->under, by))
    atomic_store_explicit(f->is_steep, 1, memory_order_relaxed);
  return vg_stat_clamp(f, h < most ? h : most);
}

double vg_stat_at(const struct vg_stat *f, const double x[3],
                  struct vg_bvh_reach *reach, uint32_t *hint)
{
  return vg_stat_combine(f, x, vg_source_at(&f->set, x), reach, hint);
}

double vg_stat_floor(const struct vg_stat *f, const double lo[3], double side,
                     struct vg_bvh_reach *reach, uint32_t *hint,
                     int *by_sources)
{
  const double far = 0.8660254037844387 * side;
  double hi[3], mid[3], h, most, below, by, more, fall = far * f->slope;

  for (int k = 0; k < 3; k++) {
    hi[k] = lo[k] + side;
    mid[k] = lo[k] + 0.5 * side;
  }
  h = vg_source_floor(&f->set, lo, hi);
  if (f->set.n_mean) {
    double mean = vg_source_mean(f->set.n_mean, f->set.mean, mid);

    h = mean < h ? mean : h;
  }
  if (!(h < f->h_max)) h = f->h_max;
  *by_sources = 1;
  if (!f->near) return vg_stat_clamp(f, h);
  most = vg_bvh_above(f->near, lo, hi, f->h_max, hint);
  *by_sources = h < FINER * most;
  if (most <= h) return vg_stat_clamp(f, most);
  below = vg_bvh_below(f->under, mid, h + fall, most + fall, reach, &by);
  more = vg_bvh_falls(f->under, by, below, far);
  below -= fall;
  if (more > 0 && below - more > h) h = below - more;
  else if (!(more > 0)) h = below;
  return vg_stat_clamp(f, h < most ? h : most);
}
