#include "core/tets.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/predicates.h"

const uint8_t vg_face[4][3] = {{1, 3, 2}, {0, 2, 3}, {0, 3, 1}, {0, 1, 2}};

void vg_tets_release(struct vg_tets *t)
{
  free(t->x);
  free(t->cell);
  free(t->flag);
  free(t->free);
  memset(t, 0, sizeof *t);
}

int vg_tets_reserve_points(struct vg_tets *t, size_t n)
{
  return vg_reserve(&t->x, &t->cap_point, t->n_point + n, sizeof *t->x);
}

int vg_tets_reserve_cells(struct vg_tets *t, size_t n)
{
  size_t cap = t->cap_cell, need;

  if (t->n_free >= n) return 0;
  need = t->n_cell + n - t->n_free;
  if (need <= cap) return 0;
  if (need >= VG_CELL_MAX) return -1;
  if (vg_reserve(&t->cell, &cap, need, sizeof *t->cell)) return -1;
  cap = t->cap_cell;
  if (vg_reserve(&t->flag, &cap, need, sizeof *t->flag)) return -1;
  t->cap_cell = cap;
  return 0;
}

int vg_tets_drop(struct vg_tets *t, uint32_t cell)
{
  if (vg_reserve(&t->free, &t->cap_free, t->n_free + 1, sizeof *t->free))
    return -1;
  t->flag[cell] = VG_DEAD;
  t->free[t->n_free++] = cell;
  return 0;
}

/* --- links ------------------------------------------------------------- */

static void sort3(uint32_t v[3])
{
#define ORDER(a, b) \
  if (v[a] > v[b]) { uint32_t keep = v[a]; v[a] = v[b]; v[b] = keep; }
  ORDER(0, 1)
  ORDER(1, 2)
  ORDER(0, 1)
#undef ORDER
}

static uint64_t face_key(const struct vg_cell *c, int i, uint32_t v[3])
{
  for (int k = 0; k < 3; k++) v[k] = c->v[vg_face[i][k]];
  sort3(v);
  return (v[0] * 0x9e3779b97f4a7c15u) ^ (v[1] * 0xc2b2ae3d27d4eb4fu) ^
         (v[2] * 0x165667b19e3779f9u);
}

/* Faces met once wait in an open-addressing table; the second visit takes
 * them out again as a tombstone, so load is bounded by faces, not pairs. */
static vg_status link_faces(struct vg_tets *t, uint32_t *table, size_t mask,
                            struct vg_error *err)
{
  for (uint32_t c = 0; c < t->n_cell; c++) {
    if (t->flag[c] & VG_DEAD) continue;
    for (uint32_t i = 0; i < 4; i++) {
      uint32_t v[3], w[3];
      uint64_t key = face_key(&t->cell[c], (int)i, v);
      size_t at = (key ^ key >> 29) & mask;

      for (;; at = (at + 1) & mask) {
        uint32_t other = table[at];

        if (other == VG_NONE) {
          table[at] = 4 * c + i;
          break;
        }
        face_key(&t->cell[other >> 2], other & 3, w);
        if (memcmp(v, w, sizeof v)) continue;
        if (t->cell[other >> 2].link[other & 3] != VG_NONE)
          return vg_fail(err, VG_ERR_GEOMETRY,
                         "face of points %u %u %u has more than two cells",
                         v[0] + 1, v[1] + 1, v[2] + 1);
        vg_tets_join(t, other, 4 * c + i);
        break;
      }
    }
  }
  return VG_OK;
}

vg_status vg_tets_link(struct vg_tets *t, struct vg_error *err)
{
  size_t size = 64;
  uint32_t *table;
  vg_status st;

  while (size < 5 * t->n_cell) size *= 2;
  table = vg_alloc(size, sizeof *table);
  if (!table) return vg_fail_memory(err, "the neighbour table");
  memset(table, 0xff, size * sizeof *table);
  for (size_t c = 0; c < t->n_cell; c++)
    memset(t->cell[c].link, 0xff, sizeof t->cell[c].link);
  st = link_faces(t, table, size - 1, err);
  free(table);
  return st;
}

