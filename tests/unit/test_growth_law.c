/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The growth law of layers. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>

#include "layers/columns/columns.h"

static const struct vg_growth_law laws[] = {
  { 0.001, 0.15, 0.02, INFINITY, 1 },
  { 0.001, 0.15, 0.02, 1.3, 1 },
  { 1e-5, 0.2, 0, 1.3, 1 },
  { 1e-5, 0.2, 0, 1.3, 4 },
  { 2e-6, 0, 0, 1.3, 1 },
  { 3e-4, 0.5, 0.1, 1.25, 7 },
  { 1, 0.15, 0.02, 1, 1 },
};
#define N_LAW (sizeof laws / sizeof *laws)

/* formats.md 1.8: wall distances of VGRID's box for 0.001, 0.15, 0.02, as
 * printed there (6 decimals) and from the formula with libm. */
static void vgrid_box(void **state)
{
  static const double printed[12] = { 0.001,    0.002153, 0.003489, 0.005047,
                                      0.006873, 0.009024, 0.011575, 0.014618,
                                      0.018270, 0.022681, 0.028042, 0.034603 };
  double d[31], sum = 0;

  (void)state;
  vg_growth_law_heights(&laws[0], INFINITY, 30, d);
  assert_true(d[0] == 0);
  for (int j = 1; j <= 12; j++)
    assert_true(fabs(d[j] - printed[j - 1]) < 0.51e-6);
  for (int j = 1; j <= 30; j++) {
    sum += 0.001 * pow(1 + 0.15 * pow(1.02, j - 1), j - 1);
    /* a few dozen roundings on either side */
    assert_true(fabs(d[j] - sum) < 1e-14 * sum);
  }
  assert_true(d[30] > 3.3 && d[30] < 3.5);
}

static void geometric_when_r2_is_0(void **state)
{
  struct vg_growth_law law = { 1e-5, 0.2, 0, INFINITY, 1 };
  double d[VG_LEVELS_MAX + 1];

  (void)state;
  vg_growth_law_heights(&law, INFINITY, VG_LEVELS_MAX, d);
  for (int j = 1; j <= VG_LEVELS_MAX; j++) {
    double all = 1e-5 * (pow(1.2, j) - 1) / 0.2;

    assert_true(fabs(d[j] - all) < 1e-12 * all);
  }
}

/* Thickness of the layers, to the rounding of heights. */
static void thickness_grows_by_cap_at_most(void **state)
{
  double d[61];

  (void)state;
  for (size_t i = 0; i < N_LAW; i++) {
    vg_growth_law_heights(&laws[i], INFINITY, 60, d);
    for (int j = 1; j <= 60; j++) {
      double t = d[j] - d[j - 1], slack = 1e-15 * d[j];

      if (j <= laws[i].n_constant) assert_true(fabs(t - d[1]) <= slack);
      if (j == 1) assert_true(t == laws[i].delta1);
      else assert_true(t >= d[j - 1] - d[j - 2] - 2 * slack);
      if (j > 1) assert_true(t <= laws[i].cap * (d[j - 1] - d[j - 2] + slack));
    }
  }
}

static void constant_layers_shift_the_law(void **state)
{
  struct vg_growth_law law = { 1e-4, 0.2, 0.01, INFINITY, 1 }, late = law;
  double d[31], e[35];

  (void)state;
  late.n_constant = 5;
  vg_growth_law_heights(&law, INFINITY, 30, d);
  vg_growth_law_heights(&late, INFINITY, 34, e);
  for (int j = 1; j <= 30; j++)
    assert_true(fabs(e[j + 4] - d[j] - 4e-4) <= 1e-14 * e[j + 4]);
}

