/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Sizes along Mach cones. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/geometry/tensor.h"
#include "core/geometry/vector.h"
#include "core/sizing/sizing_cone.h"
#include "core/sizing/sizing_source.h"
#include "core/sizing/sizing_tensor.h"

#define SLOPE 0.2 /* growth - 1 */

static void cone_tensor(const struct vg_source *s, double slope,
                        const double x[3], double h[6])
{
  struct vg_mach_cones c;
  struct vg_size_axes a;

  vg_mach_cones_prepare(s, slope, &c);
  vg_mach_cones_axes(&c, x, &a);
  vg_size_axes_tensor(&a, h);
}

/* Cones of a flow along x at Mach 1.6 with apexes from -1 to 2, up to r = 10.
 */
static struct vg_source cones(void)
{
  return (struct vg_source){ .kind = VG_SOURCE_MACHCONE,
                             .p0 = { -1, 0, 0 },
                             .p1 = { 2, 0, 0 },
                             .h0 = 0.02,
                             .h1 = 0.04,
                             .r0 = 10,
                             .stretch = 20,
                             .mach = 1.6,
                             .an = 1 };
}

static double size_along(const double h[6], double x, double y, double z)
{
  double d[3] = { x, y, z }, to[3], inverse[6];

  vg_unit(d);
  vg_tensor_invert(h, inverse);
  vg_tensor_apply(inverse, d, to);
  return 1 / vg_norm(to);
}

static void near(double a, double b)
{
  if (!(fabs(a - b) <= 1e-12 * fmax(1, fabs(b)))) fail_msg("%.17g %.17g", a, b);
}

static void has_its_sizes_along_and_across(void **state)
{
  const struct vg_source s = cones();
  const double sine = 1 / 1.6, cosine = sqrt(1 - sine * sine);
  /* On the cone with the apex at x = 0.5, at radius 5. */
  const double x[3] = { 0.5 + 5 * cosine / sine, 3, -4 };
  const double turn = sqrt(1.75 * 1.75 - sine * sine) / cosine;
  const double round = sqrt(0.03 * (0.03 + turn * SLOPE * 5));
  double h[6], value[3], vector[3][3], t, way[3];

  (void)state;
  assert_true(vg_mach_cone_way(&s, x, &t, way) == 0);
  near(t, 0.5);
  cone_tensor(&s, SLOPE, x, h);
  near(size_along(h, sine, -cosine * 0.6, cosine * 0.8), 0.03);
  near(size_along(h, cosine, sine * 0.6, -sine * 0.8), 0.6);
  near(size_along(h, 0, 0.8, 0.6), round);
  vg_tensor_eigen(h, value, vector);
  near(value[0], 0.03);
  near(value[1], round);
  near(value[2], 0.6);
}

/* An edge of the size around the axis leaves the cone by at most half of the
 * size across it, and no size exceeds what growth from the axis allows. */
static void keeps_chords_near_the_cone(void **state)
{
  const struct vg_source s = cones();

  (void)state;
  for (double r = 0.01; r < 10; r *= 1.5) {
    const double x[3] = { r * sqrt(1.56), r, 0 };
    double h[6], round, across;

    cone_tensor(&s, SLOPE, x, h);
    round = size_along(h, 0, 0, 1);
    across = 0.02 + 0.02 * r / 10;
    assert_true(hypot(r, round) - r <= fmax(0.5, across / r) * across);
    assert_true(round >= across - 1e-12);
    assert_true(size_along(h, sqrt(1.56), 1, 0) <= across + SLOPE * r);
  }
}

/* The tensor is isotropic, with exactly equal components, at the axis, and
 * changes continuously. */
static void is_isotropic_at_the_axis(void **state)
{
  const struct vg_source s = cones();
  const double on[3] = { 1, 0, 0 }, at[3] = { 1, 0.015, 0 };
  const double beyond[3] = { 1, 0.0203, 0 };
  double h[6];

  (void)state;
  cone_tensor(&s, SLOPE, on, h);
  assert_true(h[0] == 0.02 && h[3] == h[0] && h[5] == h[0]);
  assert_true(h[1] == 0 && h[2] == 0 && h[4] == 0);
  cone_tensor(&s, SLOPE, at, h);
  assert_true(h[0] == h[3] && h[3] == h[5] && h[1] == 0);
  cone_tensor(&s, SLOPE, beyond, h);
  assert_true(fabs(h[0] - h[3]) < 0.001 && fabs(h[0] - h[5]) < 0.001);
}

