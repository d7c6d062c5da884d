/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/remesh/metric.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "core/geometry/tensor.h"

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

/* --- the metric of a sizing field ----------------------------------------- */

/* Component of a form for each component of a tensor. */
static const int place[6] = { 0, 3, 5, 1, 4, 2 };

/* Eigenvalues of the metric in the plane normal to n, and its larger
 * eigenvalue's direction d within it. */
static void eigen_in_plane(const double metric[6], const double n[3],
                           double value[2], double d[3])
{
  double u[3], v[3], mu[3], mv[3], a, b, c, mean, gap, s, t;

  vg_normals(n, u, v);
  vg_tensor_apply(metric, u, mu);
  vg_tensor_apply(metric, v, mv);
  a = vg_dot(u, mu);
  b = vg_dot(u, mv);
  c = vg_dot(v, mv);
  mean = (a + c) / 2;
  gap = sqrt((a - c) * (a - c) / 4 + b * b);
  value[0] = fmax(mean - gap, 0);
  value[1] = mean + gap;
  /* Of two expressions for the eigenvector, the one without cancellation. */
  s = a > c ? value[1] - c : b;
  t = a > c ? b : value[1] - a;
  for (int k = 0; k < 3; k++) d[k] = s * u[k] + t * v[k];
  if (!(vg_unit(d) > 0)) memcpy(d, u, sizeof u);
}

/* Intersection of the metric, restricted to the plane normal to n, with the
 * same size in all directions. */
static void intersect_in_plane(const double metric[6], const double n[3],
                               struct vg_metric *m)
{
  const double least = 1 / (m->size * m->size);
  double value[2], d[3];

  eigen_in_plane(metric, n, value, d);
  for (int k = 0; k < 2; k++) value[k] = fmax(value[k], least);
  m->size = 1 / sqrt(value[1]);
  for (int k = 0; k < 3; k++) {
    const double rest = value[0] / value[1];

    m->form[k] = rest + (1 - rest) * d[k] * d[k];
    m->form[3 + k] = (1 - rest) * d[k] * d[(k + 1) % 3];
  }
}

/* The same metric in the plane normal to n, with the largest length of the
 * plane along n. */
static void restrict_to(double metric[6], const double n[3])
{
  struct vg_metric m = { .size = INFINITY };

  intersect_in_plane(metric, n, &m);
  for (int k = 0; k < 6; k++) metric[k] = m.form[place[k]] / (m.size * m.size);
}

static void intersect(const double metric[6], const double *n, int has_form,
                      struct vg_metric *m)
{
  double own[6], value[3], vector[3][3];

  vg_tensor_uniform(1 / (m->size * m->size), own);
  for (int k = 0; has_form && k < 6; k++)
    own[k] = m->form[place[k]] / (m->size * m->size);
  if (n) {
    double flat[6];

    memcpy(flat, metric, sizeof flat);
    restrict_to(flat, n);
    vg_metric_intersect(flat, own, own);
  } else vg_metric_intersect(metric, own, own);
  vg_tensor_eigen(own, value, vector);
  m->size = 1 / sqrt(value[2]);
  for (int k = 0; k < 6; k++) m->form[place[k]] = own[k] / value[2];
}

void vg_follow_field(const struct vg_sizing *field, const double x[3],
                     const double *n, double factor, int has_form,
                     struct vg_metric *m)
{
  double t[6], metric[6];

  assert(field && factor > 0 && m->size > 0);
  vg_sizing_stretch_at(field, x, t);
  for (int k = 0; k < 6; k++) t[k] /= factor;
  vg_tensor_square(t, metric);
  if (n && vg_dot(n, n) == 0) n = NULL; /* too flat to have a normal */
  if (n && !has_form) intersect_in_plane(metric, n, m);
  else intersect(metric, n, has_form, m);
}
