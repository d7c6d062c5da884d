/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* base/heap.h: a binary heap in an array of the caller. Uses nothing.
 *
 * The order in which equal items leave depends on the order of all calls. Where
 * this matters, `before` must compare a unique number of the items last, so
 * that no two items are equal. Threads: one at a time. */
#ifndef VG_BASE_HEAP_H
#define VG_BASE_HEAP_H

#include <assert.h>
#include <stddef.h>

/** Define NAME_push and NAME_pop for a heap of items of a type:
 *
 *   static void NAME_push(TYPE *heap, size_t *n, TYPE item)
 *     Add an item; heap has room for *n + 1. O(log n).
 *   static TYPE NAME_pop(TYPE *heap, size_t *n)
 *     Remove the first item; *n > 0. O(log n).
 *
 * heap[0] is the item that leaves next.
 * @param before  int before(const TYPE *a, const TYPE *b): does a leave before
 *                b? A function or a macro, compiled inline. */
#define VG_HEAP_DEFINE(name, type, before)                                     \
  static inline void name##_push(type *heap, size_t *n, type item)             \
  {                                                                            \
    size_t at = (*n)++;                                                        \
                                                                               \
    while (at && before(&item, &heap[(at - 1) / 2])) {                         \
      heap[at] = heap[(at - 1) / 2];                                           \
      at = (at - 1) / 2;                                                       \
    }                                                                          \
    heap[at] = item;                                                           \
  }                                                                            \
                                                                               \
  static inline type name##_pop(type *heap, size_t *n)                         \
  {                                                                            \
    size_t left, at = 0, child;                                                \
    type top, last;                                                            \
                                                                               \
    assert(*n > 0);                                                            \
    left = --*n;                                                               \
    top = heap[0];                                                             \
    last = heap[left];                                                         \
    while ((child = 2 * at + 1) < left) {                                      \
      if (child + 1 < left && before(&heap[child + 1], &heap[child])) child++; \
      if (before(&last, &heap[child])) break;                                  \
      heap[at] = heap[child];                                                  \
      at = child;                                                              \
    }                                                                          \
    heap[at] = last;                                                           \
    return top;                                                                \
  }

#endif
