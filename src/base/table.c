/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "base/table.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

enum { BITS_LEAST = 4, BITS_MOST = 33 };

static size_t n_slot(const struct vg_table *t)
{
  return (size_t)(t->end - t->slot);
}

int vg_table_init(struct vg_table *t, size_t n)
{
  unsigned bits = BITS_LEAST;

  *t = (struct vg_table)VG_TABLE_INIT;
  while (bits < BITS_MOST && (size_t)1 << bits < 2 * n) bits++;
  if (n > UINT32_MAX) return -1;
  t->slot = vg_alloc((size_t)1 << bits, sizeof *t->slot);
  if (!t->slot) return -1;
  t->end = t->slot + ((size_t)1 << bits);
  t->shift = 64 - bits;
  vg_table_clear(t);
  return 0;
}

int vg_table_reserve(struct vg_table *t, size_t n,
                     uint64_t (*hash)(const void *of, uint32_t item),
                     const void *of)
{
  struct vg_table more;

  if (n <= n_slot(t) / 2) return 0;
  if (vg_table_init(&more, n > n_slot(t) ? n : n_slot(t))) return -1;
  for (const uint32_t *from = t->slot; from != t->end; from++) {
    uint32_t *at;

    if (*from == VG_TABLE_FREE) continue;
    VG_TABLE_FIND(&more, at, hash(of, *from), 0);
    *at = *from;
  }
  free(t->slot);
  *t = more;
  return 0;
}

void vg_table_clear(struct vg_table *t)
{
  if (t->slot) memset(t->slot, 0xff, n_slot(t) * sizeof *t->slot);
}

void vg_table_release(struct vg_table *t)
{
  free(t->slot);
  *t = (struct vg_table)VG_TABLE_INIT;
}
