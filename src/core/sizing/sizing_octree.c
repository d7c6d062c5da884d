/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/sizing/sizing_octree.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"
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

/* The compact tree, in depth-first order, which keeps cells that are near in
 * space near in memory. First the leaves and splits below each cell are
 * counted, from the last level up. Then each cell passes its first numbers on
 * to its children. */

struct span {
  uint32_t leaf, split;
  float least;
};

struct compaction {
  const struct vg_octree_build *b;
  struct span *span; /* [n_cell] numbers below each cell, later the first
                        number */
  struct vg_octree *t;
  size_t first; /* first cell of the level */
};

static void count_body(void *context, size_t first, size_t end, int worker)
{
  const struct compaction *m = context;

  (void)worker;
  for (size_t i = m->first + first; i < m->first + end; i++) {
    const struct vg_octree_cell *c = m->b->cell + i;
    struct span sum = { !c->child, c->child != 0, INFINITY };

    for (uint32_t j = 0; j < 8; j++) {
      struct span below = { 0, 0, 0 };

      if (c->child) below = m->span[c->child + j];
      else below.least = m->b->point[c->corner[j]].h;
      sum.leaf += below.leaf;
      sum.split += below.split;
      sum.least = below.least < sum.least ? below.least : sum.least;
    }
    m->span[i] = sum;
  }
}

static void put_leaf(const struct compaction *m, size_t cell)
{
  const struct vg_octree_cell *c = m->b->cell + cell;

  for (int i = 0; i < 8; i++)
    m->t->leaf[m->span[cell].leaf][i] = m->b->point[c->corner[i]].h;
}

static void emit_body(void *context, size_t first, size_t end, int worker)
{
  const struct compaction *m = context;

  (void)worker;
  for (size_t i = m->first + first; i < m->first + end; i++) {
    uint32_t child = m->b->cell[i].child;
    struct span next = m->span[i];

    if (!child) {
      put_leaf(m, i);
      continue;
    }
    m->t->least[next.split++] = next.least;
    for (uint32_t j = 0; j < 8; j++) {
      struct span below = m->span[child + j];

      m->t->child[m->span[i].split][j] = m->b->cell[child + j].child
                                         ? next.split
                                         : VG_OCTREE_LEAF | next.leaf;
      next.least = below.least;
      m->span[child + j] = next;
      next.leaf += below.leaf;
      next.split += below.split;
    }
  }
}

static int compact(const struct vg_octree_build *b, struct vg_octree *t)
{
  struct compaction m = { .b = b, .t = t };
  size_t n_split = b->n_cell / 8;
  int bad;

  m.span = vg_alloc(b->n_cell, sizeof *m.span);
  t->child = vg_alloc(n_split, sizeof *t->child);
  t->least = vg_alloc(n_split, sizeof *t->least);
  t->leaf = vg_alloc(b->n_cell - n_split, sizeof *t->leaf);
  bad = !m.span || !t->child || !t->least || !t->leaf;
  for (int k = b->n_level; !bad && k-- > 0;) {
    m.first = b->level[k];
    vg_parallel_for(b->threads, b->level[k + 1] - m.first, VG_OCTREE_GRAIN,
                    count_body, &m);
  }
  if (!bad) m.span[0].leaf = m.span[0].split = 0;
  for (int k = 0; !bad && k < b->n_level; k++) {
    m.first = b->level[k];
    vg_parallel_for(b->threads, b->level[k + 1] - m.first, VG_OCTREE_GRAIN,
                    emit_body, &m);
  }
  free(m.span);
  if (bad) return -1;
  t->n_split = n_split;
  t->n_leaf = b->n_cell - n_split;
  t->root = b->cell->child ? 0 : VG_OCTREE_LEAF;
  return 0;
}

vg_status vg_octree_build(const struct vg_stat *f, const double lo[3],
                          double side, double coarseness, size_t max_leaf,
                          int threads, struct vg_team *team,
                          struct vg_octree *out, struct vg_error *err)
{
  struct vg_octree_build b = { .f = f,
                               .unit = side / VG_OCTREE_TOP,
                               .max_cell = max_leaf,
                               .threads = threads,
                               .team = team };
  vg_status st;

