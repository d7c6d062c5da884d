/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/mesh/double_faces.h: interfaces whose two sides are parts of the
 * boundary, for solvers in which a zone moves along another one. Uses
 * zone_meshes.h. */
#ifndef VG_CORE_MESH_DOUBLE_FACES_H
#define VG_CORE_MESH_DOUBLE_FACES_H

#include "core/mesh/mesh.h"

/** Separate the zones of m along interfaces: each of these sheets becomes two
 * patches, NAME of the zones into which its triangles look and NAME_back of
 * those behind them (VG_INNER_FRONT and VG_INNER_BACK with is_interface). The
 * triangles of both are in the same order. Their points are copied for all
 * zones but the first; copies follow the other points. Cells and their order,
 * other sheets and zones stay.
 *
 * @param is_doubled  [m->n_sheet]
 * VG_ERR_INPUT: a sheet lies within a zone, or an interface that is not doubled
 * connects the zones on both sides of a doubled one. VG_ERR_UNSUPPORTED: too
 * many points, or no number for a patch. VG_ERR_MEMORY. m is unchanged on
 * failure. O(n log n + n_zone n_point). */
vg_status vg_mesh_double_faces(struct vg_mesh *m, const uint8_t *is_doubled,
                               struct vg_error *err);

#endif
