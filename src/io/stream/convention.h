/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/stream/convention.h: conversion of file contents to the conventions of
 * core/mesh/mesh.h. Shared by the readers. Orientations in files are never
 * trusted. */
#ifndef VG_IO_STREAM_CONVENTION_H
#define VG_IO_STREAM_CONVENTION_H

#include <stddef.h>
#include <stdint.h>

#include "core/mesh/mesh.h"

struct vg_turned {
  size_t cell;       /* cells of negative volume, which were mirrored */
  size_t face;       /* boundary faces turned to point into the fluid */
  size_t loose_face; /* boundary faces that belong to no cell, left unchanged */
};

/** Make the volume of every cell positive and turn every boundary face to point
 * into its cell. A mesh without cells is not changed. Indices must be valid.
 * turned may be NULL.
 * Tetrahedra are tested exactly, other cells by their volume in double
 * precision; cells of zero volume are not changed. O(n) time; memory O(points +
 * boundary). */
vg_status vg_mesh_turn(struct vg_mesh *m, struct vg_turned *turned,
                       struct vg_error *err);

/** The part of vg_mesh_turn for cells: mirrors those of negative volume and
 * returns their number. */
size_t vg_mesh_turn_cells(struct vg_mesh *m);

/** The number after the last point of the boundary, from the faces only; 0
 * without faces. */
size_t vg_mesh_boundary_end(const struct vg_mesh *m);

/** Sides of the boundary faces on which there are cells, for a mesh whose cells
 * come in parts. Not thread-safe. */
struct vg_face_sides;

/** Enters the boundary faces of m, which must stay valid and unchanged.
 * O(boundary) memory. The caller frees *out with vg_face_sides_free.
 * VG_ERR_MEMORY. */
vg_status vg_face_sides_new(const struct vg_mesh *m, struct vg_face_sides **out,
                            struct vg_error *err);

/** Finds the boundary faces of the cells of `part`, whose volumes are positive
 * and whose nodes have the numbers of m. */
void vg_face_sides_meet(struct vg_face_sides *t, const struct vg_mesh *part);

/** Once all cells have been met: turns the faces of m as vg_mesh_turn does,
 * *n of them. Returns 0 if a face lies between two cells; m is then
 * unchanged. */
int vg_face_sides_turn(const struct vg_face_sides *t, struct vg_mesh *m,
                       size_t *n);
void vg_face_sides_free(struct vg_face_sides *t);

/* Faces listed as boundary that lie between two cells. */
struct vg_inner_faces {
  size_t n_sheet_face; /* triangles that became sheets */
  size_t n_face;       /* faces removed: quadrilaterals, and copies of faces */
  size_t n_copy;       /* of these: faces whose points an earlier face has */
  char patches[160];   /* their patches with the number of faces of each:
                          "interface (120), wake (48)" */
};

/* Format of a note: path, n_face, patches. */
#define VG_INNER_FACES_NOTE                                                    \
  "%s: %zu boundary faces lie between two cells and are quadrilaterals or "    \
  "copies of other faces; they were removed (patches: %s)"

/* Format of a note: path, n_sheet_face. */
#define VG_SHEET_FACES_NOTE                                                    \
  "%s: %zu triangles lie between two cells; they are sheets, which are no "    \
  "part of the boundary"

/** Take the boundary faces that join two cells on opposite sides out of the
 * boundary, with the patches that have no other faces. Triangles become sheets
 * (core/mesh/sheets.h); other faces, and further copies of a face, are removed.
 * Programs write such faces for sheets, and for the interface of two volumes
 * (Gmsh) or of two kinds of cells (Mmg). The order of faces and patches is
 * kept. Indices must be valid. O(n) time; memory O(points + boundary).
 * @param m      without sheets
 * @param found  all zero without such faces
 * VG_ERR_MEMORY: the mesh is unchanged. */
vg_status vg_mesh_take_inner(struct vg_mesh *m, struct vg_inner_faces *found,
                             struct vg_error *err);

/** Fail with VG_ERR_INPUT, naming the first point with a coordinate that is not
 * finite or has a magnitude that is not between VG_COORDINATE_MIN and
 * VG_COORDINATE_MAX. */
vg_status vg_check_points(const char *path, size_t n, const double (*p)[3],
                          struct vg_error *err);

/** Convert n 1-based indices of a file, `width` per element, to 0-based ones in
 * place. VG_ERR_INPUT names the first element ("triangle 7") that refers to a
 * point outside 1 .. n_point. */
vg_status vg_index_from_file(const char *path, const char *element, size_t n,
                             int width, size_t n_point, uint32_t *index,
                             struct vg_error *err);

/** Set patch[], tri_patch and quad_patch from one tag per boundary face.
 * Patches are sorted by tag. O(n) for any number of tags.
 *
 * @param tag  [n_tri + n_quad], triangles first */
vg_status vg_patches_from_tags(struct vg_mesh *m, const int32_t *tag,
                               struct vg_error *err);

/** Copy a name, shortened to size - 1 bytes if necessary, but never within a
 * UTF-8 character, which would make the text unreadable. Control characters,
 * which would damage the files written, become '_'. */
void vg_name_from_file(const char *text, size_t len, char *name, size_t size);

/** Remove the cells and all points that no boundary face uses; the order is
 * kept. */
void vg_mesh_keep_boundary(struct vg_mesh *m);

#endif
