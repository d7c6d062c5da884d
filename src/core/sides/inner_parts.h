/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/sides/inner_parts.h: the steps that double sheets. Private to
 * core/sides. */
#ifndef VG_CORE_SIDES_INNER_PARTS_H
#define VG_CORE_SIDES_INNER_PARTS_H

#include "core/mesh/sheets.h"
#include "core/sides/inner.h"
#include "core/sides/sides.h"

struct vg_inner_work {
  struct vg_mesh *m;
  const uint8_t *is_inner; /* [m->n_patch] */
  struct vg_inner_report *report;
  struct vg_sides sides; /* of the triangles of m */
  int passes_all;        /* 1: sheets with is_split count as passed */
  uint32_t *room;        /* [sides.n_sector] the first of the sectors around a
                            point that passed sheets connect */
};

static inline int vg_is_sheet(const struct vg_inner_work *s, size_t tri)
{
  return s->is_inner[s->m->tri_patch[tri]];
}

/** Does the mesh continue through triangle tri, and have its sides the same
 * points, while it is made or, with passes_all, when it is complete? */
static inline int vg_is_passed(const struct vg_inner_work *s, size_t tri)
{
  const struct vg_patch *p = &s->m->patch[s->m->tri_patch[tri]];

  return p->is_sheet && (s->passes_all || !p->is_split) && vg_is_sheet(s, tri);
}

/** Orient each piece of a patch whose triangles are connected through edges of
 * exactly two of them like its first triangle. Turned triangles go to
 * s->report. VG_ERR_GEOMETRY, with the place, for a piece with only one side;
 * s->m is then unchanged. s->sides is not used. O(n log n). (inner_orient.c) */
vg_status vg_inner_orient(const struct vg_inner_work *s, struct vg_error *err);

/** VG_ERR_GEOMETRY if a sheet is not in the fluid or touches a surface in a
 * point. Sealed regions go to s->report. (inner_check.c) */
vg_status vg_inner_check(const struct vg_inner_work *s, struct vg_error *err);

/** VG_ERR_GEOMETRY, with the narrowest place, if a sheet nearly touches a
 * surface or itself: triangles without a common point, which no edge joins, are
 * nearer than 1e-6 of the longest edge of one of them. Pairs nearer than 1e-3
 * go to s->report. O(n log n). (inner_near.c) */
vg_status vg_inner_near(const struct vg_inner_work *s, struct vg_error *err);

/** Cut edges so that the two sides of a sheet have different points: the
 * longest edge of a triangle of which all corners have one sector, among those
 * that other triangles have; and an edge in which alone a sheet ends on another
 * surface. Their middles have two sectors or more. s->sides is out of date
 * afterwards if *n_cut, their number, is not 0. (inner_cut.c) */
vg_status vg_inner_cut(struct vg_inner_work *s, size_t *n_cut,
                       struct vg_error *err);

#endif
