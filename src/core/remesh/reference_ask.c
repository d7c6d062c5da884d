/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/remesh/reference.h"

#include <assert.h>
#include <float.h>
#include <math.h>

#include "core/geometry/vector.h"

#define FACING 0.7 /* S22: cosine between equally oriented directions */
#define WALK 24    /* triangles tried before the tree */
#define FOLLOW 64  /* S30: triangles along which an edge is followed */
#define START 1e-6 /* of the squared distance: start point is found */
#define AROUND 48  /* most leaves around the points of one query */

static double clamp(double x)
{
  return x < 0 ? 0 : x > 1 ? 1 : x;
}

/* The nearest point on edge k of a triangle: sets its coordinates p and q for u
 * and v. Returns its squared distance minus that of corner a. */
static inline double on_edge(const struct vg_ref_tri *t, double du, double dv,
                             int k, double *p, double *q)
{
  const double uu = t->uu, uv = t->uv, vv = t->vv, ww = uu - 2 * uv + vv;
  double s;

  if (k == 0) {
    *p = uu > 0 ? clamp(du / uu) : 0;
    *q = 0;
    return *p * (*p * uu - 2 * du);
  }
  if (k == 1) {
    *p = 0;
    *q = vv > 0 ? clamp(dv / vv) : 0;
    return *q * (*q * vv - 2 * dv);
  }
  s = ww > 0 ? clamp((uu - uv - du + dv) / ww) : 0;
  *p = 1 - s;
  *q = s;
  return *p * (*p * uu - 2 * du) + s * (s * vv - 2 * dv) + 2 * *p * s * uv;
}

/* After Ericson, "Real-Time Collision Detection", 2005, 5.1.5: the nearest
 * point is inside the triangle or on an edge that x is beyond. */
double vg_ref_tri_nearest(const struct vg_ref_tri *t, const double x[3],
                          double *s, double *r)
{
  double d[3], du, dv, det, a, b;

  vg_sub(x, t->a, d);
  du = vg_dot(d, t->u);
  dv = vg_dot(d, t->v);
  det = t->uu * t->vv - t->uv * t->uv;
  a = t->vv * du - t->uv * dv;
  b = t->uu * dv - t->uv * du;
  if (a >= 0 && b >= 0 && a + b <= det && det > 0) {
    a /= det;
    b /= det;
  } else {
    const int flat = !(det > 0);
    const int beyond[3] = { b < 0 || flat, a < 0 || flat, a + b > det || flat };
    double best = INFINITY, p, q, e2;

    a = b = 0;
    for (int k = 0; k < 3; k++) {
      if (!beyond[k]) continue;
      e2 = on_edge(t, du, dv, k, &p, &q);
      if (e2 < best) best = e2, a = p, b = q;
    }
  }
  *s = a;
  *r = b;
  for (int k = 0; k < 3; k++) d[k] -= a * t->u[k] + b * t->v[k];
  return vg_dot(d, d);
}

/* A triangle without a normal is oriented like any n. */
static int faces(const struct vg_ref_tri *t, const double *n)
{
  double c;

  if (!n) return 1;
  c = vg_dot(t->n, n);
  return c > FACING || (c == 0 && vg_dot(t->n, t->n) == 0);
}

/* May a triangle below the node be oriented like n? Conservative with respect
 * to rounding. */
static int may_face(const struct vg_ref *r, size_t node, const double *n)
{
  const struct vg_ref_node *b = vg_ref_node(r, node);
  double most = 0;

  if (!n) return 1;
  for (int k = 0; k < 3; k++) most += n[k] * b->normal[n[k] > 0][k];
  return most > (FACING - 0.01) * VG_REF_NORMAL;
}

/* Is the plane of a triangle within the distance? */
static int plane_near(const struct vg_ref_tri *t, const double x[3],
                      double limit)
{
  double d[3], off;

  vg_sub(x, t->a, d);
  off = vg_dot(d, t->n);
  return off * off <= limit;
}

/* Walk from triangle *t to neighbours nearer to x, until no neighbour is nearer
 * or a triangle oriented like n is within `enough` (squared). Returns the
 * squared distance; INFINITY if the last triangle is not oriented like n. */
