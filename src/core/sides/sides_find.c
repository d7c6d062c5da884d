/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Angles around edges, and the sector in which a cell lies. */
#include <assert.h>

#include "core/geometry/predicates.h"
#include "core/sides/sides_parts.h"

/* --- angles around an edge ------------------------------------------------ */

struct vg_turn vg_turn_of(const struct vg_sides *s, uint32_t h)
{
  uint32_t a = vg_half_from(s->tri, h), b = vg_half_to(s->tri, h);

  return (struct vg_turn){ s->x[a < b ? a : b], s->x[a < b ? b : a],
                           s->x[vg_half_apex(s, h)] };
}

/* For a point in the plane of the axis and its zero direction: is it on the
 * side of the zero direction? Decided in a projection along a coordinate axis
 * in which the three points do not become one line. */
static int is_at_zero(const struct vg_turn *axis, const double y[3])
{
  for (int k = 0; k < 3; k++) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const double a[2] = { axis->a[i], axis->a[j] };
    const double b[2] = { axis->b[i], axis->b[j] };
    const double z[2] = { axis->zero[i], axis->zero[j] };
    const double at[2] = { y[i], y[j] };
    const double side = vg_orient2d(a, b, z);

    if (side != 0) return (side > 0) == (vg_orient2d(a, b, at) > 0);
  }
  return 1;
}

/* Part of the turn with the angle of y: 0 at zero, 1 up to half a turn, 2 at
 * half a turn, 3 beyond. */
static int part_of(const struct vg_turn *axis, const double y[3])
{
  const double side = vg_orient3d(axis->a, axis->b, axis->zero, y);

  if (side != 0) return side > 0 ? 1 : 3;
  return is_at_zero(axis, y) ? 0 : 2;
}

int vg_turn_before(const struct vg_turn *axis, const double y[3],
                   const double z[3])
{
  const int i = part_of(axis, y), j = part_of(axis, z);

  if (i != j || !(i & 1)) return i < j;
  return vg_orient3d(axis->a, axis->b, y, z) > 0;
}

/* --- a cell with a face or with edges of the surface -----------------------
 */

/* A triangle at the point, seen from its corner there: c, then a and b. */
struct leaf {
  uint32_t corner; /* 3 t + k */
  uint32_t a, b;
};

static struct leaf leaf_of(const struct vg_sides *s, uint32_t corner)
{
  return (struct leaf){ corner, vg_half_to(s->tri, corner),
                        vg_half_apex(s, corner) };
}

/* Half-face corner of a leaf on its normal side (1) or on the other (0). */
static uint32_t side_of(uint32_t corner, int is_normal)
{
  return vg_sides_corner(corner, !is_normal);
}

static int index_in(const uint32_t at[3], uint32_t p)
{
  for (int i = 0; i < 3; i++)
    if (at[i] == p) return i;
  return -1;
}

/* The half-face corner if a triangle of the surface is a face of the cell. */
static uint32_t find_face(const struct vg_sides *s, uint32_t p,
                          const uint32_t at[3], const double *const x[3])
{
  for (uint32_t k = s->first[p]; k < s->first[p + 1]; k++) {
    const struct leaf f = leaf_of(s, s->corner[k]);
    const int i = index_in(at, f.a), j = index_in(at, f.b);

    if (i < 0 || j < 0) continue;
    return side_of(f.corner, vg_orient3d(s->x[p], s->x[f.a], s->x[f.b],
                                         x[3 - i - j]) > 0);
  }
  return UINT32_MAX;
}

/* The half-edge of the surface from p to q or back, UINT32_MAX if there is
 * none. */
static uint32_t edge_to(const struct vg_sides *s, uint32_t p, uint32_t q)
{
  for (uint32_t k = s->first[p]; k < s->first[p + 1]; k++) {
    const uint32_t h = s->corner[k];

    if (vg_half_to(s->tri, h) == q) return h;
    if (vg_half_apex(s, h) == q) return vg_half_prev(h);
  }
  return UINT32_MAX;
}

/* The corner at p of the half-face that looks into the wedge, around the edge
 * of half-edge h, with the point y. */
static uint32_t find_wedge(const struct vg_sides *s, uint32_t p, uint32_t h,
                           const double y[3])
{
  const size_t i = s->edge.of_half[h];
  const uint32_t *half = vg_edges_at(&s->edge, i);
  const struct vg_turn axis = vg_turn_of(s, half[0]);
  uint32_t k = vg_edges_count(&s->edge, i) - 1, e;

  while (k && vg_turn_before(&axis, y, s->x[vg_half_apex(s, half[k])])) k--;
  e = vg_wedge_above(s, half[k]);
  return s->tri[e / 6][e % 3] == p ? e : vg_half_next(e);
}

/* --- a cell inside a sector ------------------------------------------------
 */

/* An arc on the sphere of directions around p, from that of a point in a
 * sector to one within a leaf. */
struct arc {
  const struct vg_sides *s;
  const double *p, *from;
  double to[3];
};

static double turn(const struct arc *r, const double *a, const double *b,
                   const double *c)
{
  return vg_orient3d(r->p, a, b, c);
}

/* Does the arc cross leaf f? -1: it meets a corner of f, and another arc must
 * be tried. The last test excludes crossings of the opposite directions. */
static int crosses(const struct arc *r, const struct leaf *f)
{
  const double *a = r->s->x[f->a], *b = r->s->x[f->b];
  const double from = turn(r, a, b, r->from), to = turn(r, a, b, r->to);
  double u, v;

  if (!((from > 0 && to < 0) || (from < 0 && to > 0))) return 0;
  u = turn(r, r->from, r->to, a);
  v = turn(r, r->from, r->to, b);
  if (u == 0 || v == 0) return -1;
  return (u > 0) != (v > 0) && (from > 0) == (u < 0);
}

