/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/cgns/cgns.h: CGNS files in HDF5 (cgns.github.io: SIDS, and its mapping to
 * HDF5). Uses io/vgrid/mapbc.h for boundary conditions.
 *
 * A written file has one base and one zone, with a section per kind of cell,
 * followed by one or two sections per patch, named after it. Each patch has a
 * BC_t for its faces, and a Family_t of the same name with its condition and,
 * as a Descriptor_t, its number.
 * Indices have 4 bytes, or 8 if the counts require it.
 *
 * The HDF5 library lays out the nodes, without the times that it would normally
 * record. It reserves space for the arrays of points, cells and faces, which
 * are then written there directly, so that all ranks can write one file. In a
 * build without HDF5 all functions return VG_ERR_UNSUPPORTED. */
#ifndef VG_IO_CGNS_CGNS_H
#define VG_IO_CGNS_CGNS_H

#include "base/library.h"
#include "core/mesh/mesh.h"
#include "core/mesh/plane_mesh.h"
#include "io/stream/stream.h"

/** Maximum length of the name of a patch, for vg_patch_words. */
#define VG_CGNS_WORD_MOST 26

/** Returns 1 in a build with HDF5. */
int vg_cgns_is_built(void);

void vg_library_hdf5(struct vg_library *out);

/** Read a surface, or a volume mesh with its boundary; gzip'd input is
 * accepted. All zones of all bases with the highest cell dimension are joined;
 * if there are several zones, points with the same coordinates are merged.
 *
 * Unstructured zones: sections of triangles, quadrilaterals, tetrahedra,
 * pyramids, prisms, hexahedra, and MIXED sections of these are read; bars and
 * nodes are ignored. A face belongs to the patch of its BC_t, which is the
 * family of the BC_t if it has one, otherwise its name. A face without a BC_t
 * belongs to a patch named after its section; in a base of surfaces, to that of
 * its zone's family, or of the zone if there are several.
 *
 * Structured zones: of a surface (cell dimension 2, or a single layer of
 * points) all faces are read. They belong to the patch of a BC_t, otherwise of
 * the zone's family, otherwise of the zone. Of a block with cells, the faces of
 * each BC_t with a PointRange are read; the cells are not used.
 * io/cgns/cgns_block.h describes how faces become triangles.
 *
 * Patches with the same name are one patch. They have the numbers that Vanguard
 * recorded in their families, if all of them have one, otherwise they are
 * numbered from 1 in the order in which they appear. Conditions are used if
 * USM3D has a counterpart.
 *
 * The HDF5 library runs in a child process, since damaged files may crash it.
 * @param out  unchanged on failure
 * VG_ERR_IO, VG_ERR_FORMAT, VG_ERR_INPUT, VG_ERR_MEMORY; VG_ERR_UNSUPPORTED:
 * elements of higher order, polygons, conditions on points of unstructured
 * zones or on lists of points of structured zones, links to other files, files
 * in ADF. Threads: re-entrant. O(n). */
vg_status vg_cgns_read(const char *path, struct vg_mesh *out,
                       struct vg_error *err);

/** vg_cgns_read from bytes in memory. */
vg_status vg_cgns_parse(struct vg_input *in, struct vg_mesh *out,
                        struct vg_error *err);

/** As vg_cgns_parse for a file with one zone, with the values at its points of
 * the last FlowSolution_t that has an array of this name.
 * @param name   "": none; the error lists the names of the arrays
 * @param value  out: [n_point], to be freed
 * VG_ERR_INPUT: no such array at the points. */
vg_status vg_cgns_solution_parse(struct vg_input *in, const char *name,
                                 struct vg_mesh *out, double **value,
                                 struct vg_error *err);

/** Write cells and boundary. The same mesh always gives the same bytes.
 * VG_ERR_INPUT: no cells; VG_ERR_IO, VG_ERR_MEMORY. No file is left on failure.
 * Threads: one at a time, a restriction of the HDF5 library. */
vg_status vg_cgns_write(const char *path, const struct vg_mesh *m,
                        struct vg_error *err);

/** Write a mesh in two dimensions: cell and physical dimension 2, conditions on
 * edges. Otherwise as vg_cgns_write. */
vg_status vg_cgns_plane_write(const char *path, const struct vg_plane_mesh *m,
                              struct vg_error *err);

#endif
