/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* layers/topology/fan.h: fans, several columns at one point of a convex edge.
 * Private to topology*.c and fan*.c. Uses core, topology_wall.h.
 *
 * Edges that turn by more than the fan angle are ridges. The ridges at a point
 * divide its faces into sectors, and each sector has a column. The columns
 * between two neighbouring sectors, whose directions are preset, form a chain
 * across the ridge with the columns of both sectors. Section across a ridge at
 * point p, with c0 and c4 the columns of the sectors:
 *
 *     upper face     c0  c1
 *     ----____        | /
 *             ----____|/
 *        body         p----c2      all columns stand on p; each step
 *             ____----|\           turns by 40 degrees at most
 *     ----''''        | \
 *     lower face     c4  c3
 *
 * Virtual faces connect the chains of the two ends p and q of a ridge, and
 * close the polygon that is left between the chains where three or more sectors
 * meet. Seen from the fluid, a chain of three steps at p and one of two steps
 * at q:
 *
 *     p0-----p1-----p2-----p3
 *      \    /  \    |   .'  |      at level 0 all columns of p are one
 *       \  /    `.  | .'    |      point, as are those of q, so virtual
 *        q0---------q1------q2     faces have zero area there
 *
 * The columns of a point are numbered counter-clockwise from its first column:
 * the column of a sector, the preset columns up to the next sector, and so on,
 * and last the centre of the polygon, if there is one. A chain goes from the
 * column of the sector clockwise of the ridge to the column of the other
 * sector. */
#ifndef VG_LAYERS_TOPOLOGY_FAN_H
#define VG_LAYERS_TOPOLOGY_FAN_H

#include <assert.h>

#include "layers/topology/topology_wall.h"

/* Most sectors of a fan; a point with more keeps one column. */
#define VG_FAN_SECTORS 16
#define VG_FAN_STEPS 12 /* Most steps of a chain. */
#define VG_FAN_COLUMNS (VG_FAN_SECTORS * VG_FAN_STEPS + 1)

/* The directions of the columns at one point. */
struct vg_fan_shape {
  /* Input. */
  int n_sector, is_open; /* Open ring of faces: one ridge fewer than sectors. */
  int has_plane;
  double plane[3];                  /* Normal of the plane in which all
                                       directions must lie. */
  double sector[VG_FAN_SECTORS][3]; /* Unit direction of each sector,
                                       counter-clockwise. */
  double ridge[VG_FAN_SECTORS][3];  /* Unit vector along the ridge between
                                       sectors i and i + 1, away from the
                                       point. */
  /* Output. */
  int n_column;
  int shared;                 /* The ridge whose chain consists of the other
                                 chains in reverse, so that no polygon is left;
                                 -1: none. */
  int n_polygon;              /* Columns around the polygon at the point; 0: no
                                 polygon. */
  int has_centre;             /* 1: the last column stands in the middle of the
                                 polygon. */
  int at[VG_FAN_SECTORS];     /* Column of each sector. */
  int n_step[VG_FAN_SECTORS]; /* Steps of the chain across each ridge. */
  double dir[VG_FAN_COLUMNS][3];
};

/** Computes the output members. Returns 1, or 0 if cells between these
 * directions would not have positive volume; the point then keeps one
 * column. */
int vg_fan_spread(struct vg_fan_shape *s);

/* Columns of a point across one of its ridges: a, a + 1, ..., b (b may be one
 * past the last), or a, a - 1, ..., b if `down`. */
struct vg_fan_chain {
  uint8_t a, b, n_step, down;
};

/** Column of step i = 0 .. n_step, counted from the first column of the
 * point. */
static inline uint32_t vg_fan_at(const struct vg_fan_chain *c, uint32_t i)
{
  assert(i <= c->n_step);
  if (i == c->n_step) return c->b;
  return c->down ? c->a - i : c->a + i;
}

struct vg_fan_point {
  uint32_t point; /* Wall point of the fan. */
  uint8_t n_column, n_polygon, has_centre, is_open;
};

struct vg_fan_preset {
  uint32_t point;
  uint32_t at; /* Column, counted from the first column of the point. */
  double dir[3];
};

struct vg_fans {
  size_t n_fan, n_preset, n_chain, n_face, n_border;
  uint32_t *first;              /* [wall n_point + 1] first column of each wall
                                   point. */
  uint8_t *at;                  /* [3 * wall n_face] column of each corner,
                                   counted from the first column of its point;
                                   NULL: 0 everywhere. */
  uint32_t *chain_of;           /* [3 * wall n_face] chain across the ridge that
                                   is this half-edge; VG_NO_INDEX if it is not a
                                   ridge. */
  struct vg_fan_chain *chain;   /* [n_chain] chains. */
  struct vg_fan_point *fan;     /* [n_fan] fans, sorted by point. */
  struct vg_fan_preset *preset; /* [n_preset] preset directions, sorted by
                                   column. */
  uint32_t (*face)[3];          /* [n_face] virtual faces, as columns. */
  uint32_t (*border)[2];        /* [n_border] boundary edges, as columns. */
  uint32_t *border_patch;       /* [n_border] slide patch of each boundary
                                   edge. */
};
#define VG_FANS_INIT                                                           \
  {                                                                            \
    0, 0, 0, 0, 0, NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL        \
  }

void vg_fans_release(struct vg_fans *f);

/** Finds the fans of a wall; *f must be empty. fan_angle >= 180: no fans; 0:
 * fans only where one column does not see all faces well enough; VG_FANS_SHARP:
 * also at sharp edges with triangles that are not stretched along them. */
vg_status vg_fans_build(const struct vg_wall *w, size_t n_slide,
                        const struct vg_slide *slide, double fan_angle,
                        struct vg_fans *f, struct vg_error *err);

/** Makes the virtual faces and boundary edges once columns and chains are known
 * (fan_face.c). */
vg_status vg_fans_close(const struct vg_wall *w, struct vg_fans *f,
                        struct vg_error *err);

/** Column of a corner. */
static inline uint32_t vg_fan_column(const struct vg_wall *w,
                                     const struct vg_fans *f, uint32_t h)
{
  assert(h < 3 * w->n_face);
  return f->first[w->face[h / 3][h % 3]] + (f->at ? f->at[h] : 0u);
}

#endif
