/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Tensors: eigenvalues, roots, inverses, intersections and lengths, on random
 * metrics of aspects up to 1e6. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "core/geometry/tensor.h"
#include "core/geometry/vector.h"
#include "tensor_support.h"

static void random_metric(double aspect, double m[6])
{
  double value[3], v[3][3];

  random_frame(v);
  for (int k = 0; k < 3; k++) value[k] = pow(aspect, random_in(-2, 2));
  vg_tensor_from_eigen(value, (const double(*)[3])v, m);
}

static void eigenvectors_are_found(void **state)
{
  (void)state;
  for (int trial = 0; trial < 2000; trial++) {
    double want[3], v[3][3], m[6], value[3], vector[3][3], av[3];

    random_frame(v);
    want[0] = random_in(0.001, 1);
    want[1] = trial % 3 ? want[0] + random_in(0, 10) : want[0];
    want[2] = trial % 2 ? want[1] + random_in(0, 1000) : want[1];
    vg_tensor_from_eigen(want, (const double(*)[3])v, m);
    vg_tensor_eigen(m, value, vector);
    for (int k = 0; k < 3; k++) {
      assert_true(fabs(value[k] - want[k]) < 1e-12 * want[2]);
      vg_tensor_apply(m, vector[k], av);
      for (int i = 0; i < 3; i++)
        assert_true(fabs(av[i] - value[k] * vector[k][i]) < 1e-11 * want[2]);
    }
    assert_true(fabs(vg_triple(vector[0], vector[1], vector[2])) > 1 - 1e-12);
  }
}

static void roots_and_inverses(void **state)
{
  (void)state;
  for (int trial = 0; trial < 2000; trial++) {
    double m[6], t[6], back[6], inverse[6], e[3], x[3], scale = 0;

    random_metric(30, m);
    vg_tensor_root(m, t);
    vg_tensor_square(t, back);
    for (int k = 0; k < 6; k++) scale = fmax(scale, fabs(m[k]));
    for (int k = 0; k < 6; k++)
      assert_true(fabs(back[k] - m[k]) < 1e-11 * scale);
    for (int k = 0; k < 3; k++) e[k] = random_in(-1, 1);
    vg_tensor_apply(t, e, x);
    assert_true(fabs(vg_norm(x) - sqrt(vg_tensor_form(m, e))) <
                1e-7 * sqrt(scale) * vg_norm(e));
    assert_true(vg_tensor_invert(t, inverse) > 0);
    vg_tensor_apply(inverse, x, x);
    assert_true(vg_distance(x, e) < 1e-6);
  }
}

static void cube_roots(void **state)
{
  (void)state;
  for (int trial = 0; trial < 2000; trial++) {
    double x = pow(10, random_in(-200, 200)), y = vg_cube_root(x);

    assert_true(fabs(y * y * y - x) < 2e-15 * x);
  }
}

/* The intersection is at least as fine as both metrics in every direction, and
 * touches one of them in three directions. */
static void intersections_cover_both(void **state)
{
  (void)state;
  for (int trial = 0; trial < 2000; trial++) {
    double a[6], b[6], m[6], twice[6], e[3];

    random_metric(10, a);
    random_metric(10, b);
    vg_metric_intersect(a, b, m);
    for (int k = 0; k < 50; k++) {
      for (int i = 0; i < 3; i++) e[i] = random_in(-1, 1);
      assert_true(vg_tensor_form(m, e) > 0.9999 * vg_tensor_form(a, e));
      assert_true(vg_tensor_form(m, e) > 0.9999 * vg_tensor_form(b, e));
    }
    assert_true(vg_tensor_det(m) < 1.0001 * fmax(vg_tensor_det(a), 1) *
                                     fmax(vg_tensor_det(b), 1) * 1e12);
    for (int k = 0; k < 6; k++) twice[k] = 4 * a[k];
    vg_metric_intersect(twice, a, m);
    assert_true(!memcmp(m, twice, sizeof m));
    vg_metric_intersect(a, twice, m);
    for (int i = 0; i < 3; i++) e[i] = random_in(-1, 1);
    assert_true(fabs(vg_tensor_form(m, e) / vg_tensor_form(twice, e) - 1) <
                1e-6);
  }
}

/* Sizes that change geometrically along the edge: the exact integral. */
static void lengths(void **state)
{
  (void)state;
  static const double ratio[] = { 1, 1.01, 2, 10, 1000 };

  for (int k = 0; k < 5; k++) {
    double a[6], b[6], v[3] = { 2, 0, 0 }, la = 2, lb = 2 * ratio[k];
    double want = k ? (lb - la) / log(lb / la) : 2;

    vg_tensor_uniform(1, a);
    vg_tensor_uniform(ratio[k] * ratio[k], b);
    assert_true(fabs(vg_metric_length(a, b, v) / want - 1) < 1e-3);
    assert_true(fabs(vg_metric_length(b, a, v) / want - 1) < 1e-3);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(eigenvectors_are_found),
    cmocka_unit_test(roots_and_inverses),
    cmocka_unit_test(cube_roots),
    cmocka_unit_test(intersections_cover_both),
    cmocka_unit_test(lengths),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
