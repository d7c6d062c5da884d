/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The exact field: sources, and growth of the spacing from the surface. */
#include <math.h>
#include <string.h>

#include "core/geometry/tensor.h"
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
  if (f->set.n_mean && !f->set.mean_is_stretched) {
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

static struct vg_size_limits limits_of(const struct vg_stat *f)
{
  return (struct vg_size_limits){
    fmin(fmax(f->h_min, 1e-30 * f->h_max), f->h_max), f->h_max, f->aspect_max
  };
}

void vg_stat_tensor_source(const struct vg_stat *f, const double x[3],
                           double h[6], double range[2], double *iso)
{
  const struct vg_size_limits l = limits_of(f);

  *iso = fmin(vg_source_at(&f->set, x), f->h_max);
  vg_source_metric_at(&f->set, x, *iso, h);
  vg_size_from_metric(h, &l, h, range);
}

void vg_stat_tensor_limit(const struct vg_stat *f, double h[6], double range[2])
{
  const struct vg_size_limits l = limits_of(f);

  vg_size_limit(h, &l, range);
}

/* The bounds of the surface apply to each eigenvalue as vg_stat_combine applies
 * them to an isotropic size. */
static void bound(const struct vg_stat *f, const double x[3], double h[6],
                  double range[2], struct vg_bvh_reach *reach, uint32_t *hint,
                  double *most)
{
  struct vg_size_limits l = limits_of(f);
  double below, by;

  *most = vg_bvh_above(f->near, x, x, f->h_max, hint);
  l.aspect = INFINITY;
  l.most = fmin(fmax(*most, l.least), l.most);
  if (range[0] < *most && f->under) {
    below = vg_bvh_below(f->under, x, range[0], *most, reach, &by);
    if (below < *most && below < vg_bvh_knee(f->under, by))
      atomic_store_explicit(f->is_steep, 1, memory_order_relaxed);
    l.least = fmax(l.least, fmin(below, l.most));
  }
  if (range[0] < l.least || range[1] > l.most) vg_size_limit(h, &l, range);
}

void vg_stat_tensor_combine(const struct vg_stat *f, const double x[3],
                            const double h[6], const double range[2],
                            struct vg_bvh_reach *reach, uint32_t *hint,
                            struct vg_size *out, double *most)
{
  double bounded[6], its[2] = { range[0], range[1] };

  memcpy(bounded, h, sizeof bounded);
  *most = INFINITY;
  if (f->near) bound(f, x, bounded, its, reach, hint, most);
  for (int k = 0; k < 6; k++) out->h[k] = (float)bounded[k];
  out->least = (float)its[0];
  out->most = (float)its[1];
}

void vg_stat_tensor_at(const struct vg_stat *f, const double x[3],
                       struct vg_bvh_reach *reach, uint32_t *hint,
                       struct vg_size *out, float *iso)
{
  double h[6], range[2], least, most;

  vg_stat_tensor_source(f, x, h, range, &least);
  vg_stat_tensor_combine(f, x, h, range, reach, hint, out, &most);
  *iso = (float)fmin(least, most);
}
