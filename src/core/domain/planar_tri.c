/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/domain/planar_tri.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/memory.h"
#include "core/geometry/hilbert.h"
#include "core/geometry/predicates.h"

void vg_tri2_release(struct vg_tri2 *t)
{
  free(t->x);
  free(t->h);
  free(t->vt);
  free(t->face);
  free(t->unused);
  free(t->cavity);
  free(t->stack);
  free(t->border);
  memset(t, 0, sizeof *t);
}

uint32_t vg_tri2_add_point(struct vg_tri2 *t, const double x[2], double h)
{
  size_t n = t->n_point;

  if (n >= VG_T2_POINT_MAX ||
      vg_reserve(&t->x, &t->cap_point, n + 1, sizeof *t->x) ||
      vg_reserve(&t->h, &t->cap_h, n + 1, sizeof *t->h) ||
      vg_reserve(&t->vt, &t->cap_vt, n + 1, sizeof *t->vt))
    return VG_T2_NONE;
  t->x[n][0] = x[0];
  t->x[n][1] = x[1];
  t->h[n] = h;
  t->vt[n] = VG_T2_NONE;
  return (uint32_t)t->n_point++;
}

static uint32_t take_slot(struct vg_tri2 *t)
{
  if (t->n_unused) return t->unused[--t->n_unused];
  if (t->n_face >= VG_T2_NONE / 4 - 1 ||
      vg_reserve(&t->face, &t->cap_face, t->n_face + 1, sizeof *t->face))
    return VG_T2_NONE;
  t->face[t->n_face].stamp = 0;
  return (uint32_t)t->n_face++;
}

int vg_tri2_init(struct vg_tri2 *t, size_t n, const double (*p)[2])
{
  double lo[2], hi[2], mid[2], r;
  struct vg_t2_face *f;
  uint32_t slot;

  assert(p || !n);
  for (int k = 0; k < 2; k++) {
    lo[k] = hi[k] = p[0][k];
    for (size_t i = 1; i < n; i++) {
      if (p[i][k] < lo[k]) lo[k] = p[i][k];
      if (p[i][k] > hi[k]) hi[k] = p[i][k];
    }
    mid[k] = lo[k] + 0.5 * (hi[k] - lo[k]);
  }
  r = hi[0] - lo[0] + (hi[1] - lo[1]);
  for (size_t i = 0; i < n; i++)
    if (vg_tri2_add_point(t, p[i], 0) == VG_T2_NONE) return -1;
  for (int k = 0; k < 3; k++) {
    const double corner[2] = { mid[0] + (k - 1) * 64 * r,
                               mid[1] + (k == 1 ? 64 : -64) * r };

    if (vg_tri2_add_point(t, corner, 0) == VG_T2_NONE) return -1;
  }
  slot = take_slot(t);
  if (slot == VG_T2_NONE) return -1;
  f = &t->face[slot];
  f->v[0] = (uint32_t)n;
  f->v[1] = (uint32_t)n + 2;
  f->v[2] = (uint32_t)n + 1;
  f->flag = 0;
  for (int k = 0; k < 3; k++) {
    f->adj[k] = VG_T2_NONE;
    t->vt[f->v[k]] = 4 * slot + (uint32_t)k;
  }
  t->walk = slot;
  return 0;
}

/* Visibility walk. The first edge tried changes with every step, so that the
 * walk cannot cycle forever where constraints distort the triangulation. */
