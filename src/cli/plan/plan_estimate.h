/* cli/plan/plan_estimate.h: the forecast of a project, for plan_*.c. Uses
 * run/input/layers.h, partition/model/rates.h.
 *
 * plan_estimate.c computes it, plan_print.c tells it. */
#ifndef VG_CLI_PLAN_PLAN_ESTIMATE_H
#define VG_CLI_PLAN_PLAN_ESTIMATE_H

#include "cli/plan/plan.h"
#include "cli/plot/timeline.h"
#include "partition/cut/decomposition.h"
#include "partition/model/rates.h"
#include "run/input/layers.h"
#include "run/input/source_effect.h"

enum { VG_PLAN_LEAVES = 8 };

/** A whole run on a machine. */
struct vg_plan_row {
  int ranks, threads, ranks_per_node;
  struct vg_model_result tasks; /* cutting and filling alone */
  double wall;                  /* s, of everything */
  double speedup, efficiency;   /* of everything, against one worker */
  double memory;                /* bytes of a rank */
};

/** What the field is parted into before it is filled. */
struct vg_plan_decomposition {
  size_t n_part;      /* 0: not parted */
  size_t n_whole;     /* of these, filled as they are */
  double cells, most; /* expected in all of these, in one at most */
  double seconds;
  struct vg_decomposition made;
  struct vg_load *load; /* [n_part] */
};

struct vg_plan {
  const struct vg_plan_options *o;
  struct vg_display show;
  struct vg_problem problem;
  struct vg_layer_stage layers;
  struct vg_mesh lifted;       /* the surface on top of estimated layers */
  struct vg_mesh grown;        /* the front above layers that were grown;
                                  borrowed from layers and problem */
  const struct vg_mesh *front; /* what bounds the field; borrowed */
  struct vg_sizing *sizing;    /* over the front */
  struct vg_effects effects;
  struct vg_load load;
  struct vg_plan_decomposition decomposition;
  struct vg_cut_rule rule;
  struct vg_rates rates;
  struct vg_rate_fit fit[VG_RATE_FITS]; /* n is 0: not fitted */
  double spread_per_cell;               /* s */
  struct vg_forecast forecast;
  int is_grown; /* layers were; else they are estimated */
  size_t n_wall_point;
  double layer_tet, layer_point;  /* if all are tetrahedra */
  double cell, point, prism, tet; /* of the mesh; cell: of all kinds */
  double phase[VG_PHASE_N];       /* s of one core, outside the tasks; judging
                                     includes the files written with it, writing
                                     those that follow */
  double shared, per_cell, per_thread; /* bytes: of any rank; of the mesh,
                                  the mean of field and layers; of a leaf */
  size_t n_row;
  struct vg_plan_row *row; /* [n_row] */
  size_t best;             /* row; SIZE_MAX: none reaches the target */
  size_t n_leaf;
  struct {
    double cells;
    size_t n;
    struct vg_plan_row row;
  } leaf[VG_PLAN_LEAVES]; /* other leaf sizes at the best row */
  size_t best_leaf;
};

/** What a phase takes on the machine of a row: parts [3] out: by one thread, by
 * each node, by all workers. Returns their sum. */
double vg_plan_phase(const struct vg_plan *p, const struct vg_plan_row *r,
                     enum vg_phase phase, double parts[3]);

/** Bytes of the files that a word of the write list stands for; 0: not
 * known. */
double vg_plan_bytes(const struct vg_plan *p, const char *item);

/** p->decomposition, where one is asked for. (plan_decomposition.c) */
vg_status vg_plan_part(struct vg_plan *p, struct vg_error *err);
void vg_plan_decomposition_release(struct vg_plan_decomposition *q);

/** The forecast of the tasks of p->decomposition. (plan_decomposition.c) */
vg_status vg_plan_parted(const struct vg_plan *p, const struct vg_front *v,
                         const struct vg_cut_rule *rule,
                         struct vg_forecast *out, struct vg_error *err);

/** Speed-up over workers as a figure. */
vg_status vg_plan_draw(const struct vg_plan *p, struct vg_error *err);

void vg_plan_text(const struct vg_plan *p);
vg_status vg_plan_json(const struct vg_plan *p, struct vg_error *err);

#endif
