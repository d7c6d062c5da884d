/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The balls of all points at once. To list them takes one pass over the cells,
 * which is faster than a search around each point. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/optimise/optimise_parts.h"

static int is_live(const struct vg_tets *t, size_t c)
{
  return !(t->flag[c] & (VG_DEAD | VG_OUTSIDE));
}

/* Mark the points of cell c that are on a fixed face, on the hull, or on a cell
 * outside. */
static void mark_open(const struct vg_tets *t, size_t c, uint8_t *is_open)
{
  const struct vg_cell *cell = &t->cell[c];

  for (int i = 0; i < 4; i++)
    if (t->flag[c] >> i & 1 || cell->link[i] == VG_NONE ||
        t->flag[cell->link[i] >> 2] & VG_OUTSIDE)
      for (int k = 0; k < 3; k++) is_open[cell->v[vg_face[i][k]]] = 1;
}

int vg_balls_init(const struct vg_tets *t, struct vg_balls *b)
{
  size_t n = 0;

  memset(b, 0, sizeof *b);
  b->first = vg_calloc(t->n_point + 2, sizeof *b->first);
  b->is_open = vg_calloc(t->n_point, 1);
  if (!b->first || !b->is_open) return -1;
  for (size_t c = 0; c < t->n_cell; c++) {
    if (!is_live(t, c)) continue;
    for (int i = 0; i < 4; i++) b->first[t->cell[c].v[i] + 2]++;
    mark_open(t, c, b->is_open);
    n += 4;
  }
  assert(n <= UINT32_MAX);
  b->link = vg_alloc(n, sizeof *b->link);
  if (!b->link) return -1;
  for (size_t p = 0; p < t->n_point; p++) b->first[p + 2] += b->first[p + 1];
  for (size_t c = 0; c < t->n_cell; c++)
    for (uint32_t i = 0; i < 4 && is_live(t, c); i++)
      b->link[b->first[t->cell[c].v[i] + 1]++] = 4 * (uint32_t)c + i;
  return 0;
}

void vg_balls_release(struct vg_balls *b)
{
  free(b->first);
  free(b->link);
  free(b->is_open);
}
