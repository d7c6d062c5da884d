/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/geometry/exact_sum.h"

#include <assert.h>
#include <math.h>

#include "base/wide.h"

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

/* --- sums of parts -------------------------------------------------------- */

/* Each summand is split into multiples of decreasing units, so few that MOST
 * numbers of them can be added in 64 bits: at most 2^31 of the first unit, and
 * 2^30 of the others. They make up the whole summand if it is at least 2^-40
 * times the largest one; otherwise there is a rest. The loops are vectorised.
 */
#define N_PART 3
#define PART_BITS 31

/* Exponents of the largest summand for which all units are ordinary numbers. */
#define EXPONENT_MIN 64
#define EXPONENT_MAX 2000

struct parts {
  double magic[N_PART];  /* Adding it rounds to the unit. */
  uint64_t bits[N_PART]; /* Sums of the bits of the numbers so rounded. */
  uint64_t has_rest;     /* Not 0: there are rests. */
  double rest[MOST];
};

/* Bits of the largest absolute value. */
VG_WITHIN int64_t largest(size_t n, const double *x)
{
  int64_t most = 0;

  for (size_t i = 0; i < n; i++) {
    int64_t bits;

    memcpy(&bits, x + i, sizeof bits);
    bits &= INT64_MAX;
    most = bits > most ? bits : most;
  }
  return most;
}

/* Round x to a multiple of the unit of `magic`; returns the rest. */
VG_WITHIN double split(double x, double magic, uint64_t *sum)
{
  double y = x + magic;
  uint64_t bits;

  memcpy(&bits, &y, sizeof bits);
  *sum += bits;
  return x - (y - magic);
}

VG_WITHIN void split_all(struct parts *p, size_t n, const double *x)
{
  uint64_t a = 0, b = 0, c = 0, any = 0, bits;

  for (size_t i = 0; i < n; i++) {
    double rest = split(x[i], p->magic[0], &a);

    rest = split(rest, p->magic[1], &b);
    rest = split(rest, p->magic[2], &c);
    p->rest[i] = rest;
    memcpy(&bits, &rest, sizeof bits);
    any |= bits << 1;
  }
  p->bits[0] = a;
  p->bits[1] = b;
  p->bits[2] = c;
  p->has_rest = any;
}

#ifdef VG_WIDE
static VG_WIDE int64_t largest_wide(size_t n, const double *x)
{
  return largest(n, x);
}
static VG_WIDE void split_wide(struct parts *p, size_t n, const double *x)
{
  split_all(p, n, x);
}
#endif

static int64_t find_largest(size_t n, const double *x)
{
#ifdef VG_WIDE
  if (VG_IS_WIDE) return largest_wide(n, x);
#endif
  return largest(n, x);
}

static void find_parts(struct parts *p, size_t n, const double *x)
{
#ifdef VG_WIDE
  if (VG_IS_WIDE) {
    split_wide(p, n, x);
    return;
  }
#endif
  split_all(p, n, x);
}

/* Add n <= MOST numbers by their parts; 0: it is not possible, and nothing was
 * added. A number of 1.5 * 2^52 units has the unit as its last bit, so that its
 * bits count units, also after the addition of a summand. */
static int add_parts(struct vg_exact *s, size_t n, const double *x)
{
  unsigned e = (unsigned)(find_largest(n, x) >> 52);
  uint64_t magic[N_PART];
  struct parts p;

  if (e < EXPONENT_MIN || e > EXPONENT_MAX) return 0;
  e += 53 - PART_BITS;
  for (unsigned k = 0; k < N_PART; k++)
    magic[k] = (uint64_t)(e - PART_BITS * k) << 52 | UINT64_C(1) << 51;
  memcpy(p.magic, magic, sizeof magic);
  find_parts(&p, n, x);
  for (unsigned k = 0; k < N_PART; k++)
    add_scaled(s, e - PART_BITS * k, (int64_t)(p.bits[k] - n * magic[k]));
  for (size_t i = 0; p.has_rest && i < n; i++)
    if (p.rest[i] != 0) vg_exact_add(s, p.rest[i]);
  return 1;
}

void vg_exact_add_all(struct vg_exact *s, size_t n, const double *x)
{
  assert(s && (x || !n));
  for (size_t i = 0; i < n; i += MOST) {
    size_t some = n - i < MOST ? n - i : MOST;

    if (!add_parts(s, some, x + i)) add_some(s, some, x + i);
  }
}

/* --- value ---------------------------------------------------------------- */

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
