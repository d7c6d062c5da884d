/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/domain/symmetry.h: decides whether an opening in one plane is the cut of
 * a half body. Private to core/domain. */
#ifndef VG_CORE_DOMAIN_SYMMETRY_H
#define VG_CORE_DOMAIN_SYMMETRY_H

#include "core/domain/farfield.h"

/* Open edges this close to a coordinate plane, in body lengths, are in the
 * plane. */
#define VG_PLANE_TOLERANCE 1e-5 /* S5 */

/** Can open edges in the plane x[axis] = at be the cut of a symmetric body,
 * rather than a missing face? All of the following must hold:
 * - The surface meets the plane steeply along most of them, as where a body
 *   continues into its mirror image; a missing nose or panel leaves a flat or
 *   blunt rim.
 * - They span at least half of the body along their longer side.
 * - The body is not much deeper than they are wide, as a tube without its base
 *   would be; or the plane is y = 0 or z = 0, where models are usually cut.
 * @param open  at least one edge; O(triangles) */
int vg_is_symmetry(const struct vg_mesh *m, const struct vg_border *open,
                   int axis, double at);

#endif
