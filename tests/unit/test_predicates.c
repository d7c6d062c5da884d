/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Signs of core/geometry/predicates.h compared with integer arithmetic of
 * arbitrary length: every coordinate here is a whole number, so the reference
 * has no rounding. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/geometry/predicates.h"

/* --- signed integers of LIMB 32-bit digits, two's complement ------------- */

#define LIMB 14 /* 448 bits: five factors of 64 bits and sums of them */

struct big {
  uint32_t v[LIMB];
};

static struct big big_of(double x)
{
  int64_t i = (int64_t)x;
  struct big b;

  assert_true((double)i == x);
  b.v[0] = (uint32_t)i;
  b.v[1] = (uint32_t)((uint64_t)i >> 32);
  for (int k = 2; k < LIMB; k++) b.v[k] = i < 0 ? UINT32_MAX : 0;
  return b;
}

static struct big big_add(struct big a, struct big b)
{
  uint64_t carry = 0;

  for (int k = 0; k < LIMB; k++) {
    carry += (uint64_t)a.v[k] + b.v[k];
    a.v[k] = (uint32_t)carry;
    carry >>= 32;
  }
  return a;
}

static struct big big_neg(struct big a)
{
  struct big one = { { 1 } };

  for (int k = 0; k < LIMB; k++) a.v[k] = ~a.v[k];
  return big_add(a, one);
}

static struct big big_sub(struct big a, struct big b)
{
  return big_add(a, big_neg(b));
}

static struct big big_mul(struct big a, struct big b)
{
  struct big r;

  memset(&r, 0, sizeof r);
  for (int i = 0; i < LIMB; i++) {
    uint64_t carry = 0;

    for (int j = 0; i + j < LIMB; j++) {
      carry += (uint64_t)a.v[i] * b.v[j] + r.v[i + j];
      r.v[i + j] = (uint32_t)carry;
      carry >>= 32;
    }
  }
  return r;
}

static int big_sign(struct big a)
{
  if (a.v[LIMB - 1] >> 31) return -1;
  for (int k = 0; k < LIMB; k++)
    if (a.v[k]) return 1;
  return 0;
}

/* Determinant by expansion along the first row; m[n][4]. */
static struct big big_det(int n, struct big m[][4])
{
  struct big sum, minor[4][4];

  if (n == 1) return m[0][0];
  memset(&sum, 0, sizeof sum);
  for (int c = 0; c < n; c++) {
    for (int i = 1; i < n; i++)
      for (int j = 0, at = 0; j < n; j++)
        if (j != c) minor[i - 1][at++] = m[i][j];
    struct big t = big_mul(m[0][c], big_det(n - 1, minor));
    sum = c & 1 ? big_sub(sum, t) : big_add(sum, t);
  }
  return sum;
}

/* Rows p[i] - p[last], with the squared length appended if lifted. */
static int det_sign(int n, int dim, double p[][3], int lifted)
{
  struct big m[4][4];

  for (int i = 0; i < n - 1; i++) {
    struct big lift;

    memset(&lift, 0, sizeof lift);
    for (int k = 0; k < dim; k++) {
      m[i][k] = big_sub(big_of(p[i][k]), big_of(p[n - 1][k]));
      lift = big_add(lift, big_mul(m[i][k], m[i][k]));
    }
    if (lifted) m[i][dim] = lift;
  }
  return big_sign(big_det(n - 1, m));
}

static int sign(double x)
{
  return (x > 0) - (x < 0);
}

static void check_orient3d(double p[4][3])
{
  assert_int_equal(sign(vg_orient3d(p[0], p[1], p[2], p[3])),
                   -det_sign(4, 3, p, 0));
}

static void check_insphere(double p[5][3])
{
  assert_int_equal(sign(vg_insphere(p[0], p[1], p[2], p[3], p[4])),
                   -det_sign(5, 3, p, 1));
}

static void check_plane(double p[4][3])
{
  assert_int_equal(sign(vg_orient2d(p[0], p[1], p[2])), det_sign(3, 2, p, 0));
  assert_int_equal(sign(vg_incircle(p[0], p[1], p[2], p[3])),
                   det_sign(4, 2, p, 1));
}

/* --- points -------------------------------------------------------------- */

static uint64_t next(uint64_t *state) /* xorshift64* */
{
  *state ^= *state >> 12;
  *state ^= *state << 25;
  *state ^= *state >> 27;
  return *state * 2685821657736338717u;
}

