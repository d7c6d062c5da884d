/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/stream/narrow.h: effects of rounding coordinates to 4-byte reals: cells
 * that become flat or inverted, and points that coincide. Uses core. */
#ifndef VG_IO_STREAM_NARROW_H
#define VG_IO_STREAM_NARROW_H

#include <stddef.h>
#include <stdint.h>

#include "base/comm.h"

struct vg_narrow {
  uint64_t n_cell;     /* cells whose positive volume is lost by rounding */
  uint64_t kind, cell; /* kind (as in vg_cell_positive) of the first such
                          cell, and its number within that kind */
  double at[3];        /* centre of that cell */
  uint64_t n_point;    /* points that coincide with another point only after
                          rounding */
  uint64_t point;      /* first such point */
  double x[3];
};
#define VG_NARROW_INIT                                                         \
  {                                                                            \
    .n_cell = 0                                                                \
  }

/** Check cells of one kind, numbered from `first` on, and add the result to
 * *to.
 *
 * @param x        their points
 * @param rounded  the same points rounded by vg_narrow_round
 * Threads: safe on distinct *to. Cost: one determinant per tetrahedron. */
void vg_narrow_cells(const double (*x)[3], const double (*rounded)[3], int kind,
                     size_t n, const uint32_t *node, uint64_t first,
                     struct vg_narrow *to);
void vg_narrow_round(size_t n, const double (*x)[3], double (*rounded)[3]);

/** Check n points: O(n log n). VG_ERR_MEMORY. */
vg_status vg_narrow_points(size_t n, const double (*x)[3], struct vg_narrow *to,
                           struct vg_error *err);

/** Add the result for another part of the mesh, or combine those of all ranks
 * (collective). */
void vg_narrow_add(struct vg_narrow *to, const struct vg_narrow *more);
vg_status vg_narrow_share(struct vg_comm *comm, struct vg_narrow *n,
                          struct vg_error *err);

/** Returns VG_OK if rounding does no damage, otherwise VG_ERR_GEOMETRY with a
 * message about a file of this kind that recommends the kind `instead`. */
vg_status vg_narrow_accept(const struct vg_narrow *n, const char *kind,
                           const char *instead, struct vg_error *err);

#endif
