/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Sheets with fluid on both sides. Header only. */
#ifndef TESTS_UNIT_INNER_SHAPES_H
#define TESTS_UNIT_INNER_SHAPES_H

#include "core/sides/inner.h"
#include "core/surface/surface_check.h"
#include "fill_shapes.h"

/* Adds the back of patch `front`, the last one, and both sides of its
 * triangles; is_sheet: the mesh continues through it. */
static inline vg_status put_sides(struct vg_mesh *m, int is_sheet,
                                  struct vg_inner_report *r,
                                  struct vg_error *err)
{
  uint8_t is_inner[9] = { 0 };
  uint32_t back[9] = { 0 };
  const size_t front = m->n_patch - 1;

  assert_int_equal(vg_surface_merge_points(m, err), VG_OK);
  is_inner[front] = 1;
  back[front] = (uint32_t)vg_mesh_add_patch(m, 50, "sheet_back");
  m->patch[front].inner = VG_INNER_FRONT;
  m->patch[front + 1].inner = VG_INNER_BACK;
  m->patch[front].is_sheet = m->patch[front + 1].is_sheet = is_sheet;
  return vg_inner_double(m, is_inner, back, r, err);
}

static inline vg_status put_back(struct vg_mesh *m, struct vg_inner_report *r,
                                 struct vg_error *err)
{
  return put_sides(m, 0, r, err);
}

/* A parallelogram of n x n quadrilaterals from o along u and v. */
static inline void add_sheet(struct vg_mesh *m, const double o[3],
                             const double u[3], const double v[3], int n)
{
  const size_t patch = vg_mesh_add_patch(m, 40, "sheet");
  const uint32_t first = (uint32_t)m->n_point, row = (uint32_t)n + 1;

  for (uint32_t k = 0; k < row * row; k++) {
    const double s = (double)(k % row) / n, t = (double)(k / row) / n;

    shape_point(m, o[0] + s * u[0] + t * v[0], o[1] + s * u[1] + t * v[1],
                o[2] + s * u[2] + t * v[2]);
  }
  for (uint32_t k = 0; k < row * row - row; k++) {
    const uint32_t a = first + k;

    if (k % row == row - 1) continue;
    shape_tri(m, a, a + 1, a + row + 1, patch);
    shape_tri(m, a, a + row + 1, a + row, patch);
  }
}

#endif