static double walk(const struct vg_ref *r, const double x[3], const double *n,
                   double enough, uint32_t *t, double *s, double *q)
{
  double best = vg_ref_tri_nearest(&r->shape[*t], x, s, q);
  uint32_t from = VG_REF_NONE;

  for (int i = 0; i < WALK; i++) {
    uint32_t to = VG_REF_NONE;

    if (!r->mate || (best <= enough && faces(&r->shape[*t], n))) break;
    for (uint32_t h = 3 * *t; h < 3 * *t + 3; h++) {
      uint32_t u = r->mate[h] == VG_REF_NONE ? from : r->mate[h] / 3;
      double us, uq, d2;

      if (u == from) continue;
      d2 = vg_ref_tri_nearest(&r->shape[u], x, &us, &uq);
      if (!(d2 < best)) continue;
      best = d2;
      to = u;
      *s = us;
      *q = uq;
    }
    if (to == VG_REF_NONE) break;
    from = *t;
    *t = to;
  }
  return faces(&r->shape[*t], n) ? best : INFINITY;
}

/* A search for a triangle oriented like n (NULL: any). */
struct finding {
  const struct vg_ref *r;
  const double *x, *n;
  double best; /* Squared distance: limit, or that of `at`. */
  double s, q; /* Barycentric coordinates of the point found. */
  uint32_t at; /* Triangle found; VG_REF_NONE: none yet. */
};

static inline int enter_within(void *context, size_t node)
{
  const struct finding *f = context;

  return vg_box_distance2(vg_box_tree_node(&f->r->tree, node), f->x) <=
           f->best &&
         may_face(f->r, node, f->n);
}

static inline int find_within(void *context, size_t node)
{
  struct finding *f = context;
  const struct vg_box_tree *tree = &f->r->tree;
  const size_t end = vg_box_tree_end(tree, node);

  for (size_t k = vg_box_tree_first(tree, node); k < end; k++) {
    const struct vg_ref_tri *t = &f->r->shape[tree->item[k]];
    double d2;

    if (!faces(t, f->n) || !plane_near(t, f->x, f->best)) continue;
    d2 = vg_ref_tri_nearest(t, f->x, &f->s, &f->q);
    if (!(d2 <= f->best)) continue;
    f->best = d2;
    f->at = tree->item[k];
    return 1;
  }
  return 0;
}

int vg_ref_within(const struct vg_ref *r, const double x[3], const double n[3],
                  double distance, uint32_t *hint, double *d2)
{
  struct finding f = { r, x, n, distance * distance, 0, 0, VG_REF_NONE };

  assert(distance >= 0 && hint && d2);
  if (*hint != VG_REF_NONE) {
    f.at = *hint;
    *d2 = walk(r, x, n, f.best, &f.at, &f.s, &f.q);
    if (*d2 <= f.best) {
      *hint = f.at;
      return 1;
    }
  }
  if (!vg_box_tree_visit(&r->tree, enter_within, find_within, &f)) return 0;
  *d2 = f.best;
  *hint = f.at;
  return 1;
}

static inline int enter_nearer(void *context, size_t node, double d2)
{
  const struct finding *f = context;

  return d2 <= f->best && may_face(f->r, node, f->n);
}

/* Of several triangles at the same distance, take the one with the lowest
 * number. */
static inline void find_nearer(void *context, size_t node)
{
  struct finding *f = context;
  const struct vg_box_tree *tree = &f->r->tree;
  const size_t end = vg_box_tree_end(tree, node);

  for (size_t k = vg_box_tree_first(tree, node); k < end; k++) {
    const struct vg_ref_tri *t = &f->r->shape[tree->item[k]];
    double d2, s, q;

    if (!faces(t, f->n) || !plane_near(t, f->x, f->best)) continue;
    d2 = vg_ref_tri_nearest(t, f->x, &s, &q);
    if (d2 < f->best || (d2 == f->best && tree->item[k] < f->at)) {
      f->best = d2;
      f->at = tree->item[k];
      f->s = s;
      f->q = q;
    }
  }
}

static double search(const struct vg_ref *r, const double x[3], const double *n,
                     uint32_t *hint, double out[3])
{
  struct finding f = { r, x, n, INFINITY, 0, 0, VG_REF_NONE };

  if (*hint != VG_REF_NONE) {
    uint32_t t = *hint;

    f.best = walk(r, x, n, 0, &t, &f.s, &f.q);
    if (f.best < INFINITY) f.at = t;
  }
  vg_box_tree_approach(&r->tree, x, enter_nearer, find_nearer, &f);
  if (f.at == VG_REF_NONE) return INFINITY;
  *hint = f.at;
  for (int k = 0; k < 3; k++)
    out[k] = r->shape[f.at].a[k] + f.s * r->shape[f.at].u[k] +
             f.q * r->shape[f.at].v[k];
  return sqrt(f.best);
}