static double distance(const struct vg_source *s, const double x[3])
{
  double t, way[3];

  return vg_mach_cone_way(s, x, &t, way);
}

/* The way leads to a point of the shape, the distance is its length, and no
 * sampled point of the shape is nearer. */
static void finds_the_nearest_point(void **state)
{
  struct vg_source s = cones();
  const double cot = sqrt(1.56);
  double lo[3], hi[3];

  (void)state;
  vg_mach_cone_bounds(&s, lo, hi);
  near(lo[0], -1);
  near(hi[0], 2 + 10 * cot);
  near(lo[1], -10);
  near(hi[2], 10);
  for (double z = -20; z < 40; z += 2.7)
    for (double r = 0; r < 25; r += 1.9) {
      const double x[3] = { z, 0.6 * r, 0.8 * r };
      double t, way[3], foot[3], least = INFINITY;
      const double d = vg_mach_cone_way(&s, x, &t, way);

      near(vg_norm(way), d);
      vg_sub(x, way, foot);
      assert_true(distance(&s, foot) < 1e-12);
      for (int k = 0; k < 3; k++)
        assert_true(foot[k] >= lo[k] - 1e-12 && foot[k] <= hi[k] + 1e-12);
      for (int i = 0; i <= 60; i++)
        for (int j = 0; j <= 60; j++)
          least = fmin(least,
                       hypot(-1 + i / 20.0 + j / 6.0 * cot - z, j / 6.0 - r));
      assert_true(d <= least + 1e-12);
      assert_true(d >= least - 0.17); /* Half a diagonal of the samples. */
    }
}

/* A turned source gives turned tensors. */
static void follows_its_axis(void **state)
{
  const struct vg_source s = cones();
  struct vg_source turned = s;
  const double x[3] = { 6, 2, 3 }, y[3] = { 3, 6, 2 };
  double a[6], b[6];

  (void)state;
  for (int k = 0; k < 3; k++) {
    turned.p0[(k + 1) % 3] = s.p0[k];
    turned.p1[(k + 1) % 3] = s.p1[k];
  }
  cone_tensor(&s, SLOPE, x, a);
  cone_tensor(&turned, SLOPE, y, b);
  near(a[0], b[3]);
  near(a[1], b[4]);
  near(a[2], b[1]);
  near(a[3], b[5]);
  near(a[4], b[2]);
  near(a[5], b[0]);
  near(distance(&s, x), distance(&turned, y));
}

static double between(uint64_t *seed, double lo, double hi)
{
  *seed = *seed * 6364136223846793005u + 1442695040888963407u;
  return lo + (hi - lo) * (double)(*seed >> 11) * 0x1p-53;
}

/* Largest length in the size tensor `most` of an edge that has length 1 in h.
 */
static double longest(const double h[6], const double most[6])
{
  double unit[6], ball[6], value[3], vector[3][3], d[3], e[3], worst = 0;

  vg_tensor_invert(most, unit);
  vg_tensor_eigen(h, value, vector);
  for (int i = 0; i < 6; i++) ball[i] = 0;
  for (int i = 0; i < 3; i++) { /* sum of (unit h e)(unit h e)' */
    vg_tensor_apply(h, vector[i], d);
    vg_tensor_apply(unit, d, e);
    for (int k = 0, n = 0; k < 3; k++)
      for (int l = k; l < 3; l++) ball[n++] += e[k] * e[l];
  }
  vg_tensor_eigen(ball, value, vector);
  for (int i = 0; i < 3; i++) worst = fmax(worst, value[i]);
  return sqrt(worst);
}

/* The sizes obey the growth within 0.3 of its slope, over steps of up to half
 * an edge in each axis, within the cones, outside, and beyond their end: for
 * random stretching, sizes, Mach numbers and growth. */
