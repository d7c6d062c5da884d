/* run/input/share.h: what the first rank of a node made, for the others of it.
 * Uses base/comm.h, core/mesh/mesh.h. */
#ifndef VG_RUN_INPUT_SHARE_H
#define VG_RUN_INPUT_SHARE_H

#include "base/comm.h"
#include "core/mesh/mesh.h"

/** The boundary of the first rank of a node and a number on all of its ranks,
 * one copy of it where the ranks can have memory in common (base/comm.h). From
 * then on it is only read. Collective over the node; nothing where a rank is
 * alone on it.
 *
 * @param m       its arrays are then those in `common`: m is not released
 * @param common  vg_shmem_release; untouched, as the others, on failure, which
 *                all ranks of the node have */
vg_status vg_surface_share(struct vg_comm *c, struct vg_mesh *m,
                           uint64_t *number, struct vg_shmem *common,
                           struct vg_error *err);

/** A boundary of triangles and a number as bytes, and back: the same bit by
 * bit. VG_ERR_MEMORY; VG_ERR_FORMAT for bytes that are none. On failure
 * outputs are untouched; *m is replaced. */
vg_status vg_surface_pack(const struct vg_mesh *m, uint64_t number,
                          struct vg_bytes *out, struct vg_error *err);
vg_status vg_surface_unpack(const struct vg_bytes *bytes, struct vg_mesh *m,
                            uint64_t *number, struct vg_error *err);

/** The boundary of rank 0 on the ranks with `takes`, whose *m it replaces.
 * Collective over all ranks; every one gets the same status, that of rank 0
 * before (st) included. */
vg_status vg_surface_bcast(struct vg_comm *c, int takes, vg_status st,
                           struct vg_mesh *m, struct vg_error *err);

#endif
