/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* layers/slide/slide_parts.h: data shared by the steps of vg_slide_front.
 * Private to slide*.c.
 *
 * While the front is built, points have a single numbering: first the points of
 * the surface, then one point per column (its top; unused if n = 0), then new
 * points. */
#ifndef VG_LAYERS_SLIDE_SLIDE_PARTS_H
#define VG_LAYERS_SLIDE_SLIDE_PARTS_H

#include <assert.h>

#include "base/tri_key.h"
#include "core/search/box_tree.h"
#include "layers/slide/slide.h"

/* slide_tree.c ------------------------------------------------------------*/

/** A box in the plane; its extent in z is zero. */
static inline struct vg_box vg_slide_box(const double lo[2], const double hi[2])
{
  return (struct vg_box){ { lo[0], lo[1], 0 }, { hi[0], hi[1], 0 } };
}

/** Tree of n boxes in the plane, ordered along a Morton curve through their
 * centres. O(n). VG_ERR_MEMORY. */
vg_status vg_slide_tree(struct vg_box_tree *t, size_t n,
                        const struct vg_box *box, struct vg_error *err);

/* slide.c -----------------------------------------------------------------*/

struct vg_slide_edge {
  uint32_t part, v[2];
};

/* A step along a curve: an edge from point a to b in place of the chain edges
 * from `at` on, or the removal of the chain edges from a to b. */
struct vg_slide_step {
  int is_edge;
  size_t at;
  uint32_t a, b;
};

/* Images of new points by a periodic pair. */
struct vg_slide_images {
  size_t n, cap;
  uint32_t *of; /* [n] VG_NO_INDEX: none yet. */
};

struct vg_slide_work {
  const struct vg_mesh *m;
  const struct vg_sizing *sizing;
  size_t n_slide;
  const struct vg_slide *slide;
  const struct vg_twins *twins; /* NULL: no patch is periodic. */
  struct vg_columns *c;
  uint32_t *slide_of; /* [m->n_patch] index into slide[]. */
  size_t n_x, cap_x;
  double (*x)[3];    /* [n_x] surface points, tops, new points. */
  uint32_t *local;   /* [surface points, tops, points of curves] scratch; all
                        VG_NO_INDEX between uses. */
  uint32_t *copy_of; /* [m->n_point] first copy of each point of an inner
                        surface; NULL: no point has a copy. */
  uint8_t *held;     /* [m->n_point] 1: a point of a sheet, through which the
                        mesh continues; NULL: no patch is such a sheet. */
  size_t n_held;
  uint64_t *held_edge; /* [n_held] keys of the edges of sheets, sorted. */
  /* Half-edges 3 * triangle + corner of slide patches, sorted by first
   * point. */
  uint32_t *first, *half; /* [m->n_point + 1], [first[n_point]]. */
  /* Parts to be remeshed, each with its own mean normal: plane patches as a
   * whole, curved patches only around walls. */
  size_t n_part, cap_part;
  struct vg_slide *part;
  uint32_t *part_of;         /* [m->n_tri] part of each triangle; VG_NO_INDEX:
                                it remains. */
  uint32_t *tri_first, *tri; /* [n_part + 1] offsets into tri[], the triangles
                                sorted by part. */
  uint32_t *border_first, *border; /* [n_part + 1] offsets into border[], the
                                      boundary edges sorted by part. */
  /* Curves between slide patches: the removed edges of the surface (keys with
   * the lower point in the high half, sorted) and the edges that replace
   * them. */
  size_t n_gone, cap_gone, n_edge, cap_edge;
  uint64_t *gone;
  struct vg_slide_edge *edge;
  struct vg_slide_images *image; /* [twins->n] */
  size_t n_step, cap_step;       /* Steps along curves, with twins. */
  struct vg_slide_step *step;
  size_t (*steps_of)[2]; /* [n_column] first and last + 1 of the curve that
                            starts at a column. */
  /* Triangles of remeshed patches. */
  size_t n_new, cap_new, cap_new_patch;
  uint32_t (*new_tri)[3], *new_patch;
  /* Failures. */
  uint8_t *bad; /* [n_column] 1: failed; 2: fails at any height. */
  size_t n_bad, cap_path;
  char *text; /* [200] "" until the first failure. */
  struct vg_error *err;
};

