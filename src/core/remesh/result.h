/* core/remesh/result.h: a finished surface as a mesh. Private to core/remesh.
 * */
#ifndef VG_CORE_REMESH_RESULT_H
#define VG_CORE_REMESH_RESULT_H

#include "core/remesh/remesh.h"
#include "core/remesh/work.h"

/** The surface into the empty mesh *out, patches (with all their triangles'
 * numbers) as `given` has them; edges and bad triangles into *r. */
vg_status vg_result_store(const struct vg_tris *w, const struct vg_mesh *given,
                          struct vg_mesh *out, struct vg_remesh_report *r,
                          struct vg_error *err);

#endif
