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

/* Points that may move, and the cells at them. */
struct vg_relax_input {
  const uint8_t *mark; /* [n_column] 1: the column may move. */
  size_t n_id;
  const uint32_t *id; /* [n_id] Points of the field that may move, ascending. */
  size_t n_cell;
  struct vg_relax_cell *cell; /* [n_cell] All cells of the field at these tops
                                 and points, in any order; sorted. */
};

struct vg_relax_result {
  size_t n_move, n_point;
  struct vg_relax_move *move; /* [n_move] owned; columns lowered, ascending. */
  struct vg_slices_point *point; /* [n_point] owned; ascending. */
};

/** Lowers columns and moves points until no move improves the worst cell of a
 * top or a point. On failure *out is unchanged. VG_ERR_MEMORY. */
vg_status vg_relax_tops(const struct vg_mesh *surface,
                        const struct vg_layers *layers,
                        const struct vg_relax_input *in,
                        struct vg_relax_result *out,
                        struct vg_relax_report *report, struct vg_error *err);

#endif
