/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Shape of the last level of a pair of wall faces. Declared in
 * layers/expand/pairs.h. */
#include <assert.h>
#include <math.h>

#include "core/geometry/vector.h"
#include "core/judge/quality.h"
#include "layers/expand/pairs.h"

/* L29 */
/* Least volume of a cell relative to that in a box: a sixth of the level for a
 * pyramid, a twelfth for a tetrahedron. */
#define VOLUME_LEAST 0.4
/* Least cosine between a face and the line between the centres of its cells:
 * 78 degrees. */
#define COSINE_LEAST 0.2

/* The pyramid below the middle, those at the sides, and the tetrahedra below
 * the tops of both faces. */
enum { BELOW, SIDE, TOP = SIDE + 4, N_CELL = TOP + 2 };

struct level {
  const double *low[4], *high[4], *middle;
  double centre[N_CELL][3], volume[N_CELL];
};

/* The centre of a pyramid with n corners below its apex, and its volume as a
 * sum of tetrahedra around the centre of the base. */
static void set_cell(struct level *v, int cell, int n,
                     const double *const base[4])
{
  double at[3] = { 0, 0, 0 }, a[3], b[3], c[3];

  for (int k = 0; k < n; k++)
    for (int i = 0; i < 3; i++) at[i] += base[k][i] / n;
  vg_sub(v->middle, at, c);
  v->volume[cell] = 0;
  for (int k = 0; k < n; k++) {
    vg_sub(base[k], at, a);
    vg_sub(base[(k + 1) % n], at, b);
    v->volume[cell] += vg_triple(c, a, b) / 6;
  }
  for (int i = 0; i < 3; i++) v->centre[cell][i] = at[i] + c[i] / 4;
}

static void set_cells(struct level *v)
{
  const double *const *p = v->low, *const *h = v->high;
  const double *below[4] = { p[0], p[1], p[2], p[3] };
  const double *first[4] = { h[0], h[3], h[1] },
               *other[4] = { h[1], h[3], h[2] };

  set_cell(v, BELOW, 4, below);
  for (int k = 0; k < 4; k++) {
    const int m = (k + 1) % 4;
    const double *side[4] = { p[k], h[k], h[m], p[m] };

    set_cell(v, SIDE + k, 4, side);
  }
  set_cell(v, TOP, 3, first);
  set_cell(v, TOP + 1, 3, other);
}

/* Whether the face between two cells, on the edge from a to b and the middle,
 * is far enough from parallel to the line between their centres. */
static int is_across(const struct level *v, const double *a, const double *b,
                     int cell, int other)
{
  double s[3], t[3], n[3], line[3];

  vg_sub(a, v->middle, s);
  vg_sub(b, v->middle, t);
  vg_cross(s, t, n);
  vg_sub(v->centre[other], v->centre[cell], line);
  return fabs(vg_dot(n, line)) >= COSINE_LEAST * vg_norm(n) * vg_norm(line);
}

int vg_pair_level_is_sound(const double (*x)[3], const uint32_t p[4],
                           uint32_t middle)
{
  struct level v = { .middle = x[middle] };
  double sum = 0;

  for (int k = 0; k < 4; k++) {
    v.low[k] = x[p[k]];
    v.high[k] = x[p[k] + 1];
  }
  set_cells(&v);
  for (int i = 0; i < N_CELL; i++) sum += v.volume[i];
  for (int i = 0; i < N_CELL; i++)
    if (!(v.volume[i] >= VOLUME_LEAST * sum / (i < TOP ? 6 : 12))) return 0;
  for (int k = 0; k < 4; k++) {
    const int m = (k + 1) % 4, side = SIDE + k, next = SIDE + m;
    const int top = TOP + (k == 1 || k == 2);

    if (!is_across(&v, v.low[k], v.low[m], BELOW, side) ||
        !is_across(&v, v.low[m], v.high[m], side, next) ||
        !is_across(&v, v.high[k], v.high[m], side, top))
      return 0;
  }
  return is_across(&v, v.high[1], v.high[3], TOP, TOP + 1);
}
