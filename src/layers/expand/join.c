/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Merges layers and field into one mesh in memory. */
#include "layers/expand/join.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "layers/expand/join_plan.h"

#define FIELD_GRAIN 65536
#define BLOCK_GRAIN 8 /* Blocks of faces that a thread takes at a time. */

struct join {
  const struct vg_mesh *field;
  struct vg_join_plan plan;
  struct vg_mesh *m;
};

static vg_status place_points(struct join *j, struct vg_error *err)
{
  const struct vg_join_plan *p = &j->plan;
  size_t n_front = p->front->n_point;
  size_t n_field = j->field->n_point - n_front;

  j->m->point = vg_alloc(p->n_point, sizeof *j->m->point);
  if (!j->m->point) return vg_fail_memory(err, "the points of the mesh");
  j->m->n_point = p->n_point;
  vg_join_plan_points(p, 0, j->m->point);
  if (n_field)
    memcpy(j->m->point[p->first_field], j->field->point[n_front],
           n_field * sizeof *j->m->point);
  return VG_OK;
}

static void fill_layers(void *context, size_t first, size_t end, int worker)
{
  const struct join *j = context;
  const struct vg_expand *e = &j->plan.expand;
  const struct vg_columns *c = e->columns;
  size_t last = end * VG_FACE_BLOCK < c->n_face ? end * VG_FACE_BLOCK
                                                : c->n_face;
  struct vg_cell_sink s = { NULL, NULL, NULL, NULL };

  (void)worker;
  if (e->n_cell[VG_KIND_TET]) s.tet = j->m->tet + e->cell[VG_KIND_TET][first];
  if (e->n_cell[VG_KIND_PYR]) s.pyr = j->m->pyr + e->cell[VG_KIND_PYR][first];
  if (e->n_cell[VG_KIND_PRI]) s.pri = j->m->pri + e->cell[VG_KIND_PRI][first];
  if (e->n_cell[VG_KIND_HEX]) s.hex = j->m->hex + e->cell[VG_KIND_HEX][first];
  for (size_t i = first * VG_FACE_BLOCK; i < last; i++) {
    const uint32_t *f = c->face[i];
    const uint32_t foot[3] = { e->foot[f[0]], e->foot[f[1]], e->foot[f[2]] };
    const uint32_t base[3] = { e->base[f[0]], e->base[f[1]], e->base[f[2]] };

    vg_expand_face(e, i, foot, base, &s);
  }
}

static void fill_field(void *context, size_t first, size_t end, int worker)
{
  const struct join *j = context;
  const struct vg_join_plan *p = &j->plan;
  size_t n_front = p->front->n_point;
  uint32_t(*tet)[4] = j->m->tet + p->expand.n_cell[VG_KIND_TET];

  (void)worker;
  for (size_t i = first; i < end; i++)
    for (int k = 0; k < 4; k++) {
      uint32_t v = j->field->tet[i][k];

      tet[i][k] = v < n_front ? p->id[v]
                              : (uint32_t)(p->first_field + (v - n_front));
    }
}

static vg_status make_cells(struct join *j, struct vg_error *err)
{
  const struct vg_expand *e = &j->plan.expand;
  struct vg_mesh *m = j->m;

  m->n_tet = e->n_cell[VG_KIND_TET] + j->field->n_tet;
  m->n_pyr = e->n_cell[VG_KIND_PYR];
  m->n_pri = e->n_cell[VG_KIND_PRI];
  m->n_hex = e->n_cell[VG_KIND_HEX];
  m->tet = vg_alloc(m->n_tet, sizeof *m->tet);
  if (m->n_pyr) m->pyr = vg_alloc(m->n_pyr, sizeof *m->pyr);
  if (m->n_pri) m->pri = vg_alloc(m->n_pri, sizeof *m->pri);
  if (m->n_hex) m->hex = vg_alloc(m->n_hex, sizeof *m->hex);
  if (!m->tet || (m->n_pyr && !m->pyr) || (m->n_pri && !m->pri) ||
      (m->n_hex && !m->hex))
    return vg_fail_memory(err, "the cells of the mesh");
  vg_parallel_for(e->threads, e->n_block, BLOCK_GRAIN, fill_layers, j);
  vg_parallel_for(e->threads, j->field->n_tet, FIELD_GRAIN, fill_field, j);
  return VG_OK;
}

vg_status vg_layers_join(const struct vg_mesh *surface,
                         const struct vg_layers *layers,
                         const struct vg_mesh *field, enum vg_layer_cells cells,
                         int threads, struct vg_mesh *out,
                         struct vg_join_info *info, struct vg_error *err)
{
  assert(threads >= 0 && out);

  struct vg_mesh m = VG_MESH_INIT;
  struct join j = { .field = field, .m = &m };
  double start = vg_clock();
  vg_status st;

  VG_TRY(vg_join_check_field(&layers->front, field->n_point, field->n_tri,
                             field->n_pyr + field->n_pri + field->n_hex, err));
  VG_TRY(vg_join_plan_open(&j.plan, surface, layers,
                           field->n_point - layers->front.n_point, cells,
                           threads, err));
  vg_mesh_move(&m, &j.plan.boundary);
  VG_TRY(place_points(&j, err));
  VG_TRY(make_cells(&j, err));
  vg_mesh_move(out, &m);
  vg_join_plan_describe(&j.plan, vg_clock() - start, info);
done:
  vg_mesh_release(&m);
  vg_join_plan_close(&j.plan);
  return st;
}
