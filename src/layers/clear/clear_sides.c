/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Overlaps of the side faces of the layers in one slide patch. The patch may be
 * plane only up to noise, or curved, so the test is two-dimensional: the
 * coordinate along which the normals of both side faces are largest is dropped,
 * and the projection is tested exactly. */
#include "layers/clear/clear_parts.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/predicates.h"

/* A side face lies in the patch of another one if it is off that patch by less
 * than this share of its size: plane patches are flat to 1e-6, and curved ones
 * are resolved. */
#define OFF_PLANE 0.1

struct flanks {
  const struct vg_tops *t;
  uint32_t (*tri)[3]; /* [2 n_border] halves of the side faces, for their
                         bounding boxes. */
  struct vg_boxes boxes;
};

/* Outline of a side face in the plane: roots a and b, then the tops of b and a,
 * without repeated points. */
struct outline {
  int n; /* 2: neither column has a level; otherwise 3 or 4. */
  uint32_t node[4];
  double x[4][2];
  int tri[2][3], n_tri; /* Division into triangles of equal orientation. */
};

static int sign(double x)
{
  return (x > 0) - (x < 0);
}

static int turn(const double *a, const double *b, const double *c)
{
  return sign(vg_orient2d(a, b, c));
}

static int between(double a, double b, double x)
{
  return a < b ? a <= x && x <= b : b <= x && x <= a;
}

static int on_segment(const double *a, const double *b, const double *x)
{
  return between(a[0], b[0], x[0]) && between(a[1], b[1], x[1]);
}

static int segments_meet(const double *a, const double *b, const double *c,
                         const double *d)
{
  int abc = turn(a, b, c), abd = turn(a, b, d);
  int cda = turn(c, d, a), cdb = turn(c, d, b);

  if (!abc && !abd)
    return on_segment(a, b, c) || on_segment(a, b, d) || on_segment(c, d, a);
  return abc * abd <= 0 && cda * cdb <= 0;
}

/* Whether the edge from corner i of p intersects half h of q anywhere except at
 * shared corners and the edges between them. */
static int edge_meets_half(const struct outline *p, int i,
                           const struct outline *q, int h)
{
  int j = (i + 1) % p->n, at_i = -1, at_j = -1, own;
  const double *a = p->x[i], *b = p->x[j], *c[3];

  for (int k = 0; k < 3; k++) {
    c[k] = q->x[q->tri[h][k]];
    if (q->node[q->tri[h][k]] == p->node[i]) at_i = k;
    if (q->node[q->tri[h][k]] == p->node[j]) at_j = k;
  }
  if (at_i >= 0 && at_j >= 0) return 0;
  own = turn(c[0], c[1], c[2]);
  if (at_i >= 0 || at_j >= 0) {
    int k = at_i >= 0 ? at_i : at_j;
    const double *far = at_i >= 0 ? b : a;

    /* From the shared corner: into the half, or along one of its edges. */
    return own * turn(c[k], c[(k + 1) % 3], far) >= 0 &&
           own * turn(c[(k + 2) % 3], c[k], far) >= 0;
  }
  if (own * turn(c[0], c[1], a) >= 0 && own * turn(c[1], c[2], a) >= 0 &&
      own * turn(c[2], c[0], a) >= 0)
    return 1;
  for (int k = 0; k < 3; k++)
    if (segments_meet(a, b, c[k], c[(k + 1) % 3])) return 1;
  return 0;
}

/* Tests the edges of p against q if q has a level. If q has none, it is an edge
 * of the wall, which the call with p and q exchanged tests. */
static int edges_meet(const struct outline *p, const struct outline *q)
{
  for (int i = 0; i < p->n; i++)
    for (int h = 0; h < q->n_tri; h++)
      if (edge_meets_half(p, i, q, h)) return 1;
  return 0;
}

/* --- side faces ---------------------------------------------------------- */

/* Corners of the side face on boundary edge r, including repeated points. */
static void corners(const struct vg_tops *t, size_t r, uint32_t node[4])
{
  uint32_t a = t->columns->border[r][0], b = t->columns->border[r][1];

  node[0] = vg_tops_root(t, t->columns->column[a].root);
  node[1] = vg_tops_root(t, t->columns->column[b].root);
  node[2] = t->node[b];
  node[3] = t->node[a];
}

/* Area vector, times two. */
static void area_of(const struct vg_tops *t, const uint32_t node[4],
                    double n[3])
{
  const double *p[4];
  double d[3], e[3];

  for (int k = 0; k < 4; k++) p[k] = t->point[node[k]];
  for (int k = 0; k < 3; k++) {
    d[k] = p[2][k] - p[0][k];
    e[k] = p[3][k] - p[1][k];
  }
  for (int k = 0; k < 3; k++)
    n[k] = d[(k + 1) % 3] * e[(k + 2) % 3] - d[(k + 2) % 3] * e[(k + 1) % 3];
}

/* Divides a quadrilateral along one of its diagonals into two triangles of
 * equal orientation. Returns 0 if neither diagonal works because the
 * quadrilateral crosses itself or has no area. */