static void obeys_the_growth(void **state)
{
  uint64_t seed = 1;

  (void)state;
  for (int i = 0; i < 40000; i++) {
    struct vg_source s = cones();
    const double slope = between(&seed, 0.05, 0.4);
    double x[3], y[3], way[3], h[6], from[6], excess;

    s.h0 = between(&seed, 0.01, 0.1);
    s.h1 = between(&seed, 0.5, 2) * s.h0;
    s.stretch = between(&seed, 1, 10) * between(&seed, 1, 10);
    s.mach = between(&seed, 1.05, 4);
    x[0] = between(&seed, -10, 30);
    for (int k = 1; k < 3; k++) x[k] = between(&seed, -12, 12);
    cone_tensor(&s, slope, x, from);
    for (int k = 0; k < 3; k++) way[k] = between(&seed, -0.5, 0.5);
    vg_tensor_apply(from, way, y);
    memcpy(way, y, sizeof way);
    for (int k = 0; k < 3; k++) y[k] += x[k];
    cone_tensor(&s, slope, y, h);
    vg_size_grow(from, way, slope, from);
    excess = longest(h, from) - 1;
    if (!(excess < 0.3 * slope))
      fail_msg("case %d at (%g, %g, %g), slope %g, Mach %g, stretch %g: %g", i,
               x[0], x[1], x[2], slope, s.mach, s.stretch, excess);
  }
}

/* The octree of the field follows the law, with larger errors at kinks between
 * the samples (H14). Coarse sizes, since the field is large. */
static void makes_a_field(void **state)
{
  struct vg_source s = cones();
  struct vg_sizing_options o = VG_SIZING_OPTIONS_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_sizing *field = NULL;
  double before = INFINITY;

  (void)state;
  s.h0 = s.h1 = 0.15;
  s.stretch = 10;
  if (vg_sizing_new(&o, 1, &s, NULL, &field, &err) != VG_OK)
    fail_msg("%s", err.text);
  assert_true(vg_sizing_is_stretched(field));
  for (double apex = -0.5; apex <= 1.5; apex += 0.25)
    for (double r = 1; r <= 9; r += 0.5) {
      const double x[3] = { apex + r * sqrt(1.56), 0.6 * r, -0.8 * r };
      double h[6], t[6], value[3], axis[3][3], e[3];

      cone_tensor(&s, SLOPE, x, h);
      vg_sizing_stretch_at(field, x, t);
      vg_tensor_eigen(h, value, axis);
      for (int i = 0; i < 3; i++) {
        vg_tensor_apply(t, axis[i], e);
        if (!(vg_norm(e) * value[i] > 0.8 && vg_norm(e) * value[i] < 1.15))
          fail_msg("apex %g, r %g, axis %d: %g", apex, r, i,
                   vg_norm(e) * value[i]);
      }
    }
  /* Outside, sizes grow with the distance. */
  for (double apex = -3; apex < -1; apex += 0.25) {
    const double x[3] = { apex + 5 * sqrt(1.56), 3, 4 };
    const double h = vg_sizing_at(field, x);

    assert_true(h < before);
    before = h;
  }
  vg_sizing_free(field);
}

static void refuses_bad_sources(void **state)
{
  struct {
    size_t at;
    double value;
    const char *text;
  } const bad[] = {
    { offsetof(struct vg_source, mach), 1, "Mach number is not above 1" },
    { offsetof(struct vg_source, mach), NAN, "Mach number is not above 1" },
    { offsetof(struct vg_source, r0), 0, "radius is not positive" },
    { offsetof(struct vg_source, h1), 0, "not positive" },
    { offsetof(struct vg_source, p1), -1, "axis has no length" },
    { offsetof(struct vg_source, stretch), 0.5, "stretching is below 1" },
  };
  struct vg_source s = cones();
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  assert_int_equal(vg_source_check(1, &s, &err), VG_OK);
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    s = cones();
    memcpy((char *)&s + bad[i].at, &bad[i].value, sizeof(double));
    assert_int_equal(vg_source_check(1, &s, &err), VG_ERR_INPUT);
    if (!strstr(err.text, bad[i].text)) fail_msg("%s", err.text);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(has_its_sizes_along_and_across),
    cmocka_unit_test(keeps_chords_near_the_cone),
    cmocka_unit_test(is_isotropic_at_the_axis),
    cmocka_unit_test(finds_the_nearest_point),
    cmocka_unit_test(follows_its_axis),
    cmocka_unit_test(obeys_the_growth),
    cmocka_unit_test(makes_a_field),
    cmocka_unit_test(refuses_bad_sources),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
