/* partition/solver/solver_parts.h: what the files of solver.h share. Private.
 *
 * A unit is what stays together: a stack of layer cells, a cluster of cells of
 * the field, a cell: a vertex of the graph. */
#ifndef VG_PARTITION_SOLVER_SOLVER_PARTS_H
#define VG_PARTITION_SOLVER_SOLVER_PARTS_H

#include "core/mesh/cell_links.h"
#include "partition/graph/graph.h"
#include "partition/solver/solver.h"

/* --- units.c --- */

struct vg_units {
  size_t n_unit;
  uint32_t *of;         /* [n_cell] unit of each cell */
  double *weight;       /* [n_unit] */
  unsigned char *alone; /* [n_unit] 1: no stack; its cells are of the
                           field */
  uint64_t n_stack, n_stack_cell, most_stack;
  int has_loose;
};
#define VG_UNITS_INIT                                                          \
  {                                                                            \
    0                                                                          \
  }

void vg_units_release(struct vg_units *u);

/* Which cells stand in layers, by their numbers. */
struct vg_unit_options {
  int is_known, is_ours;        /* n_layer tells; and is beyond doubt */
  uint64_t n_layer[3];          /* cells in layers of each kind: its first ones;
                                   prisms all stand in layers, always */
  const unsigned char *is_wall; /* as of vg_solver_layers */
  size_t cluster;               /* cells of the field to be gathered; 1: none */
  const double *weight;         /* [VG_SOLVER_KINDS] */
};

/** Units in the order of their first cells. */
vg_status vg_units_make(const struct vg_cell_links *l,
                        const struct vg_unit_options *o, struct vg_units *out,
                        struct vg_error *err);

/** Cells of the field that go into one unit, by the number of them all. */
size_t vg_unit_cluster(const struct vg_solver_options *o, uint64_t n_field);

/* --- unit_graph.c: the graph of the units, from pairs that share a face --- */

/* A pair of units with n common faces; a < b. */
struct vg_unit_pair {
  uint32_t a, b, n;
};

struct vg_unit_graph {
  size_t n;
  uint64_t *begin; /* [n + 1] */
  uint32_t *to;    /* [begin[n]] rising in each row */
  int32_t *faces;  /* [begin[n]] */
};

void vg_unit_graph_release(struct vg_unit_graph *g);

/** From the links of all cells. */
vg_status vg_unit_graph_of_links(const struct vg_cell_links *l,
                                 const struct vg_units *u,
                                 struct vg_unit_graph *out,
                                 struct vg_error *err);

/** From pairs, which may repeat. */
vg_status vg_unit_graph_of_pairs(size_t n, const struct vg_unit_pair *pair,
                                 size_t n_pair, struct vg_unit_graph *out,
                                 struct vg_error *err);

/** METIS; then no part is empty. part: [g->n]. */
vg_status vg_unit_graph_part(const struct vg_unit_graph *g,
                             const double *weight, uint64_t n_part,
                             uint32_t *part, struct vg_solver_report *report,
                             struct vg_error *err);

/* --- tally.c: what came out --- */

struct vg_tally;

/** NULL: no memory. */
struct vg_tally *vg_tally_new(uint64_t n_part);
void vg_tally_free(struct vg_tally *t);

/** n faces between parts a and b; each pair from one side only. 0, or -1 where
 * memory is refused. */
int vg_tally_faces(struct vg_tally *t, uint32_t a, uint32_t b, uint64_t n);

void vg_tally_cells(struct vg_tally *t, uint32_t part, uint64_t n,
                    double weight);

void vg_tally_report(const struct vg_tally *t, struct vg_solver_report *r);

#endif
