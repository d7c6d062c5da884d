/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The hierarchy of samples (core/sizing/sizing_bvh.h) against all samples one
 * by one, and its vectors of four and of eight lanes against each other. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <cmocka.h>

#include "base/wide.h"
#include "core/sizing/sizing_bvh_parts.h"

#define SAMPLES 3000
#define QUERIES 4000
#define SLOPE 0.2

static uint64_t seed = 1;

/* From 0 to 1. */
static double random_number(void)
{
  seed = seed * 6364136223846793005u + 1442695040888963407u;
  return (double)(seed >> 32) * 0x1p-32;
}

/* Samples on a sphere, with sizes that differ by a factor of up to 1000. */
struct samples {
  double p[SAMPLES][3], h[SAMPLES];
  struct vg_bvh *tree;
};

static void make(struct samples *s)
{
  struct vg_error err = VG_ERROR_INIT;

  for (int i = 0; i < SAMPLES; i++) {
    double r2 = 0;

    for (int k = 0; k < 3; k++) {
      s->p[i][k] = random_number() - 0.5;
      r2 += s->p[i][k] * s->p[i][k];
    }
    for (int k = 0; k < 3; k++) s->p[i][k] /= sqrt(r2);
    s->h[i] = 1e-3 * pow(10, 1.5 * (s->p[i][0] + 1));
  }
  assert_int_equal(vg_bvh_new(SAMPLES, (const double(*)[3])s->p, s->h, SLOPE, 1,
                              &s->tree, &err),
                   VG_OK);
}

/* A box, in every third case a point. */
static void random_box(double lo[3], double hi[3])
{
  double side = random_number() < 1 / 3. ? 0 : pow(10, -3 * random_number());

  for (int k = 0; k < 3; k++) {
    lo[k] = 3 * random_number() - 1.5;
    hi[k] = lo[k] + side;
  }
}

/* A cube of up to four times the side around a box, which is not at its centre.
 */
static struct vg_bvh_reach reach_around(const double lo[3], const double hi[3])
{
  struct vg_bvh_reach r = { .is_known = 0 };
  double side = hi[0] - lo[0] + 0.1 * random_number();

  for (int k = 0; k < 3; k++)
    r.mid[k] = 0.5 * (lo[k] + hi[k]) + side * (random_number() - 0.5);
  vg_bvh_reach_clear(&r, 1.001 * side, 1e-5f);
  return r;
}

static double distance(const double lo[3], const double hi[3],
                       const double p[3])
{
  double sum = 0;

  for (int k = 0; k < 3; k++) {
    double d = fmax(fmax(lo[k] - p[k], p[k] - hi[k]), 0);

    sum += d * d;
  }
  return sqrt(sum);
}

static void values_are_those_of_all_samples(void **state)
{
  static struct samples s;
  const double rise = vg_bvh_rise(SLOPE), steep = vg_bvh_steep(SLOPE);
  const double offset = vg_bvh_offset(SLOPE);
  uint32_t hint = 0;

  (void)state;
  make(&s);
  for (int q = 0; q < QUERIES; q++) {
    double lo[3], hi[3], above = INFINITY, below = 0, by, value;
    struct vg_bvh_reach reach;

    random_box(lo, hi);
    for (int i = 0; i < SAMPLES; i++) {
      double d = distance(lo, hi, s.p[i]), h = s.h[i];

      above = fmin(above, fmax(h, h * (1 - offset) + SLOPE * d));
      d = distance(lo, lo, s.p[i]);
      below = fmax(below, fmin(h, fmin(h * (1 + offset) - SLOPE * d,
                                       h * rise - steep * d)));
    }
    value = vg_bvh_above(s.tree, lo, hi, INFINITY, NULL, &hint);
    assert_true(fabs(value - above) <= 1e-5 * above);
    reach = reach_around(lo, hi);
    for (int i = 0; i < 2; i++)
      assert_true(vg_bvh_above(s.tree, lo, hi, INFINITY, &reach, &hint) ==
                  value);
    value = vg_bvh_below(s.tree, lo, 1e-4, INFINITY, NULL, &by);
    below = fmax(below, 1e-4);
    assert_true(fabs(value - below) <= 1e-5 * fmax(below, by));
  }
  vg_bvh_free(s.tree);
}

static void all_widths_have_the_same_bits(void **state)
{
#ifdef VG_WIDE
  static struct samples s;
  uint32_t hint[2] = { 0, 0 };

  (void)state;
  if (!VG_IS_WIDE) skip();
  make(&s);
  for (int q = 0; q < QUERIES; q++) {
    double lo[3], hi[3], v[2], by[2], enough;
    struct vg_bvh_reach reach[2];

    random_box(lo, hi);
    reach[0] = reach[1] = reach_around(lo, hi);
    v[0] = vg_bvh_above_narrow(s.tree, lo, hi, 1, q % 2 ? &reach[0] : NULL,
                               &hint[0]);
    v[1] = vg_bvh_above_wide(s.tree, lo, hi, 1, q % 2 ? &reach[1] : NULL,
                             &hint[1]);
    assert_true(v[0] == v[1] && hint[0] == hint[1]);
    enough = v[0] * (0.5 + random_number());
    for (int w = 0; w < 2; w++) {
      reach[w] = (struct vg_bvh_reach){ .mid = { hi[0], hi[1], hi[2] },
                                        .trifle = 1e-5f };
      v[w] = (w ? vg_bvh_below_wide
                : vg_bvh_below_narrow)(s.tree, lo, 1e-4, enough,
                                       q % 2 ? &reach[w] : NULL, &by[w]);
    }
    assert_true(v[0] == v[1] && by[0] == by[1]);
  }
  vg_bvh_free(s.tree);
#else
  (void)state;
  skip();
#endif
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(values_are_those_of_all_samples),
    cmocka_unit_test(all_widths_have_the_same_bits),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
