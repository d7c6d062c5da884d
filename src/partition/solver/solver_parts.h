/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* partition/solver/solver_parts.h: declarations shared by the files of
 * solver.h. Private.
 *
 * A unit is a set of cells that stay together and form one vertex of the
 * graph: a stack of layer cells, a cluster of cells outside the layers, or a
 * single cell. */
#ifndef VG_PARTITION_SOLVER_SOLVER_PARTS_H
#define VG_PARTITION_SOLVER_SOLVER_PARTS_H

#include "core/mesh/cell_links.h"
#include "partition/graph/graph.h"
#include "partition/solver/solver.h"

/* --- units.c --- */

struct vg_units {
  size_t n_unit;
  uint32_t *of;         /* [n_cell] Unit of each cell. */
  double *weight;       /* [n_unit] */
  unsigned char *alone; /* [n_unit] 1: not a stack; its cells are outside the
                           layers. */
  uint64_t n_stack, n_stack_cell, most_stack;
  int has_loose;
};
#define VG_UNITS_INIT                                                          \
  {                                                                            \
    0                                                                          \
  }

void vg_units_release(struct vg_units *u);

/* Which cells belong to layers, by index. */
struct vg_unit_options {
  int is_known, is_ours;        /* n_layer is valid; and it is certain, since
                                   Vanguard made the layers. */
  uint64_t n_layer[4];          /* Layer cells of each kind, which come
                                   first; prisms always count as layer cells. */
  const unsigned char *is_wall; /* See vg_solver_layers. */
  size_t cluster;       /* Cells outside layers per cluster; 1: no clusters. */
  const double *weight; /* [VG_SOLVER_KINDS] */
  const double *cell_weight; /* [n_cell] Instead of weight; may be NULL. */
  const uint32_t *together;  /* [n_cell] First cell of a zone that is one unit;
                                UINT32_MAX: none. May be NULL. */
};

/** Makes the units, in the order of their first cells. */
vg_status vg_units_make(const struct vg_cell_links *l,
                        const struct vg_unit_options *o, struct vg_units *out,
                        struct vg_error *err);

/** Cells per cluster, from the total number of cells outside layers. */
size_t vg_unit_cluster(const struct vg_solver_options *o, uint64_t n_field);

/* --- unit_graph.c: the graph of the units, from pairs that share a face --- */

/* A pair of units that share n faces; a < b. */
struct vg_unit_pair {
  uint32_t a, b, n;
};

struct vg_unit_graph {
  size_t n;
  uint64_t *begin; /* [n + 1] */
  uint32_t *to;    /* [begin[n]] Ascending in each row. */
  int32_t *faces;  /* [begin[n]] */
};

void vg_unit_graph_release(struct vg_unit_graph *g);

/** Builds the graph from the links of all cells. */
vg_status vg_unit_graph_of_links(const struct vg_cell_links *l,
                                 const struct vg_units *u,
                                 struct vg_unit_graph *out,
                                 struct vg_error *err);

/** Builds the graph from pairs, which may repeat. */
vg_status vg_unit_graph_of_pairs(size_t n, const struct vg_unit_pair *pair,
                                 size_t n_pair, struct vg_unit_graph *out,
                                 struct vg_error *err);

/** Calls METIS, then fills empty partitions. part: [g->n]. */
vg_status vg_unit_graph_part(const struct vg_unit_graph *g,
                             const double *weight, uint64_t n_part,
                             uint32_t *part, struct vg_solver_report *report,
                             struct vg_error *err);

/* --- tally.c: statistics of the partitions --- */

struct vg_tally;

/** NULL: no memory. */
struct vg_tally *vg_tally_new(uint64_t n_part);
void vg_tally_free(struct vg_tally *t);

/** Adds n faces between partitions a and b; each pair from one side only.
 * Returns 0, or -1 when memory is refused. */
int vg_tally_faces(struct vg_tally *t, uint32_t a, uint32_t b, uint64_t n);

void vg_tally_cells(struct vg_tally *t, uint32_t part, uint64_t n,
                    double weight);

void vg_tally_report(const struct vg_tally *t, struct vg_solver_report *r);

#endif
