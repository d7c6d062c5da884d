/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/sizing/sizing_cone.h"

#include <assert.h>
#include <math.h>

#include "core/geometry/tensor.h"
#include "core/geometry/vector.h"
#include "core/sizing/sizing_tensor.h"

/* The half plane of a point: axial and radial direction, with the coordinates z
 * and r of the point. */
struct half_plane {
  double axis[3], out[3], length, z, r;
  double sine, cosine; /* Of the half angle of the cones. */
};

static struct half_plane half_plane_of(const struct vg_source *s,
                                       const double x[3])
{
  struct half_plane p;
  double u[3];

  vg_sub(s->p1, s->p0, p.axis);
  p.length = vg_unit(p.axis);
  p.sine = 1 / s->mach;
  p.cosine = sqrt((1 - p.sine) * (1 + p.sine));
  vg_sub(x, s->p0, u);
  p.z = vg_dot(u, p.axis);
  for (int k = 0; k < 3; k++) p.out[k] = u[k] - p.z * p.axis[k];
  p.r = vg_norm(p.out);
  if (p.r > 0) {
    for (int k = 0; k < 3; k++) p.out[k] /= p.r;
  } else { /* On the axis any radial direction will do. */
    double other[3] = { 0, 0, 0 };

    other[fabs(p.axis[2]) < 0.6 ? 2 : 1] = 1;
    vg_cross(p.axis, other, p.out);
    if (!(vg_unit(p.out) > 0)) p.out[0] = 1;
  }
  return p;
}

const char *vg_mach_cone_defect(const struct vg_source *s)
{
  double d[3];

  vg_sub(s->p1, s->p0, d);
  if (!(s->mach > 1) || !isfinite(s->mach))
    return "its Mach number is not above 1; give that of the flow (mach)";
  if (!(vg_dot(d, d) > 0))
    return "its axis has no length; give the foremost and the rearmost point "
           "of the body (x0 y0 z0, x1 y1 z1)";
  if (!(s->r0 > 0) || !isfinite(s->r0))
    return "its radius is not positive; give the radius where the cones end "
           "(r0)";
  if (!(s->h1 > 0) || !isfinite(s->h1))
    return "its spacing at the radius r0 is not positive; give a length above "
           "zero (h1)";
  if (!(s->stretch >= 1) || !isfinite(s->stretch))
    return "its stretching is below 1; give the ratio of the sizes along and "
           "across the cone (stretch)";
  return NULL;
}

/* --- distance ------------------------------------------------------------- */

/* Nearest point of the segment a b of the half plane, if it is nearer to p than
 * `best`. */
static double nearer(const double a[2], const double b[2], const double p[2],
                     double best, double foot[2])
{
  const double d[2] = { b[0] - a[0], b[1] - a[1] };
  const double len2 = d[0] * d[0] + d[1] * d[1];
  double t = ((p[0] - a[0]) * d[0] + (p[1] - a[1]) * d[1]) / len2, at[2], dd;

  t = t < 0 ? 0 : t > 1 ? 1 : t;
  at[0] = a[0] + t * d[0];
  at[1] = a[1] + t * d[1];
  dd = (p[0] - at[0]) * (p[0] - at[0]) + (p[1] - at[1]) * (p[1] - at[1]);
  if (!(dd < best)) return best;
  foot[0] = at[0];
  foot[1] = at[1];
  return dd;
}

double vg_mach_cone_way(const struct vg_source *s, const double x[3], double *t,
                        double way[3])
{
  const struct half_plane h = half_plane_of(s, x);
  const double shift = s->r0 * h.cosine / h.sine;
  const double apex = h.z - h.r * h.cosine / h.sine;
  const double p[2] = { h.z, h.r };
  const double corner[5][2] = { { 0, 0 },
                                { shift, s->r0 },
                                { shift + h.length, s->r0 },
                                { h.length, 0 },
                                { 0, 0 } };
  double foot[2] = { h.z, h.r }, d2 = INFINITY;

  assert(s->mach > 1 && s->r0 > 0);
  if (apex >= 0 && apex <= h.length && h.r <= s->r0) d2 = 0;
  for (int i = 0; d2 > 0 && i < 4; i++)
    d2 = nearer(corner[i], corner[i + 1], p, d2, foot);
  *t = foot[1] / s->r0;
  for (int k = 0; k < 3; k++)
    way[k] = (h.z - foot[0]) * h.axis[k] + (h.r - foot[1]) * h.out[k];
  return sqrt(d2);
}

/* --- sizes ---------------------------------------------------------------- */

/* Sizes normal to the cone, along the line from the apex, and around the axis.
 */
enum { ACROSS, ALONG, ROUND };

