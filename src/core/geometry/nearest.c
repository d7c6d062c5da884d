/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/geometry/nearest.h"

#include "core/geometry/vector.h"

/* Squared norm of p - t u. */
static double off_line2(const double p[3], double t, const double u[3])
{
  double q[3] = { p[0] - t * u[0], p[1] - t * u[1], p[2] - t * u[2] };

  return vg_dot(q, q);
}

/* The region that contains the foot of x determines the formula (Ericson,
 * Real-Time Collision Detection, 5.1.5). */
double vg_to_triangle2(const double x[3], const double a[3], const double b[3],
                       const double c[3])
{
  double u[3], v[3], p[3], q[3], r[3], n[3];
  double d1, d2, d3, d4, d5, d6, va, vb, vc, height;

  vg_sub(b, a, u);
  vg_sub(c, a, v);
  vg_sub(x, a, p);
  d1 = vg_dot(u, p);
  d2 = vg_dot(v, p);
  if (d1 <= 0 && d2 <= 0) return vg_dot(p, p);
  vg_sub(p, u, q);
  d3 = vg_dot(u, q);
  d4 = vg_dot(v, q);
  if (d3 >= 0 && d4 <= d3) return vg_dot(q, q);
  vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return off_line2(p, d1 / (d1 - d3), u);
  vg_sub(p, v, r);
  d5 = vg_dot(u, r);
  d6 = vg_dot(v, r);
  if (d6 >= 0 && d5 <= d6) return vg_dot(r, r);
  vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return off_line2(p, d2 / (d2 - d6), v);
  va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) {
    double w[3];

    vg_sub(v, u, w);
    return off_line2(q, (d4 - d3) / (d4 - d3 + d5 - d6), w);
  }
  vg_cross(u, v, n);
  height = vg_dot(n, p);
  return height * height / vg_dot(n, n);
}

static void set_weights(double w[3], double wa, double wb, double wc)
{
  w[0] = wa;
  w[1] = wb;
  w[2] = wc;
}

/* As above. d[i]: products of the edges u and v with the way from corner i to
 * x. */
void vg_nearest_weights(const double x[3], const double a[3], const double b[3],
                        const double c[3], double w[3])
{
  double u[3], v[3], d[3][2], va, vb, vc, t;
  const double *corner[3] = { a, b, c };

  vg_sub(b, a, u);
  vg_sub(c, a, v);
  for (int i = 0; i < 3; i++) {
    double p[3];

    vg_sub(x, corner[i], p);
    d[i][0] = vg_dot(u, p);
    d[i][1] = vg_dot(v, p);
  }
  va = d[1][0] * d[2][1] - d[2][0] * d[1][1];
  vb = d[2][0] * d[0][1] - d[0][0] * d[2][1];
  vc = d[0][0] * d[1][1] - d[1][0] * d[0][1];
  if (d[0][0] <= 0 && d[0][1] <= 0) {
    set_weights(w, 1, 0, 0);
  } else if (d[1][0] >= 0 && d[1][1] <= d[1][0]) {
    set_weights(w, 0, 1, 0);
  } else if (d[2][1] >= 0 && d[2][0] <= d[2][1]) {
    set_weights(w, 0, 0, 1);
  } else if (vc <= 0 && d[0][0] >= 0 && d[1][0] <= 0) {
    t = d[0][0] / (d[0][0] - d[1][0]);
    set_weights(w, 1 - t, t, 0);
  } else if (vb <= 0 && d[0][1] >= 0 && d[2][1] <= 0) {
    t = d[0][1] / (d[0][1] - d[2][1]);
    set_weights(w, 1 - t, 0, t);
  } else if (va <= 0) {
    t = d[1][1] - d[1][0];
    t /= t + d[2][0] - d[2][1];
    set_weights(w, 0, 1 - t, t);
  } else {
    t = va + vb + vc;
    set_weights(w, va / t, vb / t, vc / t);
  }
}