uint32_t vg_tri2_locate(struct vg_tri2 *t, const double x[2], int stop_at_fixed)
{
  uint32_t at = t->walk, came = VG_T2_NONE, turn = 1;

  for (;;) {
    const struct vg_t2_face *f = &t->face[at];
    uint32_t k, go = VG_T2_NONE;

    turn = turn * 1664525u + 1013904223u;
    k = (turn >> 16) % 3;
    for (int i = 0; i < 3 && go == VG_T2_NONE; i++, k = k == 2 ? 0 : k + 1) {
      const uint32_t e = 4 * at + k;

      if (e == came) continue;
      if (vg_orient2d(t->x[f->v[k]], t->x[f->v[k == 2 ? 0 : k + 1]], x) < 0)
        go = e;
    }
    if (go == VG_T2_NONE) break;
    if (vg_t2_twin(t, go) == VG_T2_NONE ||
        (stop_at_fixed && vg_t2_is_fixed(t, go)))
      return VG_T2_NONE;
    came = vg_t2_twin(t, go);
    at = came >> 2;
  }
  t->walk = at;
  return at;
}

static int in_circle(const struct vg_tri2 *t, uint32_t at, const double x[2])
{
  const uint32_t *v = t->face[at].v;

  return vg_incircle(t->x[v[0]], t->x[v[1]], t->x[v[2]], x) > 0;
}

static int cavity_add(struct vg_tri2 *t, uint32_t at)
{
  if (vg_reserve(&t->cavity, &t->cap_cavity, t->n_cavity + 1,
                 sizeof *t->cavity))
    return -1;
  t->cavity[t->n_cavity++] = at;
  t->face[at].flag |= VG_T2_CAVITY;
  return 0;
}

static int border_add(struct vg_tri2 *t, uint32_t e, const double x[2])
{
  struct vg_t2_border *r;

  if (vg_reserve(&t->border, &t->cap_border, t->n_border + 1,
                 sizeof *t->border))
    return -1;
  r = &t->border[t->n_border++];
  r->a = vg_t2_from(t, e);
  r->b = vg_t2_to(t, e);
  r->outer = vg_t2_twin(t, e);
  r->constrained = (uint32_t)vg_t2_is_fixed(t, e);
  return vg_orient2d(t->x[r->a], t->x[r->b], x) > 0;
}

/* Depth first, the edges of each triangle counter-clockwise from the one
 * through which it was entered, so that the border is a single
 * counter-clockwise cycle. */
int vg_tri2_cavity(struct vg_tri2 *t, const double x[2], uint32_t at)
{
  size_t n = 3;

  assert(at < t->n_face && !(t->face[at].flag & VG_T2_DEAD));
  t->n_cavity = t->n_border = 0;
  if (vg_reserve(&t->stack, &t->cap_stack, 8, sizeof *t->stack) ||
      cavity_add(t, at))
    return -1;
  for (uint32_t k = 0; k < 3; k++) t->stack[k] = 4 * at + 2 - k;
  while (n) {
    const uint32_t e = t->stack[--n], out = vg_t2_twin(t, e);

    if (out != VG_T2_NONE && !vg_t2_is_fixed(t, e)) {
      if (t->face[out >> 2].flag & VG_T2_CAVITY) return 0;
      if (in_circle(t, out >> 2, x)) {
        if (vg_reserve(&t->stack, &t->cap_stack, n + 2, sizeof *t->stack) ||
            cavity_add(t, out >> 2))
          return -1;
        t->stack[n++] = vg_t2_prev(out);
        t->stack[n++] = vg_t2_next(out);
        continue;
      }
    }
    switch (border_add(t, e, x)) {
    case -1: return -1;
    case 0: return 0;
    }
  }
  return 1;
}

void vg_tri2_cancel(struct vg_tri2 *t)
{
  for (size_t i = 0; i < t->n_cavity; i++)
    t->face[t->cavity[i]].flag &= ~(uint32_t)VG_T2_CAVITY;
  t->n_cavity = t->n_border = 0;
}

