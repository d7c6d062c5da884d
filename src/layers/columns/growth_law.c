/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "layers/columns/growth_law.h"

#include <assert.h>
#include <math.h>

/* Upper bound of the growth rate, above any rate in use. */
#define RATE_MAX 1e6

static double power(double x, int n)
{
  double y = 1;

  for (; n > 0; n >>= 1, x *= x)
    if (n & 1) y *= x;
  return y;
}

/* Thickness of layer j by the growth law without the cap. */
static double bare(const struct vg_growth_law *law, int j)
{
  int k = law->n_constant > 1 ? j - (int)law->n_constant : j - 1;

  if (k <= 0) return law->delta1;
  return law->delta1 *
         power(1 + law->rate1 * (law->rate2 > 0 ? power(1 + law->rate2, k) : 1),
               k);
}

/* As bare(), from the thickness of layer j - 1: one product for a geometric
 * law. */
static double bare_next(const struct vg_growth_law *law, int j, double before)
{
  if (j <= 1 || j <= law->n_constant) return law->delta1;
  return law->rate2 > 0 ? bare(law, j) : before * (1 + law->rate1);
}

/* Thickness of layer j under the cap, from that of layer j - 1. */
static double next(double bare, double cap, int j, double before)
{
  return j > 1 && bare > cap * before ? cap * before : bare;
}

void vg_growth_law_heights(const struct vg_growth_law *law, double cap, int n,
                           double *d)
{
  double t = 0, b = 0;

  assert(n >= 0 && d);
  assert(law->delta1 > 0 && law->rate1 >= 0 && law->rate2 >= 0);
  assert(law->n_constant >= 1 && cap >= 1);
  if (cap > law->cap) cap = law->cap;
  d[0] = 0;
  for (int j = 1; j <= n; j++) {
    b = bare_next(law, j, b);
    t = next(b, cap, j, t);
    d[j] = d[j - 1] + t;
    assert(d[j] >= d[j - 1]);
  }
}

/* Height of n layers whose thickness without the cap is b[1 .. n]. Adds in the
 * same order as vg_growth_law_heights, so both agree to the last bit. */
static double sum(const double *b, double cap, int n)
{
  double total = 0, t = 0;

  for (int j = 1; j <= n; j++) {
    t = next(b[j], cap, j, t);
    total += t;
  }
  return total;
}

double vg_growth_law_compress(const struct vg_growth_law *law, int n,
                              double height)
{
  assert(n >= 0 && law->delta1 > 0);

  double lo = 1, hi = law->cap, b[VG_LEVELS_MAX + 1];

  if (n > VG_LEVELS_MAX) n = VG_LEVELS_MAX;
  b[0] = 0;
  for (int j = 1; j <= n; j++) b[j] = bare_next(law, j, b[j - 1]);
  if (sum(b, hi, n) <= height) return hi;
  if (sum(b, lo, n) > height) return 0;
  /* A law without a cap still has a largest ratio among its n layers. */
  if (!isfinite(hi)) {
    hi = 2;
    while (sum(b, hi, n) <= height) hi *= 2;
  }
  for (int i = 0; i < 28; i++) { /* Accurate to 4e-9 of the cap. */
    double mid = 0.5 * (lo + hi);

    if (sum(b, mid, n) <= height) lo = mid;
    else hi = mid;
  }
  return lo;
}

/* x^(1/7), x > 0, by Newton's method. libm is avoided because its last bits
 * differ between machines. y starts above the root and decreases until it no
 * longer does. */
static double seventh_root(double x)
{
  double y, next;
  int e;

  frexp(x, &e);
  next = ldexp(1, e >= 0 ? e / 7 + 1 : e / 7); /* Above the root. */
  do {
    y = next;
    next = y - (y - x / power(y, 6)) / 7;
  } while (next < y);
  return y;
}

/* Friction velocity divided by the free-stream velocity. */
static double friction(double reynolds)
{
  return sqrt(0.5 * 0.026 / seventh_root(reynolds));
}

double vg_first_height(double y_plus, double reynolds, double length)
{
  return y_plus * length / (reynolds * friction(reynolds));
}

double vg_y_plus(double y, double reynolds, double length)
{
  return y * reynolds * friction(reynolds) / length;
}

double vg_y_plus_at(double y, double reynolds, double length, double c_f)
{
  assert(c_f >= 0);
  return y * reynolds * sqrt(0.5 * c_f) / length;
}

static double total_at(double delta1, int n_constant, int n, double rate)
{
  struct vg_growth_law law = { delta1, rate, 0, INFINITY, n_constant };
  double total = 0;

  for (int j = 1; j <= n; j++) total += bare(&law, j);
  return total;
}

double vg_growth_law_rate_for_total(double delta1, int n_constant, int n,
                                    double total)
{
  double lo = 0, hi = 1;

  assert(n_constant >= 1 && delta1 > 0);
  if (total_at(delta1, n_constant, n, 0) > total) return -1;
  while (total_at(delta1, n_constant, n, hi) < total) {
    if (hi > RATE_MAX) return INFINITY;
    hi *= 2;
  }
  for (int i = 0; i < 60; i++) {
    double mid = 0.5 * (lo + hi);

    if (total_at(delta1, n_constant, n, mid) < total) lo = mid;
    else hi = mid;
  }
  return 0.5 * (lo + hi);
}

/* --- grid families ------------------------------------------------------- */

double vg_real_power(double x, double e)
{
  assert(x > 0 && isfinite(e));

  double whole = floor(fabs(e)), part = fabs(e) - whole, y, root = x;

  if (whole > 1000)
    whole = 1000; /* Beyond any exponent that makes a
                     difference. */
  y = power(x, (int)whole);
  for (int i = 0; i < 53 && part > 0; i++) {
    root = sqrt(root);
    part *= 2;
    if (part < 1) continue;
    y *= root;
    part -= 1;
  }
  return e < 0 ? 1 / y : y;
}

double vg_growth_law_power(enum vg_growth_law_rule rule, double scale)
{
  assert(scale > 0);
  if (rule == VG_GROWTH_LAW_KEPT) return 1;
  return rule == VG_GROWTH_LAW_EVEN ? scale
                                    : vg_real_power(2. / 3, 2 / scale - 2);
}

static int64_t times(int64_t n, double factor)
{
  double m = floor((double)n * factor + 0.5);

  return m < 1 ? 1 : m > VG_LEVELS_MAX ? VG_LEVELS_MAX : (int64_t)m;
}

void vg_growth_law_scale(struct vg_growth_law *law,
                         enum vg_growth_law_rule rule, double scale, int *n)
{
  assert(scale > 0 && n);

  double e = vg_growth_law_power(rule, scale);

  if (rule == VG_GROWTH_LAW_KEPT) return;
  law->delta1 *= scale;
  law->rate1 = vg_real_power(1 + law->rate1, e) - 1;
  law->rate2 = vg_real_power(1 + law->rate2, e) - 1;
  if (isfinite(law->cap)) law->cap = vg_real_power(law->cap, e);
  if (law->n_constant > 1) law->n_constant = times(law->n_constant, 1 / scale);
  if (*n > 0) *n = (int)times(*n, 1 / e);
}
