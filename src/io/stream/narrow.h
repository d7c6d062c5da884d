/* io/stream/narrow.h: what becomes of a mesh whose coordinates are rounded to
 * 4-byte reals: cells that are flat or inverted then, points that coincide.
 * Uses core. */
#ifndef VG_IO_STREAM_NARROW_H
#define VG_IO_STREAM_NARROW_H

#include <stddef.h>
#include <stdint.h>

#include "base/comm.h"

struct vg_narrow {
  uint64_t n_cell;     /* cells that are positive, but not so rounded */
  uint64_t kind, cell; /* the first of them: kind as in vg_cell_positive,
                          number in its kind */
  double at[3];        /* its centre */
  uint64_t n_point;    /* points that coincide with another one only when
                          rounded */
  uint64_t point;      /* the first of them */
  double x[3];
};
#define VG_NARROW_INIT                                                         \
  {                                                                            \
    .n_cell = 0                                                                \
  }

/** Cells of one kind, numbered from `first` on, added to *to.
 *
 * @param x        their points
 * @param rounded  the same, by vg_narrow_round
 * Threads: safe on distinct *to. Cost: a determinant per tetrahedron. */
void vg_narrow_cells(const double (*x)[3], const double (*rounded)[3], int kind,
                     size_t n, const uint32_t *node, uint64_t first,
                     struct vg_narrow *to);
void vg_narrow_round(size_t n, const double (*x)[3], double (*rounded)[3]);

/** Points: O(n log n). VG_ERR_MEMORY. */
vg_status vg_narrow_points(size_t n, const double (*x)[3], struct vg_narrow *to,
                           struct vg_error *err);

/** Cells of another part of the mesh; of all ranks (collective). */
void vg_narrow_add(struct vg_narrow *to, const struct vg_narrow *more);
vg_status vg_narrow_share(struct vg_comm *comm, struct vg_narrow *n,
                          struct vg_error *err);

/** VG_OK where rounding did no harm; else VG_ERR_GEOMETRY for a file of this
 * kind, with the kind to be written instead. */
vg_status vg_narrow_accept(const struct vg_narrow *n, const char *kind,
                           const char *instead, struct vg_error *err);

#endif
