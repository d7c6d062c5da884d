/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Smoothing: each free vertex moves towards the mean of the apexes of
 * equilateral triangles on the edges of its ring, as far as the sum of squared
 * inverse qualities of its triangles decreases. Then edges are flipped to
 * Delaunay, which in the plane also maximises the smallest angle. Where angles
 * stay small, points are added. */
#include <assert.h>
#include <math.h>

#include "core/domain/planar_front.h"
#include "core/geometry/predicates.h"

enum { RING_MAX = 32, N_LIFT = 4, N_SPLIT = 2 };

/* Vertices of triangles with a smaller angle (sine of 36 degrees) are moved
 * once more, to increase that angle alone. */
#define LIFT_BELOW 0.588 /* S7 */

/* Points are added in triangles with a smaller angle (sine of 25 degrees) if
 * that increases the smallest angle around them. */
#define SPLIT_BELOW 0.423 /* S122 */

/* Sum over the ring of (sum of squared edges / area)^2; INFINITY if a triangle
 * is not positive. */
static double badness(int n, double (*ring)[2], const double x[2])
{
  double sum = 0;

  for (int i = 0; i < n; i++) {
    const double *a = ring[i], *b = ring[i + 1 < n ? i + 1 : 0];
    const double ax = a[0] - x[0], ay = a[1] - x[1];
    const double bx = b[0] - x[0], by = b[1] - x[1];
    const double cx = bx - ax, cy = by - ay, area = ax * by - ay * bx;
    const double q = ax * ax + ay * ay + bx * bx + by * by + cx * cx + cy * cy;

    if (!(area > 0)) return INFINITY;
    sum += q / area * (q / area);
  }
  return sum;
}

static void ideal(int n, double (*ring)[2], double x[2])
{
  double sx = 0, sy = 0;
  const double tall = 0.86602540378443864676; /* sqrt(3) / 2 */

  for (int i = 0; i < n; i++) {
    const double *a = ring[i], *b = ring[i + 1 < n ? i + 1 : 0];

    sx += 0.5 * (a[0] + b[0]) - tall * (b[1] - a[1]);
    sy += 0.5 * (a[1] + b[1]) + tall * (b[0] - a[0]);
  }
  x[0] = sx / n;
  x[1] = sy / n;
}

static int is_positive(int n, double (*ring)[2], const double x[2])
{
  for (int i = 0; i < n; i++)
    if (!(vg_orient2d(ring[i], ring[i + 1 < n ? i + 1 : 0], x) > 0)) return 0;
  return 1;
}

static int get_ring(const struct vg_tri2 *t, uint32_t v, double (*ring)[2])
{
  uint32_t edge[RING_MAX];
  const int n = vg_tri2_ring(t, v, RING_MAX, edge);

  for (int i = 0; i < n; i++) {
    const double *p = t->x[vg_t2_to(t, edge[i])];

    ring[i][0] = p[0];
    ring[i][1] = p[1];
  }
  return n;
}

static int smooth_vertex(struct vg_tri2 *t, uint32_t v)
{
  double ring[RING_MAX][2], x[2], goal[2], step = 1;
  const int n = get_ring(t, v, ring);
  double before;

  if (!n) return 0;
  before = badness(n, ring, t->x[v]);
  ideal(n, ring, goal);
  for (int attempt = 0; attempt < 3; attempt++, step *= 0.5) {
    x[0] = t->x[v][0] + step * (goal[0] - t->x[v][0]);
    x[1] = t->x[v][1] + step * (goal[1] - t->x[v][1]);
    if (badness(n, ring, x) < before && is_positive(n, ring, x)) {
      t->x[v][0] = x[0];
      t->x[v][1] = x[1];
      return 1;
    }
  }
  return 0;
}

/* Smallest sine of the angles of the triangle a, b, x. */
static double sine_of(const double a[2], const double b[2], const double x[2])
{
  const double ax = a[0] - x[0], ay = a[1] - x[1];
  const double bx = b[0] - x[0], by = b[1] - x[1];
  const double aa = ax * ax + ay * ay, bb = bx * bx + by * by;
  const double cc = (bx - ax) * (bx - ax) + (by - ay) * (by - ay);
  const double area = ax * by - ay * bx;
  const double low = aa < bb ? aa < cc ? aa : cc : bb < cc ? bb : cc;

  /* Twice the area over the product of the two longer edges. */
  return area / sqrt(aa * bb * cc / low);
}

/* Smallest sine of all angles of the ring's triangles. */
static double least_sine(int n, double (*ring)[2], const double x[2])
{
  double least = 1;

  for (int i = 0; i < n; i++) {
    const double sine = sine_of(ring[i], ring[i + 1 < n ? i + 1 : 0], x);

    if (!(sine >= least)) least = sine;
  }
  return least;
}

/* Moves x in its ring in decreasing steps along the axes while the smallest
 * sine, which is `best`, increases. Returns the smallest sine. */
static double climb(int n, double (*ring)[2], double x[2], double best)
{
  static const double way[4][2] = { { 1, 0 }, { 0, 1 }, { -1, 0 }, { 0, -1 } };
  const double dx = ring[0][0] - x[0], dy = ring[0][1] - x[1];
  double step = 0.25 * sqrt(dx * dx + dy * dy);

  for (int i = 0; i < 24; i++) {
    int better = 0;

    for (int k = 0; k < 4; k++) {
      const double to[2] = { x[0] + step * way[k][0], x[1] + step * way[k][1] };
      const double sine = least_sine(n, ring, to);

      if (!(sine > best) || !is_positive(n, ring, to)) continue;
      best = sine;
      x[0] = to[0];
      x[1] = to[1];
      better = 1;
    }
    if (!better) step *= 0.5;
  }
  return best;
}

