/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/recover/recover.h: recovery of surface triangles that are missing from
 * Delaunay tetrahedra, by flips or pocket by pocket. */
#ifndef VG_CORE_RECOVER_RECOVER_H
#define VG_CORE_RECOVER_RECOVER_H

#include <stddef.h>
#include <stdint.h>

#include "core/delaunay/tets.h"
#include "core/recover/boundary.h"

/** Make every triangle a fixed face of t.
 *
 * Flips recover most triangles (core/recover/recover_flip.h). For each
 * triangle that is still missing, the cells that it passes through form its
 * pocket; pockets that share cells are merged. TetGen meshes each pocket and
 * preserves its border and every triangle in it. The result is verified face
 * by face before it replaces the pocket's cells. If that fails, the pocket
 * grows by a layer of cells and is tried again, up to three times. Returns
 * VG_ERR_GEOMETRY if pockets remain that cannot be closed, or if one is so
 * large that recovering the whole surface at once is more promising.
 *
 * @param is_delaunay  1: the cells of t are Delaunay, and are made Delaunay
 *                     again where they changed (vg_recover_delaunay)
 * @param has_inner    1: there are points in the void. Each triangle then has a
 *                     small pocket, which is closed by itself first */
vg_status vg_recover(struct vg_tets *t, size_t n_tri, const uint32_t (*tri)[3],
                     int is_delaunay, int has_inner,
                     struct vg_boundary_report *report, struct vg_error *err);

/** Flip faces of t that are not locally Delaunay, except fixed ones, until no
 * flip brings any of them closer to Delaunay. Points inserted afterwards
 * (core/delaunay/insert.h) then start from Delaunay cells. No edge or face of
 * the surface is lost while all its triangles are fixed faces.
 *
 * n_before, before: copy of the cells from when all faces were locally
 * Delaunay; faces between cells that have not changed since are not examined
 * again. n_flip out: number of flips. */
vg_status vg_recover_delaunay(struct vg_tets *t, size_t n_before,
                              const struct vg_cell *before, size_t *n_flip,
                              struct vg_error *err);

#endif