int vg_tri2_commit(struct vg_tri2 *t, uint32_t p, uint32_t flag)
{
  assert(p < t->n_point && t->n_border > 2);

  const size_t n = t->n_border;

  /* A cavity of m triangles has m + 2 border edges. */
  while (t->n_cavity < n) {
    const uint32_t slot = take_slot(t);

    if (slot == VG_T2_NONE) return -1;
    t->face[slot].flag = VG_T2_CAVITY;
    if (cavity_add(t, slot)) return -1;
  }
  for (size_t i = 0; i < n; i++) {
    const struct vg_t2_border *r = &t->border[i];
    const uint32_t slot = t->cavity[i];
    struct vg_t2_face *f = &t->face[slot];

    f->v[0] = r->a;
    f->v[1] = r->b;
    f->v[2] = p;
    f->flag = flag | r->constrained;
    f->stamp++;
    f->adj[0] = r->outer;
    f->adj[1] = 4 * t->cavity[i + 1 < n ? i + 1 : 0] + 2;
    f->adj[2] = 4 * t->cavity[i ? i - 1 : n - 1] + 1;
    if (r->outer != VG_T2_NONE)
      t->face[r->outer >> 2].adj[r->outer & 3] = 4 * slot;
    t->vt[r->a] = 4 * slot;
  }
  t->vt[p] = 4 * t->cavity[0] + 2;
  t->walk = t->cavity[0];
  return 0;
}

/* Order of insertion: rounds of doubling size, each along a Morton curve
 * (Amenta, Choi, Rote, "Incremental constructions con BRIO", 2003). The round
 * is derived from a hash of the index, so that the order is a function of the
 * input. */
struct order {
  uint64_t key;
  uint32_t round, point;
};

static int order_compare(const void *pa, const void *pb)
{
  const struct order *a = pa, *b = pb;

  if (a->round != b->round) return a->round < b->round ? -1 : 1;
  if (a->key != b->key) return a->key < b->key ? -1 : 1;
  return a->point < b->point ? -1 : a->point > b->point;
}

static uint32_t round_of(uint32_t i)
{
  uint32_t h = (i + 1) * (uint32_t)(VG_GOLDEN >> 32);

  h = (h ^ h >> 15) * 2246822519u;
  h ^= h >> 13;
  return h ? (uint32_t)__builtin_ctz(h) : 32;
}

static void make_order(const struct vg_tri2 *t, size_t n, const uint32_t *list,
                       struct order *order)
{
  double lo[2], hi[2];

  for (int k = 0; k < 2; k++) {
    lo[k] = hi[k] = t->x[list[0]][k];
    for (size_t i = 1; i < n; i++) {
      if (t->x[list[i]][k] < lo[k]) lo[k] = t->x[list[i]][k];
      if (t->x[list[i]][k] > hi[k]) hi[k] = t->x[list[i]][k];
    }
  }
  for (size_t i = 0; i < n; i++) {
    uint64_t key = 0;

    for (int k = 0; k < 2; k++) {
      const double w = hi[k] > lo[k] ? hi[k] - lo[k] : 1;

      key |= vg_interleave2(
               (uint64_t)((t->x[list[i]][k] - lo[k]) / w * 4294967295.0))
          << k;
    }
    order[i] = (struct order){ key, 32 - round_of(list[i]), list[i] };
  }
  qsort(order, n, sizeof *order, order_compare);
}

int vg_tri2_insert_all(struct vg_tri2 *t, size_t n, const uint32_t *list,
                       uint32_t *alias)
{
  assert((list || !n) && alias);

  struct order *order = n ? vg_alloc(n, sizeof *order) : NULL;
  int bad = n && !order;

  if (!bad && n) make_order(t, n, list, order);
  for (size_t i = 0; !bad && i < n; i++) {
    const uint32_t p = order[i].point;
    const uint32_t at = vg_tri2_locate(t, t->x[p], 0);
    const uint32_t *v = t->face[at].v;

    alias[p] = p;
    for (int k = 0; k < 3; k++)
      if (t->x[v[k]][0] == t->x[p][0] && t->x[v[k]][1] == t->x[p][1])
        alias[p] = v[k];
    if (alias[p] != p) continue;
    bad = vg_tri2_cavity(t, t->x[p], at) != 1 || vg_tri2_commit(t, p, 0);
  }
  free(order);
  return bad ? -1 : 0;
}

