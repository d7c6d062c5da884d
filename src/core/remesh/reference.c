/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/remesh/reference.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "core/geometry/vector.h"

#define FLAT 1e-9 /* height over edge below which a normal is noise */
#define PIECE 2.0 /* mean edges: longer triangles are cut into pieces */
#define PIECES 64 /* most pieces of a triangle */
#define FEW_PIECES                                                             \
  3               /* mean number of pieces of a tree that takes less memory */
#define GRAIN 256 /* leaves per task */
#define OPPOSED                                                                \
  0.03 /* cosine below which a direction and its opposite may both be faced    \
          (S22) */

/* --- construction --------------------------------------------------------- */

static vg_status refuse(const struct vg_ref *r, uint32_t h, const char *what,
                        struct vg_error *err)
{
  const uint32_t a = vg_ref_from(r, h), b = vg_ref_to(r, h);
  const double *x = r->point[a < b ? a : b];

  return vg_fail(err, VG_ERR_INPUT,
                 "triangle %zu of the surface, at (%g, %g, %g): %s; run "
                 "`vanguard check` for a list of all such triangles",
                 (size_t)h / 3 + 1, x[0], x[1], x[2], what);
}

static vg_status find_mates(struct vg_ref *r, struct vg_error *err)
{
  struct vg_edges e = VG_EDGES_INIT;
  vg_status st = vg_edges_build(&e, r->n_point, r->n_tri, r->tri, NULL, 0, err);

  memset(r->mate, 0xff, 3 * r->n_tri * sizeof *r->mate);
  for (size_t i = 0; i < e.n && st >= 0; i++) {
    const uint32_t n = vg_edges_count(&e, i), *h = vg_edges_at(&e, i);

    if (n > 2)
      st = refuse(r, h[0],
                  "one of its edges belongs to three "
                  "triangles",
                  err);
    if (n != 2) continue;
    if (vg_edges_disagree(&e, r->tri, i))
      st = refuse(r, h[0],
                  "its orientation is opposite to that of its "
                  "neighbour",
                  err);
    r->mate[h[0]] = h[1];
    r->mate[h[1]] = h[0];
  }
  vg_edges_release(&e);
  return st;
}

void vg_ref_tri_make(struct vg_ref_tri *t, const double a[3], const double b[3],
                     const double c[3])
{
  memcpy(t->a, a, sizeof t->a);
  vg_sub(b, a, t->u);
  vg_sub(c, a, t->v);
  t->uu = vg_dot(t->u, t->u);
  t->uv = vg_dot(t->u, t->v);
  t->vv = vg_dot(t->v, t->v);
  t->far = sqrt(t->uu > t->vv ? t->uu : t->vv);
}

static void make_shape(struct vg_ref *r, size_t t)
{
  struct vg_ref_tri *s = &r->shape[t];
  const double *b = r->point[r->tri[t][1]], *c = r->point[r->tri[t][2]];
  double w[3], most;

  vg_ref_tri_make(s, r->point[r->tri[t][0]], b, c);
  vg_sub(c, b, w);
  vg_cross(s->u, s->v, s->n);
  most = fmax(vg_dot(w, w), fmax(s->uu, s->vv));
  if (!(vg_unit(s->n) > FLAT * most)) memset(s->n, 0, sizeof s->n);
}

/* Needles are put into the tree in pieces, cut by planes across their longest
 * edge, because the bounding box of a whole needle is large and mostly
 * empty. */
struct pieces {
  size_t n, cap_box, cap_tri;
  struct vg_box *box;
  uint32_t *tri;
};

static void pieces_release(struct pieces *p)
{
  free(p->box);
  free(p->tri);
}

static double longest_edge(const struct vg_ref *r, size_t t, int *which)
{
  double most = -1;

  for (int k = 0; k < 3; k++) {
    double l = vg_distance2(r->point[r->tri[t][k]],
                            r->point[r->tri[t][(k + 1) % 3]]);

    if (l > most) most = l, *which = k;
  }
  return sqrt(most);
}

/* Bounding box of triangle t between fractions `from` and `to` of its longest
 * edge. */
