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
    cmocka_unit_test(follows_the_requests),
    cmocka_unit_test(counts_the_base),
    cmocka_unit_test(refuses_tiny_edges),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
