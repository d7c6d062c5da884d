/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The spatial hash: points near a position are found, distant ones are not. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/fill/hgrid.h"

static struct vg_hgrid *new_grid(double h_min, double h_max)
{
  const double lo[3] = { 0, 0, 0 };
  struct vg_hgrid *s = calloc(1, sizeof *s);

  assert_non_null(s);
  assert_int_equal(vg_hgrid_init(s, lo, h_min, h_max, 0.2), 0);
  return s;
}

static void free_grid(struct vg_hgrid *s)
{
  vg_hgrid_release(s);
  free(s);
}

static double spacing(const double x[3])
{
  return 0.5 + 0.05 * x[0];
}

/* The list is in single precision, relative to the centre, and radii are below
 * 2: distances are accurate to 1e-6. Queries with a point this close to the
 * radius are drawn again, so that the count is exact. */
#define ROUNDING 1e-6

/* Number of points of x within r of c, or -1 if rounding decides for one of
 * them. */
static int count_within(size_t n, const double (*x)[3], const double c[3],
                        double r)
{
  int inside = 0;

  for (size_t i = 0; i < n; i++) {
    double d = hypot(hypot(x[i][0] - c[0], x[i][1] - c[1]), x[i][2] - c[2]);

    if (fabs(d - r) < ROUNDING) return -1;
    inside += d < r;
  }
  return inside;
}

/* Each listed point is one of those within r of c, and no two are the same. */
static void are_those_within(const struct vg_hgrid *s, size_t n,
                             const double (*x)[3], const double c[3], double r)
{
  for (size_t k = 0; k < s->n; k++) {
    int n_same = 0;

    for (size_t i = 0; i < n; i++) {
      double d[3];

      for (int a = 0; a < 3; a++) d[a] = x[i][a] - c[a] - s->x[a][k];
      if (hypot(hypot(d[0], d[1]), d[2]) > ROUNDING) continue;
      n_same++;
      for (int a = 0; a < 3; a++) d[a] = x[i][a] - c[a];
      assert_true(hypot(hypot(d[0], d[1]), d[2]) < r);
    }
    assert_int_equal(n_same, 1);
  }
}

static void lists_agree_with_a_search(void **state)
{
  enum { N = 3000 };
  static double x[N][3];
  struct vg_hgrid *s = new_grid(0.5, 2);
  size_t n_listed = 0;

  (void)state;
  srand(3);
  for (int i = 0; i < N; i++) {
    for (int k = 0; k < 3; k++) x[i][k] = 15.0 * rand() / RAND_MAX;
    assert_int_equal(vg_hgrid_add(s, x[i], spacing(x[i])), 0);
  }
  for (int q = 0; q < 300;) {
    double c[3], r = 0.3 + 1.5 * rand() / RAND_MAX;
    int n;

    for (int k = 0; k < 3; k++) c[k] = 15.0 * rand() / RAND_MAX;
    n = count_within(N, (const double(*)[3])x, c, r);
    if (n < 0) continue;
    q++;
    vg_hgrid_gather(s, c, spacing(c), r);
    assert_int_equal(s->n, n);
    are_those_within(s, N, (const double(*)[3])x, c, r);
    n_listed += s->n;
  }
  assert_true(n_listed > 5 * 300);
  assert_int_equal(s->n_cut, 0);
  free_grid(s);
}

/* The keys of blocks have fewer bits than their coordinates, so two blocks can
 * have the same key. */
static void blocks_with_one_key_are_two(void **state)
{
  static const double far[] = { 0x1p18, 0x1p20, 0x1p21, 0x1p22, 0x1p30 };
  struct vg_hgrid *s = new_grid(1, 1);
  const double x[3] = { 1.1, 1.2, 1.3 };

  (void)state;
  assert_int_equal(vg_hgrid_add(s, x, 1), 0);
  vg_hgrid_gather(s, x, 1, 1);
  assert_int_equal(s->n, 1);
  for (size_t k = 0; k < sizeof far / sizeof *far; k++)
    for (int axis = 0; axis < 3; axis++) {
      double c[3] = { x[0], x[1], x[2] };

      c[axis] += far[k];
      vg_hgrid_gather(s, c, 1, 1);
      assert_int_equal(s->n, 0);
    }
  free_grid(s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(lists_agree_with_a_search),
    cmocka_unit_test(blocks_with_one_key_are_two),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
