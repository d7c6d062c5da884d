/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/remesh/result.h: converts a remeshed surface to a mesh. Private to
 * core/remesh. */
#ifndef VG_CORE_REMESH_RESULT_H
#define VG_CORE_REMESH_RESULT_H

#include "core/remesh/remesh.h"
#include "core/remesh/work.h"

/** Store the surface in the empty mesh *out, with the patches of `given` in the
 * same order. Adds edge statistics and bad triangles to *r. */
vg_status vg_result_store(const struct vg_tris *w, const struct vg_mesh *given,
                          struct vg_mesh *out, struct vg_remesh_report *r,
                          struct vg_error *err);

#endif