/* --- location ---------------------------------------------------------- */

static uint32_t search_all(const struct vg_tets *t, const double x[3])
{
  for (uint32_t c = 0; c < t->n_cell; c++) {
    const uint32_t *v = t->cell[c].v;
    int i = 0;

    if (t->flag[c] & VG_DEAD) continue;
    for (; i < 4; i++)
      if (vg_orient3d(t->x[v[vg_face[i][0]]], t->x[v[vg_face[i][1]]],
                      t->x[v[vg_face[i][2]]], x) < 0)
        break;
    if (i == 4) return c;
  }
  return VG_NONE;
}

uint32_t vg_tets_locate(const struct vg_tets *t, uint32_t start,
                        const double x[3])
{
  uint32_t c = start, from = VG_NONE;

  /* The first face tried turns with the step: a walk in a mesh that is not
   * Delaunay cannot circle for ever in step with a fixed order. */
  for (uint32_t step = 0; step < 4096; step++) {
    const struct vg_cell *cell = &t->cell[c];
    uint32_t turn = step * 0x9e3779b1u >> 30, k = 0;

    for (; k < 4; k++) {
      uint32_t i = (turn + k) & 3;
      const uint8_t *f = vg_face[i];

      if (cell->link[i] == from && from != VG_NONE) continue;
      if (vg_orient3d(t->x[cell->v[f[0]]], t->x[cell->v[f[1]]],
                      t->x[cell->v[f[2]]], x) >= 0)
        continue;
      if (cell->link[i] == VG_NONE) return VG_NONE;
      from = 4 * c + i;
      c = cell->link[i] >> 2;
      break;
    }
    if (k == 4) return c;
  }
  return search_all(t, x);
}

/* --- housekeeping ------------------------------------------------------ */

vg_status vg_tets_compact(struct vg_tets *t, int drop_outside,
                          struct vg_error *err)
{
  uint8_t gone = VG_DEAD | (drop_outside ? VG_OUTSIDE : 0);
  uint32_t *to = vg_alloc(t->n_cell, sizeof *to);
  uint32_t n = 0;

  if (!to) return vg_fail_memory(err, "renumbering cells");
  for (size_t c = 0; c < t->n_cell; c++)
    to[c] = t->flag[c] & gone ? VG_NONE : n++;
  for (size_t c = 0; c < t->n_cell; c++) {
    struct vg_cell cell = t->cell[c];

    if (to[c] == VG_NONE) continue;
    for (int i = 0; i < 4; i++)
      if (cell.link[i] != VG_NONE) {
        uint32_t other = to[cell.link[i] >> 2];

        cell.link[i] = other == VG_NONE ? VG_NONE
                                        : 4 * other + (cell.link[i] & 3);
      }
    t->cell[to[c]] = cell;
    t->flag[to[c]] = t->flag[c];
  }
  t->n_cell = n;
  t->n_free = 0;
  free(to);
  return VG_OK;
}

size_t vg_tets_defects(const struct vg_tets *t)
{
  size_t bad = 0;

  for (uint32_t c = 0; c < t->n_cell; c++) {
    const struct vg_cell *cell = &t->cell[c];

    if (t->flag[c] & VG_DEAD) continue;
    bad += !(vg_orient3d(t->x[cell->v[0]], t->x[cell->v[1]],
                         t->x[cell->v[2]], t->x[cell->v[3]]) > 0);
    for (uint32_t i = 0; i < 4; i++) {
      uint32_t l = cell->link[i], v[3], w[3];

      if (l == VG_NONE) continue;
      face_key(cell, (int)i, v);
      face_key(&t->cell[l >> 2], l & 3, w);
      bad += t->cell[l >> 2].link[l & 3] != 4 * c + i ||
             memcmp(v, w, sizeof v) || t->flag[l >> 2] & VG_DEAD ||
             (t->flag[c] >> i & 1) != (t->flag[l >> 2] >> (l & 3) & 1);
    }
  }
  return bad;
}