static void a_compressed_column_fits(void **state)
{
  double d[41], whole[41];

  (void)state;
  for (size_t i = 0; i < N_LAW; i++) {
    vg_growth_law_heights(&laws[i], INFINITY, 40, whole);
    for (int part = 1; part <= 20; part++) {
      double height = whole[40] * part / 20;
      double cap = vg_growth_law_compress(&laws[i], 40, height);

      if (cap == 0) {
        assert_true(40 * laws[i].delta1 > height * (1 - 1e-12));
        continue;
      }
      assert_true(cap >= 1 && cap <= laws[i].cap);
      vg_growth_law_heights(&laws[i], cap, 40, d);
      assert_true(d[40] <= height);
      assert_true(d[1] == laws[i].delta1);
      /* and no lower than necessary: 28 halvings */
      if (cap == laws[i].cap) continue;
      vg_growth_law_heights(&laws[i], cap * (1 + 1e-7), 40, d);
      assert_true(d[40] > height);
    }
    assert_true(vg_growth_law_compress(&laws[i], 40, whole[40]) == laws[i].cap);
    assert_true(vg_growth_law_compress(&laws[i], 40, 39 * laws[i].delta1) == 0);
    assert_true(vg_growth_law_compress(&laws[i], 0, 0) == laws[i].cap);
  }
}

static void a_lower_cap_raises_no_height(void **state)
{
  double a[41], b[41];

  (void)state;
  for (size_t i = 0; i < N_LAW; i++)
    for (double cap = 1; cap < 1.3; cap += 0.05) {
      vg_growth_law_heights(&laws[i], cap, 40, a);
      vg_growth_law_heights(&laws[i], cap + 0.05, 40, b);
      for (int j = 0; j <= 40; j++) assert_true(a[j] <= b[j]);
    }
}

static void y_plus_round_trip(void **state)
{
  (void)state;
  for (double re = 1e4; re < 1e9; re *= 7)
    for (double y_plus = 0.1; y_plus < 300; y_plus *= 3) {
      double y = vg_first_height(y_plus, re, 2.5);

      assert_true(y > 0);
      assert_true(fabs(vg_y_plus(y, re, 2.5) / y_plus - 1) < 1e-14);
      assert_true(
        fabs(vg_y_plus_at(y, re, 2.5, 0.026 / pow(re, 1. / 7)) / y_plus - 1) <
        1e-13);
      assert_true(fabs(vg_first_height(y_plus, re, 5) / y - 2) < 1e-14);
    }
  /* By hand: Re^(1/7) = 9.0582 for 5 million, c_f = 0.0028703, so that sqrt(c_f
   * / 2) = 0.037884 and y = 1 / (5e6 * 0.037884). */
  assert_true(fabs(vg_first_height(1, 5e6, 1) / 5.2793e-6 - 1) < 1e-4);
}

static void a_rate_for_the_total(void **state)
{
  (void)state;
  for (int n = 2; n <= 60; n += 7)
    for (int constant = 1; constant < 4; constant++)
      for (double rate = 0.01; rate < 0.6; rate *= 2) {
        struct vg_growth_law law = { 1e-5, rate, 0, INFINITY, constant };
        double d[61], total;

        if (n <= constant) continue;
        vg_growth_law_heights(&law, INFINITY, n, d);
        total = d[n];
        law.rate1 = vg_growth_law_rate_for_total(1e-5, constant, n, total);
        vg_growth_law_heights(&law, INFINITY, n, d);
        assert_true(fabs(d[n] / total - 1) < 1e-12);
        assert_true(fabs(law.rate1 - rate) < 1e-9);
      }
  assert_true(vg_growth_law_rate_for_total(0.1, 1, 10, 0.9) < 0);
  assert_true(vg_growth_law_rate_for_total(0.1, 10, 10, 2) == INFINITY);
  assert_true(vg_growth_law_rate_for_total(0.1, 1, 10, 1) < 1e-12);
}

/* Levels of a column, and a coordinate that its direction does not change. */
static void columns_have_points(void **state)
{
  double point[1][3] = { { 0.1, 1.0 / 3, -7 } }, d[VG_LEVELS_MAX + 1], x[6][3];
  struct vg_growth_law law = { 0.25, 0.2, 0, 1.3, 1 };
  struct vg_column column = {
    .dir = { 0, 0, 2 }, .cap = INFINITY, .bent = SIZE_MAX, .n = 5
  };
  struct vg_columns c = {
    .n_column = 1, .n_law = 1, .column = &column, .law = &law
  };
  struct vg_mesh m = { .n_point = 1, .point = point };
  double top[3];

  (void)state;
  vg_column_points(&c, &m, 0, d, x);
  vg_column_top(&c, &m, 0, top);
  assert_memory_equal(x[0], point[0], sizeof x[0]);
  assert_memory_equal(x[5], top, sizeof top);
  for (int l = 0; l <= 5; l++) {
    assert_true(x[l][0] == point[0][0] && x[l][1] == point[0][1]);
    assert_true(x[l][2] == -7 + 2 * d[l]);
  }
  c.path = x;
  column.bent = 1;
  column.n = 2;
  vg_column_top(&c, &m, 0, top);
  assert_memory_equal(x[3], top, sizeof top);
  assert_string_equal(vg_layer_cause_name(VG_CAUSE_NONE), "none");
  assert_string_equal(vg_layer_cause_name(VG_CAUSE_SLIDE), "slide");
}

