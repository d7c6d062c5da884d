/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* base/tri_key.h: vertices of edges, triangles and quadrilaterals in ascending
 * order, used as keys to match the two sides of a face. Uses hash.h. */
#ifndef VG_BASE_TRI_KEY_H
#define VG_BASE_TRI_KEY_H

#include <stdint.h>

#include "base/hash.h"

/** Sort two numbers; returns 1 if they were exchanged, else 0. */
static inline uint32_t vg_order2(uint32_t *a, uint32_t *b)
{
  uint32_t low = *a < *b ? *a : *b, high = *a < *b ? *b : *a;
  uint32_t exchanged = *a > *b;

  *a = low;
  *b = high;
  return exchanged;
}

/** Sort three numbers; returns 1 after an odd number of exchanges. */
static inline uint32_t vg_order3(uint32_t v[3])
{
  uint32_t odd = vg_order2(&v[0], &v[1]);

  odd ^= vg_order2(&v[1], &v[2]);
  return odd ^ vg_order2(&v[0], &v[1]);
}

/** Sort four numbers; returns 1 after an odd number of exchanges. */
static inline uint32_t vg_order4(uint32_t v[4])
{
  uint32_t odd = vg_order2(&v[0], &v[1]) ^ vg_order2(&v[2], &v[3]);

  odd ^= vg_order2(&v[0], &v[2]) ^ vg_order2(&v[1], &v[3]);
  return odd ^ vg_order2(&v[1], &v[2]);
}

/** The three lowest corners of a quadrilateral in its cyclic order, so that
 * they turn like it: a triangle that stands for it in a key. */
static inline void vg_quad_low_corners(const uint32_t quad[4], uint32_t v[3])
{
  int high = 0, n = 0;

  for (int k = 1; k < 4; k++)
    if (quad[k] > quad[high]) high = k;
  for (int k = 0; k < 4; k++)
    if (k != high) v[n++] = quad[k];
}

/** Key of the edge between two points, the same in both directions. */
static inline uint64_t vg_edge_key(uint32_t a, uint32_t b)
{
  return a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
}

/** Ascending order of keys of edges, for qsort and bsearch. */
static inline int vg_compare_edge_keys(const void *a, const void *b)
{
  const uint64_t p = *(const uint64_t *)a, q = *(const uint64_t *)b;

  return (p > q) - (p < q);
}

/* Key of a triangle, independent of the order of its vertices. */
struct vg_tri_key {
  uint64_t low;  /* Lowest vertex << 32 | middle vertex. */
  uint32_t high; /* Highest vertex. */
};

static inline struct vg_tri_key vg_tri_key(const uint32_t corner[3])
{
  uint32_t v[3] = { corner[0], corner[1], corner[2] };

  vg_order3(v);
  return (struct vg_tri_key){ (uint64_t)v[0] << 32 | v[1], v[2] };
}

static inline int vg_tri_key_same(struct vg_tri_key a, struct vg_tri_key b)
{
  return a.low == b.low && a.high == b.high;
}

static inline uint64_t vg_tri_key_hash(struct vg_tri_key k)
{
  return k.low * VG_GOLDEN + k.high * VG_HASH_2;
}

#endif
