/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* layers/expand/expand_defects.h: checks of columns made by a stage
 * (base/checks.h). Uses columns.h, core/judge/quality.h. */
#ifndef VG_LAYERS_EXPAND_DEFECTS_H
#define VG_LAYERS_EXPAND_DEFECTS_H

#include "layers/columns/columns.h"

/** Number of violations of the invariants that columns.h states: indices out of
 * range, columns not sorted by root, faces out of order or with a repeated
 * column, boundary edges whose columns do not slide in their patch, and cells
 * of the lift rule without positive volume. O(cells). */
size_t vg_columns_defects(const struct vg_columns *c,
                          const struct vg_mesh *surface);

#endif
