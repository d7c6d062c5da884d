/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/remesh/levels.h: remeshing in a metric from coarse to fine. Private to
 * core/remesh.
 *
 * The triangles of a coarse input are needles in a stretched metric, whose
 * directions differ between their corners. They are therefore first remeshed
 * with larger sizes, which are halved from level to level. The sizes that the
 * surface requests (curvature, gaps, strips) are the same on all levels. */
#ifndef VG_CORE_REMESH_LEVELS_H
#define VG_CORE_REMESH_LEVELS_H

#include "core/remesh/work.h"

/** Number of levels with enlarged sizes before the last one: 0 if the surface
 * has no field, or about as many triangles as the field requests. O(n) */
int vg_levels_number(const struct vg_ref *r, const struct vg_sizing *field,
                     double h_max);

/** Set the factor on the sizes of the field, and the target lengths of all
 * points. O(n log n). VG_ERR_STOPPED. */
vg_status vg_levels_set(struct vg_tris *w, double factor, struct vg_error *err);

#endif
