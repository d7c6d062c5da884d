/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* partition/advance/advance.h: the advancing partition: separator zones of
 * final cells cut a void until the voids between them are small, and these are
 * filled, as tasks over ranks and threads. Uses core, load.h, lattice.h,
 * engine.h, store.h.
 *
 * Tasks of a node, a void with path p ("0" is the whole void, "0.2" its third
 * child): pJ0 plans planes and selects the parts of the front that lines and
 * tiles need. pP.. grow pencils (edge separators) along the lines, and pT..
 * tiles (face separators) of the planes between them. pJ1, pJ2, ... insert
 * their changes into the front, in the order of their numbers. After the last
 * stage the void is split into p.0, p.1, ..., each of which is cut again or
 * filled: p.0L. Between these steps, tiles with further numbers close places
 * where subdomains are still connected. A cut costs the time of its zones; the
 * front of the node is only copied at memory speed. */
#ifndef VG_PARTITION_ADVANCE_ADVANCE_H
#define VG_PARTITION_ADVANCE_ADVANCE_H

#include "base/comm.h"
#include "core/mesh/mesh.h"
#include "core/mesh/slices.h"
#include "core/sizing/sizing.h"
#include "partition/cut/partition.h"
#include "partition/engine/spans.h"

/** Fills the region enclosed by the triangles of `front`. Collective.
 *
 * @param front  closed, free of intersections, the same on every rank; its
 *   arrays are borrowed until vg_partition_free
 * @param spans  see vg_engine_run
 * The cells depend on front, sizing, rule, levels and sweeps alone.
 * Returns on all ranks alike: VG_ERR_STOPPED on request; VG_ERR_GEOMETRY;
 * VG_ERR_UNSUPPORTED beyond max_cells or 2^32 - 1 points. */
vg_status vg_partition_grow(struct vg_comm *comm, const struct vg_mesh *front,
                            const struct vg_sizing *sizing,
                            const struct vg_partition_options *options,
                            struct vg_partition **out,
                            struct vg_partition_report *report,
                            struct vg_spans *spans, struct vg_error *err);

/** The mesh in slices: one for each task that made cells, in the order of their
 * paths, and on rank 0 one without cells that owns the points of the front,
 * which come first. Valid until vg_partition_free. */
const struct vg_slices *vg_partition_slices(const struct vg_partition *p);

/** Copies the coordinates of the points of `front` again after they changed.
 * Cells keep their points. */
void vg_partition_move_front(struct vg_partition *p);

/** Number of cells of each leaf of this rank. sizes out: [*n], owned by the
 * caller. */
vg_status vg_partition_leaves(const struct vg_partition *p, size_t *n,
                              uint64_t **sizes, struct vg_error *err);

void vg_partition_free(struct vg_partition *p);

#endif
