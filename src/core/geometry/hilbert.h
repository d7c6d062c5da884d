/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/geometry/hilbert.h: ordering of points that keeps neighbours together.
 */
#ifndef VG_CORE_GEOMETRY_HILBERT_H
#define VG_CORE_GEOMETRY_HILBERT_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

struct vg_key {
  uint64_t key;
  uint32_t index;
};

/** Spread the 21 bits of q so that two zero bits follow each of them. Three
 * such numbers make a Morton code, x | y << 1 | z << 2 (Morton, IBM Ltd.,
 * 1966). */
static inline uint64_t vg_interleave3(uint64_t q)
{
  q = (q | q << 32) & 0x001f00000000ffffu;
  q = (q | q << 16) & 0x001f0000ff0000ffu;
  q = (q | q << 8) & 0x100f00f00f00f00fu;
  q = (q | q << 4) & 0x10c30c30c30c30c3u;
  return (q | q << 2) & 0x1249249249249249u;
}

/** Spread the 32 bits of q so that one zero bit follows each of them. */
static inline uint64_t vg_interleave2(uint64_t q)
{
  q = (q | q << 16) & 0x0000ffff0000ffffu;
  q = (q | q << 8) & 0x00ff00ff00ff00ffu;
  q = (q | q << 4) & 0x0f0f0f0f0f0f0f0fu;
  q = (q | q << 2) & 0x3333333333333333u;
  return (q | q << 1) & 0x5555555555555555u;
}

/** Position of x along the Hilbert curve of the cube with lower corner lo and
 * 2^20 cells of length 1 / scale per side. Coordinates outside are clamped.
 * (Skilling, "Programming the Hilbert curve", AIP Conf. Proc. 707, 2004.) */
uint64_t vg_hilbert_key(const double x[3], const double lo[3], double scale);

/** Sort by key. Equal keys keep their order (stable radix sort, O(n)). */
vg_status vg_sort_keys(size_t n, struct vg_key *key, struct vg_error *err);

/** Order of the points along the Hilbert curve through their bounding cube.
 * order out: [n]. */
vg_status vg_hilbert_order(size_t n, const double (*x)[3], uint32_t *order,
                           struct vg_error *err);

/** Order that makes point insertion fast: rounds that grow by a factor of
 * eight, each along the Hilbert curve (Amenta, Choi, Rote, "Incremental
 * constructions con BRIO", 2003). order out: [n] a permutation of 0..n-1. */
vg_status vg_insertion_order(size_t n, const double (*x)[3], uint32_t *order,
                             struct vg_error *err);

#endif
