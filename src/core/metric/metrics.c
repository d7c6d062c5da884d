/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/metric/metrics.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

void vg_metric_at(const struct vg_sizing *sizing, const double x[3],
                  struct vg_point_metric *out)
{
  double t[6];

  vg_sizing_stretch_at(sizing, x, t);
  out->root = vg_tensor_det(t);
  vg_tensor_square(t, out->m);
}

int vg_metrics_add(struct vg_metrics *s, const struct vg_tets *t, size_t from,
                   size_t n)
{
  assert(from <= n && n <= t->n_point);
  if (vg_reserve(&s->at, &s->cap, n, sizeof *s->at)) return -1;
  for (size_t i = from; i < n; i++) vg_metric_at(s->sizing, t->x[i], &s->at[i]);
  return 0;
}

void vg_metrics_release(struct vg_metrics *s)
{
  free(s->at);
  s->at = NULL;
  s->cap = 0;
}

double vg_metric_shape(const struct vg_point_metric *m, const double a[3],
                       const double b[3], const double c[3], const double d[3])
{
  double u[3], v[3], w[3], n[3], det, uu, vv, ww, sum, volume;
  double mu[3], mv[3], mw[3];

  vg_sub(b, a, u);
  vg_sub(c, a, v);
  vg_sub(d, a, w);
  vg_cross(u, v, n);
  det = vg_dot(n, w);
  if (!(det > 0) ||
      det * det < 1e-26 * vg_dot(u, u) * vg_dot(v, v) * vg_dot(w, w))
    return 0;
  vg_tensor_apply(m->m, u, mu);
  vg_tensor_apply(m->m, v, mv);
  vg_tensor_apply(m->m, w, mw);
  uu = vg_dot(u, mu);
  vv = vg_dot(v, mv);
  ww = vg_dot(w, mw);
  /* |v - u|^2 = uu + vv - 2 uv, and so on. */
  sum = 3 * (uu + vv + ww) -
        2 * (vg_dot(u, mv) + vg_dot(v, mw) + vg_dot(w, mu));
  volume = 0.5 * det * m->root; /* 3 V */
  return 1728 * volume * volume / (sum * sum * sum);
}
