/* run/picture/worst.h: cells that stand out, with the cells around them. Uses
 * core/mesh/slices.h. */
#ifndef VG_RUN_PICTURE_WORST_H
#define VG_RUN_PICTURE_WORST_H

#include "base/comm.h"
#include "core/mesh/slices.h"

enum { VG_AROUND_MAX = 400 }; /* cells of one */

/** A tetrahedron and those that share a point with it, in its slice. */
struct vg_around {
  size_t n;
  double (*cell)[4][3]; /* [n], the tetrahedron first; owned */
};

/** The surroundings of tetrahedra, on rank 0; n = 0 elsewhere, and of numbers
 * that are none. Collective; costs every slice of the field once.
 * @param id   [n] numbers among the tetrahedra of the mesh
 * @param out  [n]; vg_around_release */
vg_status vg_around_find(struct vg_comm *comm, const struct vg_slices *s,
                         int threads, size_t n, const uint64_t *id,
                         struct vg_around *out, struct vg_error *err);

void vg_around_release(struct vg_around *a, size_t n);

#endif
