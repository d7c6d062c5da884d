/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/geometry/exact_sum.h"

#include <assert.h>
#include <math.h>

/* Number of summands whose mantissas can be added in 63 bits, per exponent. */
#define MOST 512
#define N_EXPONENT 0x800

static unsigned exponent(double x)
{
  uint64_t bits;

  memcpy(&bits, &x, sizeof bits);
  return (unsigned)(bits >> 52) & 0x7FF;
}

static int64_t mantissa(double x)
{
  uint64_t bits, m, minus;

  memcpy(&bits, &x, sizeof bits);
  m = bits & ((UINT64_C(1) << 52) - 1);
  if (bits << 1 >> 53) m |= UINT64_C(1) << 52;
  minus = 0 - (bits >> 63);
  return (int64_t)((m ^ minus) - minus);
}

/* Add m times the unit of a mantissa with exponent e. */
static void add_scaled(struct vg_exact *s, unsigned e, int64_t m)
{
  uint64_t minus = m < 0 ? UINT64_MAX : 0;
  unsigned at = e ? e - 1 : 0;
  unsigned __int128 v = (unsigned __int128)(((uint64_t)m ^ minus) - minus)
                     << (at & 31);

  for (unsigned k = 0; k < 3; k++, v >>= 32)
    s->limb[(at >> 5) + k] += (((uint64_t)v & UINT64_C(0xFFFFFFFF)) ^ minus) -
                              minus;
}

static void add_some(struct vg_exact *s, size_t n, const double *x)
{
  int64_t sum[N_EXPONENT];
  unsigned low = N_EXPONENT, high = 0;

  for (size_t i = 0; i < n; i++) {
    unsigned e = exponent(x[i]);

    low = e < low ? e : low;
    high = e > high ? e : high;
  }
  for (unsigned e = low; e <= high; e++) sum[e] = 0;
  for (size_t i = 0; i < n; i++) sum[exponent(x[i])] += mantissa(x[i]);
  if (high == N_EXPONENT - 1) {
    for (size_t i = 0; i < n; i++) s->n_odd += exponent(x[i]) == high;
    high--;
  }
  for (unsigned e = low; e <= high; e++)
    if (sum[e]) add_scaled(s, e, sum[e]);
}

void vg_exact_add_all(struct vg_exact *s, size_t n, const double *x)
{
  assert(s && (x || !n));
  for (size_t i = 0; i < n; i += MOST)
    add_some(s, n - i < MOST ? n - i : MOST, x + i);
}

/* Propagate the carries so that every limb is in [0, 2^32). Returns the carry
 * out of the last limb, which is negative for a negative sum. */
static int64_t carry(const struct vg_exact *s, int negate,
                     uint64_t out[VG_EXACT_LIMBS])
{
  int64_t over = 0;

  for (int i = 0; i < VG_EXACT_LIMBS; i++) {
    int64_t v = (int64_t)(negate ? 0 - s->limb[i] : s->limb[i]) + over;

    out[i] = (uint64_t)v & UINT64_C(0xFFFFFFFF);
    over = v >> 32;
  }
  return over;
}

double vg_exact_value(const struct vg_exact *s)
{
  uint64_t limb[VG_EXACT_LIMBS];
  unsigned __int128 top = 0;
  int negative, i = VG_EXACT_LIMBS - 1, low;

  assert(s);
  if (s->n_odd) return NAN;
  negative = carry(s, 0, limb) < 0;
  if (negative) carry(s, 1, limb);
  while (i > 2 && !limb[i]) i--;
  low = i - 2;
  for (int k = i; k >= low; k--) top = top << 32 | limb[k];
  /* The lower limbs only decide on which side of a tie the sum lies. */
  for (int k = 0; k < low; k++)
    if (limb[k]) top |= 1;
  return ldexp(negative ? -(double)top : (double)top, 32 * low - 1074);
}
