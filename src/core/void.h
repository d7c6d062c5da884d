/* core/void.h: the state of a mesh being grown.
 *
 * A void is what is still to be meshed: a closed, oriented triangulation, the
 * front. Growing (core/grow.h) turns part of it into cells and leaves a
 * smaller void; so at any moment the cells and the void together fill the
 * domain. */
#ifndef VG_CORE_VOID_H
#define VG_CORE_VOID_H

#include <stddef.h>
#include <stdint.h>

#include "core/mesh.h"

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

#endif