/** The first copy of point p, or p. */
static inline uint32_t vg_slide_first(const struct vg_slide_work *w, uint32_t p)
{
  return w->copy_of && p < w->m->n_point ? w->copy_of[p] : p;
}

/** Number of point p in the region that is remeshed. */
static inline uint32_t vg_slide_local(const struct vg_slide_work *w, uint32_t p)
{
  return w->local[vg_slide_first(w, p)];
}

/** Point of column i in the front: its top, or its root if it has no levels. */
static inline uint32_t vg_slide_top(const struct vg_slide_work *w, uint32_t i)
{
  assert(i < w->c->n_column);

  const struct vg_column *c = &w->c->column[i];

  return c->n ? (uint32_t)(w->m->n_point + i) : c->root;
}

/** Column whose top is point p, or VG_NO_INDEX. */
static inline uint32_t vg_slide_column(const struct vg_slide_work *w,
                                       uint32_t p)
{
  return p >= w->m->n_point && p - w->m->n_point < w->c->n_column
         ? (uint32_t)(p - w->m->n_point)
         : VG_NO_INDEX;
}

static inline uint64_t vg_slide_key(uint32_t a, uint32_t b)
{
  assert(a != b);
  return vg_edge_key(a, b);
}

/** Appends a point. VG_ERR_MEMORY or VG_ERR_UNSUPPORTED. */
vg_status vg_slide_add_point(struct vg_slide_work *w, const double x[3],
                             uint32_t *number);

/** Marks column i as failed, unless it has no levels. The first call sets the
 * description of the failure: `what`, the patch, and the position x. */
void vg_slide_mark_bad(struct vg_slide_work *w, uint32_t i, uint32_t patch,
                       const double x[3], const char *what);

/** Marks all columns on the boundary edges of part s. */
void vg_slide_mark_bad_all(struct vg_slide_work *w, size_t s, const char *what);

/** Half-edge from b to a (the twin of a -> b) in a slide patch, or
 * VG_NO_INDEX. */
uint32_t vg_slide_twin(const struct vg_slide_work *w, uint32_t a, uint32_t b);

/* slide_region.c ----------------------------------------------------------*/

/** Finds half-edges and parts, and the triangles and boundary edges of each
 * part. */
vg_status vg_slide_parts(struct vg_slide_work *w);

/* slide_curve.c -----------------------------------------------------------*/

/** Follows columns that slide in two patches along the common curve of the
 * patches. Fills gone[] and edge[], and bends columns where the curve is not
 * straight. */
vg_status vg_slide_curves(struct vg_slide_work *w);

/* slide_image.c -----------------------------------------------------------*/

/** Whether the patch is the second one of a pair. */
int vg_slide_is_image(const struct vg_slide_work *w, uint32_t patch);

vg_status vg_slide_images_open(struct vg_slide_work *w);
void vg_slide_images_release(struct vg_slide_work *w);

/** The image by pair p of point v of its first patch; new points are added. */
vg_status vg_slide_image(struct vg_slide_work *w, size_t p, uint32_t v,
                         uint32_t *is);

/** Sets the image of a new point; other points have theirs. */
vg_status vg_slide_set_image(struct vg_slide_work *w, size_t p, uint32_t v,
                             uint32_t is);

/** Moves the tops of twins to their places. */
void vg_slide_copy_tops(struct vg_slide_work *w);

/** Bends columns with twins, and their twins to the images. */
vg_status vg_slide_copy_paths(struct vg_slide_work *w);

/** Marks the images of the triangles that are marked in curved patches. */
void vg_slide_copy_marks(struct vg_slide_work *w);

/** Adds the images of new triangles. */
vg_status vg_slide_copy_faces(struct vg_slide_work *w);

/* slide_loop.c ------------------------------------------------------------*/

/* New boundary of a part, with the region on its left. */
struct vg_slide_loops {
  size_t n, cap;
  uint32_t (*edge)[2];
};

/** Boundary of part s; empty if columns were marked. */
vg_status vg_slide_boundary(struct vg_slide_work *w, size_t s,
                            struct vg_slide_loops *out);

/* slide_plane.c -----------------------------------------------------------*/

/* Coordinates in a plane. axis >= 0: the other two coordinates of space. */
struct vg_slide_frame {
  int axis, iu, iv;
  double at, o[3], u[3], v[3], n[3];
};

