/* core/optimise/optimise_parts.h: what the steps of the optimisation share. */
#ifndef VG_CORE_OPTIMISE_OPTIMISE_PARTS_H
#define VG_CORE_OPTIMISE_OPTIMISE_PARTS_H

#include "core/delaunay/cavity.h"
#include "core/geometry/shape.h"
#include "core/optimise/optimise.h"

enum {
  VG_BALL_MAX = 256,
  VG_SHELL_MAX = 10,
  VG_NEW_MAX = VG_CAVITY_MAX,
  VG_OLD_MAX = VG_CAVITY_MAX
};

enum { /* what was tried without success, until a change */
       VG_FAILED_SMOOTH = 1,
       VG_FAILED_COLLAPSE = 2, /* of a point */
       VG_FAILED_SPLIT = 4,    /* of a cell */
       VG_NOT_IN_REGION = 8    /* likewise: does not belong to the region */
};

struct vg_optimiser {
  struct vg_tets *t;
  size_t n_fixed;                 /* points below stay */
  size_t n_keep;                  /* points below are not taken away */
  const struct vg_region *region; /* NULL: all cells matter */
  const struct vg_sizing *sizing; /* of the region */
  float *q;                       /* [cap_cell] shape of each cell */
  size_t cap_q;
  uint8_t *failed_cell; /* [cap_cell] steps of no use to each cell */
  size_t cap_failed_cell;
  uint32_t *star; /* [n_point] a cell of each point, or VG_NONE */
  size_t cap_star;
  uint8_t *failed; /* [n_point] and to each point, until a change */
  size_t cap_failed;
  size_t n_ball;
  uint32_t ball[VG_BALL_MAX]; /* links 4 * cell + index of the centre */
  int refused;                /* memory was refused */
  size_t spent, budget;       /* cells looked at to put points in */
  struct vg_optimise_report *report;
};

/** A cell of a shape from here on is as good as it need be (45, 135). */
#define VG_SHAPE_GOOD 0.5f

/* K40: moves of a point. Least factor on the worst shape below what is aimed
 * at, and on the sum of the shapes above it, that a move is worth. */
#define VG_GAIN_WORST 1.001
#define VG_GAIN_SUM 1.0005
/* Least share of the way to a target; steps up the slope of the worst shape, in
 * lengths of an edge: the first, the factor to the next one, the least. */
#define VG_SHARE_LEAST 0.2
#define VG_CLIMB_FIRST 0.25
#define VG_CLIMB_NEXT 0.4
#define VG_CLIMB_LEAST 0.01

static inline double vg_cell_shape(const struct vg_tets *t, uint32_t c)
{
  const uint32_t *v = t->cell[c].v;

  return vg_shape(t->x[v[0]], t->x[v[1]], t->x[v[2]], t->x[v[3]]);
}

/** Cell c changed: what failed for it and its points may work now. */
static inline void vg_changed(struct vg_optimiser *o, uint32_t c)
{
  const uint32_t *v = o->t->cell[c].v;

  o->t->flag[c] &= (uint8_t)~VG_TRIED;
  o->failed_cell[c] = 0;
  o->failed[v[0]] = o->failed[v[1]] = o->failed[v[2]] = o->failed[v[3]] = 0;
}

/** Collect the cells around point p in o->ball. 0 when there are more than
 * VG_BALL_MAX, or when the ball is cut by a fixed face. */
int vg_ball(struct vg_optimiser *o, uint32_t p);

/** Replace n_old cells by n_new ones that fill the same cavity.
 * The first slots of old are reused; shapes, stars, links and fixed faces are
 * brought up to date. made out: [n_new] the slots used; may be NULL.
 * Returns 0; -1 when memory was refused, t unchanged. */
int vg_replace(struct vg_optimiser *o, int n_old, const uint32_t *old,
               int n_new, const uint32_t (*v)[4], const float *q,
               uint32_t *made);

/* Steps. Each returns 1 when the mesh became better, else 0. */

/** Move p so that the worst cell around it gets better; `aim` > 0: positions
 * that leave every cell above aim count by their mean shape instead. */
int vg_smooth(struct vg_optimiser *o, uint32_t p, double aim);

/** Remove faces and edges of cell c where the worst of the cells concerned
 * gets better by it. */
int vg_swap(struct vg_optimiser *o, uint32_t c);

/** Take away a vertex of the bad cell c, into one of its neighbours. */
int vg_collapse(struct vg_optimiser *o, uint32_t c);

/** How much vg_split may spend on t. */
size_t vg_split_budget(const struct vg_tets *t);

/** Put a point into the bad cell c, in a cavity opened for it, and smooth it
 * towards `aim`; once the budget is spent nothing. */
int vg_split(struct vg_optimiser *o, uint32_t c, double aim);

#endif
