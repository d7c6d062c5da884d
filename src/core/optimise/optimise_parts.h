/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/optimise/optimise_parts.h: declarations shared by the steps of the
 * optimisation. */
#ifndef VG_CORE_OPTIMISE_OPTIMISE_PARTS_H
#define VG_CORE_OPTIMISE_OPTIMISE_PARTS_H

#include "core/delaunay/cavity.h"
#include "core/geometry/shape.h"
#include "core/metric/metrics.h"
#include "core/optimise/optimise.h"

enum {
  VG_BALL_MAX = 256,
  VG_SHELL_MAX = 10,
  VG_NEW_MAX = VG_CAVITY_MAX,
  VG_OLD_MAX = VG_CAVITY_MAX
};

enum { /* steps that failed for a point; cleared by a change */
       VG_FAILED_SMOOTH = 1,
       VG_FAILED_COLLAPSE = 2
};

enum { /* for a cell; cleared by a change */
       VG_FAILED_SPLIT = 1,
       VG_NOT_IN_REGION = 2, /* does not belong to the region */
       VG_FAILED_LENGTH = 4, /* << edge: the length of this edge could not be
                                changed in this pass (optimise_lengths.c) */
       VG_EVEN = 63 * VG_FAILED_LENGTH /* all six bits: no length requires a
                                          change, or none could be changed */
};

/* Shapes that decide which cells the steps improve. Without metrics, shapes are
 * those of vg_shape, with metrics those of vg_metric_shape. */
struct vg_shape_levels {
  double aim;       /* cells below this are improved one by one */
  float fair;       /* sweeps swap cells below this */
  float good;       /* the first sweep moves the points of cells below this */
  double desperate; /* points are removed and inserted below this */
  float worst;      /* more positions are tried for cells below this */
};

struct vg_optimiser {
  struct vg_tets *t;
  size_t n_fixed;                 /* points with a lower index do not move */
  size_t n_keep;                  /* points with a lower index are not
                                     removed */
  const struct vg_region *region; /* NULL: all cells are improved */
  const struct vg_sizing *sizing; /* measures the region */
  struct vg_metrics *metrics;     /* metrics of the points, in which shapes
                                     are measured; NULL: Euclidean shapes */
  const struct vg_shape_levels *level; /* limits of shapes for the steps */
  float *q;                            /* [cap_cell] shape of each cell */
  size_t cap_q;
  uint8_t *failed_cell; /* [cap_cell] bits of each cell, as above */
  size_t cap_failed_cell;
  uint32_t *star; /* [n_point] a cell of each point, or VG_NONE */
  size_t cap_star;
  uint8_t *failed; /* [n_point] bits of each point, as above */
  size_t cap_failed;
  size_t n_ball;
  uint32_t ball[VG_BALL_MAX]; /* links 4 * cell + index of the centre */
  int refused;                /* memory was refused */
  size_t spent, budget;       /* cells examined by insertion of points, and
                                 their limit */
  struct vg_optimise_report *report;
};

/** A cell of this shape or better is good enough (45, 135 degrees). */
#define VG_SHAPE_GOOD 0.5f

/* K40: factors by which a move of a point must improve the worst shape, if
 * that is below the target, or otherwise the sum of the shapes. */
#define VG_GAIN_WORST 1.001
#define VG_GAIN_SUM 1.0005
/* Smallest fraction of the way to a target position that is tried. Steps along
 * the gradient of the worst shape, relative to an edge length: the first step,
 * the factor to the next one, the smallest one. */
#define VG_SHARE_LEAST 0.2
#define VG_CLIMB_FIRST 0.25
#define VG_CLIMB_NEXT 0.4
#define VG_CLIMB_LEAST 0.01

/** Shape of the cell with corners a b c d. */
static inline double vg_shape_of(const struct vg_optimiser *o, uint32_t a,
                                 uint32_t b, uint32_t c, uint32_t d)
{
  const struct vg_tets *t = o->t;

  if (o->metrics) {
    const uint32_t v[4] = { a, b, c, d };

    return vg_metrics_shape(o->metrics, t, v);
  }
  return vg_shape(t->x[a], t->x[b], t->x[c], t->x[d]);
}

/** To be called when cell c has changed: steps that failed for it and its
 * points may work now. */
