/* partition/model/forecast.h: a whole run from the load alone, before any cell
 * is made: the tree of cuts, and the tasks with the time that each will take,
 * for vg_model_replay. Uses lattice.h, spans.h.
 *
 * Follows advance.h: the same planes at the same places, tasks by the same
 * names. What only cells could tell is modelled: zones are so many spacings
 * thick, a void falls into the blocks of its lattice, fronts have the faces
 * that their areas need. */
#ifndef VG_PARTITION_MODEL_FORECAST_H
#define VG_PARTITION_MODEL_FORECAST_H

#include "partition/cut/lattice.h"
#include "partition/engine/spans.h"

/** Seconds of one core that a task of a kind takes: at all, per cell made where
 * spacing is even and where it varies, per face of the front it is given; for
 * joins, per task that it makes and per face of the fronts of these, and the
 * share of their time, where fronts are large, in loops that idle threads of
 * the rank help with. */
struct vg_task_rate {
  double task, even, graded, face, made, hand, loops;
};

/** Seconds of one core that a maker of decompositions takes
 * (cut/decomposition.h), per face of the front, coarse cell or octant, and
 * triangle of interfaces; the share of them in loops; of repairs at interfaces,
 * per triangle of these; and per coarse cell of a mesh that all workers make
 * first. */
struct vg_decomposition_rate {
  double face, coarse, side, loops, repair, mesh;
};

struct vg_rates {
  struct vg_task_rate pencil, rib, tile, leaf;
  struct vg_task_rate closing; /* where parts still hang together */
  struct vg_task_rate repair;  /* at interfaces, per cell of a zone */
  struct vg_task_rate plan, join, close, split; /* joins: the first of a node,
                                   those between stages, the one that looks
                                   for such places, the last */
  struct vg_decomposition_rate discrete, octree;
};

/** As measured: forecast.c says where. */
extern const struct vg_rates vg_rates_measured;

/** A void of the tree. */
struct vg_forecast_node {
  char path[VG_PATH_MAX];
  size_t parent; /* SIZE_MAX: the root */
  int depth;
  double lo[3], hi[3];       /* between the planes that cut it out */
  double cells;              /* expected, zones to come included */
  double zone;               /* cells of its own zones */
  double faces;              /* of its front */
  struct vg_lattice lattice; /* without planes: a leaf, or parted otherwise;
                                ribs are not kept */
  size_t n_child;
};

/** Is it filled as it is? */
static inline int vg_forecast_is_leaf(const struct vg_forecast_node *n)
{
  return !n->n_child && !n->lattice.n[0] && !n->lattice.n[1] &&
         !n->lattice.n[2];
}

struct vg_forecast {
  double cells, separator_cells; /* of all; of pencils and tiles */
  size_t n_node, cap_node;
  struct vg_forecast_node *node; /* [n_node] parents first, the whole is [0] */
  size_t n_leaf, n_pencil, n_tile;
  struct vg_spans spans; /* bytes_in: of the front handed over; start and
                            end: one after the other on one core */
};
#define VG_FORECAST_INIT                                                       \
  {                                                                            \
    .n_node = 0                                                                \
  }

void vg_forecast_release(struct vg_forecast *o);

/** What the advancing partition will do with a void.
 *
 * @param v       its front, as vg_load_new had it
 * @param load    its cells
 * @param levels  bisections, for a rule by levels
 * @param out     replaced; untouched on failure
 * Result follows from the arguments alone. O((octants + faces) x depth), times
 * the number of zones of a cut. VG_ERR_MEMORY. */
vg_status vg_forecast_new(const struct vg_front *v, const struct vg_load *load,
                          const struct vg_cut_rule *rule, int levels,
                          const struct vg_rates *rates, struct vg_forecast *out,
                          struct vg_error *err);

/** A part of a void that is parted before it is filled (cut/decomposition.h).
 */
struct vg_forecast_part {
  struct vg_front v; /* its front */
  const struct vg_load *load;
  int may_cut; /* 1: planes may cut it further */
};

/** What a maker of decompositions does. */
struct vg_forecast_decomposition {
  const struct vg_decomposition_rate *rate;
  double coarse, sides; /* coarse cells or octants; triangles */
  size_t n;
  const struct vg_forecast_part *part; /* [n] */
};

/** As vg_forecast_new, of a void that is parted so. All is borrowed. Nodes: the
 * whole, then its parts. */
vg_status vg_forecast_parted(
  const struct vg_front *v, const struct vg_load *load,
  const struct vg_forecast_decomposition *decomposition,
  const struct vg_cut_rule *rule, int levels, const struct vg_rates *rates,
  struct vg_forecast *out, struct vg_error *err);

/** Points of a mesh of tetrahedra whose boundary has so many faces. */
double vg_forecast_points(double cells, double faces);

#endif
