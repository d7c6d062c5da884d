/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/sizing/sizing_octree.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "core/geometry/tensor.h"
#include "core/sizing/sizing_build.h"

/* Cells are not split below FLOOR times the spacing (H2), or SURFACE times
 * that where the surface determines the spacing (H6), unless the growth
 * exceeds STEEP. */
#define FLOOR 1.25
#define FLOOR_SLOPE                                                            \
  0.2                /* H11: slope at which FLOOR applies; it scales with      \
                        1 / sqrt(slope) */
#define FLOOR_MOST 2 /* upper limit of the scaled floor */
#define SURFACE 2
#define STEEP 0.5
#define MOST_POINTS 68719476736.0 /* 2^36: 16 times what indices allow */

/* The compact tree, in depth-first order, which keeps cells that are near in
 * space near in memory. First the leaves and splits below each cell are
 * counted, from the last level up. Then each cell passes its first numbers on
 * to its children. */

struct compaction {
  const struct vg_octree_build *b;
  struct vg_octree *t;
  size_t first; /* first cell of the level */
};

static float corner_size(const struct vg_octree_build *b,
                         const struct vg_octree_cell *c)
{
  float least = INFINITY;
  double det = INFINITY, h[6];

  for (int i = 0; i < 8 && !b->tensor; i++)
    least = fminf(least, b->point[c->corner[i]].h);
  if (!b->tensor) return least;
  for (int i = 0; i < 8; i++) {
    for (int k = 0; k < 6; k++) h[k] = (double)b->tensor[c->corner[i]].h[k];
    det = vg_lesser(det, vg_tensor_det(h));
  }
  return (float)vg_cube_root(det);
}

static void count_body(void *context, size_t first, size_t end, int worker)
{
  const struct compaction *m = context;

  (void)worker;
  for (size_t i = m->first + first; i < m->first + end; i++) {
    struct vg_octree_cell *c = m->b->cell + i;
    struct vg_octree_span sum = { 0, 1, INFINITY };

    for (uint32_t j = 0; j < 8 && c->child; j++) {
      struct vg_octree_span below = m->b->cell[c->child + j].span;

      sum.leaf += below.leaf;
      sum.split += below.split;
      sum.least = below.least < sum.least ? below.least : sum.least;
    }
    if (!c->child) sum = (struct vg_octree_span){ 1, 0, corner_size(m->b, c) };
    c->span = sum;
  }
}

/* Are the size tensors at the corners of a leaf multiples of I? */
static int is_uniform(const struct vg_octree_build *b,
                      const struct vg_octree_cell *c)
{
  for (int i = 0; b->tensor && i < 8; i++)
    if (!vg_size_is_uniform(b->tensor[c->corner[i]].h)) return 0;
  return 1;
}

/* Corners of leaves with tensors are points of the construction until they are
 * numbered. */
static void put_leaf(const struct compaction *m, size_t cell)
{
  const struct vg_octree_cell *c = m->b->cell + cell;
  union vg_octree_leaf *leaf = m->t->leaf + c->span.leaf;
  int uniform = is_uniform(m->b, c);

  for (int i = 0; i < 8; i++)
    if (!uniform) leaf->corner[i] = c->corner[i];
    else if (m->b->tensor) leaf->h[i] = m->b->tensor[c->corner[i]].h[0];
    else leaf->h[i] = m->b->point[c->corner[i]].h;
}

static uint32_t leaf_entry(const struct compaction *m, size_t cell,
                           uint32_t leaf)
{
  uint32_t e = VG_OCTREE_LEAF | leaf;

  return is_uniform(m->b, m->b->cell + cell) ? e : e | VG_OCTREE_TENSOR;
}

