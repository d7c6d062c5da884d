/* io/cgns/cgns.h: CGNS files in HDF5 (cgns.github.io:
 * SIDS, and its mapping to HDF5). Uses io/vgrid/mapbc.h for conditions.
 *
 * Written: one base, one zone; a section per kind of cell, behind these one or
 * two per patch, named after it; a BC_t per patch on its faces, and a Family_t
 * of the same name with the condition. Indices have 4 bytes, or 8 where counts
 * ask for it.
 *
 * Nodes are laid out by the HDF5 library, without the times that it would
 * note; the arrays of points, cells and faces are put where it has reserved
 * room for them, so that all ranks can write one file. A build without HDF5
 * answers VG_ERR_UNSUPPORTED. */
#ifndef VG_IO_CGNS_CGNS_H
#define VG_IO_CGNS_CGNS_H

#include "core/mesh/mesh.h"
#include "io/stream/stream.h"

/** Characters of the name of a patch: vg_patch_words. */
#define VG_CGNS_WORD_MOST 26

/** 1 in a build with HDF5. */
int vg_cgns_is_built(void);

/** Read a surface, or a volume mesh with its boundary; gzip'd input is
 * accepted. All zones of all bases with the highest cell dimension are joined;
 * where there are several, points with the same coordinates become one.
 *
 * Unstructured zones: sections of triangles, quadrilaterals, tetrahedra,
 * pyramids, prisms, hexahedra, and MIXED ones of them; bars and nodes are
 * ignored. A face is on the patch of its BC_t: its family, where it has one,
 * else its name. One that no BC_t names is on that of its section; in a base
 * of surfaces on that of its zone's family, or of the zone where there are
 * several.
 *
 * Structured zones: the faces of surfaces (cell dimension 2, or a single layer
 * of points), on the patch of a BC_t, else of the zone's family, else of the
 * zone. Of blocks with cells the faces that a BC_t with a PointRange is on; the
 * cells are not used. Faces become triangles as io/cgns/cgns_block.h has it.
 *
 * Patches of the same name are one; they are numbered from 1 as they come.
 * Conditions are taken over where they have a counterpart.
 *
 * The HDF5 library works in a child process, as damaged files may end it.
 * @param out  untouched on failure
 * VG_ERR_IO, VG_ERR_FORMAT, VG_ERR_INPUT, VG_ERR_MEMORY; VG_ERR_UNSUPPORTED:
 * elements of higher order, polygons, conditions on points of unstructured
 * zones, or on lists of points of structured ones, links to other files, files
 * in ADF. Threads: re-entrant. O(n). */
vg_status vg_cgns_read(const char *path, struct vg_mesh *out,
                       struct vg_error *err);

/** vg_cgns_read from bytes in memory. */
vg_status vg_cgns_parse(struct vg_input *in, struct vg_mesh *out,
                        struct vg_error *err);

/** Write cells and boundary: the same bytes whenever the mesh is the same.
 * VG_ERR_INPUT: no cells; VG_ERR_IO, VG_ERR_MEMORY. No file is left on
 * failure. Threads: one at a time, as the HDF5 library has it. */
vg_status vg_cgns_write(const char *path, const struct vg_mesh *m,
                        struct vg_error *err);

#endif
