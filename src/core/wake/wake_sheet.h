/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/wake/wake_sheet.h: triangles that continue trailing edges along the
 * stream. Uses core/wake/trailing.h.
 *
 *      trailing edge        rows
 *          o----o----o------o--------o
 *          |\   |\   |\     |\       |
 *          | \  | \  | \    | \      |   stream -->
 *          |  \ |  \ |  \   |  \     |
 *          o----o----o------o--------o
 */
#ifndef VG_CORE_WAKE_WAKE_SHEET_H
#define VG_CORE_WAKE_WAKE_SHEET_H

#include "core/wake/trailing.h"

struct vg_wake_sheet {
  double length;  /* in local chords, > 0 */
  double row;     /* longest row in local chords, if it is longer than three
                     edges of the trailing edge */
  double flow[3]; /* direction of the stream, unit vector */
  double up[3];   /* of both edges of a blunt trailing edge, the sheet leaves
                     the upper one; unit vector */
};

/** Add a sheet to a surface.
 *
 * @param m     mesh of the trailing edges
 * @param on    [n_patch] 1: edges of this patch count
 * @param to    surface; points with the coordinates of those of the trailing
 *              edges are added, and not merged with them
 * @param patch index in to->patch of the new triangles
 *
 * The first row is as long as the mean edge of the trailing edge, the others
 * grow by a tenth. Chords and rows are those at the point of the trailing edge.
 * O(n log n). VG_ERR_MEMORY leaves *to valid. No triangles are added if no edge
 * counts. */
vg_status vg_wake_sheet_add(const struct vg_mesh *m,
                            const struct vg_trailing *t, const uint8_t *on,
                            const struct vg_wake_sheet *s, struct vg_mesh *to,
                            uint32_t patch, struct vg_error *err);

#endif
