/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/sizing/sizing.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/checks.h"
#include "base/memory.h"
#include "base/team.h"
#include "core/geometry/tensor.h"
#include "core/geometry/vector.h"
#include "core/sizing/sizing_octree.h"
#include "core/sizing/sizing_surface.h"

/* Number of leaves in addition to those that the surface accounts for, since
 * sources may need some. */
#define LEAF_BASE (1u << 20)
#define LEAF_PER_SAMPLE 8

static vg_status check_options(const struct vg_sizing_options *o,
                               struct vg_error *err)
{
  if (!isfinite(o->growth) || o->growth <= 1)
    return vg_fail(err, VG_ERR_INPUT,
                   "growth rate %g of the spacing is not above 1; 1.2 is usual",
                   o->growth);
  if (!isfinite(o->scale) || o->scale <= 0)
    return vg_fail(err, VG_ERR_INPUT,
                   "scale %g of source spacings is not positive; 1 leaves "
                   "them as they are",
                   o->scale);
  if (!(isfinite(o->coarseness) && o->coarseness >= 1))
    return vg_fail(err, VG_ERR_INPUT,
                   "coarseness %g of the sizing field is "
                   "below 1; give 1 or more",
                   o->coarseness);
  if (!(o->aspect_max == 0 || o->aspect_max >= 1))
    return vg_fail(err, VG_ERR_INPUT,
                   "largest aspect %g of the sizes is below 1; 100 is usual",
                   o->aspect_max);
  if (!isfinite(o->h_min) || o->h_min < 0)
    return vg_fail(err, VG_ERR_INPUT,
                   "smallest size %g is negative or not finite; 0 means no "
                   "limit",
                   o->h_min);
  if (!(o->h_max >= 0))
    return vg_fail(err, VG_ERR_INPUT,
                   "largest size %g is negative or not a number; 0 means the "
                   "largest one in the input",
                   o->h_max);
  if (o->h_max > 0 && o->h_min > o->h_max)
    return vg_fail(err, VG_ERR_INPUT,
                   "smallest size %g is above the largest size %g; exchange "
                   "them",
                   o->h_min, o->h_max);
  return VG_OK;
}

/* Largest spacing in the input. With a surface, it is the upper limit unless
 * one is given: cells larger than any face of the boundary are useless, and a
 * uniform boundary should give a uniform mesh. VGRID's mean never exceeds it.
 */
static double largest(const struct vg_source_set *set,
                      const struct vg_samples *s)
{
  double h = 0;

  for (size_t i = 0; i < s->n; i++)
    if (s->h[i] > h) h = s->h[i];
  for (size_t i = 0; i < set->n_bounded; i++) {
    if (set->bounded[i].law.h0 > h) h = set->bounded[i].law.h0;
    if (set->bounded[i].law.h1 > h) h = set->bounded[i].law.h1;
  }
  for (size_t i = 0; i < set->n_stretched; i++) {
    const struct vg_stretched *t = set->stretched + i;

    h = fmax(h, t->law.h0 * fmax(1, t->ratio[0]));
    h = fmax(h, t->law.h1 * fmax(1, t->ratio[1]));
  }
  if (set->map && set->map->most > h) h = set->map->most;
  if (set->metric && set->metric->most > h) h = set->metric->most;
  return h;
}

/* Cube around the surface, or around the sources if there is no surface. It is
 * slightly larger, so that rounding moves no point of the domain outside. */
static double root_cube(const struct vg_mesh *surface,
                        const struct vg_source_set *set, double h, double lo[3])
{
  double hi[3] = { 0, 0, 0 }, side = 0, far = 0;
  int on_surface = surface && surface->n_point;

  if (on_surface) vg_mesh_bounds(surface, lo, hi);
  else vg_source_bounds(set, lo, hi);
  for (int k = 0; k < 3; k++) {
    if (hi[k] - lo[k] > side) side = hi[k] - lo[k];
    if (fabs(lo[k]) > far) far = fabs(lo[k]);
    if (fabs(hi[k]) > far) far = fabs(hi[k]);
  }
  side = on_surface && side > 0 ? 1.001 * side : 3 * side + 20 * h;
  if (side < 1e-6 * far) side = 1e-6 * far;
  for (int k = 0; k < 3; k++) lo[k] = 0.5 * (lo[k] + hi[k]) - 0.5 * side;
  return side;
}

