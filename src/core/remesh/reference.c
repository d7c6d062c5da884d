#include "core/remesh/reference.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/hilbert.h"
#include "core/geometry/vector.h"

#define LEAF 4
#define FACING 0.7        /* S22: cosine between what faces the same
                             way */
#define FLAT 1e-9         /* height over edge, below which a normal is noise */
#define DEPTH 64
#define PIECE 2.0         /* mean edges, about: longer triangles are cut up */
#define PIECES 64         /* at most */

/* --- building ------------------------------------------------------------ */

struct side {
  uint32_t lo, hi, half;
};

static int by_nodes(const void *pa, const void *pb)
{
  const struct side *a = pa, *b = pb;

  if (a->lo != b->lo) return a->lo < b->lo ? -1 : 1;
  if (a->hi != b->hi) return a->hi < b->hi ? -1 : 1;
  return (a->half > b->half) - (a->half < b->half);
}

static vg_status refuse(const struct vg_ref *r, const struct side *s,
                        const char *what, struct vg_error *err)
{
  const double *x = r->point[s->lo];

  return vg_fail(err, VG_ERR_INPUT, "triangle %zu of the surface, at (%g, %g, "
                 "%g): %s; vanguard check names all such places",
                 (size_t)s->half / 3 + 1, x[0], x[1], x[2], what);
}

static vg_status find_mates(struct vg_ref *r, struct vg_error *err)
{
  const size_t n = 3 * r->n_tri;
  struct side *s = vg_alloc(n, sizeof *s);
  vg_status st = VG_OK;

  if (!s) return vg_fail_memory(err, "the edges of the surface");
  for (size_t i = 0; i < n; i++) {
    uint32_t a = r->tri[i / 3][i % 3], b = r->tri[i / 3][(i + 1) % 3];

    s[i] = (struct side){ a < b ? a : b, a < b ? b : a, (uint32_t)i };
    r->mate[i] = VG_REF_NONE;
  }
  qsort(s, n, sizeof *s, by_nodes);
  for (size_t i = 0, end; i < n && st >= 0; i = end) {
    for (end = i + 1; end < n && s[end].lo == s[i].lo
         && s[end].hi == s[i].hi;) end++;
    if (end - i > 2)
      st = refuse(r, &s[i], "an edge of it has three triangles", err);
    if (end - i != 2) continue;
    if (r->tri[s[i].half / 3][s[i].half % 3]
        == r->tri[s[i + 1].half / 3][s[i + 1].half % 3])
      st = refuse(r, &s[i], "it is turned the other way than its neighbour",
                  err);
    r->mate[s[i].half] = s[i + 1].half;
    r->mate[s[i + 1].half] = s[i].half;
  }
  free(s);
  return st;
}

static void make_shape(struct vg_ref *r, size_t t)
{
  struct vg_ref_tri *s = &r->shape[t];
  const double *b = r->point[r->tri[t][1]], *c = r->point[r->tri[t][2]];
  double w[3], most;

  memcpy(s->a, r->point[r->tri[t][0]], sizeof s->a);
  vg_sub(b, s->a, s->u);
  vg_sub(c, s->a, s->v);
  vg_sub(c, b, w);
  vg_cross(s->u, s->v, s->n);
  most = fmax(vg_dot(w, w), fmax(vg_dot(s->u, s->u), vg_dot(s->v, s->v)));
  if (!(vg_unit(s->n) > FLAT * most)) memset(s->n, 0, sizeof s->n);
}

/* Needles are put into the tree in pieces, so that boxes about them are not
 * large and empty: parts between planes across their longest edge. */
struct piece {
  double lo[3], hi[3];
  uint32_t tri;
};

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

static void into_box(struct piece *p, const double x[3])
{
  for (int k = 0; k < 3; k++) {
    p->lo[k] = fmin(p->lo[k], x[k]);
    p->hi[k] = fmax(p->hi[k], x[k]);
  }
}

