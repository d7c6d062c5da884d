/* core/domain/open_edges.h: where a surface ends. Private to core/domain. */
#ifndef VG_CORE_DOMAIN_OPEN_EDGES_H
#define VG_CORE_DOMAIN_OPEN_EDGES_H

#include "core/domain/farfield.h"

/** Edges whose two directions do not cancel, as a surface that closes m runs
 * along them. Triangles and quads; O(n log valence).
 * @param open  appended to
 * VG_ERR_GEOMETRY where triangles at an edge run the same way. */
vg_status vg_open_edges(const struct vg_mesh *m, struct vg_border *open,
                        struct vg_error *err);

#endif
