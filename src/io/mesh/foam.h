/* io/mesh/foam.h: OpenFOAM polyMesh, written (formats.md 4.3).
 *
 * A case is a folder:
 *   CASE/constant/polyMesh/{points,faces,owner,neighbour,boundary}
 *   CASE/system/{controlDict,fvSchemes,fvSolution}  only where absent: the
 *                  least that OpenFOAM's mesh tools (checkMesh, ...) ask for
 *   CASE/NAME.foam  empty, what ParaView opens; NAME is the last part of CASE
 *                  without ".openfoam"
 * The word in a write list is "foam" (binary) or "foam-ascii"; the case of
 * project STEM is STEM.openfoam (VG_FOAM_SUFFIX).
 *
 * Cells keep their order: tetrahedra, pyramids, prisms, hexahedra. Faces are
 * in upper-triangular order, boundary faces by patch in the order of patch[].
 * Cells must have positive volume; their own nodes decide the direction of
 * every face. Labels have 32 bits, scalars 64. */
#ifndef VG_IO_MESH_FOAM_H
#define VG_IO_MESH_FOAM_H

#include "core/mesh/mesh.h"

#define VG_FOAM_SUFFIX "openfoam"
#define VG_FOAM_PARTS "cellDecomposition"

struct vg_foam_options {
  int is_ascii; /* 1: text with all digits; 0: binary, host byte order */
};

/** 1 when `word` of a write list asks for a case; sets *options. */
int vg_foam_word(const char *word, struct vg_foam_options *options);

/** Write the mesh into a case folder, made where absent. An earlier mesh in
 * it is replaced, with the zones, sets, parts and addressing of it; all
 * else in the folder stays. The new mesh appears when it is complete.
 * @param options  NULL: binary
 * Returns VG_ERR_INPUT when the cells and the boundary do not close (names
 * cell or boundary face and its corners), VG_ERR_UNSUPPORTED beyond 32-bit
 * labels, VG_ERR_IO, VG_ERR_MEMORY. O(n); memory 16 bytes per tetrahedron and
 * 16 per point. */
vg_status vg_foam_write(const char *case_dir, const struct vg_mesh *m,
                        const struct vg_foam_options *options,
                        struct vg_error *err);

/** Write which part each cell of a case belongs to, for decomposePar with the
 * method "manual": constant/cellDecomposition, and system/decomposeParDict
 * where absent.
 * @param part  [n_cell] 0 .. n_part - 1, in the order of the cells */
vg_status vg_foam_write_parts(const char *case_dir, size_t n_cell,
                              const uint32_t *part, size_t n_part,
                              struct vg_error *err);

/** Move what vg_foam_write made in one folder into another on the same file
 * system, as vg_foam_write would have put it there; the first folder is
 * removed. For output that is first collected aside. */
vg_status vg_foam_place(const char *from_case, const char *to_case,
                        struct vg_error *err);

/** Remove a case that was just made: the files that vg_foam_write makes, and
 * folders that this leaves empty. Absent ones are no error. */
void vg_foam_remove(const char *case_dir);

#endif
