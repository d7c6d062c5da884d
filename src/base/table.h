/* base/table.h: a hash table of numbers of items. Uses hash.h.
 *
 * The items and their keys stay in an array of the caller; a slot of the table
 * holds the number of an item. The caller gives the hash of a key and says
 * which item has that key, both in line:
 *
 *   uint32_t *at;
 *
 *   VG_TABLE_FIND(&t, at, vg_hash_1(key), item[*at].key == key);
 *   if (*at == VG_TABLE_FREE) *at = n++;
 *
 * Open addressing with linear probing, at most half full, from the upper bits
 * of the hash. Items are never removed. Nothing depends on the order of the
 * slots as long as keys differ. Threads: any number may search a table that
 * nobody changes. */
#ifndef VG_BASE_TABLE_H
#define VG_BASE_TABLE_H

#include <stddef.h>
#include <stdint.h>

/* The content of a slot without an item. */
#define VG_TABLE_FREE UINT32_MAX

struct vg_table {
  uint32_t *slot, *end;      /* the slots, a power of two of them; owned */
  unsigned shift;            /* upper bits of a hash, moved to the lower end */
};
#define VG_TABLE_INIT { NULL, NULL, 0 }

/** An empty table with room for n items in *t, which held nothing. 4 bytes for
 * each of 2 n slots, rounded up to a power of two.
 * Returns 0, or -1 when memory is refused or n is beyond 32 bits (*t is
 * then empty and without room). */
int vg_table_init(struct vg_table *t, size_t n);

/** Room for n items in all in a table that holds some, or was only zeroed.
 * The slots double, so that growing by one item costs O(1) on average.
 * @param hash  of an item by its number, as it was entered
 * @param of    passed to hash
 * Returns 0, or -1 as vg_table_init, *t unchanged. */
int vg_table_reserve(struct vg_table *t, size_t n,
                     uint64_t (*hash)(const void *of, uint32_t item),
                     const void *of);

/** Forget all items and keep the room. */
void vg_table_clear(struct vg_table *t);

void vg_table_release(struct vg_table *t);

static inline uint32_t *vg_table_home(const struct vg_table *t, uint64_t hash)
{
  return t->slot + (hash >> t->shift);
}

static inline uint32_t *vg_table_next(const struct vg_table *t, uint32_t *at)
{
  return at + 1 == t->end ? t->slot : at + 1;
}

/** Set at (uint32_t *) to the slot of the item for which is_it holds, else to
 * the free slot where an item of this hash belongs.
 * @param t      const struct vg_table *, with room
 * @param is_it  expression: is *at the number of the item that is looked for? */
#define VG_TABLE_FIND(t, at, hash, is_it)                              \
  for ((at) = vg_table_home((t), (hash));                              \
       *(at) != VG_TABLE_FREE && !(is_it); (at) = vg_table_next((t), (at))) {}

#endif
