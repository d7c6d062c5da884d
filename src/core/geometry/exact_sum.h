/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/geometry/exact_sum.h: sums of doubles without rounding errors. The
 * result depends neither on the order of the summands nor on the thread or
 * rank that adds them. Uses base only.
 *
 * A sum is a fixed-point number that spans all exponents. Each limb of 32 bits
 * is stored in 64 bits, so that no carry is needed during the additions
 * (Kulisch's long accumulator with deferred carries). Two sums are added limb
 * by limb, modulo 2^64; functions that sum integer arrays over ranks can do
 * this. */
#ifndef VG_CORE_GEOMETRY_EXACT_SUM_H
#define VG_CORE_GEOMETRY_EXACT_SUM_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* Limb i counts multiples of 2^(32 i - 1074); for i = 0 this is the smallest
 * positive double. The last limbs hold the carries. */
#define VG_EXACT_LIMBS 67

/** A zeroed struct is the empty sum. Holds up to 2^30 summands. */
struct vg_exact {
  uint64_t limb[VG_EXACT_LIMBS]; /* limbs in two's complement */
  uint64_t n_odd;                /* number of summands that were infinite or
                                    NaN */
};

static inline void vg_exact_add(struct vg_exact *s, double x)
{
  const uint64_t low = UINT64_C(0xFFFFFFFF);
  uint64_t bits, m, minus, *limb;
  unsigned e, shift;

  memcpy(&bits, &x, sizeof bits);
  m = bits & ((UINT64_C(1) << 52) - 1);
  e = (unsigned)(bits >> 52) & 0x7FF;
  if (e == 0x7FF) {
    s->n_odd++;
    return;
  }
  if (e) m |= UINT64_C(1) << 52;
  else e = 1;
  minus = 0 - (bits >> 63);
  limb = s->limb + ((e - 1) >> 5);
  shift = (e - 1) & 31;
  limb[0] += ((m << shift & low) ^ minus) - minus;
  limb[1] += ((m << shift >> 32) ^ minus) - minus;
  limb[2] += (((m >> 1) >> (63 - shift)) ^ minus) - minus;
}

/** Add n numbers. Same result as vg_exact_add for each of them, but faster. */
void vg_exact_add_all(struct vg_exact *s, size_t n, const double *x);

/** The sum rounded to the nearest double; NaN if any summand was not finite. */
double vg_exact_value(const struct vg_exact *s);

#endif
