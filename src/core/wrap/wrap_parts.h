/* core/wrap/wrap_parts.h: the adapter of CGAL. */
#ifndef VG_CORE_WRAP_WRAP_PARTS_H
#define VG_CORE_WRAP_WRAP_PARTS_H

#include "core/wrap/wrap.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Points, triangles and patches of triangles of the wrap into the empty *out,
 * which the caller releases on failure too; distances into *r. m is sound. */
vg_status vg_wrap_cgal(const struct vg_mesh *m, double size, double offset,
                       struct vg_mesh *out, struct vg_wrap_report *r,
                       struct vg_error *err);

#ifdef __cplusplus
}
#endif

#endif
