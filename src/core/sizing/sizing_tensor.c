/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/sizing/sizing_tensor.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "core/geometry/tensor.h"
#include "core/geometry/vector.h"

void vg_size_grow(const double h[6], const double way[3], double slope,
                  double out[6])
{
  double t[6], v[3], factor, more, det = vg_tensor_adjugate(h, t);

  vg_tensor_apply(t, way, v);
  factor = 1 + VG_GROWTH_IN_METRIC * slope * (vg_norm(v) / det);
  more = (1 - VG_GROWTH_IN_METRIC) * slope * vg_norm(way);
  for (int k = 0; k < 6; k++) out[k] = factor * h[k];
  out[0] += more;
  out[3] += more;
  out[5] += more;
}

/* The unit ball of h is within that of `most` if most^2 - h^2 is positive
 * semidefinite. */
int vg_size_is_within(const double h[6], const double most[6], double within)
{
  double a[6], b[6], factor = (1 + within) * (1 + within);

  vg_tensor_square(h, a);
  vg_tensor_square(most, b);
  for (int k = 0; k < 6; k++) b[k] = factor * b[k] - a[k];
  return b[0] >= 0 && b[3] >= 0 && b[5] >= 0 && b[0] * b[3] >= b[1] * b[1] &&
         b[0] * b[5] >= b[2] * b[2] && b[3] * b[5] >= b[4] * b[4] &&
         vg_tensor_det(b) >= 0;
}

void vg_size_metric(const double h[6], double m[6])
{
  double t[6];

  vg_tensor_invert(h, t);
  vg_tensor_square(t, m);
}

void vg_size_intersect(const double a[6], const double b[6], double out[6])
{
  double m[6], n[6];

  vg_size_metric(a, m);
  vg_size_metric(b, n);
  vg_metric_intersect(m, n, m);
  vg_tensor_root(m, m);
  vg_tensor_invert(m, out);
}

static int is_multiple(const double h[6])
{
  return h[1] == 0 && h[2] == 0 && h[4] == 0 && h[0] == h[3] && h[0] == h[5];
}

int vg_size_is_uniform(const float h[6])
{
  return h[1] == 0 && h[2] == 0 && h[4] == 0 && h[0] == h[3] && h[0] == h[5];
}

void vg_size_axes_of(const double h[6], struct vg_size_axes *a)
{
  if (is_multiple(h)) a->size[0] = a->size[1] = a->size[2] = h[0];
  else vg_tensor_eigen(h, a->size, a->axis);
}

void vg_size_axes_of_metric(const double m[6], struct vg_size_axes *a)
{
  vg_size_axes_of(m, a);
  for (int k = 0; k < 3; k++) a->size[k] = 1 / sqrt(fmax(a->size[k], 0));
}

void vg_size_axes_tensor(const struct vg_size_axes *a, double h[6])
{
  if (vg_size_axes_are_equal(a)) vg_tensor_uniform(a->size[0], h);
  else vg_tensor_from_eigen(a->size, (const double(*)[3])a->axis, h);
}

void vg_size_axes_metric(const struct vg_size_axes *a, double m[6])
{
  double value[3];

  for (int k = 0; k < 3; k++) value[k] = 1 / (a->size[k] * a->size[k]);
  if (vg_size_axes_are_equal(a)) vg_tensor_uniform(value[0], m);
  else vg_tensor_from_eigen(value, (const double(*)[3])a->axis, m);
}

int vg_size_axes_limit(struct vg_size_axes *a, const struct vg_size_limits *l,
                       double range[2])
{
  double low = vg_size_axes_least(a), high;
  int changed = 0;

  assert(l->least <= l->most && l->aspect >= 1);
  low = vg_lesser(vg_greater(low, l->least), l->most);
  high = vg_lesser(l->aspect * low, l->most);
  range[0] = range[1] = low;
  for (int k = 0; k < 3; k++) {
    double v = vg_lesser(vg_greater(a->size[k], low), high);

    changed |= v != a->size[k];
    a->size[k] = v;
    range[1] = vg_greater(range[1], v);
  }
  return changed;
}

void vg_size_from_metric(const double m[6], const struct vg_size_limits *l,
                         double out[6], double range[2])
{
  struct vg_size_axes a;

  vg_size_axes_of_metric(m, &a);
  vg_size_axes_limit(&a, l, range);
  vg_size_axes_tensor(&a, out);
}

void vg_size_limit(double h[6], const struct vg_size_limits *l, double range[2])
{
  struct vg_size_axes a;

  vg_size_axes_of(h, &a);
  if (vg_size_axes_limit(&a, l, range)) vg_size_axes_tensor(&a, h);
}

double vg_size_error(const double h[6], const double exact[6])
{
  static const int at[3][3] = { { 0, 1, 2 }, { 1, 3, 4 }, { 2, 4, 5 } };
  double t[6], most = 0, det = vg_tensor_adjugate(exact, t);

  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      double sum = i == j ? -det : 0;

      for (int k = 0; k < 3; k++) sum += t[at[i][k]] * h[at[k][j]];
      most = vg_greater(most, fabs(sum));
    }
  return most / det;
}

double vg_size_mean(const double h[6])
{
  return vg_cube_root(vg_tensor_det(h));
}
