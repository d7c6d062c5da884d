/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/metric/metric_points.h: field points in a metric, by a front of points
 * that starts at the surface and advances by one unit of the metric.
 *
 * Each face of the surface proposes the apex of a cell that is regular in the
 * metric, and each point that is accepted proposes its neighbours in a
 * body-centred cubic pattern mapped by H = M^(-1/2):
 *
 *        .   .                   .     .
 *          o         -- H -->       o          o accepted point
 *        .   .                  .     .        . its proposals
 *
 * A proposal is accepted if it lies in the fluid and no point is nearer than a
 * fraction of a unit in the metric at the proposal. It is then inserted at
 * once, and the cells around it serve as the search structure for the next
 * proposals: the cavity of a point contains its nearest neighbours in the
 * metric, whatever the aspect of the cells. */
#ifndef VG_CORE_METRIC_METRIC_POINTS_H
#define VG_CORE_METRIC_METRIC_POINTS_H

#include "base/stop.h"
#include "core/delaunay/insert.h"
#include "core/front/region.h"
#include "core/metric/metrics.h"

struct vg_metric_advance_report {
  size_t n_proposed; /* Proposals whose cell was searched. */
  size_t n_inserted; /* Points inserted. */
  size_t n_refused;  /* Proposals for which no valid cavity was found. */
};

/** Insert field points into the fluid cells of t.
 *
 * @param metrics  of the points of t; the new points are added
 * @param region   NULL: everywhere
 * @param limit    fail if more points are needed; 0: no limit
 *
 * Deterministic. VG_ERR_UNSUPPORTED if the limit is exceeded; VG_ERR_STOPPED,
 * VG_ERR_MEMORY. */
vg_status vg_metric_advance(struct vg_tets *t, struct vg_metrics *metrics,
                            const struct vg_region *region, size_t limit,
                            const struct vg_stop *stop,
                            struct vg_metric_advance_report *report,
                            struct vg_error *err);

#endif
