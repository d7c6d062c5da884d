/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Smoothing: each free vertex moves towards the mean of the apexes of
 * equilateral triangles on the edges of its ring, as far as the sum of squared
 * inverse qualities of its triangles decreases. Then edges are flipped to
 * Delaunay, which in the plane also maximises the smallest angle. */
#include <assert.h>
#include <math.h>

#include "core/domain/planar_front.h"
#include "core/geometry/predicates.h"

enum { RING_MAX = 32, N_LIFT = 4 };

/* Vertices of triangles with a smaller angle (sine of 36 degrees) are moved
 * once more, to increase that angle alone. */
#define LIFT_BELOW 0.588 /* S7 */

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

/* Smallest sine of all angles of the ring's triangles. */
static double least_sine(int n, double (*ring)[2], const double x[2])
{
  double least = 1;

  for (int i = 0; i < n; i++) {
    const double *a = ring[i], *b = ring[i + 1 < n ? i + 1 : 0];
    const double ax = a[0] - x[0], ay = a[1] - x[1];
    const double bx = b[0] - x[0], by = b[1] - x[1];
    const double aa = ax * ax + ay * ay, bb = bx * bx + by * by;
    const double cc = (bx - ax) * (bx - ax) + (by - ay) * (by - ay);
    const double area = ax * by - ay * bx;
    const double low = aa < bb ? aa < cc ? aa : cc : bb < cc ? bb : cc;
    /* Twice the area over the product of the two longer edges. */
    const double sine = area / sqrt(aa * bb * cc / low);

    if (!(sine >= least)) least = sine;
  }
  return least;
}

/* Try decreasing steps along the axes while the smallest angle increases. */
static int lift_vertex(struct vg_tri2 *t, uint32_t v)
{
  static const double way[4][2] = { { 1, 0 }, { 0, 1 }, { -1, 0 }, { 0, -1 } };
  double ring[RING_MAX][2], x[2], step, best;
  const int n = get_ring(t, v, ring);
  int moved = 0;

  if (!n) return 0;
  best = least_sine(n, ring, t->x[v]);
  if (best >= LIFT_BELOW) return 0;
  x[0] = ring[0][0] - t->x[v][0];
  x[1] = ring[0][1] - t->x[v][1];
  step = 0.25 * sqrt(x[0] * x[0] + x[1] * x[1]);
  for (int i = 0; i < 24; i++) {
    int better = 0;

    for (int k = 0; k < 4; k++) {
      double sine;

      x[0] = t->x[v][0] + step * way[k][0];
      x[1] = t->x[v][1] + step * way[k][1];
      sine = least_sine(n, ring, x);
      if (!(sine > best) || !is_positive(n, ring, x)) continue;
      best = sine;
      t->x[v][0] = x[0];
      t->x[v][1] = x[1];
      better = moved = 1;
    }
    if (!better) step *= 0.5;
  }
  return moved;
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
