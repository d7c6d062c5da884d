/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "partition/engine/engine_memory.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

/* Bytes per chunk; smaller arrays than LARGE are left to realloc. */
enum { CHUNK = 1 << 18, LARGE = 1 << 20 }; /* E3 */

struct copy {
  char *to;
  const char *from;
};

static void copy_part(void *context, size_t first, size_t end, int worker)
{
  const struct copy *c = context;

  (void)worker;
  memcpy(c->to + first, c->from + first, end - first);
}

int vg_engine_reserve(const struct vg_engine *e, void *block, size_t *cap,
                      size_t n, size_t need, size_t size)
{
  size_t more = *cap + *cap / 2, new_cap = 0;
  char *old, *new = NULL;
  struct copy c;

  if (need <= *cap) return 0;
  if (n * size < LARGE) return vg_reserve(block, cap, need, size);
  memcpy(&old, block, sizeof old);
  if (vg_reserve(&new, &new_cap, need > more ? need : more, size)) return -1;
  c = (struct copy){ new, old };
  vg_engine_loop(e, n * size, CHUNK, copy_part, &c);
  free(old);
  memcpy(block, &new, sizeof new);
  *cap = new_cap;
  return 0;
}

static void free_part(void *context, size_t first, size_t end, int worker)
{
  void *const *block = context;

  (void)worker;
  for (size_t i = first; i < end; i++) free(block[i]);
}

void vg_engine_free(const struct vg_engine *e, size_t n, void *const *block)
{
  vg_engine_loop(e, n, 1, free_part, (void *)(uintptr_t)block);
}
