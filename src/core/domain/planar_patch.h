/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/domain/planar_patch.h: triangulates a plane patch of a surface in space
 * inside its boundary by vg_planar_mesh. Uses core/mesh/mesh.h. */
#ifndef VG_CORE_DOMAIN_PLANAR_PATCH_H
#define VG_CORE_DOMAIN_PLANAR_PATCH_H

#include <stddef.h>
#include <stdint.h>

#include "base/stop.h"
#include "core/mesh/mesh.h"

/** Target edge length in space. */
struct vg_size_function {
  double (*at)(void *user, const double x[3]);
  void *user;
  struct vg_stop stop; /* Polled regularly. */
};

struct vg_sizing;

/** Size law that evaluates a sizing field, which is borrowed. */
struct vg_size_function vg_size_function_of(const struct vg_sizing *sizing);

/** Append the triangles of the plane region on the left of `edge` to m.
 *
 * @param m       in/out: points used by edge[]; new points and triangles are
 *                appended, existing ones are not changed. Unchanged on failure
 * @param edge    directed segments between points of m; closed loops,
 *                counter-clockwise as seen from the side to which normals point
 * @param patch   index in m->patch for the new triangles
 * If a coordinate is exactly the same at all points of the region, new points
 * have the same value. VG_ERR_GEOMETRY: points off the plane by more than 1e-6
 * of the extent, or loops that cross. VG_ERR_STOPPED. */
vg_status vg_planar_patch(struct vg_mesh *m, size_t n_edge,
                          const uint32_t (*edge)[2],
                          const struct vg_size_function *size, uint32_t patch,
                          struct vg_error *err);

/** Like vg_planar_patch, for points that are off their mean plane by up to
 * `flatness` of the extent: they keep their positions, and new points are in
 * that plane. */
vg_status vg_planar_patch_near(struct vg_mesh *m, size_t n_edge,
                               const uint32_t (*edge)[2],
                               const struct vg_size_function *size,
                               double flatness, uint32_t patch,
                               struct vg_error *err);

#endif