static void find_range(struct vg_sizing *s, int threads)
{
  const struct vg_octree *t = &s->octree;
  const float *h = t->leaf[0].h;
  float least = h[0], most = h[0];
  double range[2], slope;

  if (t->is_stretched) {
    vg_octree_tensor_range(t, threads, range, &slope);
    s->least = range[0];
    s->most = range[1];
    s->slope = fmax(s->slope, slope);
    return;
  }
  for (size_t i = 0; i < t->n_leaf; i++)
    for (int k = 0; k < 8; k++) {
      least = fminf(least, t->leaf[i].h[k]);
      most = fmaxf(most, t->leaf[i].h[k]);
    }
  s->least = (double)least;
  s->most = (double)most;
}

/* Limits of the sizes. A field of size tensors needs a largest size: without
 * one, it is the side of the root cube. */
static void set_limits(const struct vg_sizing_options *o, double cap,
                       int has_surface, double side, struct vg_stat *f,
                       struct vg_sizing *s)
{
  f->slope = o->growth - 1;
  f->h_min = o->h_min;
  f->h_max = o->h_max > 0 ? o->h_max : has_surface ? cap : INFINITY;
  f->aspect_max = o->aspect_max > 0 ? o->aspect_max : VG_ASPECT_MAX;
  f->is_stretched = vg_source_any_stretched(&f->set);
  if (f->is_stretched && f->h_max == INFINITY) f->h_max = side;
  if (f->h_max < f->h_min) f->h_max = f->h_min;
  s->growth = f->slope;
  s->cap = o->h_max > 0 ? o->h_max : f->set.n_mean ? cap : INFINITY;
}

/* Part of vg_sizing_new, called after the input was checked. Owns no memory. */
static vg_status build(const struct vg_sizing_options *o,
                       const struct vg_mesh *surface, struct vg_stat *f,
                       const struct vg_samples *samples, struct vg_sizing *s,
                       struct vg_error *err)
{
  size_t n = samples->n_sized, limit = LEAF_BASE;
  double lo[3] = { 0, 0, 0 }, cap = largest(&f->set, samples), side;

  if (!(cap > 0) && !(o->h_max > 0 && isfinite(o->h_max)) &&
      !(f->set.metric && surface && surface->n_point))
    return vg_fail(err, VG_ERR_INPUT,
                   "nothing defines a size: no source, no edge of the surface "
                   "(surface_sizes) and no largest size; give one of them");
  side = root_cube(surface, &f->set,
                   cap > 0              ? cap
                   : isfinite(o->h_max) ? o->h_max
                                        : 0,
                   lo);
  if (!isfinite(side) || !isfinite(lo[0] + lo[1] + lo[2]))
    return vg_fail(err, VG_ERR_INPUT,
                   "coordinates are too large for the sizing field (extent "
                   "%g); use another unit of length",
                   side);
  set_limits(o, cap, n > 0, side, f, s);
  if (n < (VG_OCTREE_LEAF - LEAF_BASE) / LEAF_PER_SAMPLE)
    limit += n * LEAF_PER_SAMPLE;
  return vg_octree_build(f, lo, side, o, limit, &s->octree, err);
}

/* Build the hierarchy for the growth of surface samples, from above or from
 * below. */
static vg_status make_near(const struct vg_sizing_options *o,
                           const struct vg_mesh *surface,
                           const struct vg_samples *all, int below,
                           struct vg_bvh **out, struct vg_error *err)
{
  struct vg_samples s = VG_SAMPLES_INIT;
  vg_status st;

  VG_TRY(
    vg_samples_thin(surface, all, o->growth - 1, below, o->threads, &s, err));
  st = vg_bvh_new(s.n, (const double(*)[3])s.p, s.h, o->growth - 1, o->threads,
                  out, err);
done:
  vg_samples_release(&s);
  return st;
}

