/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* partition/discrete/discrete.h: discrete domain decomposition: the cells of a
 * coarse mesh of the void are assigned to subdomains, whose interfaces are
 * remeshed to the local size. Uses core, graph.h, load.h, decomposition.h.
 *
 * Outline: (1) the built-in kernel fills the void at sizes multiplied by a
 * factor, with the front unchanged. (2) METIS or recursive coordinate
 * bisection assigns the coarse cells to subdomains, weighted by the cells that
 * each is expected to hold; disconnected components become subdomains of their
 * own. (3) The interfaces are smoothed without inverting a coarse cell. (4)
 * The edges of the interfaces are divided to the local size, and then each
 * coarse face between subdomains is meshed separately within its plane. The
 * division of an edge is therefore the same on all sides, and interfaces
 * intersect neither each other nor the front. (N. Chrisochoides and others
 * call it discrete domain decomposition.) */
#ifndef VG_PARTITION_DISCRETE_DISCRETE_H
#define VG_PARTITION_DISCRETE_DISCRETE_H

#include "partition/cut/decomposition.h"

/** See vg_decomposition_maker. The subdomains may not be cut further. Cost:
 * that of a mesh with about three cells per face of the front, in one thread
 * unless the options provide it; the loops that assign and divide are shared.
 * VG_ERR_UNSUPPORTED: fewer coarse cells than subdomains. */
vg_decomposition_maker vg_discrete_part;

/** Factor between the sizes of the coarse mesh and of the mesh, for a void with
 * the given number of cells. o->n_part is at least 1. */
double vg_discrete_coarsening(double cells,
                              const struct vg_decomposition_options *o);

/** Sizing field of the coarse mesh: that of the mesh times a factor, growing
 * from the front's edges. The caller frees *out with vg_sizing_free.
 * VG_ERR_MEMORY. */
vg_status vg_discrete_sizes(const struct vg_mesh *front,
                            const struct vg_sizing *sizing, double factor,
                            struct vg_sizing **out, struct vg_error *err);

/** Reports that the coarse mesh cannot be made, with the reason and a remedy.
 * Returns st. */
vg_status vg_discrete_refuse(vg_status st, const char *why, double factor,
                             struct vg_error *err);

#endif
