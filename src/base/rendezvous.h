/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* base/rendezvous.h: brings equal items of all ranks together (a distributed
 * directory). Uses comm.h and hash.h.
 *
 * An item begins with its key, a few 32-bit words. Items with equal keys are
 * sent to the rank that a hash of the key selects, and are processed there as a
 * group. */
#ifndef VG_BASE_RENDEZVOUS_H
#define VG_BASE_RENDEZVOUS_H

#include <pthread.h>
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

/** Append the blocks of `more`, which is empty afterwards, to *to. */
vg_status vg_item_blocks_join(struct vg_item_blocks *to,
                              struct vg_item_blocks *more,
                              struct vg_error *err);

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

/** Process those groups of one list that are complete (m->is_whole) in the
 * calling thread, which m->group knows as `worker`, before vg_rendezvous_blocks
 * processes the other ones. They leave the list. On failure it is empty. */
vg_status vg_rendezvous_thin(const struct vg_rendezvous *m, int worker,
                             struct vg_item_blocks *list, struct vg_error *err);

/** vg_rendezvous_run for lists in blocks. Lists keep their items if it fails
 * before the first message. */
vg_status vg_rendezvous_blocks(const struct vg_rendezvous *m,
                               struct vg_item_blocks *list, size_t n_list,
                               size_t stride, struct vg_error *err);

/** Items of all threads of a rank that wait for others with the same key.
 * Threads hand over their lists; from time to time one of them takes all items,
 * removes the complete groups with vg_rendezvous_thin, and returns the others.
 */
struct vg_waiting_items {
  pthread_mutex_t lock;        /* Guards the other members. */
  struct vg_item_blocks items; /* Those that wait. */
  size_t most;                 /* Largest number of them so far. */
  size_t limit;                /* Number from which a thread takes them. */
  int is_taken;                /* 1: a thread has taken items. */
};

/** @param limit  number of items below which they are never taken */
void vg_waiting_items_init(struct vg_waiting_items *w, size_t limit);
void vg_waiting_items_release(struct vg_waiting_items *w);

/** Hand a list over, which is empty afterwards. If it is time, *taken has all
 * waiting items, for vg_waiting_items_return; otherwise it is empty. On failure
 * the list is unchanged. Threads: safe. */
vg_status vg_waiting_items_add(struct vg_waiting_items *w,
                               struct vg_item_blocks *list,
                               struct vg_item_blocks *taken,
                               struct vg_error *err);

/** Return the items that still wait; *list is empty afterwards, also on
 * failure. They are taken again when their number has doubled, so that the cost
 * of all is proportional to the number of items. Threads: safe. */
vg_status vg_waiting_items_return(struct vg_waiting_items *w,
                                  struct vg_item_blocks *list,
                                  struct vg_error *err);

#endif
