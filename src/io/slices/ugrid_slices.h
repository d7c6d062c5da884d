/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/slices/ugrid_slices.h: a binary .ugrid as a mesh in slices, which are read
 * when they are needed. */
#ifndef VG_IO_SLICES_UGRID_SLICES_H
#define VG_IO_SLICES_UGRID_SLICES_H

#include "core/mesh/slices.h"
#include "io/mesh/format.h"

struct vg_ugrid_slices;

/** Open a mesh in slices of about `slice_cells` cells, with the cells and faces
 * of vg_mesh_read in the same order, and with names and conditions. The whole
 * file is read once, slice by slice, to orient the boundary and to check the
 * indices.
 *
 * Memory: the boundary with the points up to its last one, and per thread that
 * uses the slices one slice with its points.
 * @param out     NULL if the file must be read as a whole: text, compressed, or
 *                with Fortran records; without cells; with boundary faces
 *                between two cells, or sheets in STEM.sheets; or not valid, so
 * that vg_mesh_read gives the reason. To be closed by the caller.
 * @param info    as of vg_mesh_read, but turned.loose_face is 0
 * VG_ERR_IO, VG_ERR_MEMORY; the errors of a .mapbc. */
vg_status vg_ugrid_slices_open(const char *path, size_t slice_cells,
                               struct vg_ugrid_slices **out,
                               struct vg_read_info *info, struct vg_error *err);
void vg_ugrid_slices_close(struct vg_ugrid_slices *u);

/** The mesh, valid until the file is closed. n_layer_cell is the number of
 * layer tetrahedra in the tail, 0 without one. Points of the boundary may have
 * any numbers; n_boundary_point is the number after the last of them. */
const struct vg_slices *vg_ugrid_slices(const struct vg_ugrid_slices *u);

/** Its boundary, with the points up to the last one of the boundary; the arrays
 * are borrowed. */
struct vg_mesh vg_ugrid_slices_boundary(const struct vg_ugrid_slices *u);

/** Lower and upper corner of the bounding box of all points. */
void vg_ugrid_slices_bounds(const struct vg_ugrid_slices *u, double lo[3],
                            double hi[3]);

#endif
