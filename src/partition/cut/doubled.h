/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* partition/cut/doubled.h: a boundary with inner surfaces, which have every
 * triangle twice and most points more than once (core/sides/inner.h), except
 * where layers have separated the two sides.
 *
 * The void is filled as if each of these points occurred once: the first copy
 * stands for all of them in fronts and cells, so that both sides of an inner
 * surface are opposite faces of a front. When a piece is numbered, the corners
 * of its cells get the copies that belong to the sides on which the cells
 * are. */
#ifndef VG_PARTITION_CUT_DOUBLED_H
#define VG_PARTITION_CUT_DOUBLED_H

#include <stddef.h>
#include <stdint.h>

#include "core/front/front.h"
#include "core/mesh/mesh.h"
#include "core/mesh/slices.h"
#include "core/sides/sides.h"

struct vg_doubled {
  const struct vg_mesh *boundary; /* borrowed */
  uint32_t *first;     /* [n_point] first copy of each point; NULL: the boundary
                          has no inner surface, and all else is empty */
  uint8_t *has_copies; /* [n_point] 1: a first copy that is not the only one */
  uint32_t (*tri)[3];  /* triangles at points of inner surfaces, of each inner
                          pair only the front, by first copies */
  uint32_t *of;        /* [sides.n_tri] their numbers in the boundary */
  uint32_t *back;      /* [sides.n_tri] number of the other side, or
                          UINT32_MAX */
  struct vg_sides sides; /* of tri */
};

/** Find the copies in a boundary. *d is empty before. Nothing is done if no
 * patch is inner. VG_ERR_MEMORY, after which it is empty again. Same result on
 * all ranks. O(n) */
vg_status vg_doubled_new(struct vg_doubled *d, const struct vg_mesh *boundary,
                         struct vg_error *err);

void vg_doubled_release(struct vg_doubled *d);

/** Replace the corners of the faces of a front, whose points are those of the
 * boundary, by first copies, and drop the other copies. Ids do not change.
 * VG_ERR_MEMORY. */
vg_status vg_doubled_merge(const struct vg_doubled *d, struct vg_front *f,
                           struct vg_error *err);

/** Number of points that are not first copies. */
uint64_t vg_doubled_copies(const struct vg_doubled *d);

/** First copy of boundary point v. */
static inline uint32_t vg_doubled_first(const struct vg_doubled *d, uint32_t v)
{
  return d->first ? d->first[v] : v;
}

/** Does boundary point v, a first copy, have other copies? */
static inline int vg_doubled_is(const struct vg_doubled *d, uint32_t v)
{
  return d->first && d->has_copies[v];
}

/** Is the triangle of these boundary points, by their first copies, in an inner
 * surface? */
int vg_doubled_has(const struct vg_doubled *d, const uint32_t v[3]);

/** Give the cells of a slice with tetrahedra the copies of points that belong
 * to the sides on which they are. The slice, whose ids of boundary points are
 * first copies, gets further points, and a new block `keep`, which has all
 * arrays that may change; free it. VG_ERR_GEOMETRY for a cell that is so flat
 * that its side is not known; VG_ERR_MEMORY. On failure the slice is as
 * before. */
vg_status vg_doubled_slice(const struct vg_doubled *d, struct vg_slice *s,
                           struct vg_error *err);

#endif