static vg_status check_map(const struct vg_map_fault *f, int is_metric,
                           struct vg_error *err)
{
  const double *v = f->value;

  if (!f->n) return VG_OK;
  if (is_metric)
    return vg_fail(err, VG_ERR_INPUT,
                   "the metric given for the point (%.9g, %.9g, %.9g) is not "
                   "positive: xx %g, xy %g, xz %g, yy %g, yz %g, zz %g; its "
                   "eigenvalues are 1 / size^2 and must be above 0 and finite",
                   f->x[0], f->x[1], f->x[2], v[0], v[1], v[2], v[3], v[4],
                   v[5]);
  return vg_fail(err, VG_ERR_INPUT,
                 "the edge length given for the point "
                 "(%.9g, %.9g, %.9g) is %g; it must be above 0",
                 f->x[0], f->x[1], f->x[2], v[0]);
}

/* Apply the scale to all options except those of the sources, whose laws apply
 * it themselves. */
static struct vg_sizing_options scaled(const struct vg_sizing_options *options)
{
  struct vg_sizing_options o = *options;

  o.h_min *= o.scale;
  o.h_max *= o.scale;
  o.growth = vg_scaled_growth(o.growth, o.scale);
  return o;
}

vg_status vg_sizing_new(const struct vg_sizing_options *given, size_t n,
                        const struct vg_source *source,
                        const struct vg_mesh *surface, struct vg_sizing **out,
                        struct vg_error *err)
{
  assert(given && out && (source || !n));

  const struct vg_sizing_options o = scaled(given), *options = &o;
  vg_status st = VG_OK;
  atomic_int is_steep = 0;
  int steep;
  struct vg_map_fault fault = { ATOMIC_FLAG_INIT, 0, { 0, 0, 0 }, { 0 } };
  struct vg_stat f = { .set = VG_SOURCE_SET_INIT, .is_steep = &is_steep };
  struct vg_samples samples = VG_SAMPLES_INIT;
  struct vg_bvh *near = NULL, *under = NULL;
  struct vg_sizing *s = NULL;

  VG_TRY(check_options(given, err));
  VG_TRY(vg_source_check(n, source, err));
  if (surface) VG_TRY(vg_samples_check(surface, err));
  s = vg_calloc(1, sizeof *s);
  if (!s) {
    st = vg_fail_memory(err, "the sizing field");
    goto done;
  }
  VG_TRY(vg_source_prepare(options, n, source, 1, &f.set, err));
  if (options->map && options->map->metric) f.set.metric = options->map;
  else f.set.map = options->map;
  f.set.fault = &fault;
  if (surface && options->from_surface)
    VG_TRY(vg_samples_make(surface, options->threads, &samples, err));
  if (samples.n_sized)
    VG_TRY(make_near(options, surface, &samples, 0, &near, err));
  if (samples.n_sized && (n || options->map))
    VG_TRY(make_near(options, surface, &samples, 1, &under, err));
  f.near = near;
  f.under = under;
  VG_TRY(build(options, surface, &f, &samples, s, err));
  steep = is_steep;
  VG_TRY(vg_team_any(options->team, &steep, err));
  VG_TRY(check_map(&fault, f.set.metric != NULL, err));
  s->slope = steep ? vg_bvh_steep(s->growth) : s->growth;
  find_range(s, options->threads);
  s->reach = 1;
  if (s->octree.is_stretched)
    s->reach = vg_cube_root(o.aspect_max > 0 ? o.aspect_max * o.aspect_max
                                             : VG_ASPECT_MAX * VG_ASPECT_MAX);
  VG_CHECK("the sizing field", vg_octree_defects(&s->octree));
  *out = s;
  s = NULL;
done:
  vg_source_release(&f.set);
  vg_samples_release(&samples);
  vg_bvh_free(near);
  vg_bvh_free(under);
  vg_sizing_free(s);
  return st;
}

