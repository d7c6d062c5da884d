/* partition/graph/graph.h: weighted graphs cut into parts by METIS (G. Karypis,
 * V. Kumar, "A fast and high quality multilevel scheme for partitioning
 * irregular graphs", SIAM J. Sci. Comput. 20(1), 1998). Uses base only. */
#ifndef VG_PARTITION_GRAPH_GRAPH_H
#define VG_PARTITION_GRAPH_GRAPH_H

#include <stddef.h>
#include <stdint.h>

#include "base/library.h"
#include "base/status.h"

/** Both directions of an edge are there, with one weight; no loops. Borrowed.
 */
struct vg_graph {
  size_t n;
  const uint64_t *begin; /* [n + 1] of the neighbours of each vertex */
  const uint32_t *to;    /* [begin[n]] */
  const double *weight;  /* [n] > 0, finite: work; NULL: all alike */
  const int32_t *edge;   /* [begin[n]] > 0: price of being cut; NULL: 1 */
};

struct vg_graph_options {
  int n_part;
  double imbalance; /* most over mean allowed, > 1: a wish */
  int contiguous;   /* parts hang together, if the graph does */
  double *seconds;  /* processor time that METIS took is added, which
                       this process does not have; NULL: not */
};

/** Part of every vertex, 0 .. n_part - 1; some may stay empty when parts have
 * few vertices.
 *
 * part out: [n]
 * METIS has static state and takes SIGTERM for itself: it runs in a child
 * (base/child.h). The seed is fixed; the same parts for the same input.
 * Weights are rounded to a billionth of their sum, 1 at least.
 * Threads: safe. Cost: O(n + edges), some 60 bytes each in the child.
 * VG_ERR_INPUT: fewer vertices than parts, n_part < 1; VG_ERR_UNSUPPORTED:
 * beyond 5e8 vertices or 2^31 - 1 edges; VG_ERR_MEMORY: METIS or a process was
 * refused memory, or METIS died. */
vg_status vg_graph_part(const struct vg_graph *g,
                        const struct vg_graph_options *options, uint32_t *part,
                        struct vg_error *err);

/** Which METIS this is, by its header. */
void vg_library_metis(struct vg_library *out);

#endif
