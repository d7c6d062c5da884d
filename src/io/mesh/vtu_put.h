/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/mesh/vtu_put.h: functions that write parts of a .vtu file, for the serial
 * writer and for the writer of slices, in which all ranks write
 * (io/slices/slices_parts.h). */
#ifndef VG_IO_MESH_VTU_PUT_H
#define VG_IO_MESH_VTU_PUT_H

#include "core/mesh/mesh.h"
#include "io/mesh/vtu.h"
#include "io/stream/stream.h"

#define VG_VTU_FIELDS_MAX 4

/* Offsets in the file of the data of each array. */
struct vg_vtu_places {
  uint64_t points, connectivity, offsets, types, field[VG_VTU_FIELDS_MAX];
};

/** Write a frame. field: [n] cell fields; data NULL: skipped. */
void vg_vtu_put(struct vg_output *out, const struct vg_mesh *frame,
                const struct vg_vtu_field *field, size_t n);

/** Compute the offsets in a file of file_size bytes. */
void vg_vtu_find(const struct vg_mesh *frame, uint64_t file_size,
                 const struct vg_vtu_field *field, size_t n,
                 struct vg_vtu_places *to);

/* A sequence of cells of one kind. */
struct vg_vtu_cells {
  int kind; /* VG_SLICE_TET, ... */
  size_t n;
  const uint32_t *node;
  const uint32_t *number;     /* number of each node in the file; NULL: the node
                                 itself */
  uint64_t add;               /* added to that number */
  uint64_t first, first_node; /* position among the cells, and in the
                                 connectivity */
};

/** Write connectivity, offsets and types of a sequence of cells. */
void vg_vtu_put_cells(struct vg_output *out, const struct vg_vtu_places *at,
                      const struct vg_vtu_cells *c);

#endif