static void emit_body(void *context, size_t first, size_t end, int worker)
{
  const struct compaction *m = context;

  (void)worker;
  for (size_t i = m->first + first; i < m->first + end; i++) {
    const struct vg_octree_cell *c = m->b->cell + i;
    struct vg_octree_span next = c->span;

    if (!c->child) {
      put_leaf(m, i);
      continue;
    }
    m->t->least[next.split++] = next.least;
    for (uint32_t j = 0; j < 8; j++) {
      struct vg_octree_cell *d = m->b->cell + c->child + j;
      struct vg_octree_span below = d->span;

      m->t->child[c->span.split][j] = d->child
                                      ? next.split
                                      : leaf_entry(m, c->child + j, next.leaf);
      next.least = below.least;
      d->span = next;
      next.leaf += below.leaf;
      next.split += below.split;
    }
  }
}

/* Number the tensors in the order of the tree's entries. */
static int number_tensors(const struct vg_octree_build *b, struct vg_octree *t)
{
  uint32_t *number = vg_calloc(b->n_point, sizeof *number), n = 0;
  size_t n_entry = 8 * t->n_split;
  const uint32_t *entry = n_entry ? t->child[0] : &t->root;

  if (!number) return -1;
  for (size_t i = 0; i < (n_entry ? n_entry : 1); i++) {
    union vg_octree_leaf *leaf = t->leaf + (entry[i] & VG_OCTREE_LEAF_INDEX);

    if (!(entry[i] & VG_OCTREE_LEAF) || !(entry[i] & VG_OCTREE_TENSOR))
      continue;
    for (int j = 0; j < 8; j++) {
      uint32_t *at = number + leaf->corner[j];

      if (!*at) *at = ++n;
      leaf->corner[j] = *at - 1;
    }
  }
  t->n_tensor = n;
  t->tensor = vg_alloc(n, sizeof *t->tensor);
  for (size_t i = 0; t->tensor && i < b->n_point; i++)
    if (number[i])
      memcpy(t->tensor[number[i] - 1], b->tensor[i].h, sizeof *t->tensor);
  free(number);
  return t->tensor ? 0 : -1;
}

/* Frees what is no longer needed of b: of size tensors, the points before, and
 * the cells before the tensors are numbered. */
static int compact(struct vg_octree_build *b, struct vg_octree *t)
{
  struct compaction m = { .b = b, .t = t };
  size_t n_split = b->n_cell / 8;
  int bad;

  if (b->tensor) {
    free(b->point);
    b->point = NULL;
  }
  t->child = vg_alloc(n_split, sizeof *t->child);
  t->least = vg_alloc(n_split, sizeof *t->least);
  t->leaf = vg_alloc(b->n_cell - n_split, sizeof *t->leaf);
  bad = !t->child || !t->least || !t->leaf;
  for (int k = b->n_level; !bad && k-- > 0;) {
    m.first = b->level[k];
    vg_parallel_for(b->threads, b->level[k + 1] - m.first, VG_OCTREE_GRAIN,
                    count_body, &m);
  }
  if (!bad) b->cell->span.leaf = b->cell->span.split = 0;
  for (int k = 0; !bad && k < b->n_level; k++) {
    m.first = b->level[k];
    vg_parallel_for(b->threads, b->level[k + 1] - m.first, VG_OCTREE_GRAIN,
                    emit_body, &m);
  }
  if (bad) return -1;
  t->n_split = n_split;
  t->n_leaf = b->n_cell - n_split;
  t->root = b->cell->child ? 0 : leaf_entry(&m, 0, 0);
  t->is_stretched = b->tensor != NULL;
  free(b->cell);
  b->cell = NULL;
  return t->is_stretched ? number_tensors(b, t) : 0;
}

vg_status vg_octree_build(const struct vg_stat *f, const double lo[3],
                          double side, const struct vg_sizing_options *o,
                          size_t max_leaf, struct vg_octree *out,
                          struct vg_error *err)
{
  struct vg_octree_build b = { .f = f,
                               .unit = side / VG_OCTREE_TOP,
                               .max_cell = max_leaf,
                               .most_points = o->most_points > 0
                                              ? o->most_points
                                              : MOST_POINTS,
                               .threads = o->threads,
                               .team = o->team };
  vg_status st;