/* The box about triangle t between parts from and to of its longest edge. */
static void box_piece(const struct vg_ref *r, size_t t, int edge, double from,
                      double to, struct piece *p)
{
  const double *a = r->point[r->tri[t][edge]];
  double along[3], s[3], l2;

  *p = (struct piece){ { INFINITY, INFINITY, INFINITY },
                       { -INFINITY, -INFINITY, -INFINITY }, (uint32_t)t };
  vg_sub(r->point[r->tri[t][(edge + 1) % 3]], a, along);
  l2 = vg_dot(along, along);
  for (int k = 0; k < 3; k++) {
    double d[3];

    vg_sub(r->point[r->tri[t][k]], a, d);
    s[k] = l2 > 0 ? vg_dot(d, along) / l2 : 0;
    if (s[k] >= from && s[k] <= to) into_box(p, r->point[r->tri[t][k]]);
  }
  for (int k = 0; k < 3; k++)
    for (int side = 0; side < 2; side++) {
      int m = (k + 1) % 3;
      double cut = side ? to : from, x[3], u;

      if (!((s[k] - cut) * (s[m] - cut) < 0)) continue;
      u = (cut - s[k]) / (s[m] - s[k]);
      for (int d = 0; d < 3; d++)
        x[d] = r->point[r->tri[t][k]][d]
               + u * (r->point[r->tri[t][m]][d] - r->point[r->tri[t][k]][d]);
      into_box(p, x);
    }
}

/* As many pieces as make them about as long as the mean edge. */
static vg_status make_pieces(const struct vg_ref *r, struct piece **out,
                             size_t *n, struct vg_error *err)
{
  double area = 0, step;
  size_t cap = 0;
  int edge = 0;

  for (size_t t = 0; t < r->n_tri; t++) {
    double x[3];

    vg_cross(r->shape[t].u, r->shape[t].v, x);
    area += vg_norm(x) / 2;
  }
  step = PIECE * sqrt(area / (double)r->n_tri);
  for (size_t t = 0; t < r->n_tri; t++) {
    double parts = ceil(longest_edge(r, t, &edge) / step);
    int k = parts > 1 ? parts < PIECES ? (int)parts : PIECES : 1;

    if (vg_reserve(out, &cap, *n + (size_t)k, sizeof **out))
      return vg_fail_memory(err, "the tree of the surface");
    for (int i = 0; i < k; i++)
      box_piece(r, t, edge, i ? (double)i / k : -1,
                i + 1 < k ? (double)(i + 1) / k : 2, &(*out)[(*n)++]);
  }
  return VG_OK;
}

static void leaf_size(const struct vg_ref *r, size_t leaf,
                      struct vg_ref_node *b)
{
  b->size = INFINITY;
  for (size_t i = LEAF * leaf; i < LEAF * (leaf + 1) && i < r->n_item; i++)
    for (int c = 0; c < 3; c++)
      b->size = fmin(b->size, r->size[r->tri[r->item[i]][c]]);
}

static void leaf_box(const struct vg_ref *r, const struct piece *piece,
                     const uint32_t *order, size_t leaf,
                     struct vg_ref_node *b)
{
  for (int k = 0; k < 3; k++) b->lo[k] = INFINITY, b->hi[k] = -INFINITY;
  b->size = INFINITY;
  for (size_t i = LEAF * leaf; i < LEAF * (leaf + 1) && i < r->n_item; i++)
    for (int k = 0; k < 3; k++) {
      b->lo[k] = fmin(b->lo[k], piece[order[i]].lo[k]);
      b->hi[k] = fmax(b->hi[k], piece[order[i]].hi[k]);
    }
}

/* Inner nodes from their children. */
static void join_nodes(struct vg_ref *r)
{
  for (size_t i = r->first_leaf; i-- > 0;) {
    struct vg_ref_node *b = &r->node[i];

    *b = r->node[2 * i + 1];
    for (int k = 0; k < 3; k++) {
      b->lo[k] = fmin(b->lo[k], r->node[2 * i + 2].lo[k]);
      b->hi[k] = fmax(b->hi[k], r->node[2 * i + 2].hi[k]);
    }
    b->size = fmin(b->size, r->node[2 * i + 2].size);
  }
}

static vg_status make_tree(struct vg_ref *r, const struct piece *piece,
                           struct vg_error *err)
{
  double (*middle)[3] = vg_alloc(r->n_item, sizeof *middle);
  uint32_t *order = vg_alloc(r->n_item, sizeof *order);
  size_t n_leaf = 1;
  vg_status st;

