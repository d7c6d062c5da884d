/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* partition/solver/solver.h: partitioning of a finished mesh for a flow
 * solver. Uses core/mesh, partition/graph.
 *
 * METIS partitions the graph of cells and their shared faces. Every stack of
 * layer cells is one vertex, so that no stack is cut and solvers that are
 * implicit along layer lines keep complete lines. In large meshes the cells
 * outside the layers are gathered into clusters first. The partitions depend
 * on the mesh alone, for any number of ranks and threads. */
#ifndef VG_PARTITION_SOLVER_SOLVER_H
#define VG_PARTITION_SOLVER_SOLVER_H

#include <stddef.h>
#include <stdint.h>

#include "base/comm.h"
#include "core/mesh/mesh.h"
#include "core/mesh/slices.h"

/** Tetrahedra, pyramids, prisms, hexahedra. */
enum { VG_SOLVER_KINDS = 4 };

struct vg_solver_options {
  uint64_t n_part;
  double weight[VG_SOLVER_KINDS]; /* > 0: work of a cell of each kind. */
  uint64_t cluster_above; /* Cells outside layers are clustered if there are
                             more than this. */
  int threads;            /* Threads that process slices; 0: one per core. */
  /* [zones of the mesh] > 0: factor on the work of their cells; NULL: 1. Only
   * for meshes in one piece. */
  const double *zone_weight;
  /* [zones of the mesh] 1: all its cells are in one partition; NULL: none. Only
   * for meshes in one piece. */
  const uint8_t *is_whole;
};
#define VG_SOLVER_OPTIONS_INIT                                                 \
  {                                                                            \
    .weight = { 1, 1, 1, 1 }, .cluster_above = 12000000                        \
  } /* P1 */

/** Layer information of a mesh in one piece. */
struct vg_solver_layers {
  /* 1: n_tet is valid, and the layer tetrahedra come first, in Vanguard's
   * order. */
  int is_known;
  size_t n_tet;                 /* Tetrahedra in layers. */
  const unsigned char *is_wall; /* [n_patch] 1: stacks of hexahedra start on
                                   it; NULL: none do. */
};

struct vg_solver_report {
  uint64_t n_part, n_cell;
  /* Stacks of at least two cells, cells in them, cells in the largest. */
  uint64_t n_stack, n_stack_cell, most_stack;
  /* 1: tetrahedra may belong to stacks that could not be detected, because
   * layers are unknown or the given information was wrong. */
  int has_loose;
  uint64_t n_vertex; /* Vertices of the graph. */
  double balance;    /* Maximum over mean weight of a partition. */
  uint64_t most_cells, least_cells;
  uint64_t n_cut;     /* Faces between partitions. */
  uint64_t most_cut;  /* Maximum of these on one partition, its surface. */
  uint64_t most_near; /* Maximum number of neighbour partitions. */
  double mean_cut, mean_near;
  uint64_t n_moved; /* Vertices moved to partitions that METIS left empty. */
  double time_graph, time_metis;
};

/** Partitions a mesh in one piece.
 *
 * @param layers  NULL: unknown; stacks of prisms are still detected by their
 *   triangles
 * @param name  of the mesh, for messages
 * @param part  out: [cells, in the order of kinds] 0 .. n_part - 1; no
 *   partition is empty
 * VG_ERR_INPUT: n_part is 0 or more than the vertices of the graph, or the
 * mesh is not closed; other errors as of vg_cell_links_build and
 * vg_graph_part.
 * Memory: at most 25 words of 4 bytes per tetrahedron, plus the memory of
 * METIS for the graph. */
vg_status vg_solver_part(const struct vg_mesh *m,
                         const struct vg_solver_layers *layers,
                         const struct vg_solver_options *options,
                         const char *name, uint32_t *part,
                         struct vg_solver_report *report, struct vg_error *err);

/** Partitions a mesh in slices, whose layers are known. Collective. The slices
 * of *out have `part` set; otherwise they equal those of s, which must stay
 * open.
 *
 * No rank holds more of the mesh than it serves; rank 0 holds the graph. Each
 * rank keeps one word per cell that it serves.
 * VG_ERR_INPUT: as above. The result and the report are equal on all ranks. */
struct vg_solver_slices;
vg_status vg_solver_part_slices(struct vg_comm *comm, const struct vg_slices *s,
                                const struct vg_solver_options *options,
                                struct vg_slices *out,
                                struct vg_solver_slices **keep,
                                struct vg_solver_report *report,
                                struct vg_error *err);

/** Accepts NULL. */
void vg_solver_slices_close(struct vg_solver_slices *keep);

#endif
