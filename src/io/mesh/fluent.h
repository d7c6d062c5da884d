/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/mesh/fluent.h: writer of meshes for Fluent, as text (ANSYS Fluent User's
 * Guide, "Mesh file format"): points, faces with the cells on both sides, and
 * the kinds of cells. Numbers of points, faces and cells start from 1 and are
 * hexadecimal. */
#ifndef VG_IO_MESH_FLUENT_H
#define VG_IO_MESH_FLUENT_H

#include "core/mesh/mesh.h"
#include "core/periodic/periodic.h"
#include "io/stream/patch_words.h"
#include "io/stream/stream.h"

#define VG_FLUENT_SUFFIX "fluent.msh"

/** Write the cells as zone "fluid", the faces between them as zone "interior",
 * and one zone per patch. A mesh with zones has a zone of cells, of the type
 * fluid or solid, and one of faces, "interior_NAME", for each of them; faces
 * between two of them that are in no sheet are the zone "interior_between".
 * Names of patches are those of vg_patch_words; a zone whose name a patch has
 * is called "fluid_1" or "interior_1". Each sheet is another zone of the type
 * interior. The type of a zone follows from its boundary condition: wall,
 * symmetry, pressure-far-field, pressure-inlet or pressure-outlet; a patch
 * without a condition is a wall. Cells keep their order, in each zone:
 * tetrahedra, pyramids, prisms, hexahedra. The right-hand normal of a face
 * points into its first cell; boundary faces have no second cell. Numbers are
 * written in columns of one width, so that all ranks can write one file. Reals
 * read back to the same bits. VG_ERR_INPUT: no cells, or the boundary does not
 * close the cells; VG_ERR_UNSUPPORTED: more faces than an OpenFOAM mesh can
 * have (io/mesh/foam.h); VG_ERR_IO, VG_ERR_MEMORY. No file is left on failure.
 * O(n); memory 16 bytes per tetrahedron and 16 per point. */
vg_status vg_fluent_write(const char *path, const struct vg_mesh *m,
                          struct vg_error *err);

/* --- parts of the file, for the writer of slices (io/slices) --- */

enum { VG_FLUENT_KINDS = 4 }; /* tetrahedra, pyramids, prisms, hexahedra */

/** Layout of a file; determined by the counts. */
struct vg_fluent {
  const struct vg_mesh *frame;
  char (*word)[VG_PATCH_WORD]; /* [n_patch + n_sheet + n_zone] */
  size_t *start, *order;       /* from vg_boundary_by_patch */
  int width;                   /* width of a number */
  int *kind;                   /* [n_patch] 3 or 4 vertices per face, 0: both */
  uint64_t n_cell, first[VG_FLUENT_KINDS];
  uint64_t n_internal, n_quad; /* number of faces between cells; number of
                                  those with four vertices */
  uint64_t at_point, at_cell, at_internal, *at_patch; /* offsets in the file */
  /* With zones: [n_cell] number of a cell in the file, in which zones follow
   * each other, and its zone. Slices have none. */
  uint32_t *number, *zone;
  const struct vg_periodic_links *links; /* NULL: no patch is periodic */
  uint64_t *face_at; /* [n_tri + n_quad] with links: place of each face in
                        `order` */
  uint64_t *n_face;  /* [2 (n_zone + 1)] faces of the zones of faces, and those
                        of them with four vertices */
};

/** Compute the layout.
 * @param n_internal  number of faces between two cells, n_quad of which have 4
 *                    vertices
 * Errors as for vg_fluent_write. Must be released after success. */
vg_status vg_fluent_plan(const char *path, const struct vg_mesh *frame,
                         uint64_t n_internal, uint64_t n_quad,
                         struct vg_fluent *f, struct vg_error *err);
void vg_fluent_release(struct vg_fluent *f);

/** Number the faces for links; after vg_fluent_plan. VG_ERR_MEMORY. */
vg_status vg_fluent_number_faces(struct vg_fluent *f, struct vg_error *err);

/** Write the file but skip points, kinds of cells, and faces. */
void vg_fluent_put_frame(struct vg_output *out, struct vg_fluent *f);

/** Move to a point; vg_fluent_put_point then writes it. */
void vg_fluent_seek_point(struct vg_output *out, const struct vg_fluent *f,
                          uint64_t point);
void vg_fluent_put_point(struct vg_output *out, const double x[3]);

/** Move to cell number `cell` of a kind and write the kinds of n cells. Does
 * nothing if all cells of the mesh are of one kind. */
void vg_fluent_put_kinds(struct vg_output *out, const struct vg_fluent *f,
                         int kind, uint64_t cell, uint64_t n);

/** Move to an internal face; write one. It has n nodes, and its normal points
 * out of the lower cell `cell` into the higher cell `mate`, both counted from
 * 0. */
void vg_fluent_seek_internal(struct vg_output *out, const struct vg_fluent *f,
                             uint64_t face);
void vg_fluent_put_internal(struct vg_output *out, const struct vg_fluent *f,
                            int n, const uint32_t *node, uint32_t cell,
                            uint32_t mate);

/** Move to a boundary face given by its position in `order`; write it with its
 * cell. */
void vg_fluent_seek_boundary(struct vg_output *out, const struct vg_fluent *f,
                             size_t at);
void vg_fluent_put_boundary(struct vg_output *out, const struct vg_fluent *f,
                            size_t at, uint32_t cell);

#endif
