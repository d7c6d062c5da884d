/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* layers/expand/slices_parts.h: private to slices*.c. */
#ifndef VG_LAYERS_EXPAND_SLICES_PARTS_H
#define VG_LAYERS_EXPAND_SLICES_PARTS_H

#include "base/comm.h"
#include "core/mesh/slices.h"
#include "layers/expand/join_plan.h"

/** Memory owned by a slice in use. */
struct vg_layer_slice {
  struct vg_slice field; /* Slice of the field, to be returned to it, if
                            is_field. */
  int is_field;
  double (*x)[3];
  uint32_t *id, *own, *cell[VG_SLICE_KINDS];
};

/** Makes cells and new points of the blocks of faces first .. end - 1. Fills
 * `s` except for kind and keep; the arrays belong to `at`, even on failure. */
vg_status vg_layer_slice_expand(const struct vg_join_plan *p, size_t first,
                                size_t end, struct vg_layer_slice *at,
                                struct vg_slice *s, struct vg_error *err);

/** vg_layer_slices_tops, for slices numbered as in the field. */
vg_status vg_layer_tops(struct vg_comm *comm, const struct vg_join_plan *p,
                        const struct vg_slices *field, double *ratio,
                        struct vg_error *err);

#endif
