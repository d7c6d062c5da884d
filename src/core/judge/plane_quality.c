/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/judge/plane_quality.h"

#include <math.h>
#include <stdlib.h>

#include "base/memory.h"

#define DEGREES 57.29577951308232

/* Angle at b between a and c, in degrees. */
static double angle_at(const double a[2], const double b[2], const double c[2])
{
  const double u[2] = { a[0] - b[0], a[1] - b[1] };
  const double v[2] = { c[0] - b[0], c[1] - b[1] };

  return DEGREES *
         atan2(fabs(u[0] * v[1] - u[1] * v[0]), u[0] * v[0] + u[1] * v[1]);
}

/* Smallest and largest angle of a cell with n corners. */
static void angles(const struct vg_plane_mesh *m, int n, const uint32_t *v,
                   double *least, double *most)
{
  *least = INFINITY;
  *most = 0;
  for (int k = 0; k < n; k++) {
    const double a = angle_at(m->x[v[(k + n - 1) % n]], m->x[v[k]],
                              m->x[v[(k + 1) % n]]);

    *least = fmin(*least, a);
    *most = fmax(*most, a);
  }
}

static int by_value(const void *a, const void *b)
{
  const double *p = a, *q = b;

  return (*p > *q) - (*p < *q);
}

static void judge_field(const struct vg_plane_mesh *m, double *least,
                        struct vg_plane_report *r)
{
  size_t worst = 0;

  for (size_t i = 0; i < r->n_field; i++) {
    double most;

    angles(m, 3, m->tri[m->n_layer_tri + i], &least[i], &most);
    r->angle_max = fmax(r->angle_max, most);
    if (least[i] < least[worst]) worst = i;
    for (int k = 0; k < VG_PLANE_LIMITS; k++)
      r->n_below[k] += least[i] < vg_plane_limit[k];
  }
  if (!r->n_field) return;
  for (int k = 0; k < 2; k++) {
    const uint32_t *v = m->tri[m->n_layer_tri + worst];

    r->at[k] = (m->x[v[0]][k] + m->x[v[1]][k] + m->x[v[2]][k]) / 3;
  }
  qsort(least, r->n_field, sizeof *least, by_value);
  r->angle_min = least[0];
  r->angle_percentile = least[r->n_field / 100];
}

vg_status vg_plane_judge(const struct vg_plane_mesh *m,
                         struct vg_plane_report *out, struct vg_error *err)
{
  struct vg_plane_report r = { .n_point = m->n_point,
                               .n_tri = m->n_tri,
                               .n_quad = m->n_quad,
                               .n_layer_tri = m->n_layer_tri,
                               .n_field = m->n_tri - m->n_layer_tri };
  double *least = vg_alloc(r.n_field, sizeof *least);

  if (!least) return vg_fail_memory(err, "the angles of the mesh");
  judge_field(m, least, &r);
  free(least);
  for (size_t i = 0; i < m->n_quad; i++) {
    double low, high;

    angles(m, 4, m->quad[i], &low, &high);
    r.quad_min = i ? fmin(r.quad_min, low) : low;
    r.quad_max = fmax(r.quad_max, high);
  }
  *out = r;
  return VG_OK;
}
