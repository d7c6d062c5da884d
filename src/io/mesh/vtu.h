/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/mesh/vtu.h: VTK unstructured grids for ParaView and VisIt, as appended raw
 * data with UInt64 headers (formats.md 4.4). 0-based; pyramids and wedges in
 * VTK's node order. Written in the byte order of the machine, array by array,
 * without a copy of the mesh. */
#ifndef VG_IO_MESH_VTU_H
#define VG_IO_MESH_VTU_H

#include <stddef.h>
#include <stdint.h>

#include "core/mesh/mesh.h"

enum vg_vtu_place { VG_VTU_POINT, VG_VTU_CELL };
enum vg_vtu_type { VG_VTU_FLOAT64, VG_VTU_FLOAT32, VG_VTU_INT32 };

/* Name of the cell data that holds the solver partition of each cell. */
#define VG_VTU_SOLVER_PART "solver_part"
#define VG_VTU_ZONE "zone"

/** One result array; the data are borrowed. */
struct vg_vtu_field {
  const char *name;
  enum vg_vtu_place place;
  enum vg_vtu_type type;
  int n_component;  /* 1 scalar, 3 vector, ...; 0 means 1 */
  const void *data; /* [entities][n_component] */
};

/** Write the cells of m (tetrahedra, pyramids, prisms, hexahedra, in this
 * order), or its boundary (vg_vtu_write_boundary) if m has no cells.
 *
 * @param fields  [n]; cell fields are in the order of the cells above. May be
 *                NULL for n = 0.
 * The file appears complete or not at all. Returns VG_ERR_IO, or VG_ERR_INPUT
 * for a field name that is empty or contains quotes, angle brackets, '&' or
 * control characters. Threads: re-entrant. */
vg_status vg_vtu_write(const char *path, const struct vg_mesh *m,
                       const struct vg_vtu_field *fields, size_t n,
                       struct vg_error *err);

/** Write the boundary of m: triangles, then quadrilaterals, with the points
 * that they use, and patch ids as cell data `patch`.
 *
 * @param fields  [n]; cell fields: triangles, then quadrilaterals; point
 *                fields: one value for every point of m */
vg_status vg_vtu_write_boundary(const char *path, const struct vg_mesh *m,
                                const struct vg_vtu_field *fields, size_t n,
                                struct vg_error *err);

/** Write individual triangles, such as faces with a defect.
 *
 * @param point  [n_point][3]
 * @param tri    [n_tri][3] 0-based, < n_point */
vg_status vg_vtu_write_triangles(const char *path, size_t n_point,
                                 const double (*point)[3], size_t n_tri,
                                 const uint32_t (*tri)[3],
                                 const struct vg_vtu_field *fields, size_t n,
                                 struct vg_error *err);

#endif
