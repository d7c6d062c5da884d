/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/fill/sites.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/memory.h"

void vg_sites_release(struct vg_sites *s)
{
  vg_table_release(&s->table);
  free(s->block);
  memset(s, 0, sizeof *s);
}

static uint64_t hash(const int32_t at[3])
{
  return vg_hash_1(
    vg_hash_3((uint32_t)at[0], (uint32_t)at[1], (uint32_t)at[2]));
}

static uint64_t block_hash(const void *sites, uint32_t block)
{
  const struct vg_sites *s = sites;

  return hash(s->block[block].at);
}

static int is_block(const struct vg_site_block *b, const int32_t at[3], float h)
{
  return b->h == h && !memcmp(b->at, at, sizeof b->at);
}

struct vg_site_block *vg_sites_block(struct vg_sites *s, const int64_t i[3],
                                     float h)
{
  assert(h > 0);
  assert(llabs(i[0]) < INT64_C(1) << 33);
  assert(llabs(i[1]) < INT64_C(1) << 33);
  assert(llabs(i[2]) < INT64_C(1) << 33);

  const int32_t at[3] = { (int32_t)(i[0] >> 3), (int32_t)(i[1] >> 3),
                          (int32_t)(i[2] >> 3) };
  uint32_t *slot;

  if (vg_table_reserve(&s->table, s->n + 1, block_hash, s)) return NULL;
  VG_TABLE_FIND(&s->table, slot, hash(at), is_block(&s->block[*slot], at, h));
  if (*slot != VG_TABLE_FREE) return &s->block[*slot];
  if (vg_reserve(&s->block, &s->cap, s->n + 1, sizeof *s->block)) return NULL;
  *slot = (uint32_t)s->n;
  s->block[s->n] = (struct vg_site_block){ .h = h };
  memcpy(s->block[s->n].at, at, sizeof at);
  return &s->block[s->n++];
}
