/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/front/region.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/front/region_parts.h"

static int is_unit(const double n[3])
{
  /* Allows for rounding of the normalisation, far below any relevant angle. */
  return fabs(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1) < 1e-12;
}

int vg_region_is_sound(const struct vg_region *r)
{
  const double *a = r->plane[0].normal, *b = r->plane[1].normal;

  if (r->n_plane < 0 || r->n_plane > 2) return 0;
  if (r->n_wall < 0 || r->n_wall > VG_REGION_WALLS) return 0;
  if (!(r->reach >= 0) || !(r->wide >= 0)) return 0;
  for (int i = 0; i < r->n_plane; i++)
    if (!is_unit(r->plane[i].normal)) return 0;
  for (int i = 0; i < r->n_wall; i++)
    if (!is_unit(r->wall[i].normal)) return 0;
  return r->n_plane < 2 ||
         fabs(a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) < 1e-12;
}

void vg_region_foot(const struct vg_region *r, const double x[3],
                    double foot[3])
{
  assert(r->n_plane >= 0 && r->n_plane <= 2 && foot);
  memcpy(foot, x, 3 * sizeof *x);
  for (int i = 0; i < r->n_plane; i++) {
    double s = vg_plane_side(&r->plane[i], foot);

    for (int k = 0; k < 3; k++) foot[k] -= s * r->plane[i].normal[k];
  }
}

double vg_region_spacing(const struct vg_region *r,
                         const struct vg_sizing *sizing, const double x[3])
{
  double foot[3];

  if (vg_sizing_is_stretched(sizing)) return vg_region_widest(r, sizing, x);
  vg_region_foot(r, x, foot);
  return vg_sizing_at(sizing, foot);
}

void vg_region_spacing_within(const struct vg_region *r,
                              const struct vg_sizing *sizing,
                              const double lo[3], const double hi[3],
                              double *least, double *most)
{
  double middle[3], d2 = 0, h, change;

  assert(least && most);
  if (vg_sizing_is_stretched(sizing)) {
    vg_region_widest_within(r, sizing, lo, hi, least, most);
    return;
  }
  for (int k = 0; k < 3; k++) {
    middle[k] = 0.5 * (lo[k] + hi[k]);
    d2 += (hi[k] - middle[k]) * (hi[k] - middle[k]);
  }
  h = vg_region_spacing(r, sizing, middle);
  change = vg_sizing_slope(sizing) * sqrt(d2);
  *least = h - change;
  *most = h + change;
}

int vg_region_within(const struct vg_region *r, const double x[3])
{
  assert(r->n_wall >= 0 && r->n_wall <= VG_REGION_WALLS);
  for (int i = 0; i < r->n_wall; i++)
    if (!(vg_plane_side(&r->wall[i], x) > 0)) return 0;
  return 1;
}

/* The largest distance from n corners to any plane or wall that they violate:
 * a plane with all corners on one side, or a wall with all corners beyond it.
 * The nearest corner counts. Distances beyond walls are scaled up by 1 /
 * VG_BEYOND_WALLS. */
static double gap(const struct vg_region *r, int n, const double *const *x)
{
  double far = 0;

  for (int i = 0; i < r->n_plane + r->n_wall; i++) {
    int is_wall = i >= r->n_plane, above = 0, below = 0;
    const struct vg_plane *p = is_wall ? &r->wall[i - r->n_plane]
                                       : &r->plane[i];
    double near = INFINITY;

    for (int k = 0; k < n; k++) {
      double s = vg_plane_side(p, x[k]);

      above |= s >= 0;
      below |= s <= 0;
      if (fabs(s) < near) near = fabs(s);
    }
    if (is_wall) near *= 1 / VG_BEYOND_WALLS;
    if (is_wall ? !above : !(above && below))
      if (near > far) far = near;
  }
  return far;
}

int vg_region_near_by(const struct vg_region *r, const struct vg_sizing *sizing,
                      const double x[3], double band, double h, double d)
{
  double far = gap(r, 1, &x), most = vg_region_band(r, band), foot2 = 0, off;

  assert(h > 0 && d >= 0);
  if (far == 0) return 1;
  for (int i = 0; i < r->n_plane; i++) {
    double s = vg_plane_side(&r->plane[i], x);

    foot2 += s * s;
  }
  off = vg_sizing_slope_along(sizing) * (sqrt(foot2) + d);
  if (far <= most * (h - off)) return 1;
  if (far > most * (h + off)) return 0;
  return far <= most * vg_region_spacing(r, sizing, x);
}

