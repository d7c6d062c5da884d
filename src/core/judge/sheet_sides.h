/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/judge/sheet_sides.h: whether the triangles of sheets are faces between
 * two cells. Uses core/mesh. */
#ifndef VG_CORE_JUDGE_SHEET_SIDES_H
#define VG_CORE_JUDGE_SHEET_SIDES_H

#include "base/comm.h"
#include "core/mesh/slices.h"

struct vg_sheet_sides;

/** Findings about a sheet. */
struct vg_sheet_report {
  uint64_t n_tri;
  uint64_t n_cell[2]; /* cells on the side of the normals, and on the other
                         side */
  uint64_t n_bad;     /* triangles that do not have one cell on each side */
  double area;
};

/** Enter the sheets of m, which stay in use until vg_sheet_sides_free. *out is
 * NULL without sheets. O(n_sheet_tri). VG_ERR_MEMORY. */
vg_status vg_sheet_sides_new(const struct vg_mesh *m,
                             struct vg_sheet_sides **out, struct vg_error *err);

/** Find the sheets in the cells of a slice. q may be NULL. Threads: any number
 * at once. */
void vg_sheet_sides_add(struct vg_sheet_sides *q, const struct vg_slice *slice);

/** After all slices: the findings, without areas. Collective.
 * @param report  out: [n_sheet], the same on all ranks */
vg_status vg_sheet_sides_sum(struct vg_comm *comm,
                             const struct vg_sheet_sides *q,
                             struct vg_sheet_report *report,
                             struct vg_error *err);

/** The same for a whole mesh, with areas.
 * @param report  out: [n_sheet], to be freed; NULL without sheets
 * VG_ERR_MEMORY. */
vg_status vg_sheet_sides_judge(const struct vg_mesh *m,
                               struct vg_sheet_report **report,
                               struct vg_error *err);

/** Accepts NULL. */
void vg_sheet_sides_free(struct vg_sheet_sides *q);

#endif
