/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/sizing/sizing_mesh.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/nearest.h"
#include "core/geometry/tensor.h"
#include "core/geometry/vector.h"
#include "core/search/box_tree.h"
#include "core/sizing/sizing_tensor.h"

/* Barycentric coordinate down to which a point counts as inside a tetrahedron.
 */
#define INSIDE -1e-9

struct vg_size_mesh {
  size_t n, n_tet;
  double (*x)[3];           /* [n] */
  struct vg_size *size;     /* [n] size tensors */
  uint32_t (*tet)[4];       /* [n_tet] */
  struct vg_box_tree cells; /* of tet */
  struct vg_box_tree points;
  double slope;
  struct vg_size_map map;
};

/* --- evaluation ----------------------------------------------------------- */

struct place {
  const struct vg_size_mesh *s;
  const double *x;
  double least; /* smallest barycentric coordinate in the best tetrahedron */
  double w[4];
  uint32_t tet;
};

/* Barycentric coordinates of x; 0 for a flat tetrahedron. */
static int find_weights(const struct place *p, const uint32_t v[4], double w[4])
{
  double e[3][3], d[3], det;

  for (int k = 0; k < 3; k++) vg_sub(p->s->x[v[k + 1]], p->s->x[v[0]], e[k]);
  vg_sub(p->x, p->s->x[v[0]], d);
  det = vg_triple(e[0], e[1], e[2]);
  if (det == 0) return 0;
  w[1] = vg_triple(d, e[1], e[2]) / det;
  w[2] = vg_triple(e[0], d, e[2]) / det;
  w[3] = vg_triple(e[0], e[1], d) / det;
  w[0] = 1 - w[1] - w[2] - w[3];
  return 1;
}

/* Ends at the first tetrahedron that contains x. */
static int visit_cell(void *context, uint32_t item)
{
  struct place *p = context;
  double w[4], least;

  if (!find_weights(p, p->s->tet[item], w)) return 0;
  least = fmin(fmin(w[0], w[1]), fmin(w[2], w[3]));
  if (!(least > p->least)) return 0;
  p->least = least;
  p->tet = item;
  memcpy(p->w, w, sizeof w);
  return least >= 0;
}

/* The nearest point of the background mesh, as a mean of mesh points. */
struct nearest {
  const struct vg_size_mesh *s;
  const double *x;
  double d2;
  int n; /* number of mesh points */
  uint32_t point[3];
  double w[3]; /* their weights; their sum is 1 */
};

static int enter_near(void *context, size_t node, double d2)
{
  (void)node;
  return d2 < ((struct nearest *)context)->d2;
}

static void try_point(struct nearest *n, uint32_t p)
{
  double d2 = vg_distance2(n->s->x[p], n->x);

  if (!(d2 < n->d2)) return;
  n->d2 = d2;
  n->n = 1;
  n->point[0] = p;
  n->w[0] = 1;
}

static void try_face(struct nearest *n, uint32_t a, uint32_t b, uint32_t c)
{
  const double(*x)[3] = (const double(*)[3])n->s->x;
  double w[3], near[3], d2;

  vg_nearest_weights(n->x, x[a], x[b], x[c], w);
  for (int k = 0; k < 3; k++)
    near[k] = w[0] * x[a][k] + w[1] * x[b][k] + w[2] * x[c][k];
  d2 = vg_distance2(near, n->x);
  if (!(d2 < n->d2)) return;
  n->d2 = d2;
  n->n = 3;
  n->point[0] = a;
  n->point[1] = b;
  n->point[2] = c;
  memcpy(n->w, w, sizeof w);
}

static void leaf_of_points(void *context, size_t node)
{
  struct nearest *n = context;
  const struct vg_box_tree *t = &n->s->points;

  for (size_t i = vg_box_tree_first(t, node); i < vg_box_tree_end(t, node); i++)
    try_point(n, t->item[i]);
}

static void leaf_of_cells(void *context, size_t node)
{
  struct nearest *n = context;
  const struct vg_box_tree *t = &n->s->cells;

  for (size_t i = vg_box_tree_first(t, node); i < vg_box_tree_end(t, node);
       i++) {
    const uint32_t *v = n->s->tet[t->item[i]];

    for (int k = 0; k < 4; k++)
      try_face(n, v[(k + 1) % 4], v[(k + 2) % 4], v[(k + 3) % 4]);
  }
}

