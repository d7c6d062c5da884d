/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "io/cgns/cgns_store.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

void vg_cgns_store_release(struct vg_cgns_store *s)
{
  const struct vg_cgns_store empty = VG_CGNS_STORE_INIT;

  free(s->page);
  *s = empty;
}

/* First page with this number or a higher one. */
static size_t find(const struct vg_cgns_store *s, uint64_t number)
{
  size_t lo = 0, hi = s->n_page;

  while (lo < hi) {
    size_t mid = lo + (hi - lo) / 2;

    if (s->page[mid].number < number) lo = mid + 1;
    else hi = mid;
  }
  return lo;
}

static uint64_t part_of(uint64_t at, uint64_t n)
{
  uint64_t left = VG_CGNS_PAGE - at % VG_CGNS_PAGE;

  return n < left ? n : left;
}

static void view_bytes(const struct vg_cgns_store *s, uint64_t at, uint64_t n,
                       unsigned char *to)
{
  uint64_t have = at < s->size ? s->size - at : 0;

  if (have > n) have = n;
  if (have) memcpy(to, s->view + at, have);
  memset(to + have, 0, n - have);
}

void vg_cgns_store_get(const struct vg_cgns_store *s, uint64_t at, uint64_t n,
                       void *to)
{
  unsigned char *out = to;

  assert(to || !n);
  if (s->view) {
    view_bytes(s, at, n, out);
    return;
  }
  for (uint64_t part; n; n -= part, at += part, out += part) {
    size_t i = find(s, at / VG_CGNS_PAGE);

    part = part_of(at, n);
    if (i < s->n_page && s->page[i].number == at / VG_CGNS_PAGE)
      memcpy(out, s->page[i].byte + at % VG_CGNS_PAGE, part);
    else memset(out, 0, part);
  }
}

/* There are few pages, and most are added in ascending order. */
static struct vg_cgns_page *page_for(struct vg_cgns_store *s, uint64_t number)
{
  size_t i = find(s, number);

  if (i < s->n_page && s->page[i].number == number) return s->page + i;
  if (vg_reserve(&s->page, &s->cap_page, s->n_page + 1, sizeof *s->page)) {
    s->failed = 1;
    return NULL;
  }
  memmove(s->page + i + 1, s->page + i, (s->n_page++ - i) * sizeof *s->page);
  memset(s->page + i, 0, sizeof *s->page);
  s->page[i].number = number;
  return s->page + i;
}

void vg_cgns_store_put(struct vg_cgns_store *s, uint64_t at, uint64_t n,
                       const void *from)
{
  const unsigned char *in = from;

  assert(!s->view && (from || !n));
  for (uint64_t part; n; n -= part, at += part, in += part) {
    struct vg_cgns_page *p = page_for(s, at / VG_CGNS_PAGE);

    part = part_of(at, n);
    if (p) memcpy(p->byte + at % VG_CGNS_PAGE, in, part);
  }
}
