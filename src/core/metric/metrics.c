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

  vg_sizing_stretch_at(sizing, x, t);
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
