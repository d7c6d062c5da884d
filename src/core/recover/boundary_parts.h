/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/recover/boundary_parts.h: steps from a surface to cells. Private to
 * core/recover. */
#ifndef VG_CORE_RECOVER_BOUNDARY_PARTS_H
#define VG_CORE_RECOVER_BOUNDARY_PARTS_H

#include "core/metric/metrics.h"
#include "core/recover/boundary.h"

/** A surface, as in the arguments of vg_boundary_tets and vg_boundary_open. */
struct vg_boundary_input {
  size_t n, n_tri;
  const double (*x)[3];           /* [n] Points. */
  const uint32_t (*tri)[3];       /* [n_tri] Triangles that face the fluid. */
  const struct vg_sizing *sizing; /* NULL: Delaunay cells are not stretched. */
  const struct vg_region *region; /* NULL: the whole void. */
};

static inline int vg_boundary_is_stretched(const struct vg_boundary_input *in)
{
  return in->sizing && vg_sizing_is_stretched(in->sizing);
}

/** Delaunay cells of the points, in a wide box with the corners n to n + 7. If
 * the sizes are stretched, cells are Delaunay in the metric. With inner = 1,
 * they have other points, too: apexes over the triangles, and seeds.
 * (boundary_cells.c) */
vg_status vg_boundary_cells(struct vg_tets *t,
                            const struct vg_boundary_input *in, int inner,
                            struct vg_error *err);

#endif
