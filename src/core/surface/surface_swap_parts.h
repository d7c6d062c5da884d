/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/surface/surface_swap_parts.h: declarations shared by surface_swap*.c.
 * Not part of the public interface. */
#ifndef VG_CORE_SURFACE_SURFACE_SWAP_PARTS_H
#define VG_CORE_SURFACE_SURFACE_SWAP_PARTS_H

#include <assert.h>
#include <stdint.h>

#include "core/mesh/edges.h"
#include "core/surface/surface_swap.h"

/* A surface being changed. Half-edge 3 t + k runs from tri[t][k] to tri[t][(k +
 * 1) % 3]; each has a mate that runs the other way. */
struct vg_swapper {
  const struct vg_swap_options *o;
  double cosine; /* Cosine of options.angle. */
  size_t n_point, n_tri;
  const double (*point)[3];
  const uint32_t *patch; /* [n_tri] Patch of each triangle. */
  uint32_t (*tri)[3];    /* [n_tri] Removed triangles have three equal nodes. */
  uint32_t *mate;        /* [3 n_tri] Opposite half-edges. */
  double *moved;         /* [n_tri] Upper bound of the distance from the
                            original surface. */
  uint8_t *changed;      /* [n_tri] 1: changed. */
  uint8_t *locked;       /* [n_point] 1: the faces at the point must stay. */
  uint8_t *removed;      /* [n_point] 1: removed. */
  uint32_t *queue;       /* [3 n_tri] Circular queue of half-edges to
                            examine. */
  uint8_t *queued;       /* [3 n_tri] 1: in the queue. */
  size_t head, n_queue;
  int caps_only;  /* 1: skip pairs without a cap. */
  uint32_t *mark; /* [n_point] Last `turn` in which the point was a neighbour of
                     the point to be removed. */
  uint32_t turn;  /* Counter for `mark`. */
  size_t n_swapped, n_collapsed;
  double moved_max, moved_relative;
};

static inline uint32_t vg_swap_from(const struct vg_swapper *w, uint32_t h)
{
  assert(h < 3 * w->n_tri);
  return w->tri[h / 3][h % 3];
}

static inline void vg_half_pair(struct vg_swapper *w, uint32_t g, uint32_t h)
{
  assert(g != h && g < 3 * w->n_tri && h < 3 * w->n_tri);
  w->mate[g] = h;
  w->mate[h] = g;
}

/* The next outgoing half-edge of the start node of h, clockwise as seen from
 * the solid; after a full circle it is h again. */
static inline uint32_t vg_half_turn(const struct vg_swapper *w, uint32_t h)
{
  return w->mate[vg_half_prev(h)];
}

static inline int vg_tri_removed(const struct vg_swapper *w, size_t t)
{
  return w->tri[t][0] == w->tri[t][1];
}

/* Geometry of a triangle. */
struct vg_tri_shape {
  double normal[3];                    /* Its length is twice the area. */
  double area;                         /* The length of `normal`. */
  double longest2, middle2, shortest2; /* Squared edge lengths. */
  double sine2;                        /* Squared sine of the smallest angle; 0
                                          for degenerate triangles. */
};

void vg_tri_shape_of(const double *a, const double *b, const double *c,
                     struct vg_tri_shape *s);

/* The triangle is no sliver, so that its normal is reliable. */
static inline int vg_tri_shape_sound(const struct vg_tri_shape *s)
{
  return s->area > VG_SWAP_SLIVER * s->longest2;
}

/* Do the normals differ by less than options.angle? */
int vg_tri_shape_agree(const struct vg_swapper *w, const struct vg_tri_shape *a,
                       const struct vg_tri_shape *b);

/* Append h to the queue unless it or its mate is in it. */
void vg_swap_push(struct vg_swapper *w, uint32_t h);

/* The cosine of the largest angle is below -1/2. */
static inline int vg_tri_shape_cap(const struct vg_tri_shape *s)
{
  double rest = s->longest2 - s->middle2 - s->shortest2;

  return !vg_tri_shape_sound(s) && rest > 0 &&
         rest * rest > s->middle2 * s->shortest2;
}

/* surface_swap_edge.c: swap the edges in the queue, and those that become
 * worthwhile as a result, until the queue is empty. */
void vg_swap_edges(struct vg_swapper *w);

/* surface_swap_point.c: remove one end of each short edge where that is
 * possible, and queue the surrounding edges.
 *
 * @param n_removed  out: number of removed points */
vg_status vg_swap_points(struct vg_swapper *w, size_t *n_removed,
                         struct vg_error *err);

#endif
