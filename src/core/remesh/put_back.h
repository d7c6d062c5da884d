/* core/remesh/put_back.h: points of a new surface put where they belong, on the
 * shape that the old triangles stood for. */
#ifndef VG_CORE_REMESH_PUT_BACK_H
#define VG_CORE_REMESH_PUT_BACK_H

#include <stddef.h>
#include <stdint.h>

#include "base/stop.h"
#include "core/mesh/mesh.h"

/** The triangle of `on` nearest to each point.
 *
 * @param on        any triangles; need not be closed or agree
 * @param stop      may be NULL
 * @param tri       out: [n]
 * @param foot      out: [n][3] the nearest point
 * O(n log n). VG_ERR_INPUT without triangles, VG_ERR_MEMORY, VG_ERR_STOPPED. */
vg_status vg_remesh_locate(const struct vg_mesh *on, size_t n,
                           const double (*x)[3], int threads,
                           const struct vg_stop *stop, uint32_t *tri,
                           double (*foot)[3], struct vg_error *err);

/** Move points of a sound surface, each to its place or not at all. A point
 * stays if its triangles would turn by more than 60 degrees, become slivers, or
 * meet others. Where triangles meet repeatedly, rings of points around them
 * stay too.
 *
 * @param to         [n_point][3]
 * @param stop       may be NULL
 * @param stays      in: [n_point] 1: keep this one; out: the refused ones too
 * @param n_refused  out
 * Untouched on failure: VG_ERR_MEMORY, VG_ERR_STOPPED. The same for any
 * threads. O(n log n) for each time that something is refused, nine at most:
 * then all points stay. */
vg_status vg_remesh_put_back(struct vg_mesh *m, const double (*to)[3],
                             int threads, const struct vg_stop *stop,
                             uint8_t *stays, size_t *n_refused,
                             struct vg_error *err);

#endif