  assert(!out->child && !out->leaf);
  assert(side > 0 && o->coarseness >= 1 && f->slope > 0);
  if (b.max_cell > VG_OCTREE_LEAF / 2) b.max_cell = VG_OCTREE_LEAF / 2;
  b.floor = FLOOR * sqrt(FLOOR_SLOPE / f->slope);
  if (b.floor > FLOOR_MOST) b.floor = FLOOR_MOST;
  b.floor *= o->coarseness;
  b.surface = f->slope > STEEP ? 1 : SURFACE;
  for (int k = 0; k < 3; k++) b.lo[k] = out->lo[k] = lo[k];
  out->side = side;
  st = vg_octree_grow(&b, err);
  if (st >= 0 && b.tensor) st = vg_octree_limit_tensors(&b, err);
  else if (st >= 0 && vg_source_any(&f->set)) st = vg_octree_limit(&b, err);
  if (st >= 0 && compact(&b, out))
    st = vg_fail_memory(err, "the octree of the sizing field");
  free(b.cell);
  free(b.point);
  free(b.tensor);
  if (st >= 0 && out->is_stretched) st = vg_octree_bounds(out, o->threads, err);
  if (st < 0) vg_octree_release(out);
  return st;
}

void vg_octree_release(struct vg_octree *t)
{
  free(t->child);
  free(t->least);
  free(t->leaf);
  free(t->tensor);
  free(t->bounds);
  memset(t, 0, sizeof *t);
}

/* --- evaluation ----------------------------------------------------------- */

/* f: position in the leaf, from 0 to 1. */
static inline double trilinear(const float h[8], const double f[3])
{
  double a = (double)h[0] + f[0] * ((double)h[1] - (double)h[0]);
  double b = (double)h[2] + f[0] * ((double)h[3] - (double)h[2]);
  double c = (double)h[4] + f[0] * ((double)h[5] - (double)h[4]);
  double d = (double)h[6] + f[0] * ((double)h[7] - (double)h[6]);

  a += f[1] * (b - a);
  c += f[1] * (d - c);
  return a + f[2] * (c - a);
}

/* A position in the octree. */
struct spot {
  uint32_t at[3]; /* in units of the finest cell */
  double f[3];    /* in the root cube, from 0 to 1; later in the leaf */
  double outside; /* distance to the root cube */
};

static inline void find_spot(const struct vg_octree *t, const double x[3],
                             struct spot *s)
{
  double d2 = 0;

  for (int k = 0; k < 3; k++) {
    double u = (x[k] - t->lo[k]) / t->side, v = u > 0 ? u < 1 ? u : 1 : 0;

    d2 += (u - v) * (u - v);
    s->f[k] = v;
    s->at[k] = (uint32_t)(v * VG_OCTREE_TOP);
    if (s->at[k] >= VG_OCTREE_TOP) s->at[k] = VG_OCTREE_TOP - 1;
  }
  s->outside = d2 > 0 ? sqrt(d2) * t->side : 0;
}

/* Entry of the child that contains the spot. bit: that of the child's level. */
static inline uint32_t child_at(const struct vg_octree *t, uint32_t e,
                                const struct spot *s, int bit)
{
  return t->child[e][(s->at[0] >> bit & 1) | (s->at[1] >> bit & 1) << 1 |
                     (s->at[2] >> bit & 1) << 2];
}

/* Convert the position in the root cube to that in a leaf of this level. */
static inline void enter_leaf(struct spot *s, int bit)
{
  double scale = (double)(VG_OCTREE_TOP >> bit);

  for (int k = 0; k < 3; k++)
    s->f[k] = s->f[k] * scale - (double)(s->at[k] >> bit);
}

/* Leaf at x, as an entry of the tree. f out: position in the leaf, from 0 to 1.
 * *scale out: side of the root cube over that of the leaf. *outside out:
 * distance to the root cube. */
