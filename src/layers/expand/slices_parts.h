/* layers/expand/slices_parts.h: private to slices*.c. */
#ifndef VG_LAYERS_EXPAND_SLICES_PARTS_H
#define VG_LAYERS_EXPAND_SLICES_PARTS_H

#include "base/comm.h"
#include "core/mesh/slices.h"
#include "layers/expand/join_plan.h"

/** What a slice at hand owns. */
struct vg_layer_slice {
  struct vg_slice field; /* of the field, to be put back; else get == 0 */
  int is_field;
  double (*x)[3];
  uint32_t *id, *own, *cell[VG_SLICE_KINDS];
};

/** Cells and new points of the blocks of faces first .. end - 1. Fills `s`
 * but for kind and keep; arrays go to `at`, also on failure. */
vg_status vg_layer_slice_expand(const struct vg_join_plan *p, size_t first,
                                size_t end, struct vg_layer_slice *at,
                                struct vg_slice *s, struct vg_error *err);

/** vg_layer_slices_tops, of slices with the field's numbers. */
vg_status vg_layer_tops(struct vg_comm *comm, const struct vg_join_plan *p,
                        const struct vg_slices *field, double *ratio,
                        struct vg_error *err);

#endif
