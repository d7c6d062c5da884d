/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Moves the points of a wrap onto the input where the wrap stays sound. Around
 * a convex edge the nearest point is on the edge, so that sharp edges and
 * corners are restored. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "core/surface/surface_check.h"
#include "core/wrap/wrap_parts.h"

#define ROUNDS 8  /* until triangles no longer intersect */
#define TURN 0.3  /* S41: cosine of the largest turn of a triangle */
#define FLAT 0.02 /* least remaining height over longest edge */

struct fit {
  struct vg_mesh *m;
  double (*old)[3]; /* [n_point] Positions in the wrap. */
  const double (*near)[3];
  uint8_t *moved; /* [n_point] 1: moved onto the input. */
};

static void normal(const struct vg_mesh *m, const double (*x)[3], size_t t,
                   double n[3])
{
  double u[3], v[3];

  vg_sub(x[m->tri[t][1]], x[m->tri[t][0]], u);
  vg_sub(x[m->tri[t][2]], x[m->tri[t][0]], v);
  vg_cross(u, v, n);
}

static int stands(const struct fit *f, size_t t)
{
  const struct vg_mesh *m = f->m;
  double before[3], after[3], longest2 = 0, area;

  normal(m, (const double(*)[3])f->old, t, before);
  normal(m, (const double(*)[3])m->point, t, after);
  for (int k = 0; k < 3; k++)
    longest2 = fmax(longest2, vg_distance2(m->point[m->tri[t][k]],
                                           m->point[m->tri[t][(k + 1) % 3]]));
  area = vg_norm(after);
  return area > FLAT * longest2 &&
         vg_dot(before, after) > TURN * vg_norm(before) * area;
}

/* Move the corners of triangle t back to their positions in the wrap. */
static size_t give_up(struct fit *f, size_t t)
{
  size_t n = 0;

  for (int k = 0; k < 3; k++) {
    uint32_t p = f->m->tri[t][k];

    if (!f->moved[p]) continue;
    f->moved[p] = 0;
    memcpy(f->m->point[p], f->old[p], sizeof f->old[p]);
    n++;
  }
  return n;
}

static void settle(struct fit *f)
{
  size_t n = 1;

  while (n) {
    n = 0;
    for (size_t t = 0; t < f->m->n_tri; t++)
      if (!stands(f, t)) n += give_up(f, t);
  }
}

/* Move points of intersecting triangles back. *n: number of points. */
static vg_status part(struct fit *f, const struct vg_stop *stop, size_t *n,
                      struct vg_error *err)
{
  struct vg_surface_check_options o = { .external = 1, .threads = 1 };
  struct vg_surface_report r = VG_SURFACE_REPORT_INIT;
  vg_status st;

  if (stop) o.stop = *stop;
  st = vg_surface_check(f->m, &o, &r, err);
  *n = 0;
  for (size_t i = 0; i < r.n_defect && st >= 0; i++)
    for (int k = 0; k < 2; k++)
      if (r.defect[i].face[k] != SIZE_MAX)
        *n += give_up(f, r.defect[i].face[k]);
  vg_surface_report_release(&r);
  return st;
}

vg_status vg_wrap_fit(struct vg_mesh *m, const double (*near)[3], double most,
                      const struct vg_stop *stop, size_t *n_fit,
                      struct vg_error *err)
{
  struct fit f = { .m = m, .near = near };
  size_t n = 1;
  vg_status st = VG_OK;

  assert((near || !m->n_point) && most >= 0 && n_fit);
  f.old = vg_alloc(m->n_point, sizeof *f.old);
  f.moved = vg_calloc(m->n_point, 1);
  if (!f.old || !f.moved) VG_TRY(vg_fail_memory(err, "a wrap"));
  memcpy(f.old, m->point, m->n_point * sizeof *f.old);
  for (size_t p = 0; p < m->n_point; p++) {
    if (!(vg_distance(near[p], f.old[p]) <= most)) continue;
    f.moved[p] = 1;
    memcpy(m->point[p], near[p], sizeof near[p]);
  }
  for (int round = 0; n && round < ROUNDS; round++) {
    settle(&f);
    VG_TRY(part(&f, stop, &n, err));
  }
  if (n) /* the original wrap has no intersections */
    memcpy(m->point, f.old, m->n_point * sizeof *f.old);
  *n_fit = 0;
  for (size_t p = 0; p < m->n_point && !n; p++) *n_fit += f.moved[p];
done:
  free(f.old);
  free(f.moved);
  return st;
}
