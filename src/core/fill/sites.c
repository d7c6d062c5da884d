#include "core/fill/sites.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

void vg_sites_release(struct vg_sites *s)
{
  free(s->slot);
  memset(s, 0, sizeof *s);
}

static struct vg_site_block *find(const struct vg_sites *s,
                                  const int32_t at[3], float h)
{
  uint64_t mix = (uint32_t)at[0] * 0x9e3779b97f4a7c15u +
                 (uint32_t)at[1] * 0xc2b2ae3d27d4eb4fu +
                 (uint32_t)at[2] * 0x165667b19e3779f9u;
  size_t k = (mix ^ mix >> 29) * 0xbf58476d1ce4e5b9u >> 32 & (s->size - 1);

  for (;; k = (k + 1) & (s->size - 1)) {
    struct vg_site_block *b = &s->slot[k];

    if (!(b->h > 0) || (b->h == h && !memcmp(b->at, at, sizeof b->at)))
      return b;
  }
}

static int grow(struct vg_sites *s)
{
  struct vg_sites old = *s;

  s->size = old.size ? 2 * old.size : 64;
  s->slot = vg_calloc(s->size, sizeof *s->slot);
  if (!s->slot) {
    *s = old;
    return -1;
  }
  for (size_t k = 0; k < old.size; k++)
    if (old.slot[k].h > 0)
      *find(s, old.slot[k].at, old.slot[k].h) = old.slot[k];
  free(old.slot);
  return 0;
}

struct vg_site_block *vg_sites_block(struct vg_sites *s, const int64_t i[3],
                                     float h)
{
  int32_t at[3] = { (int32_t)(i[0] >> 3), (int32_t)(i[1] >> 3),
                    (int32_t)(i[2] >> 3) };
  struct vg_site_block *b;

  if (2 * s->n >= s->size && grow(s)) return NULL;
  b = find(s, at, h);
  if (b->h > 0) return b;
  memcpy(b->at, at, sizeof b->at);
  b->h = h;
  s->n++;
  return b;
}
