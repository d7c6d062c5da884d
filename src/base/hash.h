/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* base/hash.h: hash functions of numbers and coordinates. Uses nothing.
 *
 * base/table.h uses the upper bits of a hash. Some hashes also affect the
 * positions of mesh points, so changing any of these functions changes
 * meshes. */
#ifndef VG_BASE_HASH_H
#define VG_BASE_HASH_H

#include <stdint.h>
#include <string.h>

/* 2^64 and 2^32 divided by the golden ratio, and two other odd multipliers
 * (primes 2 and 3 of XXH64). */
#define VG_GOLDEN UINT64_C(0x9E3779B97F4A7C15)
#define VG_GOLDEN_32 UINT32_C(0x9E3779B1)
#define VG_HASH_2 UINT64_C(0xC2B2AE3D27D4EB4F)
#define VG_HASH_3 UINT64_C(0x165667B19E3779F9)

/** Mix a number: each bit of the result depends on each bit of x. */
static inline uint64_t vg_hash_mix(uint64_t x)
{
  x ^= x >> 32;
  x *= UINT64_C(0xD6E8FEB86659FD93);
  return x ^ x >> 32;
}

/** Hash of one number. Its upper bits depend on all bits of x; costs one
 * multiplication. */
static inline uint64_t vg_hash_1(uint64_t x)
{
  return (x ^ x >> 32) * VG_GOLDEN;
}

/** Hash of an ordered triple of numbers, computed as a sum of products. Its
 * upper bits depend on all bits of numbers below 2^32. */
static inline uint64_t vg_hash_3(uint64_t a, uint64_t b, uint64_t c)
{
  return a * VG_GOLDEN + b * VG_HASH_2 + c * VG_HASH_3;
}

/** Hash of a sequence extended by one word. h: hash of the sequence without
 * that word; 0 for the empty sequence. */
static inline uint64_t vg_hash_add(uint64_t h, uint64_t word)
{
  h = (h ^ word) * VG_GOLDEN;
  return h ^ h >> 32;
}

/** Hash of a point. -0 and 0 have the same hash. */
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
