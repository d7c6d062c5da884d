/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/sizing/sizing_cone.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "core/geometry/tensor.h"
#include "core/geometry/vector.h"
#include "core/sizing/sizing_tensor.h"

/* The half plane of a point: radial direction, and the coordinates z and r of
 * the point. */
struct half_plane {
  double out[3], z, r;
};

void vg_mach_cones_prepare(const struct vg_source *s, double slope,
                           struct vg_mach_cones *c)
{
  const double q = 2 * VG_GROWTH_IN_METRIC;

  assert(s->mach > 1 && s->r0 > 0);
  memcpy(c->p0, s->p0, sizeof c->p0);
  vg_sub(s->p1, s->p0, c->axis);
  c->length = vg_unit(c->axis);
  c->sine = 1 / s->mach;
  c->cosine = sqrt((1 - c->sine) * (1 + c->sine));
  c->cot = c->cosine / c->sine;
  c->r0 = s->r0;
  c->h0 = s->h0;
  c->h1 = s->h1;
  c->stretch = s->stretch;
  c->slope = slope;
  c->turn = slope *
            fmin(sqrt(q * q - c->sine * c->sine) / c->cosine, q / c->sine);
}

/* The radial direction is that to x, of any length. */
static struct half_plane half_plane_of(const struct vg_mach_cones *c,
                                       const double x[3])
{
  struct half_plane p;
  double u[3];

  vg_sub(x, c->p0, u);
  p.z = vg_dot(u, c->axis);
  for (int k = 0; k < 3; k++) p.out[k] = u[k] - p.z * c->axis[k];
  p.r = vg_norm(p.out);
  return p;
}

