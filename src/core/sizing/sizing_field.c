/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The exact field: sources, and growth of the spacing from the surface. */
#include <math.h>
#include <string.h>

#include "core/geometry/tensor.h"
#include "core/sizing/sizing_octree.h"

/* H6: sources count as finer than the surface if they are below this share of
 * the spacing that it allows. */
#define FINER 0.65

/* Searches have single precision. */
#define WIDER (1 + 1e-6)

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
  most = vg_bvh_above(f->near, x, x, f->h_max, reach, hint);
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
  most = vg_bvh_above(f->near, lo, hi, f->h_max, reach, hint);
  if (reach) reach->above = (float)most;
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
    vg_lesser(vg_greater(f->h_min, 1e-30 * f->h_max), f->h_max), f->h_max,
    f->aspect_max
  };
}

void vg_stat_tensor_source(const struct vg_stat *f, const double x[3],
                           struct vg_size_axes *a, double *iso)
{
  *iso = vg_lesser(vg_source_at(&f->set, x), f->h_max);
  vg_source_axes_at(&f->set, x, *iso, a);
  vg_stat_tensor_limit(f, a);
}

void vg_stat_tensor_limit(const struct vg_stat *f, struct vg_size_axes *a)
{
  const struct vg_size_limits l = limits_of(f);
  double range[2];

  vg_size_axes_limit(a, &l, range);
}

/* The bounds of the surface apply to each eigenvalue as vg_stat_combine applies
 * them to an isotropic size. Unless the bound from above is asked for, only
 * values below the largest size are searched for: a larger one matters only
 * where the bound from below exceeds that size. */
static void bound(const struct vg_stat *f, const double x[3],
                  struct vg_size_axes *a, struct vg_bvh_reach *reach,
                  uint32_t *hint, double *above)
{
  const double least = vg_size_axes_least(a);
  const double wide = (double)(float)(vg_size_axes_most(a) * WIDER);
  struct vg_size_limits l = limits_of(f);
  double most = above ? f->h_max : vg_lesser(wide, f->h_max), below, by;
  double range[2], fine = 0;

  if (above || !reach || !(wide < (double)reach->above))
    most = vg_bvh_above(f->near, x, x, most, reach, hint);
  if (least < most && f->under) {
    below = vg_bvh_below(f->under, x, least, most, reach, &by);
    if (most == wide && below >= most) {
      most = vg_bvh_above(f->near, x, x, f->h_max, reach, hint);
      below = vg_bvh_below(f->under, x, least, most, reach, &by);
    }
    if (below < most && below < vg_bvh_knee(f->under, by))
      atomic_store_explicit(f->is_steep, 1, memory_order_relaxed);
    if (by > 0) fine = below;
  }
  l.aspect = INFINITY;
  l.most = vg_lesser(vg_greater(most, l.least), l.most);
  l.least = vg_greater(l.least, vg_lesser(fine, l.most));
  if (least < l.least || vg_size_axes_most(a) > l.most)
    vg_size_axes_limit(a, &l, range);
  if (above) *above = most;
}

void vg_stat_tensor_combine(const struct vg_stat *f, const double x[3],
                            struct vg_size_axes *a, struct vg_bvh_reach *reach,
                            uint32_t *hint, struct vg_size *out, double *above)
{
  double h[6];

  if (above) *above = INFINITY;
  if (f->near) bound(f, x, a, reach, hint, above);
  vg_size_axes_tensor(a, h);
  for (int k = 0; k < 6; k++) out->h[k] = (float)h[k];
  out->least = (float)vg_size_axes_least(a);
  out->most = (float)vg_size_axes_most(a);
}

void vg_stat_tensor_at(const struct vg_stat *f, const double x[3],
                       struct vg_bvh_reach *reach, uint32_t *hint,
                       struct vg_size *out, float *iso)
{
  struct vg_size_axes a;
  double least, above;

  vg_stat_tensor_source(f, x, &a, &least);
  vg_stat_tensor_combine(f, x, &a, reach, hint, out, iso ? &above : NULL);
  if (iso) *iso = (float)vg_lesser(least, above);
}
