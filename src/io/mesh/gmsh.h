/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/mesh/gmsh.h: Gmsh's .msh. Version 4.1 binary is written; versions 4.1 and
 * 2.x are read, both text and binary of either byte order (gmsh.info, "Gmsh
 * file formats").
 *
 * A patch is a physical group of surfaces, with the patch's name. If all
 * patches have positive ids, the ids are the group numbers; otherwise groups
 * are numbered from 1. The cells are the physical group "fluid", or "fluid_1"
 * and so on if a patch has that name; its number is one more than the highest
 * of the patches. The format cannot store boundary conditions. */
#ifndef VG_IO_MESH_GMSH_H
#define VG_IO_MESH_GMSH_H

#include "core/mesh/mesh.h"
#include "io/stream/stream.h"

struct vg_cad_zones;

/** Read a surface or a volume mesh; gzip'd input is accepted; text and binary
 * are distinguished by the content.
 *
 * Patches are the physical groups of surfaces. If a surface is in several
 * groups the first counts; a face in no group belongs to patch 0. If no face
 * has a group, the patches are Gmsh's surfaces. Points and lines are skipped,
 * and in a mesh without cells also the nodes that no face uses. The volume of
 * cells is made positive, and boundary faces are turned to point into them
 * (vg_mesh_turn).
 *
 * A surface mesh of version 4 says which volumes its surfaces bound. Faces
 * between two volumes become interfaces, in patches of their own, and each
 * volume a zone with a point inside and the name of its physical group. Without
 * such faces there are no zones.
 * @param out    unchanged on failure
 * @param zones  in: empty; receives the volumes of a surface. NULL: they are
 *               ignored
 * VG_ERR_IO, VG_ERR_FORMAT, VG_ERR_MEMORY; VG_ERR_INPUT also: a surface bounds
 * more than two volumes, or no point is found in a volume; VG_ERR_UNSUPPORTED:
 * versions 1, 3 and 4.0, elements of higher order, partitioned meshes. Threads:
 * re-entrant. O(n), or O(n log n) if nodes are not numbered in order. */
vg_status vg_gmsh_read_volumes(const char *path, struct vg_mesh *out,
                               struct vg_cad_zones *zones,
                               struct vg_error *err);
/** The same from bytes in memory. */
vg_status vg_gmsh_parse_volumes(struct vg_input *in, struct vg_mesh *out,
                                struct vg_cad_zones *zones,
                                struct vg_error *err);

static inline vg_status vg_gmsh_read(const char *path, struct vg_mesh *out,
                                     struct vg_error *err)
{
  return vg_gmsh_read_volumes(path, out, NULL, err);
}

static inline vg_status vg_gmsh_parse(struct vg_input *in, struct vg_mesh *out,
                                      struct vg_error *err)
{
  return vg_gmsh_parse_volumes(in, out, NULL, err);
}

/** Write a surface or a volume mesh: faces sorted by patch, then tetrahedra,
 * pyramids, prisms and hexahedra, numbered consecutively from 1. Patches
 * without faces are omitted; names are those of vg_patch_words.
 * VG_ERR_INPUT: neither faces nor cells; VG_ERR_IO, VG_ERR_MEMORY. No file is
 * left on failure. */
vg_status vg_gmsh_write(const char *path, const struct vg_mesh *m,
                        struct vg_error *err);

#endif
