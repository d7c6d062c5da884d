/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Selection of the triangles near a region, where sizes vary along it. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

#include "core/front/region.h"

/* Fine near the origin, growing away from it. */
static struct vg_sizing *graded(void)
{
  struct vg_source far[2] = {
    { .kind = VG_SOURCE_POINT, .p0 = { -5, 1, 0 }, .h0 = 0.05, .growth = 1.3 },
    { .kind = VG_SOURCE_POINT, .p0 = { -40, -40, -40 }, .h0 = 8, .growth = 1.3 }
  };
  struct vg_sizing_options o = VG_SIZING_OPTIONS_INIT;
  struct vg_sizing *s = NULL;

  o.h_max = 8;
  assert_int_equal(vg_sizing_new(&o, 2, far, NULL, &s, NULL), VG_OK);
  return s;
}

static int ruled(const struct vg_region *r, const struct vg_sizing *s,
                 const double (*x)[3], double band)
{
  static const uint32_t v[3] = { 0, 1, 2 };
  struct vg_region_cache cache = { 0 };
  int is;

  assert_int_equal(vg_region_cache_init(&cache, r, s, 3, x, NULL), VG_OK);
  is = vg_region_cache_meets(&cache, v, band);
  if (is) assert_true(vg_region_cache_may_meet(&cache, v, band));
  vg_region_cache_release(&cache);
  return is;
}

static int met(const struct vg_region *r, const struct vg_sizing *s,
               const double (*x)[3], double band)
{
  int is = vg_region_meets(r, s, x[0], x[1], x[2], band);

  assert_int_equal(ruled(r, s, x, band), is);
  if (is) assert_true(vg_region_may_meet(r, s, x[0], x[1], x[2], band));
  return is;
}

/* A line along x, one unit above a plane of symmetry: near it by the spacing at
 * x = -12, not by that at x = -5. */
static const struct vg_region line = {
  .n_plane = 2, .plane = { { { 0, 1, 0 }, 1 }, { { 0, 0, 1 }, 0 } }
};

/* The middle of the triangle's part near the line is where the size is fine. */
static void test_large_by_a_corner(void **state)
{
  static const double x[3][3] = { { -12, 0, 0 },
                                  { 97, -93, 135 },
                                  { 97, -93, -136 } };
  struct vg_sizing *s = graded();

  (void)state;
  assert_true(vg_region_spacing(&line, s, x[0]) > 1);
  assert_true(vg_region_near(&line, s, x[0], VG_BAND_PLACE));
  assert_true(met(&line, s, x, VG_BAND_PLACE));
  vg_sizing_free(s);
}

static void test_large_but_far(void **state)
{
  static const double x[3][3] = { { -5, -1, 0 },
                                  { 97, -93, 135 },
                                  { 97, -93, -136 } };
  static const double behind[3][3] = { { -12, 0, 30 },
                                       { -12, -9, 90 },
                                       { -1, -9, 90 } };
  struct vg_sizing *s = graded();

  (void)state;
  assert_true(vg_region_spacing(&line, s, x[0]) < 0.5);
  assert_false(vg_region_near(&line, s, x[0], VG_BAND_FRONT));
  assert_false(met(&line, s, behind, VG_BAND_FRONT));
  vg_sizing_free(s);
}

/* A corner that is beyond a wall is not within reach of the region. */
static void test_large_beyond_a_wall(void **state)
{
  static const double x[3][3] = { { -12, 0, 0 },
                                  { -97, -93, 135 },
                                  { -97, -93, -136 } };
  struct vg_region r = line;
  struct vg_sizing *s = graded();

  (void)state;
  assert_true(met(&r, s, x, VG_BAND_PLACE));
  r.n_wall = 1;
  r.wall[0] = (struct vg_plane){ { 1, 0, 0 }, 20 };
  assert_false(met(&r, s, x, VG_BAND_PLACE));
  vg_sizing_free(s);
}

/* A triangle of the size of the cells counts as a whole. */
static void test_small(void **state)
{
  static const double x[3][3] = { { -12, 0.5, 0 },
                                  { -11.5, 1.2, 0 },
                                  { -11.5, 0.5, 0.5 } };
  static const double off[3][3] = { { -12, 40.5, 0 },
                                    { -11.5, 41.2, 0 },
                                    { -11.5, 40.5, 0.5 } };
  struct vg_sizing *s = graded();

  (void)state;
  assert_true(met(&line, s, x, VG_BAND_PLACE));
  assert_false(met(&line, s, off, VG_BAND_PLACE));
  vg_sizing_free(s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_large_by_a_corner),
    cmocka_unit_test(test_large_but_far),
    cmocka_unit_test(test_large_beyond_a_wall),
    cmocka_unit_test(test_small),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
