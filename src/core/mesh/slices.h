/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/mesh/slices.h: a mesh that no process holds as a whole. Uses base,
 * mesh.h.
 *
 * A slice is a contiguous run of the mesh's points and of its cells of each
 * kind. It also contains the points of other slices that its cells use. Every
 * rank serves some of the slices. Together, the slices contain each point and
 * each cell of the mesh once. The boundary, O(N^(2/3)), is known on every
 * rank. The division into slices, and all numbers in them, depend on the input
 * only; the assignment of slices to ranks may vary. */
#ifndef VG_CORE_MESH_SLICES_H
#define VG_CORE_MESH_SLICES_H

#include <stddef.h>
#include <stdint.h>

#include "core/mesh/mesh.h"

enum { VG_SLICE_TET, VG_SLICE_PYR, VG_SLICE_PRI, VG_SLICE_HEX, VG_SLICE_KINDS };

/* Number of nodes of a cell of each kind. */
static const unsigned char vg_slice_width[VG_SLICE_KINDS] = { 4, 5, 6, 8 };

struct vg_slice {
  size_t n_point;       /* local points */
  const double (*x)[3]; /* [n_point] */
  const uint32_t *id;   /* [n_point] index in the mesh */
  /* Points that this slice owns: point_at + k of the mesh is local point
   * own[k]. Every point of the mesh is owned by exactly one slice. */
  uint64_t point_at;
  size_t n_own;
  const uint32_t *own;              /* [n_own] */
  uint64_t cell_at[VG_SLICE_KINDS]; /* index of the first cell among the
                                       mesh's cells of the kind */
  size_t n_cell[VG_SLICE_KINDS];
  const uint32_t *cell[VG_SLICE_KINDS]; /* [n_cell][4, 5, 6, 8] local points,
                                           in the node order of
                                           core/mesh/mesh.h */
  const uint32_t *part[VG_SLICE_KINDS]; /* [n_cell] solver partition, <
                                           n_part; NULL if the slices have no
                                           n_part */
  uint32_t domain; /* number of the subdomain; 0 for layers */
  uint8_t kind;    /* 0: layers, 1: leaf, 2: separator zone, 3: repair */
  void *keep;      /* private data of the server */
};

struct vg_slices {
  /* Counts of the whole mesh. */
  uint64_t n_point, n_cell[VG_SLICE_KINDS];
  uint64_t n_boundary_point; /* boundary points come first */
  uint64_t n_copy; /* boundary points with the coordinates of earlier ones:
                      both sides of inner surfaces */
  uint64_t n_layer_point;                /* index after the last layer point */
  uint64_t n_layer_cell[VG_SLICE_KINDS]; /* layer cells come first of their
                                            kind */
  uint32_t n_part;                       /* number of solver partitions; 0:
                                            mesh is not partitioned */
  /* Boundary of the mesh on every rank: patches, triangles and quadrilaterals
   * with point indices of the mesh; no points, no cells. */
  const struct vg_mesh *boundary;
  size_t n_slice;    /* number of slices served by this rank */
  uint64_t n_served; /* cells of all kinds in these slices */
  /** Provide slice i, which stays valid until `put` is called for it. Threads:
   * any number of slices at once, each by one thread. VG_ERR_MEMORY. */
  vg_status (*get)(const struct vg_slices *s, size_t i, struct vg_slice *out,
                   struct vg_error *err);
  void (*put)(const struct vg_slices *s, struct vg_slice *slice);
  void *user; /* private data of the server */
};

/* New coordinates of a point of the mesh. */
struct vg_slices_point {
  uint64_t id;
  double x[3];
};

/** Call body for each slice that this rank serves, in threads. Returns the
 * failure of the lowest slice that failed. After a failure, remaining slices
 * may be skipped. */
typedef vg_status (*vg_slice_body)(void *context, const struct vg_slice *slice,
                                   struct vg_error *err);
vg_status vg_slices_each(const struct vg_slices *s, int threads,
                         vg_slice_body body, void *context,
                         struct vg_error *err);

/** Collect all slices that this rank serves into one mesh in memory, with the
 * boundary. With one rank, this is the mesh; with several, the points and cells
 * of the other ranks' slices are left unset (io/slices/slices.h has
 * vg_slices_gather). VG_ERR_MEMORY. */
vg_status vg_slices_collect(const struct vg_slices *s, int threads,
                            struct vg_mesh *out, struct vg_error *err);

/** Collect the solver partitions of the cells in these slices, ordered by cell
 * kind. Requires n_part > 0. part: [cells of the mesh]. */
vg_status vg_slices_collect_parts(const struct vg_slices *s, int threads,
                                  uint32_t *part, struct vg_error *err);

#endif