static inline void vg_changed(struct vg_optimiser *o, uint32_t c)
{
  const uint32_t *v = o->t->cell[c].v;

  o->t->flag[c] &= (uint8_t)~VG_TRIED;
  o->failed_cell[c] = 0;
  o->failed[v[0]] = o->failed[v[1]] = o->failed[v[2]] = o->failed[v[3]] = 0;
}

/** Collect the cells around point p in o->ball. Returns 0 if there are more
 * than VG_BALL_MAX, or if a fixed face cuts the ball. */
int vg_ball(struct vg_optimiser *o, uint32_t p);

/** Replace n_old cells by n_new cells that fill the same cavity. The first
 * slots of old are reused; shapes, stars, links and fixed faces are updated.
 * made out: [n_new] the slots used; may be NULL. Returns 0, or -1 if memory
 * was refused; t is unchanged then. */
int vg_replace(struct vg_optimiser *o, int n_old, const uint32_t *old,
               int n_new, const uint32_t (*v)[4], const float *q,
               uint32_t *made);

/* Steps. Each returns 1 if the mesh has improved, otherwise 0. */

/** Move p so that the worst cell around it improves. If `aim` > 0, positions
 * where every cell is above aim are rated by the mean shape instead. */
int vg_smooth(struct vg_optimiser *o, uint32_t p, double aim);

/** The balls of all points, for a pass that changes no cells. */
struct vg_balls {
  uint32_t *first;  /* [n_point + 1] first link of each point */
  uint32_t *link;   /* [first[n_point]] 4 * cell + index of the point */
  uint8_t *is_open; /* [n_point] 1: a fixed face, the hull or a cell outside
                       cuts the ball */
};

/** Returns 0, or -1 if memory is refused. Call vg_balls_release in any case. */
int vg_balls_init(const struct vg_tets *t, struct vg_balls *b);
void vg_balls_release(struct vg_balls *b);

/** vg_smooth for a point whose ball is known. */
int vg_smooth_within(struct vg_optimiser *o, const struct vg_balls *b,
                     uint32_t p, double aim);

/** vg_smooth with metrics. */
int vg_smooth_metric(struct vg_optimiser *o, uint32_t p);

/** The step of vg_smooth_metric: move p, with its metric, among the cells
 * around it, if that improves them. link: [n] 4 * cell + index of p, with
 * 0 < n <= VG_BALL_MAX. q out: [VG_BALL_MAX] their new shapes if p moves.
 * Returns the relative decrease of the function that is minimised, or 0 if p
 * does not move. */
double vg_move_in_metric(struct vg_tets *t, struct vg_metrics *metrics,
                         uint32_t p, size_t n, const uint32_t *link, double *q);

/** Collapse edges that are too short in the metric, and split those that are
 * too long, in one pass over the cells. VG_ERR_MEMORY. (optimise_lengths.c) */
vg_status vg_even_lengths(struct vg_optimiser *o, struct vg_error *err);

/** Put x at index n_point of the points, with its metric if there are metrics,
 * without adding it. Returns 0, or -1 if memory was refused. */
int vg_try_point(struct vg_optimiser *o, const double x[3]);

/** Remove faces and edges of cell c if this improves the worst of the affected
 * cells. */
int vg_swap(struct vg_optimiser *o, uint32_t c);

/** Remove a vertex of the bad cell c by collapsing it onto one of its
 * neighbours. */
int vg_collapse(struct vg_optimiser *o, uint32_t c);

/** Collapse p onto its neighbour `to`, with metrics. Refused if a new shape is
 * below `need` and below the worst shape around p, or if a new edge is longer
 * than `most` in the metric. */
int vg_merge_onto(struct vg_optimiser *o, uint32_t p, uint32_t to, double need,
                  double most);

/** Insert a point in the middle of edge a b of cell c. Refused if a new shape
 * is below `share` times the worst one around the edge, or if a new edge is
 * shorter than `least` in the metric. */
int vg_split_edge(struct vg_optimiser *o, uint32_t c, uint32_t a, uint32_t b,
                  double share, double least);

/** Limit of the number of cells that vg_split examines in t. */
size_t vg_split_budget(const struct vg_tets *t);

/** Insert a point into the bad cell c, in a cavity opened for it, and smooth it
 * towards `aim`. Does nothing once the budget is spent. */
int vg_split(struct vg_optimiser *o, uint32_t c, double aim);

#endif