/* On the axis any radial direction will do. */
static void set_out(const struct vg_mach_cones *c, struct half_plane *p)
{
  double other[3] = { 0, 0, 0 }, scale = 1 / p->r;

  if (p->r > 0) {
    for (int k = 0; k < 3; k++) p->out[k] *= scale;
    return;
  }
  vg_normals(c->axis, p->out, other);
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

double vg_mach_cones_way(const struct vg_mach_cones *c, const double x[3],
                         double *t, double way[3])
{
  struct half_plane h = half_plane_of(c, x);
  const double shift = c->r0 * c->cot, apex = h.z - h.r * c->cot;
  const double p[2] = { h.z, h.r };
  const double corner[5][2] = { { 0, 0 },
                                { shift, c->r0 },
                                { shift + c->length, c->r0 },
                                { c->length, 0 },
                                { 0, 0 } };
  double foot[2] = { h.z, h.r }, d2 = INFINITY;

  *t = h.r / c->r0;
  way[0] = way[1] = way[2] = 0;
  if (apex >= 0 && apex <= c->length && h.r <= c->r0) return 0;
  for (int i = 0; d2 > 0 && i < 4; i++)
    d2 = nearer(corner[i], corner[i + 1], p, d2, foot);
  *t = foot[1] / c->r0;
  set_out(c, &h);
  for (int k = 0; k < 3; k++)
    way[k] = (h.z - foot[0]) * c->axis[k] + (h.r - foot[1]) * h.out[k];
  return sqrt(d2);
}

double vg_mach_cone_way(const struct vg_source *s, const double x[3], double *t,
                        double way[3])
{
  struct vg_mach_cones c;

  vg_mach_cones_prepare(s, 0, &c);
  return vg_mach_cones_way(&c, x, t, way);
}

/* --- sizes ---------------------------------------------------------------- */

/* Sizes normal to the cone, along the line from the apex, and around the axis.
 */
enum { ACROSS, ALONG, ROUND };

/* Nearest point (z, r) of the cones without their end at r0. Returns whether it
 * is another point. */
static int foot_of(const struct vg_mach_cones *c, const struct half_plane *p,
                   double foot[2])
{
  const double apex = p->z - p->r * c->cot;
  const double from = vg_lesser(vg_greater(apex, 0), c->length);
  double along;

  foot[0] = p->z;
  foot[1] = p->r;
  if (apex == from) return 0;
  along = vg_greater((p->z - from) * c->cosine + p->r * c->sine, 0);
  foot[0] = from + along * c->cosine;
  foot[1] = along * c->sine;
  return 1;
}

/* Grow the sizes over the vector `way` of the half plane (vg_size_grow). */
static void grow(const struct vg_mach_cones *c, const double way[2],
                 double size[3])
{
  const double n = c->sine * way[0] - c->cosine * way[1];
  const double g = c->cosine * way[0] + c->sine * way[1];
  const double l = sqrt(n * n / (size[ACROSS] * size[ACROSS]) +
                        g * g / (size[ALONG] * size[ALONG]));
  const double factor = 1 + VG_GROWTH_IN_METRIC * c->slope * l;
  const double more = (1 - VG_GROWTH_IN_METRIC) * c->slope *
                      sqrt(n * n + g * g);

  for (int k = 0; k < 3; k++) size[k] = factor * size[k] + more;
}

/* Limit the sizes, since the metric turns around the axis. A step of the length
 * d on a circle of radius r turns it by d / r. The grown size tensor contains
 * that of the next point if the sizes a, b, c across, along and around satisfy
 *   (cosine (c^2 - a^2) / a)^2 + (sine (b^2 - c^2) / b)^2 <= (2 q slope r)^2,
 * q = VG_GROWTH_IN_METRIC. With b - a <= slope r, the second term is at most
 * (sine slope r)^2. Along the cone, c grows no faster than allowed if
 * turn / slope is at most 2 q / sine. wide: growth of b - a from the axis. */
static void limit_turn(const struct vg_mach_cones *c, double wide, double r,
                       double size[3])
{
  const double a = size[ACROSS];

  size[ALONG] = vg_lesser(size[ALONG], a + wide);
  size[ROUND] = vg_lesser(vg_lesser(size[ROUND], size[ALONG]),
                          sqrt(a * (a + c->turn * r)));
}

/* Sizes at a point of the half plane. */
static void sizes_at(const struct vg_mach_cones *c, const struct half_plane *p,
                     double size[3])
{
  double foot[2], t, r, wide;
  int is_outside = foot_of(c, p, foot);

  t = vg_lesser(foot[1] / c->r0, 1);
  r = vg_lesser(foot[1], p->r);
  size[ACROSS] = c->h0 + t * (c->h1 - c->h0);
  size[ALONG] = size[ROUND] = c->stretch * size[ACROSS];
  wide = c->slope * vg_greater(r - size[ACROSS], 0);
  limit_turn(c, c->slope * vg_greater(t * c->r0 - size[ACROSS], 0), t * c->r0,
             size);
  if (!is_outside && foot[1] <= c->r0) return;
  if (foot[1] > c->r0) {
    const double beyond[2] = { (foot[1] - c->r0) * c->cot, foot[1] - c->r0 };

    grow(c, beyond, size);
  }
  if (is_outside)
    grow(c, (const double[2]){ p->z - foot[0], p->r - foot[1] }, size);
  limit_turn(c, wide, r, size);
}

/* Near the axis of the cones, the sizes are equal. */
void vg_mach_cones_axes(const struct vg_mach_cones *c, const double x[3],
                        struct vg_size_axes *a)
{
  struct half_plane p = half_plane_of(c, x);

  sizes_at(c, &p, a->size);
  if (!(a->size[ALONG] > a->size[ACROSS])) {
    a->size[ALONG] = a->size[ROUND] = a->size[ACROSS];
    return;
  }
  set_out(c, &p);
  for (int k = 0; k < 3; k++) {
    a->axis[ACROSS][k] = c->sine * c->axis[k] - c->cosine * p.out[k];
    a->axis[ALONG][k] = c->cosine * c->axis[k] + c->sine * p.out[k];
  }
  vg_cross(c->axis, p.out, a->axis[ROUND]);
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
