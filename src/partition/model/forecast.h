/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* partition/model/forecast.h: forecast of a whole run from the load estimate
 * alone, before any cell is made: the decomposition tree, and the tasks with
 * their expected times, for vg_model_replay. Uses lattice.h, spans.h.
 *
 * The forecast follows advance.h: the same planes at the same positions, and
 * tasks with the same names. Quantities that only real cells could give are
 * modelled: separator zones have a fixed thickness in spacings, a void splits
 * into the blocks of its lattice, and fronts have the number of faces that
 * their areas require. */
#ifndef VG_PARTITION_MODEL_FORECAST_H
#define VG_PARTITION_MODEL_FORECAST_H

#include "partition/cut/lattice.h"
#include "partition/engine/spans.h"

/** Seconds of one core for a kind of task: constant part, per cell made at
 * uniform and at varying spacing, and per face of the received front. For
 * joins also per task created, per face of the fronts of these tasks, and the
 * share of the time, for large fronts, in loops that idle threads of the rank
 * help with. */
struct vg_task_rate {
  double task, even, graded, face, made, hand, loops;
};

/** Seconds of one core for a decomposition (cut/decomposition.h): per face of
 * the front, per coarse cell or octant, and per triangle of interfaces; the
 * share of this time in loops; for repairs, per triangle of interfaces; and per
 * cell of a coarse mesh that all workers make first. */
struct vg_decomposition_rate {
  double face, coarse, side, loops, repair, mesh;
};

struct vg_rates {
  struct vg_task_rate pencil, rib, tile, leaf;
  struct vg_task_rate closing; /* Where subdomains are still connected across
                                  planes. */
  struct vg_task_rate repair;  /* At interfaces, per cell of a zone. */
  /* Joins: the first of a node, those between stages, the search for such
   * connections, the last. */
  struct vg_task_rate plan, join, close, split;
  struct vg_decomposition_rate discrete, octree;
};

/** Measured rates; forecast.c gives the source. */
extern const struct vg_rates vg_rates_measured;

/** The same in a sizing field of metrics. */
struct vg_rates vg_rates_in_metric(void);

/** A void of the tree. */
struct vg_forecast_node {
  char path[VG_PATH_MAX];
  size_t parent; /* Index of the parent; SIZE_MAX: the root. */
  int depth;
  double lo[3], hi[3];       /* Box between the planes that bound it. */
  double cells;              /* Expected cells, including zones to come. */
  double zone;               /* Cells of its own zones. */
  double faces;              /* Faces of its front. */
  struct vg_lattice lattice; /* Without planes: a leaf, or decomposed
                                otherwise; ribs are not kept. */
  size_t n_child;
};

/** Is the void filled without a further cut? */
static inline int vg_forecast_is_leaf(const struct vg_forecast_node *n)
{
  return !n->n_child && !n->lattice.n[0] && !n->lattice.n[1] &&
         !n->lattice.n[2];
}

struct vg_forecast {
  double cells,
    separator_cells; /* Cells of the mesh; cells of pencils and tiles. */
  size_t n_node, cap_node;
  struct vg_forecast_node *node; /* [n_node] Parents first; [0] is the whole
                                    void. */
  size_t n_leaf, n_pencil, n_tile;
  struct vg_spans spans; /* bytes_in: size of the transferred front; start
                            and end: sequential on one core. */
};
#define VG_FORECAST_INIT                                                       \
  {                                                                            \
    .n_node = 0                                                                \
  }

void vg_forecast_release(struct vg_forecast *o);

/** Forecasts the advancing partition of a void.
 *
 * @param v       its front, as passed to vg_load_new
 * @param load    its load estimate
 * @param levels  number of bisections, if the rule has no leaf_cells
 * @param out     replaced; untouched on failure
 * The result depends on the arguments alone. O((octants + faces) x depth),
 * times the number of zones of a cut. VG_ERR_MEMORY. */
vg_status vg_forecast_new(const struct vg_front *v, const struct vg_load *load,
                          const struct vg_cut_rule *rule, int levels,
                          const struct vg_rates *rates, struct vg_forecast *out,
                          struct vg_error *err);

/** A subdomain of a void that is decomposed before it is filled
 * (cut/decomposition.h). */
struct vg_forecast_part {
  struct vg_front v; /* Its front. */
  const struct vg_load *load;
  int may_cut; /* 1: planes may cut it further. */
};

/** Work of a decomposition. */
struct vg_forecast_decomposition {
  const struct vg_decomposition_rate *rate;
  double coarse, sides; /* Coarse cells or octants; triangles of interfaces. */
  size_t n;
  const struct vg_forecast_part *part; /* [n] */
};

/** Like vg_forecast_new, for a void that is decomposed in this way. All
 * arguments are borrowed. Nodes: the whole void, then its subdomains. */
vg_status vg_forecast_parted(
  const struct vg_front *v, const struct vg_load *load,
  const struct vg_forecast_decomposition *decomposition,
  const struct vg_cut_rule *rule, int levels, const struct vg_rates *rates,
  struct vg_forecast *out, struct vg_error *err);

/** Points of a tetrahedral mesh with the given number of boundary faces. */
double vg_forecast_points(double cells, double faces);

#endif
