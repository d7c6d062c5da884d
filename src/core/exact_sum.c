#include "core/exact_sum.h"

#include <math.h>

/* Carries all limbs into [0, 2^32); returns what is left above the last,
 * negative for a negative sum. */
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

  if (s->n_odd) return NAN;
  negative = carry(s, 0, limb) < 0;
  if (negative) carry(s, 1, limb);
  while (i > 2 && !limb[i]) i--;
  low = i - 2;
  for (int k = i; k >= low; k--) top = top << 32 | limb[k];
  /* What is below only says on which side of a tie the sum is. */
  for (int k = 0; k < low; k++) if (limb[k]) top |= 1;
  return ldexp(negative ? -(double)top : (double)top, 32 * low - 1074);
}
