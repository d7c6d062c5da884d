/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
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

struct text {
  char **out, *text;
  size_t *size, n, cap;
  int is_part;
};

static ssize_t append(void *cookie, const char *data, size_t n)
{
  struct text *t = cookie;

  if (t->is_part || vg_reserve(&t->text, &t->cap, t->n + n + 1, 1)) {
    t->is_part = 1;
    return 0; /* an error */
  }
  memcpy(t->text + t->n, data, n);
  t->n += n;
  t->text[t->n] = 0;
  return (ssize_t)n;
}

static int end_text(void *cookie)
{
  struct text *t = cookie;
  int status = t->is_part ? -1 : 0;

  if (status) free(t->text);
  *t->out = status ? NULL : t->text;
  *t->size = status ? 0 : t->n;
  free(t);
  return status;
}

FILE *vg_text_open(char **text, size_t *size)
{
  const cookie_io_functions_t calls = { .write = append, .close = end_text };
  struct text *t = vg_calloc(1, sizeof *t);
  FILE *to;

  assert(text && size);
  *text = NULL;
  *size = 0;
  if (!t) return NULL;
  *t = (struct text){ .out = text, .size = size };
  append(t, "", 0); /* The empty text, too, is a text. */
  to = t->is_part ? NULL : fopencookie(t, "w", calls);
  if (!to) {
    free(t->text);
    free(t);
  }
  return to;
}

void vg_memory_trim(void)
{
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}
