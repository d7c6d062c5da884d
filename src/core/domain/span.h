/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/domain/span.h: closes a rim that is not plane. Private to core/domain.
 */
#ifndef VG_CORE_DOMAIN_SPAN_H
#define VG_CORE_DOMAIN_SPAN_H

#include <stddef.h>
#include <stdint.h>

#include "core/mesh/mesh.h"

#define VG_SPAN_MOST 1500 /* most points of a rim */

/** Add the triangles between the points of a closed rim that have the least
 * total area (Barequet and Sharir, "Filling gaps in the boundary of a
 * polyhedron", 1995). No points are added.
 *
 * @param n, rim  points of m in the order of the rim; triangles have the rim
 *                on their left
 *
 * O(n^3), 12 n^2 bytes. VG_ERR_GEOMETRY for more than VG_SPAN_MOST points or
 * fewer than 3; VG_ERR_MEMORY. */
vg_status vg_span_rim(struct vg_mesh *m, size_t n, const uint32_t *rim,
                      uint32_t patch, struct vg_error *err);

#endif
