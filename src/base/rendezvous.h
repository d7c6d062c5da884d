/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* base/rendezvous.h: brings equal items of all ranks together (a distributed
 * directory). Uses comm.h and hash.h.
 *
 * An item begins with its key, a few 32-bit words. Items with equal keys are
 * sent to the rank that a hash of the key selects, and are processed there as a
 * group. */
#ifndef VG_BASE_RENDEZVOUS_H
#define VG_BASE_RENDEZVOUS_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "base/comm.h"
#include "base/hash.h"

/** A list of items; empty if zeroed. */
struct vg_items {
  size_t n, room;
  unsigned char *data;
};

/** Append space for one item of this size; NULL if there is not enough
 * memory. */
void *vg_items_add(struct vg_items *list, size_t size);

/** Append all items of `more`, of this size, to *to. */
vg_status vg_items_append(struct vg_items *to, const struct vg_items *more,
                          size_t size, struct vg_error *err);

void vg_items_release(struct vg_items *list);

/** A list of items in blocks, each twice as large as the previous one, but not
 * above 8 MB: a long list grows without a copy and without much unused memory.
 * Empty if zeroed. */
struct vg_item_blocks {
  size_t n_block, room;
  struct vg_items *block; /* [n_block] */
};

/** As vg_items_add. */
void *vg_item_blocks_add(struct vg_item_blocks *list, size_t size);

/** Number of items. */
size_t vg_item_blocks_n(const struct vg_item_blocks *list);

void vg_item_blocks_release(struct vg_item_blocks *list);

struct vg_rendezvous {
  struct vg_comm *comm;
  int threads;
  size_t size, key; /* bytes of an item (a multiple of 4) and of the key at
                       its beginning */
  /** Process n items with the same key, in any order. Called by several
   * threads. */
  void (*group)(void *context, const unsigned char *item, size_t n, int worker);
  void *context;
  /** NULL, or a function that tells whether n items with the same key, all that
   * this rank has, are the complete group. Complete groups are processed
   * locally and are not sent. */
  int (*is_whole)(const void *context, const unsigned char *item, size_t n);
};

static inline uint64_t vg_rendezvous_hash(const void *key, size_t n)
{
  uint64_t h = n;

  for (size_t i = 0; i < n; i += sizeof(uint32_t)) {
    uint32_t word;

    memcpy(&word, (const unsigned char *)key + i, sizeof word);
    h = vg_hash_add(h, word);
  }
  return vg_hash_mix(h);
}

/** Rank that processes the items with this key. */
int vg_rendezvous_rank(const struct vg_rendezvous *m, const void *key);

/** Process the items of n_list lists, `stride` bytes apart, which are empty
 * afterwards, also on failure. Collective.
 * Memory: the items once, with several ranks twice. VG_ERR_MEMORY on all
 * ranks. */
vg_status vg_rendezvous_run(const struct vg_rendezvous *m,
                            struct vg_items *list, size_t n_list, size_t stride,
                            struct vg_error *err);

/** vg_rendezvous_run for lists in blocks. Lists keep their items if it fails
 * before the first message. */
vg_status vg_rendezvous_blocks(const struct vg_rendezvous *m,
                               struct vg_item_blocks *list, size_t n_list,
                               size_t stride, struct vg_error *err);

#endif
