/* layers/expand/expand_defects.h: checks of columns that a stage has made
 * (base/checks.h). Uses columns.h, core/judge/quality.h. */
#ifndef VG_LAYERS_EXPAND_DEFECTS_H
#define VG_LAYERS_EXPAND_DEFECTS_H

#include "layers/columns/columns.h"

/** Number of violations of what columns.h states about *c: indices out of
 * range, columns that are not in the order of their roots, faces out of order
 * or with a repeated column, borders whose columns do not slide in their patch,
 * and cells of the lift rule that are not positive. O(cells). */
size_t vg_columns_defects(const struct vg_columns *c,
                          const struct vg_mesh *surface);

#endif
