/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Finds the pairs of wall faces that become quadrilaterals with stacks of
 * hexahedra. Declared in layers/expand/pairs.h. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "core/geometry/vector.h"
#include "core/mesh/copies.h"
#include "core/mesh/edges.h"
#include "layers/expand/matching.h"
#include "layers/expand/pairs.h"

#define EDGE_GRAIN 64

/* L28 */
/* Least cosine of the angle between the normals of the two triangles. */
#define WARP_LEAST 0.9
/* Largest magnitude of the cosine of an angle of the quadrilateral. */
#define COSINE_MOST 0.9
/* Largest difference of the levels of its columns. */
#define LEVEL_STEP 3
/* Weights of right angles, of flatness, and of a common edge that is the
 * longest of both triangles; weights are above 0. */
#define WEIGHT_ANGLE 800
#define WEIGHT_FLAT 100
#define WEIGHT_LONGEST 100

/* Cells are tested for pairs of the matching only, a third of all edges. Where
 * they are bad, the matching is repeated without this pair, this often. */
#define ROUNDS 12

enum { UNTESTED, GOOD, BAD };

struct walls {
  struct vg_expand *e;
  const struct vg_mesh *surface;
  size_t n;        /* Number of wall faces, which come first. */
  uint32_t *other; /* [n] face on the other side of an inner surface;
                      VG_NO_INDEX: none. NULL: no inner surfaces. */
  struct vg_edges edges;
  uint16_t *weight; /* [edges.n] 0: no pair. */
  uint8_t *state;   /* [edges.n] of the test. */
};

static const double *foot_of(const struct walls *w, uint32_t column)
{
  return w->surface->point[w->e->columns->column[column].root];
}

/* Whether the corners of two neighbouring faces are four, with different roots
 * and without marks, on one patch, and with enough levels. Sheets have no
 * pairs: their triangles are faces between the cells of both sides. */
static int may_pair(const struct walls *w, const size_t pair[2])
{
  const struct vg_columns *c = w->e->columns;
  const uint32_t *f = c->face[pair[0]], *g = c->face[pair[1]];
  const uint32_t *patch = w->surface->tri_patch;
  uint32_t q[4];
  unsigned low, high = 0;
  int n_common = 0;

  for (int k = 0; k < 9; k++) n_common += f[k / 3] == g[k % 3];
  if (n_common != 2 ||
      patch[c->face_tri[pair[0]]] != patch[c->face_tri[pair[1]]] ||
      w->surface->patch[patch[c->face_tri[pair[0]]]].is_sheet)
    return 0;
  vg_pair_ring(c, pair, q);
  if (c->column[q[0]].root == c->column[q[2]].root) return 0;
  for (int k = 0; k < 4; k++) {
    const unsigned n = vg_mark_n(w->e->mark[q[k]]);

    if (w->e->mark[q[k]] & VG_MARK_SHARED) return 0;
    if (n > high) high = n;
  }
  low = vg_pair_levels(w->e, q);
  return low > 1 && high <= low + LEVEL_STEP;
}

static void normal_of(const struct walls *w, size_t face, double n[3])
{
  const uint32_t *f = w->e->columns->face[face];
  double a[3], b[3];

  vg_sub(foot_of(w, f[1]), foot_of(w, f[0]), a);
  vg_sub(foot_of(w, f[2]), foot_of(w, f[0]), b);
  vg_cross(a, b, n);
}

/* Largest magnitude of the cosines of the angles of a quadrilateral with this
 * normal; 2 if it is not convex. */
static double widest(const double *const x[4], const double normal[3])
{
  double most = 0;

  for (int k = 0; k < 4; k++) {
    double a[3], b[3], n[3], cosine;

    vg_sub(x[(k + 1) % 4], x[k], a);
    vg_sub(x[(k + 3) % 4], x[k], b);
    vg_cross(a, b, n);
    if (!(vg_dot(n, normal) > 0)) return 2;
    cosine = fabs(vg_dot(a, b)) / (vg_norm(a) * vg_norm(b));
    if (!(cosine <= most)) most = cosine;
  }
  return most;
}

static double length2(const double a[3], const double b[3])
{
  double d[3];

  vg_sub(a, b, d);
  return vg_dot(d, d);
}

/* Length of the common edge over the longest edge of the quadrilateral or the
 * common edge: 1 if the edges along stretched triangles stay. */
static double share_of_common(const double *const x[4])
{
  const double common = length2(x[1], x[3]);
  double most = common;

  for (int k = 0; k < 4; k++) {
    const double l = length2(x[k], x[(k + 1) % 4]);

    if (l > most) most = l;
  }
  return sqrt(common / most);
}

