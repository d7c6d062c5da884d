/* core/recover/recover.h: surface triangles that are missing from Delaunay
 * tetrahedra are put in, by flips or pocket by pocket. */
#ifndef VG_CORE_RECOVER_RECOVER_H
#define VG_CORE_RECOVER_RECOVER_H

#include <stddef.h>
#include <stdint.h>

#include "core/delaunay/tets.h"
#include "core/recover/boundary.h"

/** Make every triangle a fixed face of t.
 *
 * Flips bring in most (core/recover/recover_flip.h). The cells that a triangle
 * still missing passes through form its pocket; pockets that share cells are
 * one. TetGen closes each pocket, its border and every triangle in it kept; the
 * result is verified face by face before it replaces the pocket's cells. A
 * pocket that fails grows by a ring of cells and is tried again, three times.
 * Returns VG_ERR_GEOMETRY when pockets remain that cannot be closed, or one is
 * so large that the whole surface is the better start. */
vg_status vg_recover(struct vg_tets *t, size_t n_tri, const uint32_t (*tri)[3],
                     struct vg_boundary_report *report, struct vg_error *err);

/** Flip faces of t that are not locally Delaunay, fixed ones excepted, until
 * none is left that a flip brings nearer to it: points inserted afterwards
 * (core/delaunay/insert.h) start from Delaunay cells. No edge or face of the
 * surface is lost while all its triangles are fixed faces.
 * n_before, before  cells as they were when all faces were locally Delaunay;
 *                   those that still are the same are not looked at again
 * n_flip out: flips made */
vg_status vg_recover_delaunay(struct vg_tets *t, size_t n_before,
                              const struct vg_cell *before, size_t *n_flip,
                              struct vg_error *err);

#endif
