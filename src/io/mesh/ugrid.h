/* io/mesh/ugrid.h: AFLR / UGRID meshes, every variant of formats.md 2.1: text,
 * and binary with 4- or 8-byte integers, 4- or 8-byte reals, either byte order,
 * streams or Fortran records. 1-based; cells and boundary faces as in
 * core/mesh/mesh.h, but signs are tested on reading. */
#ifndef VG_IO_MESH_UGRID_H
#define VG_IO_MESH_UGRID_H

#include "core/mesh/mesh.h"
#include "io/stream/convention.h"
#include "io/stream/stream.h"

struct vg_ugrid_kind {
  int is_text;
  int int_size;  /* 4 or 8 bytes */
  int real_size; /* 4 or 8 bytes */
  int is_record; /* Fortran records */
  int is_big;
};

/** Kind by the last parts of a name ("x.lb8.ugrid", "b8.ugrid64", "ugrid"),
 * upper or lower case. 1 when it is a name of the family, else 0. */
int vg_ugrid_kind(const char *name, struct vg_ugrid_kind *kind);

/** Read a mesh or a surface; the kind follows from the name (a ".gz" at its
 * end is ignored) and is checked against the content.
 *
 * Tags become patch ids, patches are sorted by id. What follows the cells
 * (layer counts, volume tags, ...) is ignored. Cells are made positive and
 * boundary faces turned into their cells; a file without cells is kept as it
 * is. Points that nothing uses are kept.
 * @param out     untouched on failure
 * @param turned  what was turned; may be NULL
 * Returns VG_ERR_IO, VG_ERR_FORMAT (truncated, or another kind than the name
 * says: the message names the right one), VG_ERR_INPUT (index out of range,
 * coordinate not finite) or VG_ERR_MEMORY. Threads: re-entrant. O(n). */
vg_status vg_ugrid_read(const char *path, struct vg_mesh *out,
                        struct vg_turned *turned, struct vg_error *err);

/** As vg_ugrid_read on bytes in memory, of a given kind. */
vg_status vg_ugrid_parse(struct vg_input *in, const struct vg_ugrid_kind *kind,
                         struct vg_mesh *out, struct vg_turned *turned,
                         struct vg_error *err);

/** The seven counts of a file (points, triangles, quadrilaterals, tetrahedra,
 * pyramids, prisms, hexahedra) without reading the rest. */
vg_status vg_ugrid_peek(const char *path, uint64_t count[7],
                        struct vg_error *err);

/** The number of tetrahedra in layers, where a tail tells it (formats.md 2.4):
 * *is_known says whether one does. Of text kinds no tail is read. */
vg_status vg_ugrid_layer_tets(const char *path, int *is_known, size_t *n,
                              struct vg_error *err);

/** Write in the kind that the name says; no tail. Single precision kinds
 * round the coordinates: VG_ERR_GEOMETRY where that makes cells flat or
 * inverted, or points one. VG_ERR_UNSUPPORTED when counts exceed the integers
 * of the kind. The file appears complete or not at all. */
vg_status vg_ugrid_write(const char *path, const struct vg_mesh *m,
                         struct vg_error *err);

/** As vg_ugrid_write, followed by the first part of the tail (formats.md 2.4):
 * the number of tetrahedra in the layers, an integer of the kind's
 * size; a record of its own in Fortran kinds. Layer tetrahedra are meant to
 * be the first ones of the file. Readers, ours too, ignore it.
 * @param n_layer_tet  0 .. m->n_tet, else VG_ERR_INPUT; mixed meshes, whose
 *                     layers are prisms mostly, have few or none */
vg_status vg_ugrid_write_tail(const char *path, const struct vg_mesh *m,
                              size_t n_layer_tet, struct vg_error *err);

#endif
