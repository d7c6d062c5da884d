/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/mesh/mesh_defects.h: checks of a mesh produced by a stage of the
 * program (base/checks.h). Files are checked where they are read. Uses mesh.h.
 */
#ifndef VG_CORE_MESH_DEFECTS_H
#define VG_CORE_MESH_DEFECTS_H

#include "core/mesh/mesh.h"

/** Number of node and patch indices of boundary faces that are out of range.
 * O(faces). */
size_t vg_mesh_bad_faces(const struct vg_mesh *m);

/** Number of edges that boundary faces do not use equally often in both
 * directions; 0 if the boundary is closed and consistently oriented. SIZE_MAX
 * if memory is refused. O(faces). All nodes must be in range. */
size_t vg_mesh_open_edges(const struct vg_mesh *m);

#endif