static uint16_t weight_of(const struct walls *w, const size_t pair[2])
{
  const double *x[4];
  double n[2][3], normal[3], flat, cosine;
  uint32_t q[4];

  if (!may_pair(w, pair)) return 0;
  vg_pair_ring(w->e->columns, pair, q);
  for (int k = 0; k < 4; k++) x[k] = foot_of(w, q[k]);
  for (int i = 0; i < 2; i++) {
    normal_of(w, pair[i], n[i]);
    vg_unit(n[i]);
  }
  flat = vg_dot(n[0], n[1]);
  if (!(flat >= WARP_LEAST)) return 0;
  for (int i = 0; i < 3; i++) normal[i] = n[0][i] + n[1][i];
  cosine = widest(x, normal);
  if (!(cosine <= COSINE_MOST)) return 0;
  flat = (flat - WARP_LEAST) / (1 - WARP_LEAST);
  return (uint16_t)(1 + WEIGHT_ANGLE * (1 - cosine) + WEIGHT_FLAT * flat +
                    WEIGHT_LONGEST * share_of_common(x));
}

static int32_t side_of(const struct walls *w, size_t face)
{
  const uint32_t t = w->e->columns->face_tri[face];

  return w->surface->patch[w->surface->tri_patch[t]].inner;
}

/* The faces on the other side of a pair on an inner surface. Returns 0 if the
 * pair is on none. */
static int across(const struct walls *w, const size_t pair[2], size_t back[2])
{
  if (side_of(w, pair[0]) == VG_INNER_NOT) return 0;
  for (int k = 0; k < 2; k++) back[k] = w->other[pair[k]];
  return 1;
}

/* Both sides of a baffle have the same pairs, so that the mesh shows which
 * faces lie back to back: those of its front are matched. */
static uint16_t weight_across(const struct walls *w, const size_t pair[2],
                              uint16_t weight)
{
  size_t back[2];
  uint16_t other;

  if (!weight || !across(w, pair, back)) return weight;
  if (side_of(w, pair[0]) != VG_INNER_FRONT || back[0] == VG_NO_INDEX ||
      back[1] == VG_NO_INDEX)
    return 0;
  other = weight_of(w, back);
  return other < weight ? other : weight;
}

static void weigh(void *context, size_t first, size_t end, int worker)
{
  const struct walls *w = context;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    const uint32_t *half = vg_edges_at(&w->edges, i);
    size_t pair[2];

    w->weight[i] = 0;
    if (vg_edges_count(&w->edges, i) != 2) continue;
    for (int k = 0; k < 2; k++) pair[k] = half[k] / 3;
    w->weight[i] = weight_across(w, pair, weight_of(w, pair));
  }
}

/* Tests the pairs of the matching that were not tested before. */
static void test_pairs(void *context, size_t first, size_t end, int worker)
{
  const struct walls *w = context;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    const uint32_t *half = vg_edges_at(&w->edges, i);
    size_t pair[2], back[2];
    int good;

    if (!w->weight[i] || w->state[i] != UNTESTED) continue;
    for (int k = 0; k < 2; k++) pair[k] = half[k] / 3;
    if (w->e->partner[pair[0]] != pair[1]) continue;
    good = vg_pair_is_good(w->e, w->surface, pair) &&
           (!across(w, pair, back) || vg_pair_is_good(w->e, w->surface, back));
    w->state[i] = good ? GOOD : BAD;
  }
}

/* Removes the links of pairs with bad cells, and these pairs. Returns their
 * number. */
static size_t drop_bad(const struct walls *w)
{
  size_t n = 0;

  for (size_t i = 0; i < w->edges.n; i++) {
    const uint32_t *half = vg_edges_at(&w->edges, i);

    if (w->state[i] != BAD || !w->weight[i]) continue;
    w->weight[i] = 0;
    for (int k = 0; k < 2; k++) w->e->partner[half[k] / 3] = VG_NO_INDEX;
    n++;
  }
  return n;
}

static void link_faces(const struct walls *w, struct vg_links *l)
{
  memset(l->to, 0xff, l->n * sizeof *l->to);
  memset(l->weight, 0, l->n * sizeof *l->weight);
  for (size_t i = 0; i < w->edges.n; i++) {
    const uint32_t *half = vg_edges_at(&w->edges, i);

    for (int k = 0; w->weight[i] && k < 2; k++) {
      l->to[half[k] / 3][half[k] % 3] = half[1 - k] / 3;
      l->weight[half[k] / 3][half[k] % 3] = w->weight[i];
    }
  }
}