int vg_region_near(const struct vg_region *r, const struct vg_sizing *sizing,
                   const double x[3], double band)
{
  double far, most = vg_region_band(r, band), h_min, h_max;

  if (vg_sizing_is_stretched(sizing))
    return vg_region_near_in_metric(r, sizing, x, most);
  far = gap(r, 1, &x);
  vg_sizing_range_along(sizing, &h_min, &h_max);
  if (far == 0 || far <= most * h_min) return 1;
  return far <= most * h_max && far <= most * vg_region_spacing(r, sizing, x);
}

/* --- triangles ------------------------------------------------------------ */

enum { CORNERS = 3 + 2 * 2 + VG_REGION_WALLS };

/* Clip a polygon to sign * side <= most. Returns the number of corners left. */
static int clip(int n, double (*x)[3], const struct vg_plane *p, double sign,
                double most)
{
  double out[CORNERS][3];
  int m = 0;

  for (int i = 0; i < n; i++) {
    const double *a = x[i], *b = x[(i + 1) % n];
    double s = sign * vg_plane_side(p, a) - most;
    double t = sign * vg_plane_side(p, b) - most;

    if (s <= 0) memcpy(out[m++], a, sizeof *out);
    if ((s < 0 && t > 0) || (s > 0 && t < 0)) {
      for (int k = 0; k < 3; k++)
        out[m][k] = a[k] + (b[k] - a[k]) * (s / (s - t));
      m++;
    }
    if (m > CORNERS - 2) break;
  }
  memcpy(x, out, (size_t)m * sizeof *out);
  return m;
}

int vg_region_reaches(const struct vg_region *r, const double *const corner[3],
                      const double *most, int step, double middle[3])
{
  double x[CORNERS][3];
  int n = 3;

  for (int k = 0; k < 3; k++) memcpy(x[k], corner[k], sizeof *x);
  for (int i = 0; i < r->n_plane && n; i++) {
    n = clip(n, x, &r->plane[i], 1, most[i * step]);
    if (n) n = clip(n, x, &r->plane[i], -1, most[i * step]);
  }
  for (int i = 0; i < r->n_wall && n; i++)
    n = clip(n, x, &r->wall[i], -1,
             VG_BEYOND_WALLS * most[(r->n_plane + i) * step]);
  for (int k = 0; k < 3; k++) {
    middle[k] = 0;
    for (int i = 0; i < n; i++) middle[k] += x[i][k] / n;
  }
  return n > 0;
}

double vg_region_longest(const double *const corner[3])
{
  double most = 0;

  for (int i = 0; i < 3; i++) {
    double d2 = 0;

    for (int k = 0; k < 3; k++) {
      double d = corner[(i + 1) % 3][k] - corner[i][k];

      d2 += d * d;
    }
    if (d2 > most) most = d2;
  }
  return sqrt(most);
}

/* Clips a triangle that is much larger than the local cells. Such a triangle
 * may cross the planes and the walls at different places, so the part of it
 * within reach is cut out: first with `most`, the largest spacing found at the
 * corners and the middle of the triangle, then (is_sure) with the spacing at
 * the middle of that part. Where the spacing varies, this middle may be far
 * from a corner that is within reach by its own spacing, so the caller tests
 * the corners first. */
static int large_meets(const struct vg_region *r,
                       const struct vg_sizing *sizing,
                       const double *const corner[3], double most, double band,
                       int is_sure)
{
  double middle[3], reach = vg_region_band(r, band) * most;

  if (!vg_region_reaches(r, corner, &reach, 0, middle)) return 0;
  if (!is_sure) return 1;
  reach = vg_region_band(r, band) * vg_region_spacing(r, sizing, middle);
  return vg_region_reaches(r, corner, &reach, 0, middle);
}

static double spacing_amid(const struct vg_region *r,
                           const struct vg_sizing *sizing,
                           const double *const corner[3])
{
  double middle[3];

  for (int k = 0; k < 3; k++)
    middle[k] = (corner[0][k] + corner[1][k] + corner[2][k]) / 3;
  return vg_region_spacing(r, sizing, middle);
}

