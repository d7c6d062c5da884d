/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/mesh/sheets.h: named faces between cells, such as actuator disks, wakes
 * and planes for monitors. Uses mesh.h.
 *
 * While a mesh is made, a sheet is an inner surface: a patch with both sides of
 * its triangles, which have the same points (core/sides/inner.h), or copies of
 * them if layers grow on it (is_split). In a finished mesh it is no part of the
 * boundary: sheet_tri has its triangles. */
#ifndef VG_CORE_MESH_SHEETS_H
#define VG_CORE_MESH_SHEETS_H

#include "base/table.h"
#include "core/mesh/mesh.h"

/** Is a patch of m a sheet? */
static inline int vg_mesh_has_sheets(const struct vg_mesh *m)
{
  for (size_t i = 0; i < m->n_patch; i++)
    if (m->patch[i].is_sheet) return 1;
  return 0;
}

/** Is p the back of a sheet without layers, which exists only until the mesh is
 * complete? Lists of patches omit it, and no setting refers to it. */
static inline int vg_patch_is_sheet_back(const struct vg_patch *p)
{
  return p->is_sheet && !p->is_split && p->inner == VG_INNER_BACK;
}

/** Have both sides of patch p, a sheet, the same points while the mesh is made?
 */
static inline int vg_patch_is_passed(const struct vg_patch *p)
{
  return p->is_sheet && !p->is_split;
}

/** Move the triangles of the patches with is_sheet from the boundary m to
 * sheet_tri: those of VG_INNER_FRONT, in their order. Those of VG_INNER_BACK
 * and the patches are removed; the other patches keep their order.
 * VG_ERR_MEMORY: m is unchanged. */
vg_status vg_mesh_part_sheets(struct vg_mesh *m, struct vg_error *err);

/** Remove the sheets. */
void vg_mesh_drop_sheets(struct vg_mesh *m);

/** A view of m in which sheets are patches: its triangles are those of the
 * boundary, followed by those of the sheets. A sheet with the number of a patch
 * belongs to this patch; the others have is_sheet. For writers of formats in
 * which both are lists of faces. The other arrays of *out are those of m.
 * VG_ERR_MEMORY: *out is empty. */
vg_status vg_mesh_sheet_view(const struct vg_mesh *m, struct vg_mesh *out,
                             struct vg_error *err);

/** Release a view of m; also accepts an empty one. */
void vg_mesh_sheet_view_release(struct vg_mesh *view, const struct vg_mesh *m);

/** Triangles of sheets by their points. */
struct vg_sheet_table {
  const struct vg_mesh *m; /* borrowed */
  struct vg_table table;
  uint8_t *on; /* [n_on] 1: a point of a sheet */
  size_t n_on; /* number after the last point of a sheet */
};
#define VG_SHEET_TABLE_INIT                                                    \
  {                                                                            \
    NULL, VG_TABLE_INIT, NULL, 0                                               \
  }

/** Enter the sheets of m, which must stay valid. Of triangles with the same
 * points, the first one is entered. O(n_sheet_tri). VG_ERR_MEMORY: *t is empty.
 */
vg_status vg_sheet_table_new(struct vg_sheet_table *t, const struct vg_mesh *m,
                             struct vg_error *err);
void vg_sheet_table_release(struct vg_sheet_table *t);

/** Is point p on a sheet? Threads: re-entrant. */
static inline int vg_sheet_table_on(const struct vg_sheet_table *t, uint32_t p)
{
  return p < t->n_on && t->on[p];
}

/** The triangle of a sheet with these points, or UINT32_MAX. *is_same: 1 if it
 * has the same orientation, else 0. Threads: re-entrant. */
uint32_t vg_sheet_table_find(const struct vg_sheet_table *t,
                             const uint32_t v[3], int *is_same);

/** Area of sheet i; the points of m must be there. O(n_sheet_tri). */
double vg_mesh_sheet_area(const struct vg_mesh *m, size_t i);

#endif