static int lift_vertex(struct vg_tri2 *t, uint32_t v)
{
  double ring[RING_MAX][2];
  const int n = get_ring(t, v, ring);
  double before;

  if (!n) return 0;
  before = least_sine(n, ring, t->x[v]);
  return before < LIFT_BELOW && climb(n, ring, t->x[v], before) > before;
}

static double sine_of_face(const struct vg_tri2 *t, uint32_t i)
{
  const uint32_t *v = t->face[i].v;

  return sine_of(t->x[v[0]], t->x[v[1]], t->x[v[2]]);
}

/* A point next to the longest edge of the triangle that is not constrained,
 * inside the triangle. 0: all edges are constrained. */
static int point_near_edge(const struct vg_tri2 *t, uint32_t face, double x[2])
{
  uint32_t edge = VG_T2_NONE;
  double most = 0;

  for (uint32_t e = 4 * face; e < 4 * face + 3; e++) {
    const double *p = t->x[vg_t2_from(t, e)], *q = t->x[vg_t2_to(t, e)];
    const double dx = q[0] - p[0], dy = q[1] - p[1], d2 = dx * dx + dy * dy;

    if (vg_t2_is_fixed(t, e) || vg_t2_twin(t, e) == VG_T2_NONE || !(d2 > most))
      continue;
    most = d2;
    edge = e;
  }
  if (edge == VG_T2_NONE) return 0;
  for (int k = 0; k < 2; k++)
    x[k] = 0.45 * (t->x[vg_t2_from(t, edge)][k] + t->x[vg_t2_to(t, edge)][k]) +
           0.1 * t->x[vg_t2_apex(t, edge)][k];
  return 1;
}

/* The best place of a new point in the cavity of x. 0 if it would not increase
 * the smallest angle there. */
static int place(const struct vg_tri2 *t, double x[2])
{
  double ring[RING_MAX][2], before = 1, best;
  const int n = (int)t->n_border;

  if (t->n_border > RING_MAX) return 0;
  for (size_t i = 0; i < t->n_cavity; i++)
    before = fmin(before, sine_of_face(t, t->cavity[i]));
  for (int i = 0; i < n; i++) {
    ring[i][0] = t->x[t->border[i].a][0];
    ring[i][1] = t->x[t->border[i].a][1];
  }
  if (!is_positive(n, ring, x)) return 0;
  best = climb(n, ring, x, least_sine(n, ring, x));
  return best > before;
}

/* Adds a point in the triangle if that increases the smallest angle around it.
 * 1: done; -1: no memory. */
static int split_face(struct vg_tri2 *t, uint32_t face)
{
  double x[2];
  uint32_t p;
  int ok;

  if (t->face[face].flag & VG_T2_DEAD || sine_of_face(t, face) >= SPLIT_BELOW ||
      !point_near_edge(t, face, x))
    return 0;
  ok = vg_tri2_cavity(t, x, face);
  if (ok != 1 || !place(t, x)) {
    vg_tri2_cancel(t);
    return ok < 0 ? -1 : 0;
  }
  p = vg_tri2_add_point(t, x, 0);
  return p == VG_T2_NONE || vg_tri2_commit(t, p, VG_T2_INSIDE) ? -1 : 1;
}

/* Adds points in triangles with small angles. 1 if any was added; -1: no
 * memory. */
static int split(struct vg_tri2 *t)
{
  const uint32_t n = (uint32_t)t->n_face;
  int any = 0;

  for (uint32_t i = 0; i < n; i++) {
    const int done = split_face(t, i);

    if (done < 0) return -1;
    any |= done;
  }
  return any && vg_tri2_legalise(t) < 0 ? -1 : any;
}

/* Moves vertices at small angles, in several sweeps. Returns as
 * vg_tri2_improve. */
static int lift(struct vg_tri2 *t, uint32_t first_free,
                const struct vg_planar_law *law)
{
  for (int sweep = 0; sweep < N_LIFT; sweep++) {
    size_t n_moved = 0;

    for (uint32_t v = first_free; v < t->n_point; v++) {
      if (vg_tri2_stops(law, v)) return 1;
      n_moved += (size_t)lift_vertex(t, v);
    }
    if (vg_tri2_legalise(t) < 0) return -1;
    if (!n_moved) break;
  }
  return 0;
}

int vg_tri2_improve(struct vg_tri2 *t, uint32_t first_free, int n_sweep,
                    const struct vg_planar_law *law)
{
  assert(first_free <= t->n_point && n_sweep >= 0);
  for (int sweep = 0; sweep < n_sweep; sweep++) {
    size_t n_moved = 0;

    for (uint32_t v = first_free; v < t->n_point; v++) {
      if (vg_tri2_stops(law, v)) return 1;
      n_moved += (size_t)smooth_vertex(t, v);
    }
    if (vg_tri2_legalise(t) < 0) return -1;
    if (!n_moved) break;
  }
  for (int k = 0;; k++) {
    const int bad = lift(t, first_free, law);
    int more;

    if (bad || !law->splits || k == N_SPLIT) return bad;
    more = split(t);
    if (more <= 0) return more;
  }
}