static inline uint32_t find_leaf(const struct vg_octree *t, const double x[3],
                                 double f[3], double *scale, double *outside)
{
  assert(t->n_leaf > 0 && outside);

  struct spot s;
  uint32_t e = t->root;
  int bit = VG_OCTREE_DEPTH;

  find_spot(t, x, &s);
  while (!(e & VG_OCTREE_LEAF)) e = child_at(t, e, &s, --bit);
  enter_leaf(&s, bit);
  memcpy(f, s.f, sizeof s.f);
  *scale = (double)(VG_OCTREE_TOP >> bit);
  *outside = s.outside;
  return e;
}

double vg_octree_at(const struct vg_octree *t, const double x[3],
                    double *outside)
{
  assert(!t->is_stretched);

  double f[3], scale;
  uint32_t e = find_leaf(t, x, f, &scale, outside);

  return trilinear(t->leaf[e & VG_OCTREE_LEAF_INDEX].h, f);
}

/* The entries from the root to a leaf. */
struct path {
  uint32_t at[3], entry[VG_OCTREE_DEPTH + 1]; /* by level; at: the spot */
  int level;                                  /* level of the leaf */
};

/* Move the path to the leaf of the spot, from the last common cell on. */
static inline uint32_t follow(const struct vg_octree *t, const struct spot *s,
                              struct path *p)
{
  uint32_t differ = (s->at[0] ^ p->at[0]) | (s->at[1] ^ p->at[1]) |
                    (s->at[2] ^ p->at[2]),
           e;
  int bit = differ ? 32 - __builtin_clz(differ) : 0;

  if (bit < VG_OCTREE_DEPTH - p->level) bit = VG_OCTREE_DEPTH - p->level;
  e = p->entry[VG_OCTREE_DEPTH - bit];
  while (!(e & VG_OCTREE_LEAF)) {
    e = child_at(t, e, s, --bit);
    p->entry[VG_OCTREE_DEPTH - bit] = e;
  }
  p->level = VG_OCTREE_DEPTH - bit;
  memcpy(p->at, s->at, sizeof p->at);
  return e;
}

void vg_octree_eval(const struct vg_octree *t, size_t n, const double (*x)[3],
                    double *h, double *outside)
{
  assert(!t->is_stretched && t->n_leaf > 0);

  struct path p = { .level = 0 };

  p.entry[0] = t->root;
  for (size_t i = 0; i < n; i++) {
    struct spot s;
    uint32_t e;

    find_spot(t, x[i], &s);
    e = follow(t, &s, &p);
    enter_leaf(&s, VG_OCTREE_DEPTH - p.level);
    h[i] = trilinear(t->leaf[e & VG_OCTREE_LEAF_INDEX].h, s.f);
    outside[i] = s.outside;
  }
}

void vg_octree_gradient_at(const struct vg_octree *t, const double x[3],
                           double g[3])
{
  assert(!t->is_stretched);

  double f[3], scale, outside;
  uint32_t e = find_leaf(t, x, f, &scale, &outside);
  const float *h = t->leaf[e & VG_OCTREE_LEAF_INDEX].h;

  /* Differences along axis k of the edges whose lower corners i lack bit k. */
  for (int k = 0; k < 3; k++) {
    int u = (k + 1) % 3, v = (k + 2) % 3;

    g[k] = 0;
    for (int i = 0; i < 4; i++) {
      int corner = (i & 1) << u | (i >> 1) << v;

      g[k] += (i & 1 ? f[u] : 1 - f[u]) * (i & 2 ? f[v] : 1 - f[v]) *
              ((double)h[corner | 1 << k] - (double)h[corner]);
    }
    g[k] *= scale / t->side;
  }
}

