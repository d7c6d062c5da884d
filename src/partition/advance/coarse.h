/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* partition/advance/coarse.h: the coarse mesh of the discrete decomposition,
 * made like any mesh: cut by planes and filled by all workers. Private to
 * partition/advance. */
#ifndef VG_PARTITION_ADVANCE_COARSE_H
#define VG_PARTITION_ADVANCE_COARSE_H

#include "partition/cut/node.h"

/** Makes the coarse mesh for the void of root, which rank 0 has; other ranks
 * pass NULL. Collective.
 * c: empty; on rank 0 the mesh, in the point order of root's front; release
 * with vg_coarse_cells_release.
 * spans out: its tasks, as those of a void "1" (the final mesh is "0") that
 * make no cells of the final mesh; empty before; may be NULL. The mesh depends
 * on the input alone. VG_ERR_STOPPED: on request; VG_ERR_GEOMETRY,
 * VG_ERR_UNSUPPORTED: it cannot be made, with the reason and a remedy. */
vg_status vg_coarse_mesh(struct vg_partition *p, struct vg_comm *comm,
                         const struct vg_node *root, struct vg_coarse_cells *c,
                         struct vg_spans *spans, struct vg_error *err);

/** Combines the trace of the coarse mesh with that of the final mesh, whose
 * first task waits for it: *spans then holds both, and *before is empty.
 * VG_ERR_MEMORY. */
vg_status vg_coarse_record(struct vg_spans *before, struct vg_spans *spans,
                           struct vg_error *err);

#endif
