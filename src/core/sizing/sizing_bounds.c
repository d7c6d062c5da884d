/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Bounds of the sizes in a box of an octree with size tensors.
 *
 * Every split cell of the tree has a size tensor B and two factors. The
 * distance |H n| across a plane (vg_sizing_across) at any point of the cell is
 * between `low` and `high` times |B n|, whatever n is:
 *
 *   |H n| = |H B^-1  B n| <= |H B^-1| |B n|
 *   |B n| = |B H^-1  H n| <= |B H^-1| |H n|
 *
 * Sizes that are equal up to a factor and axes that turn little in the metric
 * give narrow bounds. The tensors in a leaf are means of those at its corners,
 * and norms are convex. Therefore the corners bound the first norm exactly,
 * and the second by 1 / (1 - |H B^-1 - I|). */
#include "core/sizing/sizing_octree.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "core/geometry/tensor.h"
#include "core/geometry/vector.h"

/* The stored tensors have single precision; the factors are rounded outwards
 * by more than that. */
static const double outwards = 1e-6;

#define GRAIN 512 /* cells per thread and step */

struct bounds {
  double h[6], low, high;
};

/* --- bounds of a cell ----------------------------------------------------- */

/* Frobenius norms of the product X = a h of two symmetric tensors, and of
 * X - I. They are not below the spectral norms. */
static void norms(const double a[6], const double h[6], double *of,
                  double *of_rest)
{
  static const int at[3][3] = { { 0, 1, 2 }, { 1, 3, 4 }, { 2, 4, 5 } };
  double sum = 0, rest = 0;

  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      double x = a[at[i][0]] * h[at[0][j]] + a[at[i][1]] * h[at[1][j]] +
                 a[at[i][2]] * h[at[2][j]];

      sum += x * x;
      rest += (x - (i == j)) * (x - (i == j));
    }
  *of = sqrt(sum);
  *of_rest = sqrt(rest);
}

/* Upper bound of the spectral norm of a h. */
static double norm_of(const double a[6], const double h[6])
{
  double of, of_rest;

  norms(a, h, &of, &of_rest);
  return fmin(of, 1 + of_rest);
}

static double norm(const double a[6])
{
  return sqrt(vg_tensor_trace2(a, a));
}

static void uniform_leaf(const float h[8], struct bounds *b)
{
  double least = (double)h[0], most = (double)h[0];

  for (int i = 1; i < 8; i++) {
    least = fmin(least, (double)h[i]);
    most = fmax(most, (double)h[i]);
  }
  vg_tensor_uniform(most, b->h);
  b->low = least / most;
  b->high = 1;
}

/* If the corners of a leaf differ too much for the bound of B H^-1 from the
 * middle, the smallest eigenvalues at the corners bound it. */
static void stretched_leaf(const struct vg_octree *t,
                           const union vg_octree_leaf *leaf, struct bounds *b)
{
  double h[8][6], inverse[6], off = 0, fine = 0;

  for (int k = 0; k < 6; k++) b->h[k] = 0;
  for (int i = 0; i < 8; i++)
    for (int k = 0; k < 6; k++) {
      h[i][k] = (double)t->tensor[leaf->corner[i]][k];
      b->h[k] += 0.125 * h[i][k];
    }
  vg_tensor_invert(b->h, inverse);
  b->high = 0;
  for (int i = 0; i < 8; i++) {
    double of, of_rest, det;

    norms(inverse, h[i], &of, &of_rest);
    b->high = vg_greater(b->high, vg_lesser(of, 1 + of_rest));
    off = vg_greater(off, of_rest);
    det = vg_tensor_adjugate(h[i], h[i]);
    fine = vg_greater(fine, norm(h[i]) / det);
  }
  b->low = fmax(1 - off, 1 / (fine * norm(b->h)));
}

static void bound_leaf(const struct vg_octree *t, uint32_t e, struct bounds *b)
{
  const union vg_octree_leaf *leaf = t->leaf + (e & VG_OCTREE_LEAF_INDEX);

  if (e & VG_OCTREE_TENSOR) stretched_leaf(t, leaf, b);
  else uniform_leaf(leaf->h, b);
}

static void bound_split(const struct vg_octree *t, uint32_t e, struct bounds *b)
{
  const struct vg_octree_bounds *of = t->bounds + e;

  for (int k = 0; k < 6; k++) b->h[k] = (double)of->h[k];
  b->low = (double)of->low;
  b->high = (double)of->high;
}

static void bound_entry(const struct vg_octree *t, uint32_t e, struct bounds *b)
{
  if (e & VG_OCTREE_LEAF) bound_leaf(t, e, b);
  else bound_split(t, e, b);
}