/* Trilinear size tensor in the leaf of entry e. */
static inline void tensor_in(const struct vg_octree *t, uint32_t e,
                             const double f[3], double h[6])
{
  const union vg_octree_leaf *leaf = t->leaf + (e & VG_OCTREE_LEAF_INDEX);

  if (!(e & VG_OCTREE_TENSOR)) {
    vg_tensor_uniform(trilinear(leaf->h, f), h);
    return;
  }
  for (int k = 0; k < 6; k++) h[k] = 0;
  for (int i = 0; i < 8; i++) {
    const float *corner = t->tensor[leaf->corner[i]];
    double w = (i & 1 ? f[0] : 1 - f[0]) * (i & 2 ? f[1] : 1 - f[1]) *
               (i & 4 ? f[2] : 1 - f[2]);

    for (int k = 0; k < 6; k++) h[k] += w * (double)corner[k];
  }
}

void vg_octree_tensor_at(const struct vg_octree *t, const double x[3],
                         double h[6], double *outside)
{
  double f[3], scale;
  uint32_t e = find_leaf(t, x, f, &scale, outside);

  tensor_in(t, e, f, h);
}

/* Spacing in the leaf of entry e. */
static double size_in(const struct vg_octree *t, uint32_t e, const double f[3])
{
  double h[6];

  if (!(e & VG_OCTREE_TENSOR))
    return trilinear(t->leaf[e & VG_OCTREE_LEAF_INDEX].h, f);
  tensor_in(t, e, f, h);
  return vg_size_mean(h);
}

/* Search for the smallest value by branch and bound. Lengths are relative to
 * the side of the root. */
struct search {
  const struct vg_octree *t;
  double lo[3], hi[3], side; /* The cube, relative to the root cube. */
  double x[3], least;        /* The least value so far, and its position. */
};

/* A trilinear function has its minimum at a corner of the part of the leaf in
 * the box. So has det(H)^(1/3), which is concave along the axes. */
static void search_leaf(struct search *s, uint32_t e, const double at[3],
                        double side)
{
  for (int i = 0; i < 8; i++) {
    double x[3], f[3], v;

    for (int k = 0; k < 3; k++) {
      x[k] = i >> k & 1 ? fmin(s->hi[k], at[k] + side) : fmax(s->lo[k], at[k]);
      f[k] = (x[k] - at[k]) / side;
    }
    v = size_in(s->t, e, f);
    if (!(v < s->least)) continue;
    s->least = v;
    memcpy(s->x, x, sizeof x);
  }
}

/* Least value at the corners of the leaf or split of entry e. */
static double least_below(const struct vg_octree *t, uint32_t e)
{
  const union vg_octree_leaf *leaf = t->leaf + (e & VG_OCTREE_LEAF_INDEX);
  double least = INFINITY;

  if (!(e & VG_OCTREE_LEAF)) return (double)t->least[e];
  for (int i = 0; i < 8; i++) {
    double h[6];

    if (!(e & VG_OCTREE_TENSOR)) {
      least = fmin(least, (double)leaf->h[i]);
      continue;
    }
    for (int k = 0; k < 6; k++) h[k] = (double)t->tensor[leaf->corner[i]][k];
    least = fmin(least, vg_tensor_det(h));
  }
  return e & VG_OCTREE_TENSOR ? vg_cube_root(least) : least;
}

static void search(struct search *s, uint32_t e, const double at[3],
                   double side)
{
  if (!(least_below(s->t, e) < s->least)) return;
  for (int k = 0; k < 3; k++)
    if (at[k] > s->hi[k] || at[k] + side < s->lo[k]) return;
  if (e & VG_OCTREE_LEAF) {
    search_leaf(s, e, at, side);
    return;
  }
  for (int i = 0; i < 8; i++) {
    double child[3];

    for (int k = 0; k < 3; k++)
      child[k] = at[k] + (i >> k & 1 ? 0.5 * side : 0);
    search(s, s->t->child[e][i], child, 0.5 * side);
  }
}

/* The cube in units of the root cube, of which it becomes a part. */
static void start_search(struct search *s, const double lo[3], double side)
{
  const struct vg_octree *t = s->t;

  assert(t->n_leaf > 0 && side >= 0);
  for (int k = 0; k < 3; k++) {
    s->lo[k] = fmin(fmax((lo[k] - t->lo[k]) / t->side, 0), 1);
    s->hi[k] = fmin(fmax((lo[k] + side - t->lo[k]) / t->side, 0), 1);
  }
}

