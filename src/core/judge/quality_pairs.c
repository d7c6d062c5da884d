/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Matching of the faces of tetrahedra in the order of the cells.
 *
 * A face waits in a hash table until its other side arrives, and then leaves
 * the table. Cells are written in an order in which neighbours follow each
 * other closely, so that few faces wait at a time and the table stays in the
 * cache. Faces of layers are matched by columns (quality_columns.c), and most
 * of them never enter the table.
 *
 * A face with four sides, two on each side, is not detected. But if all cells
 * are positive and all faces leave in pairs of opposite sides, the cells cover
 * each position equally often. The mesh then has a multiple of the volume
 * enclosed by its boundary, which is detected. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/union_find.h"
#include "core/judge/quality_pairs_parts.h"

/* Number of tetrahedra whose faces are prefetched from memory. */
#define AHEAD 16

/* Shorter columns are treated as single cells. */
#define LEAST_COLUMN 4

/* One of a and b is a cell, the other one a boundary face. */
static void bound(struct vg_pairing *p, uint32_t a, uint32_t b)
{
  uint32_t cell = a < b ? a : b;
  const uint32_t *tri = p->m->tri[(a < b ? b : a) - p->n_cell];
  const uint32_t node[4] = { tri[0], tri[1], tri[2], VG_NO_NODE };

  vg_solver_bound(p->solver, cell, node);
}

static void meet(struct vg_pairing *p, uint32_t first, uint32_t second)
{
  int same_side = (first & 1) == (second & 1);
  uint32_t a = first >> 1, b = second >> 1;
  size_t n_boundary = (size_t)(a >= p->n_cell) + (b >= p->n_cell);

  p->is_odd |= n_boundary > 1;
  if (n_boundary == 1 && p->solver) bound(p, a, b);
  if (!vg_stats_face(p->f, 2 - n_boundary, n_boundary, same_side)) return;
  vg_union(p->parent, a, b);
  vg_pairing_join(p, a, b);
}

void vg_pairing_add(struct vg_pairing *p, const struct vg_face *f)
{
  uint32_t other = vg_waiting_meet(&p->face, f);

  if (other != VG_NOBODY) meet(p, other, f->owner);
}

/* If the nodes a < b < c < d of a tetrahedron are in a positive order, b c d
 * and a b d wind in ascending order seen from outside, and the other faces in
 * the opposite direction. Each exchange of two nodes reverses all four. The
 * side is 1 under the same condition as in quality_faces.c: the lowest node is
 * followed by the higher one of the others. */
void vg_faces_of_tet(const uint32_t n[4], uint32_t cell, struct vg_face f[4])
{
  uint32_t v[4] = { n[0], n[1], n[2], n[3] };
  uint32_t side = 2 * cell ^ vg_order4(v);
  uint64_t a = v[0], b = v[1], c = v[2];

  f[0] = (struct vg_face){ a << 32 | b, v[2], side ^ 1 };
  f[1] = (struct vg_face){ a << 32 | b, v[3], side };
  f[2] = (struct vg_face){ a << 32 | c, v[3], side ^ 1 };
  f[3] = (struct vg_face){ b << 32 | c, v[3], side };
}

static struct vg_face face_of_tri(const uint32_t n[3], uint32_t owner)
{
  uint32_t v[3] = { n[0], n[1], n[2] }, side = 2 * owner ^ vg_order3(v);

  return (struct vg_face){ (uint64_t)v[0] << 32 | v[1], v[2], side };
}

/* Cells first .. end - 1, one by one. */
static void add_cells(struct vg_pairing *p, size_t first, size_t end)
{
  struct vg_face f[4 * AHEAD];

  for (size_t i = first, n; i < end && !p->face.refused; i += n) {
    n = end - i < AHEAD ? end - i : AHEAD;
    for (size_t k = 0; k < n; k++)
      vg_faces_of_tet(p->m->tet[i + k], (uint32_t)(i + k), f + 4 * k);
    for (size_t k = 0; k < 4 * n; k++)
      __builtin_prefetch(&p->face.bucket[vg_waiting_home(&p->face, &f[k])], 1);
    for (size_t k = 0; k < 4 * n && !p->face.refused; k++)
      vg_pairing_add(p, &f[k]);
  }
}

