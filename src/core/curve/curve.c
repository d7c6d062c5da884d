/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/curve/curve.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

/* S95: turning angles of corners, in radians, and the ratio of the curvature
 * there to that at the next points. */
#define ALWAYS 1.75  /* 100 degrees */
#define BLUNT 1.05   /* 60 degrees */
#define PERHAPS 0.14 /* 8 degrees */
#define RATIO 6.0
#define PAIR 0.96     /* 55 degrees, at two successive points. */
#define STRAIGHT 0.01 /* At points between straight segments. */
#define BULGE                                                                  \
  0.3 /* Largest distance of the curve from a segment, relative                \
         to its length. */
#define HALF_PI 1.5707963267948966

/* Longest base of a blunt trailing edge, relative to the chord. */
#define BASE 0.1 /* S95 */

enum {
  OVERLAP = 32, /* Intervals by which a periodic spline is extended; an error at
                   the end decays by 0.27 in each. */
  POLYGON = 8,  /* S95: points of a curve, and intervals of a piece, up to */
  PIECE = 4     /* which it is a polygon. */
};

void vg_outline_release(struct vg_outline *c)
{
  free(c->x);
  free(c->s);
  free(c->bend);
  free(c->corner);
  memset(c, 0, sizeof *c);
}

static double length(const double a[2], const double b[2])
{
  const double dx = b[0] - a[0], dy = b[1] - a[1];

  return sqrt(dx * dx + dy * dy);
}

/* --- corners ------------------------------------------------------------- */

/* Arc tangent without libm, to 0.005. */
static double arc_tangent(double t)
{
  return t <= 1 ? t / (1 + 0.28 * t * t) : HALF_PI - t / (t * t + 0.28);
}

/* Turning angle at point i, positive to the left, and the mean curvature of the
 * polygon there. */
static double turn_at(const struct vg_outline *c, size_t i, double *curvature)
{
  const double *a = c->x[i ? i - 1 : c->n - 1], *b = c->x[i];
  const double *d = c->x[i + 1 < c->n ? i + 1 : 0];
  const double u[2] = { b[0] - a[0], b[1] - a[1] };
  const double v[2] = { d[0] - b[0], d[1] - b[1] };
  const double cross = u[0] * v[1] - u[1] * v[0];
  const double dot = u[0] * v[0] + u[1] * v[1];
  const double l = length(a, b), m = length(b, d), below = l * m + dot;
  const double turn = below > 0 ? 2 * arc_tangent(fabs(cross) / below)
                                : 2 * HALF_PI;

  *curvature = 2 * turn / (l + m);
  return cross < 0 ? -turn : turn;
}

static size_t previous(const struct vg_outline *c, size_t i)
{
  return i ? i - 1 : c->n - 1;
}

static size_t next(const struct vg_outline *c, size_t i)
{
  return i + 1 < c->n ? i + 1 : 0;
}

static void set_corner(struct vg_outline *c, size_t i, const double *turn)
{
  if (c->corner[i]) return;
  c->corner[i] = turn[i] > 0 ? 1 : -1;
  c->n_corner++;
}

/* Corners by the turns and the curvatures of the polygon. */
static void find_sharp(struct vg_outline *c, const double *turn,
                       const double *bend)
{
  for (size_t i = 0; i < c->n; i++) {
    const size_t b = previous(c, i), a = next(c, i);
    const double at = fabs(turn[i]);

    if (at >= ALWAYS ||
        (at >= PAIR && fmax(fabs(turn[b]), fabs(turn[a])) >= PAIR) ||
        (at >= PERHAPS && bend[i] > RATIO * fmax(bend[b], bend[a])) ||
        (at >= BLUNT && bend[i] > RATIO * fmin(bend[b], bend[a])))
      set_corner(c, i, turn);
  }
}

/* Corners next to others, whose curvature does not count. */
static void find_next(struct vg_outline *c, const double *turn, double *bend)
{
  for (size_t i = 0; i < c->n; i++)
    if (c->corner[i]) bend[i] = 0;
  for (size_t i = 0; i < c->n; i++) {
    const double most = fmax(bend[previous(c, i)], bend[next(c, i)]);

    if (fabs(turn[i]) >= PERHAPS && bend[i] > RATIO * most)
      set_corner(c, i, turn);
  }
}

