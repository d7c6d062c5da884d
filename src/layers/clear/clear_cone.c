/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Intersection of one triangle with a line or with a cone of 45 degrees. */
#include "layers/clear/clear_ahead.h"

#include <assert.h>
#include <math.h>

#include "core/geometry/vector.h"

int vg_line_hits(const double o[3], const double u[3], const double (*p)[3],
                 const double n[3], double *along)
{
  assert(along);

  double d = vg_dot(n, u), q[3], s;

  if (!(d < 0)) return 0;
  s = (n[0] * (p[0][0] - o[0]) + n[1] * (p[0][1] - o[1]) +
       n[2] * (p[0][2] - o[2])) /
      d;
  if (!(s >= 0 && s < *along)) return 0;
  for (int k = 0; k < 3; k++) q[k] = o[k] + s * u[k];
  for (int i = 0; i < 3; i++) {
    const double *a = p[i], *b = p[(i + 1) % 3];
    double e[3], f[3], c[3];

    for (int k = 0; k < 3; k++) {
      e[k] = b[k] - a[k];
      f[k] = q[k] - a[k];
    }
    vg_cross(e, f, c);
    if (vg_dot(c, n) < -1e-6 * vg_dot(e, e)) return 0;
  }
  *along = s;
  return 1;
}

/* Least u . x for points x of the edge a b within the cone of 45 degrees. */
static double edge_in_cone(const double u[3], const double a[3],
                           const double b[3])
{
  double e[3], ua = vg_dot(u, a), ue, qa, qb, qc, root, t[4] = { 0, 1 };
  double best = INFINITY;
  int n = 2;

  for (int k = 0; k < 3; k++) e[k] = b[k] - a[k];
  ue = vg_dot(u, e);
  /* |a + t e|^2 - 2 (u . (a + t e))^2 = qa t^2 + 2 qb t + qc <= 0 */
  qa = vg_dot(e, e) - 2 * ue * ue;
  qb = vg_dot(a, e) - 2 * ua * ue;
  qc = vg_dot(a, a) - 2 * ua * ua;
  root = qb * qb - qa * qc;
  if (root >= 0) {
    double q = -(qb + copysign(sqrt(root), qb));

    if (qa != 0) t[n++] = q / qa;
    if (q != 0) t[n++] = qc / q;
  }
  for (int i = 0; i < n; i++) {
    double s = ua + t[i] * ue;

    if (!(t[i] >= 0 && t[i] <= 1) || s < 0 || s >= best) continue;
    if (i < 2 && (i ? qa + 2 * qb + qc : qc) > 0) continue;
    best = s;
  }
  return best;
}

double vg_nearest_in_cone(const double u[3], const double (*p)[3],
                          const double n[3], double most)
{
  assert(fabs(vg_dot(u, u) - 1) < 1e-6 && most >= 0);

  double g = -vg_dot(n, u), h = -vg_dot(n, p[0]);
  double flat, w[3], s, best = INFINITY;
  static const double apex[3] = { 0, 0, 0 };

  if (!(h > 0)) return INFINITY;
  /* The plane is nearest along the generator that approaches it most
   * directly. */
  flat = sqrt(g * g < 1 ? 1 - g * g : 0);
  s = h / (g + flat);
  if (s >= most) return INFINITY;
  for (int k = 0; k < 3; k++)
    w[k] = u[k] - (flat > 1e-9 ? (n[k] + g * u[k]) / flat : 0);
  s = most;
  if (vg_line_hits(apex, w, p, n, &s)) return s;
  for (int i = 0; i < 3; i++) {
    double e = edge_in_cone(u, p[i], p[(i + 1) % 3]);

    if (e < best) best = e;
  }
  return best;
}
