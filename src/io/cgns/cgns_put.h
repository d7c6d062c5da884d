/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/cgns/cgns_put.h: functions that write parts of a CGNS file, for the serial
 * writer and for the writer of slices, in which all ranks write
 * (io/slices/slices_parts.h). */
#ifndef VG_IO_CGNS_PUT_H
#define VG_IO_CGNS_PUT_H

#include "core/mesh/mesh.h"
#include "core/periodic/periodic.h"
#include "io/stream/stream.h"

enum { VG_CGNS_KINDS = 4 }; /* tetrahedra, pyramids, prisms, hexahedra */

/** Offsets of the arrays that slices write; plain data that can be sent. */
struct vg_cgns_places {
  uint64_t size; /* size of the file */
  uint64_t at_x[3], at[VG_CGNS_KINDS];
  int32_t is_wide; /* 1: indices have 8 bytes */
};

/** The complete layout of a file, with the bytes of HDF5 between the arrays. */
struct vg_cgns {
  struct vg_cgns_places places;
  const struct vg_mesh *frame;
  size_t *face_first, *face;   /* from vg_boundary_by_patch */
  struct vg_cgns_array *array; /* [n_array] in order of their offsets */
  size_t n_array;
  unsigned char *between; /* all bytes that are not part of an array */
};

struct vg_cgns_options {
  int is_wide; /* use indices of 8 bytes in any case */
  const struct vg_periodic_links *links; /* NULL: no patch is periodic */
};

/** Compute the layout. Only the writer of the frame needs it; the others need
 * its places.
 * @param o  NULL: default options
 * VG_ERR_INPUT: no cells. VG_ERR_IO, VG_ERR_MEMORY, VG_ERR_UNSUPPORTED. Must be
 * released after success. */
vg_status vg_cgns_plan(const char *path, const struct vg_mesh *frame,
                       const struct vg_cgns_options *o, struct vg_cgns *c,
                       struct vg_error *err);
void vg_cgns_release(struct vg_cgns *c);

/** Write the whole file; for a frame, cells and points are skipped. */
void vg_cgns_put(struct vg_output *out, const struct vg_cgns *c);

/** Write one coordinate of n points, starting with number `point`. Call
 * vg_output_order(out, 0) first, also for the functions below. */
void vg_cgns_seek_x(struct vg_output *out, const struct vg_cgns_places *p,
                    int axis, uint64_t point);

/** Move to a cell of a kind; write n cells. Their points are node, or
 * number[node] if number is not NULL. */
void vg_cgns_seek_cell(struct vg_output *out, const struct vg_cgns_places *p,
                       int kind, uint64_t cell);
void vg_cgns_put_cells(struct vg_output *out, const struct vg_cgns_places *p,
                       int kind, size_t n, const uint32_t *node,
                       const uint32_t *number);

/** As vg_cgns_write, with options. */
vg_status vg_cgns_write_with(const char *path, const struct vg_mesh *m,
                             const struct vg_cgns_options *o,
                             struct vg_error *err);

#endif
