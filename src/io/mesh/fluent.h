/* io/mesh/fluent.h: meshes for Fluent, written only, as text (ANSYS Fluent
 * User's Guide, "Mesh file format"): points, faces with the cells on their two
 * sides, kinds of cells. Numbers of points, faces and cells, from 1, are
 * hexadecimal. */
#ifndef VG_IO_MESH_FLUENT_H
#define VG_IO_MESH_FLUENT_H

#include "core/mesh/mesh.h"
#include "io/stream/patch_words.h"
#include "io/stream/stream.h"

#define VG_FLUENT_SUFFIX "fluent.msh"

/** Write cells as zone "fluid", faces between them as "interior", and a zone
 * per patch, named as vg_patch_words has it, of a type by its condition: wall,
 * symmetry, pressure-far-field, pressure-inlet or pressure-outlet; without one
 * it is a wall. Cells keep their order: tetrahedra, pyramids, prisms,
 * hexahedra. The right-hand normal of a face points into its first cell; faces
 * of patches have no second one. Numbers stand in columns of one width, so that
 * all ranks write one file. Reals read back to the same bits.
 * VG_ERR_INPUT: no cells, or cells and boundary that do not close;
 * VG_ERR_UNSUPPORTED: more faces than an OpenFOAM mesh can have
 * (io/mesh/foam.h); VG_ERR_IO, VG_ERR_MEMORY. No file is left on failure.
 * O(n); memory 16 bytes per tetrahedron and 16 per point. */
vg_status vg_fluent_write(const char *path, const struct vg_mesh *m,
                          struct vg_error *err);

/* --- its parts, for the writer of meshes in slices (io/slices) --- */

enum { VG_FLUENT_KINDS = 4 }; /* tetrahedra, pyramids, prisms, hexahedra */

/** Layout of a file: follows from the counts. */
struct vg_fluent {
  const struct vg_mesh *frame;
  char (*word)[VG_PATCH_WORD]; /* [n_patch] */
  size_t *start, *order;       /* vg_boundary_by_patch */
  int width;                   /* columns of a number */
  int *kind;                   /* [n_patch] 3, 4 corners, 0: both */
  uint64_t n_cell, first[VG_FLUENT_KINDS];
  uint64_t n_internal, n_quad; /* faces between cells; of four corners */
  uint64_t at_point, at_cell, at_internal, *at_patch; /* in the file */
};

/** @param n_internal  faces between two cells, n_quad of them with 4 corners
 * Errors as of vg_fluent_write. On success to be released. */
vg_status vg_fluent_plan(const char *path, const struct vg_mesh *frame,
                         uint64_t n_internal, uint64_t n_quad,
                         struct vg_fluent *f, struct vg_error *err);
void vg_fluent_release(struct vg_fluent *f);

/** The file without points, kinds of cells and faces, which are skipped. */
void vg_fluent_put_frame(struct vg_output *out, struct vg_fluent *f);

/** Go to a point, which is put next. */
void vg_fluent_seek_point(struct vg_output *out, const struct vg_fluent *f,
                          uint64_t point);
void vg_fluent_put_point(struct vg_output *out, const double x[3]);

/** Go to n cells of a kind, and put them: nothing where all are of one. */
void vg_fluent_put_kinds(struct vg_output *out, const struct vg_fluent *f,
                         int kind, uint64_t cell, uint64_t n);

/** Go to an internal face; put one: n nodes, normal out of its lower cell,
 * and that cell and the higher one, both from 0. */
void vg_fluent_seek_internal(struct vg_output *out, const struct vg_fluent *f,
                             uint64_t face);
void vg_fluent_put_internal(struct vg_output *out, const struct vg_fluent *f,
                            int n, const uint32_t *node, uint32_t cell,
                            uint32_t mate);

/** Go to a face of the boundary, by its place in `order`; put it, with its
 * cell. */
void vg_fluent_seek_boundary(struct vg_output *out, const struct vg_fluent *f,
                             size_t at);
void vg_fluent_put_boundary(struct vg_output *out, const struct vg_fluent *f,
                            size_t at, uint32_t cell);

#endif
