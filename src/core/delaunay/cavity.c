/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/delaunay/cavity.h"

#include <assert.h>
#include <string.h>

#include "base/memory.h"
#include "base/tri_key.h"

/* --- the star of an edge -------------------------------------------------- */

/* Is (from, to, a, b) an odd permutation of the corners of cell c? */
static int is_odd(const struct vg_cell *c, uint32_t from, uint32_t to,
                  uint32_t a, uint32_t b)
{
  uint32_t want[4] = { from, to, a, b };
  int place[4] = { 0 }, odd = 0;

  for (int i = 0; i < 4; i++)
    for (int j = 0; j < 4; j++)
      if (c->v[j] == want[i]) place[i] = j;
  for (int i = 0; i < 4; i++)
    for (int j = i + 1; j < 4; j++) odd ^= place[i] > place[j];
  return odd;
}

int vg_cavity_ring(const struct vg_tets *t, uint32_t c, uint32_t a, uint32_t b,
                   int most, int fixed, uint32_t *cell, uint32_t *ring)
{
  uint32_t first = c, other[2], from, to;
  int n = 0, i, k = 0;

  assert(a != b && c < t->n_cell && most > 0);
  assert(!(t->flag[c] & VG_DEAD));
  for (i = 0; i < 4; i++)
    if (t->cell[c].v[i] != a && t->cell[c].v[i] != b)
      other[k++] = t->cell[c].v[i];
  k = is_odd(&t->cell[c], other[0], other[1], a, b);
  from = other[k];
  to = other[!k];
  do {
    const struct vg_cell *at = &t->cell[c];
    uint32_t link;

    if (n == most) return 0;
    cell[n] = c;
    ring[n++] = from;
    for (i = 0; at->v[i] != from; i++) {
    }
    if (t->flag[c] >> i & 1 && !fixed) return 0;
    link = at->link[i];
    if (link == VG_NONE) return 0;
    c = link >> 2;
    from = to;
    to = t->cell[c].v[link & 3];
  } while (c != first);
  return n;
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
