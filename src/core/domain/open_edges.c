/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/domain/open_edges.h"

#include <assert.h>
#include <stdlib.h>

#include "base/memory.h"
#include "core/mesh/edges.h"

static size_t n_side(const struct vg_mesh *m)
{
  return 3 * m->n_tri + 4 * m->n_quad;
}

static void list_sides(const struct vg_mesh *m, uint32_t (*side)[2])
{
  for (size_t i = 0; i < 3 * m->n_tri; i++, side++) {
    (*side)[0] = m->tri[i / 3][i % 3];
    (*side)[1] = m->tri[i / 3][(i + 1) % 3];
  }
  for (size_t i = 0; i < 4 * m->n_quad; i++, side++) {
    (*side)[0] = m->quad[i / 4][i % 4];
    (*side)[1] = m->quad[i / 4][(i + 1) % 4];
  }
}

static vg_status refuse(const double x[3], const double y[3],
                        struct vg_error *err)
{
  return vg_fail(err, VG_ERR_GEOMETRY,
                 "edge from (%.9g, %.9g, %.9g) to (%.9g, %.9g, %.9g): its "
                 "triangles have opposite orientations; run `vanguard check` "
                 "on the surface",
                 x[0], x[1], x[2], y[0], y[1], y[2]);
}

/* Find the edges whose sides do not cancel: those with more sides in one
 * direction than in the other. */
vg_status vg_open_edges(const struct vg_mesh *m, struct vg_border *open,
                        struct vg_error *err)
{
  assert(m && open);

  uint32_t(*side)[2] = vg_alloc(n_side(m), sizeof *side);
  struct vg_edges e = VG_EDGES_INIT;
  vg_status st;

  if (!side) return vg_fail_memory(err, "the edges of the surface");
  list_sides(m, side);
  st = vg_edges_build_sides(&e, m->n_point, n_side(m),
                            (const uint32_t(*)[2])side, err);
  for (size_t i = 0; st == VG_OK && i < e.n; i++) {
    const uint32_t *s = side[vg_edges_at(&e, i)[0]];
    const uint32_t lo = s[0] < s[1] ? s[0] : s[1], hi = s[0] ^ s[1] ^ lo;
    int sum = 0; /* sides that start at the lower point, minus others */

    for (uint32_t k = 0; k < vg_edges_count(&e, i); k++)
      sum += side[vg_edges_at(&e, i)[k]][0] < hi ? 1 : -1;
    if (sum < -1 || sum > 1) st = refuse(m->point[lo], m->point[hi], err);
    else if (sum > 0) st = vg_border_add(open, hi, lo, err);
    else if (sum < 0) st = vg_border_add(open, lo, hi, err);
  }
  vg_edges_release(&e);
  free(side);
  return st;
}
