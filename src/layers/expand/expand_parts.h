/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* layers/expand/expand_parts.h: private to expand*.c. */
#ifndef VG_LAYERS_EXPAND_EXPAND_PARTS_H
#define VG_LAYERS_EXPAND_EXPAND_PARTS_H

#include "layers/expand/expand.h"

/** Counts the cells: sets cell[] and n_cell. */
void vg_expand_count(struct vg_expand *e);

#endif
