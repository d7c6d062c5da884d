/* layers/topology/fan.h: several columns at one point of a convex edge. Private
 * to topology*.c and fan*.c. Uses core, topology_wall.h.
 *
 * The columns of a point are numbered from its first one, counter-clockwise:
 * that of a sector, the preset ones up to the next sector, and so on; last, if
 * there is one, the centre. Across a ridge lies a chain, from the column of
 * the sector clockwise of it to that of the other one. */
#ifndef VG_LAYERS_TOPOLOGY_FAN_H
#define VG_LAYERS_TOPOLOGY_FAN_H

#include <assert.h>

#include "layers/topology/topology_wall.h"

#define VG_FAN_SECTORS 16 /* at a point; with more it keeps one column */
#define VG_FAN_STEPS 12   /* of a chain */
#define VG_FAN_COLUMNS (VG_FAN_SECTORS * VG_FAN_STEPS + 1)

/* One point: which directions its columns get. */
struct vg_fan_shape {
  /* in */
  int n_sector, is_open; /* open: one ridge less than sectors */
  int has_plane;
  double plane[3];                  /* directions have to be normal to this */
  double sector[VG_FAN_SECTORS][3]; /* unit, counter-clockwise */
  double ridge[VG_FAN_SECTORS][3];  /* unit, away from the point, between
                                       sectors i and i + 1 */
  /* out */
  int n_column;
  int shared;                 /* the ridge whose chain is those of all others,
                                 backwards, so that there is no gap; -1: none */
  int n_polygon;              /* columns around the gap at the point, 0: none */
  int has_centre;             /* the gap has a column in its middle, the last */
  int at[VG_FAN_SECTORS];     /* column of each sector */
  int n_step[VG_FAN_SECTORS]; /* of the chain across each ridge */
  double dir[VG_FAN_COLUMNS][3];
};

/** Fill the second part. Returns 1, or 0 when cells between these directions
 * would not be positive: the point then has to do with one column. */
int vg_fan_spread(struct vg_fan_shape *s);

/* Columns of a point across one of its ridges: a, a + 1, ..., b (b may be
 * behind the last one), or, where `down`, a, a - 1, ..., b. */
struct vg_fan_chain {
  uint8_t a, b, n_step, down;
};

/** Column of step i = 0 .. n_step, counted from the first of the point. */
static inline uint32_t vg_fan_at(const struct vg_fan_chain *c, uint32_t i)
{
  assert(i <= c->n_step);
  if (i == c->n_step) return c->b;
  return c->down ? c->a - i : c->a + i;
}

struct vg_fan_point {
  uint32_t point; /* of the wall */
  uint8_t n_column, n_polygon, has_centre, is_open;
};

struct vg_fan_preset {
  uint32_t point;
  uint32_t at; /* column, counted from the point's first */
  double dir[3];
};

struct vg_fans {
  size_t n_fan, n_preset, n_chain, n_face, n_border;
  uint32_t *first;              /* [wall n_point + 1] first column */
  uint8_t *at;                  /* [3 * wall n_face] column of each corner from
                                   the point's first; NULL: 0 */
  uint32_t *chain_of;           /* [3 * wall n_face] chain across the ridge that
                                   is this half-edge, else VG_NO_INDEX */
  struct vg_fan_chain *chain;   /* [n_chain] */
  struct vg_fan_point *fan;     /* [n_fan] by rising point */
  struct vg_fan_preset *preset; /* [n_preset] by rising column */
  uint32_t (*face)[3];          /* [n_face] virtual faces, of columns */
  uint32_t (*border)[2];        /* [n_border] of columns */
  uint32_t *border_patch;       /* [n_border] */
};
#define VG_FANS_INIT                                                           \
  {                                                                            \
    0, 0, 0, 0, 0, NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL        \
  }

void vg_fans_release(struct vg_fans *f);

/** Fans of a wall into the empty *f; fan_angle >= 180: none; 0: only where one
 * column sees too little. */
vg_status vg_fans_build(const struct vg_wall *w, size_t n_slide,
                        const struct vg_slide *slide, double fan_angle,
                        struct vg_fans *f, struct vg_error *err);

/** Virtual faces and borders, once columns and chains are known (fan_face.c).
 * */
vg_status vg_fans_close(const struct vg_wall *w, struct vg_fans *f,
                        struct vg_error *err);

/** The column of a corner. */
static inline uint32_t vg_fan_column(const struct vg_wall *w,
                                     const struct vg_fans *f, uint32_t h)
{
  assert(h < 3 * w->n_face);
  return f->first[w->face[h / 3][h % 3]] + (f->at ? f->at[h] : 0u);
}

#endif
