/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/plan/run_plan_parts.h: the steps of a forecast. Private to run/plan. */
#ifndef VG_RUN_PLAN_RUN_PLAN_PARTS_H
#define VG_RUN_PLAN_RUN_PLAN_PARTS_H

#include "run/plan/run_plan.h"

/* A sizing field of this coarseness is accurate enough to count cells (M6), if
 * its sizes do not depend on the direction. */
#define VG_PLAN_COARSENESS 2

/** Estimates the layers and moves the walls to their tops. p->front is then
 * p->lifted, which approximates the front that remains to be filled.
 * (plan_layers.c) */
vg_status vg_plan_lift(struct vg_plan *p, struct vg_error *err);

/** Bytes of surface, layers and sizing field, of which a node has one copy.
 * (plan_memory.c) */
double vg_plan_shared(const struct vg_plan *p);

/** Bytes of the rank that needs most, in each stage. o: the forecast of the
 * tasks. (plan_memory.c) */
void vg_plan_memory(const struct vg_plan *p, const struct vg_forecast *o,
                    int ranks, int threads, double stage[VG_MEMORY_STAGES]);

/** Computes p->decomposition if the settings request one.
 * (plan_decomposition.c) */
vg_status vg_plan_part(struct vg_plan *p, struct vg_error *err);
void vg_plan_decomposition_release(struct vg_plan_decomposition *q);

/** Forecasts the tasks of p->decomposition. (plan_decomposition.c) */
vg_status vg_plan_parted(const struct vg_plan *p, const struct vg_front *v,
                         const struct vg_cut_rule *rule,
                         struct vg_forecast *out, struct vg_error *err);

/** Forecasts the tasks of a run with this leaf size. */
vg_status vg_plan_tasks(const struct vg_plan *p, double leaf_cells,
                        struct vg_forecast *out, struct vg_error *err);

/** Computes the rows of p, the best of them, and other leaf sizes.
 * (plan_machines.c) */
vg_status vg_plan_machines(struct vg_plan *p, struct vg_error *err);

#endif