void vg_sizing_free(struct vg_sizing *s)
{
  if (!s) return;
  if (s->common.data) vg_shmem_release(&s->common);
  else vg_octree_release(&s->octree);
  free(s);
}

int vg_sizing_is_stretched(const struct vg_sizing *s)
{
  return s->octree.is_stretched;
}

/* Outside of the root cube, the tensor at its nearest point grows with the
 * distance, up to the largest size. */
static void grow_outside(const struct vg_sizing *s, const double x[3],
                         double h[6])
{
  struct vg_size_limits l = { 0, s->cap, INFINITY };
  double way[3], range[2];

  for (int k = 0; k < 3; k++)
    way[k] = x[k] - fmin(fmax(x[k], s->octree.lo[k]),
                         s->octree.lo[k] + s->octree.side);
  vg_size_grow(h, way, s->growth, h);
  vg_size_limit(h, &l, range);
}

static void tensor_at(const struct vg_sizing *s, const double x[3], double h[6])
{
  double outside;

  vg_octree_tensor_at(&s->octree, x, h, &outside);
  if (outside > 0) grow_outside(s, x, h);
}

double vg_sizing_stretch_at(const struct vg_sizing *s, const double x[3],
                            double t[6])
{
  double h;

  if (!s->octree.is_stretched) {
    h = vg_sizing_at(s, x);
    vg_tensor_uniform(1 / h, t);
    return h;
  }
  tensor_at(s, x, t);
  return vg_cube_root(vg_tensor_invert(t, t));
}

double vg_sizing_along(const struct vg_sizing *s, const double x[3],
                       const double n[3])
{
  double t[6], v[3];

  if (!s->octree.is_stretched) return vg_sizing_at(s, x);
  vg_sizing_stretch_at(s, x, t);
  vg_tensor_apply(t, n, v);
  return 1 / vg_norm(v);
}

void vg_sizing_tensor_at(const struct vg_sizing *s, const double x[3],
                         double h[6])
{
  if (s->octree.is_stretched) tensor_at(s, x, h);
  else vg_tensor_uniform(vg_sizing_at(s, x), h);
}

double vg_sizing_across(const struct vg_sizing *s, const double x[3],
                        const double n[3])
{
  double h[6], v[3];

  if (!s->octree.is_stretched) return vg_sizing_at(s, x);
  tensor_at(s, x, h);
  vg_tensor_apply(h, n, v);
  return vg_norm(v);
}

/* The size h at the nearest point of the root cube grows with the distance. */
static double grown(const struct vg_sizing *s, double h, double outside)
{
  if (!(outside > 0)) return h;
  h += s->growth * outside;
  return h < s->cap ? h : s->cap;
}

double vg_sizing_at(const struct vg_sizing *s, const double x[3])
{
  assert(s);

  double outside, h, tensor[6];

  if (s->octree.is_stretched) {
    tensor_at(s, x, tensor);
    return vg_size_mean(tensor);
  }
  h = vg_octree_at(&s->octree, x, &outside);
  return grown(s, h, outside);
}

void vg_sizing_gradient_at(const struct vg_sizing *s, const double x[3],
                           double g[3])
{
  assert(s);
  vg_octree_gradient_at(&s->octree, x, g);
}

#define SOME 256 /* points that are evaluated together */

void vg_sizing_eval(const struct vg_sizing *s, size_t n, const double (*x)[3],
                    double *h)
{
  double outside[SOME];

  if (s->octree.is_stretched) {
    for (size_t i = 0; i < n; i++) h[i] = vg_sizing_at(s, x[i]);
    return;
  }
  for (size_t i = 0, m; i < n; i += m) {
    m = n - i < SOME ? n - i : SOME;
    vg_octree_eval(&s->octree, m, x + i, h + i, outside);
    for (size_t k = 0; k < m; k++) h[i + k] = grown(s, h[i + k], outside[k]);
  }
}

