/* core/front/void.h: the state of a mesh being grown.
 *
 * A void is what is still to be meshed: a closed, oriented triangulation, the
 * front. Growing (core/fill/grow.h) turns part of it into cells and leaves a
 * smaller void; so at any moment the cells and the void together fill the
 * domain, and a void can be stopped, stored, sent or cut. */
#ifndef VG_CORE_FRONT_VOID_H
#define VG_CORE_FRONT_VOID_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "core/mesh/mesh.h"

struct vg_void {
  size_t n_point, cap_point;
  double (*x)[3];            /* [n_point] points of the front and the cells */
  size_t n_face, cap_face;
  uint32_t (*face)[3];       /* [n_face] the front, facing the void */
  size_t n_cell, cap_cell;
  uint32_t (*cell)[4];       /* [n_cell] cells grown so far, positive */
};
#define VG_VOID_INIT { 0 }

void vg_void_release(struct vg_void *v);

/** A void bounded by the triangles of m. Copies. VG_ERR_INPUT for quads or
 * an index out of range. *v must be empty. */
vg_status vg_void_from_mesh(struct vg_void *v, const struct vg_mesh *m,
                            struct vg_error *err);

/** Is every edge of the front used equally often in both directions, and is
 * every cell positive? 0, or the number of violations. O(n log n). */
size_t vg_void_defects(const struct vg_void *v);

/** Store in a stream, and restore into the empty *v: header "VGVOID1\\n",
 * three 64-bit counts, then the arrays, in this machine's byte order (a
 * checkpoint, not an exchange format). VG_ERR_IO, VG_ERR_FORMAT. */
vg_status vg_void_save(const struct vg_void *v, FILE *to,
                       struct vg_error *err);
vg_status vg_void_load(struct vg_void *v, FILE *from, struct vg_error *err);

#endif
