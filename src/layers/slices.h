/* layers/slices.h: vg_layers_join for a field that is in slices: layers are
 * expanded slice by slice, on whichever rank asks. Uses core/slices.h. */
#ifndef VG_LAYERS_SLICES_H
#define VG_LAYERS_SLICES_H

#include "core/slices.h"
#include "layers/join.h"

/** The mesh of layers and field, in the order of vg_layers_join.
 *
 * Every rank has the same surface and layers; the field's slices are shared
 * out. The slices of the layers (runs of about 64 k cells, from the numbering
 * alone) are shared out too: this rank serves those with number k % size ==
 * rank, besides the field's. Points of the boundary are owned by the layers'
 * slices (or, without layers, by one slice of rank 0).
 * @param field  of layers->front.mesh: its first points are the front's, in
 *               a slice without cells, which is not passed on; borrowed until
 *               closed
 * @param out    out->boundary and all else belong to *keep */
struct vg_layer_slices;
vg_status vg_layer_slices_open(const struct vg_mesh *surface,
                               const struct vg_layers *layers,
                               const struct vg_slices *field,
                               enum vg_layer_cells cells, int rank, int size,
                               int threads, struct vg_slices *out,
                               struct vg_layer_slices **keep,
                               struct vg_join_info *info,
                               struct vg_error *err);

void vg_layer_slices_close(struct vg_layer_slices *keep);

#endif
