/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/delaunay/tets.h: a modifiable tetrahedralisation: cells with their
 * neighbours, constrained faces, and a location walk. The working state of
 * boundary recovery, point insertion and optimisation. Uses base only.
 *
 * Cell v0 v1 v2 v3 is positive: v0 v1 v2 are counter-clockwise seen from v3.
 * Face i is opposite vertex i. A link is 4 * cell + face of the neighbour, or
 * VG_NONE if there is no neighbour. One void therefore has fewer than 2^30
 * cells. */
#ifndef VG_CORE_DELAUNAY_TETS_H
#define VG_CORE_DELAUNAY_TETS_H

#include <assert.h>
#include <stddef.h>
#include <stdint.h>

#include "base/hash.h"
#include "base/status.h"

#define VG_NONE UINT32_MAX
#define VG_CELL_MAX (1u << 30)

struct vg_cell {
  uint32_t v[4];
  uint32_t link[4];
};

enum {                        /* bits of vg_tets.flag */
       VG_FIXED_FACES = 0x0f, /* bit i: face i is constrained */
       VG_OUTSIDE = 0x10,     /* not in the fluid */
       VG_DEAD = 0x20,        /* slot on the free list */
       VG_MARK = 0x40,        /* scratch bit of one operation, otherwise
                                 clear */
       VG_TRIED = 0x80        /* another scratch bit */
};

struct vg_tets {
  size_t n_point, cap_point;
  double (*x)[3];          /* [n_point] */
  size_t n_cell, cap_cell; /* number of slots, including dead ones */
  struct vg_cell *cell;
  uint8_t *flag; /* [n_cell] */
  size_t n_free, cap_free;
  uint32_t *free; /* dead slots, used last in, first out */
};
#define VG_TETS_INIT                                                           \
  {                                                                            \
    0                                                                          \
  }

/* Vertices of face i, ordered so that vertex i is on the positive side. */
extern const uint8_t vg_face[4][3];

void vg_tets_release(struct vg_tets *t);

/** Reserve memory for n more points or cells. Returns 0, or -1 if it is
 * refused. */
int vg_tets_reserve_points(struct vg_tets *t, size_t n);
int vg_tets_reserve_cells(struct vg_tets *t, size_t n);

/** A slot for a new cell: a dead one if available, else the next. Call
 * vg_tets_reserve_cells first. */
static inline uint32_t vg_tets_alloc_cell(struct vg_tets *t)
{
  assert(t->n_free || t->n_cell < t->cap_cell);
  return t->n_free ? t->free[--t->n_free] : (uint32_t)t->n_cell++;
}

/** Put a cell on the free list. Returns 0, or -1 if memory is refused. */
int vg_tets_free_cell(struct vg_tets *t, uint32_t cell);

/** Begin to load the neighbours of a cell, which a search visits soon. */
static inline void vg_tets_prefetch(const struct vg_tets *t, uint32_t cell)
{
  for (int i = 0; i < 4; i++)
    __builtin_prefetch(&t->cell[t->cell[cell].link[i] >> 2]);
}

static inline void vg_tets_connect(struct vg_tets *t, uint32_t a, uint32_t b)
{
  assert(a >> 2 < t->n_cell && b >> 2 < t->n_cell);
  t->cell[a >> 2].link[a & 3] = b;
  t->cell[b >> 2].link[b & 3] = a;
}

/** Compute all links from the vertices, in O(n) expected time. VG_ERR_GEOMETRY
 * if a face has more than two cells. */
vg_status vg_tets_link(struct vg_tets *t, struct vg_error *err);

/** Link the faces whose link is VG_NONE with one another where their vertices
 * are the same. Errors as above, among these faces. */
vg_status vg_tets_link_open(struct vg_tets *t, struct vg_error *err);

/** Build *t (empty) from points and cells of either orientation, and link them.
 * t takes ownership of x, also on failure. VG_ERR_GEOMETRY for a flat cell. */
vg_status vg_tets_from_cells(struct vg_tets *t, size_t n_point, double (*x)[3],
                             size_t n_cell, const uint32_t (*v)[4],
                             struct vg_error *err);

/** First face that step `step` of a walk tries, 0 to 3. It varies with the
 * step, so that a walk in a non-Delaunay mesh does not cycle forever. */
static inline uint32_t vg_walk_turn(uint32_t step)
{
  return step * VG_GOLDEN_32 >> 30;
}

/** Walk from `start` to a cell that contains x (boundary included). The walk
 * crosses constrained faces and ignores dead cells. VG_NONE if x is outside
 * all cells; this is reliable only if the cells fill a convex hull (before
 * vg_tets_compact removes some). */
uint32_t vg_tets_locate(const struct vg_tets *t, uint32_t start,
                        const double x[3]);

/** Remove dead and outside cells, and reorder the rest so that neighbours are
 * close together: points from n_keep on along a Hilbert curve, with unused
 * points dropped (points before n_keep keep their numbers), and cells by their
 * highest point. Links to removed cells become VG_NONE. VG_ERR_MEMORY if
 * memory is refused. */
vg_status vg_tets_compact(struct vg_tets *t, size_t n_keep,
                          struct vg_error *err);

/** Number of live cells whose volume is not positive. O(n). */
size_t vg_tets_inverted(const struct vg_tets *t);

/** Number of inconsistencies: wrong links, cells that are not positive, and
 * faces that are constrained on one side only, unless one of their cells is in
 * the fluid and the other outside. For checks of stages and for tests. O(n). */
size_t vg_tets_defects(const struct vg_tets *t);

#endif
