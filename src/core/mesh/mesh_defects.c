/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Checks of the boundary faces of a mesh. */
#include "core/mesh/mesh_defects.h"

#include <assert.h>
#include <stdlib.h>

#include "base/memory.h"
#include "core/mesh/edges.h"

static size_t bad_face(const struct vg_mesh *m, const uint32_t *node, int n,
                       uint32_t patch)
{
  size_t bad = patch >= m->n_patch;

  for (int k = 0; k < n; k++) bad += node[k] >= m->n_point;
  return bad;
}

size_t vg_mesh_bad_faces(const struct vg_mesh *m)
{
  size_t bad = 0;

  assert(m);
  for (size_t i = 0; i < m->n_tri; i++)
    bad += bad_face(m, m->tri[i], 3, m->tri_patch[i]);
  for (size_t i = 0; i < m->n_quad; i++)
    bad += bad_face(m, m->quad[i], 4, m->quad_patch[i]);
  return bad;
}

static size_t add_sides(const uint32_t *node, int n, uint32_t (*side)[2])
{
  size_t n_side = 0;

  for (int k = 0; k < n; k++) {
    if (node[k] == node[(k + 1) % n]) continue; /* reported by other checks */
    side[n_side][0] = node[k];
    side[n_side++][1] = node[(k + 1) % n];
  }
  return n_side;
}

size_t vg_mesh_open_edges(const struct vg_mesh *m)
{
  uint32_t(*side)[2] = vg_alloc(3 * m->n_tri + 4 * m->n_quad, sizeof *side);
  struct vg_edges e = VG_EDGES_INIT;
  size_t n = 0, bad = 0;

  if (!side) return SIZE_MAX;
  for (size_t i = 0; i < m->n_tri; i++) n += add_sides(m->tri[i], 3, side + n);
  for (size_t i = 0; i < m->n_quad; i++)
    n += add_sides(m->quad[i], 4, side + n);
  if (vg_edges_build_sides(&e, m->n_point, n, (const uint32_t(*)[2])side,
                           NULL) < 0)
    bad = SIZE_MAX;
  for (size_t i = 0; i < e.n; i++) {
    long balance = 0;

    for (uint32_t k = e.start[i]; k < e.start[i + 1]; k++)
      balance += side[e.half[k]][0] < side[e.half[k]][1] ? 1 : -1;
    bad += balance != 0;
  }
  vg_edges_release(&e);
  free(side);
  return bad;
}
