/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/judge/waiting_faces.h: triangles that wait for an equal one. Private to
 * quality_pairs.c and quality_columns.c.
 *
 * Items cannot be removed from a table of base/table.h. For 2,076,831
 * tetrahedra of a wing, it would need 67 MB of slots for 4.2 million faces;
 * these buckets take 2.1 MB. */
#ifndef VG_CORE_JUDGE_WAITING_FACES_H
#define VG_CORE_JUDGE_WAITING_FACES_H

#include <stddef.h>
#include <stdint.h>

#if defined __SSE2__ && !defined VG_PORTABLE
#include <emmintrin.h>
#endif

#include "base/tri_key.h"

#define VG_NOBODY UINT32_MAX
#define VG_FACE_SLOTS 4

struct vg_face {
  uint64_t key;  /* Lowest node << 32 | second node. */
  uint32_t high; /* Highest node; VG_NOBODY in a vacant slot. */
  uint32_t owner;
};

/* Waiting faces that share a cache line. */
struct vg_face_bucket {
  uint64_t key[VG_FACE_SLOTS];
  uint32_t high[VG_FACE_SLOTS], owner[VG_FACE_SLOTS];
};

struct vg_waiting {
  size_t n, mask; /* Numbers of waiting faces, and of buckets - 1. */
  unsigned shift;
  struct vg_face_bucket *bucket;
  uint8_t *is_over; /* [buckets] 1: a face overflowed to the next bucket. */
  int refused;      /* 1: memory was refused. */
};

/** A table without faces; sets `refused` if there is not enough memory. */
void vg_waiting_init(struct vg_waiting *w);
void vg_waiting_release(struct vg_waiting *w);

/** Add a face that is not in the table. Sets `refused` if there is not enough
 * memory. */
void vg_waiting_put(struct vg_waiting *w, const struct vg_face *f);

static inline size_t vg_waiting_home(const struct vg_waiting *w,
                                     const struct vg_face *f)
{
  struct vg_tri_key k = { f->key, f->high };

  return (size_t)(vg_tri_key_hash(k) >> w->shift);
}

/** Bit k: slot k has this highest node. */
static inline unsigned vg_face_slots(const struct vg_face_bucket *b,
                                     uint32_t high)
{
#if defined __SSE2__ && !defined VG_PORTABLE
  __m128i all = _mm_load_si128((const __m128i *)(const void *)b->high);
  __m128i same = _mm_cmpeq_epi32(all, _mm_set1_epi32((int)high));

  return (unsigned)_mm_movemask_ps(_mm_castsi128_ps(same));
#else
  unsigned found = 0;

  for (unsigned k = 0; k < VG_FACE_SLOTS; k++)
    found |= (unsigned)(b->high[k] == high) << k;
  return found;
#endif
}

/** Remove the face equal to f from the table, and return its owner. If the
 * table has no such face, f is added to it, and VG_NOBODY is returned. */
static inline uint32_t vg_waiting_meet(struct vg_waiting *w,
                                       const struct vg_face *f)
{
  size_t i = vg_waiting_home(w, f);

  for (;; i = (i + 1) & w->mask) {
    struct vg_face_bucket *b = &w->bucket[i];

    for (unsigned s = vg_face_slots(b, f->high); s; s &= s - 1) {
      unsigned k = (unsigned)__builtin_ctz(s);

      if (b->key[k] != f->key) continue;
      b->high[k] = VG_NOBODY;
      w->n--;
      return b->owner[k];
    }
    if (w->is_over[i]) continue;
    vg_waiting_put(w, f);
    return VG_NOBODY;
  }
}

#endif
