/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/flow/half.h: half models. Private to core/flow.
 *
 *        given with a cap          open              with its mirror image
 *        z |  ______            z |  ______              ______ ______
 *          | |      \             |        \            /      |      \
 *        --+-|cap----) y        --+---------) y        (-------+-------)
 *          | |______/             |  ______/            \______|______/
 */
#ifndef VG_CORE_FLOW_HALF_H
#define VG_CORE_FLOW_HALF_H

#include "core/flow/flow.h"

/** Of the length of the body: points this near are in a plane. */
#define VG_HALF_NEAR 1e-5 /* S5 */

/** A flat cap in a coordinate plane at an end of the surface. */
struct vg_flow_cap {
  int axis; /* -1: no cap was found. */
  double at;
  size_t n_tri;
  uint8_t *tri; /* [m->n_tri] 1: triangle of the cap; owned. */
};

/** Find the cap that may close a half model: the cap with a symmetry condition
 * or name, or else one at coordinate 0 that looks like a root.
 *
 * @param half          VG_HALF_X to _Z: only a cap normal to this axis, at any
 *                      coordinate, but not the tip of a body on one side of 0.
 *                      It may be uneven or inclined by VG_ROOT_OFF; `at` is
 *                      then its outermost coordinate.
 * @param by_condition  out: 1 if the cap has a symmetry condition or name
 * VG_ERR_INPUT if only a part of an uneven cap would be found: the message
 * names the point and its distance. O(n), plus the cost of the border of the
 * cap. */
vg_status vg_flow_find_cap(const struct vg_mesh *m, enum vg_flow_half half,
                           struct vg_flow_cap *cap, int *by_condition,
                           struct vg_error *err);

/** Does the cap look like the root of half a body? It has no hole and is not
 * small. Its front and rear differ, or it spans half of the body, which is not
 * much deeper than the cap is wide.
 *
 * @param open  m without the cap, with the same points */
vg_status vg_flow_looks_like_root(const struct vg_mesh *m,
                                  const struct vg_mesh *open,
                                  const struct vg_flow_cap *cap, int *is_root,
                                  struct vg_error *err);

void vg_flow_cap_release(struct vg_flow_cap *cap);

/** Join m with its mirror image across x[axis] = at. Points of open
 * edges are shared; triangles from number n_tri on are the image. *out is empty
 * on entry. */
vg_status vg_flow_mirror(const struct vg_mesh *m, int axis, double at,
                         struct vg_mesh *out, struct vg_error *err);

#endif
