/* core/remesh/clean_parts.h: triangles that intersect each other, measured and
 * moved apart. Private to core/remesh. */
#ifndef VG_CORE_REMESH_CLEAN_PARTS_H
#define VG_CORE_REMESH_CLEAN_PARTS_H

#include "core/remesh/clean.h"
#include "core/surface/surface_check.h"

/** Set depth and place of the deepest intersection of the report in *c. */
void vg_clean_depth(const struct vg_mesh *m, const struct vg_surface_report *r,
                    struct vg_clean *c);

/** Move points of intersecting triangles along the normals there, so that the
 * two sheets of a thin place come apart: no point moves farther than a share of
 * the tolerance. *n_moved: points moved. O(n). VG_ERR_MEMORY. */
vg_status vg_clean_part(struct vg_mesh *m, const struct vg_surface_report *r,
                        double tolerance, size_t *n_moved,
                        struct vg_error *err);

#endif
