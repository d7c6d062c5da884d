/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/surface/borders.h: borders between patches that become feature edges of
 * a remeshed surface, although it may be smooth across them. */
#ifndef VG_CORE_SURFACE_BORDERS_H
#define VG_CORE_SURFACE_BORDERS_H

#include <stdint.h>

#include "core/mesh/mesh.h"

/** Select the patches that keep their borders.
 *
 * Without a feature edge, a border follows the edges of the new triangles: it
 * moves by about the edge length h, and the area of the patch changes by h
 * times the length of its border. With a feature edge, triangles become as
 * small as the patch is wide. Both matter for patches of which the width, twice
 * the area over the length of the border, is not large compared with h.
 *
 *        wide patch             patch of width w < h        many strips of a
 *     .--------------.         .----------------.           surface of
 *     |              |         |________________|           revolution: only
 *     |    kept      |           kept, triangles            those with few
 *     '--------------'           of size w                  edges are kept
 *
 * @param size    largest edge h of the remeshed surface
 * @param cosine  least cosine between the normals of a smooth surface
 * @param kept    [n_patch] set to 1 for patches that keep their borders; other
 *                entries remain unchanged
 * @param width   [n_patch] out: width of each patch; INFINITY without a border
 *
 * O(n_tri). VG_ERR_MEMORY. */
vg_status vg_borders_keep(const struct vg_mesh *m, double size, double cosine,
                          uint8_t *kept, double *width, struct vg_error *err);

#endif