static int meets(const struct vg_region *r, const struct vg_sizing *sizing,
                 const double *const corner[3], double band, int is_sure)
{
  double reach = vg_region_band(r, band), h[3], most = 0;

  if (vg_sizing_is_stretched(sizing))
    return vg_region_meets_in_metric(r, sizing, corner, reach, is_sure);
  for (int k = 0; k < 3; k++) {
    h[k] = vg_region_spacing(r, sizing, corner[k]);
    most = fmax(most, h[k]);
  }
  if (vg_region_longest(corner) <= 2 * most)
    return gap(r, 3, corner) <= reach * most;
  for (int k = 0; k < 3; k++)
    if (gap(r, 1, &corner[k]) <= reach * h[k]) return 1;
  most = fmax(most, spacing_amid(r, sizing, corner));
  return large_meets(r, sizing, corner, most, band, is_sure);
}

int vg_region_meets(const struct vg_region *r, const struct vg_sizing *sizing,
                    const double a[3], const double b[3], const double c[3],
                    double band)
{
  const double *corner[3] = { a, b, c };

  return meets(r, sizing, corner, band, 1);
}

int vg_region_may_meet(const struct vg_region *r,
                       const struct vg_sizing *sizing, const double a[3],
                       const double b[3], const double c[3], double band)
{
  const double *corner[3] = { a, b, c };

  return meets(r, sizing, corner, band, 0);
}

/* Is a corner within reach of all planes? far: [4] distance of each corner
 * from its farthest plane. The spacing varies so little between the corners
 * that most of them need no look-up. */
static int has_corner(const struct vg_region *r, const struct vg_sizing *sizing,
                      const double *const corner[4], const double far[4])
{
  double slope = vg_sizing_slope_along(sizing);
  double first = vg_region_spacing(r, sizing, corner[0]);

  if (far[0] <= r->reach * first) return 1;
  for (int k = 1; k < 4; k++) {
    double d2 = 0;

    for (int i = 0; i < 3; i++)
      d2 += (corner[k][i] - corner[0][i]) * (corner[k][i] - corner[0][i]);
    if (far[k] <= r->reach * (first + slope * sqrt(d2)) &&
        far[k] <= r->reach * vg_region_spacing(r, sizing, corner[k]))
      return 1;
  }
  return 0;
}

int vg_region_has_cell(const struct vg_region *r,
                       const struct vg_sizing *sizing, const double a[3],
                       const double b[3], const double c[3], const double d[3])
{
  const double *corner[4] = { a, b, c, d };
  double far[4] = { 0 };
  int crosses = 1;

  for (int i = 0; i < r->n_plane; i++) {
    int above = 0, below = 0;

    for (int k = 0; k < 4; k++) {
      double s = vg_plane_side(&r->plane[i], corner[k]);

      above |= s >= 0;
      below |= s <= 0;
      if (fabs(s) > far[k]) far[k] = fabs(s);
    }
    crosses &= above && below;
  }
  if (!crosses && !(r->reach > 0)) return 0;
  for (int k = 0; k < 4; k++)
    if (!vg_region_within(r, corner[k])) return 0;
  if (crosses) return 1;
  return vg_sizing_is_stretched(sizing)
         ? vg_region_has_corner_in_metric(r, sizing, corner)
         : has_corner(r, sizing, corner, far);
}

/* --- many points ---------------------------------------------------------- */

vg_status vg_region_cache_init(struct vg_region_cache *cache,
                               const struct vg_region *region,
                               const struct vg_sizing *sizing, size_t n,
                               const double (*x)[3], struct vg_error *err)
{
  int m = region->n_plane + region->n_wall;
  int n_spacing = vg_sizing_is_stretched(sizing) && m ? m : 1;
  double least, most;

  assert(cache && sizing && (x || !n));
  assert(vg_region_is_sound(region));
  vg_sizing_range_along(sizing, &least, &most);
  *cache = (struct vg_region_cache){
    region,    sizing, x,   vg_sizing_slope_along(sizing), most - least, m,
    n_spacing, NULL,   NULL
  };
  cache->side = vg_alloc(n, (size_t)(m ? m : 1) * sizeof *cache->side);
  cache->spacing = vg_alloc(n, (size_t)n_spacing * sizeof *cache->spacing);
  if (!cache->side || !cache->spacing)
    return vg_fail_memory(err, "measuring a front");
  for (size_t p = 0; p < n; p++) {
    double *s = cache->side + p * (size_t)m;

    for (int i = 0; i < region->n_plane; i++)
      s[i] = vg_plane_side(&region->plane[i], x[p]);
    for (int i = region->n_plane; i < m; i++)
      s[i] = vg_plane_side(&region->wall[i - region->n_plane], x[p]);
    if (vg_sizing_is_stretched(sizing))
      vg_region_across(region, sizing, x[p],
                       cache->spacing + p * (size_t)n_spacing);
    else cache->spacing[p] = vg_region_spacing(region, sizing, x[p]);
  }
  return VG_OK;
}

