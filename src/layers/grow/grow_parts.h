/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* layers/grow/grow_parts.h: data shared by the steps of vg_layers_grow. Private
 * to layers. Arrays are per column unless stated otherwise. "height" is
 * measured in units of column.dir, so that the wall distance of the first point
 * is delta1. */
#ifndef VG_LAYERS_GROW_GROW_PARTS_H
#define VG_LAYERS_GROW_GROW_PARTS_H

#include <assert.h>

#include "core/geometry/vector.h"
#include "layers/clear/clear.h"
#include "layers/columns/layers.h"
#include "layers/slide/slide.h"
#include "layers/topology/topology.h"

#define VG_VISIBILITY_MIN                                                      \
  0.0002 /* L5: least cosine between a column and a face. */
/* Longest dir to be considered: a wedge of 0.1 degrees. */
#define VG_FACTOR_MAX 1000.0
#define VG_FACTOR_WHOLE 2.0 /* Longest dir that is used. */

struct vg_layer_work {
  const struct vg_mesh *m;
  const struct vg_sizing *sizing;
  const struct vg_layer_options *o;
  size_t n_slide;
  struct vg_slide *slide;
  uint8_t *is_wall, *is_slide; /* [m->n_patch] flags. */
  double *noise; /* [n_slide] largest distance of the points of a plane patch
                    from its plane; INFINITY: the patch is curved. */
  struct vg_twins twins;
  struct vg_columns *c;
  struct vg_topology t;
  double (*normal)[3];   /* [n_face] unit normal; 0 for virtual faces. */
  uint8_t *cap;          /* [n_face] 1 + k: a cap whose corner k nearly lies on
                            the opposite edge; + 4: its normal is noise. */
  double (*root_dir)[3]; /* Unit direction before smoothing. */
  double *visibility;    /* Visibility: least cosine with its faces that dir
                      must keep; 0: no direction sees all faces. */
  double *edge;          /* Local isotropic edge length; in a stretched field,
                            target edge length along the column above it. */
  double *margin;        /* Distance that its top keeps from opposite tops,
                            as far as its height reaches. */
  double *wanted;        /* Height of n_wanted levels by the growth law. */
  double *allowed;       /* Allowed height, <= wanted. */
  double *slack;         /* [as t.near] largest difference of `allowed` between
                            neighbours. */
  double *settled;       /* `allowed` at the last computation of cap and ... */
  uint16_t *own;         /* ... levels. */
  uint8_t *why;          /* enum vg_layer_cause: what limited `allowed`. */
  uint8_t *by_size;      /* n_wanted is where layers reach the local size. */
  size_t max_valence;    /* Most faces at a column. */
  int last_resort;       /* Too many rounds: columns that fail lose all
                            height. */
};

/** Range first .. end - 1 of the columns with the same root as column i. */
static inline void vg_root_range(const struct vg_columns *c, uint32_t i,
                                 uint32_t *first, uint32_t *end)
{
  assert(i < c->n_column);

  const uint32_t root = c->column[i].root;

  for (*first = i; *first > 0 && c->column[*first - 1].root == root;) --*first;
  for (*end = i + 1; *end < c->n_column && c->column[*end].root == root;)
    ++*end;
}

static inline double vg_root_distance(const struct vg_layer_work *w, uint32_t i,
                                      uint32_t j)
{
  assert(i < w->c->n_column && j < w->c->n_column);
  return vg_distance(w->m->point[w->c->column[i].root],
                     w->m->point[w->c->column[j].root]);
}

/* direct.c, bend.c, lift.c ------------------------------------------------*/

/** Computes the normals of faces, the initial directions and their
 * visibility. */
vg_status vg_directions_first(struct vg_layer_work *w, struct vg_error *err);

/** Why column i has no direction: VG_CAUSE_SLIDE if a direction out of its
 * slide patches would see all faces, otherwise VG_CAUSE_VISIBILITY.
 * n: scratch, [max_valence]. */
enum vg_layer_cause vg_unseen_cause(const struct vg_layer_work *w, size_t i,
                                    double (*n)[3]);

/** Bends directions apart where columns of height `wanted` would converge. */
vg_status vg_directions_smooth(struct vg_layer_work *w, struct vg_error *err);

/** Sets the lengths of dir so that layers are as thick as the growth law
 * requests. The apex of a cap then follows the two ends of the opposite
 * edge. */
