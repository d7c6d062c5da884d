/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/sides/zone_line.h"

#include "core/geometry/predicates.h"

int vg_line_crosses(const double *const x[3], const double *a, const double *b)
{
  const double from = vg_orient3d(x[0], x[1], x[2], a);
  const double to = vg_orient3d(x[0], x[1], x[2], b);
  int n_positive = 0, n_negative = 0;

  if ((from > 0 && to > 0) || (from < 0 && to < 0)) return 0;
  for (int k = 0; k < 3; k++) {
    const double side = vg_orient3d(a, b, x[k], x[(k + 1) % 3]);

    n_positive += side > 0;
    n_negative += side < 0;
  }
  if (n_positive && n_negative) return 0;
  return n_positive + n_negative < 3 || from == 0 || to == 0 ? -1 : 1;
}

double vg_line_at(const double *const x[3], const double *a, const double *b)
{
  const double from = vg_orient3d(x[0], x[1], x[2], a);
  const double to = vg_orient3d(x[0], x[1], x[2], b);

  return from == to ? 0 : from / (from - to);
}

/* Steps of the golden ratio and of another irrational number fill the triangle
 * evenly. */
void vg_line_place(const double *const x[3], int i, double at[3])
{
  double u = .293 + .6180339887498949 * i, v = .346 + .4142135623730951 * i;

  u -= (int)u;
  v -= (int)v;
  if (u + v > 1) {
    u = 1 - u;
    v = 1 - v;
  }
  for (int d = 0; d < 3; d++)
    at[d] = (1 - u - v) * x[0][d] + u * x[1][d] + v * x[2][d];
}
