/* layers/expand/slices.h: vg_layers_join for a field that is in slices: layers
 * are expanded slice by slice, on whichever rank asks. Uses core/mesh/slices.h.
 * */
#ifndef VG_LAYERS_EXPAND_SLICES_H
#define VG_LAYERS_EXPAND_SLICES_H

#include "base/comm.h"
#include "core/mesh/slices.h"
#include "layers/expand/join.h"

/** The mesh of layers and field, in the order of vg_layers_join.
 *
 * Every rank has the same surface and layers; the field's slices are shared
 * out. The slices of the layers are shared out too: each rank serves some that
 * follow each other, before the field's. First come those of the boundary's
 * points, 16 k each, without cells; then runs of faces with all that stands on
 * them, at least 256 k cells each. Both follow from the layers alone.
 *
 * Kept per rank: the surface's and front's numbers, columns', and the
 * boundary with its points, all O(surface). A slice at hand costs its own
 * cells and points.
 * @param field  of the void within layers->front, whose points come first. They
 *               are taken out of the slices that own them; what then has
 *               neither points nor cells is passed on as an empty slice.
 *               Borrowed until closed, as are surface and layers
 * @param out    out->boundary and all else belong to *keep
 * @param info   may be NULL
 * Fails as vg_layers_join does, and then leaves *out and *keep untouched. */
struct vg_layer_slices;
vg_status vg_layer_slices_open(const struct vg_mesh *surface,
                               const struct vg_layers *layers,
                               const struct vg_slices *field,
                               enum vg_layer_cells cells, int rank, int size,
                               int threads, struct vg_slices *out,
                               struct vg_layer_slices **keep,
                               struct vg_join_info *info, struct vg_error *err);

/** Share the slices of the layers out anew, so that with the field's all ranks
 * take nearly as long to judge theirs. The same call on every rank.
 * @param n_field  [size] cells of the field that each rank serves
 * @param out      as from vg_layer_slices_open */
void vg_layer_slices_share(struct vg_layer_slices *keep,
                           const uint64_t *n_field, struct vg_slices *out);

/** How cells change in size across the tops of the layers, in a valid mesh.
 * Collective; each rank looks at what it serves of the field.
 *
 * @param ratio  out: [columns.n_face], on all ranks: the larger over the
 *               smaller volume of the cells on both sides of the top of a
 *               face; 0: the face has no cell, or its top no other side
 * Memory: 16 bytes per triangle of the front. VG_ERR_MEMORY. */
vg_status vg_layer_slices_tops(struct vg_comm *comm,
                               const struct vg_layer_slices *keep,
                               double *ratio, struct vg_error *err);

/** [surface n_point] the point of the mesh that each of the surface is;
 * VG_NO_INDEX: none, a slide patch was re-meshed there. On every rank, valid
 * until closed. */
const uint32_t *vg_layer_slices_roots(const struct vg_layer_slices *keep);

/** Accepts NULL. */
void vg_layer_slices_close(struct vg_layer_slices *keep);

#endif
