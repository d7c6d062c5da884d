/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* partition/graph/graph.h: partitioning of weighted graphs by METIS (G.
 * Karypis, V. Kumar, "A fast and high quality multilevel scheme for
 * partitioning irregular graphs", SIAM J. Sci. Comput. 20(1), 1998). Uses base
 * only. */
#ifndef VG_PARTITION_GRAPH_GRAPH_H
#define VG_PARTITION_GRAPH_GRAPH_H

#include <stddef.h>
#include <stdint.h>

#include "base/library.h"
#include "base/status.h"

/** A graph. Each edge is stored in both directions with one weight. There are
 * no loops. The arrays are borrowed. */
struct vg_graph {
  size_t n;
  const uint64_t *begin; /* [n + 1] first neighbour of each vertex */
  const uint32_t *to;    /* [begin[n]] neighbours */
  const double *weight;  /* [n] work per vertex, > 0, finite; NULL: equal */
  const int32_t *edge;   /* [begin[n]] cost of cutting an edge, > 0; NULL: 1 */
};

struct vg_graph_options {
  int n_part;
  double imbalance; /* allowed ratio of maximum to mean, > 1; METIS may
                       exceed it */
  int contiguous;   /* 1: connected subdomains, if the graph is connected */
  double *seconds;  /* METIS's processor time is added here, because this
                       process is not charged for it; may be NULL */
};

/** Returns 1 if this build has METIS. Without it vg_graph_part returns
 * VG_ERR_UNSUPPORTED. */
int vg_graph_is_built(void);

/** Assigns each vertex to a subdomain 0 .. n_part - 1. Some subdomains may stay
 * empty when there are few vertices per subdomain.
 *
 * part out: [n]
 * METIS has static state and installs its own SIGTERM handler, so it runs in a
 * child process (base/child.h). The seed is fixed: equal input gives equal
 * output. Weights are rounded to a billionth of their sum, and to at least 1.
 * Threads: safe. Cost: O(n + edges), about 60 bytes each in the child.
 * VG_ERR_INPUT: n_part < 1, or fewer vertices than subdomains;
 * VG_ERR_UNSUPPORTED: more than 5e8 vertices or 2^31 - 1 edges; VG_ERR_MEMORY:
 * METIS or its process could not get memory, or METIS crashed. */
vg_status vg_graph_part(const struct vg_graph *g,
                        const struct vg_graph_options *options, uint32_t *part,
                        struct vg_error *err);

/** Returns the METIS version that the header states. */
void vg_library_metis(struct vg_library *out);

#endif