vg_status vg_directions_scale(struct vg_layer_work *w, struct vg_error *err);

/** Computes the shift that places the first point delta1 away from the wall.
 * which: [n_column] columns to process; NULL: all. */
void vg_directions_shift(struct vg_layer_work *w, const uint8_t *which);

/** Makes the columns of faces with turn[f] != 0 more parallel, as far as
 * visibility permits. turned out: [n_column] set to 1 where dir changed. */
vg_status vg_directions_even(struct vg_layer_work *w, const uint8_t *turn,
                             uint8_t *turned, struct vg_error *err);

/* height.c ----------------------------------------------------------------*/

/** Propagates a bound over the columns. change(w, context, i, j) updates the
 * bound of column t.near[j] from that of column i, always in the same
 * direction, and returns whether it changed. Ends at the fixed point, which
 * does not depend on the order. */
vg_status vg_columns_spread(struct vg_layer_work *w,
                            int (*change)(struct vg_layer_work *, void *,
                                          uint32_t, uint32_t),
                            void *context, struct vg_error *err);

/** Computes edge, law, n_wanted and wanted; sets allowed = wanted. */
vg_status vg_heights_wanted(struct vg_layer_work *w, struct vg_error *err);

/** Computes slack: at most the slope times the distance of the roots, and, in
 * thin faces with inclined columns, small enough that the face does not turn
 * over. */
vg_status vg_heights_slack(struct vg_layer_work *w, struct vg_error *err);

/** Lowers `allowed` where columns converge. */
vg_status vg_heights_corner(struct vg_layer_work *w, struct vg_error *err);

/** Lowers `allowed` to at most `limit` because of `why`. */
void vg_heights_lower(struct vg_layer_work *w, size_t column, double limit,
                      enum vg_layer_cause why);

/** Computes cap, n and causes from `allowed`. The allowed heights of neighbours
 * differ by at most the slack, their levels by any number. `moved` out:
 * [n_column], 1 where n or cap changed; may be NULL. */
vg_status vg_heights_settle(struct vg_layer_work *w, uint8_t *moved,
                            struct vg_error *err);

/* twins_grow.c ------------------------------------------------------------*/

/* Columns and their twins get the same direction, law, heights and levels, from
 * whichever of them has less. Without periodic patches nothing happens. The
 * functions for wanted, allowed and levels return the number of changes; they
 * and the spreads over neighbours are repeated until nothing changes. */

/** First directions: the mean of both if both see their faces, else one of
 * them. scratch: [max_valence]. */
void vg_twins_first(struct vg_layer_work *w, double (*scratch)[3]);

/** The same for later directions, which must keep a share of the visibility;
 * otherwise `from`. turned: [n_column] columns to process; NULL: all. */
void vg_twins_agree(struct vg_layer_work *w, const uint8_t *turned,
                    double (*from)[3], double kept, double (*scratch)[3]);

/** Marks the twins of marked columns. */
void vg_twins_turned(struct vg_layer_work *w, uint8_t *turned);

/** Lengths and shifts. */
void vg_twins_farther(struct vg_layer_work *w);

void vg_twins_laws(struct vg_layer_work *w);
size_t vg_twins_wanted(struct vg_layer_work *w);
void vg_twins_edges(struct vg_layer_work *w);
size_t vg_twins_allowed(struct vg_layer_work *w);
size_t vg_twins_levels(struct vg_layer_work *w);

/* cells.c -----------------------------------------------------------------*/

/** Finds the faces with an inverted or too flat cell. Faces without a `moved`
 * column are skipped (NULL: no face is skipped). The columns of these faces
 * are lowered, or made more parallel if lowering would cost levels and
 * `may_turn` is set. *n_bad out: number of such faces. turned out: as in
 * vg_directions_even. */
vg_status vg_cells_lower(struct vg_layer_work *w, const uint8_t *moved,
                         int may_turn, uint8_t *turned, size_t *n_bad,
                         struct vg_error *err);

/* order.c -----------------------------------------------------------------*/

/** Sorts the faces of the finished layers along a Hilbert curve. Fewer faces
 * then lie between slices, and neighbouring points have nearby numbers. */
vg_status vg_layers_order(const struct vg_mesh *surface, struct vg_layers *l,
                          struct vg_error *err);

#endif