double vg_ref_nearest(const struct vg_ref *r, const double x[3],
                      const double n[3], uint32_t *hint, double out[3])
{
  assert(hint && r->n_tri > 0);

  double d = search(r, x, n, hint, out);

  return n && !(d < INFINITY) ? search(r, x, NULL, hint, out) : d;
}

/* Weights of the corners of a triangle at x, and their change along e, both
 * times the square of twice the area. */
static void weights(const struct vg_ref_tri *t, const double x[3],
                    const double e[3], double f[3], double df[3])
{
  const double det = t->uu * t->vv - t->uv * t->uv;
  double d[3];

  vg_sub(x, t->a, d);
  for (int i = 0; i < 2; i++) {
    const double *y = i ? e : d;
    const double yu = vg_dot(y, t->u), yv = vg_dot(y, t->v);
    double *to = i ? df : f;

    to[1] = t->vv * yu - t->uv * yv;
    to[2] = t->uu * yv - t->uv * yu;
    to[0] = (i ? 0 : det) - to[1] - to[2];
  }
}

int vg_ref_leaves(const struct vg_ref *r, const double a[3], const double b[3],
                  const double n[3], double distance, uint32_t hint,
                  double x[3])
{
  const double limit = distance * distance;
  uint32_t t = hint, entry = 3;
  double e[3], f[3], df[3], s, q, at = 0;

  assert(distance >= 0 && hint < r->n_tri);
  vg_sub(b, a, e);
  /* If a is on a feature edge, the hint may be on its other side. */
  if (!(walk(r, a, n, START * limit, &t, &s, &q) <= limit) &&
      !(search(r, a, n, &t, x) < INFINITY))
    return 0;
  for (int i = 0; i < FOLLOW; i++) {
    uint32_t out = 3, g;
    double end = 1;

    weights(&r->shape[t], a, e, f, df);
    for (uint32_t k = 0; k < 3; k++) {
      const uint32_t c = (k + 2) % 3; /* corner opposite edge k */

      if (k == entry || !(df[c] < 0) || !(-f[c] > end * df[c])) continue;
      end = -f[c] / df[c];
      out = k;
    }
    if (out == 3) return 0;
    if (end > at) at = end;
    for (int k = 0; k < 3; k++) x[k] = a[k] + at * e[k];
    if (vg_ref_tri_nearest(&r->shape[t], x, &s, &q) > limit) return 1;
    g = r->mate[3 * t + out];
    if (g == VG_REF_NONE || !faces(&r->shape[g / 3], n)) return 0;
    t = g / 3;
    entry = g % 3;
  }
  return 0;
}

double vg_ref_project(const struct vg_ref *r, const double x[3],
                      const double n[3], uint32_t *hint, double out[3])
{
  assert(hint && *hint < r->n_tri);

  uint32_t t = *hint;
  double s, q, d2 = walk(r, x, n, 0, &t, &s, &q);

  if (!(d2 < INFINITY)) return INFINITY;
  *hint = t;
  for (int k = 0; k < 3; k++)
    out[k] = r->shape[t].a[k] + s * r->shape[t].u[k] + q * r->shape[t].v[k];
  return sqrt(d2);
}

/* --- queries for several points ------------------------------------------- */

/* A search for leaves or triangles within a distance of a box. */
struct around {
  const struct vg_ref *r;
  const struct vg_box *box;
  double limit;  /* Squared distance. */
  size_t n, cap; /* Number found; the first cap of them are stored. */
  size_t *leaf;  /* [cap] Leaves, if these are searched for. */
  uint32_t *tri; /* [cap] Triangles, if these are searched for. */
};

static inline int enter_around(void *context, size_t node)
{
  const struct around *a = context;

  return vg_box_gap2(vg_box_tree_node(&a->r->tree, node), a->box) <= a->limit;
}

static inline int list_leaf(void *context, size_t node)
{
  struct around *a = context;

  if (a->n++ == a->cap) return 1;
  a->leaf[a->n - 1] = node;
  return 0;
}

/* Leaves within the square root of `limit` of the box. Returns their number, or
 * cap + 1 if there are more. */