/* Whole number of random sign below 2^bits, 53 significant bits at most. */
static double whole(uint64_t *state, int bits)
{
  double x = (double)(next(state) >> (64 - bits));

  return next(state) >> 63 ? -x : x;
}

static double rounded(double x)
{
  return (double)(int64_t)x;
}

static void knows_the_reference_cases(void **unused)
{
  double o[3] = { 0, 0, 0 }, x[3] = { 1, 0, 0 }, y[3] = { 0, 1, 0 };
  double z[3] = { 0, 0, 1 }, in[3] = { .3, .3, .3 }, out[3] = { 2, 2, 2 };
  double on[3] = { 1, 1, 1 };

  (void)unused;
  assert_true(vg_orient3d(o, x, y, z) == 1);
  assert_true(vg_orient3d(o, y, x, z) == -1);
  assert_true(vg_insphere(o, x, y, z, in) > 0);
  assert_true(vg_insphere(o, x, y, z, out) < 0);
  assert_true(vg_insphere(o, x, y, z, on) == 0);
  assert_true(vg_orient2d(o, x, y) > 0);
  assert_true(vg_orient2d(o, y, x) < 0);
  assert_true(vg_incircle(o, x, y, in) > 0);
  assert_true(vg_incircle(o, x, y, out) < 0);
  assert_true(vg_incircle(o, x, y, on) == 0);
}

/* All 4-subsets of a 3x3x3 grid, at the origin and far from it, where most
 * subsets are degenerate. */
static void is_exact_on_a_grid(void **unused)
{
  const double offset[3][3] = { { 0, 0, 0 },
                                { 4503599627370487, -4503599627370495, 7 },
                                { 1e15, 3e14, -2e15 } };
  double p[5][3], q[27][3];

  (void)unused;
  for (int o = 0; o < 3; o++) {
    for (int i = 0; i < 27; i++) {
      q[i][0] = offset[o][0] + i % 3;
      q[i][1] = offset[o][1] + i / 3 % 3;
      q[i][2] = offset[o][2] + i / 9;
    }
    for (int a = 0; a < 27; a++)
      for (int b = a + 1; b < 27; b++)
        for (int c = b + 1; c < 27; c++)
          for (int d = c + 1; d < 27; d++) {
            memcpy(p[0], q[a], sizeof *p);
            memcpy(p[1], q[b], sizeof *p);
            memcpy(p[2], q[c], sizeof *p);
            memcpy(p[3], q[d], sizeof *p);
            memcpy(p[4], q[(a * 7 + b * 5 + c * 3 + d) % 27], sizeof *p);
            check_orient3d(p);
            if (d % 3 == o) check_insphere(p);
            check_plane(p);
          }
  }
}

/* d within a rounding of the plane of a b c; coordinates of mixed size, so that
 * differences need two doubles. */
static void is_exact_near_a_plane(void **unused)
{
  uint64_t s = 1;
  double p[4][3];

  (void)unused;
  for (int n = 0; n < 20000; n++) {
    int bits = 8 + n % 54;
    double u = (double)(next(&s) % 64) / 32 - 1;
    double v = (double)(next(&s) % 64) / 32 - 1;

    for (int i = 0; i < 3; i++)
      for (int k = 0; k < 3; k++)
        p[i][k] = whole(&s, i == n % 3 ? bits : 2 + bits / 2);
    for (int k = 0; k < 3; k++)
      p[3][k] = rounded(p[0][k] + u * (p[1][k] - p[0][k]) / 2 +
                        v * (p[2][k] - p[0][k]) / 2);
    check_orient3d(p);
    check_plane(p);
    for (int k = 0; k < 2; k++) /* and c on the line of a b */
      p[2][k] = rounded(p[0][k] + u * (p[1][k] - p[0][k]) / 2);
    check_plane(p);
  }
}

/* Points of one sphere about 0 (permutations and reflections of one point), one
 * of them moved by at most one unit. */
