/* partition/solver/solver.h: a finished mesh in parts for a flow solver. Uses
 * core/mesh, partition/graph.
 *
 * METIS parts the graph of cells and their common faces, in which every stack
 * of layer cells is one vertex, so that none is cut: solvers that are implicit
 * along the lines of a layer keep their lines. In large meshes the cells of the
 * field are gathered into clusters first. The parts follow from the mesh alone,
 * for any number of ranks and threads. */
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
  double weight[VG_SOLVER_KINDS]; /* > 0: work that a cell of the kind is */
  uint64_t cluster_above; /* gather cells of the field where there are more
                             than so many */
  int threads;            /* to look at slices with; 0: one per core */
};
#define VG_SOLVER_OPTIONS_INIT                                                 \
  {                                                                            \
    .weight = { 1, 1, 1, 1 }, .cluster_above = 12000000                        \
  } /* P1 */

/** What is known of layers in a mesh in one piece. */
struct vg_solver_layers {
  int is_known;                 /* 1: n_tet tells, and they come first, in
                                   Vanguard's order */
  size_t n_tet;                 /* tetrahedra in layers */
  const unsigned char *is_wall; /* [n_patch] stacks of hexahedra begin on it;
                                   NULL: none do */
};

struct vg_solver_report {
  uint64_t n_part, n_cell;
  uint64_t n_stack, n_stack_cell, most_stack; /* stacks of two cells and more,
                                 cells in them, in the largest */
  int has_loose;     /* tetrahedra may stand in stacks that could not be
                        told: nothing is known of them, or what is was
                        not so */
  uint64_t n_vertex; /* of the graph */
  double balance;    /* most over mean weight of a part */
  uint64_t most_cells, least_cells;
  uint64_t n_cut;     /* faces between parts */
  uint64_t most_cut;  /* of these on one part: its surface */
  uint64_t most_near; /* parts that share faces with a part */
  double mean_cut, mean_near;
  uint64_t n_moved; /* vertices given to parts that METIS left empty */
  double time_graph, time_metis;
};

/** Parts of a mesh in one piece.
 *
 * @param layers  NULL: nothing is known; stacks of prisms are told by their
 *                triangles all the same
 * @param name    of the mesh, for messages
 * @param part    out: [cells, in the order of kinds] 0 .. n_part - 1; none of
 *                the parts is empty
 * VG_ERR_INPUT: n_part is 0 or more than the vertices of the graph, or the mesh
 * is not closed; else as vg_cell_links_build and vg_graph_part.
 * Memory: 25 words of 4 bytes per tetrahedron at most, and what METIS takes
 * for the graph. */
vg_status vg_solver_part(const struct vg_mesh *m,
                         const struct vg_solver_layers *layers,
                         const struct vg_solver_options *options,
                         const char *name, uint32_t *part,
                         struct vg_solver_report *report, struct vg_error *err);

/** Parts of a mesh in slices, whose layers are known. Collective. On *out the
 * slices have `part`; it is s otherwise, and needs s.
 *
 * No rank sees more of the mesh than it serves; rank 0 has the graph. Each
 * keeps a word per cell that it serves.
 * VG_ERR_INPUT: as above. The same answer and report on all ranks. */
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
