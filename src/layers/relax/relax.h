/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* layers/relax/relax.h: lowers tops of columns under flat cells of the field.
 * Uses base/comm.h, core/mesh/slices.h, layers/columns.
 *
 * The fill keeps its boundary, so a cell between tops of a concave fold, or
 * close above a top, may stay flat whatever happens to the points of the field.
 * Lowering a top along its column makes all cells above it thicker:
 *
 *           p                    p
 *        . ' ' .              .' | '.
 *      a---------b          a'   |   'b       the cell a b p, in a section
 *      |         |          |'-. | .-'|
 *      |         |          |   'c'   |       tops of columns
 *
 * A column keeps its number of levels and its first height, and grows more
 * slowly (its cap is reduced). Points and cells therefore keep their numbers. A
 * move is accepted if it improves the worst cell of the field at the top, does
 * not increase the number of flat cells there, and leaves all layer cells of
 * the column sound, in both kinds of output. Points of the field in flat cells
 * at such tops move as well, under the same condition, since the fill placed
 * them for the old tops. */
#ifndef VG_LAYERS_RELAX_RELAX_H
#define VG_LAYERS_RELAX_RELAX_H

#include "base/comm.h"
#include "core/mesh/slices.h"
#include "layers/columns/layers.h"

struct vg_relax_report {
  uint64_t n_flat, n_left; /* Flat cells with a top that may move: before and
                              after. */
  uint64_t n_column;       /* Columns that were lowered. */
  uint64_t n_point;        /* Points of the field that were moved. */
};

/** Collective. Changes cap and compressed of some columns, and the coordinates
 * of their tops in layers->front; copies of these coordinates elsewhere are the
 * caller's to update, as are those of moved points. The result depends on
 * layers and cells only.
 *
 * @param field  mesh of the void within layers->front, whose points come first;
 *               O(cells) to visit, and memory for the cells at the tops of flat
 *               cells on all ranks together
 * @param n_point, point  out: [*n_point] points of the field that moved,
 *               ascending, the same on all ranks; owned by the caller
 * VG_ERR_MEMORY. */
vg_status vg_layers_relax(struct vg_comm *comm, const struct vg_mesh *surface,
                          struct vg_layers *layers,
                          const struct vg_slices *field, int threads,
                          size_t *n_point, struct vg_slices_point **point,
                          struct vg_relax_report *report, struct vg_error *err);

#endif
