/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/curve/curve.h"
#include "core/geometry/graded.h"

enum { MOST = 200 };

static double thickness(double x, double last)
{
  return 0.6 * (0.2969 * sqrt(x) - 0.1260 * x - 0.3516 * x * x +
                0.2843 * x * x * x - last * x * x * x * x);
}

/* NACA 0012 with n intervals on each side, from the trailing edge. */
static size_t naca(int n, int is_blunt, double (*x)[2])
{
  const double last = is_blunt ? 0.1015 : 0.1036;
  size_t at = 0;

  for (int i = n; i > -n + (is_blunt ? -1 : 0); i--) {
    const int k = abs(i);
    double sine, cosine;

    vg_quarter_turn((double)k / n, &sine, &cosine);
    x[at][0] = k == n ? 1 : sine * sine;
    x[at][1] = (i < 0 ? -1 : 1) * thickness(x[at][0], last);
    if (k == n && !is_blunt) x[at][1] = 0;
    at++;
  }
  return at;
}

static size_t circle(int n, double (*x)[2])
{
  for (int i = 0; i < n; i++) {
    const double a = 2 * M_PI * i / n;

    x[i][0] = cos(a);
    x[i][1] = sin(a);
  }
  return (size_t)n;
}

static double next_random(unsigned *seed)
{
  *seed = *seed * 1664525u + 1013904223u;
  return (*seed >> 8) / 16777216.0;
}

static void make(size_t n, const double (*x)[2], struct vg_outline *c)
{
  struct vg_error err = VG_ERROR_INIT;

  assert_int_equal(vg_outline_new(n, x, c, &err), VG_OK);
}

/* A periodic spline through 24 points of a circle stays within 1e-4 of it, and
 * its curvature is 1 to 1 %. */
static void circle_is_smooth(void **state)
{
  double x[MOST][2], p[2], bend;
  struct vg_outline c = VG_OUTLINE_INIT;

  (void)state;
  make(circle(24, x), (const double(*)[2])x, &c);
  assert_int_equal(c.n_corner, 0);
  for (size_t i = 0; i < c.n; i++)
    for (int k = 0; k <= 4; k++) {
      vg_outline_at(&c, i, k * (c.s[i + 1] - c.s[i]) / 4, p, &bend);
      assert_true(fabs(hypot(p[0], p[1]) - 1) < 1e-4);
      assert_true(fabs(bend - 1) < 0.01);
    }
  vg_outline_release(&c);
}

/* A sharp edge is the only corner, also of 10 points on each side, and a blunt
 * one is a base between two. */
static void finds_corners(void **state)
{
  static const int sides[] = { 10, 20, 40, 80 };
  double x[MOST][2];

  (void)state;
  for (size_t i = 0; i < sizeof sides / sizeof *sides; i++) {
    struct vg_outline c = VG_OUTLINE_INIT;

    make(naca(sides[i], 0, x), (const double(*)[2])x, &c);
    assert_int_equal(c.n_corner, 1);
    assert_int_equal(c.corner[0], 1);
    assert_int_equal(c.base[0], SIZE_MAX);
    assert_int_equal(c.nose, (size_t)sides[i]);
    assert_true(c.chord == 1);
    vg_outline_release(&c);
    make(naca(sides[i], 1, x), (const double(*)[2])x, &c);
    assert_int_equal(c.n_corner, 2);
    assert_int_equal(c.base[0], c.n - 1);
    assert_int_equal(c.base[1], 0);
    assert_true(fabs(vg_outline_base(&c) - 0.00252) < 1e-5);
    vg_outline_release(&c);
  }
}

/* The vertices of a wedge turn by 11 degrees between straight sides. */
static void keeps_flat_corners(void **state)
{
  static const double x[][2] = {
    { 1, 0 },       { 0.8, 0.02 },  { 0.6, 0.04 },  { 0.5, 0.05 },
    { 0.4, 0.04 },  { 0.2, 0.02 },  { 0, 0 },       { 0.2, -0.02 },
    { 0.4, -0.04 }, { 0.5, -0.05 }, { 0.6, -0.04 }, { 0.8, -0.02 }
  };
  struct vg_outline c = VG_OUTLINE_INIT;

  (void)state;
  make(sizeof x / sizeof *x, x, &c);
  assert_int_equal(c.n_corner, 4);
  assert_int_equal(c.corner[3], 1);
  assert_int_equal(c.corner[9], 1);
  vg_outline_release(&c);
}

/* A star-shaped polygon around the origin that turns by 3 degrees or more at
 * each of its n points. */
