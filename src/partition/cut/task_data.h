/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* partition/cut/task_data.h: input and outcome of a task of the advancing
 * partition. Uses core. */
#ifndef VG_PARTITION_CUT_TASK_DATA_H
#define VG_PARTITION_CUT_TASK_DATA_H

#include <stddef.h>
#include <stdint.h>

#include "base/comm.h"
#include "core/fill/fill.h"
#include "core/front/front.h"
#include "core/front/region.h"
#include "core/mesh/packed_cells.h"
#include "partition/engine/spans.h"
#include "partition/load/load.h"

/* Global id of a point in a front: the serial of the task that created it, and
 * its index there. Serials depend on timing, so ids are compared for equality
 * only, and final numbers are given at the end (number.c). Serial 0: the
 * points of the boundary, in their order. */
#define VG_POINT_ID(serial, k) ((uint64_t)(serial) << 32 | (uint32_t)(k))

/** First point of a face that is no longer part of a front, only while a node
 * is being cut (node.c); fronts of tasks have no such faces. */
#define VG_FACE_GONE UINT32_MAX

/** PVGRID's estimate of the time to fill a subdomain, from its front alone: its
 * volume times the number of its faces, divided by their area (a length). 0 if
 * the front encloses nothing. O(faces). */
double vg_front_work(const struct vg_front *f);

/** Submesh that a task leaves on its executing rank. */
struct vg_piece {
  char path[VG_PATH_MAX];
  char kind; /* VG_SPAN_... */
  uint32_t serial;
  size_t n_in, n_point, n_cell;
  size_t n_adopted; /* Part of n_point: adopted points of a leaf, which
                       other pieces also use. */
  uint64_t *in;     /* [n_in] Global ids of points of other pieces. */
  double (*x)[3];   /* [n_in + n_point] Points of others, then its own. */
  struct vg_packed_cells cell; /* [n_cell] Indices into x. */
};
#define VG_PIECE_INIT                                                          \
  {                                                                            \
    .n_in = 0                                                                  \
  }

void vg_piece_release(struct vg_piece *p);

/** Points of cell c, indices into p->x. */
static inline void vg_piece_cell(const struct vg_piece *p, size_t c,
                                 uint32_t v[4])
{
  vg_packed_cell(&p->cell, c, v);
}

/** Bytes of memory of the arrays. */
size_t vg_piece_bytes(const struct vg_piece *p);

/** Outcome of a zone for its home rank: the change of the front. */
struct vg_change {
  int blocked;           /* 1: nothing was made. */
  uint32_t serial;       /* Serial of the zone's task. */
  size_t n_part;         /* Points of the front that the zone was given. */
  struct vg_filled made; /* Without cells, which stay with the piece. */
};
#define VG_CHANGE_INIT                                                         \
  {                                                                            \
    0                                                                          \
  }

struct vg_writer;
struct vg_reader;
void vg_change_release(struct vg_change *c);
void vg_change_put(struct vg_writer *w, const struct vg_change *c);
void vg_change_get(struct vg_reader *r, struct vg_change *c);

#endif
