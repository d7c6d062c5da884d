/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/mesh/foam.h: writer of OpenFOAM's polyMesh (formats.md 4.3).
 *
 * A case is a folder:
 *   CASE/constant/polyMesh/{points,faces,owner,neighbour,boundary}
 *   CASE/system/{controlDict,fvSchemes,fvSolution}  written only if absent,
 *                  with the minimum that OpenFOAM's mesh tools (checkMesh,
 *                  ...) require
 *   CASE/NAME.foam  empty, for ParaView; NAME is the last component of CASE
 *                  without ".openfoam"
 * The word in a write list is "foam" or "openfoam" (binary), or "foam-ascii";
 * the case of project STEM is STEM.openfoam (VG_FOAM_SUFFIX).
 *
 * Cells keep their order: tetrahedra, pyramids, prisms, hexahedra. Internal
 * faces are in upper-triangular order, boundary faces sorted by patch in the
 * order of patch[]. Cells must have positive volume; their node order
 * determines the direction of every face. Labels have 32 bits, scalars 64. */
#ifndef VG_IO_MESH_FOAM_H
#define VG_IO_MESH_FOAM_H

#include "core/mesh/mesh.h"

#define VG_FOAM_SUFFIX "openfoam"
#define VG_FOAM_PARTS "cellDecomposition"

struct vg_foam_options {
  int is_ascii; /* 1: text with all digits; 0: binary in host byte order */
};

/** Returns 1 if `word` of a write list requests a case; sets *options. */
int vg_foam_word(const char *word, struct vg_foam_options *options);

/** Write the mesh into a case folder, which is created if absent. An earlier
 * mesh in the folder is replaced, and its zones, sets, subdomains and
 * addressing are removed; everything else in the folder is kept. The new mesh
 * appears when it is complete.
 * @param options  NULL: binary
 * VG_ERR_INPUT: the boundary does not close the cells (the message names the
 * cell or boundary face and its vertices). VG_ERR_UNSUPPORTED: labels need more
 * than 32 bits. VG_ERR_IO, VG_ERR_MEMORY. O(n); memory 16 bytes per tetrahedron
 * and 16 per point. */
vg_status vg_foam_write(const char *case_dir, const struct vg_mesh *m,
                        const struct vg_foam_options *options,
                        struct vg_error *err);

/** Write the subdomain of each cell of a case, for decomposePar with the method
 * "manual": constant/cellDecomposition and, if absent, system/decomposeParDict.
 * @param part  [n_cell] 0 .. n_part - 1, in the order of the cells */
vg_status vg_foam_write_parts(const char *case_dir, size_t n_cell,
                              const uint32_t *part, size_t n_part,
                              struct vg_error *err);

/** Move the files of vg_foam_write from one folder to another on the same file
 * system, with the same effect as if vg_foam_write had written them there. The
 * first folder is removed. For output that is first collected in a temporary
 * folder. */
vg_status vg_foam_place(const char *from_case, const char *to_case,
                        struct vg_error *err);

/** Remove a case that has just been written: the files of vg_foam_write, and
 * the folders that become empty. Absent files are not an error. */
void vg_foam_remove(const char *case_dir);

#endif
