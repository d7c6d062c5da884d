/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Distances from a region in a metric. The spacing across a plane depends on
 * its normal: cells along a shock are long across one plane and thin across
 * another. The distance of a point from each plane and wall is therefore
 * divided by the spacing across that side, both taken at the foot of the
 * point. A point is near the region if it is near all sides. */
#include <assert.h>
#include <math.h>

#include "core/front/region_parts.h"
#include "core/geometry/tensor.h"
#include "core/geometry/vector.h"

static int n_sides(const struct vg_region *r)
{
  return r->n_plane + r->n_wall;
}

static const struct vg_plane *side_of(const struct vg_region *r, int i)
{
  return i < r->n_plane ? &r->plane[i] : &r->wall[i - r->n_plane];
}

/* --- spacings ------------------------------------------------------------- */

void vg_region_across(const struct vg_region *r, const struct vg_sizing *sizing,
                      const double x[3], double h[VG_REGION_SIDES])
{
  double foot[3], size[6], v[3];

  assert(vg_sizing_is_stretched(sizing));
  vg_region_foot(r, x, foot);
  vg_sizing_tensor_at(sizing, foot, size);
  for (int i = 0; i < n_sides(r); i++) {
    vg_tensor_apply(size, side_of(r, i)->normal, v);
    h[i] = vg_norm(v);
  }
}

static double widest(const struct vg_region *r, const double *h)
{
  double most = 0;

  for (int i = 0; i < n_sides(r); i++)
    most = fmax(most, (i < r->n_plane ? 1 : VG_BEYOND_WALLS) * h[i]);
  return most;
}

double vg_region_widest(const struct vg_region *r,
                        const struct vg_sizing *sizing, const double x[3])
{
  double h[VG_REGION_SIDES];

  vg_region_across(r, sizing, x, h);
  return widest(r, h);
}

/* The feet of the box are those of its middle, plus or minus the projection of
 * half its diagonals. */
static void foot_box(const struct vg_region *r, const double lo[3],
                     const double hi[3], double foot_lo[3], double foot_hi[3])
{
  double middle[3];

  for (int k = 0; k < 3; k++) middle[k] = 0.5 * (lo[k] + hi[k]);
  vg_region_foot(r, middle, middle);
  for (int k = 0; k < 3; k++) {
    double half = 0;

    for (int j = 0; j < 3; j++) {
      double p = k == j;

      for (int i = 0; i < r->n_plane; i++)
        p -= r->plane[i].normal[k] * r->plane[i].normal[j];
      half += 0.5 * fabs(p) * (hi[j] - lo[j]);
    }
    foot_lo[k] = middle[k] - half;
    foot_hi[k] = middle[k] + half;
  }
}

void vg_region_across_within(const struct vg_region *r,
                             const struct vg_sizing *sizing, const double lo[3],
                             const double hi[3], double least[VG_REGION_SIDES],
                             double most[VG_REGION_SIDES])
{
  double way[VG_REGION_SIDES][3], foot_lo[3], foot_hi[3];

  for (int i = 0; i < n_sides(r); i++)
    for (int k = 0; k < 3; k++) way[i][k] = side_of(r, i)->normal[k];
  foot_box(r, lo, hi, foot_lo, foot_hi);
  vg_sizing_bounds_across(sizing, foot_lo, foot_hi, n_sides(r),
                          (const double(*)[3])way, least, most);
}

void vg_region_widest_within(const struct vg_region *r,
                             const struct vg_sizing *sizing, const double lo[3],
                             const double hi[3], double *least, double *most)
{
  double low[VG_REGION_SIDES], high[VG_REGION_SIDES];

  vg_region_across_within(r, sizing, lo, hi, low, high);
  *least = widest(r, low);
  *most = widest(r, high);
}

/* --- points --------------------------------------------------------------- */

/* Distance from side i of n points with these signed distances: 0 if they are
 * on both sides of a plane or on the inner side of a wall. */
static double gap(const struct vg_region *r, int i, int n,
                  const double *const *side)
{
  double lo = side[0][i], hi = side[0][i];

  for (int k = 1; k < n; k++) {
    lo = fmin(lo, side[k][i]);
    hi = fmax(hi, side[k][i]);
  }
  if (i >= r->n_plane) return fmax(-hi, 0) / VG_BEYOND_WALLS;
  return fmax(fmax(lo, -hi), 0);
}

/* Are n points within `reach` spacings h[i] of all sides? */
static int is_near(const struct vg_region *r, int n, const double *const *side,
                   const double *h, double reach)
{
  for (int i = 0; i < n_sides(r); i++)
    if (gap(r, i, n, side) > reach * h[i]) return 0;
  return 1;
}

static void find_sides(const struct vg_region *r, const double x[3],
                       double side[VG_REGION_SIDES])
{
  for (int i = 0; i < n_sides(r); i++)
    side[i] = vg_plane_side(side_of(r, i), x);
}

