/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* base/table.h: a hash table that finds items by their keys. Uses nothing.
 *
 * Items and keys are in an array of the caller; a slot of the table holds the
 * number of an item. The caller computes the hash of a key (base/hash.h) and
 * compares keys. Both are compiled inline:
 *
 *   uint32_t *at;
 *
 *   VG_TABLE_FIND(&t, at, vg_hash_1(key), item[*at].key == key);
 *   if (*at == VG_TABLE_FREE) *at = n++;
 *
 * The table uses open addressing with linear probing. A search starts at the
 * slot given by the upper bits of the hash, and at most half of the slots are
 * used. Items cannot be removed. As long as keys differ, no result depends on
 * the order of the slots. Threads: any number of threads may search a table
 * that does not change. */
#ifndef VG_BASE_TABLE_H
#define VG_BASE_TABLE_H

#include <assert.h>
#include <stddef.h>
#include <stdint.h>

/* Content of an empty slot. */
#define VG_TABLE_FREE UINT32_MAX

struct vg_table {
  uint32_t *slot, *end; /* Slots; their number is a power of two; owned. */
  unsigned shift; /* 64 minus the binary logarithm of the number of slots. */
};
#define VG_TABLE_INIT                                                          \
  {                                                                            \
    NULL, NULL, 0                                                              \
  }

/** Make an empty table with room for n items; the old content of *t is not
 * released. Memory: 2 n slots of 4 bytes, rounded up to a power of 2. Returns
 * 0, or -1 if there is not enough memory or n is 2^32 or more; *t is then
 * VG_TABLE_INIT. */
int vg_table_init(struct vg_table *t, size_t n);

/** Make room for n items in total. *t may hold items, or be VG_TABLE_INIT. The
 * number of slots doubles, so that room for one more item costs O(1) on
 * average.
 * @param hash  hash of the key of an item, the same as when it was entered
 * @param of    passed to hash
 * Returns 0, or -1 as vg_table_init; *t is then unchanged. */
int vg_table_reserve(struct vg_table *t, size_t n,
                     uint64_t (*hash)(const void *of, uint32_t item),
                     const void *of);

/** Remove all items and keep the room. */
void vg_table_clear(struct vg_table *t);

void vg_table_release(struct vg_table *t);

static inline uint32_t *vg_table_home(const struct vg_table *t, uint64_t hash)
{
  assert(t->slot);
  return t->slot + (hash >> t->shift);
}

static inline uint32_t *vg_table_next(const struct vg_table *t, uint32_t *at)
{
  return at + 1 == t->end ? t->slot : at + 1;
}

/** Set at (uint32_t *) to the slot of the item for which is_it is true, or else
 * to the empty slot where an item with this hash belongs.
 * @param t      const struct vg_table *, with room
 * @param is_it  expression: does the item of number *at have the wanted key? */
#define VG_TABLE_FIND(t, at, hash, is_it)                                      \
  for ((at) = vg_table_home((t), (hash)); *(at) != VG_TABLE_FREE && !(is_it);  \
       (at) = vg_table_next((t), (at))) {                                      \
  }

#endif