static struct vg_box box_piece(const struct vg_ref *r, size_t t, int edge,
                               double from, double to)
{
  struct vg_box b = VG_BOX_EMPTY;
  const double *a = r->point[r->tri[t][edge]];
  double along[3], s[3], l2;

  if (from < 0 && to > 1) {
    for (int k = 0; k < 3; k++) vg_box_add(&b, r->point[r->tri[t][k]]);
    return b;
  }
  vg_sub(r->point[r->tri[t][(edge + 1) % 3]], a, along);
  l2 = vg_dot(along, along);
  for (int k = 0; k < 3; k++) {
    double d[3];

    vg_sub(r->point[r->tri[t][k]], a, d);
    s[k] = l2 > 0 ? vg_dot(d, along) / l2 : 0;
    if (s[k] >= from && s[k] <= to) vg_box_add(&b, r->point[r->tri[t][k]]);
  }
  for (int k = 0; k < 3; k++)
    for (int side = 0; side < 2; side++) {
      int m = (k + 1) % 3;
      double cut = side ? to : from, x[3], u;

      if (!((s[k] - cut) * (s[m] - cut) < 0)) continue;
      u = (cut - s[k]) / (s[m] - s[k]);
      for (int d = 0; d < 3; d++)
        x[d] = r->point[r->tri[t][k]][d] +
               u * (r->point[r->tri[t][m]][d] - r->point[r->tri[t][k]][d]);
      vg_box_add(&b, x);
    }
  return b;
}

/* Length of a piece: about that of the mean edge, or more if triangles would
 * have more than `most` pieces on average. */
static double piece_length(const struct vg_ref *r, double most)
{
  const double n = (double)r->n_tri;
  double area = 0, sum = 0, step;
  int edge = 0;

  for (size_t t = 0; t < r->n_tri; t++) {
    double x[3];

    vg_cross(r->shape[t].u, r->shape[t].v, x);
    area += vg_norm(x) / 2;
  }
  step = PIECE * sqrt(area / n);
  if (!(step > 0) || isinf(most)) return step;
  for (size_t t = 0; t < r->n_tri; t++)
    sum += fmin(ceil(longest_edge(r, t, &edge) / step), PIECES);
  return step * fmax(sum / (most * n), 1);
}

static vg_status make_pieces(const struct vg_ref *r, double most,
                             struct pieces *p, struct vg_error *err)
{
  const double step = piece_length(r, most);
  int edge = 0;

  for (size_t t = 0; t < r->n_tri; t++) {
    double parts = ceil(longest_edge(r, t, &edge) / step);
    int k = parts > 1 ? parts < PIECES ? (int)parts : PIECES : 1;

    if (vg_reserve(&p->box, &p->cap_box, p->n + (size_t)k, sizeof *p->box) ||
        vg_reserve(&p->tri, &p->cap_tri, p->n + (size_t)k, sizeof *p->tri))
      return vg_fail_memory(err, "the tree of the surface");
    for (int i = 0; i < k; i++) {
      p->box[p->n] = box_piece(r, t, edge, i ? (double)i / k : -1,
                               i + 1 < k ? (double)(i + 1) / k : 2);
      p->tri[p->n++] = (uint32_t)t;
    }
  }
  return VG_OK;
}

static void leaf_size(const struct vg_ref *r, size_t node)
{
  struct vg_ref_node *b = vg_ref_node(r, node);

  b->size = INFINITY;
  for (size_t i = vg_box_tree_first(&r->tree, node);
       i < vg_box_tree_end(&r->tree, node); i++)
    for (int c = 0; c < 3; c++)
      b->size = fmin(b->size, r->size[r->tri[r->tree.item[i]][c]]);
}

/* A triangle without a normal counts as oriented in every direction. */
static void add_normal(struct vg_ref_node *b, const double n[3])
{
  const int any = vg_dot(n, n) == 0, most = VG_REF_NORMAL;

  for (int k = 0; k < 3; k++) {
    const int near = (int)(most * n[k]);
    int lo = any || near <= -most ? -most : near - 1;
    int hi = any || near >= most ? most : near + 1;

    if (lo < b->normal[0][k]) b->normal[0][k] = (int8_t)lo;
    if (hi > b->normal[1][k]) b->normal[1][k] = (int8_t)hi;
  }
}

static void leaf_normals(const struct vg_ref *r, size_t node)
{
  struct vg_ref_node *b = vg_ref_node(r, node);

  for (int k = 0; k < 3; k++)
    b->normal[0][k] = INT8_MAX, b->normal[1][k] = INT8_MIN;
  b->size = INFINITY;
  for (size_t i = vg_box_tree_first(&r->tree, node);
       i < vg_box_tree_end(&r->tree, node); i++)
    add_normal(b, r->shape[r->tree.item[i]].n);
}

