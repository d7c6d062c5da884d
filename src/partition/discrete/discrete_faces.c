/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Faces and edges between subdomains. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/tri_key.h"
#include "core/mesh/edges.h"
#include "partition/discrete/discrete_parts.h"

void vg_interface_release(struct vg_interface *f)
{
  free(f->side);
  free(f->edge);
  free(f->end);
  free(f->n_around);
  memset(f, 0, sizeof *f);
}

void vg_interface_corners(const struct vg_coarse *c,
                          const struct vg_interface *f, size_t i, uint32_t v[3])
{
  const struct vg_cell *cell = &c->t.cell[f->side[i] >> 2];

  assert(i < f->n_face && f->side[i] >> 2 < c->t.n_cell);
  for (int k = 0; k < 3; k++) v[k] = cell->v[vg_face[f->side[i] & 3][k]];
}

static vg_status list_sides(const struct vg_coarse *c, struct vg_interface *f,
                            struct vg_error *err)
{
  size_t cap = 0;

  for (size_t q = 0; q < c->t.n_cell; q++)
    for (uint32_t i = 0; i < 4; i++) {
      uint32_t link = c->t.cell[q].link[i];

      if (link == VG_NONE || link >> 2 < q || c->part[link >> 2] == c->part[q])
        continue;
      if (vg_reserve(&f->side, &cap, f->n_face + 1, sizeof *f->side))
        return vg_fail_memory(err, "the interfaces");
      f->side[f->n_face++] = (uint32_t)(4 * q + i);
    }
  return VG_OK;
}

/* Numbers the edges by ascending ends. Takes over e->of_half. */
static vg_status number_edges(struct vg_interface *f,
                              const uint32_t (*corner)[3], struct vg_edges *e,
                              struct vg_error *err)
{
  f->edge = (uint32_t(*)[3])e->of_half;
  e->of_half = NULL;
  f->n_edge = e->n;
  f->end = vg_alloc(e->n, sizeof *f->end);
  f->n_around = vg_alloc(e->n, sizeof *f->n_around);
  if (!f->end || !f->n_around) return vg_fail_memory(err, "the interfaces");
  for (size_t i = 0; i < e->n; i++) {
    uint32_t half = *vg_edges_at(e, i);

    f->end[i][0] = vg_half_from(corner, half);
    f->end[i][1] = vg_half_to(corner, half);
    vg_order2(&f->end[i][0], &f->end[i][1]);
    f->n_around[i] = vg_edges_count(e, i);
  }
  return VG_OK;
}

vg_status vg_interface_list(const struct vg_coarse *c, struct vg_interface *f,
                            struct vg_error *err)
{
  struct vg_edges e = VG_EDGES_INIT;
  uint32_t(*corner)[3] = NULL;
  vg_status st;

  assert(c->part && !f->n_edge && !f->edge && !f->end && !f->n_around);
  VG_TRY(list_sides(c, f, err));
  corner = vg_alloc(f->n_face, sizeof *corner);
  if (!corner) VG_TRY(vg_fail_memory(err, "the interfaces"));
  for (size_t i = 0; i < f->n_face; i++)
    vg_interface_corners(c, f, i, corner[i]);
  VG_TRY(vg_edges_build(&e, c->t.n_point, f->n_face,
                        (const uint32_t(*)[3])corner, NULL, 0, err));
  st = number_edges(f, (const uint32_t(*)[3])corner, &e, err);
done:
  vg_edges_release(&e);
  free(corner);
  return st;
}
