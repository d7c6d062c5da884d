/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/metric/metrics.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

void vg_metric_of_stretch(const double t[6], struct vg_point_metric *out)
{
  out->root = vg_tensor_det(t);
  vg_tensor_square(t, out->m);
}

void vg_metric_at(const struct vg_sizing *sizing, const double x[3],
                  struct vg_point_metric *out)
{
  double t[6];

  vg_sizing_tensor_at(sizing, x, t);
  vg_tensor_invert(t, t);
  vg_metric_of_stretch(t, out);
}

int vg_metrics_reserve(struct vg_metrics *s, size_t n)
{
  return vg_reserve(&s->at, &s->cap, n, sizeof *s->at);
}

int vg_metrics_add(struct vg_metrics *s, const struct vg_tets *t, size_t from,
                   size_t n)
{
  assert(from <= n && n <= t->n_point);
  if (vg_metrics_reserve(s, n)) return -1;
  for (size_t i = from; i < n; i++) vg_metric_at(s->sizing, t->x[i], &s->at[i]);
  return 0;
}

/* A determinant of 0 marks points without metric. */
static void add_corners(struct vg_metrics *s, const struct vg_tets *t)
{
  for (size_t c = 0; c < t->n_cell; c++)
    for (int i = 0; i < 4; i++) {
      uint32_t p = t->cell[c].v[i];

      if (s->at[p].root == 0) vg_metric_at(s->sizing, t->x[p], &s->at[p]);
    }
}

vg_status vg_metrics_of_corners(const struct vg_sizing *sizing,
                                const struct vg_tets *t,
                                struct vg_metrics **out)
{
  struct vg_metrics *s;

  assert(sizing && out);
  *out = NULL;
  if (!vg_sizing_is_stretched(sizing)) return VG_OK;
  s = vg_calloc(1, sizeof *s);
  if (s) s->at = vg_calloc(t->n_point, sizeof *s->at);
  if (!s || !s->at) {
    free(s);
    return VG_ERR_MEMORY;
  }
  s->sizing = sizing;
  s->cap = t->n_point;
  add_corners(s, t);
  *out = s;
  return VG_OK;
}

void vg_metrics_free(struct vg_metrics *s)
{
  if (s) vg_metrics_release(s);
  free(s);
}

vg_status vg_metrics_insert(struct vg_metrics *s, struct vg_inserter *in,
                            const double x[3], const struct vg_point_metric *m,
                            uint32_t cell, double clearance, double nearest,
                            struct vg_error *err)
{
  struct vg_tets *t = in->t;
  uint32_t p = (uint32_t)t->n_point;
  vg_status st;

  if (vg_tets_reserve_points(t, 1) || vg_metrics_reserve(s, p + 1))
    return vg_fail_memory(err, "the points of the mesh");
  memcpy(t->x[p], x, sizeof *t->x);
  s->at[p] = *m;
  t->n_point++;
  in->metric = s->at;
  st = vg_insert(in, p, cell, clearance, nearest, err);
  if (st != VG_OK) t->n_point--;
  return st;
}

void vg_metrics_release(struct vg_metrics *s)
{
  free(s->at);
  s->at = NULL;
  s->cap = 0;
}

/* For face vectors e, f: (T e) x (T f) = det(T) T^(-1) (e x f). */
double vg_metric_normal(const struct vg_point_metric *m, double n[3])
{
  double inverse[6];

  if (!(vg_tensor_invert(m->m, inverse) > 0)) return 0;
  vg_tensor_apply(inverse, n, n);
  for (int k = 0; k < 3; k++) n[k] *= m->root;
  return sqrt(fmax(vg_tensor_form(m->m, n), 0));
}

int vg_metric_apex(const struct vg_sizing *sizing, const double x[3],
                   const double y[3], const double z[3], double c[3],
                   double h[6], double unit[3])
{
  double t[6], e[3], f[3], length;

  for (int k = 0; k < 3; k++) c[k] = (x[k] + y[k] + z[k]) / 3;
  vg_sizing_stretch_at(sizing, c, t);
  vg_tensor_invert(t, h);
  vg_sub(y, x, e);
  vg_sub(z, x, f);
  vg_tensor_apply(t, e, e);
  vg_tensor_apply(t, f, f);
  vg_cross(e, f, unit);
  length = vg_norm(unit);
  for (int k = 0; k < 3; k++) unit[k] *= VG_METRIC_APEX / length;
  return length > 0;
}