double vg_octree_least(const struct vg_octree *t, const double lo[3],
                       double side, double x[3])
{
  struct search s = { .t = t, .least = INFINITY };
  double root[3] = { 0, 0, 0 };

  start_search(&s, lo, side);
  search(&s, t->root, root, 1);
  for (int k = 0; k < 3; k++) x[k] = t->lo[k] + t->side * s.x[k];
  return s.least;
}

/* Least value in the octants of about half the side of the cube that intersect
 * it. */
static double bound(const struct search *s, uint32_t e, const double at[3],
                    double side)
{
  double least = INFINITY;

  for (int k = 0; k < 3; k++)
    if (at[k] > s->hi[k] || at[k] + side < s->lo[k]) return INFINITY;
  if (e & VG_OCTREE_LEAF || 2 * side <= s->side) return least_below(s->t, e);
  for (int i = 0; i < 8; i++) {
    double child[3];

    for (int k = 0; k < 3; k++)
      child[k] = at[k] + (i >> k & 1 ? 0.5 * side : 0);
    least = fmin(least, bound(s, s->t->child[e][i], child, 0.5 * side));
  }
  return least;
}

double vg_octree_bound(const struct vg_octree *t, const double lo[3],
                       double side)
{
  static const double root[3] = { 0 };
  struct search s = { .t = t, .side = side / t->side };

  start_search(&s, lo, side);
  return bound(&s, t->root, root, 1);
}

/* --- range of size tensors ------------------------------------------------ */

/* Leaves with tensors give determinants and the sixth power of the slope, whose
 * roots are taken at the end only. */
struct range {
  double least, most;         /* values in other leaves */
  double det_least, det_most; /* determinants */
  double slope6;
};

static const struct range no_range = { INFINITY, 0, INFINITY, 0, 0 };

static void join_range(struct range *r, const struct range *other)
{
  r->least = vg_lesser(r->least, other->least);
  r->most = vg_greater(r->most, other->most);
  r->det_least = vg_lesser(r->det_least, other->det_least);
  r->det_most = vg_greater(r->det_most, other->det_most);
  r->slope6 = vg_greater(r->slope6, other->slope6);
}

/* Extend the range by a leaf with tensors. With the tensor B in its middle, the
 * mean of H is at most det(B)^(1/3) tr(B^-1 H) / 3, which is largest at a
 * corner. The gradient of the mean h is h tr(H^-1 dH) / 3. */
static void extend_range(const struct vg_octree *t, uint32_t e, double side,
                         struct range *r)
{
  const uint32_t *corner = t->leaf[e & VG_OCTREE_LEAF_INDEX].corner;
  const double volume = 27 * side * side * side;
  double h[8][6], b[6], det, most = 0;

  tensor_in(t, e, (const double[3]){ 0.5, 0.5, 0.5 }, b);
  det = vg_tensor_adjugate(b, b);
  for (int i = 0; i < 8; i++) {
    for (int k = 0; k < 6; k++) h[i][k] = (double)t->tensor[corner[i]][k];
    most = vg_greater(most, vg_tensor_trace2(b, h[i]));
  }
  most /= 3 * det;
  r->det_most = vg_greater(r->det_most, det * (most * most * most));
  for (int i = 0; i < 8; i++) {
    double inverse[6], g2 = 0;

    det = vg_tensor_adjugate(h[i], inverse);
    r->det_least = vg_lesser(r->det_least, det);
    for (int k = 0; k < 3; k++) {
      double g = vg_tensor_trace2(inverse, h[i ^ 1 << k]) / det - 3;

      g2 += g * g;
    }
    det /= volume;
    r->slope6 = vg_greater(r->slope6, det * det * (g2 * g2 * g2));
  }
}