static void is_exact_near_a_sphere(void **unused)
{
  const int perm[6][3] = { { 0, 1, 2 }, { 1, 2, 0 }, { 2, 0, 1 },
                           { 0, 2, 1 }, { 2, 1, 0 }, { 1, 0, 2 } };
  uint64_t s = 2;
  double p[5][3], x[3];
  int zero = 0;

  (void)unused;
  for (int n = 0; n < 6000; n++) {
    for (int k = 0; k < 3; k++) x[k] = whole(&s, 6 + (n + 17 * k) % 55);
    for (int i = 0; i < 5; i++) {
      uint64_t r = next(&s) >> 8;

      for (int k = 0; k < 3; k++) {
        p[i][k] = x[perm[r % 6][k]];
        if (r >> (8 + k) & 1) p[i][k] = -p[i][k];
      }
    }
    if (n & 1) p[next(&s) % 5][n / 2 % 3] += 1;
    check_insphere(p);
    check_plane(p);
    zero += vg_insphere(p[0], p[1], p[2], p[3], p[4]) == 0;
  }
  assert_true(zero > 1000); /* the cases are as degenerate as intended */
}

/* Nearly cospherical far from the origin of coordinates. */
static void is_exact_after_translation(void **unused)
{
  const double unit[5][3] = {
    { 3, 4, 0 }, { -5, 0, 0 }, { 0, 3, -4 }, { 4, 0, 3 }, { 0, 0, 5 }
  };
  uint64_t s = 3;
  double p[5][3];

  (void)unused;
  for (int n = 0; n < 4000; n++) {
    double scale = 1 + (double)(next(&s) % 1000), shift[3];

    for (int k = 0; k < 3; k++) shift[k] = whole(&s, 52);
    for (int i = 0; i < 5; i++)
      for (int k = 0; k < 3; k++) {
        p[i][k] = shift[k] + scale * unit[i][k];
        if (n % 3) p[i][k] += (double)(int)(next(&s) % 3) - 1;
      }
    check_insphere(p);
    check_orient3d(p);
    check_plane(p);
  }
}

/* Rows of whole numbers with determinant 1 and the largest entries that a
 * double holds: 1 is far below the resolution even of two doubles. */
