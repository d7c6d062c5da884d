/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Curved slide patches, as graphs over their mean plane. They are remeshed in
 * that plane, and new points are projected back onto the former triangles. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/predicates.h"
#include "core/geometry/vector.h"
#include "layers/slide/slide_parts.h"

/* No triangle may be inclined by more than 60 degrees to the mean plane. */
#define TILT 0.5 /* L16 */

void vg_slide_graph_release(struct vg_slide_graph *g)
{
  free(g->p);
  free(g->height);
  vg_box_tree_release(&g->tree);
  memset(g, 0, sizeof *g);
}

static int is_steep(const struct vg_mesh *m, uint32_t t, const double n[3])
{
  const uint32_t *v = m->tri[t];
  double a[3], b[3], c[3];

  vg_sub(m->point[v[1]], m->point[v[0]], a);
  vg_sub(m->point[v[2]], m->point[v[0]], b);
  vg_cross(a, b, c);
  return vg_dot(c, n) < TILT * vg_norm(c);
}

static struct vg_box project(struct vg_slide_graph *g, size_t i)
{
  double lo[2], hi[2];

  for (int k = 0; k < 3; k++) {
    const double *x = g->w->m->point[g->w->m->tri[g->tri[i]][k]];
    double d[3], *p = g->p[i][k];

    vg_slide_to_plane(&g->frame, x, p);
    vg_sub(x, g->frame.o, d);
    g->height[i][k] = vg_dot(d, g->frame.n);
    for (int j = 0; j < 2; j++) {
      lo[j] = k ? fmin(lo[j], p[j]) : p[j];
      hi[j] = k ? fmax(hi[j], p[j]) : p[j];
    }
  }
  return vg_slide_box(lo, hi);
}

vg_status vg_slide_graph(const struct vg_slide_work *w, size_t s,
                         struct vg_slide_graph *g)
{
  assert(s < w->n_part);

  const size_t n = w->tri_first[s + 1] - w->tri_first[s];
  struct vg_box *box;
  vg_status st = VG_ERR_MEMORY;

  memset(g, 0, sizeof *g);
  g->w = w;
  g->n = n;
  g->tri = w->tri + w->tri_first[s];
  vg_slide_frame(w, s, &g->frame);
  for (size_t i = 0; i < n; i++)
    if (is_steep(w->m, g->tri[i], g->frame.n)) return VG_BLOCKED;
  g->p = vg_alloc(n, sizeof *g->p);
  g->height = vg_alloc(n, sizeof *g->height);
  box = vg_alloc(n, sizeof *box);
  if (g->p && g->height && box) {
    for (size_t i = 0; i < n; i++) box[i] = project(g, i);
    st = vg_slide_tree(&g->tree, n, box, w->err);
  }
  free(box);
  if (st >= 0) {
    const struct vg_box *all = vg_box_tree_node(&g->tree, 0);

    g->extent = fmax(all->hi[0] - all->lo[0], all->hi[1] - all->lo[1]);
    return VG_OK;
  }
  vg_slide_graph_release(g);
  return vg_fail_memory(w->err, "a curved slide patch");
}

/* Visits the triangles of part s at the roots of columns with levels. Adds up
 * their area vectors if `normal` is NULL; otherwise counts those too steep
 * against `normal`. */
static size_t at_roots(const struct vg_slide_work *w, size_t s,
                       const double *normal, double sum[3])
{
  size_t n_steep = 0;

  for (uint32_t r = w->border_first[s]; r < w->border_first[s + 1]; r++) {
    const struct vg_column *c = &w->c->column[w->c->border[w->border[r]][0]];

    for (uint32_t j = w->first[c->root]; j < w->first[c->root + 1]; j++) {
      const uint32_t t = w->half[j] / 3, *v = w->m->tri[t];
      double a[3], b[3], n[3];

      if (!c->n || w->part_of[t] != s) continue;
      if (normal) {
        n_steep += (size_t)is_steep(w->m, t, normal);
        continue;
      }
      vg_sub(w->m->point[v[1]], w->m->point[v[0]], a);
      vg_sub(w->m->point[v[2]], w->m->point[v[0]], b);
      vg_cross(a, b, n);
      for (int k = 0; k < 3; k++) sum[k] += n[k];
    }
  }
  return n_steep;
}

void vg_slide_mark_steep(struct vg_slide_work *w, size_t s)
{
  double sum[3] = { 0 };
  int never;

  assert(s < w->n_part);
  at_roots(w, s, NULL, sum);
  never = !(vg_unit(sum) > 0) || at_roots(w, s, sum, NULL) > 0;
  vg_slide_mark_bad_all(w, s, "it is too curved to be remeshed");
  for (uint32_t r = w->border_first[s]; never && r < w->border_first[s + 1];
       r++)
    for (int k = 0; k < 2; k++) {
      const uint32_t i = w->c->border[w->border[r]][k];

      if (w->bad[i]) w->bad[i] = 2;
    }
}

/* Nearest triangle so far. */
struct nearest {
  const struct vg_slide_graph *g;
  const double *p;
  double d2, height;
  uint32_t item;
};

