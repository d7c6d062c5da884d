/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/cgns/cgns_read.h: converts the tree of a CGNS file to a mesh. Private to
 * its module; only called in the child process of cgns_child.c. */
#ifndef VG_IO_CGNS_READ_H
#define VG_IO_CGNS_READ_H

#include "core/mesh/mesh.h"
#include "io/stream/stream.h"

/** As vg_cgns_parse, using the HDF5 library in this process. */
vg_status vg_cgns_take(struct vg_input *in, struct vg_mesh *out,
                       struct vg_error *err);

/** Read the values of the last FlowSolution_t at the points that has an array
 * of this name, in this process.
 * @param n_point  points of the mesh of vg_cgns_take
 * @param value    out: [n_point], to be freed
 * VG_ERR_INPUT: no such array, with the names of those that there are;
 * VG_ERR_UNSUPPORTED: more than one zone. */
vg_status vg_cgns_take_solution(struct vg_input *in, const char *name,
                                size_t n_point, double **value,
                                struct vg_error *err);

#endif
