/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/mesh/foam.h: writer of OpenFOAM's polyMesh (formats.md 4.3).
 *
 * A case is a folder:
 *   CASE/constant/polyMesh/{points,faces,owner,neighbour,boundary}
 *   CASE/constant/polyMesh/cellZones  if the mesh has zones
 *   CASE/constant/polyMesh/faceZones  if the mesh has sheets, a zone for each,
 *                  with the normals of the sheet
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
#include "core/periodic/periodic.h"

#define VG_FOAM_SUFFIX "openfoam"
#define VG_FOAM_PARTS "cellDecomposition"

struct vg_foam_options {
  int is_ascii; /* 1: text with all digits; 0: binary in host byte order */
  /* Pairs of patches that are written as `cyclic`: their faces are in the same
   * order, and begin at the same point. Borrowed; [n_periodic]. */
  size_t n_periodic;
  const struct vg_periodic *periodic;
};

/** Returns 1 if `word` of a write list requests a case; sets *options. */
int vg_foam_word(const char *word, struct vg_foam_options *options);

/** Write the mesh into a case folder, which is created if absent and must not
 * hold a mesh. vg_foam_merge puts such a case in place of an earlier one.
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

/** Receives the moves of vg_foam_merge. `path` is relative to both cases; `to`
 * is NULL, or the absolute path of the target instead. VG_FOAM_FOLDER replaces
 * a folder as a whole. VG_FOAM_REMOVE removes a file of the second case. */
enum vg_foam_move { VG_FOAM_FILE, VG_FOAM_FOLDER, VG_FOAM_REMOVE };
struct vg_foam_mover {
  vg_status (*add)(void *user, enum vg_foam_move kind, const char *path,
                   const char *to, struct vg_error *err);
  void *user;
};

/** List the moves that put a case of vg_foam_write in place of another one,
 * which may be absent: the earlier mesh is replaced, and its zones, sets,
 * subdomains and addressing are removed; everything else in the second case is
 * kept. Files of its polyMesh folder that belong to no mesh get a second name
 * in that of the first case. The second case is not changed. */
vg_status vg_foam_merge(const char *from_case, const char *to_case,
                        const struct vg_foam_mover *mover,
                        struct vg_error *err);

#endif