static void range_below(const struct vg_octree *t, uint32_t e, double side,
                        struct range *r)
{
  if (!(e & VG_OCTREE_LEAF)) {
    for (int i = 0; i < 8; i++) range_below(t, t->child[e][i], 0.5 * side, r);
  } else if (e & VG_OCTREE_TENSOR) {
    extend_range(t, e, side, r);
  } else {
    for (int i = 0; i < 8; i++) {
      double h = (double)t->leaf[e & VG_OCTREE_LEAF_INDEX].h[i];

      r->least = vg_lesser(r->least, h);
      r->most = vg_greater(r->most, h);
    }
  }
}

enum { PART_LEVEL = 3, PARTS = 1 << 3 * PART_LEVEL };

/* Parts of the tree, whose ranges are found in parallel. */
struct parts {
  const struct vg_octree *t;
  size_t n;
  struct part {
    uint32_t entry;
    double side;
    struct range range;
  } part[PARTS];
};

static void list_parts(struct parts *p, uint32_t e, int level)
{
  for (int i = 0; !(e & VG_OCTREE_LEAF) && level < PART_LEVEL && i < 8; i++)
    list_parts(p, p->t->child[e][i], level + 1);
  if (e & VG_OCTREE_LEAF || level == PART_LEVEL)
    p->part[p->n++] = (struct part){ e, p->t->side / (double)(1 << level),
                                     no_range };
}

static void range_body(void *context, size_t first, size_t end, int worker)
{
  struct parts *p = context;

  (void)worker;
  for (size_t i = first; i < end; i++)
    range_below(p->t, p->part[i].entry, p->part[i].side, &p->part[i].range);
}

void vg_octree_tensor_range(const struct vg_octree *t, int threads,
                            double range[2], double *slope)
{
  struct parts p = { .t = t };
  struct range all = no_range;

  list_parts(&p, t->root, 0);
  vg_parallel_for(threads, p.n, 1, range_body, &p);
  for (size_t i = 0; i < p.n; i++) join_range(&all, &p.part[i].range);
  range[0] = all.least;
  range[1] = all.most;
  *slope = all.slope6 > 0 ? sqrt(vg_cube_root(all.slope6)) : 0;
  if (!(all.det_most > 0)) return;
  range[0] = vg_lesser(range[0], vg_cube_root(all.det_least));
  range[1] = vg_greater(range[1], vg_cube_root(all.det_most));
}

/* --- check ---------------------------------------------------------------- */

static size_t bad_entry(const struct vg_octree *t, uint32_t e, size_t above)
{
  if (e & VG_OCTREE_LEAF) return (e & VG_OCTREE_LEAF_INDEX) >= t->n_leaf;
  return e >= t->n_split || (above != SIZE_MAX && e <= above);
}

/* Defects of the leaf of entry e, if it is one. */
static size_t bad_leaf(const struct vg_octree *t, uint32_t e)
{
  const union vg_octree_leaf *leaf = t->leaf + (e & VG_OCTREE_LEAF_INDEX);
  size_t bad = 0;

  if (!(e & VG_OCTREE_LEAF)) return 0;
  for (int k = 0; k < 8; k++)
    bad += e & VG_OCTREE_TENSOR ? leaf->corner[k] >= t->n_tensor
                                : !(leaf->h[k] >= 0);
  return bad;
}

size_t vg_octree_defects(const struct vg_octree *t)
{
  size_t bad = bad_entry(t, t->root, SIZE_MAX);

  for (size_t i = 0; i < t->n_split; i++) {
    bad += !(t->least[i] >= 0);
    for (int k = 0; k < 8; k++)
      bad += bad_entry(t, t->child[i][k], i) || bad_leaf(t, t->child[i][k]);
  }
  if (t->root & VG_OCTREE_LEAF) bad += bad_leaf(t, t->root);
  for (size_t i = 0; i < t->n_tensor; i++) {
    double h[6];

    for (int k = 0; k < 6; k++) h[k] = (double)t->tensor[i][k];
    bad += !(h[0] > 0 && h[0] * h[3] > h[1] * h[1] && vg_tensor_det(h) > 0);
  }
  return bad;
}
