/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "common/endless.h"

#include <fcntl.h>
#include <stdint.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "base/hash.h"

/* Looks before the first state is kept: hashing the memory is not free. */
#define PATIENCE 8

/* Mappings of this size and more are reservations of a sanitizer. */
#define RESERVED ((uintptr_t)1 << 40)

/* The kept state. It is in a shared mapping, because private memory is part of
 * the state. */
static struct seen {
  uint64_t n, next; /* number of looks; that of the next replacement */
  uint64_t stack, memory;
  int has_moved; /* the computation had another state in the meantime: a timer
                    that ran out during a look is no step */
} * seen;

int vg_endless_start(void)
{
  if (!seen) {
    void *page = mmap(NULL, sizeof *seen, PROT_READ | PROT_WRITE,
                      MAP_SHARED | MAP_ANONYMOUS, -1, 0);

    if (page == MAP_FAILED) return 0;
    seen = page;
  }
  memset(seen, 0, sizeof *seen);
  seen->next = PATIENCE;
  return 1;
}

__attribute__((no_sanitize("address"))) static uint64_t hash_range(uint64_t h,
                                                                   uintptr_t lo,
                                                                   uintptr_t hi)
{
  const volatile uint64_t *word = (const volatile uint64_t *)lo;
  size_t n = (hi - lo) / sizeof *word;

  for (size_t i = 0; i < n; i++) h = vg_hash_add(h, word[i]);
  return h;
}

/* /proc/self/maps, read without a buffer of the C library. */
struct maps {
  int fd;
  size_t at, n;
  char text[4096];
};

static int next_character(struct maps *m)
{
  if (m->at == m->n) {
    ssize_t n = read(m->fd, m->text, sizeof m->text);

    if (n <= 0) return -1;
    m->at = 0;
    m->n = (size_t)n;
  }
  return m->text[m->at++];
}

/* A hexadecimal number and the character after it. */
static uintptr_t number(struct maps *m)
{
  uintptr_t v = 0;
  int c;

  while ((c = next_character(m)) > ' ' && c != '-')
    v = 16 * v + (uintptr_t)(c <= '9' ? c - '0' : c - 'a' + 10);
  return v;
}

/* The next line "LO-HI rw-p ...". Returns 0 after the last one. */
static int next_mapping(struct maps *m, uintptr_t *lo, uintptr_t *hi,
                        char what[4])
{
  int c = 0;

  *lo = number(m);
  *hi = number(m);
  for (int k = 0; k < 4; k++) what[k] = (char)next_character(m);
  while (c >= 0 && c != '\n') c = next_character(m);
  return c == '\n';
}

/* The stack above the context, with the saved registers, or all writable
 * memory but the stack of the handler. Returns 0 on failure. */
static int hash_state(uintptr_t context, int has_memory, uint64_t *h)
{
  struct maps m = { .fd = open("/proc/self/maps", O_RDONLY | O_CLOEXEC) };
  uintptr_t lo, hi;
  char what[4];
  int is_found = 0;

  *h = 0;
  if (m.fd < 0) return 0;
  while (next_mapping(&m, &lo, &hi, what)) {
    int has_stack = lo <= context && context < hi;

    if (memcmp(what, "rw-p", sizeof what) != 0 || hi - lo >= RESERVED) continue;
    if (has_stack) lo = context;
    if (has_stack || has_memory) *h = hash_range(*h, lo, hi);
    is_found |= has_stack;
  }
  close(m.fd);
  return is_found;
}

/* R. Brent, "An improved Monte Carlo factorization algorithm", BIT 20, 1980:
 * the kept state is replaced after 8, 16, 32, ... looks, so that it is on the
 * cycle at some time. */
int vg_endless_look(const void *context)
{
  const uintptr_t at = (uintptr_t)context & ~(uintptr_t)7;
  int is_replaced;
  uint64_t stack, memory;

  if (!seen || ++seen->n < PATIENCE || !hash_state(at, 0, &stack)) return 0;
  is_replaced = seen->n == seen->next;
  if (!is_replaced && stack != seen->stack) seen->has_moved = 1;
  if (!is_replaced && (stack != seen->stack || !seen->has_moved)) return 0;
  seen->has_moved = 0;
  if (!hash_state(at, 1, &memory)) return 0;
  if (!is_replaced) return memory == seen->memory;
  seen->stack = stack;
  seen->memory = memory;
  seen->next *= 2;
  return 0;
}