static void add_tets(struct vg_pairing *p)
{
  size_t single = 0; /* First cell that was not added. */

  for (size_t i = 0, n; i < p->m->n_tet && !p->refused; i += n) {
    n = vg_column_length(p->m, i);
    if (n < LEAST_COLUMN) continue;
    add_cells(p, single, i);
    vg_pairing_add_column(p, i, n);
    single = i + n;
  }
  add_cells(p, single, p->m->n_tet);
}

static void add_all_faces(struct vg_pairing *p)
{
  const struct vg_mesh *m = p->m;

  add_tets(p);
  vg_pairing_end_columns(p);
  for (size_t i = 0; i < m->n_tri && !p->face.refused; i++) {
    struct vg_face f = face_of_tri(m->tri[i], (uint32_t)(p->n_cell + i));

    vg_pairing_add(p, &f);
  }
  p->refused |= p->face.refused | p->first.refused;
}

/* List the faces that still wait, for matching with other slices. */
static vg_status list_unpaired(const struct vg_pairing *p,
                               struct vg_unpaired *unpaired,
                               struct vg_error *err)
{
  const struct vg_waiting *w = &p->face;

  if (vg_reserve(&unpaired->face, &unpaired->cap_face, unpaired->n_face + w->n,
                 sizeof *unpaired->face))
    return vg_fail_memory(err, "the unmatched faces of a slice");
  for (size_t i = 0; i <= w->mask; i++)
    for (unsigned k = 0; k < VG_FACE_SLOTS; k++) {
      const struct vg_face_bucket *b = &w->bucket[i];
      uint32_t cell = b->owner[k] >> 1,
               node[2] = { (uint32_t)b->key[k], b->high[k] };

      if (b->high[k] == VG_NOBODY) continue;
      unpaired->face[unpaired->n_face++] = (struct vg_unpaired_face){
        { (uint32_t)(b->key[k] >> 32), node[b->owner[k] & 1],
          node[~b->owner[k] & 1], VG_NO_NODE },
        cell,
        cell,
        p->volume[cell]
      };
    }
  return VG_OK;
}

int vg_faces_can_pair(const struct vg_mesh *m,
                      const struct vg_unpaired *unpaired)
{
  return !(m->n_pyr + m->n_pri + m->n_hex + m->n_quad) &&
         !(unpaired && (unpaired->is_shared || m->n_tri));
}

vg_status vg_pair_faces(const struct vg_mesh *m, const float *volume,
                        struct vg_stats *f, struct vg_solver_sweep *solver,
                        struct vg_unpaired *unpaired, uint32_t *parent,
                        struct vg_error *err)
{
  assert(vg_faces_can_pair(m, unpaired));
  assert(parent || !m->n_tet);

  struct vg_pairing p = { .m = m,
                          .volume = volume,
                          .solver = solver,
                          .parent = parent,
                          .n_cell = m->n_tet };
  vg_status st = VG_OK;

  p.f = vg_stats_new();
  vg_waiting_init(&p.face);
  vg_waiting_init(&p.first);
  p.refused = !p.f || p.face.refused || p.first.refused;
  if (!p.refused) add_all_faces(&p);
  if (p.refused) st = vg_fail_memory(err, "the table of faces");
  else if (unpaired) st = list_unpaired(&p, unpaired, err);
  else if (p.face.n || p.is_odd) st = VG_BLOCKED;
  if (st == VG_OK) vg_stats_add(f, p.f);
  free(p.f);
  free(p.strip);
  vg_waiting_release(&p.face);
  vg_waiting_release(&p.first);
  return st;
}