  while (LEAF * n_leaf < r->n_item) n_leaf *= 2;
  r->first_leaf = n_leaf - 1;
  r->item = vg_alloc(r->n_item, sizeof *r->item);
  r->node = vg_alloc(2 * n_leaf - 1, sizeof *r->node);
  if (!middle || !order || !r->item || !r->node)
    VG_TRY(vg_fail_memory(err, "the tree of the surface"));
  for (size_t i = 0; i < r->n_item; i++)
    for (int k = 0; k < 3; k++)
      middle[i][k] = (piece[i].lo[k] + piece[i].hi[k]) / 2;
  VG_TRY(vg_hilbert_order(r->n_item, (const double (*)[3])middle, order, err));
  for (size_t i = 0; i < r->n_item; i++) r->item[i] = piece[order[i]].tri;
  for (size_t i = 0; i < n_leaf; i++)
    leaf_box(r, piece, order, i, &r->node[r->first_leaf + i]);
  join_nodes(r);
done:
  free(middle);
  free(order);
  return st;
}

static vg_status build(struct vg_ref *r, const struct vg_mesh *m,
                       int with_mates, struct vg_error *err)
{
  struct vg_ref made = { .n_point = m->n_point, .n_tri = m->n_tri,
    .point = (const double (*)[3])m->point,
    .tri = (const uint32_t (*)[3])m->tri };
  struct piece *piece = NULL;
  vg_status st = VG_OK;

  if (with_mates) made.mate = vg_alloc(3 * m->n_tri, sizeof *made.mate);
  made.shape = vg_alloc(m->n_tri, sizeof *made.shape);
  if ((with_mates && !made.mate) || !made.shape)
    VG_TRY(vg_fail_memory(err, "the tree of the surface"));
  if (with_mates) VG_TRY(find_mates(&made, err));
  for (size_t t = 0; t < m->n_tri; t++) make_shape(&made, t);
  VG_TRY(make_pieces(&made, &piece, &made.n_item, err));
  VG_TRY(make_tree(&made, piece, err));
  *r = made;
  made = (struct vg_ref)VG_REF_INIT;
done:
  free(piece);
  vg_ref_release(&made);
  return st;
}

vg_status vg_ref_build(struct vg_ref *r, const struct vg_mesh *m,
                       struct vg_error *err)
{
  return build(r, m, 1, err);
}

vg_status vg_ref_build_tree(struct vg_ref *r, const struct vg_mesh *m,
                            struct vg_error *err)
{
  return build(r, m, 0, err);
}

void vg_ref_sizes(struct vg_ref *r)
{
  for (size_t i = 0; i <= r->first_leaf; i++)
    leaf_size(r, i, &r->node[r->first_leaf + i]);
  join_nodes(r);
}

void vg_ref_release(struct vg_ref *r)
{
  free(r->mate);
  free(r->shape);
  free(r->size);
  free(r->item);
  free(r->node);
  memset(r, 0, sizeof *r);
}

/* --- questions ----------------------------------------------------------- */

static double clamp(double x)
{
  return x < 0 ? 0 : x > 1 ? 1 : x;
}

/* Barycentric coordinates (of u and v) of the nearest point of a triangle to
 * x; returns the squared distance. After Ericson, "Real-Time Collision
 * Detection", 2005, 5.1.5. */
