/* core/mesh/mesh_defects.h: checks of a mesh that a stage of the program has
 * made (base/checks.h). Files are checked where they are read. Uses mesh.h. */
#ifndef VG_CORE_MESH_DEFECTS_H
#define VG_CORE_MESH_DEFECTS_H

#include "core/mesh/mesh.h"

/** Number of nodes and patches of boundary faces that are out of range.
 * O(faces). */
size_t vg_mesh_bad_faces(const struct vg_mesh *m);

/** Number of edges that boundary faces do not use equally often in both
 * directions; 0 when the boundary is closed and oriented. SIZE_MAX when memory
 * is refused. O(faces). All nodes must be in range. */
size_t vg_mesh_open_edges(const struct vg_mesh *m);

#endif