/* Side of the plane through p and leaf f on which both ends of leaf g are: 1 if
 * it is that of the start of the arc, -1 if the other, 0 if neither. */
static int side_of_leaf(const struct arc *r, const struct leaf *f,
                        const struct leaf *g)
{
  const double *a = r->s->x[f->a], *b = r->s->x[f->b];
  const double sign = turn(r, a, b, r->from) > 0 ? 1 : -1;
  const double u = sign * turn(r, a, b, r->s->x[g->a]);
  const double v = sign * turn(r, a, b, r->s->x[g->b]);

  return u >= 0 && v >= 0 ? 1 : u <= 0 && v <= 0 ? -1 : 0;
}

/* 1: the arc crosses leaf f before leaf g, 0: after it, -1: not known. Leaves
 * meet at common edges only, so that one of them is on one side of the other,
 * except if one crosses directions opposite to the other. */
static int is_before(const struct arc *r, const struct leaf *f,
                     const struct leaf *g)
{
  int side = side_of_leaf(r, f, g);

  if (side) return side < 0;
  side = side_of_leaf(r, g, f);
  return side ? side > 0 : -1;
}

/* The first leaf on the arc to leaf `last`, as a half-face corner; UINT32_MAX:
 * not known. */
static uint32_t first_on(const struct arc *r, uint32_t p, uint32_t last)
{
  const struct vg_sides *s = r->s;
  struct leaf best = leaf_of(s, s->corner[last]);

  if (turn(r, s->x[best.a], s->x[best.b], r->from) == 0) return UINT32_MAX;
  for (uint32_t k = s->first[p]; k < s->first[p + 1]; k++) {
    const struct leaf f = leaf_of(s, s->corner[k]);
    const int hit = k == last ? 0 : crosses(r, &f);
    const int before = hit > 0 ? is_before(r, &f, &best) : hit;

    if (before < 0) return UINT32_MAX;
    if (before) best = f;
  }
  return side_of(best.corner, turn(r, s->x[best.a], s->x[best.b], r->from) > 0);
}

/* Tries arcs to several places in every leaf. The places are not special ones
 * such as centroids, through which arcs pass that also pass through points. */
static uint32_t find_visible(const struct vg_sides *s, uint32_t p,
                             const double *from)
{
  static const double place[][2] = { { .361, .293 }, { .227, .431 },
                                     { .519, .167 }, { .113, .157 },
                                     { .709, .131 }, { .139, .691 } };
  struct arc r = { .s = s, .p = s->x[p], .from = from };

  for (size_t i = 0; i < sizeof place / sizeof *place; i++)
    for (uint32_t k = s->first[p]; k < s->first[p + 1]; k++) {
      const struct leaf f = leaf_of(s, s->corner[k]);
      uint32_t corner;

      for (int d = 0; d < 3; d++)
        r.to[d] = r.p[d] + place[i][0] * (s->x[f.a][d] - r.p[d]) +
                  place[i][1] * (s->x[f.b][d] - r.p[d]);
      corner = first_on(&r, p, k);
      if (corner != UINT32_MAX) return corner;
    }
  return UINT32_MAX;
}

/* Is the direction of y from p inside the cell at p with the other corners x?
 * Exact. */
static int is_inside(const double *p, const double *const x[3], const double *y)
{
  const int is_positive = vg_orient3d(p, x[0], x[1], x[2]) > 0;

  for (int i = 0; i < 3; i++) {
    const double d = vg_orient3d(p, x[i], x[(i + 1) % 3], y);

    if (d == 0 || (d > 0) != is_positive) return 0;
  }
  return 1;
}

/* As find_visible, from points inside the cell: no triangle has them in its
 * plane, unlike corners of the cell. */
static uint32_t find_from_inside(const struct vg_sides *s, uint32_t p,
                                 const double *const x[3])
{
  static const double share[][3] = {
    { .31, .37, .29 }, { .23, .31, .43 }, { .47, .19, .31 }, { .13, .53, .29 }
  };
  uint32_t corner = UINT32_MAX;

  for (size_t i = 0; i < sizeof share / sizeof *share; i++) {
    double y[3];

    for (int d = 0; d < 3; d++) {
      y[d] = s->x[p][d];
      for (int k = 0; k < 3; k++) y[d] += share[i][k] * (x[k][d] - s->x[p][d]);
    }
    if (!is_inside(s->x[p], x, y)) continue;
    corner = find_visible(s, p, y);
    if (corner != UINT32_MAX) break;
  }
  return corner;
}

/* Corners of the cell that no triangle shares with p are inside the sector. If
 * each of them is in the plane of a triangle, points inside the cell decide. */
uint32_t vg_sides_find(const struct vg_sides *s, uint32_t p,
                       const uint32_t at[3], const double *const x[3])
{
  uint32_t h[3], corner = UINT32_MAX;
  int n = 0;

  assert(p < s->n_point);
  if (s->first[p] == s->first[p + 1]) return UINT32_MAX;
  for (int i = 0; i < 3; i++) {
    h[i] = at[i] == UINT32_MAX ? UINT32_MAX : edge_to(s, p, at[i]);
    n += h[i] != UINT32_MAX;
  }
  if (n == 3) {
    corner = find_face(s, p, at, x);
    return corner != UINT32_MAX ? corner : find_wedge(s, p, h[0], x[1]);
  }
  for (int i = 0; i < 3 && corner == UINT32_MAX; i++)
    if (h[i] == UINT32_MAX) corner = find_visible(s, p, x[i]);
  return corner != UINT32_MAX ? corner : find_from_inside(s, p, x);
}