void vg_slide_frame(const struct vg_slide_work *w, size_t s,
                    struct vg_slide_frame *f);
void vg_slide_to_plane(const struct vg_slide_frame *f, const double x[3],
                       double p[2]);
void vg_slide_to_space(const struct vg_slide_frame *f, const double p[2],
                       double x[3]);

/** Marks columns at which the boundary crosses itself or enters a side face.
 *
 * @param p  coordinates in the plane, indexed by vg_slide_local
 * @param n_bad  out: number of such places; 0: the region is valid */
vg_status vg_slide_cross(struct vg_slide_work *w, size_t s,
                         const struct vg_slide_frame *frame,
                         const struct vg_slide_loops *loops,
                         const double (*p)[2], size_t *n_bad);

/* slide_copies.c ----------------------------------------------------------*/

/** Finds points and edges of the sheets through which the mesh continues. */
vg_status vg_slide_hold(struct vg_slide_work *w);

/** Is a - b an edge of such a sheet? */
int vg_slide_is_held(const struct vg_slide_work *w, uint32_t a, uint32_t b);

/** Replaces first copies in new triangles of a region by those of the sides on
 * which the triangles are.
 *
 * @param n_point  points of the region, numbered by vg_slide_local
 * @param tri      [n_tri] points of the region
 * @param number   in, out: [n_tri] the same points in the numbering of *w */
vg_status vg_slide_use_copies(const struct vg_slide_work *w,
                              const struct vg_slide_loops *loops,
                              size_t n_point, size_t n_tri,
                              const uint32_t (*tri)[3], uint32_t (*number)[3]);

/* slide_curved.c ----------------------------------------------------------*/

/* Triangles of a curved part over its mean plane. */
struct vg_slide_graph {
  const struct vg_slide_work *w;
  struct vg_slide_frame frame;
  size_t n;
  const uint32_t *tri; /* [n] triangles. */
  double (*p)[3][2];   /* [n] corners in the plane. */
  double (*height)[3]; /* [n] heights of the corners above the plane. */
  struct vg_box_tree tree;
  double extent;
};

/** Returns VG_BLOCKED if the part is not a graph over its mean plane. */
vg_status vg_slide_graph(const struct vg_slide_work *w, size_t s,
                         struct vg_slide_graph *g);
void vg_slide_graph_release(struct vg_slide_graph *g);

/** Marks the columns of part s, which is not a graph. They are marked for any
 * height if the part is not even a graph at their roots, since lower columns
 * make the part smaller. */
void vg_slide_mark_steep(struct vg_slide_work *w, size_t s);

/** Point of the patch above p, or the nearest point of the patch if p is
 * outside. */
void vg_slide_lift(const struct vg_slide_graph *g, const double p[2],
                   double x[3]);

/** Bends the columns of part s onto it, except those already bent along a
 * curve. */
vg_status vg_slide_bend(struct vg_slide_work *w, size_t s,
                        const struct vg_slide_graph *g);

/* slide_size.c ------------------------------------------------------------*/

/* Target edge length in a slide patch: that of the sizing field, but not
 * smaller than the edges between nearby tops, from which it decreases with the
 * slope of the field. */
struct vg_slide_law {
  const struct vg_sizing *sizing;
  const struct vg_slide_frame *frame;
  const struct vg_slide_graph *graph; /* NULL: the patch is plane. */
  double slope;
  struct {
    double p[2], h;
  } * top;                 /* Edges between tops that are longer than the size
                              there. */
  struct vg_box_tree tree; /* Tree of their regions of influence. */
};

/** Makes the edges between tops a lower bound of the size. */
vg_status vg_slide_law_floor(struct vg_slide_work *w,
                             const struct vg_slide_loops *loops,
                             struct vg_slide_law *l);
void vg_slide_law_release(struct vg_slide_law *l);

/** Point of the patch at p. */
void vg_slide_place(const struct vg_slide_law *l, const double p[2],
                    double x[3]);

/** Size at p. law: struct vg_slide_law. */
double vg_slide_size(void *law, const double p[2]);

/* slide_plane.c, again ----------------------------------------------------*/

/** Remeshes part s. */
vg_status vg_slide_remesh(struct vg_slide_work *w, size_t s);

#endif
