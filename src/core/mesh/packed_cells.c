/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/mesh/packed_cells.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

static size_t n_word(size_t n, unsigned width)
{
  return (4 * n * width + 63) / 64 + 1;
}

static unsigned width_of(size_t n_point)
{
  unsigned width = 1;

  while (width < 32 && n_point > (size_t)1 << width) width++;
  return width;
}

int vg_packed_cells_new(size_t n, const uint32_t (*cell)[4], size_t n_point,
                        struct vg_packed_cells *out)
{
  assert(n_point <= (size_t)1 << 32 && (cell || !n) && out);

  struct vg_packed_cells p = { width_of(n_point), NULL };
  const uint32_t *v = n ? cell[0] : NULL;
  uint64_t bits = 0; /* Bits that do not fill a word yet. */
  unsigned held = 0; /* Number of these bits, < 64. */
  size_t at = 0;

  p.word = vg_alloc(n_word(n, p.width), sizeof *p.word);
  if (!p.word) return -1;
  for (size_t k = 0; k < 4 * n; k++) {
    assert(v[k] < n_point);
    bits |= (uint64_t)v[k] << held;
    held += p.width;
    if (held < 64) continue;
    p.word[at++] = bits;
    held -= 64;
    bits = held ? (uint64_t)v[k] >> (p.width - held) : 0;
  }
  while (at < n_word(n, p.width)) {
    p.word[at++] = bits;
    bits = 0;
  }
  *out = p;
  return 0;
}

void vg_packed_cells_release(struct vg_packed_cells *p)
{
  free(p->word);
  memset(p, 0, sizeof *p);
}

void vg_packed_cells_all(const struct vg_packed_cells *p, size_t n,
                         uint32_t (*cell)[4])
{
  assert(p && (n == 0 || (p->word && cell)));
  for (size_t c = 0; c < n; c++) vg_packed_cell(p, c, cell[c]);
}

size_t vg_packed_cells_bytes(const struct vg_packed_cells *p, size_t n)
{
  return p->word ? n_word(n, p->width) * sizeof *p->word : 0;
}
