/* layers/grow/grow_parts.h: what the steps of vg_layers_grow share. Private to
 * layers. Arrays are per column unless said otherwise; "height" counts in units
 * of column.dir, so that the wall distance of the first point is delta1. */
#ifndef VG_LAYERS_GROW_GROW_PARTS_H
#define VG_LAYERS_GROW_GROW_PARTS_H

#include <assert.h>

#include "core/geometry/vector.h"
#include "layers/clear/clear.h"
#include "layers/columns/layers.h"
#include "layers/slide/slide.h"
#include "layers/topology/topology.h"

#define VG_VISIBILITY_MIN                                                      \
  0.0002                     /* L5: least cosine between a column and a face */
#define VG_FACTOR_MAX 1000.0 /* longest dir: a wedge of 0.1 degrees */
#define VG_FACTOR_WHOLE 2.0  /* longest dir */

struct vg_layer_work {
  const struct vg_mesh *m;
  const struct vg_sizing *sizing;
  const struct vg_layer_options *o;
  size_t n_slide;
  struct vg_slide *slide;
  uint8_t *is_wall, *is_slide; /* [m->n_patch] */
  double *noise; /* [n_slide] how far points of a plane patch lie off
                    its plane; INFINITY: it is curved */
  struct vg_columns *c;
  struct vg_topology t;
  double (*normal)[3];   /* [n_face] unit; 0 for virtual faces */
  uint8_t *cap;          /* [n_face] 1 + k: a triangle so flat that corner k
                            lies on the edge across; bit 4: its normal is
                            noise */
  double (*root_dir)[3]; /* unit, before smoothing */
  double *visibility;    /* least cosine to its faces that dir must keep;
                      0: no direction sees them all */
  double *edge;          /* local isotropic edge */
  double *wanted;        /* height of n_wanted levels by the law */
  double *allowed;       /* height it may take, <= wanted */
  double *slack;         /* [like t.near] by how much `allowed` may differ */
  double *settled;       /* `allowed` for which cap and ... */
  uint16_t *own;         /* ... levels were found last */
  uint8_t *why;          /* enum vg_layer_cause: what set `allowed` */
  uint8_t *by_size;      /* n_wanted is where the local size is reached */
  size_t max_valence;    /* faces at a column */
  int last_resort;       /* too many rounds: what is bad loses all height */
};

/** Columns first .. end - 1 have the root of column i. */
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

/** Normals of faces, first directions and their visibility. */
vg_status vg_directions_first(struct vg_layer_work *w, struct vg_error *err);

/** Bend directions where columns of height `wanted` would converge. */
vg_status vg_directions_smooth(struct vg_layer_work *w, struct vg_error *err);

/** Lengths of dir, so that layers are as thick as the law says; the apex of a
 * cap then follows the two ends of the edge it lies on. */
vg_status vg_directions_scale(struct vg_layer_work *w, struct vg_error *err);

/** shift: what puts the first point delta1 away from the wall. which:
 * [n_column] the columns to look at, NULL: all. */
void vg_directions_shift(struct vg_layer_work *w, const uint8_t *which);

/** Make the columns of faces with turn[f] != 0 more alike, as far as they
 * keep their visibility. turned out: [n_column] set to 1 where dir changed. */
vg_status vg_directions_even(struct vg_layer_work *w, const uint8_t *turn,
                             uint8_t *turned, struct vg_error *err);

/* height.c ----------------------------------------------------------------*/

/** Spread a bound over the columns: change(w, context, i, j) moves that of
 * column t.near[j] because of that of column i, always to the same side, and
 * says whether it did. Ends at the fixed point, which does not depend on the
 * order. */
vg_status vg_columns_spread(struct vg_layer_work *w,
                            int (*change)(struct vg_layer_work *, void *,
                                          uint32_t, uint32_t),
                            void *context, struct vg_error *err);

/** edge, law, n_wanted and wanted; allowed = wanted. */
vg_status vg_heights_wanted(struct vg_layer_work *w, struct vg_error *err);

/** slack: no more than the slope times the distance of the roots, and in thin
 * faces whose columns lean over so little that the face does not turn over. */
vg_status vg_heights_slack(struct vg_layer_work *w, struct vg_error *err);

/** Lower `allowed` where columns converge. */
vg_status vg_heights_corner(struct vg_layer_work *w, struct vg_error *err);

/** Lower `allowed` to at most `limit` for the reason `why`. */
void vg_heights_lower(struct vg_layer_work *w, size_t column, double limit,
                      enum vg_layer_cause why);

/** From `allowed` to cap, n and causes: allowed heights of neighbours differ by
 * no more than the slack, levels by any number. `moved` out: [n_column], may be
 * NULL: 1 where n or cap changed. */
vg_status vg_heights_settle(struct vg_layer_work *w, uint8_t *moved,
                            struct vg_error *err);

/* cells.c -----------------------------------------------------------------*/

/** Find the faces with a cell that is inverted or too flat; faces without a
 * `moved` column are skipped (NULL: none is). Their columns are lowered; but
 * where that would cost levels and `may_turn`, they are made more alike.
 * *n_bad out: how many faces. turned out: as vg_directions_even. */
vg_status vg_cells_lower(struct vg_layer_work *w, const uint8_t *moved,
                         int may_turn, uint8_t *turned, size_t *n_bad,
                         struct vg_error *err);

/* order.c -----------------------------------------------------------------*/

/** Put the faces of grown layers in an order along a Hilbert curve: fewer lie
 * between slices, and points are numbered near their neighbours. */
vg_status vg_layers_order(const struct vg_mesh *surface, struct vg_layers *l,
                          struct vg_error *err);

#endif