/* Squared distance to segment a b, and the parameter of the foot point. */
static double segment(const double a[2], const double b[2], const double p[2],
                      double *t)
{
  const double e[2] = { b[0] - a[0], b[1] - a[1] };
  const double d[2] = { p[0] - a[0], p[1] - a[1] };
  double x, y;

  *t = (d[0] * e[0] + d[1] * e[1]) / (e[0] * e[0] + e[1] * e[1]);
  *t = fmin(fmax(*t, 0), 1);
  x = d[0] - *t * e[0];
  y = d[1] - *t * e[1];
  return x * x + y * y;
}

static int visit(void *user, uint32_t i)
{
  struct nearest *best = user;
  const double(*q)[2] = (const double(*)[2])best->g->p[i];
  const double *z = best->g->height[i];
  double part[3], d2 = INFINITY, height = 0;
  int inside = 1;

  for (int k = 0; k < 3; k++) {
    part[k] = vg_orient2d(q[(k + 1) % 3], q[(k + 2) % 3], best->p);
    inside &= part[k] >= 0;
  }
  if (inside) {
    d2 = 0;
    height = (part[0] * z[0] + part[1] * z[1] + part[2] * z[2]) /
             (part[0] + part[1] + part[2]);
  }
  for (int k = 0; !inside && k < 3; k++) {
    const int l = (k + 1) % 3;
    double t;
    const double d = segment(q[k], q[l], best->p, &t);

    if (d < d2) {
      d2 = d;
      height = z[k] + t * (z[l] - z[k]);
    }
  }
  if (d2 > best->d2 || (d2 == best->d2 && i > best->item)) return 0;
  best->d2 = d2;
  best->height = height;
  best->item = i;
  return 0;
}

void vg_slide_lift(const struct vg_slide_graph *g, const double p[2],
                   double x[3])
{
  struct nearest best = { g, p, INFINITY, 0, VG_NO_INDEX };
  double reach = 0;

  /* All triangles within `reach` have been visited, so the nearest is final if
   * it is not farther than that. */
  for (int i = 0; i < 64; i++) {
    const double lo[2] = { p[0] - reach, p[1] - reach };
    const double hi[2] = { p[0] + reach, p[1] + reach };
    const struct vg_box box = vg_slide_box(lo, hi);

    vg_box_tree_touched(&g->tree, &box, visit, &best);
    if (best.d2 <= reach * reach) break;
    reach = i ? 4 * reach : 1e-6 * g->extent;
  }
  vg_slide_to_space(&g->frame, p, x);
  for (int k = 0; k < 3; k++) x[k] += best.height * g->frame.n[k];
}

/* Point of the patch at distance |step| from the root, above the line along
 * `step`. */
static void follow(const struct vg_slide_graph *g, const double root[3],
                   const double step[3], double x[3])
{
  const double want = vg_norm(step);
  double o[2], t = 1;
  const double d[2] = { vg_dot(step, g->frame.u), vg_dot(step, g->frame.v) };

  vg_slide_to_plane(&g->frame, root, o);
  for (int i = 0; i < 12; i++) {
    const double p[2] = { o[0] + t * d[0], o[1] + t * d[1] };
    double is;

    vg_slide_lift(g, p, x);
    is = vg_distance(x, root);
    if (!(is > 0) || fabs(is - want) <= 1e-9 * want) break;
    t *= want / is;
  }
}

static vg_status bend(struct vg_slide_work *w, uint32_t i,
                      const struct vg_slide_graph *g)
{
  struct vg_columns *cs = w->c;
  struct vg_column *c = &cs->column[i];
  const double *root = w->m->point[c->root];
  double d[VG_LEVELS_MAX + 1];

  if (vg_reserve(&cs->path, &w->cap_path, cs->n_path + c->n + 1,
                 sizeof *cs->path))
    return vg_fail_memory(w->err, "bent columns");
  vg_growth_law_heights(&cs->law[c->law], c->cap, c->n, d);
  c->bent = cs->n_path;
  memcpy(cs->path[cs->n_path++], root, 3 * sizeof *root);
  for (int l = 1; l <= c->n; l++) {
    double step[3];

    vg_column_at(c, root, d[l], step);
    vg_sub(step, root, step);
    follow(g, root, step, cs->path[cs->n_path++]);
  }
  memcpy(w->x[w->m->n_point + i], cs->path[cs->n_path - 1], 3 * sizeof(double));
  return VG_OK;
}

vg_status vg_slide_bend(struct vg_slide_work *w, size_t s,
                        const struct vg_slide_graph *g)
{
  assert(s < w->n_part);
  for (uint32_t r = w->border_first[s]; r < w->border_first[s + 1]; r++)
    for (int k = 0; k < 2; k++) {
      const uint32_t i = w->c->border[w->border[r]][k];
      vg_status st;

      if (!w->c->column[i].n || w->c->column[i].bent != SIZE_MAX) continue;
      st = bend(w, i, g);
      if (st != VG_OK) return st;
    }
  return VG_OK;
}
