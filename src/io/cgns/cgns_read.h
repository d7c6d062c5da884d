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

#endif
