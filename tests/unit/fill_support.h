/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Fill a surface with tetrahedra, for tests that need a mesh. Header only: one
 * program per module. */
#ifndef TESTS_UNIT_FILL_SUPPORT_H
#define TESTS_UNIT_FILL_SUPPORT_H

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/fill/fill.h"
#include "core/mesh/mesh.h"

/* Join the surface's boundary and points, the new points after them, and the
 * cells, which *out takes over. */
static inline vg_status fill_join(const struct vg_mesh *surface,
                                  struct vg_filled *made, struct vg_mesh *out,
                                  struct vg_error *err)
{
  struct vg_mesh bare = *surface, m = VG_MESH_INIT;
  size_t cap = surface->n_point;
  vg_status st;

  bare.n_tet = bare.n_pyr = bare.n_pri = bare.n_hex = bare.n_quad = 0;
  VG_TRY(vg_mesh_copy(&m, &bare, err));
  if (vg_reserve(&m.point, &cap, m.n_point + made->n_point, sizeof *m.point)) {
    vg_mesh_release(&m);
    return vg_fail_memory(err, "the mesh");
  }
  if (made->n_point)
    memcpy(m.point + m.n_point, made->x, made->n_point * sizeof *m.point);
  m.n_point += made->n_point;
  free(m.tet);
  m.tet = made->cell;
  m.n_tet = made->n_cell;
  made->cell = NULL;
  vg_mesh_move(out, &m);
done:
  return st;
}

/* Mesh the void that a closed surface bounds. out: empty; untouched on failure.
 * *report is cleared first. */
static inline vg_status fill_mesh(const struct vg_mesh *surface,
                                  const struct vg_sizing *sizing,
                                  const struct vg_fill_options *options,
                                  struct vg_mesh *out,
                                  struct vg_fill_report *report,
                                  struct vg_error *err)
{
  const struct vg_front front = vg_front_of(surface);
  struct vg_filled made = VG_FILLED_INIT;
  vg_status st;

  memset(report, 0, sizeof *report);
  st = vg_fill_front(&front, NULL, sizing, options, &made, report, err);
  if (st == VG_OK) st = fill_join(surface, &made, out, err);
  vg_filled_release(&made);
  return st;
}

#endif
