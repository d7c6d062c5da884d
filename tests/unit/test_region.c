/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Selection of the triangles near a region, where sizes vary along it. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

#include "core/front/region.h"
#include "core/geometry/tensor.h"

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

/* Sizes 2 along (1, 1, 0), and 0.1 across it. */
static void oblique(void *user, const double x[3], double m[6])
{
  const double along = 1 / 4.0, across = 100;

  (void)user;
  (void)x;
  m[0] = m[3] = 0.5 * (along + across);
  m[1] = 0.5 * (along - across);
  m[2] = m[4] = 0;
  m[5] = across;
}

/* Sizes 0.1 across x, and 2 across y and z. */
static void thin(void *user, const double x[3], double m[6])
{
  (void)user;
  (void)x;
  for (int k = 0; k < 6; k++) m[k] = 0;
  m[0] = 100;
  m[3] = m[5] = 0.25;
}

static struct vg_sizing *stretched_by(void (*metric)(void *user,
                                                     const double x[3],
                                                     double m[6]))
{
  static double corner[2][3] = { { 0, 0, 0 }, { 8, 8, 8 } };
  const struct vg_mesh box = { .n_point = 2, .point = corner };
  const struct vg_size_map map = { .metric = metric };
  struct vg_sizing_options o = VG_SIZING_OPTIONS_INIT;
  struct vg_sizing *s = NULL;

  o.map = &map;
  assert_int_equal(vg_sizing_new(&o, 0, NULL, &box, &s, NULL), VG_OK);
  return s;
}

static struct vg_sizing *stretched(void)
{
  return stretched_by(oblique);
}

/* Shortest length in the metric of the edges from x to the points of a plane
 * normal to y at the distance d, which are sampled along x. */
static double length_to_plane(const struct vg_sizing *s, const double x[3],
                              double d)
{
  double least = INFINITY, t[6], m[6];

  vg_sizing_stretch_at(s, x, t);
  vg_tensor_square(t, m);
  for (int i = -4000; i <= 4000; i++) {
    const double e[3] = { 1e-3 * i, d, 0 };

    least = fmin(least, sqrt(vg_tensor_form(m, e)));
  }
  return least;
}

/* Cells that are oblique to a plane reach far from it: their length counts, and
 * not their thickness, which is 0.14 normal to the plane. */
static void test_spacing_in_a_metric(void **state)
{
  const struct vg_region r = { .n_plane = 1, .plane = { { { 0, 1, 0 }, 4 } } };
  const double x[3] = { 4, 4, 4 }, y_axis[3] = { 0, 1, 0 };
  const double lo[3] = { 2, 1, 2 }, hi[3] = { 5, 6, 6 };
  struct vg_sizing *s = stretched();
  double h = vg_region_spacing(&r, s, x), least, most;

  (void)state;
  assert_true(fabs(h - sqrt(0.5 * (4 + 0.01))) < 1e-5);
  assert_true(fabs(length_to_plane(s, x, h) - 1) < 1e-4);
  assert_true(fabs(vg_sizing_across(s, x, y_axis) - h) < 1e-12);
  assert_true(vg_sizing_along(s, x, y_axis) < 0.15);
  vg_region_spacing_within(&r, s, lo, hi, &least, &most);
  assert_true(least <= h && h <= most && most - least < 1e-4);
  assert_true(vg_region_near(&r, s, (double[3]){ 4, 4 + 0.9 * h, 4 }, 1));
  assert_false(vg_region_near(&r, s, (double[3]){ 4, 4 + 1.1 * h, 4 }, 1));
  vg_sizing_free(s);
}

/* A pencil along cells that are thin across one of its planes is as thin there,
 * however long the cells are across the other plane and across a wall. */
static void test_each_side_has_its_spacing(void **state)
{
  static const double small[3][3] = { { 4.15, 4, 4 },
                                      { 4.25, 4, 4 },
                                      { 4.15, 4.1, 4 } };
  static const double large[3][3] = { { 4.15, 1, 4 },
                                      { 4.25, 7, 4 },
                                      { 4.15, 4, 7 } };
  struct vg_region r = {
    .n_plane = 2,
    .n_wall = 1,
    .plane = { { { 1, 0, 0 }, 4 }, { { 0, 1, 0 }, 4 } },
    .wall = { { { 0, 0, 1 }, 3 } },
  };
  struct vg_sizing *s = stretched_by(thin);
  double h[VG_REGION_SIDES];

  (void)state;
  vg_region_across(&r, s, small[0], h);
  assert_true(fabs(h[0] - 0.1) < 1e-6 && fabs(h[1] - 2) < 1e-4);
  assert_true(fabs(h[2] - 2) < 1e-4);
  assert_false(vg_region_near(&r, s, small[0], 1));
  assert_true(vg_region_near(&r, s, small[0], 1.6));
  assert_true(vg_region_near(&r, s, (double[3]){ 4.05, 5.9, 4 }, 1));
  assert_true(vg_region_near(&r, s, (double[3]){ 4, 4, 2.1 }, 1));
  assert_false(vg_region_near(&r, s, (double[3]){ 4, 4, 1.9 }, 1));
  assert_false(met(&r, s, small, 1));
  assert_true(met(&r, s, small, 1.6));
  assert_false(met(&r, s, large, 1));
  assert_true(met(&r, s, large, 1.6));
  vg_sizing_free(s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_large_by_a_corner),
    cmocka_unit_test(test_large_but_far),
    cmocka_unit_test(test_large_beyond_a_wall),
    cmocka_unit_test(test_small),
    cmocka_unit_test(test_spacing_in_a_metric),
    cmocka_unit_test(test_each_side_has_its_spacing),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