static double nearest(const struct vg_ref_tri *t, const double x[3],
                      double *s, double *r)
{
  double d[3], uu, uv, vv, du, dv, det, a, b;

  vg_sub(x, t->a, d);
  uu = vg_dot(t->u, t->u);
  uv = vg_dot(t->u, t->v);
  vv = vg_dot(t->v, t->v);
  du = vg_dot(d, t->u);
  dv = vg_dot(d, t->v);
  det = uu * vv - uv * uv;
  a = vv * du - uv * dv;
  b = uu * dv - uv * du;
  if (a >= 0 && b >= 0 && a + b <= det && det > 0) {
    a /= det;
    b /= det;
  } else {
    double ww = uu - 2 * uv + vv, best = INFINITY;
    const double edge[3][2] = {
      { uu > 0 ? clamp(du / uu) : 0, 0 },
      { 0, vv > 0 ? clamp(dv / vv) : 0 },
      { 1, ww > 0 ? clamp((uu - uv - du + dv) / ww) : 0 } };

    a = b = 0;
    for (int k = 0; k < 3; k++) {
      double p = k < 2 ? edge[k][0] : 1 - edge[2][1];
      double q = k < 2 ? edge[k][1] : edge[2][1];
      double e2 = p * p * uu + 2 * p * q * uv + q * q * vv
                  - 2 * (p * du + q * dv);

      if (e2 < best) best = e2, a = p, b = q;
    }
  }
  *s = a;
  *r = b;
  for (int k = 0; k < 3; k++) d[k] -= a * t->u[k] + b * t->v[k];
  return vg_dot(d, d);
}

static double box2(const struct vg_ref_node *b, const double x[3])
{
  double sum = 0;

  for (int k = 0; k < 3; k++) {
    double below = b->lo[k] - x[k], above = x[k] - b->hi[k];
    double d = below > 0 ? below : above > 0 ? above : 0;

    sum += d * d;
  }
  return sum;
}

/* Triangles without a normal face every way. */
static int faces(const struct vg_ref_tri *t, const double *n)
{
  double c;

  if (!n) return 1;
  c = vg_dot(t->n, n);
  return c > FACING || (c == 0 && vg_dot(t->n, t->n) == 0);
}

/* Does the plane of a triangle come within the distance? */
static int plane_near(const struct vg_ref_tri *t, const double x[3],
                      double limit)
{
  double d[3], off;

  vg_sub(x, t->a, d);
  off = vg_dot(d, t->n);
  return off * off <= limit;
}

int vg_ref_within(const struct vg_ref *r, const double x[3],
                  const double n[3], double distance, uint32_t *hint,
                  double *d2)
{
  size_t stack[DEPTH];
  double limit = distance * distance, s, q;
  int top = 0;

  if (*hint != VG_REF_NONE && faces(&r->shape[*hint], n)
      && (*d2 = nearest(&r->shape[*hint], x, &s, &q)) <= limit) return 1;
  stack[top++] = 0;
  while (top) {
    size_t i = stack[--top], leaf;

    if (box2(&r->node[i], x) > limit) continue;
    if (i < r->first_leaf) {
      stack[top++] = 2 * i + 2;
      stack[top++] = 2 * i + 1;
      continue;
    }
    leaf = LEAF * (i - r->first_leaf);
    for (size_t k = leaf; k < leaf + LEAF && k < r->n_item; k++) {
      const struct vg_ref_tri *t = &r->shape[r->item[k]];

      if (!faces(t, n) || !plane_near(t, x, limit)) continue;
      *d2 = nearest(t, x, &s, &q);
      if (!(*d2 <= limit)) continue;
      *hint = r->item[k];
      return 1;
    }
  }
  return 0;
}

static double search(const struct vg_ref *r, const double x[3],
                     const double *n, uint32_t *hint, double out[3])
{
  struct { size_t i; double d2; } stack[DEPTH];
  double best = INFINITY, s, q, bs = 0, bq = 0;
  uint32_t at = VG_REF_NONE;
  int top = 0;

  if (*hint != VG_REF_NONE && faces(&r->shape[*hint], n)) {
    best = nearest(&r->shape[*hint], x, &bs, &bq);
    at = *hint;
  }
  stack[top].i = 0;
  stack[top++].d2 = 0;
  while (top) {
    size_t i = stack[--top].i, leaf;

    if (stack[top].d2 > best) continue;
    if (i < r->first_leaf) {
      double l = box2(&r->node[2 * i + 1], x);
      double h = box2(&r->node[2 * i + 2], x);
      int left = l <= h;      /* the nearer one on top */

      stack[top].i = 2 * i + (left ? 2 : 1);
      stack[top++].d2 = left ? h : l;
      stack[top].i = 2 * i + (left ? 1 : 2);
      stack[top++].d2 = left ? l : h;
      continue;
    }
    leaf = LEAF * (i - r->first_leaf);
    for (size_t k = leaf; k < leaf + LEAF && k < r->n_item; k++) {
      const struct vg_ref_tri *t = &r->shape[r->item[k]];
      double d2;

      if (!faces(t, n) || !plane_near(t, x, best)) continue;
      d2 = nearest(t, x, &s, &q);
      if (d2 < best || (d2 == best && r->item[k] < at)) {
        best = d2;
        at = r->item[k];
        bs = s;
        bq = q;
      }
    }
  }
  if (at == VG_REF_NONE) return INFINITY;
  *hint = at;
  for (int k = 0; k < 3; k++)
    out[k] = r->shape[at].a[k] + bs * r->shape[at].u[k]
             + bq * r->shape[at].v[k];
  return sqrt(best);
}

