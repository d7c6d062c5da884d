/* partition/cut/needles.h: planes that long thin triangles forbid. Private to
 * cut. */
#ifndef VG_PARTITION_CUT_NEEDLES_H
#define VG_PARTITION_CUT_NEEDLES_H

#include "partition/cut/lattice.h"
#include "partition/cut/task_data.h"

/** Is a good part of the front needles that a plane of the lattice crosses:
 * triangles a hundred times as long as high? The cells over them are as thin
 * as they, and cannot be closed along a plane with points that are a spacing
 * apart; planes along the needles fare no better. Such a void is not cut.
 * O(faces). */
int vg_crosses_needles(const struct vg_front *front,
                       const struct vg_lattice *l);

#endif