/* Distance from the farthest side. */
static double farthest(const struct vg_region *r, int n,
                       const double *const *side)
{
  double far = 0;

  for (int i = 0; i < n_sides(r); i++) far = fmax(far, gap(r, i, n, side));
  return far;
}

int vg_region_near_in_metric(const struct vg_region *r,
                             const struct vg_sizing *sizing, const double x[3],
                             double reach)
{
  double side[VG_REGION_SIDES], h[VG_REGION_SIDES], far, least, most;
  const double *of = side;

  find_sides(r, x, side);
  far = farthest(r, 1, &of);
  vg_sizing_range_along(sizing, &least, &most);
  if (far == 0 || far <= reach * least) return 1;
  if (far > reach * most) return 0;
  vg_region_across(r, sizing, x, h);
  return is_near(r, 1, &of, h, reach);
}

int vg_region_has_corner_in_metric(const struct vg_region *r,
                                   const struct vg_sizing *sizing,
                                   const double *const corner[4])
{
  struct vg_region planes = *r;

  planes.n_wall = 0;
  for (int k = 0; k < 4; k++)
    if (vg_region_near_in_metric(&planes, sizing, corner[k], r->reach))
      return 1;
  return 0;
}

double vg_region_cache_far(const struct vg_region_cache *cache, uint32_t p)
{
  const double *side = cache->side + p * (size_t)cache->n_side;
  const double *h = cache->spacing + p * (size_t)cache->n_spacing;
  double far = 0;

  assert(cache->region && cache->side && cache->spacing);
  for (int i = 0; i < cache->n_side; i++)
    far = fmax(far, gap(cache->region, i, 1, &side) /
                      h[cache->n_spacing > 1 ? i : 0]);
  return far;
}

/* --- triangles ------------------------------------------------------------ */

struct triangle {
  const struct vg_region *region;
  const struct vg_sizing *sizing;
  const double *corner[3];
  const double *side[3]; /* Distances of the corners from the sides. */
  const double *h[3];    /* Spacings at their feet. */
};

/* Is a part of the triangle within reach[i] of all sides, by the spacings at
 * the corners and, for is_sure, also by those amid this part? */
static int reaches(const struct triangle *t, double most[VG_REGION_SIDES],
                   double reach, int is_sure)
{
  double amid[VG_REGION_SIDES], x[3];
  int n = n_sides(t->region);

  for (int k = 0; k < 3; k++)
    x[k] = (t->corner[0][k] + t->corner[1][k] + t->corner[2][k]) / 3;
  vg_region_across(t->region, t->sizing, x, amid);
  for (int i = 0; i < n; i++) most[i] = reach * fmax(most[i], amid[i]);
  if (!vg_region_reaches(t->region, t->corner, most, 1, x)) return 0;
  if (!is_sure) return 1;
  vg_region_across(t->region, t->sizing, x, amid);
  for (int i = 0; i < n; i++) amid[i] *= reach;
  return vg_region_reaches(t->region, t->corner, amid, 1, x);
}

static int meets(const struct triangle *t, double reach, int is_sure)
{
  const struct vg_region *r = t->region;
  double most[VG_REGION_SIDES], wide = 0, low, high;

  for (int i = 0; i < n_sides(r); i++) {
    most[i] = fmax(t->h[0][i], fmax(t->h[1][i], t->h[2][i]));
    wide = fmax(wide, most[i]);
  }
  if (vg_region_longest(t->corner) <= 2 * wide)
    return is_near(r, 3, t->side, most, reach);
  for (int k = 0; k < 3; k++)
    if (is_near(r, 1, &t->side[k], t->h[k], reach)) return 1;
  vg_sizing_range_along(t->sizing, &low, &high);
  return farthest(r, 3, t->side) <= reach * high &&
         reaches(t, most, reach, is_sure);
}

int vg_region_meets_in_metric(const struct vg_region *r,
                              const struct vg_sizing *sizing,
                              const double *const corner[3], double reach,
                              int is_sure)
{
  double side[3][VG_REGION_SIDES], h[3][VG_REGION_SIDES];
  struct triangle t = { .region = r, .sizing = sizing };

  for (int k = 0; k < 3; k++) {
    find_sides(r, corner[k], side[k]);
    vg_region_across(r, sizing, corner[k], h[k]);
    t.corner[k] = corner[k];
    t.side[k] = side[k];
    t.h[k] = h[k];
  }
  return meets(&t, reach, is_sure);
}

int vg_region_cache_meets_in_metric(const struct vg_region_cache *cache,
                                    const uint32_t v[3], double reach,
                                    int is_sure)
{
  struct triangle t = { .region = cache->region, .sizing = cache->sizing };

  for (int k = 0; k < 3; k++) {
    t.corner[k] = cache->x[v[k]];
    t.side[k] = cache->side + v[k] * (size_t)cache->n_side;
    t.h[k] = cache->spacing + v[k] * (size_t)cache->n_side;
  }
  return meets(&t, reach, is_sure);
}
