/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/periodic/periodic_cfg.h: periodic patches next to meshes in formats that
 * do not hold them. STEM.periodic.cfg is a part of SU2's configuration:
 * comments begin with %, and MARKER_PERIODIC has for each pair the two names,
 * the centre, the angles in degrees about x, y and z, in this order, and the
 * translation. */
#ifndef VG_IO_PERIODIC_PERIODIC_CFG_H
#define VG_IO_PERIODIC_PERIODIC_CFG_H

#include "core/mesh/mesh.h"
#include "core/periodic/periodic.h"

#define VG_PERIODIC_SUFFIX "periodic.cfg"

/** Write the pairs. boundary: for the names of the patches, which are those of
 * .su2. VG_ERR_IO, VG_ERR_MEMORY; no file is left on failure. */
vg_status vg_periodic_cfg_write(const char *path,
                                const struct vg_mesh *boundary, size_t n,
                                const struct vg_periodic *pair,
                                struct vg_error *err);

#endif
