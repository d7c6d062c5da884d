/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/front/front.h: the boundary of a region that is still to be meshed.
 *
 * A front is an oriented triangulation whose faces look into the void, the
 * region without cells. It is the only boundary type between the surface and
 * the writers. Layers leave a front, and the decomposition cuts fronts. The
 * kernel (core/fill/fill.h) takes a front and returns cells, new faces of the
 * front, and the consumed faces, which have a cell now. At any moment, the
 * cells and the void fill the domain.
 *
 *        ______          faces look into the void:
 *       /      \           corners counter-clockwise as seen from the void
 *      |  void  |
 *       \______/         closed, unless stated to be a part of a larger front
 *
 * Threads: different fronts are independent. */
#ifndef VG_CORE_FRONT_FRONT_H
#define VG_CORE_FRONT_FRONT_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "core/mesh/mesh.h"
#include "core/mesh/mesh_defects.h"

struct vg_front {
  size_t n_point, n_face;
  double (*x)[3];      /* [n_point] coordinates */
  uint64_t *id;        /* [n_point] ids that points keep when the front is
                          cut or sent; NULL: points have no ids */
  uint32_t (*face)[3]; /* [n_face] indices of the corners */
  uint32_t *patch;     /* [n_face] patches of the faces; NULL: not known, as
                          in the fronts that tasks are given */
  uint32_t *face_id;   /* [n_face] ids of the faces; NULL: faces have no ids */
};
#define VG_FRONT_INIT                                                          \
  {                                                                            \
    0                                                                          \
  }

/** Free the arrays and leave *f empty. */
void vg_front_release(struct vg_front *f);

/** The triangles and points of a mesh as a front without ids. Its arrays are
 * borrowed from m: do not release the front. */
static inline struct vg_front vg_front_of(const struct vg_mesh *m)
{
  return (struct vg_front){ .n_point = m->n_point,
                            .n_face = m->n_tri,
                            .x = m->point,
                            .face = m->tri,
                            .patch = m->tri_patch };
}

/** A front with known patches as a mesh that has the patches of `surface`.
 * Borrows the arrays of both. */
static inline struct vg_mesh vg_front_mesh(const struct vg_front *f,
                                           const struct vg_mesh *surface)
{
  return (struct vg_mesh){ .n_point = f->n_point,
                           .point = f->x,
                           .n_tri = f->n_face,
                           .tri = f->face,
                           .tri_patch = f->patch,
                           .n_patch = surface->n_patch,
                           .patch = surface->patch };
}

/** VG_ERR_INPUT names a face with an index out of range, or a point that no
 * face uses. O(points + faces). */
vg_status vg_front_check(const struct vg_front *f, struct vg_error *err);

/** Number of edges that are not used equally often in both directions; 0 for a
 * closed front. SIZE_MAX if memory is refused. O(n log n). */
static inline size_t vg_front_open_edges(const struct vg_front *f)
{
  const struct vg_mesh m = {
    .n_point = f->n_point, .point = f->x, .n_tri = f->n_face, .tri = f->face
  };

  return vg_mesh_open_edges(&m);
}

/** Volume of the void that a closed front encloses; negative for a shell
 * around a body. */
double vg_front_volume(const struct vg_front *f);

/** Append a front to the bytes of a message or record. ids = 0: without ids. */
struct vg_writer;
struct vg_reader;
void vg_front_put(struct vg_writer *w, const struct vg_front *f, int ids);
/** Read a front written by vg_front_put. Damaged data set r->bad and leave *f
 * empty. */
void vg_front_get(struct vg_reader *r, struct vg_front *f, int ids);

/** Add the points and faces of `from` to a front (join); merge points with the
 * same id (weld); do both (append). Both fronts must have ids. VG_ERR_MEMORY;
 * the caller releases *to in this case, too. */
vg_status vg_front_join(struct vg_front *to, const struct vg_front *from,
                        struct vg_error *err);
vg_status vg_front_weld(struct vg_front *f, struct vg_error *err);
vg_status vg_front_append(struct vg_front *to, const struct vg_front *from,
                          struct vg_error *err);

#endif
