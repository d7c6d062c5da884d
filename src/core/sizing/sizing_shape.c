/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/sizing/sizing_shape.h"

#include <math.h>
#include <string.h>

#include "core/geometry/vector.h"
#include "core/sizing/sizing_cone.h"
#include "core/sizing/sizing_tensor.h"

double vg_segment_way(const double a[3], const double b[3], const double x[3],
                      double *t, double way[3])
{
  double d = vg_segment_distance(a, b, x, t);

  for (int k = 0; k < 3; k++) way[k] = x[k] - a[k] - *t * (b[k] - a[k]);
  return d;
}

/* Within the three edge planes, the distance is that from the plane, otherwise
 * that from the nearest edge. A degenerate triangle has only edges. */
double vg_triangle_distance(const struct vg_source *s, const double x[3],
                            double way[3])
{
  const double *p[3] = { s->p0, s->p1, s->p2 };
  double e[3][3], n[3], u[3], m[3], d, t;
  int inside = 1;

  for (int k = 0; k < 3; k++) vg_sub(p[(k + 1) % 3], p[k], e[k]);
  vg_cross(e[0], e[1], n);
  for (int i = 0; i < 3 && inside; i++) {
    vg_sub(x, p[i], u);
    vg_cross(n, e[i], m);
    inside = vg_dot(m, u) >= 0;
  }
  vg_sub(x, s->p0, u);
  if (inside && vg_dot(n, n) > 0) {
    memcpy(way, n, sizeof n);
    return fabs(vg_dot(u, n)) / sqrt(vg_dot(n, n));
  }
  d = vg_segment_way(p[0], p[1], x, &t, way);
  for (int i = 1; i < 3; i++) {
    double other = vg_segment_way(p[i], p[(i + 1) % 3], x, &t, u);

    if (other >= d) continue;
    d = other;
    memcpy(way, u, sizeof u);
  }
  return d;
}

/* In the half plane (axial z, radial r), the cone is a trapezium. */
double vg_cone_distance(const struct vg_source *s, const double x[3], double *t)
{
  double d[3], u[3], len, z, r, r_at;
  double foot[3], rim0[3] = { 0, s->r0, 0 }, rim1[3], mid0[3] = { 0, 0, 0 };
  double mid1[3], at[3], f;

  vg_sub(s->p1, s->p0, d);
  vg_sub(x, s->p0, u);
  len = sqrt(vg_dot(d, d));
  z = vg_dot(u, d) / len;
  for (int k = 0; k < 3; k++) foot[k] = u[k] - z * (d[k] / len);
  r = sqrt(vg_dot(foot, foot));
  *t = vg_within(z / len, 0, 1);
  r_at = s->r0 + *t * (s->r1 - s->r0);
  if (z >= 0 && z <= len && r <= r_at) return 0;
  rim1[0] = mid1[0] = len;
  rim1[1] = s->r1;
  at[0] = z;
  at[1] = r;
  rim1[2] = mid1[1] = mid1[2] = at[2] = 0;
  f = vg_segment_distance(rim0, rim1, at, &r_at);
  f = vg_lesser(f, vg_segment_distance(mid0, rim0, at, &r_at));
  return vg_lesser(f, vg_segment_distance(mid1, rim1, at, &r_at));
}

/* As vg_cone_distance: the nearest point of the trapezium, in the half plane
 * of x. */
static double cone_way(const struct vg_source *s, const double x[3], double *t,
                       double way[3])
{
  double axis[3], u[3], out[3], best = INFINITY, len, z, r;
  double rim[2][3] = { { 0, s->r0, 0 }, { 0, s->r1, 0 } }, mid[2][3] = { 0 };
  double at[3] = { 0 }, flat[2] = { 0, 0 };

  vg_sub(s->p1, s->p0, axis);
  vg_sub(x, s->p0, u);
  len = vg_unit(axis);
  z = vg_dot(u, axis);
  for (int k = 0; k < 3; k++) out[k] = u[k] - z * axis[k];
  r = vg_unit(out);
  *t = vg_within(z / len, 0, 1);
  for (int k = 0; k < 3; k++) way[k] = 0;
  if (z >= 0 && z <= len && r <= s->r0 + *t * (s->r1 - s->r0)) return 0;
  at[0] = z;
  at[1] = r;
  rim[1][0] = mid[1][0] = len;
  for (int i = 0; i < 3; i++) {
    double ignored, v[3];
    double d = i < 2 ? vg_segment_way(mid[i], rim[i], at, &ignored, v)
                     : vg_segment_way(rim[0], rim[1], at, &ignored, v);

    if (d >= best) continue;
    best = d;
    flat[0] = v[0];
    flat[1] = v[1];
  }
  for (int k = 0; k < 3; k++) way[k] = flat[0] * axis[k] + flat[1] * out[k];
  return best;
}

double vg_shape_way(const struct vg_source *s, const double x[3], double *t,
                    double way[3])
{
  double d = 0, r = s->r0, len, from[3];

  *t = 0;
  switch (s->kind) {
  case VG_SOURCE_VGRID_LINE:
  case VG_SOURCE_LINE: d = vg_segment_way(s->p0, s->p1, x, t, way); break;
  case VG_SOURCE_TRIANGLE:
    d = vg_triangle_distance(s, x, way);
    len = vg_norm(way);
    vg_sub(x, s->p0, from);
    if (vg_dot(from, way) < 0) len = -len;
    for (int k = 0; k < 3; k++) way[k] *= len == 0 ? 0 : d / len;
    break;
  case VG_SOURCE_BOX:
    for (int k = 0; k < 3; k++)
      way[k] = x[k] - vg_within(x[k], s->p0[k], s->p1[k]);
    return vg_norm(way);
  case VG_SOURCE_CYLINDER: return cone_way(s, x, t, way);
  case VG_SOURCE_MACHCONE: return vg_mach_cone_way(s, x, t, way);
  case VG_SOURCE_VGRID_NODE:
  case VG_SOURCE_POINT:
  case VG_SOURCE_SPHERE: d = vg_segment_way(s->p0, s->p0, x, t, way); break;
  }
  for (int k = 0; k < 3; k++) way[k] *= d > r ? 1 - r / d : 0;
  return d > r ? d - r : 0;
}