/* The bounds of a split cell follow from those of its children. */
static void join(const struct bounds child[8], struct vg_octree_bounds *out)
{
  double h[6] = { 0 }, inverse[6], low = INFINITY, high = 0;

  for (int i = 0; i < 8; i++)
    for (int k = 0; k < 6; k++) h[k] += 0.125 * child[i].h[k];
  for (int k = 0; k < 6; k++) out->h[k] = (float)h[k];
  for (int k = 0; k < 6; k++) h[k] = (double)out->h[k];
  vg_tensor_invert(h, inverse);
  for (int i = 0; i < 8; i++) {
    double t[6];

    vg_tensor_invert(child[i].h, t);
    high = fmax(high, child[i].high * norm_of(inverse, child[i].h));
    low = fmin(low, child[i].low / norm_of(t, h));
  }
  out->low = (float)(low * (1 - outwards));
  out->high = (float)(high * (1 + outwards));
}

static int has_leaves_only(const struct vg_octree *t, size_t split)
{
  for (int k = 0; k < 8; k++)
    if (!(t->child[split][k] & VG_OCTREE_LEAF)) return 0;
  return 1;
}

static void bound_children(const struct vg_octree *t, size_t split)
{
  struct bounds child[8];

  for (int k = 0; k < 8; k++) bound_entry(t, t->child[split][k], &child[k]);
  join(child, t->bounds + split);
}

static void leaves_body(void *context, size_t first, size_t end, int worker)
{
  const struct vg_octree *t = context;

  (void)worker;
  for (size_t i = first; i < end; i++)
    if (has_leaves_only(t, i)) bound_children(t, i);
}

/* Children follow their parents in the tree. */
vg_status vg_octree_bounds(struct vg_octree *t, int threads,
                           struct vg_error *err)
{
  assert(t->is_stretched && !t->bounds);
  t->bounds = vg_alloc(t->n_split, sizeof *t->bounds);
  if (!t->bounds) return vg_fail_memory(err, "the sizing field");
  vg_parallel_for(threads, t->n_split, GRAIN, leaves_body, t);
  for (size_t i = t->n_split; i-- > 0;)
    if (!has_leaves_only(t, i)) bound_children(t, i);
  return VG_OK;
}

/* --- queries -------------------------------------------------------------- */

/* Lengths are relative to the side of the root. */
struct query {
  const struct vg_octree *t;
  double lo[3], hi[3], fine; /* box; half of its longest side */
  int n;
  const double (*normal)[3];
  double *least, *most; /* [n] */
};

static void extend(const struct query *q, uint32_t e)
{
  struct bounds b;

  bound_entry(q->t, e, &b);
  for (int i = 0; i < q->n; i++) {
    double v[3], h;

    vg_tensor_apply(b.h, q->normal[i], v);
    h = vg_norm(v);
    q->least[i] = fmin(q->least[i], b.low * h * (1 - outwards));
    q->most[i] = fmax(q->most[i], b.high * h * (1 + outwards));
  }
}

static void visit(const struct query *q, uint32_t e, const double at[3],
                  double side)
{
  for (int k = 0; k < 3; k++)
    if (at[k] > q->hi[k] || at[k] + side < q->lo[k]) return;
  if (e & VG_OCTREE_LEAF || side <= q->fine) {
    extend(q, e);
    return;
  }
  for (int i = 0; i < 8; i++) {
    double child[3];

    for (int k = 0; k < 3; k++)
      child[k] = at[k] + (i >> k & 1 ? 0.5 * side : 0);
    visit(q, q->t->child[e][i], child, 0.5 * side);
  }
}

void vg_octree_range_across(const struct vg_octree *t, const double lo[3],
                            const double hi[3], int n,
                            const double (*normal)[3], double *least,
                            double *most)
{
  const double root[3] = { 0, 0, 0 };
  struct query q = {
    .t = t, .n = n, .normal = normal, .least = least, .most = most
  };

  assert(t->is_stretched && t->bounds);
  for (int k = 0; k < 3; k++) {
    q.lo[k] = fmin(fmax((lo[k] - t->lo[k]) / t->side, 0), 1);
    q.hi[k] = fmin(fmax((hi[k] - t->lo[k]) / t->side, 0), 1);
    q.fine = fmax(q.fine, 0.5 * (q.hi[k] - q.lo[k]));
  }
  for (int i = 0; i < n; i++) {
    least[i] = INFINITY;
    most[i] = 0;
  }
  visit(&q, t->root, root, 1);
}
