/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Layers that are estimated from the walls and their growth laws instead of
 * being grown. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "run/plan/run_plan_parts.h"

/* Seconds on one core; docs/lab/performance-parallel.md, "Model". */
static const double layer_per_cell = 0.1e-6; /* growing and measuring */

struct lift {
  const struct vg_layer_stage *s;
  const struct vg_mesh *m;
  const struct vg_sizing *sizing;
  double (*normal)[3]; /* [n_point] */
  double *edge;        /* [n_point] sum, then mean of its edge lengths */
  uint32_t *n_edge;    /* [n_point] */
  uint32_t *patch;     /* [n_point] the wall whose growth law applies */
  uint16_t *level;     /* [n_point] */
};

static int is_wall(const struct lift *l, size_t tri)
{
  return l->s->reason[l->m->tri_patch[tri]] != VG_WALL_NOT;
}

static void add_triangle(struct lift *l, size_t i)
{
  const uint32_t *t = l->m->tri[i], patch = l->m->tri_patch[i];
  const struct vg_layer_request *q = l->s->request;
  double d[3][3], n[3];

  for (int k = 0; k < 3; k++) {
    vg_sub(l->m->point[t[(k + 1) % 3]], l->m->point[t[k]], d[k]);
    l->edge[t[k]] += vg_norm(d[k]);
    l->n_edge[t[k]]++;
  }
  vg_cross(d[0], d[1], n);
  for (int k = 0; k < 3; k++) {
    uint32_t *rules = &l->patch[t[k]];

    for (int j = 0; j < 3; j++) l->normal[t[k]][j] += n[j];
    if (*rules == VG_NO_INDEX || q[patch].law.delta1 < q[*rules].law.delta1)
      *rules = patch;
  }
}

/* The place x at height d above point i, and the target edge length along the
 * normal there. */
static double size_above(const struct lift *l, size_t i, double length,
                         double d, double x[3])
{
  const double *v = l->normal[i];
  double n[3];

  for (int k = 0; k < 3; k++) n[k] = v[k] / length;
  for (int k = 0; k < 3; k++) x[k] = l->m->point[i][k] + n[k] * d;
  return vg_sizing_is_stretched(l->sizing) ? vg_sizing_along(l->sizing, x, n)
                                           : vg_sizing_at(l->sizing, x);
}

/* Stack layers at a point by the rule of the layer module: until the next one
 * would be thicker than the local edge length, at the wall and at the top. In a
 * stretched field, edges of the wall are no measure of it. */
static void lift_point(struct lift *l, size_t i, double x[3])
{
  const struct vg_layer_request *q = &l->s->request[l->patch[i]];
  const struct vg_layer_options *o = &l->s->options;
  const int is_stretched = vg_sizing_is_stretched(l->sizing);
  double d[VG_LEVELS_MAX + 1], length;
  int n = 0, most = q->n_max > 0 && q->n_max < VG_LEVELS_MAX ? q->n_max
                                                             : VG_LEVELS_MAX;
  struct vg_growth_law law = q->law;

  if (o->law_at) o->law_at(o->law_user, l->m->point[i], &law);
  length = vg_norm(l->normal[i]);
  if (!(length > 0) || !(law.delta1 > 0)) return;
  vg_growth_law_heights(&law, INFINITY, most, d);
  while (n < most && !(q->total > 0 && d[n + 1] > q->total)) {
    const double h = is_stretched ? size_above(l, i, length, d[n + 1], x)
                                  : l->edge[i];

    if (!q->n_exact && !(d[n + 1] - d[n] <= o->end * h)) break;
    n++;
  }
  for (;; n--) {
    const double h = size_above(l, i, length, d[n], x);

    if (n == 0 || q->n_exact || d[n] - d[n - 1] <= o->end * h) break;
  }
  l->level[i] = (uint16_t)n;
}

static void measure_lift(struct vg_plan *p, struct lift *l)
{
  for (size_t i = 0; i < l->m->n_tri; i++)
    if (is_wall(l, i)) add_triangle(l, i);
  for (size_t i = 0; i < l->m->n_point; i++) {
    if (l->patch[i] == VG_NO_INDEX) continue;
    l->edge[i] /= l->n_edge[i];
    lift_point(l, i, p->lifted.point[i]);
    p->layer_point += l->level[i];
  }
  for (size_t i = 0; i < l->m->n_tri; i++)
    for (int k = 0; k < 3 && is_wall(l, i); k++)
      p->layer_tet += l->level[l->m->tri[i][k]];
}

vg_status vg_plan_lift(struct vg_plan *p, struct vg_error *err)
{
  const struct vg_mesh *m = &p->problem->boundary.surface;
  struct lift l = { .s = p->layers, .m = m, .sizing = p->sizing };
  vg_status st;

  VG_TRY(vg_mesh_copy(&p->lifted, m, err));
  l.normal = vg_calloc(m->n_point, sizeof *l.normal);
  l.edge = vg_calloc(m->n_point, sizeof *l.edge);
  l.n_edge = vg_calloc(m->n_point, sizeof *l.n_edge);
  l.patch = vg_alloc(m->n_point, sizeof *l.patch);
  l.level = vg_calloc(m->n_point, sizeof *l.level);
  if (!l.normal || !l.edge || !l.n_edge || !l.patch || !l.level) {
    st = vg_fail_memory(err, "the layers");
    goto done;
  }
  memset(l.patch, 0xff, m->n_point * sizeof *l.patch);
  measure_lift(p, &l);
  p->phase[VG_PHASE_LAYERS] += layer_per_cell * p->layer_tet;
  p->front = &p->lifted;
done:
  free(l.normal);
  free(l.edge);
  free(l.n_edge);
  free(l.patch);
  free(l.level);
  return st;
}
