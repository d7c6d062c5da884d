/* io/stream/convention.h: what a file says, turned into the conventions of
 * core/mesh/mesh.h. Shared by the readers. Rule: never trust a sign. */
#ifndef VG_IO_STREAM_CONVENTION_H
#define VG_IO_STREAM_CONVENTION_H

#include <stddef.h>
#include <stdint.h>

#include "core/mesh/mesh.h"

struct vg_turned {
  size_t cell;       /* cells of negative volume that were mirrored */
  size_t face;       /* boundary faces that were turned into the fluid */
  size_t loose_face; /* boundary faces of no cell, kept as they are */
};

/** Make every cell positive and every boundary face of a cell point into it.
 * A mesh without cells is left as it is. Indices must be valid. turned may be
 * NULL.
 * Tetrahedra are tested exactly; other cells by their volume in doubles;
 * cells of zero volume stay. O(n) time; memory O(points + boundary). */
vg_status vg_mesh_turn(struct vg_mesh *m, struct vg_turned *turned,
                       struct vg_error *err);

/* Up to here products of three differences stay exact
 * (core/geometry/predicates.h). */
#define VG_COORDINATE_MAX 1e60

/** Fail (VG_ERR_INPUT) naming the first point that is not finite, or beyond
 * VG_COORDINATE_MAX. */
vg_status vg_check_points(const char *path, size_t n, const double (*p)[3],
                          struct vg_error *err);

/** Turn n 1-based indices of a file, `width` per element, into 0-based ones
 * in place; VG_ERR_INPUT names the first element ("triangle 7") that refers
 * to a point outside 1..n_point. */
vg_status vg_index_from_file(const char *path, const char *element, size_t n,
                             int width, size_t n_point, uint32_t *index,
                             struct vg_error *err);

/** Set patch[], tri_patch and quad_patch from one tag per boundary face.
 * Patches are ordered by rising tag. O(n), however many tags there are.
 *
 * @param tag  [n_tri + n_quad], triangles first */
vg_status vg_patches_from_tags(struct vg_mesh *m, const int32_t *tag,
                               struct vg_error *err);

/** A name as it is kept, cut to size - 1 bytes, yet never within a UTF-8
 * character, which would leave text that no reader takes. Control characters,
 * which would upset the files that it is written to, become '_'. */
void vg_name_from_file(const char *text, size_t len, char *name, size_t size);

/** Drop cells and the points that no boundary face uses; order is kept. */
void vg_mesh_keep_boundary(struct vg_mesh *m);

#endif
