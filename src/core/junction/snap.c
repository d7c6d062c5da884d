/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Outline: points of sheets near a sharp edge of the walls move onto it, and
 * become points of the walls. Points of the walls near an edge of a sheet
 * between two such points become points of the sheet. The sheet then has the
 * edges of the walls. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "core/junction/junction_parts.h"
#include "core/mesh/edges.h"
#include "core/search/box_tree.h"

#define SHARP 0.7660444431189780 /* S105: cos 40 degrees between the faces */

/* Edges of a mesh, and the places on them at which they are split. */
struct targets {
  struct vg_mesh *m;
  uint32_t (*edge)[2];
  size_t n, n_split, cap_split;
  struct split *split;
  struct vg_box_tree tree;
};

struct split {
  uint32_t edge, point; /* Point of the other mesh. */
  double at;            /* Distance from the first point of the edge. */
};

static void release(struct targets *g)
{
  free(g->edge);
  free(g->split);
  vg_box_tree_release(&g->tree);
}

static int is_sharp(const struct vg_mesh *m, const uint32_t *half)
{
  double n[2][3];

  for (int k = 0; k < 2; k++) {
    const uint32_t *v = m->tri[half[k] / 3];
    double a[3], b[3];

    vg_sub(m->point[v[1]], m->point[v[0]], a);
    vg_sub(m->point[v[2]], m->point[v[0]], b);
    vg_cross(a, b, n[k]);
    if (!(vg_unit(n[k]) > 0)) return 0;
  }
  return vg_dot(n[0], n[1]) < SHARP;
}

/* Lists the sharp edges of g->m or, with `on` [n_point], those between two
 * marked points. */
static vg_status list_edges(struct targets *g, const uint8_t *on,
                            struct vg_error *err)
{
  const struct vg_mesh *m = g->m;
  const uint32_t(*tri)[3] = (const uint32_t(*)[3])m->tri;
  struct vg_edges e = VG_EDGES_INIT;
  struct vg_box *box = NULL;
  vg_status st;

  VG_TRY(vg_edges_build(&e, m->n_point, m->n_tri, tri, NULL, 0, err));
  g->edge = vg_alloc(e.n, sizeof *g->edge);
  box = vg_alloc(e.n, sizeof *box);
  if (!g->edge || !box) VG_TRY(vg_fail_memory(err, "the inner surfaces"));
  for (size_t i = 0; i < e.n; i++) {
    const uint32_t *h = vg_edges_at(&e, i);
    const uint32_t a = vg_half_from(tri, h[0]), b = vg_half_to(tri, h[0]);

    if (on ? !on[a] || !on[b] : vg_edges_count(&e, i) != 2 || !is_sharp(m, h))
      continue;
    box[g->n] = (struct vg_box)VG_BOX_EMPTY;
    vg_box_add(&box[g->n], m->point[a]);
    vg_box_add(&box[g->n], m->point[b]);
    g->edge[g->n][0] = a;
    g->edge[g->n++][1] = b;
  }
  VG_TRY(vg_box_tree_build_items(&g->tree, g->n, box, NULL, err));
done:
  free(box);
  vg_edges_release(&e);
  return st;
}

/* The nearest edge within a distance. */
struct nearest {
  const struct targets *g;
  const double *x;
  double best2, at, foot[3];
  uint32_t edge;
};

static int approach(void *context, uint32_t i)
{
  struct nearest *q = context;
  const double *a = q->g->m->point[q->g->edge[i][0]];
  const double *b = q->g->m->point[q->g->edge[i][1]];
  double u[3], v[3], uu, t, foot[3], d2;

  vg_sub(b, a, u);
  vg_sub(q->x, a, v);
  uu = vg_dot(u, u);
  t = uu > 0 ? fmin(fmax(vg_dot(u, v) / uu, 0), 1) : 0;
  for (int d = 0; d < 3; d++) foot[d] = (1 - t) * a[d] + t * b[d];
  d2 = vg_distance2(foot, q->x);
  if (!(d2 < q->best2) && !(d2 <= q->best2 && i < q->edge)) return 0;
  q->best2 = d2;
  q->edge = i;
  q->at = t * sqrt(uu);
  memcpy(q->foot, foot, sizeof q->foot);
  return 0;
}