static void random_polygon(int n, unsigned *seed, double (*x)[2])
{
  int is_good;

  do {
    is_good = 1;
    for (int i = 0; i < n; i++) {
      const double a = 2 * M_PI * (i + 0.8 * (next_random(seed) - 0.5)) / n;
      const double r = 0.3 + next_random(seed);

      x[i][0] = r * cos(a);
      x[i][1] = 0.2 * r * sin(a);
    }
    for (int i = 0; i < n; i++) {
      const double *p = x[i], *q = x[(i + 1) % n], *r = x[(i + 2) % n];
      const double u[2] = { q[0] - p[0], q[1] - p[1] };
      const double v[2] = { r[0] - q[0], r[1] - q[1] };

      is_good &= fabs(atan2(u[0] * v[1] - u[1] * v[0],
                            u[0] * v[0] + u[1] * v[1])) > 0.05;
    }
  } while (!is_good);
}

/* Area within the curve, by 64 points in each interval. */
static double area_within(const struct vg_outline *c)
{
  double sum = 0, p[2], q[2], bend;

  vg_outline_at(c, 0, 0, p, &bend);
  for (size_t i = 0; i < c->n; i++)
    for (int k = 1; k <= 64; k++) {
      vg_outline_at(c, i, (c->s[i + 1] - c->s[i]) * k / 64, q, &bend);
      sum += 0.5 * (p[0] * q[1] - q[0] * p[1]);
      memcpy(p, q, sizeof p);
    }
  return sum;
}

static double area_of(int n, const double (*x)[2])
{
  double sum = 0;

  for (int i = 0; i < n; i++) {
    const double *p = x[i], *q = x[(i + 1) % n];

    sum += 0.5 * (p[0] * q[1] - q[0] * p[1]);
  }
  return sum;
}

/* Up to 8 points are the corners of a polygon, and so are all that turn by 55
 * degrees as their neighbour does, or by 100. */
static void keeps_polygons(void **state)
{
  unsigned seed = 7;
  double x[MOST][2];

  (void)state;
  for (int round = 0; round < 2000; round++) {
    const int n = 3 + round % 6;
    struct vg_outline c = VG_OUTLINE_INIT;
    double area;

    random_polygon(n, &seed, x);
    make((size_t)n, (const double(*)[2])x, &c);
    area = area_of(n, (const double(*)[2])x);
    assert_int_equal(c.n_corner, n);
    assert_true(fabs(area_within(&c) - area) < 1e-12);
    vg_outline_release(&c);
  }
  for (int n = 9; n < 60; n++) {
    struct vg_outline c = VG_OUTLINE_INIT;

    for (int i = 0; i < n; i++) {
      const double a = 2 * M_PI * i / n, r = i % 2 || i == n - 1 ? 1 : 0.3;

      x[i][0] = r * cos(a);
      x[i][1] = r * sin(a);
    }
    make((size_t)n, (const double(*)[2])x, &c);
    assert_true(fabs(area_within(&c) - area_of(n, (const double(*)[2])x)) <
                1e-6);
    vg_outline_release(&c);
  }
}

/* Polygons of any number of points keep their shape where each side has a
 * point more, and no curve is far from its segment. */
static void keeps_sides(void **state)
{
  unsigned seed = 11;
  double x[MOST][2], y[MOST][2], p[2], bend;

  (void)state;
  for (int round = 0; round < 500; round++) {
    const int n = 9 + round % 30;
    struct vg_outline c = VG_OUTLINE_INIT;

    for (int i = 0; i < n; i++) {
      const double a = 2 * M_PI * i / n;
      const double r = 0.5 + next_random(&seed);

      x[i][0] = r * cos(a);
      x[i][1] = r * sin(a);
    }
    make((size_t)n, (const double(*)[2])x, &c);
    for (size_t i = 0; i < c.n; i++)
      for (int k = 1; k < 8; k++) {
        const double h = c.s[i + 1] - c.s[i], u = k / 8.0;
        const double *a = c.x[i], *b = c.x[(i + 1) % c.n];

        vg_outline_at(&c, i, h * u, p, &bend);
        assert_true(hypot(p[0] - a[0] - u * (b[0] - a[0]),
                          p[1] - a[1] - u * (b[1] - a[1])) <= 0.3001 * h);
      }
    vg_outline_release(&c);
    for (int i = 0; i < 2 * n; i++)
      for (int k = 0; k < 2; k++)
        y[i][k] = 0.5 * (x[i / 2][k] + x[(i + 1) / 2 % n][k]);
    make(2 * (size_t)n, (const double(*)[2])y, &c);
    for (int i = 0; i < n; i++) assert_true(c.corner[2 * i] || c.turn < 0.14);
    vg_outline_release(&c);
  }
}