/* Nearest point (z, r) of the cones without their end at r0. */
static void foot_of(const struct half_plane *p, double foot[2])
{
  const double apex = p->z - p->r * p->cosine / p->sine;
  const double from = fmin(fmax(apex, 0), p->length);
  double along;

  foot[0] = p->z;
  foot[1] = p->r;
  if (apex == from) return;
  along = fmax((p->z - from) * p->cosine + p->r * p->sine, 0);
  foot[0] = from + along * p->cosine;
  foot[1] = along * p->sine;
}

/* Grow the sizes over the vector `way` of the half plane (vg_size_grow). */
static void grow(const struct half_plane *p, double slope, const double way[2],
                 double size[3])
{
  const double n = p->sine * way[0] - p->cosine * way[1];
  const double g = p->cosine * way[0] + p->sine * way[1];
  const double l = sqrt(n * n / (size[ACROSS] * size[ACROSS]) +
                        g * g / (size[ALONG] * size[ALONG]));
  const double factor = 1 + VG_GROWTH_IN_METRIC * slope * l;
  const double more = (1 - VG_GROWTH_IN_METRIC) * slope * sqrt(n * n + g * g);

  for (int k = 0; k < 3; k++) size[k] = factor * size[k] + more;
}

/* Limit the sizes, since the metric turns around the axis. A step of the length
 * d on a circle of radius r turns it by d / r. The grown size tensor contains
 * that of the next point if the sizes a, b, c across, along and around satisfy
 *   (cosine (c^2 - a^2) / a)^2 + (sine (b^2 - c^2) / b)^2 <= (2 q slope r)^2,
 * q = VG_GROWTH_IN_METRIC. With b - a <= slope r, the second term is at most
 * (sine slope r)^2. Along the cone, c grows no faster than allowed if `turn` is
 * at most 2 q / sine. wide: growth of b - a from the axis. */
static void limit_turn(const struct half_plane *p, double slope, double wide,
                       double r, double size[3])
{
  const double q = 2 * VG_GROWTH_IN_METRIC;
  const double turn = fmin(sqrt(q * q - p->sine * p->sine) / p->cosine,
                           q / p->sine);
  const double a = size[ACROSS];

  size[ALONG] = fmin(size[ALONG], a + wide);
  size[ROUND] = fmin(fmin(size[ROUND], size[ALONG]),
                     sqrt(a * (a + turn * slope * r)));
}

/* Sizes at a point of the half plane. */
static void sizes_at(const struct vg_source *s, const struct half_plane *p,
                     double slope, double size[3])
{
  double foot[2], t, r, wide;

  foot_of(p, foot);
  t = fmin(foot[1] / s->r0, 1);
  r = fmin(foot[1], p->r);
  size[ACROSS] = s->h0 + t * (s->h1 - s->h0);
  size[ALONG] = size[ROUND] = s->stretch * size[ACROSS];
  wide = slope * fmax(r - size[ACROSS], 0);
  limit_turn(p, slope, slope * fmax(t * s->r0 - size[ACROSS], 0), t * s->r0,
             size);
  if (foot[1] > s->r0) {
    const double beyond[2] = { (foot[1] - s->r0) * p->cosine / p->sine,
                               foot[1] - s->r0 };

    grow(p, slope, beyond, size);
  }
  if (foot[0] != p->z || foot[1] != p->r)
    grow(p, slope, (const double[2]){ p->z - foot[0], p->r - foot[1] }, size);
  limit_turn(p, slope, wide, r, size);
}

/* Near the axis of the cones, the sizes are equal. */
void vg_mach_cone_axes(const struct vg_source *s, double slope,
                       const double x[3], struct vg_size_axes *a)
{
  const struct half_plane p = half_plane_of(s, x);

  sizes_at(s, &p, slope, a->size);
  if (!(a->size[ALONG] > a->size[ACROSS]))
    a->size[ALONG] = a->size[ROUND] = a->size[ACROSS];
  for (int k = 0; k < 3; k++) {
    a->axis[ACROSS][k] = p.sine * p.axis[k] - p.cosine * p.out[k];
    a->axis[ALONG][k] = p.cosine * p.axis[k] + p.sine * p.out[k];
  }
  vg_cross(p.axis, p.out, a->axis[ROUND]);
}

void vg_mach_cone_bounds(const struct vg_source *s, double lo[3], double hi[3])
{
  const double cot = sqrt((s->mach - 1) * (s->mach + 1));
  double axis[3];

  vg_sub(s->p1, s->p0, axis);
  vg_unit(axis);
  for (int k = 0; k < 3; k++) {
    /* The circle of radius r0 around the axis, at the end of the cones. */
    const double wide = s->r0 * sqrt(fmax(0, 1 - axis[k] * axis[k]));
    const double along = s->r0 * cot * axis[k];

    lo[k] = fmin(fmin(s->p0[k], s->p1[k]),
                 fmin(s->p0[k], s->p1[k]) + along - wide);
    hi[k] = fmax(fmax(s->p0[k], s->p1[k]),
                 fmax(s->p0[k], s->p1[k]) + along + wide);
  }
}