static void sees_one_unit_of_volume(void **unused)
{
  uint64_t s = 5;

  (void)unused;
  for (int n = 0; n < 2000; n++) {
    int64_t m[3][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
    double p[4][3] = { { 0 } };

    for (;;) { /* add a multiple of one row to another while it fits */
      int i = (int)(next(&s) % 3), j = (i + 1 + (int)(next(&s) % 2)) % 3;
      int64_t by = (int64_t)(next(&s) % 15) - 7, most = 0, row[3];

      for (int k = 0; k < 3; k++) {
        row[k] = m[i][k] + by * m[j][k];
        if (llabs(row[k]) > most) most = llabs(row[k]);
      }
      if (most >= (int64_t)1 << 52) break;
      memcpy(m[i], row, sizeof row);
    }
    for (int i = 0; i < 3; i++)
      for (int k = 0; k < 3; k++) p[i + 1][k] = (double)m[i][k];
    assert_int_equal(det_sign(4, 3, p, 0), -1);
    check_orient3d(p);
  }
}

static void sees_one_unit_of_area(void **unused)
{
  uint64_t s = 7;

  (void)unused;
  for (int n = 0; n < 2000; n++) { /* neighbours in a Farey series */
    double p[4][3] = { { 0 } };
    double *a = p[1 + n % 2], *b = p[2 - n % 2];

    a[0] = b[1] = 1;
    for (;;) {
      double by = (double)(1 + next(&s) % 9), *c = b;

      for (int k = 0; k < 2; k++) b[k] += by * a[k];
      if (b[0] + b[1] > 0x1p48) break;
      b = a;
      a = c;
    }
    p[3][0] = p[1][0] + p[2][0]; /* incircle: fourth of a parallelogram */
    p[3][1] = p[1][1] + p[2][1];
    check_plane(p);
    assert_int_equal(fabs(vg_orient2d(p[0], p[1], p[2])), 1);
  }
}

/* Points on a sphere with squared radius R of 107 bits about 0, and one with R
 * - 1: u^2 + v^2 = x^2 + y^2 - 1 for x = u + 1 and 2 u = v^2 - y^2. */
static void sees_one_unit_of_squared_radius(void **unused)
{
  uint64_t s = 6;
  double p[5][3];
  int side[3] = { 0, 0, 0 };

  (void)unused;
  for (int n = 0; n < 4000; n++) {
    double v = (double)(134000000 + next(&s) % 200000);
    double y = v - 2 * (double)(1 + next(&s) % 30000000);
    double u = (v - y) / 2 * (v + y), e[3] = { u, v, 0 };
    double x[3] = { u + 1, y, n & 1 ? whole(&s, 53) : 0 };
    int want;

    e[2] = x[2];
    for (int i = 0; i < 5; i++) {
      uint64_t r = next(&s) >> 8;
      const double *from = i == n / 2 % 5 ? e : x;
      int turn = n & 1 ? (int)(r % 3) : 0; /* even: all in the plane z = 0 */

      for (int k = 0; k < 3; k++)
        p[i][k] = r >> (8 + k) & 1 ? -from[(k + turn) % 3]
                                   : from[(k + turn) % 3];
    }
    check_insphere(p);
    check_plane(p);
    want = sign(vg_insphere(p[0], p[1], p[2], p[3], p[4]));
    side[1 + want]++;
  }
  assert_true(side[0] > 500 && side[2] > 500);
}

static int parity(const int *perm, int n)
{
  int odd = 0;

  for (int i = 0; i < n; i++)
    for (int j = i + 1; j < n; j++) odd ^= perm[i] > perm[j];
  return odd ? -1 : 1;
}

/* Exchanging two arguments changes the sign, also for values that are not whole
 * numbers and where the first filter fails. */
static void is_antisymmetric(void **unused)
{
  uint64_t s = 4;

  (void)unused;
  for (int n = 0; n < 300; n++) {
    double p[5][3];
    int want4, want5;

    for (int i = 0; i < 4; i++)
      for (int k = 0; k < 3; k++) p[i][k] = whole(&s, 52) * 0x1p-52;
    for (int k = 0; k < 3; k++) {
      if (n & 1) p[3][k] = .3 * p[0][k] + .3 * p[1][k] + .4 * p[2][k];
      p[4][k] = n & 2 ? p[1][k] : p[0][k];
    }
    p[4][n % 3] += 1e-17;
    want4 = sign(vg_orient3d(p[0], p[1], p[2], p[3]));
    want5 = sign(vg_insphere(p[0], p[1], p[2], p[3], p[4]));
    for (int code = 0; code < 625; code++) {
      int q[5] = { code % 5, code / 5 % 5, code / 25 % 5, code / 125, 0 };

      q[4] = 10 - q[0] - q[1] - q[2] - q[3];
      if (q[4] < 0 ||
          (1 << q[0] | 1 << q[1] | 1 << q[2] | 1 << q[3] | 1 << q[4]) != 31)
        continue;
      assert_int_equal(sign(vg_insphere(p[q[0]], p[q[1]], p[q[2]], p[q[3]],
                                        p[q[4]])),
                       want5 * parity(q, 5));
      if (q[4] == 4)
        assert_int_equal(sign(vg_orient3d(p[q[0]], p[q[1]], p[q[2]], p[q[3]])),
                         want4 * parity(q, 4));
    }
  }
}

/* A long thin set far below the inline bound, at the ends of the range for
 * which the header promises exact signs. */
static void is_exact_at_the_ends_of_the_range(void **unused)
{
  const double scale[3] = { 0x1p-140, 1, 0x1p190 };

  (void)unused;
  for (int n = 0; n < 3; n++) {
    double h = scale[n];
    double a[3] = { h, h, h }, b[3] = { 3 * h, h, h }, c[3] = { h, 5 * h, h };
    double d[3] = { 2 * h, 2 * h, h }, e[3] = { 3 * h, 5 * h, h };

    assert_true(vg_orient3d(a, b, c, d) == 0);
    assert_true(vg_insphere(a, b, c, d, e) == 0);
    assert_true(vg_incircle(a, b, c, e) == 0);
    d[2] = nextafter(h, 2 * h);
    assert_true(vg_orient3d(a, b, c, d) > 0);
    assert_true(vg_insphere(a, b, c, d, e) == 0);
    e[0] = nextafter(e[0], 0);
    assert_true(vg_insphere(a, b, c, d, e) != 0);
    assert_true(vg_incircle(a, b, c, e) > 0);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(knows_the_reference_cases),
    cmocka_unit_test(is_exact_on_a_grid),
    cmocka_unit_test(is_exact_near_a_plane),
    cmocka_unit_test(is_exact_near_a_sphere),
    cmocka_unit_test(is_exact_after_translation),
    cmocka_unit_test(sees_one_unit_of_volume),
    cmocka_unit_test(sees_one_unit_of_area),
    cmocka_unit_test(sees_one_unit_of_squared_radius),
    cmocka_unit_test(is_antisymmetric),
    cmocka_unit_test(is_exact_at_the_ends_of_the_range),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
