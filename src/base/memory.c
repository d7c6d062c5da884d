/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "base/memory.h"

#include <assert.h>
#include <malloc.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

enum { HUGE_PAGE = 1 << 21 };

/* Advise the kernel to use huge pages. Mesh algorithms access memory
 * irregularly; fewer page faults and address translations make a complete fill
 * 7 % faster. */
static void *spread(void *block, size_t bytes)
{
  uintptr_t from = ((uintptr_t)block + HUGE_PAGE - 1) & -(uintptr_t)HUGE_PAGE;
  uintptr_t to = ((uintptr_t)block + bytes) & -(uintptr_t)HUGE_PAGE;

  if (block && bytes >= 2 * HUGE_PAGE)
    madvise((void *)from, to - from, MADV_HUGEPAGE);
  return block;
}

void *vg_alloc(size_t n, size_t size)
{
  assert(size > 0);
  return vg_realloc(NULL, n, size);
}

void *vg_calloc(size_t n, size_t size)
{
  assert(size > 0);
  return calloc(n ? n : 1, size ? size : 1);
}

void *vg_realloc(void *block, size_t n, size_t size)
{
  size_t bytes;

  assert(size > 0);
  if (__builtin_mul_overflow(n, size, &bytes) || bytes > PTRDIFF_MAX)
    return NULL;
  return spread(realloc(block, bytes ? bytes : 1), bytes);
}

int vg_reserve(void *block, size_t *cap, size_t need, size_t size)
{
  assert(block && cap && size > 0);

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

void vg_memory_trim(void)
{
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}
