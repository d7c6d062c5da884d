/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/input/share.h: distributes data of the first rank of a node to its other
 * ranks. Uses base/comm.h, core/mesh/mesh.h. */
#ifndef VG_RUN_INPUT_SHARE_H
#define VG_RUN_INPUT_SHARE_H

#include "base/comm.h"
#include "core/mesh/mesh.h"

/** Shares the boundary of the first rank of a node, and a number, with all its
 * ranks, as a single copy where the ranks can share memory (base/comm.h). The
 * boundary is read-only afterwards. Collective over the node; does nothing if
 * the rank is alone on its node.
 *
 * @param m       its arrays are in `common` afterwards: m is not released
 * @param common  vg_shmem_release; untouched on failure, as are the other
 *                arguments. All ranks of the node report a failure */
vg_status vg_surface_share(struct vg_comm *c, struct vg_mesh *m,
                           uint64_t *number, struct vg_shmem *common,
                           struct vg_error *err);

/** Converts a boundary of triangles and a number to bytes and back, bitwise.
 * VG_ERR_MEMORY; VG_ERR_FORMAT for invalid bytes. Outputs are untouched on
 * failure; *m is replaced on success. */
vg_status vg_surface_pack(const struct vg_mesh *m, uint64_t number,
                          struct vg_bytes *out, struct vg_error *err);
vg_status vg_surface_unpack(const struct vg_bytes *bytes, struct vg_mesh *m,
                            uint64_t *number, struct vg_error *err);

/** Sends the boundary of rank 0 to the ranks with `takes`, where it replaces
 * *m. Collective over all ranks. All ranks get the same status, which includes
 * the status st of rank 0 before the call. */
vg_status vg_surface_bcast(struct vg_comm *c, int takes, vg_status st,
                           struct vg_mesh *m, struct vg_error *err);

#endif
