/* core/search/box_pairs.h: all pairs of boxes of a tree that touch. */
#ifndef VG_CORE_SEARCH_BOX_PAIRS_H
#define VG_CORE_SEARCH_BOX_PAIRS_H

#include "core/search/box_tree.h"

/** Handle a pair of items. worker < vg_box_tree_workers(threads) names scratch
 * space of the calling thread. A status < 0 ends the search. */
typedef vg_status (*vg_box_pair_visit)(void *context, int worker, uint32_t a,
                                       uint32_t b);

/** Number of workers that vg_box_tree_pairs has at most. */
int vg_box_tree_workers(int threads);

/** Call visit for all pairs of items whose boxes touch, once each.
 *
 * @param t        built by vg_box_tree_build_items
 * @param threads  as vg_parallel_for's; with one thread the order of the pairs
 *                 follows from the tree alone
 *
 * Stops soon after visit returned < 0, and returns one such status;
 * VG_ERR_MEMORY without a message. */
vg_status vg_box_tree_pairs(const struct vg_box_tree *t, int threads,
                            vg_box_pair_visit visit, void *context);

#endif
