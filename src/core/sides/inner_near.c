/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Sheets that nearly touch a surface: triangles that no edge joins, with a gap
 * that is small compared with their edges. */
#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "core/geometry/nearest.h"
#include "core/geometry/vector.h"
#include "core/search/box_tree.h"
#include "core/sides/inner_parts.h"

/* S90: gaps as shares of the longest edge. A surface with a smaller gap than
 * WELDED is meant to touch: single precision alone moves points by 1e-7. */
#define NARROW 1e-3
#define WELDED 1e-6

struct near {
  const struct vg_inner_work *s;
  uint32_t sheet; /* the triangle that is compared with others */
  double edge;    /* its longest edge */
  double share;   /* smallest gap so far as a share of the longest edge */
  double gap;
  uint32_t tri[2]; /* the pair with that gap */
  size_t n, n_welded;
};

static double longest_edge(const struct vg_mesh *m, size_t t)
{
  const uint32_t *v = m->tri[t];
  double d2 = 0;

  for (int k = 0; k < 3; k++)
    d2 = fmax(d2, vg_distance2(m->point[v[k]], m->point[v[(k + 1) % 3]]));
  return sqrt(d2);
}

/* --- distance --------------------------------------------------------------
 */

/* Squared distance of the lines through a b and c d if their nearest points are
 * inside both segments, else INFINITY. */
static double between_edges2(const double *a, const double *b, const double *c,
                             const double *d)
{
  double u[3], v[3], w[3], n[3], p[3], q[3], n2, s, t, h;

  vg_sub(b, a, u);
  vg_sub(d, c, v);
  vg_sub(c, a, w);
  vg_cross(u, v, n);
  n2 = vg_dot(n, n);
  if (!(n2 > 0)) return INFINITY;
  vg_cross(w, v, p);
  vg_cross(w, u, q);
  s = vg_dot(p, n) / n2;
  t = vg_dot(q, n) / n2;
  if (s < 0 || s > 1 || t < 0 || t > 1) return INFINITY;
  h = vg_dot(w, n);
  return h * h / n2;
}

/* Distance of two triangles that do not intersect. */
static double between(const struct vg_mesh *m, const uint32_t *a,
                      const uint32_t *b)
{
  const double *x[3], *y[3];
  double d2 = INFINITY;

  for (int k = 0; k < 3; k++) x[k] = m->point[a[k]], y[k] = m->point[b[k]];
  for (int k = 0; k < 3; k++) {
    d2 = fmin(d2, vg_to_triangle2(x[k], y[0], y[1], y[2]));
    d2 = fmin(d2, vg_to_triangle2(y[k], x[0], x[1], x[2]));
    for (int l = 0; l < 3; l++)
      d2 = fmin(d2, between_edges2(x[k], x[(k + 1) % 3], y[l], y[(l + 1) % 3]));
  }
  return sqrt(d2);
}

/* --- search ----------------------------------------------------------------
 */

static int have_common(const uint32_t *a, const uint32_t *b)
{
  for (int k = 0; k < 9; k++)
    if (a[k / 3] == b[k % 3]) return 1;
  return 0;
}

/* Whether the triangles have a common point, or an edge joins them: then they
 * belong to one surface, which is narrow where it has short edges. */
static int are_joined(const struct vg_sides *s, uint32_t a, uint32_t b)
{
  for (int k = 0; k < 3; k++) {
    const uint32_t p = s->tri[a][k];

    for (uint32_t i = s->first[p]; i < s->first[p + 1]; i++)
      if (have_common(s->tri[s->corner[i] / 3], s->tri[b])) return 1;
  }
  return 0;
}

/* Each pair of sheets is compared once. */
static int compare(void *context, uint32_t t)
{
  struct near *x = context;
  const struct vg_mesh *m = x->s->m;
  double edge, gap;

  if (vg_is_sheet(x->s, t) && t >= x->sheet) return 0;
  edge = fmin(x->edge, longest_edge(m, t));
  gap = between(m, m->tri[x->sheet], m->tri[t]);
  if (gap >= NARROW * edge || are_joined(&x->s->sides, x->sheet, t)) return 0;
  x->n++;
  x->n_welded += gap < WELDED * edge;
  if (gap >= x->share * edge) return 0;
  x->share = gap / edge;
  x->gap = gap;
  x->tri[0] = x->sheet;
  x->tri[1] = t;
  return 0;
}

static struct vg_box box_of(const struct vg_mesh *m, size_t t, double margin)
{
  struct vg_box b = VG_BOX_EMPTY;

  for (int k = 0; k < 3; k++) vg_box_add(&b, m->point[m->tri[t][k]]);
  for (int k = 0; k < 3; k++) b.lo[k] -= margin, b.hi[k] += margin;
  return b;
}

static vg_status search(struct near *x, struct vg_error *err)
{
  const struct vg_mesh *m = x->s->m;
  struct vg_box_tree tree = VG_BOX_TREE_INIT;
  struct vg_box *box = vg_alloc(m->n_tri, sizeof *box);
  vg_status st = VG_OK;

  if (!box) return vg_fail_memory(err, "the gaps next to sheets");
  for (size_t t = 0; t < m->n_tri; t++) box[t] = box_of(m, t, 0);
  VG_TRY(vg_box_tree_build_items(&tree, m->n_tri, box, NULL, err));
  for (size_t t = 0; t < m->n_tri; t++) {
    struct vg_box reach;

    if (!vg_is_sheet(x->s, t)) continue;
    x->sheet = (uint32_t)t;
    x->edge = longest_edge(m, t);
    reach = box_of(m, t, NARROW * x->edge);
    vg_box_tree_touched(&tree, &reach, compare, x);
  }
done:
  vg_box_tree_release(&tree);
  free(box);
  return st;
}

vg_status vg_inner_near(const struct vg_inner_work *s, struct vg_error *err)
{
  struct near x = { .s = s, .share = INFINITY };
  struct vg_inner_report *r = s->report;
  const struct vg_mesh *m = s->m;
  const struct vg_patch *p, *q;
  vg_status st = search(&x, err);

  if (st < 0 || !x.n) return st;
  r->n_near = x.n;
  r->gap = x.gap;
  for (int k = 0; k < 3; k++)
    for (int d = 0; d < 3; d++)
      r->at[d] += m->point[m->tri[x.tri[0]][k]][d] / 3;
  if (!x.n_welded) return VG_OK;
  p = &m->patch[m->tri_patch[x.tri[0]]];
  q = &m->patch[m->tri_patch[x.tri[1]]];
  return vg_fail(
    err, VG_ERR_GEOMETRY,
    "patch %d%s%s, an inner surface, nearly touches patch %d%s%s: %zu pairs of "
    "triangles have no common point, but gaps below %g of their edges, the "
    "narrowest one of %.3g near (%g, %g, %g); merge the points in the surface "
    "file, so that they share edges, or move them apart",
    (int)p->id, *p->name ? " " : "", p->name, (int)q->id, *q->name ? " " : "",
    q->name, x.n_welded, WELDED, x.gap, r->at[0], r->at[1], r->at[2]);
}
