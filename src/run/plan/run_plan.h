/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/plan/run_plan.h: forecast of a complete run (cells, points, memory of a
 * rank, time) from the surface and the sizing field only. Uses
 * run/layers/layers.h, partition/model/rates.h.
 *
 *   vg_plan_begin    notes the time before the project is read
 *   (the caller)     vg_problem_read or vg_problem_given
 *   vg_plan_make     surface, sizing field, layers, tasks, machines
 *   vg_plan_release
 */
#ifndef VG_RUN_PLAN_RUN_PLAN_H
#define VG_RUN_PLAN_RUN_PLAN_H

#include "partition/cut/decomposition.h"
#include "partition/model/memory_stages.h"
#include "partition/model/model.h"
#include "partition/model/phase.h"
#include "partition/model/rates.h"
#include "run/common/ranges.h"
#include "run/layers/layers.h"
#include "run/input/source_effect.h"

enum { VG_PLAN_LEAVES = 8 };

/** Machines of a forecast, and how their times are computed. */
struct vg_plan_request {
  /* Numbers of ranks and of threads per rank; borrowed. */
  struct vg_range_list ranks, threads;
  struct vg_machine machine; /* All members but ranks, threads and the times
                                outside the tasks. */
  int cores;      /* Cores of a node: `ranks` are then numbers of nodes, and all
                     combinations of ranks and threads that fill a node are
                     tried; 0: use ranks and threads as given. */
  double target;  /* Seconds; 0: none. */
  double serial;  /* Seconds that are not parallel; below 0: the phases, from
                     their times in this process. */
  double program; /* Bytes of a process before it reads the project. */
  double spread_per_cell; /* Seconds of numbering and mesh check on one core; 0:
                             the built-in rate. */
  struct vg_rate_fit fit[VG_RATE_FITS]; /* n is 0: the built-in rates. */
  int workers;   /* Threads of this process; 0: one per core. */
  int no_leaves; /* 1: other leaf sizes are not tried. */
};

/** Forecast of a complete run on one machine. */
struct vg_plan_row {
  int ranks, threads, ranks_per_node;
  struct vg_model_result tasks;   /* Cutting and filling only. */
  double wall;                    /* Seconds of the complete run. */
  double speedup, efficiency;     /* Of the complete run, over one worker. */
  double stage[VG_MEMORY_STAGES]; /* Bytes of the rank that needs most. */
  double memory;                  /* The largest of these. */
};

/** The decomposition (discrete or octree) made before anything is filled. */
struct vg_plan_decomposition {
  size_t n_part;      /* Number of subdomains; 0: no such decomposition. */
  size_t n_whole;     /* Subdomains that are filled without cutting them. */
  double cells, most; /* Expected cells of these: sum, largest. */
  double seconds;
  struct vg_decomposition made;
  struct vg_load *load; /* [n_part] */
};

struct vg_plan {
  /* Set by the caller and borrowed: request, project, layers (empty, see
   * vg_layer_stage_release) and progress. */
  const struct vg_plan_request *o;
  struct vg_problem *problem;
  struct vg_layer_stage *layers;
  struct vg_display *show;
  /* Results. */
  double start;                /* Processor time at vg_plan_begin. */
  struct vg_mesh lifted;       /* The surface moved to the top of estimated
                                  layers. */
  struct vg_mesh grown;        /* The front above layers that were grown;
                                  borrowed from layers and problem. */
  const struct vg_mesh *front; /* Boundary of the field; borrowed. */
  struct vg_sizing *sizing;    /* Sizing field for the front. */
  double finer;                /* Leaves in the octree of the run's sizing field
                                  for each leaf in that of `sizing`. */
  struct vg_effects effects;
  struct vg_load load;
  struct vg_plan_decomposition decomposition;
  struct vg_cut_rule rule;
  struct vg_rates rates;
  struct vg_forecast forecast;
  int is_grown; /* 1: layers were grown; 0: estimated. */
  size_t n_wall_point;
  double layer_tet, layer_point;  /* Of the layers, as tetrahedra only. */
  double layer_join;              /* Cells of the layers in mixed output. */
  double cell, point, prism, tet; /* Counts of the mesh; cell: all types, prism:
                                     all that layers have in mixed output. */
  double phase[VG_PHASE_N];       /* Seconds on one core, outside the tasks;
                                     the mesh check includes the files written
                                     with it, writing the files after it. */
  double surface_peak;            /* Bytes of this process at most until the
                                     surface was complete. */
  double shared;                  /* Bytes of surface, layers and sizing field,
                                     of which a node has one copy. */
  size_t n_row;
  struct vg_plan_row *row; /* [n_row] */
  size_t best;             /* Best row; SIZE_MAX: none meets the criterion. */
  size_t n_leaf;
  struct {
    double cells;
    size_t n;
    struct vg_plan_row row;
  } leaf[VG_PLAN_LEAVES]; /* Other leaf sizes at the best row. */
  size_t best_leaf;
};

/** Notes the processor time, so that the time of reading counts for the run. */
void vg_plan_begin(struct vg_plan *p);

/** Makes surface and sizing field of p->problem, which has been read, as
 * vanguard mesh does, grows or estimates the layers, and forecasts the run on
 * all requested machines. The boundary and the resolved settings are then those
 * of the problem, which gets notes. Times are measured in this process, so
 * other threads of it distort them. On failure p holds what was made before.
 *
 * The errors are those of vanguard mesh before its fill; VG_ERR_STOPPED. */
vg_status vg_plan_make(struct vg_plan *p, struct vg_error *err);

/** Releases the results; problem and layers belong to the caller. */
void vg_plan_release(struct vg_plan *p);

/** Time of a phase on the machine of a row. parts [3] receives the times of its
 * portions that run on one thread, on the cores of a node and on all workers.
 * Returns their sum. */
double vg_plan_phase(const struct vg_plan *p, const struct vg_plan_row *r,
                     enum vg_phase phase, double parts[3]);

/** Size in bytes of the files of a format in the write list, 0: unknown; and of
 * the whole list. */
double vg_plan_bytes(const struct vg_plan *p, const char *item);
double vg_plan_bytes_all(const struct vg_plan *p);

#endif