/* So few points show no curve: all that turn are corners. */
static void find_polygons(struct vg_outline *c, const double *turn)
{
  size_t from, run = 0;

  for (from = 0; from < c->n && !c->corner[from]; from++) continue;
  for (size_t k = 1; k <= c->n && c->n_corner; k++) {
    const size_t i = (from + k) % c->n;

    run++;
    if (!c->corner[i] && k < c->n) continue;
    for (size_t j = 1; j < run && run <= PIECE; j++) {
      const size_t at = (i + c->n - j) % c->n;

      if (fabs(turn[at]) > STRAIGHT) set_corner(c, at, turn);
    }
    run = 0;
  }
  for (size_t i = 0; i < c->n && c->n <= POLYGON; i++)
    if (fabs(turn[i]) > STRAIGHT) set_corner(c, i, turn);
}

static vg_status find_corners(struct vg_outline *c, struct vg_error *err)
{
  double *bend = vg_alloc(2 * c->n, sizeof *bend), *turn = bend + c->n;

  if (!bend) return vg_fail_memory(err, "the corners of a curve");
  for (size_t i = 0; i < c->n; i++) turn[i] = turn_at(c, i, &bend[i]);
  find_sharp(c, turn, bend);
  find_next(c, turn, bend);
  find_polygons(c, turn);
  for (size_t i = 0; i < c->n; i++)
    if (!c->corner[i] && fabs(turn[i]) > c->turn) {
      c->turn = fabs(turn[i]);
      c->turns_at = i;
    }
  free(bend);
  return VG_OK;
}

static void find_nose(struct vg_outline *c)
{
  for (size_t i = 1; i < c->n; i++) {
    const double d = length(c->x[0], c->x[i]);

    if (!(d > c->chord)) continue;
    c->chord = d;
    c->nose = i;
  }
}

static size_t corner_before(const struct vg_outline *c, size_t i)
{
  do i = previous(c, i);
  while (!c->corner[i]);
  return i;
}

static size_t corner_after(const struct vg_outline *c, size_t i)
{
  do i = next(c, i);
  while (!c->corner[i]);
  return i;
}

/* The piece from corner a to corner b is a base if it is short. */
static int is_base(const struct vg_outline *c, size_t a, size_t b)
{
  const double l = b > a ? c->s[b] - c->s[a] : c->s[c->n] - c->s[a] + c->s[b];

  return a != b && l <= BASE * c->chord;
}

static void find_base(struct vg_outline *c)
{
  size_t a, b;

  c->base[0] = c->base[1] = SIZE_MAX;
  if (!c->n_corner) return;
  a = corner_before(c, 0);
  b = c->corner[0] ? 0 : corner_after(c, 0);
  if (!is_base(c, a, b) && c->corner[0]) {
    a = 0;
    b = corner_after(c, 0);
  }
  if (!is_base(c, a, b)) return;
  c->base[0] = a;
  c->base[1] = b;
}

/* --- splines ------------------------------------------------------------- */

/* Second derivatives at the n + 1 points of n intervals that begin at point
 * `first` of the curve, by the tridiagonal system of continuous first
 * derivatives. scratch: [n + 1] each. */
static void solve(const struct vg_outline *c, size_t first, size_t n, int k,
                  double *diagonal, double *bend)
{
#define AT(i) (((first) + (i)) % c->n)
#define STEP(i) (c->s[AT(i) + 1] - c->s[AT(i)])
#define SLOPE(i) ((c->x[AT((i) + 1)][k] - c->x[AT(i)][k]) / STEP(i))
  if (n == 1) {
    bend[0] = bend[1] = 0;
    return;
  }
  for (size_t i = 1; i < n; i++) {
    const double left = STEP(i - 1), right = STEP(i);
    double f;

    diagonal[i] = 2 * (left + right) + (i == 1 ? left : 0) +
                  (i + 1 == n ? right : 0);
    bend[i] = 6 * (SLOPE(i) - SLOPE(i - 1));
    if (i == 1) continue;
    f = left / diagonal[i - 1];
    diagonal[i] -= f * left;
    bend[i] -= f * bend[i - 1];
  }
  for (size_t i = n - 1; i > 0; i--)
    bend[i] = (bend[i] - (i + 1 < n ? STEP(i) * bend[i + 1] : 0)) / diagonal[i];
  bend[0] = bend[1];
  bend[n] = bend[n - 1];
#undef SLOPE
#undef STEP
#undef AT
}

/* The spline of n intervals from point `first` on, of which the first and last
 * `skip` are left out. */
static void fit(struct vg_outline *c, size_t first, size_t n, size_t skip,
                double *scratch)
{
  for (int k = 0; k < 2; k++) {
    double *bend = scratch + n + 1;

    solve(c, first, n, k, scratch, bend);
    for (size_t i = skip; i < n - skip; i++)
      for (int end = 0; end < 2; end++)
        c->bend[(first + i) % c->n][end][k] = bend[i + (size_t)end];
  }
}

