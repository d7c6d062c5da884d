/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/remesh/put_back.h: moves points of a remeshed surface to the shape that
 * the old triangles approximate. */
#ifndef VG_CORE_REMESH_PUT_BACK_H
#define VG_CORE_REMESH_PUT_BACK_H

#include <stddef.h>
#include <stdint.h>

#include "base/stop.h"
#include "core/mesh/mesh.h"

/** Find the triangle of `on` nearest to each point.
 *
 * @param on        any triangles; need not be closed or consistently oriented
 * @param stop      may be NULL
 * @param tri       out: [n]
 * @param foot      out: [n][3] nearest point
 * O(n log n). VG_ERR_INPUT if there are no triangles, VG_ERR_MEMORY,
 * VG_ERR_STOPPED. */
vg_status vg_remesh_locate(const struct vg_mesh *on, size_t n,
                           const double (*x)[3], int threads,
                           const struct vg_stop *stop, uint32_t *tri,
                           double (*foot)[3], struct vg_error *err);

/** Move points of a sound surface, each to its target or not at all. A point
 * stays if its triangles would turn by more than 60 degrees, become slivers, or
 * intersect others. If triangles intersect repeatedly, rings of points around
 * them stay, too.
 *
 * @param to         [n_point][3] target of each point
 * @param stop       may be NULL
 * @param stays      in: [n_point] 1: do not move this point; out: refused
 * points are added
 * @param n_refused  out: number of refused points
 * Untouched on failure: VG_ERR_MEMORY, VG_ERR_STOPPED. The result is the same
 * for any number of threads. O(n log n) for each round in which points are
 * refused, at most nine: then all points stay. */
vg_status vg_remesh_put_back(struct vg_mesh *m, const double (*to)[3],
                             int threads, const struct vg_stop *stop,
                             uint8_t *stays, size_t *n_refused,
                             struct vg_error *err);

#endif