/* The numbers of the workshops, to the published digits. */
static void members_of_a_grid_family(void **state)
{
  static const double ratio[6] = { 1.16, 1.104, 1.068, 1.045, 1.03, 1.02 };
  static const double y_plus[6] = { 1, 0.67, 0.5, 0.4, 0.33, 0.29 };

  (void)state;
  for (int level = 1; level <= 6; level++) {
    const double scale = 2. / (level + 1);
    struct vg_growth_law law = { 1, 0.16, 0, 1.3, 2 };
    int n = 40;

    vg_growth_law_scale(&law, VG_GROWTH_LAW_WORKSHOP, scale, &n);
    assert_float_equal(1 + law.rate1, ratio[level - 1], 0.0006);
    assert_float_equal(law.delta1, y_plus[level - 1], 0.005);
    assert_int_equal(law.n_constant, (int64_t)floor(2 / scale + 0.5));
    assert_true(law.cap >= 1 + law.rate1);
  }
}

/* A finer member of an even family has proportionally more layers and the same
 * total height, to within the thickness of the last layer. */
static void an_even_family_is_as_high(void **state)
{
  struct vg_growth_law law = { 1e-3, 0.2, 0, 1.3, 1 }, half = law;
  double d[2][VG_LEVELS_MAX + 1];
  int n = 24;

  (void)state;
  vg_growth_law_scale(&half, VG_GROWTH_LAW_EVEN, 0.5, &n);
  assert_int_equal(n, 48);
  assert_true(fabs(half.rate1 - (sqrt(1.2) - 1)) < 1e-14);
  assert_true(fabs(half.cap - sqrt(1.3)) < 1e-14);
  assert_int_equal(half.n_constant, 1);
  vg_growth_law_heights(&law, INFINITY, 24, d[0]);
  vg_growth_law_heights(&half, INFINITY, 48, d[1]);
  assert_float_equal(d[1][48] / d[0][24], 1, 0.06);
  n = 200;
  vg_growth_law_scale(&half, VG_GROWTH_LAW_EVEN, 0.5, &n);
  assert_int_equal(n, VG_LEVELS_MAX);
  n = 0;
  half = law;
  vg_growth_law_scale(&half, VG_GROWTH_LAW_KEPT, 0.5, &n);
  assert_int_equal(n, 0);
  assert_memory_equal(&half, &law, sizeof law);
}

static void powers_are_computed_without_libm(void **state)
{
  static const double x[] = { 2. / 3, 1, 1.02, 1.2, 10 };
  static const double e[] = { 0, 1e-9, 1. / 3, 0.5, 1, 2.75, 198, -0.4, -2 };

  (void)state;
  for (size_t i = 0; i < sizeof x / sizeof *x; i++)
    for (size_t k = 0; k < sizeof e / sizeof *e; k++) {
      double y = pow(x[i], e[k]);

      assert_true(fabs(vg_real_power(x[i], e[k]) - y) < 1e-13 * y);
    }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(vgrid_box),
    cmocka_unit_test(geometric_when_r2_is_0),
    cmocka_unit_test(thickness_grows_by_cap_at_most),
    cmocka_unit_test(constant_layers_shift_the_law),
    cmocka_unit_test(a_compressed_column_fits),
    cmocka_unit_test(a_lower_cap_raises_no_height),
    cmocka_unit_test(y_plus_round_trip),
    cmocka_unit_test(a_rate_for_the_total),
    cmocka_unit_test(columns_have_points),
    cmocka_unit_test(members_of_a_grid_family),
    cmocka_unit_test(an_even_family_is_as_high),
    cmocka_unit_test(powers_are_computed_without_libm),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