static vg_status fit_all(struct vg_outline *c, struct vg_error *err)
{
  double *scratch = vg_alloc(2 * (c->n + 2 * OVERLAP + 1), sizeof *scratch);
  size_t first, a, b;

  if (!scratch) return vg_fail_memory(err, "a spline");
  for (first = 0; c->n_corner && !c->corner[first]; first++) continue;
  if (!c->n_corner) {
    fit(c, (c->n - OVERLAP % c->n) % c->n, c->n + 2 * OVERLAP, OVERLAP,
        scratch);
  } else {
    a = first;
    do {
      b = corner_after(c, a);
      fit(c, a, b > a ? b - a : b + c->n - a, 0, scratch);
      a = b;
    } while (a != first);
  }
  free(scratch);
  return VG_OK;
}

/* Marks the ends of the intervals in which the curve is too far from the
 * segment, so that it no longer has the shape of the points. */
static size_t mark_bulges(struct vg_outline *c)
{
  size_t n = 0;

  for (size_t i = 0; i < c->n; i++) {
    const size_t j = next(c, i);
    const double h = c->s[i + 1] - c->s[i];
    double x[2], bend, most = 0;

    for (int k = 1; k < 8; k++) {
      vg_outline_at(c, i, h * k / 8, x, &bend);
      for (int e = 0; e < 2; e++)
        x[e] -= c->x[i][e] + (c->x[j][e] - c->x[i][e]) * k / 8;
      most = fmax(most, sqrt(x[0] * x[0] + x[1] * x[1]));
    }
    if (most <= BULGE * h) continue;
    for (int k = 0; k < 2; k++) {
      const size_t at = k ? j : i;

      if (c->corner[at]) continue;
      c->corner[at] = turn_at(c, at, &bend) > 0 ? 1 : -1;
      c->n_corner++;
      n++;
    }
  }
  return n;
}

vg_status vg_outline_new(size_t n, const double (*x)[2], struct vg_outline *out,
                         struct vg_error *err)
{
  assert(n >= 3 && x && out);

  struct vg_outline c = { .n = n,
                          .x = vg_alloc(n, sizeof *c.x),
                          .s = vg_alloc(n + 1, sizeof *c.s),
                          .bend = vg_calloc(n, sizeof *c.bend),
                          .corner = vg_calloc(n, 1) };
  vg_status st;

  if (!c.x || !c.s || !c.bend || !c.corner) {
    st = vg_fail_memory(err, "the points of a curve");
    goto done;
  }
  memcpy(c.x, x, n * sizeof *x);
  c.s[0] = 0;
  for (size_t i = 0; i < n; i++)
    c.s[i + 1] = c.s[i] + length(x[i], x[i + 1 < n ? i + 1 : 0]);
  find_nose(&c);
  VG_TRY(find_corners(&c, err));
  do VG_TRY(fit_all(&c, err));
  while (mark_bulges(&c));
  find_base(&c);
  *out = c;
  return VG_OK;
done:
  vg_outline_release(&c);
  return st;
}

void vg_outline_at(const struct vg_outline *c, size_t i, double t, double x[2],
                   double *curvature)
{
  assert(i < c->n && x && curvature);

  const double *a = c->x[i], *b = c->x[i + 1 < c->n ? i + 1 : 0];
  const double h = c->s[i + 1] - c->s[i], u = t < h ? t / h : 1, v = 1 - u;
  double d1[2], d2[2], speed;

  for (int k = 0; k < 2; k++) {
    const double p = c->bend[i][0][k], q = c->bend[i][1][k];

    x[k] = v * a[k] + u * b[k] +
           ((v * v * v - v) * p + (u * u * u - u) * q) * (h * h / 6);
    d1[k] = (b[k] - a[k]) / h +
            ((1 - 3 * v * v) * p + (3 * u * u - 1) * q) * (h / 6);
    d2[k] = v * p + u * q;
  }
  if (u <= 0) memcpy(x, a, 2 * sizeof *x);
  if (u >= 1) memcpy(x, b, 2 * sizeof *x);
  speed = d1[0] * d1[0] + d1[1] * d1[1];
  *curvature = speed > 0
               ? fabs(d1[0] * d2[1] - d1[1] * d2[0]) / (speed * sqrt(speed))
               : INFINITY;
}

double vg_outline_base(const struct vg_outline *c)
{
  assert(c->base[0] != SIZE_MAX);

  const double a = c->s[c->base[0]], b = c->s[c->base[1]];

  return b > a ? b - a : c->s[c->n] - a + b;
}