double vg_sizing_least(const struct vg_sizing *s, const double lo[3],
                       double side, double x[3])
{
  assert(side >= 0);

  const struct vg_octree *t = &s->octree;
  double h = vg_octree_least(t, lo, side, x), gap2 = 0;
  double growth = s->growth;

  if (t->is_stretched) growth *= 1 - VG_GROWTH_IN_METRIC;

  for (int k = 0; k < 3; k++) {
    double gap = fmax(t->lo[k] - lo[k] - side, lo[k] - t->lo[k] - t->side);

    if (gap > 0) gap2 += gap * gap;
  }
  if (!(gap2 > 0)) return h;
  h += growth * sqrt(gap2);
  return h < s->cap ? h : s->cap;
}

double vg_sizing_bound(const struct vg_sizing *s, const double lo[3],
                       double side)
{
  return vg_octree_bound(&s->octree, lo, side);
}

void vg_sizing_range(const struct vg_sizing *s, double *h_min, double *h_max)
{
  assert(h_min && h_max);
  *h_min = s->least;
  *h_max = s->most;
}

double vg_sizing_slope(const struct vg_sizing *s)
{
  return s->slope;
}

/* With an aspect a, the mean of three sizes is at least a^(1/3) times the
 * smallest one, and at least a^(-2/3) times the largest one. */
void vg_sizing_range_along(const struct vg_sizing *s, double *h_min,
                           double *h_max)
{
  assert(h_min && h_max);
  *h_min = s->least / s->reach;
  *h_max = s->most * s->reach;
}

double vg_sizing_slope_along(const struct vg_sizing *s)
{
  return s->octree.is_stretched ? INFINITY : s->slope;
}

/* Outside of the root cube, sizes are not below those at its nearest point. */
void vg_sizing_bounds_across(const struct vg_sizing *s, const double lo[3],
                             const double hi[3], int n,
                             const double (*normal)[3], double *least,
                             double *most)
{
  const struct vg_octree *t = &s->octree;
  int outside = 0;

  assert(t->is_stretched && n >= 0 && normal && least && most);
  vg_octree_range_across(t, lo, hi, n, normal, least, most);
  for (int k = 0; k < 3; k++)
    outside |= lo[k] < t->lo[k] || hi[k] > t->lo[k] + t->side;
  for (int i = 0; outside && i < n; i++) most[i] = fmax(most[i], s->cap);
}

double vg_sizing_growth(const struct vg_sizing *s)
{
  return s->growth;
}

double vg_sizing_below(double growth, double h, double d)
{
  assert(growth > 0 && h >= 0 && d >= 0);

  double slope = growth - 1;
  double even = h * (1 + vg_bvh_offset(slope)) - slope * d;
  double steep = h * vg_bvh_rise(slope) - vg_bvh_steep(slope) * d;
  double v = fmin(h, fmin(even, steep));

  return v > 0 ? v : 0;
}

double vg_sizing_below_edge(double growth, double h, double d)
{
  double slope = growth - 1;
  double even = (h + slope * d) / (1 + vg_bvh_offset(slope));
  double steep = (h + vg_bvh_steep(slope) * d) / vg_bvh_rise(slope);

  return fmax(h, fmax(even, steep));
}

size_t vg_sizing_leaves(const struct vg_sizing *s)
{
  return s->octree.n_leaf;
}

double vg_sizing_sources_at(const struct vg_sizing_options *options, size_t n,
                            const struct vg_source *source, const double x[3])
{
  const struct vg_sizing_options o = scaled(options);
  struct vg_source_set set = VG_SOURCE_SET_INIT;
  struct vg_size_axes a;
  double h;

  if (!n || vg_source_prepare(&o, n, source, 0, &set, NULL) < 0)
    return INFINITY;
  h = vg_source_at(&set, x);
  if (vg_source_any_stretched(&set)) {
    vg_source_axes_at(&set, x, h, &a);
    h = vg_cube_root(a.size[0] * a.size[1] * a.size[2]);
  }
  vg_source_release(&set);
  if (o.h_max > 0 && h > o.h_max) h = o.h_max;
  return h > o.h_min ? h : o.h_min;
}
