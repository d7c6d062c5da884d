/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* cli/plan/plan_estimate.h: the forecast of a project, for plan_*.c. Uses
 * run/input/layers.h, partition/model/rates.h.
 *
 * plan_estimate.c computes it, plan_print.c prints it. */
#ifndef VG_CLI_PLAN_PLAN_ESTIMATE_H
#define VG_CLI_PLAN_PLAN_ESTIMATE_H

#include "cli/plan/plan.h"
#include "cli/plot/timeline.h"
#include "partition/cut/decomposition.h"
#include "partition/model/memory_stages.h"
#include "partition/model/rates.h"
#include "run/input/layers.h"
#include "run/input/source_effect.h"

enum { VG_PLAN_LEAVES = 8 };

/* A sizing field of this coarseness is accurate enough to count cells (M6), if
 * its sizes do not depend on the direction. */
#define VG_PLAN_COARSENESS 2

/** Forecast of a complete run on one machine. */
struct vg_plan_row {
  int ranks, threads, ranks_per_node;
  struct vg_model_result tasks;   /* cutting and filling only */
  double wall;                    /* seconds of the complete run */
  double speedup, efficiency;     /* of the complete run, over one worker */
  double stage[VG_MEMORY_STAGES]; /* bytes of the rank that needs most */
  double memory;                  /* the largest of these */
};

/** The decomposition (discrete or octree) made before anything is filled. */
struct vg_plan_decomposition {
  size_t n_part;      /* number of subdomains; 0: no such decomposition */
  size_t n_whole;     /* subdomains that are filled without cutting them */
  double cells, most; /* expected cells of these: sum, largest */
  double seconds;
  struct vg_decomposition made;
  struct vg_load *load; /* [n_part] */
};

struct vg_plan {
  const struct vg_plan_options *o;
  struct vg_display show;
  struct vg_problem problem;
  struct vg_layer_stage layers;
  struct vg_mesh lifted;       /* the surface moved to the top of estimated
                                  layers */
  struct vg_mesh grown;        /* the front above layers that were grown;
                                  borrowed from layers and problem */
  const struct vg_mesh *front; /* boundary of the field; borrowed */
  struct vg_sizing *sizing;    /* sizing field for the front */
  double finer;                /* leaves in the octree of the run's sizing field
                                  for each leaf in that of `sizing` */
  struct vg_effects effects;
  struct vg_load load;
  struct vg_plan_decomposition decomposition;
  struct vg_cut_rule rule;
  struct vg_rates rates;
  struct vg_rate_fit fit[VG_RATE_FITS]; /* n is 0: not fitted */
  double spread_per_cell;               /* seconds */
  struct vg_forecast forecast;
  int is_grown; /* 1: layers were grown; 0: estimated */
  size_t n_wall_point;
  double layer_tet, layer_point;  /* of the layers, as tetrahedra only */
  double cell, point, prism, tet; /* counts of the mesh; cell: all types */
  double phase[VG_PHASE_N];       /* seconds on one core, outside the tasks;
                                     the mesh check includes the files written
                                     with it, writing the files after it */
  double program;                 /* bytes of this process before it read the
                                     project */
  double surface_peak;            /* bytes of this process at most until the
                                     surface was complete */
  double shared;                  /* bytes of surface, layers and sizing field,
                                     of which a node has one copy */
  size_t n_row;
  struct vg_plan_row *row; /* [n_row] */
  size_t best;             /* best row; SIZE_MAX: none meets the criterion */
  size_t n_leaf;
  struct {
    double cells;
    size_t n;
    struct vg_plan_row row;
  } leaf[VG_PLAN_LEAVES]; /* other leaf sizes at the best row */
  size_t best_leaf;
};

/** Time of a phase on the machine of a row. parts [3] receives the times of its
 * portions that run on one thread, on the cores of a node and on all workers.
 * Returns their sum. */
double vg_plan_phase(const struct vg_plan *p, const struct vg_plan_row *r,
                     enum vg_phase phase, double parts[3]);

/** Bytes of surface, layers and sizing field, of which a node has one copy.
 * (plan_memory.c) */
double vg_plan_shared(const struct vg_plan *p);

/** Bytes of the rank that needs most, in each stage. o: the forecast of the
 * tasks. (plan_memory.c) */
void vg_plan_memory(const struct vg_plan *p, const struct vg_forecast *o,
                    int ranks, int threads, double stage[VG_MEMORY_STAGES]);

/** Size in bytes of the files of a format in the write list; 0: unknown. */
double vg_plan_bytes(const struct vg_plan *p, const char *item);

/** Compute p->decomposition if the settings request one. (plan_decomposition.c)
 */
vg_status vg_plan_part(struct vg_plan *p, struct vg_error *err);
void vg_plan_decomposition_release(struct vg_plan_decomposition *q);

/** Forecast the tasks of p->decomposition. (plan_decomposition.c) */
vg_status vg_plan_parted(const struct vg_plan *p, const struct vg_front *v,
                         const struct vg_cut_rule *rule,
                         struct vg_forecast *out, struct vg_error *err);

/** Plot of the speed-up over the number of workers. */
vg_status vg_plan_draw(const struct vg_plan *p, struct vg_error *err);

void vg_plan_text(const struct vg_plan *p);
vg_status vg_plan_json(const struct vg_plan *p, struct vg_error *err);

#endif