uint32_t vg_tri2_find(const struct vg_tri2 *t, uint32_t a, uint32_t b)
{
  assert(a < t->n_point && b < t->n_point);

  const uint32_t first = t->vt[a];
  uint32_t e = first;

  do {
    if (vg_t2_to(t, e) == b) return e;
    e = vg_t2_twin(t, vg_t2_prev(e));
  } while (e != first && e != VG_T2_NONE);
  if (e == first) return VG_T2_NONE;
  for (e = first; (e = vg_t2_twin(t, e)) != VG_T2_NONE;) {
    e = vg_t2_next(e); /* a vertex of the border: turn back clockwise */
    if (vg_t2_to(t, e) == b) return e;
  }
  return VG_T2_NONE;
}

/* Flip the diagonal e. */
static void flip(struct vg_tri2 *t, uint32_t e)
{
  /* a -> b with apex c on the left and d on the right becomes d -> c. */
  const uint32_t o = vg_t2_twin(t, e), l = e >> 2, r = o >> 2;
  const uint32_t en = vg_t2_next(e), ep = vg_t2_prev(e);
  const uint32_t on = vg_t2_next(o), op = vg_t2_prev(o);
  const uint32_t a = vg_t2_from(t, e), b = vg_t2_from(t, o);
  const uint32_t c = vg_t2_from(t, ep), d = vg_t2_from(t, op);
  const uint32_t out[4] = { vg_t2_twin(t, on), vg_t2_twin(t, ep),
                            vg_t2_twin(t, en), vg_t2_twin(t, op) };
  const uint32_t fixed[4] = { (uint32_t)vg_t2_is_fixed(t, on),
                              (uint32_t)vg_t2_is_fixed(t, ep),
                              (uint32_t)vg_t2_is_fixed(t, en),
                              (uint32_t)vg_t2_is_fixed(t, op) };
  struct vg_t2_face *fl = &t->face[l], *fr = &t->face[r];
  /* Left: a d c, right: b c d; their outer edges are in this order. */
  const uint32_t mine[4] = { 4 * l, 4 * l + 2, 4 * r, 4 * r + 2 };

  fl->v[0] = a, fl->v[1] = d, fl->v[2] = c;
  fr->v[0] = b, fr->v[1] = c, fr->v[2] = d;
  fl->adj[1] = 4 * r + 1;
  fr->adj[1] = 4 * l + 1;
  fl->flag = (fl->flag & ~(uint32_t)VG_T2_EDGE) | fixed[0] | fixed[1] << 2;
  fr->flag = (fr->flag & ~(uint32_t)VG_T2_EDGE) | fixed[2] | fixed[3] << 2;
  for (int k = 0; k < 4; k++) {
    t->face[mine[k] >> 2].adj[mine[k] & 3] = out[k];
    if (out[k] != VG_T2_NONE) t->face[out[k] >> 2].adj[out[k] & 3] = mine[k];
  }
  fl->stamp++;
  fr->stamp++;
  t->vt[a] = 4 * l;
  t->vt[d] = 4 * l + 1;
  t->vt[b] = 4 * r;
  t->vt[c] = 4 * r + 1;
}

static int is_convex(const struct vg_tri2 *t, uint32_t e)
{
  const uint32_t a = vg_t2_from(t, e), b = vg_t2_to(t, e);
  const uint32_t c = vg_t2_apex(t, e), d = vg_t2_apex(t, vg_t2_twin(t, e));

  return vg_orient2d(t->x[d], t->x[c], t->x[a]) > 0 &&
         vg_orient2d(t->x[c], t->x[d], t->x[b]) > 0;
}

/* The half-edge through which the ray a -> b leaves the ring of a; NONE, with
 * *on set, if it runs along an edge to *on. */