static vg_status reserve(struct walls *w, struct vg_links *l,
                         struct vg_error *err)
{
  struct vg_expand *e = w->e;
  const size_t n = e->columns->n_face;

  l->n = w->n;
  l->to = vg_alloc(w->n, sizeof *l->to);
  l->weight = vg_alloc(w->n, sizeof *l->weight);
  w->weight = vg_alloc(w->edges.n, sizeof *w->weight);
  w->state = vg_calloc(w->edges.n, 1);
  if (!e->partner) {
    e->partner = vg_alloc(n, sizeof *e->partner);
    e->middle = vg_alloc(n, sizeof *e->middle);
    if (e->partner) memset(e->partner, 0xff, n * sizeof *e->partner);
  }
  if (l->to && l->weight && w->weight && w->state && e->partner && e->middle)
    return VG_OK;
  return vg_fail_memory(err, "the pairs of wall faces");
}

/* Pairs of fronts become pairs of backs. */
static void copy_pairs(const struct walls *w)
{
  uint32_t *partner = w->e->partner;

  for (size_t i = 0; i < w->n && w->other; i++)
    if (partner[i] != VG_NO_INDEX && side_of(w, i) == VG_INNER_FRONT)
      partner[w->other[i]] = w->other[partner[i]];
}

/* Finds the faces on both sides of inner surfaces. */
static vg_status find_others(struct walls *w, struct vg_error *err)
{
  const uint32_t *face_tri = w->e->columns->face_tri;
  uint32_t *first = NULL, *tri = NULL, *face = NULL;
  vg_status st = vg_mesh_inner_points(w->surface, &first, err);

  if (st < 0 || !first) return st;
  tri = vg_alloc(w->surface->n_tri, sizeof *tri);
  face = vg_alloc(w->surface->n_tri, sizeof *face);
  w->other = vg_alloc(w->n, sizeof *w->other);
  if (!tri || !face || !w->other)
    VG_TRY(vg_fail_memory(err, "the pairs of wall faces"));
  VG_TRY(vg_mesh_inner_pairs(w->surface, first, tri, err));
  memset(face, 0xff, w->surface->n_tri * sizeof *face);
  for (uint32_t i = 0; i < w->n; i++) face[face_tri[i]] = i;
  for (size_t i = 0; i < w->n; i++) {
    const uint32_t t = tri[face_tri[i]];

    w->other[i] = t == UINT32_MAX ? VG_NO_INDEX : face[t];
  }
done:
  free(first);
  free(tri);
  free(face);
  return st;
}

/* Counts the pairs, and measures their part of the area of the walls. */
static void measure(struct walls *w)
{
  struct vg_expand *e = w->e;
  double all = 0, paired = 0;

  for (size_t i = 0; i < w->n; i++) {
    double n[3], area;

    normal_of(w, i, n);
    area = vg_norm(n);
    all += area;
    if (e->partner[i] == VG_NO_INDEX) continue;
    paired += area;
    e->n_pair += (size_t)vg_pair_is_first(e, i);
  }
  e->wall_quads = all > 0 ? paired / all : 0;
}

vg_status vg_pairs_find_wall(struct vg_expand *e, const struct vg_mesh *surface,
                             struct vg_error *err)
{
  const struct vg_columns *c = e->columns;
  struct walls w = { .e = e, .surface = surface, .edges = VG_EDGES_INIT };
  struct vg_links l = { 0 };
  vg_status st;

  while (w.n < c->n_face && c->face_tri[w.n] != VG_NO_INDEX) w.n++;
  VG_TRY(vg_edges_build(&w.edges, c->n_column, w.n,
                        (const uint32_t(*)[3])c->face, NULL, 0, err));
  VG_TRY(reserve(&w, &l, err));
  VG_TRY(find_others(&w, err));
  vg_parallel_for(e->threads, w.edges.n, EDGE_GRAIN, weigh, &w);
  for (int i = 0, again = 1; i < ROUNDS && again; i++) {
    link_faces(&w, &l);
    VG_TRY(vg_links_match(&l, e->partner, err));
    vg_parallel_for(e->threads, w.edges.n, EDGE_GRAIN, test_pairs, &w);
    again = drop_bad(&w) > 0;
  }
  copy_pairs(&w);
  measure(&w);
done:
  vg_edges_release(&w.edges);
  free(w.other);
  free(w.weight);
  free(w.state);
  free(l.to);
  free(l.weight);
  return st;
}
