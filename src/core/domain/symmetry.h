/* core/domain/symmetry.h: is a hole in one plane where a half body was cut?
 * Private to core/domain. */
#ifndef VG_CORE_DOMAIN_SYMMETRY_H
#define VG_CORE_DOMAIN_SYMMETRY_H

#include "core/domain/farfield.h"

/* Open edges this close to a coordinate plane, in body lengths, are in it. */
#define VG_PLANE_TOLERANCE 1e-5 /* S5 */

/** Whether open edges in the plane x[axis] = at can be where the rest of a
 * symmetric body was cut off, and not a face that is missing. All must hold:
 *   - the surface meets the plane steeply along most of them, as it does where
 *     a body and its image go on into each other; a nose or a panel that is
 *     missing leaves a flat or blunt rim;
 *   - they span half of the body along their longer side, or more;
 *   - the body is not much deeper than they are wide, as a tube without its
 *     base would be; or the plane is y = 0 or z = 0, where models are cut.
 * @param open  at least one edge; O(triangles) */
int vg_is_symmetry(const struct vg_mesh *m, const struct vg_border *open,
                   int axis, double at);

#endif