  assert(!out->child && !out->leaf);
  assert(side > 0 && coarseness >= 1 && f->slope > 0);
  if (b.max_cell > VG_OCTREE_LEAF / 2) b.max_cell = VG_OCTREE_LEAF / 2;
  b.floor = FLOOR * sqrt(FLOOR_SLOPE / f->slope);
  if (b.floor > FLOOR_MOST) b.floor = FLOOR_MOST;
  b.floor *= coarseness;
  b.surface = f->slope > STEEP ? 1 : SURFACE;
  for (int k = 0; k < 3; k++) b.lo[k] = out->lo[k] = lo[k];
  out->side = side;
  st = vg_octree_grow(&b, err);
  if (st >= 0 && vg_source_any(&f->set)) st = vg_octree_limit(&b, err);
  if (st >= 0 && compact(&b, out))
    st = vg_fail_memory(err, "the octree of the sizing field");
  free(b.cell);
  free(b.point);
  if (st < 0) vg_octree_release(out);
  return st;
}

void vg_octree_release(struct vg_octree *t)
{
  free(t->child);
  free(t->least);
  free(t->leaf);
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

double vg_octree_at(const struct vg_octree *t, const double x[3],
                    double *outside)
{
  assert(t->n_leaf > 0 && outside);

  double f[3], d2 = 0, scale = 1;
  uint32_t at[3], e = t->root;
  int bit = VG_OCTREE_DEPTH;

  for (int k = 0; k < 3; k++) {
    double u = (x[k] - t->lo[k]) / t->side, v = u > 0 ? u < 1 ? u : 1 : 0;

    d2 += (u - v) * (u - v);
    f[k] = v;
    at[k] = (uint32_t)(v * VG_OCTREE_TOP);
    if (at[k] >= VG_OCTREE_TOP) at[k] = VG_OCTREE_TOP - 1;
  }
  while (!(e & VG_OCTREE_LEAF)) {
    bit--;
    e = t->child[e][(at[0] >> bit & 1) | (at[1] >> bit & 1) << 1 |
                    (at[2] >> bit & 1) << 2];
  }
  scale = (double)(VG_OCTREE_TOP >> bit);
  for (int k = 0; k < 3; k++) f[k] = f[k] * scale - (double)(at[k] >> bit);
  *outside = d2 > 0 ? sqrt(d2) * t->side : 0;
  return trilinear(t->leaf[e & ~VG_OCTREE_LEAF], f);
}

/* Search for the smallest value by branch and bound. Lengths are relative to
 * the side of the root. */
struct search {
  const struct vg_octree *t;
  double lo[3], hi[3], x[3], least;
};

/* A trilinear function has its minimum at a corner of the part of the leaf in
 * the box. */
static void search_leaf(struct search *s, const float h[8], const double at[3],
                        double side)
{
  for (int i = 0; i < 8; i++) {
    double x[3], f[3], v;

    for (int k = 0; k < 3; k++) {
      x[k] = i >> k & 1 ? fmin(s->hi[k], at[k] + side) : fmax(s->lo[k], at[k]);
      f[k] = (x[k] - at[k]) / side;
    }
    v = trilinear(h, f);
    if (!(v < s->least)) continue;
    s->least = v;
    memcpy(s->x, x, sizeof x);
  }
}

static double least_below(const struct vg_octree *t, uint32_t e)
{
  const float *h;
  float least;

  if (!(e & VG_OCTREE_LEAF)) return (double)t->least[e];
  h = t->leaf[e & ~VG_OCTREE_LEAF];
  least = h[0];
  for (int i = 1; i < 8; i++) least = h[i] < least ? h[i] : least;
  return (double)least;
}

static void search(struct search *s, uint32_t e, const double at[3],
                   double side)
{
  if (!(least_below(s->t, e) < s->least)) return;
  for (int k = 0; k < 3; k++)
    if (at[k] > s->hi[k] || at[k] + side < s->lo[k]) return;
  if (e & VG_OCTREE_LEAF) {
    search_leaf(s, s->t->leaf[e & ~VG_OCTREE_LEAF], at, side);
    return;
  }
  for (int i = 0; i < 8; i++) {
    double child[3];

    for (int k = 0; k < 3; k++)
      child[k] = at[k] + (i >> k & 1 ? 0.5 * side : 0);
    search(s, s->t->child[e][i], child, 0.5 * side);
  }
}

double vg_octree_least(const struct vg_octree *t, const double lo[3],
                       double side, double x[3])
{
  struct search s = { .t = t, .least = INFINITY };
  double root[3] = { 0, 0, 0 };

  assert(t->n_leaf > 0 && side >= 0);
  for (int k = 0; k < 3; k++) {
    s.lo[k] = fmin(fmax((lo[k] - t->lo[k]) / t->side, 0), 1);
    s.hi[k] = fmin(fmax((lo[k] + side - t->lo[k]) / t->side, 0), 1);
  }
  search(&s, t->root, root, 1);
  for (int k = 0; k < 3; k++) x[k] = t->lo[k] + t->side * s.x[k];
  return s.least;
}
