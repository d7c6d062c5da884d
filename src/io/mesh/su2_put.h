/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/mesh/su2_put.h: functions that write parts of a .su2 file, for the serial
 * writer and for the writer of slices, in which all ranks write
 * (io/slices/slices_parts.h). */
#ifndef VG_IO_MESH_SU2_PUT_H
#define VG_IO_MESH_SU2_PUT_H

#include "core/mesh/mesh.h"
#include "io/stream/patch_words.h"
#include "io/stream/stream.h"

enum { VG_SU2_KINDS = 4 }; /* tetrahedra, pyramids, prisms, hexahedra */

/** Layout of a file; determined by the counts of the frame. */
struct vg_su2 {
  const struct vg_mesh *frame;
  char (*word)[VG_PATCH_WORD]; /* [n_patch] */
  size_t *face_first, *face;   /* faces by patch, triangles first */
  int node_width, cell_width;  /* widths of their numbers */
  uint64_t n_cell[VG_SU2_KINDS], first[VG_SU2_KINDS];
  uint64_t at[VG_SU2_KINDS], at_point; /* offsets in the file */
};

/** Compute the layout. VG_ERR_INPUT: no cells. Must be released after
 * success. */
vg_status vg_su2_plan(const char *path, const struct vg_mesh *frame,
                      struct vg_su2 *s, struct vg_error *err);
void vg_su2_release(struct vg_su2 *s);

/** Write the whole file; for a frame, cells and points are skipped. */
void vg_su2_put(struct vg_output *out, const struct vg_su2 *s);

/** Move to a cell of a kind, or to a point. */
void vg_su2_seek_cell(struct vg_output *out, const struct vg_su2 *s, int kind,
                      uint64_t cell);
void vg_su2_seek_point(struct vg_output *out, const struct vg_su2 *s,
                       uint64_t point);

/** Write a cell. Its points are node, or number[node] if number is not NULL. */
void vg_su2_put_cell(struct vg_output *out, const struct vg_su2 *s, int kind,
                     uint64_t cell, const uint32_t *node,
                     const uint32_t *number);
void vg_su2_put_point(struct vg_output *out, const struct vg_su2 *s,
                      uint64_t point, const double x[3]);

#endif
