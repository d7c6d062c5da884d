/* partition/octree/octree.h: the octree-guided decomposition: the void off the
 * front is filled with octants, graded by the sizes, and these are parted;
 * their sides are the interfaces. What is left at the front is the gap.
 * (G. Zagaris, S. Pirzadeh, N. Chrisochoides, "A framework for parallel
 * unstructured grid generation for practical aerodynamic simulations", AIAA
 * 2009-980.) Uses partition/load, graph, core/domain. */
#ifndef VG_PARTITION_OCTREE_OCTREE_H
#define VG_PARTITION_OCTREE_OCTREE_H

#include "partition/cut/decomposition.h"

/** Make a decomposition of a void; see vg_decomposition_maker.
 *
 * front  closed; load  its own
 * o      n_part: of them all those off the front get their share, by the cells
 *        expected; coarsening: octants are so many times as wide as the least
 *        size in them at most, 2 at least; 0: 4, and more only where octants
 *        would be more than half a million
 * out    first the parts of octants, of plane interfaces, may_cut 0; then the
 *        gap, in as many parts as it falls into, may_cut 1. Where no octant has
 *        room the gap is all there is.
 * Names of points follow vg_decomposition; the same for any number of threads
 * of e, which may be NULL. Cost: O(front log front + octants), and the
 * triangulation of the interfaces. VG_ERR_INPUT: n_part < 1, a coarsening below
 * 2 or not finite, h_refine; VG_ERR_GEOMETRY: the front is not closed;
 * VG_ERR_UNSUPPORTED: more than 16 M octants; VG_ERR_STOPPED: as asked. */
vg_decomposition_maker vg_octree_part;

#endif
