/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Volumes on both sides of the tops of the layers.
 *
 * The points of the front come first in the field, so a cell of the field on a
 * top has three points of the front. A table of the triangles of the front
 * identifies the top, and the columns give the cell below it. */
#include <stdlib.h>
#include <string.h>

#include "base/table.h"
#include "base/tri_key.h"
#include "core/judge/quality.h"
#include "layers/expand/pairs.h"
#include "layers/expand/slices_parts.h"

struct tops {
  const struct vg_join_plan *p;
  struct vg_table table; /* Triangles of the front that are tops. */
  double *ratio;         /* [n_face] each top has one cell of the field, so only
                            one thread writes an entry. */
};

/* Slot of a triangle in the table, occupied or free. */
static uint32_t *find(const struct tops *t, const uint32_t v[3])
{
  const uint32_t(*tri)[3] = (const uint32_t(*)[3])t->p->front->face;
  struct vg_tri_key key = vg_tri_key(v);
  uint32_t *at;

  VG_TABLE_FIND(&t->table, at, vg_tri_key_hash(key),
                vg_tri_key_same(vg_tri_key(tri[*at]), key));
  return at;
}

static vg_status make_table(struct tops *t, struct vg_error *err)
{
  const struct vg_front *f = t->p->front;

  if (vg_table_init(&t->table, f->n_face))
    return vg_fail_memory(err, "the tops of the layers");
  for (size_t i = 0; i < f->n_face; i++)
    if (f->face_id[i] != VG_NO_INDEX) *find(t, f->face[i]) = (uint32_t)i;
  return VG_OK;
}

/* Volume of the layer cell at the top of a face; 0 if the face has no cell. */
static double volume_below(const struct tops *t, size_t face)
{
  const struct vg_columns *c = t->p->columns;
  double d[VG_LEVELS_MAX + 1], column[VG_LEVELS_MAX + 1][3], x[7][3];
  uint32_t node[6];
  int n_node = vg_expand_top(&t->p->expand, face, node);

  if (!n_node) return 0;
  for (int k = 0; k < 3; k++) {
    uint32_t i = c->face[face][k];
    unsigned n = c->column[i].n;

    vg_column_points(c, t->p->surface, i, d, column);
    memcpy(x[k], column[n ? n - 1 : 0], sizeof *x);
    memcpy(x[3 + k], column[n], sizeof *x);
  }
  if (t->p->expand.partner && t->p->expand.partner[face] != VG_NO_INDEX)
    vg_pair_middle(&t->p->expand, t->p->surface, face, x[6]);
  return vg_cell_volume((const double(*)[3])x, n_node - 4, node);
}

static void meet(const struct tops *t, const struct vg_slice *s,
                 const uint32_t cell[4], const uint32_t v[3])
{
  static const uint32_t whole[4] = { 0, 1, 2, 3 };
  const struct vg_front *f = t->p->front;
  uint32_t i = *find(t, v);
  double x[4][3], above, below;

  if (i == VG_TABLE_FREE) return;
  below = volume_below(t, f->face_id[i]);
  if (!(below > 0)) return;
  for (int k = 0; k < 4; k++) memcpy(x[k], s->x[cell[k]], sizeof *x);
  above = vg_cell_volume((const double(*)[3])x, 0, whole);
  t->ratio[f->face_id[i]] = above > below ? above / below : below / above;
}

static vg_status look_through(void *context, const struct vg_slice *s,
                              struct vg_error *err)
{
  const struct tops *t = context;
  const uint32_t(*tet)[4] = (const uint32_t(*)[4])s->cell[VG_SLICE_TET];
  size_t n_front = t->p->front->n_point;

  (void)err;
  for (size_t i = 0; i < s->n_cell[VG_SLICE_TET]; i++) {
    uint32_t v[4];
    int n = 0;

    for (int k = 0; k < 4; k++) {
      v[k] = s->id[tet[i][k]];
      n += v[k] < n_front;
    }
    for (int k = 0; k < 4 && n >= 3; k++) {
      const uint32_t face[3] = { v[(k + 1) % 4], v[(k + 2) % 4],
                                 v[(k + 3) % 4] };

      if (n == 4 || v[k] >= n_front) meet(t, s, tet[i], face);
    }
  }
  return VG_OK;
}

vg_status vg_layer_tops(struct vg_comm *comm, const struct vg_join_plan *p,
                        const struct vg_slices *field, double *ratio,
                        struct vg_error *err)
{
  struct tops t = { .p = p, .ratio = ratio };
  vg_status st;

  memset(ratio, 0, p->columns->n_face * sizeof *ratio);
  VG_TRY(make_table(&t, err));
  st = vg_slices_each(field, p->expand.threads, look_through, &t, err);
done:
  vg_table_release(&t.table);
  st = vg_comm_agree(comm, st, err);
  return st < 0 ? st : vg_comm_max(comm, p->columns->n_face, ratio, err);
}
