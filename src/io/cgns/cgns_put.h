/* io/cgns/cgns_put.h: the parts of a CGNS file, for its writer and for that of
 * meshes in slices, which has them written by all ranks
 * (io/slices/slices_parts.h). */
#ifndef VG_IO_CGNS_PUT_H
#define VG_IO_CGNS_PUT_H

#include "core/mesh/mesh.h"
#include "io/stream/stream.h"

enum { VG_CGNS_KINDS = 4 }; /* tetrahedra, pyramids, prisms, hexahedra */

/** Where the arrays are that slices write: plain data, to be sent. */
struct vg_cgns_places {
  uint64_t size; /* of the file */
  uint64_t at_x[3], at[VG_CGNS_KINDS];
  int32_t is_wide; /* indices of 8 bytes */
};

/** The rest of the file: what HDF5 made, between the arrays. */
struct vg_cgns {
  struct vg_cgns_places places;
  const struct vg_mesh *frame;
  size_t *face_first, *face;   /* vg_boundary_by_patch */
  struct vg_cgns_array *array; /* [n_array] by rising place */
  size_t n_array;
  unsigned char *between; /* all bytes that are in no array */
};

struct vg_cgns_options {
  int is_wide; /* indices of 8 bytes in any case */
};

/** Lay a file out. Only who puts the frame needs it, others its places.
 * @param o  NULL: none
 * VG_ERR_INPUT: no cells. VG_ERR_IO, VG_ERR_MEMORY, VG_ERR_UNSUPPORTED. On
 * success to be released. */
vg_status vg_cgns_plan(const char *path, const struct vg_mesh *frame,
                       const struct vg_cgns_options *o, struct vg_cgns *c,
                       struct vg_error *err);
void vg_cgns_release(struct vg_cgns *c);

/** The whole file; of a frame cells and points are skipped. */
void vg_cgns_put(struct vg_output *out, const struct vg_cgns *c);

/** Of n points from `point` on, one coordinate; to be called with
 * vg_output_order(out, 0), as the next. */
void vg_cgns_seek_x(struct vg_output *out, const struct vg_cgns_places *p,
                    int axis, uint64_t point);

/** Go to a cell of a kind; n cells with the points node, number[node] where
 * number is not NULL. */
void vg_cgns_seek_cell(struct vg_output *out, const struct vg_cgns_places *p,
                       int kind, uint64_t cell);
void vg_cgns_put_cells(struct vg_output *out, const struct vg_cgns_places *p,
                       int kind, size_t n, const uint32_t *node,
                       const uint32_t *number);

/** As vg_cgns_write. */
vg_status vg_cgns_write_with(const char *path, const struct vg_mesh *m,
                             const struct vg_cgns_options *o,
                             struct vg_error *err);

#endif
