/* io/mesh/gmsh.h: Gmsh's .msh, written as 4.1 binary, read as 4.1 and 2.x,
 * text and binary of either byte order (gmsh.info, "Gmsh file formats").
 *
 * A patch is a physical group of surfaces, with its name and, where all
 * patches have numbers above 0, its number; else they are numbered from 1. The
 * cells are the physical group "fluid". Conditions have no place in the
 * format. */
#ifndef VG_IO_MESH_GMSH_H
#define VG_IO_MESH_GMSH_H

#include "core/mesh/mesh.h"
#include "io/stream/stream.h"

/** Read a surface or a volume mesh; gzip'd input is accepted; text or binary
 * is found from the content.
 *
 * Patches are the physical groups of surfaces, of several the first; a face of
 * none is on patch 0. Where no face has a group they are Gmsh's surfaces.
 * Points and lines are passed over, and points that no face uses left out
 * where there are no cells. Cells are made positive and boundary faces turned
 * into them (vg_mesh_turn).
 * @param out  untouched on failure
 * VG_ERR_IO, VG_ERR_FORMAT, VG_ERR_INPUT, VG_ERR_MEMORY; VG_ERR_UNSUPPORTED:
 * versions 1, 3 and 4.0, elements of higher order, partitioned meshes.
 * Threads: re-entrant. O(n), O(n log n) where points are not numbered in
 * order. */
vg_status vg_gmsh_read(const char *path, struct vg_mesh *out,
                       struct vg_error *err);

/** vg_gmsh_read from bytes in memory. */
vg_status vg_gmsh_parse(struct vg_input *in, struct vg_mesh *out,
                        struct vg_error *err);

/** Write a surface or a volume mesh. Faces patch by patch, then cells:
 * tetrahedra, pyramids, prisms, hexahedra, numbered through from 1; patches
 * without faces are left out, names are those of vg_patch_words.
 * VG_ERR_INPUT: neither faces nor cells; VG_ERR_IO, VG_ERR_MEMORY. No file is
 * left on failure. */
vg_status vg_gmsh_write(const char *path, const struct vg_mesh *m,
                        struct vg_error *err);

#endif