/* Size tensor at the nearest point of the cells, or the nearest point if there
 * are no cells. It grows over the distance beyond one edge length: the domain
 * may extend beyond the cells by less than that, where its boundary is curved
 * or by rounding. */
static void size_outside(const struct vg_size_mesh *s, const double x[3],
                         double h[6])
{
  struct nearest n = { .s = s, .x = x, .d2 = INFINITY };
  double way[3] = { x[0], x[1], x[2] }, t[6], v[3], edges;

  if (s->n_tet)
    vg_box_tree_approach(&s->cells, x, enter_near, leaf_of_cells, &n);
  if (!n.n) vg_box_tree_approach(&s->points, x, enter_near, leaf_of_points, &n);
  memset(h, 0, 6 * sizeof *h);
  for (int i = 0; i < n.n; i++) {
    for (int k = 0; k < 3; k++) way[k] -= n.w[i] * s->x[n.point[i]][k];
    for (int k = 0; k < 6; k++)
      h[k] += n.w[i] * (double)s->size[n.point[i]].h[k];
  }
  vg_tensor_invert(h, t);
  vg_tensor_apply(t, way, v);
  edges = vg_norm(v);
  if (!(edges > 1)) return;
  for (int k = 0; k < 3; k++) way[k] *= 1 - 1 / edges;
  vg_size_grow(h, way, s->slope, h);
}

static void size_at(const struct vg_size_mesh *s, const double x[3],
                    double h[6])
{
  struct place p = { .s = s, .x = x, .least = -INFINITY };
  struct vg_box at;

  for (int k = 0; k < 3; k++) at.lo[k] = at.hi[k] = x[k];
  if (s->n_tet) vg_box_tree_touched(&s->cells, &at, visit_cell, &p);
  if (!(p.least >= INSIDE)) {
    size_outside(s, x, h);
    return;
  }
  for (int k = 0; k < 6; k++) {
    h[k] = 0;
    for (int i = 0; i < 4; i++)
      h[k] += fmax(p.w[i], 0) * (double)s->size[s->tet[p.tet][i]].h[k];
  }
}

static void metric_at(void *user, const double x[3], double m[6])
{
  double h[6];

  size_at(user, x, h);
  vg_size_metric(h, m);
}

struct search {
  const struct vg_size_mesh *s;
  double least;
};

static int visit_point(void *context, uint32_t item)
{
  struct search *q = context;

  q->least = fmin(q->least, (double)q->s->size[item].least);
  return 0;
}

/* Smallest size at the points in a box, and at its centre. Between points, size
 * tensors are linear or grow. */
static double least(void *user, const double lo[3], const double hi[3])
{
  struct search q = { user, 0 };
  double mid[3], h[6], range[2];
  struct vg_size_limits any = { 0, INFINITY, INFINITY };
  struct vg_box box;

  for (int k = 0; k < 3; k++) {
    mid[k] = 0.5 * (lo[k] + hi[k]);
    box.lo[k] = lo[k];
    box.hi[k] = hi[k];
  }
  size_at(q.s, mid, h);
  vg_size_limit(h, &any, range);
  q.least = range[0];
  vg_box_tree_touched(&q.s->points, &box, visit_point, &q);
  return q.least;
}

/* --- construction --------------------------------------------------------- */

/* Divisions of cells into tetrahedra, by node. A face between two cells may be
 * divided along different diagonals; the interpolation is then discontinuous by
 * the difference of two linear functions with the same corners. */
static const uint8_t pyramid[2][4] = { { 0, 3, 4, 2 }, { 0, 4, 1, 2 } };
static const uint8_t prism[3][4] = { { 0, 1, 2, 3 },
                                     { 1, 2, 3, 4 },
                                     { 2, 3, 4, 5 } };
static const uint8_t hex[6][4] = { { 0, 1, 2, 6 }, { 0, 2, 3, 6 },
                                   { 0, 3, 7, 6 }, { 0, 7, 4, 6 },
                                   { 0, 4, 5, 6 }, { 0, 5, 1, 6 } };

