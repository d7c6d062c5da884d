/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/picture/worst.h: selected cells with the cells around them. Uses
 * core/mesh/slices.h. */
#ifndef VG_RUN_PICTURE_WORST_H
#define VG_RUN_PICTURE_WORST_H

#include "base/comm.h"
#include "core/mesh/slices.h"

enum { VG_AROUND_MAX = 400 }; /* Most cells around one cell. */

/** A tetrahedron and the tetrahedra of its slice that share a point with it. */
struct vg_around {
  size_t n;
  double (*cell)[4][3]; /* [n], the tetrahedron first; owned. */
};

/** Finds the surroundings of tetrahedra, on rank 0; n = 0 on other ranks, and
 * for numbers that do not exist. Collective; visits every slice of the field
 * once.
 * @param id   [n] numbers among the tetrahedra of the mesh
 * @param out  [n]; vg_around_release */
vg_status vg_around_find(struct vg_comm *comm, const struct vg_slices *s,
                         int threads, size_t n, const uint64_t *id,
                         struct vg_around *out, struct vg_error *err);

void vg_around_release(struct vg_around *a, size_t n);

#endif
