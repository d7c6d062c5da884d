/* core/geometry/exact_sum.h: sums of doubles without rounding, so that they do
 * not depend on the order of what is added, nor on who adds it. Uses base only.
 *
 * A sum is a fixed-point number that spans all exponents, in limbs of 32 bits
 * which are each kept in 64: nothing is carried while adding (Kulisch's long
 * accumulator, with the carries put off). Two sums are added limb by limb,
 * modulo 2^64, also by what sums arrays of integers over ranks. */
#ifndef VG_CORE_GEOMETRY_EXACT_SUM_H
#define VG_CORE_GEOMETRY_EXACT_SUM_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* Limb i counts multiples of 2^(32 i - 1074), the finest double for i = 0.
 * The last ones take what is carried. */
#define VG_EXACT_LIMBS 67

/** Zeroed: the sum of nothing. For up to 2^30 summands. */
struct vg_exact {
  uint64_t limb[VG_EXACT_LIMBS]; /* two's complement */
  uint64_t n_odd;                /* summands that were not finite */
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

/** Add n of them: as vg_exact_add for each, in less time. */
void vg_exact_add_all(struct vg_exact *s, size_t n, const double *x);

/** The sum as the nearest double; NaN when a summand was not finite. */
double vg_exact_value(const struct vg_exact *s);

#endif
