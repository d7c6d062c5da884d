/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/delaunay/cavity.h"

#include <assert.h>
#include <string.h>

#include "base/memory.h"
#include "base/tri_key.h"

/* --- the star of an edge -------------------------------------------------- */

/* [i][j]: the corners k, l for which (k, l, i, j) is an even permutation. */
static const uint8_t across[4][4][2] = {
  { { 0, 0 }, { 2, 3 }, { 3, 1 }, { 1, 2 } },
  { { 3, 2 }, { 0, 0 }, { 0, 3 }, { 2, 0 } },
  { { 1, 3 }, { 3, 0 }, { 0, 0 }, { 0, 1 } },
  { { 2, 1 }, { 0, 2 }, { 1, 0 }, { 0, 0 } },
};

/* Index of point p among the corners of cell c, without branches. */
static inline uint32_t corner_of(const struct vg_cell *c, uint32_t p)
{
  assert(c->v[0] == p || c->v[1] == p || c->v[2] == p || c->v[3] == p);
  return (uint32_t)(c->v[1] == p) + 2 * (uint32_t)(c->v[2] == p) +
         3 * (uint32_t)(c->v[3] == p);
}

int vg_cavity_ring(const struct vg_tets *t, uint32_t c, uint32_t a, uint32_t b,
                   int most, int fixed, uint32_t *cell, uint32_t *ring)
{
  const struct vg_cell *at = &t->cell[c];
  uint32_t first = c, from, to, i;
  const uint8_t *other;
  int n = 0;

  assert(a != b && c < t->n_cell && most > 0);
  assert(!(t->flag[c] & VG_DEAD));
  other = across[corner_of(at, a)][corner_of(at, b)];
  i = other[0];
  from = at->v[i];
  to = at->v[other[1]];
  for (;;) {
    uint32_t link = at->link[i];

    if (n == most) return 0;
    cell[n] = c;
    ring[n++] = from;
    if ((t->flag[c] >> i & 1 && !fixed) || link == VG_NONE) return 0;
    c = link >> 2;
    if (c == first) return n;
    at = &t->cell[c];
    from = to;
    to = at->v[link & 3];
    i = corner_of(at, from);
  }
}

/* --- replacing cells ------------------------------------------------------ */

struct border { /* a face of the cavity, or one that waits for its mate */
  uint32_t v[3], link;
  uint8_t fixed;
};

void vg_cavity_face(const struct vg_cell *c, int i, uint32_t v[3])
{
  assert(i >= 0 && i < 4);
  for (int k = 0; k < 3; k++) v[k] = c->v[vg_face[i][k]];
  vg_order3(v);
}

static int collect_border(const struct vg_tets *t, int n_old,
                          const uint32_t *old, struct border *border)
{
  int n = 0;

  for (int k = 0; k < n_old; k++)
    for (int i = 0; i < 4; i++) {
      uint32_t link = t->cell[old[k]].link[i];

      if (link != VG_NONE && t->flag[link >> 2] & VG_MARK) continue;
      vg_cavity_face(&t->cell[old[k]], i, border[n].v);
      border[n].link = link;
      border[n++].fixed = t->flag[old[k]] >> i & 1;
    }
  return n;
}

/* Link face i of new cell c with the border or with another new cell. */
static void link_face(struct vg_tets *t, uint32_t c, uint32_t i,
                      struct border *border, int *n)
{
  uint32_t v[3];

  vg_cavity_face(&t->cell[c], (int)i, v);
  for (int k = 0; k < *n; k++) {
    if (border[k].v[0] != v[0] || border[k].v[1] != v[1] ||
        border[k].v[2] != v[2])
      continue;
    t->cell[c].link[i] = border[k].link;
    if (border[k].link != VG_NONE)
      t->cell[border[k].link >> 2].link[border[k].link & 3] = 4 * c + i;
    if (border[k].fixed) t->flag[c] |= (uint8_t)(1 << i);
    border[k] = border[--*n];
    return;
  }
  memcpy(border[*n].v, v, sizeof v);
  border[*n].link = 4 * c + i;
  border[(*n)++].fixed = 0;
}

int vg_cavity_reserve(struct vg_tets *t, int n_old, int n_new)
{
  assert(n_old > 0 && n_new > 0);
  return vg_tets_reserve_cells(t, (size_t)n_new) ||
             vg_reserve(&t->free, &t->cap_free, t->n_free + (size_t)n_old,
                        sizeof *t->free)
         ? -1
         : 0;
}

void vg_cavity_refill(struct vg_tets *t, int n_old, const uint32_t *old,
                      int n_new, const uint32_t (*v)[4], uint32_t *slot)
{
  struct border border[8 * VG_CAVITY_MAX];
  int n;

  assert(n_old > 0 && n_old <= VG_CAVITY_MAX);
  assert(n_new > 0 && n_new <= VG_CAVITY_MAX);
  for (int k = 0; k < n_old; k++) t->flag[old[k]] |= VG_MARK;
  n = collect_border(t, n_old, old, border);
  for (int k = 0; k < n_new; k++) {
    uint32_t c = slot[k] = k < n_old ? old[k] : vg_tets_alloc_cell(t);

    memcpy(t->cell[c].v, v[k], sizeof t->cell[c].v);
    t->flag[c] = 0;
  }
  for (int k = 0; k < n_new; k++)
    for (uint32_t i = 0; i < 4; i++) link_face(t, slot[k], i, border, &n);
  for (int k = n_new; k < n_old; k++) vg_tets_free_cell(t, old[k]);
}