static int split(struct outline *o)
{
  static const int half[2][2][3] = { { { 0, 1, 2 }, { 0, 2, 3 } },
                                     { { 0, 1, 3 }, { 1, 2, 3 } } };

  if (o->n == 2) return 1;
  for (int d = 0; d < (o->n == 4 ? 2 : 1); d++) {
    const int *p = half[d][0], *q = half[d][1];
    int s = turn(o->x[p[0]], o->x[p[1]], o->x[p[2]]);

    if (!s || (o->n == 4 && turn(o->x[q[0]], o->x[q[1]], o->x[q[2]]) != s))
      continue;
    memcpy(o->tri, half[d], sizeof o->tri);
    o->n_tri = o->n - 2;
    return 1;
  }
  return 0;
}

static int outline_of(const struct vg_tops *t, const uint32_t node[4], int axis,
                      struct outline *o)
{
  int i = (axis + 1) % 3, j = (axis + 2) % 3;

  memset(o, 0, sizeof *o);
  for (int k = 0; k < 4; k++) {
    int again = 0;

    for (int l = 0; l < o->n; l++) again |= o->node[l] == node[k];
    if (again) continue;
    o->node[o->n] = node[k];
    o->x[o->n][0] = t->point[node[k]][i];
    o->x[o->n++][1] = t->point[node[k]][j];
  }
  return o->n > 1 && split(o);
}

static int axis_of(const double n[3])
{
  int axis = fabs(n[1]) > fabs(n[0]) ? 1 : 0;

  return fabs(n[2]) > fabs(n[axis]) ? 2 : axis;
}

static void mark_border(const struct vg_tops *t, size_t r)
{
  vg_tops_mark(t, t->columns->border[r][0]);
  vg_tops_mark(t, t->columns->border[r][1]);
}

static int border_active(const struct vg_tops *t, size_t r)
{
  return vg_tops_active(t, t->columns->border[r][0]) ||
         vg_tops_active(t, t->columns->border[r][1]);
}

static void meet_flanks(void *context, size_t i, size_t j)
{
  const struct flanks *x = context;
  const struct vg_tops *t = x->t;
  size_t r = x->boxes.item[i] / 2, s = x->boxes.item[j] / 2;
  struct outline o, p;
  uint32_t a[4], b[4];
  double n[3], m[3], dot = 0;

  if (r == s || t->columns->border_patch[r] != t->columns->border_patch[s])
    return;
  if (!border_active(t, r) && !border_active(t, s)) return;
  corners(t, r, a);
  corners(t, s, b);
  area_of(t, a, n);
  area_of(t, b, m);
  for (int k = 0; k < 3; k++) dot += n[k] * m[k];
  /* Opposite sides of a thin plate. A side face without a level has no
   * orientation. */
  if (dot < 0) return;
  for (int k = 0; k < 3; k++) n[k] += m[k];
  if (!outline_of(t, a, axis_of(n), &o) || !outline_of(t, b, axis_of(n), &p))
    return;
  if (o.n == 2 && p.n == 2) return;
  if (!edges_meet(&o, &p) && !edges_meet(&p, &o)) return;
  mark_border(t, r);
  mark_border(t, s);
}

static void judge_alone(const struct vg_tops *t, size_t r)
{
  struct outline o;
  uint32_t node[4];
  double n[3];

  corners(t, r, node);
  area_of(t, node, n);
  /* Within a fan without levels all four corners are one point. */
  if (node[0] == node[1] && node[2] == node[0] && node[3] == node[0]) return;
  if (border_active(t, r) && !outline_of(t, node, axis_of(n), &o))
    mark_border(t, r);
}

vg_status vg_clear_flanks(const struct vg_tops *t, struct vg_error *err)
{
  assert(t->bad || !t->columns->n_column);

  const struct vg_columns *c = t->columns;
  struct flanks x = { t, NULL, VG_BOXES_INIT };
  vg_status st = VG_OK;

  if (!c->n_border) return VG_OK;
  if (c->n_border > VG_NO_INDEX / 2)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "%zu edges between walls and slide patches are too many: "
                   "use a coarser surface",
                   c->n_border);
  x.tri = vg_alloc(2 * c->n_border, sizeof *x.tri);
  if (!x.tri) return vg_fail_memory(err, "side faces of the layers");
  for (size_t r = 0; r < c->n_border; r++) {
    uint32_t node[4];

    judge_alone(t, r);
    corners(t, r, node);
    memcpy(x.tri[2 * r], node, sizeof *x.tri);
    memcpy(x.tri[2 * r + 1], (uint32_t[3]){ node[0], node[2], node[3] },
           sizeof *x.tri);
  }
  VG_TRY(vg_boxes_build(&x.boxes, (const double(*)[3])t->point,
                        (const uint32_t(*)[3])x.tri, 2 * c->n_border, NULL,
                        OFF_PLANE, t->threads, err));
  vg_boxes_pairs(&x.boxes, t->threads, meet_flanks, &x);
done:
  free(x.tri);
  vg_boxes_release(&x.boxes);
  return st;
}
