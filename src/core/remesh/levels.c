/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/remesh/levels.h"

#include <assert.h>
#include <math.h>

#include "base/parallel.h"
#include "core/geometry/vector.h"
#include "core/remesh/follow.h"

#define SAMPLES 65536 /* least number of points at which sizes are sampled */
#define LEVELS 8      /* most levels before the last one */

/* Sizes are sampled at the centroids of n * n triangles in each triangle. */
static double triangles_in(const struct vg_ref *r, uint32_t t, int n,
                           const struct vg_sizing *field, double h_max)
{
  const struct vg_ref_tri *s = &r->shape[t];
  const uint32_t *v = r->tri[t];
  double sum = 0, area[3];

  for (int i = 0; i < n; i++)
    for (int k = 0; k < 2 * (n - i) - 1; k++) {
      const double a = (i + (1 + k % 2) / 3.0) / n;
      const double b = (k / 2 + (1 + k % 2) / 3.0) / n;
      struct vg_metric m;
      double x[3];

      for (int d = 0; d < 3; d++) x[d] = s->a[d] + a * s->u[d] + b * s->v[d];
      m.size = fmin(h_max, (1 - a - b) * r->size[v[0]] + a * r->size[v[1]] +
                             b * r->size[v[2]]);
      vg_follow_field(field, x, s->n, 1, 0, &m);
      sum += sqrt(vg_form_area2(m.form, s->n)) / (m.size * m.size);
    }
  vg_cross(s->u, s->v, area);
  return sum / (n * n) * vg_norm(area) / 0.8660254037844386;
}

int vg_levels_number(const struct vg_ref *r, const struct vg_sizing *field,
                     double h_max)
{
  const double each = SAMPLES / (double)r->n_tri;
  double n = 0, most = 4 * (double)r->n_tri;
  int level = 0;

  if (!field) return 0;
  for (uint32_t t = 0; t < r->n_tri; t++)
    n += triangles_in(r, t, each > 1 ? (int)ceil(sqrt(each)) : 1, field, h_max);
  for (; level < LEVELS && n > most; n /= 4) level++;
  return level;
}

static void ask_again(void *context, size_t first, size_t end, int worker)
{
  struct vg_tris *w = context;

  (void)worker;
  for (size_t p = first; p < end && !vg_stops(&w->stop); p++) {
    struct vg_tris_point *q = &w->point[p];

    if (q->half == VG_REF_NONE) continue;
    vg_tris_ask(w, q, vg_tris_size(w, q->x, &q->by));
  }
}

vg_status vg_levels_set(struct vg_tris *w, double factor, struct vg_error *err)
{
  assert(w->field && factor >= 1);

  w->coarse = factor;
  vg_parallel_for(w->threads, w->n_point, 1024, ask_again, w);
  w->clock++;
  for (size_t p = 0; p < w->n_point; p++) w->point[p].changed = w->clock;
  for (size_t t = 0; t < w->n_tri; t++) w->stamp[t] = w->clock;
  return vg_stopped(&w->stop, err);
}