static int find(const struct targets *g, const double x[3], double most,
                struct nearest *q)
{
  struct vg_box box = VG_BOX_EMPTY;

  *q = (struct nearest){ .g = g, .x = x, .edge = VG_JUNCTION_NONE };
  q->best2 = most * most;
  vg_box_add(&box, x);
  for (int d = 0; d < 3; d++) {
    box.lo[d] -= most;
    box.hi[d] += most;
  }
  vg_box_tree_touched(&g->tree, &box, approach, q);
  return q->edge != VG_JUNCTION_NONE;
}

static vg_status add_split(struct targets *g, const struct split *s,
                           struct vg_error *err)
{
  if (vg_reserve(&g->split, &g->cap_split, g->n_split + 1, sizeof *g->split))
    return vg_fail_memory(err, "the inner surfaces");
  g->split[g->n_split++] = *s;
  return VG_OK;
}

static int compare_splits(const void *a, const void *b)
{
  const struct split *p = a, *q = b;

  if (p->edge != q->edge) return p->edge < q->edge ? -1 : 1;
  if (p->at < q->at || p->at > q->at) return p->at < q->at ? -1 : 1;
  return (p->point > q->point) - (p->point < q->point);
}

/* Splits the edges at points of `from`, which move to points that are there
 * already, at most `most` away, if moves is 1. */
static vg_status split_edges(struct targets *g, struct vg_mesh *from,
                             double most, int moves, struct vg_error *err)
{
  struct vg_junction_sheet s = { .m = NULL };
  vg_status st;

  if (!g->n_split) return VG_OK;
  qsort(g->split, g->n_split, sizeof *g->split, compare_splits);
  VG_TRY(vg_junction_sheet_open(&s, g->m, err));
  for (size_t i = 0, end; i < g->n_split; i = end) {
    const uint32_t *v = g->edge[g->split[i].edge];
    uint32_t last = v[0], made;

    for (end = i; end < g->n_split && g->split[end].edge == g->split[i].edge;
         end++) {
      double *x = from->point[g->split[end].point];
      const double *near = vg_distance(x, g->m->point[last]) <= most
                           ? g->m->point[last]
                         : vg_distance(x, g->m->point[v[1]]) <= most
                           ? g->m->point[v[1]]
                           : NULL;

      if (near) {
        if (moves) memcpy(x, near, 3 * sizeof *x);
        continue;
      }
      VG_TRY(vg_junction_split(&s, last, v[1], x, &made, err));
      last = made;
    }
  }
done:
  vg_junction_sheet_release(&s);
  return st;
}

vg_status vg_junction_snap(struct vg_mesh *walls, struct vg_mesh *sheets,
                           double most, size_t *n, struct vg_error *err)
{
  struct targets wall = { .m = walls }, sheet = { .m = sheets };
  uint8_t *on = vg_calloc(sheets->n_point, 1);
  uint8_t *has = NULL;
  struct nearest q;
  vg_status st = on ? VG_OK : vg_fail_memory(err, "the inner surfaces");

  assert(most > 0);
  VG_TRY(st);
  *n = 0;
  VG_TRY(list_edges(&wall, NULL, err));
  for (uint32_t p = 0; p < sheets->n_point; p++) {
    if (!find(&wall, sheets->point[p], most, &q)) continue;
    on[p] = 1;
    *n += q.best2 > 0;
    memcpy(sheets->point[p], q.foot, sizeof q.foot);
    VG_TRY(add_split(&wall, &(struct split){ q.edge, p, q.at }, err));
  }
  VG_TRY(split_edges(&wall, sheets, most, 1, err));
  VG_TRY(list_edges(&sheet, on, err));
  has = vg_calloc(walls->n_point, 1);
  if (!has) VG_TRY(vg_fail_memory(err, "the inner surfaces"));
  for (size_t i = 0; i < 2 * wall.n; i++) has[wall.edge[i / 2][i % 2]] = 1;
  for (uint32_t p = 0; p < walls->n_point && sheet.n; p++)
    if (has[p] && find(&sheet, walls->point[p], most, &q))
      VG_TRY(add_split(&sheet, &(struct split){ q.edge, p, q.at }, err));
  VG_TRY(split_edges(&sheet, walls, most, 0, err));
done:
  release(&wall);
  release(&sheet);
  free(on);
  free(has);
  return st;
}
