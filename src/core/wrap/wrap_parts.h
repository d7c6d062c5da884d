/* core/wrap/wrap_parts.h: the adapter of CGAL, and what its wraps become. */
#ifndef VG_CORE_WRAP_WRAP_PARTS_H
#define VG_CORE_WRAP_WRAP_PARTS_H

#include "core/wrap/wrap.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Points and triangles of the wrap into the empty *out, which the caller
 * releases on failure too. m is sound. */
vg_status vg_wrap_cgal(const struct vg_mesh *m, double size, double offset,
                       const struct vg_stop *stop, struct vg_mesh *out,
                       struct vg_error *err);

/** The places of m nearest to n points, and their triangles; of several alike
 * the same one each time. VG_ERR_INPUT: all triangles are degenerate. */
vg_status vg_wrap_nearest(const struct vg_mesh *m, size_t n,
                          const double (*x)[3], const struct vg_stop *stop,
                          double (*foot)[3], uint32_t *tri,
                          struct vg_error *err);

/** Points onto their places, where those are no farther away than `most` and no
 * triangle folds, gets flat or meets another one. n_fit: how many. */
vg_status vg_wrap_fit(struct vg_mesh *m, const double (*near)[3], double most,
                      const struct vg_stop *stop, size_t *n_fit,
                      struct vg_error *err);

/** At an edge as sharp as a knife a wrap has an end as wide as twice its
 * offset, all of whose points have their places on the edge: its triangles are
 * taken away, so that both sides meet there. near: in: of each point; out: of those
 * that are left, places farther away than `most` being where the points are.
 * n: how many points went. */
vg_status vg_wrap_zip(struct vg_mesh *m, double (*near)[3], double most,
                      const struct vg_stop *stop, size_t *n,
                      struct vg_error *err);

#ifdef __cplusplus
}
#endif

#endif
