#include "base/memory.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

void *vg_alloc(size_t n, size_t size)
{
  return vg_realloc(NULL, n, size);
}

void *vg_calloc(size_t n, size_t size)
{
  return calloc(n ? n : 1, size ? size : 1);
}

void *vg_realloc(void *block, size_t n, size_t size)
{
  size_t bytes;

  if (__builtin_mul_overflow(n, size, &bytes) || bytes > PTRDIFF_MAX)
    return NULL;
  return realloc(block, bytes ? bytes : 1);
}

int vg_reserve(void *block, size_t *cap, size_t need, size_t size)
{
  void *old, *new;
  size_t n = *cap + *cap / 2;

  if (need <= *cap) return 0;
  if (n < need) n = need;
  if (n < 16) n = 16;
  memcpy(&old, block, sizeof old);
  new = vg_realloc(old, n, size);
  if (!new) return -1;
  memcpy(block, &new, sizeof new);
  *cap = n;
  return 0;
}