static size_t leaves_around(const struct vg_ref *r, const struct vg_box *box,
                            double limit, size_t cap, size_t *leaf)
{
  struct around a = { r, box, limit, 0, cap, leaf, NULL };

  vg_box_tree_visit(&r->tree, enter_around, list_leaf, &a);
  return a.n;
}

static double best_of_leaf(const struct vg_ref *r, size_t node,
                           const double x[3], double best, uint32_t *at)
{
  const struct vg_box_tree *tree = &r->tree;
  const size_t end = vg_box_tree_end(tree, node);

  for (size_t k = vg_box_tree_first(tree, node); k < end; k++) {
    const struct vg_ref_tri *t = &r->shape[tree->item[k]];
    double s, q, d2;

    if (tree->item[k] == *at || !plane_near(t, x, best)) continue;
    d2 = vg_ref_tri_nearest(t, x, &s, &q);
    if (d2 < best) best = d2, *at = tree->item[k];
  }
  return best;
}

void vg_ref_distances(const struct vg_ref *r, size_t n, const double (*x)[3],
                      uint32_t *hint, double *d)
{
  size_t leaf[AROUND], n_leaf;
  uint32_t at[VG_REF_GROUP];
  struct vg_box box = VG_BOX_EMPTY;
  double most = 0, y[3];

  assert(n <= VG_REF_GROUP && hint);
  for (size_t i = 0; i < n; i++) {
    double s, q;

    if (*hint == VG_REF_NONE) search(r, x[i], NULL, hint, y);
    d[i] = walk(r, x[i], NULL, 0, hint, &s, &q);
    at[i] = *hint;
    if (d[i] > most) most = d[i];
    vg_box_add(&box, x[i]);
  }
  n_leaf = leaves_around(r, &box, most, AROUND, leaf);
  for (size_t i = 0; i < n; i++) {
    if (n_leaf > AROUND) {
      d[i] = search(r, x[i], NULL, &at[i], y);
      continue;
    }
    for (size_t k = 0; k < n_leaf; k++)
      if (vg_box_distance2(vg_box_tree_node(&r->tree, leaf[k]), x[i]) <= d[i])
        d[i] = best_of_leaf(r, leaf[k], x[i], d[i], &at[i]);
    d[i] = sqrt(d[i]);
  }
  if (n) *hint = at[n - 1];
}

static inline int list_triangles(void *context, size_t node)
{
  struct around *a = context;
  const struct vg_box_tree *tree = &a->r->tree;
  const size_t end = vg_box_tree_end(tree, node);

  for (size_t k = vg_box_tree_first(tree, node); k < end; k++, a->n++)
    if (a->n < a->cap) a->tri[a->n] = tree->item[k];
  return a->tri && a->n > a->cap;
}

size_t vg_ref_around(const struct vg_ref *r, const struct vg_box *box,
                     double distance, size_t cap, uint32_t *tri)
{
  struct around a = { r, box, distance * distance, 0, cap, NULL, tri };

  assert(distance >= 0 && (tri || !cap));
  vg_box_tree_visit(&r->tree, enter_around, list_triangles, &a);
  return a.n;
}

/* --- sizes --------------------------------------------------------------- */

/* The size that triangle t determines at x: interpolated at the nearest point,
 * or that of a corner, plus growth with the distance. */
double vg_ref_size_by(const struct vg_ref *r, uint32_t t, const double x[3])
{
  assert(t < r->n_tri);

  const uint32_t *c = r->tri[t];
  double s, q, h, d = sqrt(vg_ref_tri_nearest(&r->shape[t], x, &s, &q));

  h = (1 - s - q) * r->size[c[0]] + s * r->size[c[1]] + q * r->size[c[2]] +
      r->slope * d;
  for (int k = 0; k < 3; k++) {
    double own = r->size[c[k]];

    if (own >= h) continue;
    h = fmin(h, own + r->slope * vg_distance(r->point[c[k]], x));
  }
  return h;
}

/* Can triangle t determine a size below h at x? */
static int may_ask(const struct vg_ref *r, uint32_t t, const double x[3],
                   double h)
{
  const uint32_t *c = r->tri[t];
  double least = r->size[c[0]], room;

  if (r->size[c[1]] < least) least = r->size[c[1]];
  if (r->size[c[2]] < least) least = r->size[c[2]];
  room = h - least;
  if (!(room > 0)) return 0;
  room = room / r->slope + r->shape[t].far;
  return vg_distance2(x, r->shape[t].a) < room * room;
}

