/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Triangles of two surfaces that overlap in one plane. Declared in
 * core/junction/junction.h. */
#include <math.h>

#include "core/geometry/vector.h"
#include "core/junction/junction.h"

/* Share of the smaller triangle that must be covered: less is rounding where
 * two surfaces meet along an edge. */
#define COVERED 1e-6

enum { MOST = 9 }; /* corners of a triangle that three lines cut */

static double normal_of(const double x[3][3], double n[3])
{
  double u[3], v[3];

  vg_sub(x[1], x[0], u);
  vg_sub(x[2], x[0], v);
  vg_cross(u, v, n);
  return vg_unit(n);
}

/* Cut a polygon of n corners off at the line through a with the normal `out`.
 * Returns its number of corners. */
static int cut(double (*p)[3], int n, const double a[3], const double out[3])
{
  double old[MOST][3], height[MOST];
  int m = 0;

  for (int i = 0; i < n; i++) {
    double d[3];

    for (int k = 0; k < 3; k++) old[i][k] = p[i][k];
    vg_sub(p[i], a, d);
    height[i] = vg_dot(d, out);
  }
  for (int i = 0; i < n; i++) {
    const int j = (i + 1) % n;

    if (height[i] <= 0) {
      for (int k = 0; k < 3; k++) p[m][k] = old[i][k];
      m++;
    }
    if ((height[i] < 0 && height[j] > 0) || (height[i] > 0 && height[j] < 0)) {
      const double share = height[i] / (height[i] - height[j]);

      for (int k = 0; k < 3; k++)
        p[m][k] = old[i][k] + share * (old[j][k] - old[i][k]);
      m++;
    }
  }
  return m;
}

/* Twice the area of a polygon. */
static double area_of(double (*p)[3], int n)
{
  double sum[3] = { 0, 0, 0 };

  for (int i = 2; i < n; i++) {
    double u[3], v[3], w[3];

    vg_sub(p[i - 1], p[0], u);
    vg_sub(p[i], p[0], v);
    vg_cross(u, v, w);
    for (int k = 0; k < 3; k++) sum[k] += w[k];
  }
  return vg_norm(sum);
}

int vg_junction_overlap(const double s[3][3], const double t[3][3], double most)
{
  double n[3], m[3], p[MOST][3];
  const double area = normal_of(s, n), other = normal_of(t, m);
  int corners = 3;

  if (!(area > 0) || !(other > 0)) return 0;
  for (int i = 0; i < 3; i++) {
    double d[3];

    vg_sub(t[i], s[0], d);
    if (fabs(vg_dot(d, n)) > most) return 0;
    for (int k = 0; k < 3; k++) p[i][k] = t[i][k];
  }
  for (int i = 0; i < 3 && corners; i++) {
    double e[3], out[3];

    vg_sub(s[(i + 1) % 3], s[i], e);
    vg_cross(e, n, out);
    corners = cut(p, corners, s[i], out);
  }
  return area_of(p, corners) > COVERED * fmin(area, other);
}
