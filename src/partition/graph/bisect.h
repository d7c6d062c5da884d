/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* partition/graph/bisect.h: recursive coordinate bisection (M. J. Berger, S. H.
 * Bokhari, "A partitioning strategy for nonuniform problems on
 * multiprocessors", IEEE Trans. Comput. C-36(5), 1987). Uses base only. */
#ifndef VG_PARTITION_GRAPH_BISECT_H
#define VG_PARTITION_GRAPH_BISECT_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

/** Divides weighted points into subdomains by recursive bisection: each plane
 * is normal to the longest side of the remaining point set. The subdomains
 * have nearly equal weight. None is empty, but a subdomain may be
 * disconnected.
 *
 * x: [n]; weight: [n] > 0; part out: [n], 0 .. n_part - 1
 * Threads: safe. Cost: O(n log n log n_part). VG_ERR_INPUT: n_part is below 1
 * or above n; VG_ERR_MEMORY. */
vg_status vg_bisect(size_t n, const double (*x)[3], const double *weight,
                    int n_part, uint32_t *part, struct vg_error *err);

#endif
