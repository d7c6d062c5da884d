/* core/surface/surface_swap_parts.h: what the files surface_swap*.c share. Not
 * for users of the library. */
#ifndef VG_CORE_SURFACE_SURFACE_SWAP_PARTS_H
#define VG_CORE_SURFACE_SURFACE_SWAP_PARTS_H

#include <assert.h>
#include <stdint.h>

#include "core/mesh/edges.h"
#include "core/surface/surface_swap.h"

/* A surface being changed. Half-edge 3 t + k runs from tri[t][k] to
 * tri[t][(k + 1) % 3]; every one has a mate that runs the other way. */
struct vg_swapper {
  const struct vg_swap_options *o;
  double cosine; /* of the angle of the options */
  size_t n_point, n_tri;
  const double (*point)[3];
  const uint32_t *patch; /* [n_tri] */
  uint32_t (*tri)[3];    /* [n_tri] removed: three times the same node */
  uint32_t *mate;        /* [3 n_tri] */
  double *moved;         /* [n_tri] bound of how far it is from where the
                            surface was */
  uint8_t *changed;      /* [n_tri] */
  uint8_t *locked;       /* [n_point] faces at it must stay */
  uint8_t *removed;      /* [n_point] */
  uint32_t *queue;       /* [3 n_tri] ring of half-edges to look at */
  uint8_t *queued;       /* [3 n_tri] */
  size_t head, n_queue;
  int caps_only;  /* leave pairs without a cap */
  uint32_t *mark; /* [n_point] last turn in which it was a */
  uint32_t turn;  /* neighbour of the point to be removed */
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

/* Next half-edge away from the node that h leaves, clockwise from inside the
 * solid; after a turn the first again. */
static inline uint32_t vg_half_turn(const struct vg_swapper *w, uint32_t h)
{
  return w->mate[vg_half_prev(h)];
}

static inline int vg_tri_removed(const struct vg_swapper *w, size_t t)
{
  return w->tri[t][0] == w->tri[t][1];
}

/* Measures of a triangle. */
struct vg_tri_shape {
  double normal[3];                    /* length: twice the area */
  double area;                         /* that length */
  double longest2, middle2, shortest2; /* squares of the edges' lengths */
  double sine2; /* square of the sine of the smallest angle; 0
                   for degenerate ones */
};

void vg_tri_shape_of(const double *a, const double *b, const double *c,
                     struct vg_tri_shape *s);

/* Its normal can be trusted. */
static inline int vg_tri_shape_sound(const struct vg_tri_shape *s)
{
  return s->area > VG_SWAP_SLIVER * s->longest2;
}

/* Normals within the angle of the options. */
int vg_tri_shape_agree(const struct vg_swapper *w, const struct vg_tri_shape *a,
                       const struct vg_tri_shape *b);

/* To the end of the queue, unless it or its mate is in it. */
void vg_swap_push(struct vg_swapper *w, uint32_t h);

/* Cosine of the largest angle below -1/2. */
static inline int vg_tri_shape_cap(const struct vg_tri_shape *s)
{
  double rest = s->longest2 - s->middle2 - s->shortest2;

  return !vg_tri_shape_sound(s) && rest > 0 &&
         rest * rest > s->middle2 * s->shortest2;
}

/* surface_swap_edge.c: swap what is in the queue, and what becomes worth it
 * by that, until nothing is left. */
void vg_swap_edges(struct vg_swapper *w);

/* surface_swap_point.c: remove one end of each short edge where that can be
 * done; their surroundings go to the queue. Returns how many. */
vg_status vg_swap_points(struct vg_swapper *w, size_t *n_removed,
                         struct vg_error *err);

#endif
