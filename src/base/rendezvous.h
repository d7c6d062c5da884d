/* base/rendezvous.h: where equal items of all ranks meet. Uses comm.h
 * and hash.h.
 *
 * An item begins with its key, a few 32-bit words. Items of equal keys go to
 * the rank that a hash of the key names, and are looked at there together. */
#ifndef VG_BASE_RENDEZVOUS_H
#define VG_BASE_RENDEZVOUS_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "base/comm.h"
#include "base/hash.h"

/** A list of items; zeroed: none. */
struct vg_items {
  size_t n, room;
  unsigned char *data;
};

/** Room for one more item of this size at the end; NULL when refused. */
void *vg_items_add(struct vg_items *list, size_t size);

/** All of `more`, items of this size, behind those of *to. */
vg_status vg_items_append(struct vg_items *to, const struct vg_items *more,
                          size_t size, struct vg_error *err);

void vg_items_release(struct vg_items *list);

struct vg_rendezvous {
  struct vg_comm *comm;
  int threads;
  size_t size, key; /* bytes of an item, multiple of 4, and of its
                       key at its beginning */
  /** n items of one key, in any order. Called by several threads. */
  void (*group)(void *context, const unsigned char *item, size_t n, int worker);
  void *context;
  /** NULL, or whether n items of one key, all that this rank has, are all
   * there are. Such groups are looked at where they are and do not travel. */
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

/** Rank on which items of a key meet. */
int vg_rendezvous_rank(const struct vg_rendezvous *m, const void *key);

/** Collective. Takes the items of n_list lists, `stride` bytes apart, and
 * leaves these empty, also on failure.
 * Memory: the items once, on several ranks twice. VG_ERR_MEMORY on all
 * ranks. */
vg_status vg_rendezvous_run(const struct vg_rendezvous *m,
                            struct vg_items *list, size_t n_list, size_t stride,
                            struct vg_error *err);

#endif
