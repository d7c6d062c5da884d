/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/vgrid/vgrid.h: files of VGRID / TetrUSS (formats.md 1): the volume mesh
 * .cogsg with its .bc, the surface front .front and the project .d3m.
 * Big-endian Fortran records and text; 1-based; cells have positive volume and
 * boundary faces point inward, which readers verify. For .mapbc see
 * io/vgrid/mapbc.h. */
#ifndef VG_IO_VGRID_VGRID_H
#define VG_IO_VGRID_VGRID_H

#include <stddef.h>
#include <stdint.h>

#include "core/domain/project.h"
#include "core/mesh/mesh.h"
#include "io/stream/convention.h"
#include "io/stream/stream.h"

/** Header data of .cogsg and .bc that the mesh does not contain. */
struct vg_cogsg_info {
  int32_t inew;         /* -1 */
  size_t n_boundary;    /* nbn: number of boundary points, which come first */
  size_t n_layer_point; /* npv: number of the last layer point; 0: none */
  size_t n_layer_cell;  /* nev: cells 1..nev are layer cells */
  double tc;
  int n_trailing;       /* number of trailing records, each with one zero */
  size_t n_curve_point; /* nbc: number of points shared by two or more
                           patches */
  int32_t igrid; /* 1 inviscid, 2 viscous; 0: derived from n_layer_cell */
};
#define VG_COGSG_INFO_INIT                                                     \
  {                                                                            \
    -1, 0, 0, 0, 0.0, 2, 0, 0                                                  \
  }

/** Read STEM.cogsg, and the boundary triangles from STEM.bc in the same folder.
 * Variants with little-endian byte order, single precision, 8-byte markers or
 * subrecords are also read.
 * @param out     unchanged on failure; patches have ids only
 * @param info, turned  may be NULL */
vg_status vg_cogsg_read(const char *path, struct vg_mesh *out,
                        struct vg_cogsg_info *info, struct vg_turned *turned,
                        struct vg_error *err);

/** Read nev, the number of layer cells, from the header alone; *is_known is 0
 * if that fails. */
vg_status vg_cogsg_layer_tets(const char *path, int *is_known, size_t *n,
                              struct vg_error *err);

/** As vg_cogsg_read, from memory. bc may be NULL: no boundary triangles. */
vg_status vg_cogsg_parse(struct vg_input *cogsg, struct vg_input *bc,
                         struct vg_mesh *out, struct vg_cogsg_info *info,
                         struct vg_turned *turned, struct vg_error *err);

/** Read triangles and patch ids of a .bc into a mesh that has its points.
 * @param n_boundary  largest valid node number */
vg_status vg_bc_parse(struct vg_input *in, size_t n_boundary, struct vg_mesh *m,
                      struct vg_cogsg_info *info, struct vg_error *err);

/** Write STEM.cogsg, STEM.bc and STEM.mapbc (VGRID layout); all of them or
 * none.
 *
 * Points are renumbered in VGRID's order: corners, points along patch curves,
 * other surface points, field points. A mesh that already has points of several
 * patches before other surface points before field points keeps its numbering.
 * Cells keep their order.
 * @param info     inew, n_layer_point, n_layer_cell, tc, n_trailing and igrid
 *                 are used; NULL: VG_COGSG_INFO_INIT
 * @param record_limit  0: VG_RECORD_LIMIT (2 GB)
 * @param n_unset  see vg_mapbc_write; may be NULL
 * VG_ERR_UNSUPPORTED for cells other than tetrahedra, for quadrilaterals, or
 * more than 2^31 - 1 cells or points. */
vg_status vg_cogsg_write(const char *stem, const struct vg_mesh *m,
                         const struct vg_cogsg_info *info,
                         uint32_t record_limit, size_t *n_unset,
                         struct vg_error *err);

/** Point order of VGRID: new_to_old and old_to_new, [n_point] each, owned by
 * the caller; both NULL if the mesh is already in this order. */
vg_status vg_vgrid_order(const struct vg_mesh *m, uint32_t **new_to_old,
                         uint32_t **old_to_new, size_t *n_curve_point,
                         size_t *n_boundary, struct vg_error *err);

/** Read a surface front (of a VGRID run that stopped after the surface mesh).
 *
 * The file has no patch numbers of faces. Its curve edges divide the surface
 * into regions; the curves around a region, with their directions, identify the
 * patch of the project.
 * @param project  NULL: each region becomes a patch, numbered by its first face
 * VG_ERR_UNSUPPORTED for the front of an unfinished volume run. VG_ERR_INPUT if
 * project and front do not belong together; the message names the region. */
vg_status vg_front_read(const char *path, const struct vg_project *project,
                        struct vg_mesh *out, struct vg_error *err);
vg_status vg_front_parse(struct vg_input *in, const struct vg_project *project,
                         struct vg_mesh *out, struct vg_error *err);

/** Assign the faces to patches: divide the surface at curve edges and match the
 * regions by their curves (see vg_front_read). m has points and triangles; its
 * patches are set. Deterministic, O(n log n).
 * @param edge  [n_edge][2] 0-based points */
vg_status vg_front_patches(struct vg_mesh *m, size_t n_edge,
                           const uint32_t (*edge)[2],
                           const struct vg_project *project, const char *path,
                           struct vg_error *err);

/** Read a project file and check its shapes and sources (loops are closed,
 * indices in range, spacings positive). *out is released first on success. */
vg_status vg_d3m_read(const char *path, struct vg_project *out,
                      struct vg_error *err);
vg_status vg_d3m_parse(struct vg_input *in, struct vg_project *out,
                       struct vg_error *err);

/** Write a project in VGRID's columns. Coordinates have 11 digits there.
 * VG_ERR_UNSUPPORTED for sources that VGRID does not support. */
vg_status vg_d3m_write(const char *path, const struct vg_project *p,
                       struct vg_error *err);

#endif
