/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/search/box_pairs.h: all pairs of touching boxes in a tree. */
#ifndef VG_CORE_SEARCH_BOX_PAIRS_H
#define VG_CORE_SEARCH_BOX_PAIRS_H

#include "core/search/box_tree.h"

/** Handle a pair of items. worker < vg_box_tree_workers(threads) selects the
 * scratch space of the calling thread. A status < 0 ends the search. */
typedef vg_status (*vg_box_pair_visit)(void *context, int worker, uint32_t a,
                                       uint32_t b);

/** Largest number of workers that vg_box_tree_pairs uses. */
int vg_box_tree_workers(int threads);

/** Call visit once for each pair of items whose boxes touch.
 *
 * @param t        built by vg_box_tree_build_items
 * @param threads  as for vg_parallel_for; with one thread the order of the
 *                 pairs depends on the tree only
 *
 * Stops soon after a visit has returned a status < 0, and returns one such
 * status. VG_ERR_MEMORY comes without a message. */
vg_status vg_box_tree_pairs(const struct vg_box_tree *t, int threads,
                            vg_box_pair_visit visit, void *context);

#endif