static void divide(struct vg_size_mesh *s, const uint32_t *node,
                   const uint8_t (*part)[4], int n)
{
  for (int i = 0; i < n; i++, s->n_tet++)
    for (int k = 0; k < 4; k++) s->tet[s->n_tet][k] = node[part[i][k]];
}

static void put_cells(struct vg_size_mesh *s, const struct vg_mesh *m)
{
  static const uint8_t whole[1][4] = { { 0, 1, 2, 3 } };

  for (size_t i = 0; i < m->n_tet; i++) divide(s, m->tet[i], whole, 1);
  for (size_t i = 0; i < m->n_pyr; i++) divide(s, m->pyr[i], pyramid, 2);
  for (size_t i = 0; i < m->n_pri; i++) divide(s, m->pri[i], prism, 3);
  for (size_t i = 0; i < m->n_hex; i++) divide(s, m->hex[i], hex, 6);
}

static vg_status build_trees(struct vg_size_mesh *s, struct vg_error *err)
{
  size_t n = s->n > s->n_tet ? s->n : s->n_tet;
  struct vg_box *box = vg_alloc(n, sizeof *box);
  vg_status st = VG_OK;

  if (!box) return vg_fail_memory(err, "the background mesh of the sizes");
  for (size_t i = 0; i < s->n; i++)
    for (int k = 0; k < 3; k++) box[i].lo[k] = box[i].hi[k] = s->x[i][k];
  VG_TRY(vg_box_tree_build_items(&s->points, s->n, box, NULL, err));
  for (size_t i = 0; i < s->n_tet; i++)
    for (int k = 0; k < 3; k++) {
      box[i].lo[k] = box[i].hi[k] = s->x[s->tet[i][0]][k];
      for (int j = 1; j < 4; j++) {
        box[i].lo[k] = fmin(box[i].lo[k], s->x[s->tet[i][j]][k]);
        box[i].hi[k] = fmax(box[i].hi[k], s->x[s->tet[i][j]][k]);
      }
    }
  VG_TRY(vg_box_tree_build_items(&s->cells, s->n_tet, box, NULL, err));
done:
  free(box);
  return st;
}

static void put_sizes(struct vg_size_mesh *s, const double (*metric)[6])
{
  struct vg_size_limits any = { 0, INFINITY, INFINITY };

  for (size_t i = 0; i < s->n; i++) {
    double h[6], range[2];

    vg_size_from_metric(metric[i], &any, h, range);
    for (int k = 0; k < 6; k++) s->size[i].h[k] = (float)h[k];
    s->size[i].least = (float)range[0];
    s->size[i].most = (float)range[1];
    s->map.most = fmax(s->map.most, range[1]);
  }
}

vg_status vg_size_mesh_new(const struct vg_mesh *m, const double (*metric)[6],
                           double growth, struct vg_size_mesh **out,
                           struct vg_error *err)
{
  assert(m && m->n_point > 0 && metric && growth > 1 && out);

  struct vg_size_mesh *s = vg_calloc(1, sizeof *s);
  size_t n_tet = m->n_tet + 2 * m->n_pyr + 3 * m->n_pri + 6 * m->n_hex;
  vg_status st = VG_OK;

  if (s) {
    s->x = vg_alloc(m->n_point, sizeof *s->x);
    s->size = vg_alloc(m->n_point, sizeof *s->size);
    s->tet = vg_alloc(n_tet, sizeof *s->tet);
  }
  if (!s || !s->x || !s->size || !s->tet) {
    st = vg_fail_memory(err, "the background mesh of the sizes");
    goto done;
  }
  s->n = m->n_point;
  s->slope = growth - 1;
  memcpy(s->x, m->point, s->n * sizeof *s->x);
  s->map = (struct vg_size_map){ .metric = metric_at,
                                 .least = least,
                                 .user = s };
  put_sizes(s, metric);
  put_cells(s, m);
  VG_TRY(build_trees(s, err));
  *out = s;
  s = NULL;
done:
  vg_size_mesh_free(s);
  return st;
}

void vg_size_mesh_free(struct vg_size_mesh *s)
{
  if (!s) return;
  vg_box_tree_release(&s->cells);
  vg_box_tree_release(&s->points);
  free(s->x);
  free(s->size);
  free(s->tet);
  free(s);
}

const struct vg_size_map *vg_size_mesh_map(const struct vg_size_mesh *s)
{
  return &s->map;
}
