/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* layers/relax/relax_parts.h: data of vg_layers_relax. Private. */
#ifndef VG_LAYERS_RELAX_RELAX_PARTS_H
#define VG_LAYERS_RELAX_RELAX_PARTS_H

#include "layers/relax/relax.h"

/* Square of the least sine of the dihedral angles of a cell that is not
 * flat: 10 degrees, or 170. */
#define VG_RELAX_FLAT 0.0301536896

/* A cell of the field at a top that may move. */
struct vg_relax_cell {
  uint32_t id[4]; /* Points of the field. */
  double x[4][3];
};

/* A column that was lowered. */
struct vg_relax_move {
  uint64_t column;
  double cap;
};

/** Column whose top is point `id` of the field; VG_NO_INDEX: not a top. */
static inline uint32_t vg_relax_column_of(const struct vg_front *f, uint32_t id)
{
  return id < f->n_point ? vg_layer_column_of(f->id[id]) : VG_NO_INDEX;
}

/** Whether lowering a column may move its top. */
static inline int vg_relax_may_move(const struct vg_column *c)
{
  return c->n > 1 && c->bent == SIZE_MAX;
}

/** Lowers columns until no move improves the worst cell of a top.
 *
 * @param mark  [n_column] 1: the column may move
 * @param cell  [n_cell] all cells of the field at the tops of these columns, in
 *              any order; sorted
 * @param move  out: [*n_move] columns lowered, ascending; owned by the caller
 * VG_ERR_MEMORY. */
vg_status vg_relax_tops(const struct vg_mesh *surface,
                        const struct vg_layers *layers, const uint8_t *mark,
                        size_t n_cell, struct vg_relax_cell *cell,
                        size_t *n_move, struct vg_relax_move **move,
                        struct vg_relax_report *report, struct vg_error *err);

#endif
