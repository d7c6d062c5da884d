/* partition/advance/coarse.h: the coarse mesh of the discrete decomposition,
 * made as any mesh is: cut by planes and filled by all workers. Private to
 * partition/advance. */
#ifndef VG_PARTITION_ADVANCE_COARSE_H
#define VG_PARTITION_ADVANCE_COARSE_H

#include "partition/cut/node.h"

/** For the void of root, which rank 0 has; others give NULL. Collective.
 * c: empty; on rank 0 the mesh, in the order of root's front; by
 * vg_coarse_cells_release.
 * spans out: what its tasks were, as those of a void "1" (the mesh's own is
 * "0") that make none of the mesh's cells; empty before; may be NULL. Follows
 * from the input alone. VG_ERR_STOPPED: as asked; VG_ERR_GEOMETRY,
 * VG_ERR_UNSUPPORTED: there is none, with the reason and a remedy. */
vg_status vg_coarse_mesh(struct vg_partition *p, struct vg_comm *comm,
                         const struct vg_node *root, struct vg_coarse_cells *c,
                         struct vg_spans *spans, struct vg_error *err);

/** What was done for the coarse mesh before what was done for the mesh, whose
 * first task waits for it: *spans is both then, *before empty. VG_ERR_MEMORY.
 */
vg_status vg_coarse_record(struct vg_spans *before, struct vg_spans *spans,
                           struct vg_error *err);

#endif
