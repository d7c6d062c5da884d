/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/domain/open_edges.h: the open edges of a surface. Private to
 * core/domain. */
#ifndef VG_CORE_DOMAIN_OPEN_EDGES_H
#define VG_CORE_DOMAIN_OPEN_EDGES_H

#include "core/domain/farfield.h"

/** Append the edges whose two directions do not cancel, directed as a surface
 * that closes m runs along them. Triangles and quadrilaterals; O(n log
 * valence).
 *
 * @param open  appended to
 * VG_ERR_GEOMETRY if triangles at an edge run along it in the same
 * direction. */
vg_status vg_open_edges(const struct vg_mesh *m, struct vg_border *open,
                        struct vg_error *err);

#endif