static uint32_t leave_ring(const struct vg_tri2 *t, uint32_t a, uint32_t b,
                           uint32_t *on)
{
  const uint32_t first = t->vt[a];
  const double *pa = t->x[a], *pb = t->x[b];
  uint32_t e = first;

  do {
    const uint32_t v1 = vg_t2_to(t, e), v2 = vg_t2_apex(t, e);
    const double o = vg_orient2d(pa, pb, t->x[v1]);
    const int k = (pb[0] > pa[0] ? pb[0] - pa[0] : pa[0] - pb[0]) <
                  (pb[1] > pa[1] ? pb[1] - pa[1] : pa[1] - pb[1]);

    if (v1 == b || (o == 0 && (pb[k] > pa[k]) == (t->x[v1][k] > pa[k]))) {
      *on = v1;
      return VG_T2_NONE;
    }
    if (o < 0 && vg_orient2d(pa, pb, t->x[v2]) > 0) return vg_t2_next(e);
    e = vg_t2_twin(t, vg_t2_prev(e));
  } while (e != first && e != VG_T2_NONE);
  *on = a;
  return VG_T2_NONE;
}

struct pair_list {
  uint32_t (*item)[2];
  size_t n, cap, head;
};

static int pair_push(struct pair_list *l, uint32_t a, uint32_t b)
{
  if (vg_reserve(&l->item, &l->cap, l->n + 1, sizeof *l->item)) return -1;
  l->item[l->n][0] = a;
  l->item[l->n++][1] = b;
  return 0;
}

static vg_status collect_crossed(struct vg_tri2 *t, uint32_t a, uint32_t b,
                                 struct pair_list *list, int *hit,
                                 uint32_t at[2])
{
  uint32_t on = VG_T2_NONE, e = leave_ring(t, a, b, &on);

  if (e == VG_T2_NONE) {
    *hit = 1;
    at[0] = on;
    return on == b ? VG_OK : VG_ERR_GEOMETRY;
  }
  for (;;) {
    uint32_t o, w;
    double side;

    if (vg_t2_is_fixed(t, e)) {
      *hit = 2;
      at[0] = vg_t2_from(t, e);
      at[1] = vg_t2_to(t, e);
      return VG_ERR_GEOMETRY;
    }
    if (pair_push(list, vg_t2_from(t, e), vg_t2_to(t, e))) return VG_ERR_MEMORY;
    o = vg_t2_twin(t, e);
    w = vg_t2_apex(t, o);
    if (w == b) return VG_OK;
    side = vg_orient2d(t->x[a], t->x[b], t->x[w]);
    if (side == 0) {
      *hit = 1;
      at[0] = w;
      return VG_ERR_GEOMETRY;
    }
    /* o runs from the left side of the ray to the right side. */
    e = side > 0 ? vg_t2_next(o) : vg_t2_prev(o);
  }
}

static void fix_edge(struct vg_tri2 *t, uint32_t e)
{
  const uint32_t o = vg_t2_twin(t, e);

  t->face[e >> 2].flag |= 1u << (e & 3);
  if (o != VG_T2_NONE) t->face[o >> 2].flag |= 1u << (o & 3);
}

/* Flip crossed edges whose quadrilateral is convex until no edge is crossed
 * (Sloan, "A fast algorithm for generating constrained Delaunay
 * triangulations", Comput. Struct. 47, 1993). */
vg_status vg_tri2_constrain(struct vg_tri2 *t, uint32_t a, uint32_t b, int *hit,
                            uint32_t at[2])
{
  assert(a != b && a < t->n_point && b < t->n_point && hit);

  struct pair_list list = { 0 };
  vg_status st = collect_crossed(t, a, b, &list, hit, at);

  while (st == VG_OK && list.head < list.n) {
    const uint32_t u = list.item[list.head][0], v = list.item[list.head][1];
    const uint32_t e = vg_tri2_find(t, u, v);
    uint32_t c, d;

    list.head++;
    if (!is_convex(t, e)) {
      if (pair_push(&list, u, v)) st = VG_ERR_MEMORY;
      continue;
    }
    c = vg_t2_apex(t, e);
    d = vg_t2_apex(t, vg_t2_twin(t, e));
    flip(t, e);
    if (c == a || c == b || d == a || d == b) continue;
    if ((vg_orient2d(t->x[a], t->x[b], t->x[c]) > 0) !=
          (vg_orient2d(t->x[a], t->x[b], t->x[d]) > 0) &&
        pair_push(&list, c, d))
      st = VG_ERR_MEMORY;
  }
  if (st == VG_OK) fix_edge(t, vg_tri2_find(t, a, b));
  free(list.item);
  return st;
}