void vg_region_cache_release(struct vg_region_cache *cache)
{
  free(cache->side);
  free(cache->spacing);
  memset(cache, 0, sizeof *cache);
}

static const double *sides_of(const struct vg_region_cache *cache, uint32_t p)
{
  return cache->side + p * (size_t)cache->n_side;
}

/* As gap(), for three corners of a cache. Avoids fmin() and fmax(), which are
 * function calls. */
static double gap_of(const struct vg_region_cache *cache, const uint32_t v[3])
{
  const double *a = sides_of(cache, v[0]), *b = sides_of(cache, v[1]);
  const double *c = sides_of(cache, v[2]);
  double far = 0;

  for (int i = 0; i < cache->n_side; i++) {
    double lo = a[i] < b[i] ? a[i] : b[i], hi = a[i] < b[i] ? b[i] : a[i];

    if (c[i] < lo) lo = c[i];
    if (c[i] > hi) hi = c[i];
    if (i >= cache->region->n_plane) {
      lo = 0;
      hi *= 1 / VG_BEYOND_WALLS;
    }
    if (-hi > far) far = -hi;
    if (lo > far) far = lo;
  }
  return far;
}

static double gap_of_point(const struct vg_region_cache *cache, uint32_t p)
{
  const double *s = sides_of(cache, p);
  double far = 0;

  for (int i = 0; i < cache->n_side; i++)
    far = fmax(far, i < cache->region->n_plane ? fabs(s[i])
                                               : -s[i] / VG_BEYOND_WALLS);
  return far;
}

/* Large triangles that plain distances do not decide are tested as in
 * vg_region_meets. The distances are compared using the smallest and the
 * largest possible spacing anywhere on the triangle, or at its middle, which
 * is at most two thirds of an edge away from the corners. */
static int cache_meets(const struct vg_region_cache *cache, const uint32_t v[3],
                       double band, int is_sure)
{
  const struct vg_region *r = cache->region;
  const double(*x)[3] = cache->x;
  const double *corner[3] = { x[v[0]], x[v[1]], x[v[2]] };
  const double *h = cache->spacing;
  double least = h[v[0]] < h[v[1]] ? h[v[0]] : h[v[1]];
  double most = h[v[0]] < h[v[1]] ? h[v[1]] : h[v[0]];
  double reach = vg_region_band(r, band);
  double far = gap_of(cache, v), size = vg_region_longest(corner), rise, up;

  if (h[v[2]] < least) least = h[v[2]];
  if (h[v[2]] > most) most = h[v[2]];
  if (size <= 2 * most) return far <= reach * most;
  rise = cache->slope * size;
  up = 0.67 * rise < cache->range ? 0.67 * rise : cache->range;
  if (rise > cache->range) rise = cache->range;
  if (far > reach * most && far > reach * (least + up)) return 0;
  for (int k = 0; k < 3; k++)
    if (gap_of_point(cache, v[k]) <= reach * h[v[k]]) return 1;
  if (cache->n_side == 1 && far <= reach * fmax(most - rise, 0)) return 1;
  most = fmax(most, spacing_amid(r, cache->sizing, corner));
  return far <= reach * most &&
         large_meets(r, cache->sizing, corner, most, band, is_sure);
}

static int cached(const struct vg_region_cache *cache, const uint32_t v[3],
                  double band, int is_sure)
{
  assert(cache->region && cache->side && cache->spacing);
  return vg_sizing_is_stretched(cache->sizing)
         ? vg_region_cache_meets_in_metric(cache, v,
                                           vg_region_band(cache->region, band),
                                           is_sure)
         : cache_meets(cache, v, band, is_sure);
}

int vg_region_cache_meets(const struct vg_region_cache *cache,
                          const uint32_t v[3], double band)
{
  return cached(cache, v, band, 1);
}

int vg_region_cache_may_meet(const struct vg_region_cache *cache,
                             const uint32_t v[3], double band)
{
  return cached(cache, v, band, 0);
}
