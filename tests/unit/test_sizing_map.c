/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Sizes from a function, and from points. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "core/sizing/sizing_map.h"

#define GROWTH 1.2

/* The box of a domain of side 10, without faces. */
static double corner[2][3] = { { 0, 0, 0 }, { 10, 10, 10 } };
static const struct vg_mesh box = { .n_point = 2, .point = corner };

static double random_unit(uint64_t *state)
{
  *state = *state * 6364136223846793005ull + 1442695040888963407ull;
  return (double)(*state >> 11) * 0x1p-53;
}

static double distance(const double a[3], const double b[3])
{
  double d2 = 0;

  for (int k = 0; k < 3; k++) d2 += (a[k] - b[k]) * (a[k] - b[k]);
  return sqrt(d2);
}

static struct vg_sizing *field(const struct vg_size_map *map, int threads)
{
  struct vg_sizing_options o = VG_SIZING_OPTIONS_INIT;
  struct vg_sizing *s = NULL;
  struct vg_error err = VG_ERROR_INIT;

  o.growth = GROWTH;
  o.h_max = 2;
  o.map = map;
  o.threads = threads;
  if (vg_sizing_new(&o, 0, NULL, &box, &s, &err) < 0) fail_msg("%s", err.text);
  return s;
}

static double ramp(void *user, const double x[3])
{
  (void)user;
  return 0.2 + 0.1 * x[0];
}

/* A small ball requests small cells abruptly, far beyond the growth. */
static double ball(void *user, const double x[3])
{
  return distance(x, user) < 1 ? 0.1 : INFINITY;
}

static double wrong(void *user, const double x[3])
{
  (void)user;
  return x[1] > 5 ? 0 : 1;
}

static void a_slowly_varying_function_is_reproduced(void **state)
{
  const struct vg_size_map map = { .at = ramp };
  struct vg_sizing *s = field(&map, 2);
  uint64_t seed = 1;

  (void)state;
  for (int i = 0; i < 1000; i++) {
    double x[3], h;

    for (int k = 0; k < 3; k++) x[k] = 10 * random_unit(&seed);
    h = ramp(NULL, x);
    /* H1: the interpolation error is 3 % at most */
    assert_true(fabs(vg_sizing_at(s, x) - h) <= 0.03 * h);
  }
  vg_sizing_free(s);
}

static void a_steep_gradient_is_limited_by_growth(void **state)
{
  double at[3] = { 4, 4, 4 };
  const struct vg_size_map map = { .at = ball, .user = at };
  struct vg_sizing *s = field(&map, 1);
  uint64_t seed = 2;

  (void)state;
  for (int i = 0; i < 1000; i++) {
    double x[3], d, most;

    for (int k = 0; k < 3; k++) x[k] = 10 * random_unit(&seed);
    d = distance(x, at);
    if (d < 0.9) assert_true(vg_sizing_at(s, x) < 0.103);
    /* Leaves next to the ball are up to 1.25 sizes wide; the gradient is
     * limited along their edges, and is up to sqrt(3) larger along
     * diagonals. */
    most = 0.1 + sqrt(3.0) * (GROWTH - 1) * (d > 0.9 ? d - 0.9 : 0) + 0.02;
    assert_true(vg_sizing_at(s, x) <= 1.1 * fmin(most, 2));
  }
  vg_sizing_free(s);
}

static void invalid_sizes_are_reported(void **state)
{
  const struct vg_size_map map = { .at = wrong };
  struct vg_sizing_options o = VG_SIZING_OPTIONS_INIT;
  struct vg_sizing *s = NULL;
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  o.h_max = 2;
  o.map = &map;
  assert_int_equal(vg_sizing_new(&o, 0, NULL, &box, &s, &err), VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "is 0; it must be above 0"));
  assert_null(s);
}

static void points_are_cones(void **state)
{
  enum { N = 200 };
  double x[N][3], h[N];
  struct vg_size_samples *samples = NULL;
  struct vg_sizing *one, *four;
  struct vg_error err = VG_ERROR_INIT;
  uint64_t seed = 3;

  (void)state;
  for (int i = 0; i < N; i++) {
    for (int k = 0; k < 3; k++) x[i][k] = 10 * random_unit(&seed);
    h[i] = 0.3 + random_unit(&seed);
  }
  assert_int_equal(vg_size_samples_new(N, (const double(*)[3])x, h, GROWTH, 1,
                                       &samples, &err),
                   VG_OK);
  one = field(vg_size_samples_map(samples), 1);
  four = field(vg_size_samples_map(samples), 4);
  for (int i = 0; i < 1000; i++) {
    double p[3], want = 2, got;

    for (int k = 0; k < 3; k++) p[k] = 10 * random_unit(&seed);
    for (int j = 0; j < N; j++)
      want = fmin(want, h[j] + (GROWTH - 1) * distance(p, x[j]));
    got = vg_sizing_at(one, p);
    /* H2: leaves of 1.25 sizes are not split, and the tip of a cone may be in
     * the middle of one, half a diagonal from its corners. H3: a plateau of a
     * quarter of the size, up to 1.3, around each point. */
    assert_true(got <= want * (1 + (GROWTH - 1) * 1.25 * sqrt(3.0) / 2));
    assert_true(got >= 0.97 * want - 0.25 * (GROWTH - 1) * 1.3);
    assert_true(got == vg_sizing_at(four, p));
  }
  vg_sizing_free(one);
  vg_sizing_free(four);
  vg_size_samples_free(samples);
}

static void bad_points_are_named(void **state)
{
  double x[3][3] = { { 0, 0, 0 }, { 1, 2, 3 }, { 4, 5, 6 } };
  double h[3] = { 1, -1, 1 };
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  assert_int_equal(vg_size_samples_check("f", 3, (const double(*)[3])x, h,
                                         &err),
                   VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "f: the edge length at point 2, (1, 2, 3), "
                                   "is -1"));
  h[1] = INFINITY;
  assert_int_equal(vg_size_samples_check("f", 3, (const double(*)[3])x, h,
                                         &err),
                   VG_ERR_INPUT);
  h[1] = 1;
  x[2][0] = NAN;
  assert_int_equal(vg_size_samples_check("f", 3, (const double(*)[3])x, h,
                                         &err),
                   VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "f: point 3, ("));
  x[2][0] = 0;
  assert_int_equal(vg_size_samples_check("f", 3, (const double(*)[3])x, h,
                                         &err),
                   VG_OK);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(a_slowly_varying_function_is_reproduced),
    cmocka_unit_test(a_steep_gradient_is_limited_by_growth),
    cmocka_unit_test(invalid_sizes_are_reported),
    cmocka_unit_test(points_are_cones),
    cmocka_unit_test(bad_points_are_named),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