/* Set size and normals of inner nodes from their children. */
static void join_nodes(struct vg_ref *r)
{
  for (size_t i = r->tree.first_leaf; i-- > 0;) {
    const struct vg_ref_node *p = vg_ref_node(r, 2 * i + 1), *q = p + 1;
    struct vg_ref_node *b = vg_ref_node(r, i);

    for (int k = 0; k < 3; k++) {
      b->normal[0][k] = p->normal[0][k] < q->normal[0][k] ? p->normal[0][k]
                                                          : q->normal[0][k];
      b->normal[1][k] = p->normal[1][k] > q->normal[1][k] ? p->normal[1][k]
                                                          : q->normal[1][k];
    }
    b->size = fmin(p->size, q->size);
  }
}

static vg_status make_tree(struct vg_ref *r, const struct pieces *p,
                           struct vg_error *err)
{
  vg_status st = vg_box_tree_build(&r->tree, p->n, p->box, NULL,
                                   sizeof(struct vg_ref_node), err);

  if (st < 0) return st;
  for (size_t i = 0; i < p->n; i++) r->tree.item[i] = p->tri[r->tree.item[i]];
  for (size_t i = r->tree.first_leaf; i <= 2 * r->tree.first_leaf; i++)
    leaf_normals(r, i);
  join_nodes(r);
  return VG_OK;
}

static vg_status set_faces(struct vg_ref *r, const struct vg_mesh *m,
                           int with_mates, const struct vg_stop *stop,
                           struct vg_error *err)
{
  struct vg_ref made = { .n_point = m->n_point,
                         .n_tri = m->n_tri,
                         .point = (const double(*)[3])m->point,
                         .tri = (const uint32_t(*)[3])m->tri };
  vg_status st = VG_OK;

  if (with_mates) made.mate = vg_alloc(3 * m->n_tri, sizeof *made.mate);
  made.shape = vg_alloc(m->n_tri, sizeof *made.shape);
  if ((with_mates && !made.mate) || !made.shape)
    VG_TRY(vg_fail_memory(err, "the triangles of the surface"));
  if (with_mates) VG_TRY(find_mates(&made, err));
  VG_TRY(vg_stopped(stop, err));
  for (size_t t = 0; t < m->n_tri; t++) make_shape(&made, t);
  *r = made;
  made = (struct vg_ref)VG_REF_INIT;
done:
  vg_ref_release(&made);
  return st;
}

vg_status vg_ref_set_faces(struct vg_ref *r, const struct vg_mesh *m,
                           const struct vg_stop *stop, struct vg_error *err)
{
  assert(!r->mate && !r->shape);
  return set_faces(r, m, 1, stop, err);
}

static vg_status add_tree(struct vg_ref *r, double most,
                          const struct vg_stop *stop, struct vg_error *err)
{
  struct pieces piece = { 0 };
  vg_status st;

  assert(r->shape || !r->n_tri);
  VG_TRY(make_pieces(r, most, &piece, err));
  VG_TRY(vg_stopped(stop, err));
  VG_TRY(make_tree(r, &piece, err));
done:
  pieces_release(&piece);
  return st;
}

vg_status vg_ref_add_tree(struct vg_ref *r, const struct vg_stop *stop,
                          struct vg_error *err)
{
  return add_tree(r, INFINITY, stop, err);
}

static vg_status build(struct vg_ref *r, const struct vg_mesh *m,
                       int with_mates, double most, const struct vg_stop *stop,
                       struct vg_error *err)
{
  vg_status st;

  VG_TRY(set_faces(r, m, with_mates, stop, err));
  VG_TRY(add_tree(r, most, stop, err));
done:
  if (st < 0) vg_ref_release(r);
  return st;
}

vg_status vg_ref_build(struct vg_ref *r, const struct vg_mesh *m,
                       const struct vg_stop *stop, struct vg_error *err)
{
  return build(r, m, 1, INFINITY, stop, err);
}

vg_status vg_ref_build_sparse(struct vg_ref *r, const struct vg_mesh *m,
                              const struct vg_stop *stop, struct vg_error *err)
{
  return build(r, m, 1, FEW_PIECES, stop, err);
}

vg_status vg_ref_build_tree(struct vg_ref *r, const struct vg_mesh *m,
                            const struct vg_stop *stop, struct vg_error *err)
{
  return build(r, m, 0, INFINITY, stop, err);
}

void vg_ref_sizes(struct vg_ref *r)
{
  for (size_t i = r->tree.first_leaf; i <= 2 * r->tree.first_leaf; i++)
    leaf_size(r, i);
  join_nodes(r);
}

void vg_ref_release(struct vg_ref *r)
{
  free(r->mate);
  free(r->shape);
  free(r->size);
  free(r->plain);
  free(r->strip);
  free(r->fine);
  free(r->fine_at);
  free(r->thin);
  vg_box_tree_release(&r->tree);
  memset(r, 0, sizeof *r);
}

