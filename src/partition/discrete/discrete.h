/* partition/discrete/discrete.h: the discrete decomposition: a coarse mesh of
 * the void is dealt out to parts, whose interfaces get the local size. Uses
 * core, graph.h, load.h, decomposition.h.
 *
 * Outline: (1) our own kernel fills the void at sizes times a factor, the front
 * kept as it is; (2) METIS, or recursive coordinate bisection, deals out the
 * coarse cells, weighted with the cells that each is expected to hold; pieces
 * that hang apart become parts of their own; (3) interfaces are smoothed, no
 * coarse cell inverted; (4) edges of interfaces are divided to the local size,
 * then each coarse face between parts by itself, within its plane: so all sides
 * of an edge agree, and interfaces cross neither each other nor the front.
 * (N. Chrisochoides and others call it discrete domain decomposition.) */
#ifndef VG_PARTITION_DISCRETE_DISCRETE_H
#define VG_PARTITION_DISCRETE_DISCRETE_H

#include "partition/cut/decomposition.h"

/** See vg_decomposition_maker. Parts may not be cut further. Cost: that of a
 * mesh of some three cells for each face of the front, in one thread unless the
 * options bring it; loops that deal out and divide are shared.
 * VG_ERR_UNSUPPORTED: fewer coarse cells than parts. */
vg_decomposition_maker vg_discrete_part;

/** Sizes of the coarse mesh over those of the mesh, for a void of so many
 * cells. o->n_part is at least 1. */
double vg_discrete_coarsening(double cells,
                              const struct vg_decomposition_options *o);

/** Sizes of the coarse mesh: those of the mesh times a factor, growing from the
 * front's edges. *out is the caller's, vg_sizing_free. VG_ERR_MEMORY. */
vg_status vg_discrete_sizes(const struct vg_mesh *front,
                            const struct vg_sizing *sizing, double factor,
                            struct vg_sizing **out, struct vg_error *err);

/** Say that there is no coarse mesh, for a reason, and what to do. Returns
 * st. */
vg_status vg_discrete_refuse(vg_status st, const char *why, double factor,
                             struct vg_error *err);

#endif
