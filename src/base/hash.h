/* base/hash.h: numbers scattered evenly over 64 bits. Uses nothing.
 *
 * Tables use the upper bits of these values only. Where points of a mesh
 * stand follows from some of the values too, so none of them may change. */
#ifndef VG_BASE_HASH_H
#define VG_BASE_HASH_H

#include <stdint.h>
#include <string.h>

/* 2^64 and 2^32 over the golden ratio, and two more odd multipliers without a
 * pattern in their bits. */
#define VG_GOLDEN UINT64_C(0x9E3779B97F4A7C15)
#define VG_GOLDEN_32 UINT32_C(0x9E3779B1)
#define VG_HASH_2 UINT64_C(0xC2B2AE3D27D4EB4F)
#define VG_HASH_3 UINT64_C(0x165667B19E3779F9)

/** Each bit of the result depends on each bit of x. */
static inline uint64_t vg_hash_mix(uint64_t x)
{
  x ^= x >> 32;
  x *= UINT64_C(0xD6E8FEB86659FD93);
  return x ^ x >> 32;
}

/** One number; its upper bits depend on all bits of x. One multiplication. */
static inline uint64_t vg_hash_1(uint64_t x)
{
  return (x ^ x >> 32) * VG_GOLDEN;
}

/** Three numbers in order, as vg_hash_1: of less than 32 bits each. */
static inline uint64_t vg_hash_3(uint64_t a, uint64_t b, uint64_t c)
{
  return a * VG_GOLDEN + b * VG_HASH_2 + c * VG_HASH_3;
}

/** The hash of a sequence whose hash was h, with one more word at its end; 0
 * is the hash of the empty sequence. */
static inline uint64_t vg_hash_add(uint64_t h, uint64_t word)
{
  h = (h ^ word) * VG_GOLDEN;
  return h ^ h >> 32;
}

/** A place; -0 and 0 have the same hash. */
static inline uint64_t vg_hash_point(const double x[3])
{
  uint64_t h = 0;

  for (int k = 0; k < 3; k++) {
    double v = x[k] + 0.0;
    uint64_t bits;

    memcpy(&bits, &v, sizeof bits);
    h = vg_hash_add(h, bits);
  }
  return h;
}

#endif
