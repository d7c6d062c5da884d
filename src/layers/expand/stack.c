/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Shape of the layer cells on one face. Declared in layers/expand/stack.h. */
#include "layers/expand/stack.h"

#include <assert.h>
#include <string.h>

#include "core/geometry/vector.h"
#include "layers/expand/join.h"

/* L24 */
/* Least sine between a column and a layer. */
#define FLAT 0.00005
/* Least area of a layer, relative to its area at the wall. */
#define SHRUNK 0.04

static int positive(double det, double area2, const double up[3])
{
  return det > 0 && det * det >= FLAT * FLAT * area2 * vg_dot(up, up);
}

static int same_point(const struct vg_stack *s, int a, int la, int b, int lb)
{
  return la == 0 && lb == 0 && s->c[a]->root == s->c[b]->root;
}

/* Tests tetrahedron (p at l, p at l + 1, q, r at their levels), where q and r
 * follow p around the face. Tetrahedra with a repeated point do not exist and
 * count as valid. */
static int lifted(const struct vg_stack *s, int p, int l, int lq, int lr)
{
  int q = (p + 1) % 3, r = (p + 2) % 3;
  const double *o = s->x[p][l];
  double a[3], b[3], up[3], n[3];

  if (same_point(s, p, l, q, lq) || same_point(s, p, l, r, lr) ||
      same_point(s, q, lq, r, lr))
    return 1;
  vg_sub(s->x[q][lq], o, a);
  vg_sub(s->x[r][lr], o, b);
  vg_sub(s->x[p][l + 1], o, up);
  vg_cross(a, b, n);
  return positive(vg_dot(n, up), vg_dot(n, n), up);
}

/* Tests all cells raised from level l by the lift rule. */
static int lifts(const struct vg_stack *s, int l)
{
  int at[3];

  for (int k = 0; k < 3; k++) at[k] = l < s->c[k]->n ? l : s->c[k]->n;
  for (int i = 0; i < 3; i++) {
    int p = s->order[i], q = (p + 1) % 3, r = (p + 2) % 3;

    if (l >= s->c[p]->n) continue;
    if (!lifted(s, p, l, at[q], at[r])) return 0;
    at[p]++;
  }
  return 1;
}

/* The first and the last of the three tetrahedra of a prism are among its
 * corner tetrahedra; this is the one between them. */
static int middle(const struct vg_stack *s, int l)
{
  int p = s->order[1], q = (p + 1) % 3, r = (p + 2) % 3;

  return lifted(s, p, l, l + (q == s->order[0]), l + (r == s->order[0]));
}

static void area(const struct vg_stack *s, int l, double n[3])
{
  double a[3], b[3];

  vg_sub(s->x[1][l], s->x[0][l], a);
  vg_sub(s->x[2][l], s->x[0][l], b);
  vg_cross(a, b, n);
}

/* Tests the corner tetrahedra of the prism between l and l + 1; returns the bad
 * corners. */
static int corners(const struct vg_stack *s, int l, const double low[3],
                   const double high[3])
{
  double a = vg_dot(low, low), b = vg_dot(high, high);
  int bad = 0;

  for (int k = 0; k < 3; k++) {
    double up[3];

    vg_sub(s->x[k][l + 1], s->x[k][l], up);
    if (!positive(vg_dot(low, up), a, up) || !positive(vg_dot(high, up), b, up))
      bad |= 1 << k;
  }
  return bad;
}

static int is_virtual(const struct vg_stack *s)
{
  return s->c[0]->root == s->c[1]->root || s->c[1]->root == s->c[2]->root ||
         s->c[2]->root == s->c[0]->root;
}

/* Tests the pyramid on the quadrilateral of the two columns other than corner
 * k, which are raised from l: all four of its corner volumes. Its apex is the
 * top of column k, which may be lower than l. */
static int pyramid(const struct vg_stack *s, int l, int k)
{
  int p = (k + 1) % 3, q = (k + 2) % 3;
  const double *apex = s->x[k][s->c[k]->n];
  const double *ring[4] = { s->x[p][l], s->x[q][l], s->x[q][l + 1],
                            s->x[p][l + 1] };

  if (l == 0 && is_virtual(s)) return 1; /* See wall_cells(). */
  for (int i = 0; i < 4; i++)
    if (!(vg_det(ring[i], ring[(i + 1) % 4], apex, ring[(i + 3) % 4]) > 0))
      return 0;
  return 1;
}

