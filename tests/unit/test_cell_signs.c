/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/delaunay/cell_signs.h compared with the predicates that it replaces. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "core/delaunay/cell_signs.h"
#include "core/geometry/predicates.h"

static double draw(uint64_t *seed)
{
  *seed = *seed * 6364136223846793005u + 1442695040888963407u;
  return (double)(*seed >> 11) * 0x1p-53;
}

static unsigned sides(const double (*x)[3], const uint32_t v[4])
{
  unsigned signs = 0;

  for (int i = 0; i < 4; i++) {
    uint32_t w[4] = { v[0], v[1], v[2], v[3] };
    double o;

    w[i] = 4; /* the cell with vertex i replaced by point 4 */
    o = vg_orient3d(x[w[0]], x[w[1]], x[w[2]], x[w[3]]);
    if (o > 0) signs |= VG_SIDE_IN << i;
    if (o >= 0) signs |= VG_SIDE_SEES << i;
  }
  return signs;
}

/* Every variant that this processor can run gives these signs. */
static void check_signs(const double (*x)[3], const uint32_t v[4],
                        unsigned signs)
{
  const double *p = x[4];
  const vg_d2 e[3] = { { p[0], p[0] }, { p[1], p[1] }, { p[2], p[2] } };

  assert_int_equal(vg_cell_signs(x, v, e), signs);
#ifdef VG_WIDE
  if (VG_IS_WIDE) assert_int_equal(vg_cell_signs_wide(x, v, p), signs);
#endif
}

/* Points on a grid of n lines, 0: anywhere; `far` from the origin, and
 * flattened by the factor `flat`. */
static void compare(int n, double far, double flat)
{
  uint64_t seed = 7;

  for (int round = 0; round < 100000; round++) {
    double x[5][3];
    const double(*at)[3] = (const double(*)[3])x;
    uint32_t v[4] = { 0, 1, 2, 3 };
    unsigned right;

    for (int i = 0; i < 5; i++)
      for (int k = 0; k < 3; k++) {
        double r = draw(&seed);

        x[i][k] = far + (n ? (double)(int)(n * r) : r) * (k < 2 ? 1 : flat);
      }
    if (vg_orient3d(x[0], x[1], x[2], x[3]) < 0) {
      v[0] = 1;
      v[1] = 0;
    }
    if (vg_orient3d(x[0], x[1], x[2], x[3]) == 0) continue;
    right = sides(at, v);
    assert_int_equal(vg_cell_sides(at, v, x[4], 0, 0), right);
    if (vg_insphere(x[v[0]], x[v[1]], x[v[2]], x[v[3]], x[4]) > 0)
      check_signs(at, v, VG_IN_SPHERE | right);
    else check_signs(at, v, 0);
  }
}

static void test_anywhere(void **state)
{
  (void)state;
  compare(0, 0, 1);
  compare(0, 1000, 1);
  compare(0, 1e7, 1);
  compare(0, 0, 1e-6);
  compare(0, 1e5, 1e-10);
}

static void test_grid(void **state)
{
  (void)state;
  compare(3, 0, 1);
  compare(5, 100, 1);
  compare(2, 0, 1e-9);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_anywhere),
    cmocka_unit_test(test_grid),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
