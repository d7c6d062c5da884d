/* io/mesh/vtu_put.h: the parts of a .vtu file, for its writer and for that of
 * meshes in slices, which has them written by all ranks
 * (io/slices/slices_parts.h). */
#ifndef VG_IO_MESH_VTU_PUT_H
#define VG_IO_MESH_VTU_PUT_H

#include "core/mesh/mesh.h"
#include "io/mesh/vtu.h"
#include "io/stream/stream.h"

#define VG_VTU_FIELDS_MAX 3

/* Where in the file the data of an array start. */
struct vg_vtu_places {
  uint64_t points, connectivity, offsets, types, field[VG_VTU_FIELDS_MAX];
};

/** A frame. field: [n] of cells; data NULL: skipped. */
void vg_vtu_put(struct vg_output *out, const struct vg_mesh *frame,
                const struct vg_vtu_field *field, size_t n);

/** Places in a file of file_size bytes. */
void vg_vtu_find(const struct vg_mesh *frame, uint64_t file_size,
                 const struct vg_vtu_field *field, size_t n,
                 struct vg_vtu_places *to);

/* A run of cells of one kind. */
struct vg_vtu_cells {
  int kind; /* VG_SLICE_TET, ... */
  size_t n;
  const uint32_t *node;
  const uint32_t *number;     /* of a node in the file; NULL: itself */
  uint64_t add;               /* to that number */
  uint64_t first, first_node; /* place among cells, in the connectivity */
};

/** Connectivity, offsets and types of a run of cells. */
void vg_vtu_put_cells(struct vg_output *out, const struct vg_vtu_places *at,
                      const struct vg_vtu_cells *c);

#endif