/* A search for the triangle that determines the size at x. */
struct asking {
  const struct vg_ref *r;
  const double *x;
  double h;    /* Least size so far. */
  uint32_t by; /* Triangle that determines it. */
};

static inline int enter_smaller(void *context, size_t node, double d2)
{
  const struct asking *a = context;
  const double room = (a->h - vg_ref_node(a->r, node)->size) / a->r->slope;

  return room > 0 && d2 < room * room;
}

static inline void ask_leaf(void *context, size_t node)
{
  struct asking *a = context;
  const struct vg_box_tree *tree = &a->r->tree;
  const size_t end = vg_box_tree_end(tree, node);

  for (size_t k = vg_box_tree_first(tree, node); k < end; k++) {
    double asked;

    if (!may_ask(a->r, tree->item[k], a->x, a->h)) continue;
    asked = vg_ref_size_by(a->r, tree->item[k], a->x);
    if (!(asked < a->h)) continue;
    a->h = asked;
    a->by = tree->item[k];
  }
}

double vg_ref_size(const struct vg_ref *r, const double x[3], double most,
                   uint32_t *by)
{
  struct asking a = { r, x, INFINITY, *by };

  assert(most > 0);
  if (*by != VG_REF_NONE) a.h = vg_ref_size_by(r, *by, x);
  if (a.h > most)
    a.h = most * (1 + 4 * DBL_EPSILON); /* slightly above, so that
                                           the triangle is still
                                           found */
  vg_box_tree_approach(&r->tree, x, enter_smaller, ask_leaf, &a);
  *by = a.by;
  return a.h;
}

/* --- rays ---------------------------------------------------------------- */

struct ray {
  const struct vg_ref *ref;
  const double *x, *d;
  double inverse[3], reach; /* `reach`: distance of the nearest triangle so
                               far. */
  uint32_t tri;
};

static inline int ray_enters(void *context, size_t node)
{
  const struct ray *r = context;
  const struct vg_box *b = vg_box_tree_node(&r->ref->tree, node);
  double from = 0, to = r->reach;

  for (int k = 0; k < 3; k++) {
    double s = (b->lo[k] - r->x[k]) * r->inverse[k];
    double t = (b->hi[k] - r->x[k]) * r->inverse[k];

    if (r->d[k] == 0) {
      if (r->x[k] < b->lo[k] || r->x[k] > b->hi[k]) return 0;
      continue;
    }
    from = fmax(from, fmin(s, t));
    to = fmin(to, fmax(s, t));
  }
  return from <= to;
}

/* After Moeller and Trumbore, "Fast, minimum storage ray/triangle
 * intersection", Journal of Graphics Tools 2(1), 1997; front sides only. */
static void ray_meets(struct ray *r, uint32_t t)
{
  const struct vg_ref_tri *s = &r->ref->shape[t];
  double p[3], q[3], w[3], det, a, b, far;

  vg_cross(r->d, s->v, p);
  det = vg_dot(s->u, p);
  if (!(det > 0)) return;
  vg_sub(r->x, s->a, w);
  a = vg_dot(w, p);
  if (a < 0 || a > det) return;
  vg_cross(w, s->u, q);
  b = vg_dot(r->d, q);
  if (b < 0 || a + b > det) return;
  far = vg_dot(s->v, q) / det;
  if (!(far > 0) || far > r->reach || (far == r->reach && t > r->tri)) return;
  r->reach = far;
  r->tri = t;
}

static inline int ray_leaf(void *context, size_t node)
{
  struct ray *r = context;
  const struct vg_box_tree *tree = &r->ref->tree;
  const size_t end = vg_box_tree_end(tree, node);

  for (size_t k = vg_box_tree_first(tree, node); k < end; k++)
    ray_meets(r, tree->item[k]);
  return 0;
}

uint32_t vg_ref_ray(const struct vg_ref *r, const double x[3],
                    const double d[3], double most, double *far)
{
  struct ray ray = { r,    x,          d, { 1 / d[0], 1 / d[1], 1 / d[2] },
                     most, VG_REF_NONE };

  vg_box_tree_visit(&r->tree, ray_enters, ray_leaf, &ray);
  *far = ray.reach;
  return ray.tri;
}
