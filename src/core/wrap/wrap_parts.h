/* core/wrap/wrap_parts.h: the adapter of CGAL. */
#ifndef VG_CORE_WRAP_WRAP_PARTS_H
#define VG_CORE_WRAP_WRAP_PARTS_H

#include "core/wrap/wrap.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Points and triangles of the wrap into the empty *out, which the caller
 * releases on failure too; of each point the nearest place of the input into
 * *near, which the caller frees. m is sound. */
vg_status vg_wrap_cgal(const struct vg_mesh *m, double size, double offset,
                       const struct vg_stop *stop, struct vg_mesh *out,
                       double (**near)[3], struct vg_error *err);

/** Points onto their places, where those are no farther away than `most` and no
 * triangle folds, gets flat or meets another one. n_fit: how many. */
vg_status vg_wrap_fit(struct vg_mesh *m, const double (*near)[3], double most,
                      const struct vg_stop *stop, size_t *n_fit,
                      struct vg_error *err);

/** Triangles of out get the patch of the nearest one of m; the largest distance
 * into *r. */
vg_status vg_wrap_label(const struct vg_mesh *m, struct vg_mesh *out,
                        const struct vg_stop *stop, struct vg_wrap_report *r,
                        struct vg_error *err);

#ifdef __cplusplus
}
#endif

#endif