struct division {
  size_t n;
  double (*x)[2];
};

static double edge(const struct division *d, size_t i)
{
  const double *a = d->x[i], *b = d->x[i + 1 < d->n ? i + 1 : 0];

  return hypot(b[0] - a[0], b[1] - a[1]);
}

static struct division divide(const struct vg_outline *c,
                              struct vg_outline_sizes sizes)
{
  struct vg_error err = VG_ERROR_INIT;
  struct division d;

  assert_int_equal(vg_outline_divide(c, &sizes, &d.n, &d.x, &err), VG_OK);
  return d;
}

/* Edges at both edges of the section have the requested length to 20 %, the
 * largest edge is not exceeded, and neighbours differ by the growth. */
static void follows_the_requests(void **state)
{
  const struct vg_outline_sizes sizes = { .largest = 0.02,
                                          .per_turn = 36,
                                          .growth = 1.2,
                                          .corner = 0.001,
                                          .nose = 0.0005 };
  double x[MOST][2];
  struct vg_outline c = VG_OUTLINE_INIT;
  struct division d;
  size_t nose = 0;

  (void)state;
  make(naca(80, 0, x), (const double(*)[2])x, &c);
  d = divide(&c, sizes);
  for (size_t i = 0; i < d.n; i++)
    if (d.x[i][0] < d.x[nose][0]) nose = i;
  assert_true(d.x[0][0] == 1 && d.x[0][1] == 0);
  assert_true(d.x[nose][0] == 0 && d.x[nose][1] == 0);
  assert_true(fabs(edge(&d, 0) / 0.001 - 1) < 0.2);
  assert_true(fabs(edge(&d, d.n - 1) / 0.001 - 1) < 0.2);
  assert_true(fabs(edge(&d, nose) / 0.0005 - 1) < 0.2);
  for (size_t i = 0; i < d.n; i++) {
    const double a = edge(&d, i), b = edge(&d, i + 1 < d.n ? i + 1 : 0);

    assert_true(a < 0.021);
    assert_true(fmax(a, b) / fmin(a, b) < 1.25);
  }
  /* The lower side mirrors the upper one to a tenth of the least edge. */
  assert_int_equal(d.n, 2 * nose);
  for (size_t i = 1; i < nose; i++) {
    assert_true(fabs(d.x[i][0] - d.x[d.n - i][0]) < 1e-4);
    assert_true(fabs(d.x[i][1] + d.x[d.n - i][1]) < 1e-4);
  }
  free(d.x);
  vg_outline_release(&c);
}

static void counts_the_base(void **state)
{
  struct vg_outline_sizes sizes = {
    .largest = 0.02, .per_turn = 36, .growth = 1.2, .corner = 0.002
  };
  double x[MOST][2];
  struct vg_outline c = VG_OUTLINE_INIT;

  (void)state;
  make(naca(40, 1, x), (const double(*)[2])x, &c);
  for (size_t n = 1; n < 28; n += 9) {
    struct division d;
    size_t on_base = 0;

    sizes.n_base = n;
    d = divide(&c, sizes);
    for (size_t i = 0; i < d.n; i++) on_base += d.x[i][0] == 1;
    assert_int_equal(on_base, n + 1);
    free(d.x);
  }
  vg_outline_release(&c);
}

static void refuses_tiny_edges(void **state)
{
  const struct vg_outline_sizes sizes = { .largest = 1e-12,
                                          .per_turn = 36,
                                          .growth = 1.2 };
  struct vg_error err = VG_ERROR_INIT;
  double x[MOST][2], (*out)[2];
  struct vg_outline c = VG_OUTLINE_INIT;
  size_t n;

  (void)state;
  make(naca(10, 0, x), (const double(*)[2])x, &c);
  assert_int_equal(vg_outline_divide(&c, &sizes, &n, &out, &err), VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "spacing"));
  vg_outline_release(&c);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(circle_is_smooth),
    cmocka_unit_test(finds_corners),
    cmocka_unit_test(keeps_flat_corners),
    cmocka_unit_test(keeps_polygons),
    cmocka_unit_test(keeps_sides),
    cmocka_unit_test(follows_the_requests),
    cmocka_unit_test(counts_the_base),
    cmocka_unit_test(refuses_tiny_edges),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
