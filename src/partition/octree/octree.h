/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* partition/octree/octree.h: octree-guided decomposition: the part of the void
 * away from the front is filled with octants, graded by the sizes and assigned
 * to subdomains, and the sides of these are the interfaces. The remaining
 * region at the front is the gap region. (G. Zagaris, S. Pirzadeh, N.
 * Chrisochoides, "A framework for parallel unstructured grid generation for
 * practical aerodynamic simulations", AIAA 2009-980.) Uses partition/load,
 * graph, core/domain. */
#ifndef VG_PARTITION_OCTREE_OCTREE_H
#define VG_PARTITION_OCTREE_OCTREE_H

#include "partition/cut/decomposition.h"

/** Decomposes a void; see vg_decomposition_maker.
 *
 * front  closed; load  of its void
 * o      n_part: the octants get their share of these subdomains, by expected
 * cells; coarsening: maximum width of an octant in the smallest size inside
 * it, at least 2; 0: 4, and more only if there would be more than half a
 * million octants
 * out    first the subdomains of octants, with plane interfaces, may_cut 0;
 * then the gap region, one subdomain per connected component, may_cut 1. If
 * there is no room for an octant, there is only the gap region.
 * Global ids of points follow vg_decomposition. The result is the same for any
 * number of threads of e, which may be NULL. Cost: O(front log front +
 * octants), and the triangulation of the interfaces.
 * VG_ERR_INPUT: n_part < 1, a coarsening below 2 or not finite, h_refine;
 * VG_ERR_GEOMETRY: the front is not closed; VG_ERR_UNSUPPORTED: more than 16 M
 * octants; VG_ERR_STOPPED: on request. */
vg_decomposition_maker vg_octree_part;

#endif
