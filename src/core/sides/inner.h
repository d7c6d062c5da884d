/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/sides/inner.h: inner surfaces, sheets of zero thickness with fluid on
 * both sides.
 *
 *        _______________                _______________
 *       |               |              |      ___      |   A sheet becomes two
 *       |      ---      |      ->      |     (___)     |   layers of triangles,
 *       |___|___________|              |__| |__________|   here drawn apart.
 *
 * A boundary with sheets as doubled here is closed, and every edge on it has as
 * many triangles in one direction as in the other. Points inside a sheet occur
 * once for each sector around them (core/sides/sides.h), points of free edges
 * once. If the mesh continues through a sheet without layers
 * (vg_patch_is_passed), both of its sides have the same points: the sectors
 * that it separates count as one. */
#ifndef VG_CORE_SIDES_INNER_H
#define VG_CORE_SIDES_INNER_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "core/mesh/mesh.h"

struct vg_inner_report {
  size_t n_tri;    /* triangles of the sheets, each counted once */
  size_t n_cut;    /* edges cut because the two sides of a triangle, or of an
                      edge on another surface, had the same points */
  size_t n_point;  /* points that were added as copies */
  size_t n_sealed; /* regions of the fluid that the sheets separate from the
                      others */
  size_t n_turned; /* triangles of the sheets that were turned, so that those of
                      each piece agree */
  double turned_at[3]; /* in the first one */
  size_t n_near; /* pairs of triangles of a sheet and a surface that have no
                    common point, and a gap below 1e-3 of their edges */
  double gap;    /* the narrowest one: narrowest as a share of edges */
  double at[3];  /* near it */
};

/** Orient the sheets of m as vg_inner_double does.
 *
 * @param report  set; n_turned and turned_at tell what was turned
 * VG_ERR_GEOMETRY if a sheet has only one side; m is then unchanged.
 * VG_ERR_MEMORY. O(n log n). */
vg_status vg_inner_turn(struct vg_mesh *m, const uint8_t *is_inner,
                        struct vg_inner_report *report, struct vg_error *err);

/** Double the sheets of a boundary.
 *
 * @param m         triangles into the fluid, closed without the sheets, whose
 *                  triangles occur once, of any orientation: each piece of a
 *                  patch is oriented like its first triangle, where a piece is
 *                  connected through edges of two of its triangles. Points with
 *                  the same coordinates are one point. No two triangles
 *                  intersect.
 *                  Untouched on failure
 * @param is_inner  [m->n_patch] 1: the patch is a sheet
 * @param back      [m->n_patch] patch of the triangles of the other side, which
 *                  are appended in the order of the first ones; both may be
 *                  the same
 *
 * Copies of points follow the other points. VG_ERR_GEOMETRY, with the place, if
 * a sheet has only one side, is not in the fluid, touches a surface in a single
 * point, or nearly touches it: a gap below 1e-6 of the edges is due to
 * rounding. VG_ERR_MEMORY. O(n log n), plus O(n) for each sheet that is
 * connected with no other surface. */
vg_status vg_inner_double(struct vg_mesh *m, const uint8_t *is_inner,
                          const uint32_t *back, struct vg_inner_report *report,
                          struct vg_error *err);

#endif
