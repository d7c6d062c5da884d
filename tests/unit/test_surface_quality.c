/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Figures of the triangles of a surface, for known triangles. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "core/surface/surface_quality.h"

/* Equilateral, half a square, a cap of height 1e-3, a needle of 0.01 degrees,
 * coordinates that are NaN. */
static void known_triangles(void **state)
{
  const double base = 2 * tan(M_PI / 36000);
  double point[][3] = { { 0, 0, 0 },  { 1, 0, 0 },    { 0.5, sqrt(3) / 2, 0 },
                        { 0, 0, 5 },  { 1, 0, 5 },    { 0, 1, 5 },
                        { 0, 0, 9 },  { 2, 0, 9 },    { 1, 1e-3, 9 },
                        { 0, 0, 7 },  { base, 0, 7 }, { base / 2, 1, 7 },
                        { NAN, 0, 0 } };
  uint32_t tri[][3] = {
    { 0, 1, 2 }, { 3, 4, 5 }, { 6, 7, 8 }, { 9, 10, 11 }, { 0, 1, 12 }
  };
  uint32_t patch[5] = { 0 };
  struct vg_mesh m = {
    .n_point = 13, .point = point, .n_tri = 5, .tri = tri, .tri_patch = patch
  };
  struct vg_surface_quality q;
  double flat = atan(1e-3) * 180 / M_PI;

  (void)state;
  vg_surface_quality(&m, &q);
  assert_int_equal(q.n, 4);
  assert_float_equal(q.angle_min, 0.01, 1e-9);
  assert_float_equal(q.angle_min_p1, 0, 1e-12);
  for (int k = 0; k < 4; k++) assert_float_equal(q.below[k], 50, 1e-12);
  assert_int_equal(q.n_cap, 1);
  assert_int_equal(q.n_needle, 1);
  assert_int_equal(q.n_worst, 2);
  assert_int_equal(q.worst[0].face, 3);
  assert_int_equal(q.worst[0].is_cap, 0);
  assert_float_equal(q.worst[1].angle, flat, 1e-9);
  assert_int_equal(q.worst[1].is_cap, 1);
  assert_float_equal(q.worst[1].at[2], 9, 1e-12);
  m.n_tri = 2;
  vg_surface_quality(&m, &q);
  assert_int_equal(q.n_worst, 0);
  assert_float_equal(q.ratio_mean, (1 + 2 * (sqrt(2) - 1)) / 2, 1e-12);
  m.n_tri = 0;
  vg_surface_quality(&m, &q);
  assert_true(q.n == 0 && q.angle_min == 0 && q.ratio_mean == 0);
}

/* If there are more triangles than fit, the worst are kept, in order. */
static void the_worst_of_many(void **state)
{
  enum { N = 40 };
  double point[3 * N][3];
  uint32_t tri[N][3], patch[N] = { 0 };
  struct vg_mesh m = {
    .n_point = 3 * N, .point = point, .n_tri = N, .tri = tri, .tri_patch = patch
  };
  struct vg_surface_quality q;

  (void)state;
  for (uint32_t i = 0; i < N; i++) {
    double height = 1e-4 * (1 + (i * 7) % N);

    for (uint32_t k = 0; k < 3; k++) {
      point[3 * i + k][0] = 0.5 * k;
      point[3 * i + k][1] = k == 1 ? height : 0;
      point[3 * i + k][2] = i;
      tri[i][k] = 3 * i + k;
    }
  }
  vg_surface_quality(&m, &q);
  assert_int_equal(q.n_cap, N);
  assert_int_equal(q.n_worst, VG_WORST_FACES);
  for (size_t i = 0; i < q.n_worst; i++)
    assert_int_equal((q.worst[i].face * 7) % N, i);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(known_triangles),
    cmocka_unit_test(the_worst_of_many),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