static int is_illegal(const struct vg_tri2 *t, uint32_t e)
{
  const uint32_t o = vg_t2_twin(t, e);

  return o != VG_T2_NONE && !vg_t2_is_fixed(t, e) &&
         in_circle(t, e >> 2, t->x[vg_t2_apex(t, o)]);
}

/* Flip e, and the edges that are no longer Delaunay as a result. */
static long settle(struct vg_tri2 *t, uint32_t e)
{
  size_t n = 1;
  long flips = 0;

  if (vg_reserve(&t->stack, &t->cap_stack, 1, sizeof *t->stack)) return -1;
  t->stack[0] = e;
  while (n) {
    const uint32_t at = t->stack[--n], l = at >> 2, r = vg_t2_twin(t, at) >> 2;

    if (!is_illegal(t, at)) continue;
    flip(t, at);
    flips++;
    if (vg_reserve(&t->stack, &t->cap_stack, n + 4, sizeof *t->stack))
      return -1;
    t->stack[n++] = 4 * l;
    t->stack[n++] = 4 * l + 2;
    t->stack[n++] = 4 * r;
    t->stack[n++] = 4 * r + 2;
  }
  return flips;
}

long vg_tri2_legalise(struct vg_tri2 *t)
{
  long total = 0;

  for (uint32_t i = 0; i < t->n_face; i++) {
    if (t->face[i].flag & VG_T2_DEAD) continue;
    for (uint32_t k = 0; k < 3; k++) {
      const uint32_t e = 4 * i + k;
      const uint32_t o = vg_t2_twin(t, e);
      long flips;

      if (o == VG_T2_NONE || o < e || !is_illegal(t, e)) continue;
      flips = settle(t, e);
      if (flips < 0) return -1;
      total += flips;
      k = UINT32_MAX; /* the face has changed: examine all its edges */
    }
  }
  return total;
}

int vg_tri2_carve(struct vg_tri2 *t)
{
  for (size_t i = 0; i < t->n_point; i++) t->vt[i] = VG_T2_NONE;
  for (uint32_t i = 0; i < t->n_face; i++) {
    struct vg_t2_face *f = &t->face[i];

    if (f->flag & VG_T2_INSIDE) {
      for (uint32_t k = 0; k < 3; k++) t->vt[f->v[k]] = 4 * i + k;
      continue;
    }
    for (int k = 0; k < 3; k++)
      if (f->adj[k] != VG_T2_NONE)
        t->face[f->adj[k] >> 2].adj[f->adj[k] & 3] = VG_T2_NONE;
    f->flag = VG_T2_DEAD;
    f->stamp++;
    if (vg_reserve(&t->unused, &t->cap_unused, t->n_unused + 1,
                   sizeof *t->unused))
      return -1;
    t->unused[t->n_unused++] = i;
  }
  return 0;
}

int vg_tri2_ring(const struct vg_tri2 *t, uint32_t v, int max, uint32_t *ring)
{
  assert(v < t->n_point && max > 0 && ring);

  const uint32_t first = t->vt[v];
  uint32_t e = first;
  int n = 0;

  if (first == VG_T2_NONE) return 0;
  do {
    if (n == max) return 0;
    ring[n++] = e;
    e = vg_t2_twin(t, vg_t2_prev(e));
    if (e == VG_T2_NONE) return 0;
  } while (e != first);
  return n;
}
