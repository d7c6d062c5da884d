/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* partition/cut/needles.h: planes that sliver triangles of the front rule out.
 * Private to cut. */
#ifndef VG_PARTITION_CUT_NEEDLES_H
#define VG_PARTITION_CUT_NEEDLES_H

#include "partition/cut/lattice.h"
#include "partition/cut/task_data.h"

/** Does a plane of the lattice cross needles (triangles a hundred times as long
 * as high) that are a large share of the front's faces? The cells on such
 * triangles are as thin as the triangles, and cannot be closed along a plane
 * with points one spacing apart; planes along the needles give no better
 * result. Such a void is not cut. O(faces). */
int vg_crosses_needles(const struct vg_front *front,
                       const struct vg_lattice *l);

#endif
