/* io/mesh/su2_put.h: the parts of a .su2 file, for its writer and for that of
 * meshes in slices, which has them written by all ranks
 * (io/slices/slices_parts.h). */
#ifndef VG_IO_MESH_SU2_PUT_H
#define VG_IO_MESH_SU2_PUT_H

#include "core/mesh/mesh.h"
#include "io/stream/patch_words.h"
#include "io/stream/stream.h"

enum { VG_SU2_KINDS = 4 }; /* tetrahedra, pyramids, prisms, hexahedra */

/** Layout of a file: follows from the counts of the frame. */
struct vg_su2 {
  const struct vg_mesh *frame;
  char (*word)[VG_PATCH_WORD]; /* [n_patch] */
  size_t *face_first, *face;   /* faces by patch, triangles first */
  int node_width, cell_width;  /* columns of their numbers */
  uint64_t n_cell[VG_SU2_KINDS], first[VG_SU2_KINDS];
  uint64_t at[VG_SU2_KINDS], at_point; /* where in the file they begin */
};

/** VG_ERR_INPUT: no cells. On success to be released. */
vg_status vg_su2_plan(const char *path, const struct vg_mesh *frame,
                      struct vg_su2 *s, struct vg_error *err);
void vg_su2_release(struct vg_su2 *s);

/** The whole file; of a frame cells and points are skipped. */
void vg_su2_put(struct vg_output *out, const struct vg_su2 *s);

/** Go to a cell of a kind, or to a point. */
void vg_su2_seek_cell(struct vg_output *out, const struct vg_su2 *s, int kind,
                      uint64_t cell);
void vg_su2_seek_point(struct vg_output *out, const struct vg_su2 *s,
                       uint64_t point);

/** A cell with the points node, number[node] where number is not NULL. */
void vg_su2_put_cell(struct vg_output *out, const struct vg_su2 *s, int kind,
                     uint64_t cell, const uint32_t *node,
                     const uint32_t *number);
void vg_su2_put_point(struct vg_output *out, const struct vg_su2 *s,
                      uint64_t point, const double x[3]);

#endif
