/* How far a region reaches where the spacing along it changes. */
#include "io_support.h"

#include <math.h>

#include "core/region.h"

/* 0.05 at the origin, growing by 0.2 with the distance. */
static struct vg_sizing *fine_in_the_middle(void)
{
  struct vg_sizing_options options = VG_SIZING_OPTIONS_INIT;
  struct vg_source s[2] = {
    { .kind = VG_SOURCE_POINT, .h0 = 0.05 },
    { .kind = VG_SOURCE_BOX, .p0 = {-10, -10, -10}, .p1 = {10, 10, 10},
      .h0 = 3 } };
  struct vg_sizing *sizing = NULL;

  assert_int_equal(vg_sizing_new(&options, 2, s, NULL, &sizing, NULL), VG_OK);
  return sizing;
}

/* Two spacings from a plane, a cell's corners are near; between them, where
 * the spacing is less, a long one is not. */
static void a_long_cell_leaves_its_region(void **state)
{
  static const struct vg_region r = { .n_plane = 1,
                                      .plane = {{{0, 0, 1}, 0}} };
  struct vg_sizing *sizing = fine_in_the_middle();
  const double long_cell[4][3] = {{-8, 0, 2}, {8, 0, 2}, {0, 7, 2},
                                  {0, 0.1, 0.05}};
  const double end[4][3] = {{8, 0, 2}, {7, 0, 2}, {7, 1, 2}, {7, 0, 1}};
  const double along[4][3] = {{-0.4, 0, 0.1}, {0.4, 0, 0.1}, {0, 0.4, 0.1},
                              {0, 0.1, -0.05}};
  const double *x[4], *y[4], *z[4];

  (void)state;
  for (int i = 0; i < 4; i++) {
    x[i] = long_cell[i];
    y[i] = end[i];
    z[i] = along[i];
    assert_true(vg_region_near(&r, sizing, x[i], VG_BAND_FLUID));
    assert_true(vg_region_near(&r, sizing, y[i], VG_BAND_FLUID));
    assert_true(vg_region_near(&r, sizing, z[i], VG_BAND_FLUID));
  }
  assert_false(vg_region_near_cell(&r, sizing, x, VG_BAND_FRONT));
  assert_true(vg_region_near_cell(&r, sizing, y, VG_BAND_FRONT));
  assert_true(vg_region_near_cell(&r, sizing, z, VG_BAND_FRONT));
  vg_sizing_free(sizing);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(a_long_cell_leaves_its_region),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
