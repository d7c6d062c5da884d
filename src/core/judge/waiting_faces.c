/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/judge/waiting_faces.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

#define FIRST_BITS 10

static int make_buckets(struct vg_waiting *w, unsigned bits)
{
  size_t n = (size_t)1 << bits;
  struct vg_face_bucket *bucket = vg_alloc(n, sizeof *bucket);
  uint8_t *is_over = vg_calloc(n, 1);

  if (!bucket || !is_over) {
    free(bucket);
    free(is_over);
    return 0;
  }
  memset(bucket, 0xff, n * sizeof *bucket);
  w->bucket = bucket;
  w->is_over = is_over;
  w->mask = n - 1;
  w->shift = 64 - bits;
  return 1;
}

static void wait_at(struct vg_waiting *w, size_t i, const struct vg_face *f)
{
  unsigned vacant;

  while (!(vacant = vg_face_slots(&w->bucket[i], VG_NOBODY))) {
    w->is_over[i] = 1;
    i = (i + 1) & w->mask;
  }
  vacant = (unsigned)__builtin_ctz(vacant);
  w->bucket[i].key[vacant] = f->key;
  w->bucket[i].high[vacant] = f->high;
  w->bucket[i].owner[vacant] = f->owner;
}

/* Double the number of buckets, so that at most half of the slots are used.
 * Without memory for them, the table stays as it is: there is room for the few
 * faces that are added before the caller stops. */
static void grow(struct vg_waiting *w)
{
  struct vg_face_bucket *old = w->bucket;
  uint8_t *over = w->is_over;
  size_t n = w->mask + 1;

  if (!make_buckets(w, 65 - w->shift)) {
    w->refused = 1;
    return;
  }
  for (size_t i = 0; i < n; i++)
    for (unsigned k = 0; k < VG_FACE_SLOTS; k++) {
      struct vg_face f = { old[i].key[k], old[i].high[k], old[i].owner[k] };

      if (f.high != VG_NOBODY) wait_at(w, vg_waiting_home(w, &f), &f);
    }
  free(old);
  free(over);
}

void vg_waiting_init(struct vg_waiting *w)
{
  memset(w, 0, sizeof *w);
  if (!make_buckets(w, FIRST_BITS)) w->refused = 1;
}

void vg_waiting_release(struct vg_waiting *w)
{
  free(w->bucket);
  free(w->is_over);
  memset(w, 0, sizeof *w);
}

void vg_waiting_put(struct vg_waiting *w, const struct vg_face *f)
{
  wait_at(w, vg_waiting_home(w, f), f);
  if (++w->n > w->mask * (VG_FACE_SLOTS / 2)) grow(w);
}