/* At the wall, mixed output makes other cells on faces at a fan than the lift
 * rule. */
static int wall_cells(const struct vg_stack *s, const struct vg_columns *c,
                      size_t f)
{
  struct vg_wall_cell cell[3];
  int n, fan = 0;

  for (int k = 0; k < 3; k++) fan |= vg_shares_root(c, c->face[f][k]);
  n = fan ? vg_join_wall_cells(c, f, cell) : 0;
  for (int i = 0; i < n; i++) {
    static const int8_t corner[3][6][4] = {
      { { 0, 1, 2, 3 } },
      { { 0, 1, 2, 3 }, { 1, 4, 2, 0 }, { 4, 3, 2, 1 }, { 3, 0, 2, 4 } },
      { { 0, 1, 2, 3 },
        { 1, 2, 0, 4 },
        { 2, 0, 1, 5 },
        { 3, 5, 4, 0 },
        { 4, 3, 5, 1 },
        { 5, 4, 3, 2 } }
    };
    static const int n_corner[3] = { 1, 4, 6 };
    int kind = cell[i].n_node - 4;

    for (int j = 0; j < n_corner[kind]; j++) {
      const double *x[4];

      for (int m = 0; m < 4; m++) {
        int node = (int)cell[i].node[corner[kind][j][m]];

        x[m] = node < 3 ? s->x[node][0] : s->x[node - 3][1];
      }
      if (!(vg_det(x[0], x[1], x[2], x[3]) > 0)) return 0;
    }
  }
  return 1;
}

/* First level below a bad cell, or -1. */
static int first_bad(const struct vg_stack *s, uint8_t *faulty)
{
  int whole = s->c[0]->n, most = whole, from = is_virtual(s);
  double base[3], low[3], high[3];

  for (int k = 1; k < 3; k++) {
    if (s->c[k]->n < whole) whole = s->c[k]->n;
    if (s->c[k]->n > most) most = s->c[k]->n;
  }
  area(s, from <= whole ? from : 0, base);
  memcpy(low, base, sizeof low);
  *faulty = 7;
  for (int l = 0; l < whole; l++) {
    int bad = 0;

    if (l >= from) {
      area(s, l + 1, high);
      bad = corners(s, l, low, high);
      if (vg_dot(high, base) < SHRUNK * vg_dot(base, base)) bad = 7;
      memcpy(low, high, sizeof low);
    }
    if (!bad && !(l < from ? lifts(s, l) : middle(s, l))) bad = 7;
    if (!bad) continue;
    if (l == 0) *faulty = (uint8_t)bad;
    return l;
  }
  for (int l = whole; l < most; l++) {
    if (!lifts(s, l)) return l;
    for (int k = 0; k < 3; k++)
      if (s->c[k]->n <= l && s->c[(k + 1) % 3]->n > l &&
          s->c[(k + 2) % 3]->n > l && !pyramid(s, l, k))
        return l;
  }
  return -1;
}

static void load(struct vg_stack *s, const struct vg_columns *c,
                 const struct vg_mesh *m, size_t f)
{
  const uint32_t *face = c->face[f];

  for (int k = 0; k < 3; k++) {
    s->c[k] = &c->column[face[k]];
    s->order[k] = k;
    vg_column_points(c, m, face[k], s->d[k], s->x[k]);
  }
  for (int pass = 0; pass < 2; pass++)
    for (int k = 0; k < 2; k++)
      if (face[s->order[k]] > face[s->order[k + 1]]) {
        int swap = s->order[k];

        s->order[k] = s->order[k + 1];
        s->order[k + 1] = swap;
      }
}

int vg_stack_first_bad(struct vg_stack *s, const struct vg_columns *c,
                       const struct vg_mesh *m, size_t f, uint8_t *faulty)
{
  int level;

  assert(f < c->n_face);
  load(s, c, m, f);
  level = first_bad(s, faulty);
  if (!level || wall_cells(s, c, f)) return level;
  *faulty = 7;
  return 0;
}
