/* base/union_find.h: sets that become one (union-find). up: [n] at first each
 * number itself, later another one of its set; that which is its own is the
 * root. Threads: one at a time. */
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

/** Make the sets of a and b one, with the lower root, so that the outcome is
 * the same in any order. Returns 0 when they were one. */
static inline int vg_union(uint32_t *up, uint32_t a, uint32_t b)
{
  a = vg_root_of(up, a);
  b = vg_root_of(up, b);
  if (a < b) up[b] = a;
  else up[a] = b;
  return a != b;
}

#endif
