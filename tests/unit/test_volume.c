/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Volumes by cones: known bodies, from points inside and outside. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "core/geometry/volume.h"

/* The corners of a box of 2 by 3 by 4, and its sides, normals outwards. */
static const double box[8][3] = { { 1, 1, 1 }, { 3, 1, 1 }, { 3, 4, 1 },
                                  { 1, 4, 1 }, { 1, 1, 5 }, { 3, 1, 5 },
                                  { 3, 4, 5 }, { 1, 4, 5 } };
static const uint32_t side[6][4] = { { 0, 3, 2, 1 }, { 4, 5, 6, 7 },
                                     { 0, 1, 5, 4 }, { 1, 2, 6, 5 },
                                     { 2, 3, 7, 6 }, { 3, 0, 4, 7 } };
static const double from[3][3] = { { 2, 2, 2 }, { 0, 0, 0 }, { 8, -4, 16 } };

/* Coordinates are small integers: every sum is exact. */
static void triangles_enclose_a_box(void **state)
{
  uint32_t tri[12][3];

  (void)state;
  for (int i = 0; i < 12; i++) {
    const uint32_t *s = side[i / 2];

    tri[i][0] = s[0];
    tri[i][1] = s[i % 2 + 1];
    tri[i][2] = s[i % 2 + 2];
  }
  for (int k = 0; k < 3; k++)
    assert_true(vg_enclosed6(12, (const uint32_t(*)[3])tri, box, from[k]) ==
                6 * 24);
  for (int i = 0; i < 12; i++) {
    uint32_t swap = tri[i][1];

    tri[i][1] = tri[i][2];
    tri[i][2] = swap;
  }
  assert_true(vg_enclosed6(12, (const uint32_t(*)[3])tri, box, from[0]) ==
              -6 * 24);
  assert_true(vg_enclosed6(0, NULL, NULL, NULL) == 0);
}

static void quadrilaterals_enclose_a_box(void **state)
{
  (void)state;
  for (int k = 0; k < 3; k++) {
    double sum = 0;

    for (int i = 0; i < 6; i++)
      sum += vg_quad_cone(from[k], box[side[i][0]], box[side[i][1]],
                          box[side[i][2]], box[side[i][3]]);
    assert_true(sum == 6 * 24);
  }
}

/* A warped face has one cone, whichever corner comes first and, with the other
 * sign, from its other side. */
static void a_warped_face_cancels(void **state)
{
  static const double p[4][3] = {
    { 0, 0, 0 }, { 1, 0, 2 }, { 1, 1, 0 }, { 0, 1, 3 }
  };
  const double o[3] = { 4, 7, -5 };
  const double cone = vg_quad_cone(o, p[0], p[1], p[2], p[3]);

  (void)state;
  assert_true(cone != vg_tri_cone(o, p[0], p[1], p[2]) +
                        vg_tri_cone(o, p[0], p[2], p[3]));
  for (int k = 0; k < 4; k++) {
    assert_true(vg_quad_cone(o, p[k], p[(k + 1) % 4], p[(k + 2) % 4],
                             p[(k + 3) % 4]) == cone);
    assert_true(vg_quad_cone(o, p[k], p[(k + 3) % 4], p[(k + 2) % 4],
                             p[(k + 1) % 4]) == -cone);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(triangles_enclose_a_box),
    cmocka_unit_test(quadrilaterals_enclose_a_box),
    cmocka_unit_test(a_warped_face_cancels),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
