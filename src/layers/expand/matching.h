/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* layers/expand/matching.h: pairs of neighbours in a graph whose nodes have at
 * most three links, such as the triangles of a surface, by weight. Private to
 * pairs*.c and tests. */
#ifndef VG_LAYERS_EXPAND_MATCHING_H
#define VG_LAYERS_EXPAND_MATCHING_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

/* L27 */
/* Most links of an augmenting path, and most nodes of an alternating cycle. */
#define VG_MATCHING_PATH 9
#define VG_MATCHING_CYCLE 8
/* Sweeps over all nodes in which paths and cycles are exchanged. */
#define VG_MATCHING_SWEEPS 2

struct vg_links {
  size_t n;              /* Number of nodes. */
  uint32_t (*to)[3];     /* [n] neighbours; UINT32_MAX: no link. Of two nodes,
                            each has the other, at most once. */
  uint16_t (*weight)[3]; /* [n] weights, above 0, the same in both directions.
                          */
};

/** Finds a matching: pairs of linked nodes without a common node. No path of up
 * to VG_MATCHING_PATH links between two nodes without partner leads to one more
 * pair. Among such matchings, the sum of the weights is large: links are taken
 * by descending weight, then paths and cycles of links which are alternately in
 * the matching and outside are exchanged where this increases the sum.
 *
 * The result depends on the links and their order only.
 * O(n log n). VG_ERR_MEMORY.
 *
 * @param partner  out: [n] UINT32_MAX: no partner */
vg_status vg_links_match(const struct vg_links *l, uint32_t *partner,
                         struct vg_error *err);

#endif