double vg_ref_nearest(const struct vg_ref *r, const double x[3],
                      const double n[3], uint32_t *hint, double out[3])
{
  double d = search(r, x, n, hint, out);

  return n && !(d < INFINITY) ? search(r, x, NULL, hint, out) : d;
}

/* What triangle t asks for at x: the size of its nearest point, or of a
 * corner, grown with the distance. */
static double size_of(const struct vg_ref *r, uint32_t t, const double x[3])
{
  const uint32_t *c = r->tri[t];
  double s, q, h, d = sqrt(nearest(&r->shape[t], x, &s, &q));

  h = (1 - s - q) * r->size[c[0]] + s * r->size[c[1]] + q * r->size[c[2]]
      + r->slope * d;
  for (int k = 0; k < 3; k++) {
    double own = r->size[c[k]];

    if (own >= h) continue;
    h = fmin(h, own + r->slope * vg_distance(r->point[c[k]], x));
  }
  return h;
}

double vg_ref_size(const struct vg_ref *r, const double x[3], uint32_t hint)
{
  size_t stack[DEPTH];
  double h = INFINITY;
  int top = 0;

  if (hint != VG_REF_NONE) h = size_of(r, hint, x);
  stack[top++] = 0;
  while (top) {
    size_t i = stack[--top], leaf;
    double room = (h - r->node[i].size) / r->slope;

    if (!(room > 0) || box2(&r->node[i], x) >= room * room) continue;
    if (i < r->first_leaf) {
      int left = box2(&r->node[2 * i + 1], x) <= box2(&r->node[2 * i + 2], x);

      stack[top++] = 2 * i + (left ? 2 : 1);
      stack[top++] = 2 * i + (left ? 1 : 2);
      continue;
    }
    leaf = LEAF * (i - r->first_leaf);
    for (size_t k = leaf; k < leaf + LEAF && k < r->n_item; k++)
      h = fmin(h, size_of(r, r->item[k], x));
  }
  return h;
}

/* --- rays ---------------------------------------------------------------- */

struct ray {
  const double *x, *d;
  double inverse[3], reach; /* to the nearest triangle so far */
  uint32_t tri;
};

static int ray_meets_box(const struct vg_ref_node *b, const struct ray *r)
{
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
 * intersection", Journal of Graphics Tools 2(1), 1997; from the front alone. */
static void ray_meets(const struct vg_ref *ref, uint32_t t, struct ray *r)
{
  const struct vg_ref_tri *s = &ref->shape[t];
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

uint32_t vg_ref_ray(const struct vg_ref *r, const double x[3],
                    const double d[3], double most, double *far)
{
  struct ray ray = { x, d, { 1 / d[0], 1 / d[1], 1 / d[2] }, most,
                     VG_REF_NONE };
  size_t stack[DEPTH];
  int top = 0;

  stack[top++] = 0;
  while (top) {
    size_t i = stack[--top], leaf;

    if (!ray_meets_box(&r->node[i], &ray)) continue;
    if (i < r->first_leaf) {
      stack[top++] = 2 * i + 2;
      stack[top++] = 2 * i + 1;
      continue;
    }
    leaf = LEAF * (i - r->first_leaf);
    for (size_t k = leaf; k < leaf + LEAF && k < r->n_item; k++)
      ray_meets(r, r->item[k], &ray);
  }
  *far = ray.reach;
  return ray.tri;
}
