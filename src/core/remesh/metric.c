/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/remesh/metric.h"

#include <assert.h>

void vg_form_stretch(double *form, const double d[3], double by)
{
  const double less = 1 - 1 / (by * by);

  assert(form && by >= 1);
  assert(by == 1 || fabs(vg_dot(d, d) - 1) < 1e-6);
  for (int k = 0; k < 3; k++) {
    form[k] = 1 - less * d[k] * d[k];
    form[3 + k] = -less * d[k] * d[(k + 1) % 3];
  }
}

void vg_form_frame(const double *form, double u[3], double v[3])
{
  double l = vg_form_norm(form, u), along;

  for (int k = 0; k < 3; k++) u[k] /= l;
  along = vg_form_dot(form, u, v);
  for (int k = 0; k < 3; k++) v[k] -= along * u[k];
  l = vg_form_norm(form, v);
  for (int k = 0; k < 3; k++) v[k] /= l;
}

/* From the eigenvalues of the form restricted to the plane, by trace and
 * determinant. */
double vg_form_aspect(const double *form, const double n[3])
{
  assert(vg_dot(n, n) > 0);

  double u[3] = { 0, 0, 0 }, v[3], a, b, c, mean, gap;
  int k = fabs(n[0]) < fabs(n[1]) ? 0 : 1;

  if (fabs(n[2]) < fabs(n[k])) k = 2;
  u[k] = 1;
  vg_cross(n, u, v);
  vg_cross(v, n, u);
  if (!(vg_unit(u) > 0) || !(vg_unit(v) > 0)) return 1;
  a = vg_form_dot(form, u, u);
  b = vg_form_dot(form, u, v);
  c = vg_form_dot(form, v, v);
  mean = (a + c) / 2;
  gap = sqrt((a - c) * (a - c) / 4 + b * b);
  return mean > gap ? sqrt((mean + gap) / (mean - gap)) : INFINITY;
}
