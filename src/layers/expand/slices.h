/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* layers/expand/slices.h: vg_layers_join for a field in slices. Layers are
 * expanded slice by slice, on the rank that requests a slice. Uses
 * core/mesh/slices.h. */
#ifndef VG_LAYERS_EXPAND_SLICES_H
#define VG_LAYERS_EXPAND_SLICES_H

#include "base/comm.h"
#include "core/mesh/slices.h"
#include "layers/expand/join.h"

/** The mesh of layers and field, in the order of vg_layers_join.
 *
 * Every rank has the same surface and layers, and serves some slices of the
 * field. The slices of the layers are distributed as well: each rank serves a
 * consecutive range of them, before those of the field. The first slices
 * contain the boundary points, 16 k each, without cells; the next slices are
 * runs of faces with all their cells and new points, at least 256 k cells each.
 * Both depend only on the layers.
 *
 * Each rank keeps the numbers of surface, front and columns, and the boundary
 * with its points, all O(surface). A slice in memory takes the space of its own
 * cells and points.
 *
 * @param field  mesh of the void within layers->front, whose points come first.
 *               They are removed from the slices that own them; a slice that
 *               then has neither points nor cells is passed on as an empty
 *               slice. Borrowed until closed, as are surface and layers
 * @param out    out->boundary and all other data belong to *keep
 * @param info   may be NULL
 *
 * Fails under the same conditions as vg_layers_join, and then leaves *out and
 * *keep untouched. */
struct vg_layer_slices;
vg_status vg_layer_slices_open(const struct vg_mesh *surface,
                               const struct vg_layers *layers,
                               const struct vg_slices *field,
                               enum vg_layer_cells cells, int rank, int size,
                               int threads, struct vg_slices *out,
                               struct vg_layer_slices **keep,
                               struct vg_join_info *info, struct vg_error *err);

/** Redistributes the slices of the layers so that, together with the slices of
 * the field, all ranks need nearly the same time for the mesh check. Every
 * rank must make the same call.
 * @param n_field  [size] cells of the field that each rank serves
 * @param out      from vg_layer_slices_open */
void vg_layer_slices_share(struct vg_layer_slices *keep,
                           const uint64_t *n_field, struct vg_slices *out);

/** Volume ratios of the cells across the tops of the layers, in a valid mesh.
 * Collective; each rank visits the slices of the field that it serves.
 *
 * @param ratio  out: [columns.n_face], on all ranks: the larger over the
 *               smaller volume of the two cells at the top of a face; 0 if the
 *               face has no cell, or its top no cell of the field
 *
 * Memory: 16 bytes per triangle of the front. VG_ERR_MEMORY. */
vg_status vg_layer_slices_tops(struct vg_comm *comm,
                               const struct vg_layer_slices *keep,
                               double *ratio, struct vg_error *err);

/** Prepares the classification of flat cells (core/judge/flat_cells.h) above
 * the layers. *out is freed by vg_flat_free before *keep is closed.
 * VG_ERR_MEMORY.
 */
struct vg_flat;
vg_status vg_layer_slices_flat(struct vg_layer_slices *keep,
                               struct vg_flat **out, struct vg_error *err);

/** Bytes of memory on this rank: numbers of points and cells, the boundary of
 * the mesh and its points. */
size_t vg_layer_slices_bytes(const struct vg_layer_slices *keep);

/** [surface n_point] point of the mesh for each point of the surface;
 * VG_NO_INDEX: the point no longer exists because its slide patch was
 * remeshed. On every rank, valid until closed. */
const uint32_t *vg_layer_slices_roots(const struct vg_layer_slices *keep);

/** Number of faces of the front without those of sheets on which the field is
 * on both sides. */
size_t vg_layer_slices_front(const struct vg_layer_slices *keep);

/** Accepts NULL. */
void vg_layer_slices_close(struct vg_layer_slices *keep);

#endif
