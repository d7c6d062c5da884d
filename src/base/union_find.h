/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* base/union_find.h: union-find of disjoint sets. up: [n] parent of each
 * number, which belongs to the same set; initially every number is its own
 * parent. A number that is its own parent is the root of its set. Threads: one
 * at a time. */
#ifndef VG_BASE_UNION_FIND_H
#define VG_BASE_UNION_FIND_H

#include <assert.h>
#include <stdint.h>

/** The root of k's set. */
static inline uint32_t vg_root_of(uint32_t *up, uint32_t k)
{
  assert(up);
  while (up[k] != k) k = up[k] = up[up[k]];
  return k;
}

/** Unite the sets of a and b under the lower root, so that the result does not
 * depend on the order of calls. Returns 0 if they were already one set. */
static inline int vg_union(uint32_t *up, uint32_t a, uint32_t b)
{
  a = vg_root_of(up, a);
  b = vg_root_of(up, b);
  if (a < b) up[b] = a;
  else up[a] = b;
  return a != b;
}

#endif