/* --- sheets close to each other ------------------------------------------- */

struct thinning {
  struct vg_ref *r;
  double distance, far;
  const double *cap;
  const struct vg_stop *stop;
};

/* Are all corners of b on one side of the plane of a, farther than the
 * distance? */
static int apart(const struct vg_ref_tri *a, const struct vg_ref_tri *b,
                 double distance)
{
  double d[3], o, u, v;

  vg_sub(b->a, a->a, d);
  o = vg_dot(d, a->n);
  u = o + vg_dot(b->u, a->n);
  v = o + vg_dot(b->v, a->n);
  return (o > distance && u > distance && v > distance) ||
         (o < -distance && u < -distance && v < -distance);
}

static int boxes_apart(const struct vg_ref_tri *a, const struct vg_ref_tri *b,
                       double distance)
{
  for (int k = 0; k < 3; k++) {
    double al = a->a[k] + fmin(0, fmin(a->u[k], a->v[k]));
    double ah = a->a[k] + fmax(0, fmax(a->u[k], a->v[k]));
    double bl = b->a[k] + fmin(0, fmin(b->u[k], b->v[k]));
    double bh = b->a[k] + fmax(0, fmax(b->u[k], b->v[k]));

    if (bl - ah > distance || al - bh > distance) return 1;
  }
  return 0;
}

/* Is triangle u turned from t by some 90 degrees or more, or without a normal,
 * and within the distance as far as planes and boxes tell? */
static int opposes(const struct vg_ref *r, uint32_t t, uint32_t u,
                   double distance)
{
  const struct vg_ref_tri *a = &r->shape[t], *b = &r->shape[u];
  const double c = vg_dot(a->n, b->n);

  return t != u &&
         (c < OPPOSED || vg_dot(a->n, a->n) == 0 || vg_dot(b->n, b->n) == 0) &&
         !apart(a, b, distance) && !apart(b, a, distance) &&
         !boxes_apart(a, b, distance);
}

static int is_outer(const struct thinning *c, uint32_t t)
{
  return isinf(c->cap[t]);
}

/* Atomic: other leaves may contain pieces of the same triangle. */
static void mark(const struct thinning *c, uint32_t t, int as)
{
  __atomic_fetch_or(&c->r->thin[t], (uint8_t)as, __ATOMIC_RELAXED);
}

/* Mark the triangles of the leaf that another one opposes within the distance.
 * For THIN_FAR, triangles that are not outer are marked without a search. */
static void thin_leaf(const struct thinning *c, size_t leaf, double distance,
                      int as)
{
  struct vg_ref *r = c->r;
  const size_t node = r->tree.first_leaf + leaf;
  const size_t end = vg_box_tree_end(&r->tree, node);
  const uint32_t *item = r->tree.item;
  uint32_t near[1024];
  size_t cap = sizeof near / sizeof *near, n;
  size_t first = vg_box_tree_first(&r->tree, node);

  if (as == VG_REF_THIN_FAR)
    while (first < end && !is_outer(c, item[first])) mark(c, item[first++], as);
  if (first == end) return;
  n = vg_ref_around(r, vg_box_tree_node(&r->tree, node), distance, cap, near);
  for (size_t i = first; i < end; i++) {
    const uint32_t t = item[i];
    int thin = n > cap || (as == VG_REF_THIN_FAR && !is_outer(c, t));

    for (size_t k = 0; k < n && !thin; k++)
      thin = opposes(r, t, near[k], distance);
    if (thin) mark(c, t, as);
  }
}

static void thin_leaves(void *context, size_t first, size_t end, int worker)
{
  const struct thinning *c = context;

  (void)worker;
  for (size_t i = first; i < end && !vg_stops(c->stop); i++) {
    thin_leaf(c, i, c->distance, VG_REF_THIN);
    if (c->cap) thin_leaf(c, i, c->far, VG_REF_THIN_FAR);
  }
}

vg_status vg_ref_thin(struct vg_ref *r, double distance, double far,
                      const double *cap, int threads,
                      const struct vg_stop *stop, struct vg_error *err)
{
  struct thinning c = { r, distance, far, cap, stop };

  assert(distance >= 0 && far >= 0 && threads >= 0);
  free(r->thin);
  r->thin = vg_calloc(r->n_tri, 1);
  if (!r->thin) return vg_fail_memory(err, "the sheets of the surface");
  vg_parallel_for(threads, (r->tree.n + VG_BOX_LEAF - 1) / VG_BOX_LEAF, GRAIN,
                  thin_leaves, &c);
  return vg_stopped(stop, err);
}
