/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/mesh/ugrid.h: AFLR / UGRID meshes in every variant of formats.md 2.1:
 * text, and binary with 4- or 8-byte integers, 4- or 8-byte reals, either byte
 * order, as streams or Fortran records. 1-based; cells and boundary faces as in
 * core/mesh/mesh.h, but their orientation is checked on reading. */
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

/** Determine the kind from the last parts of a name ("x.lb8.ugrid",
 * "b8.ugrid64", "ugrid"), in upper or lower case. Returns 1 if it is a UGRID
 * name, else 0. */
int vg_ugrid_kind(const char *name, struct vg_ugrid_kind *kind);

/** Read a mesh or a surface. The kind follows from the name (without a final
 * ".gz") and is checked against the content.
 *
 * Tags become patch ids; patches are sorted by id. Data after the cells (layer
 * counts, volume tags, ...) are ignored. The volume of cells is made positive,
 * and boundary faces are turned to point into their cells; a file without cells
 * is not changed. Unused points are kept.
 * @param out     unchanged on failure
 * @param turned  number of elements turned; may be NULL
 * Returns VG_ERR_IO, VG_ERR_FORMAT (truncated, or the name is that of another
 * kind: the message gives the right one), VG_ERR_INPUT (index out of range,
 * coordinate not finite) or VG_ERR_MEMORY. Threads: re-entrant. O(n). */
vg_status vg_ugrid_read(const char *path, struct vg_mesh *out,
                        struct vg_turned *turned, struct vg_error *err);

/** As vg_ugrid_read, for bytes in memory of a given kind. */
vg_status vg_ugrid_parse(struct vg_input *in, const struct vg_ugrid_kind *kind,
                         struct vg_mesh *out, struct vg_turned *turned,
                         struct vg_error *err);

/** Read only the seven counts of a file: points, triangles, quadrilaterals,
 * tetrahedra, pyramids, prisms, hexahedra. */
vg_status vg_ugrid_peek(const char *path, uint64_t count[7],
                        struct vg_error *err);

/** Number of layer tetrahedra, if the file has a tail that contains it
 * (formats.md 2.4); otherwise *is_known is 0. Tails of text files are not
 * read. */
vg_status vg_ugrid_layer_tets(const char *path, int *is_known, size_t *n,
                              struct vg_error *err);

/** Write in the kind given by the name, without a tail. Single-precision kinds
 * round the coordinates: VG_ERR_GEOMETRY if this makes cells flat or inverted,
 * or points coincident. VG_ERR_UNSUPPORTED if counts exceed the integers of the
 * kind. The file appears complete or not at all. */
vg_status vg_ugrid_write(const char *path, const struct vg_mesh *m,
                         struct vg_error *err);

/** As vg_ugrid_write, followed by the first part of the tail (formats.md 2.4):
 * the number of layer tetrahedra, an integer of the kind's size, and a record
 * of its own in Fortran kinds. The layer tetrahedra must be the first ones of
 * the file. Other readers ignore the tail, as vg_ugrid_read does.
 * @param n_layer_tet  0 .. m->n_tet, else VG_ERR_INPUT; mixed meshes, whose
 *                     layers are mostly prisms, have few or none */
vg_status vg_ugrid_write_tail(const char *path, const struct vg_mesh *m,
                              size_t n_layer_tet, struct vg_error *err);

/* --- layout of binary files, for readers of slices ------------------------ */

/** Number of nodes and name of a triangle, quadrilateral, tetrahedron, pyramid,
 * prism and hexahedron: the order of the counts in the header, which start with
 * the points. */
extern const int vg_ugrid_width[6];
extern const char *const vg_ugrid_element[6];

/** Reads the counts of a binary header at the start of a file, without checking
 * them. Returns 0 if the file is shorter than a header or the record marker
 * differs. */
int vg_ugrid_counts(const struct vg_input *file,
                    const struct vg_ugrid_kind *kind, uint64_t count[7]);

/** VG_ERR_FORMAT if header and size of the file do not match this binary kind;
 * the message names the kind that they match. Uses the first 64 kB. */
vg_status vg_ugrid_check_kind(const struct vg_input *in,
                              const struct vg_ugrid_kind *kind,
                              struct vg_error *err);

/** Offset in the body of the nodes of an element kind; for element 6, its
 * end. */
uint64_t vg_ugrid_nodes_at(const struct vg_ugrid_kind *kind,
                           const uint64_t count[7], int element);

/** Reads integers of either size into 32 bits; one that does not fit becomes
 * `odd`. */
vg_status vg_ugrid_ints(struct vg_input *in, int int_size, size_t n, int32_t *v,
                        int32_t odd, const char *what, struct vg_error *err);

#endif
