/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/remesh/work.h: the surface that is being changed, and the checks that
 * every change must pass. Private to core/remesh. */
#ifndef VG_CORE_REMESH_WORK_H
#define VG_CORE_REMESH_WORK_H

#include <assert.h>

#include "base/stop.h"
#include "core/remesh/curves.h"
#include "core/remesh/metric.h"
#include "core/sizing/sizing.h"

#define VG_WORK_RING 256 /* most triangles around a point that may change */
#define VG_WORK_NEARER                                                         \
  1.5 /* S25: least ratio of distances to another sheet and its own */
#define VG_WORK_SHORT                                                          \
  0.7 /* S21: in target lengths: shorter edges are collapsed */
#define VG_WORK_LONG 1.4 /* S21: in target lengths: longer edges are split */

enum { VG_WORK_FACE, VG_WORK_CURVE, VG_WORK_CORNER };

enum { VG_WORK_FREE, VG_WORK_FROZEN, VG_WORK_FANS };

/* KEPT: edges between such points stay. FIXED: only those of triangles with
 * three fixed corners stay, so that edges across other patches are split. LINE:
 * only feature edges stay. */
enum { VG_WORK_KEPT = 1, VG_WORK_FIXED, VG_WORK_LINE };

struct vg_tris_point {
  double x[3];
  double room;    /* Largest distance from the reference; see
                     vg_tris_find_room. */
  uint32_t half;  /* An outgoing half-edge; VG_REF_NONE: the point is
                     removed. */
  uint32_t home;  /* Reference triangle near the point. */
  uint32_t by;    /* Reference triangle that determines its size. */
  uint32_t given; /* Reference point that becomes a sample when this point is
                     removed; VG_REF_NONE: none. */
  uint8_t kind;
  uint8_t goes;           /* 1: curve point marked for removal. */
  uint8_t frozen;         /* FROZEN: on the border of a block; it stays, and no
                             new edges to other frozen points are made. FANS: no
                             new edges to it at all, because its triangles in
                             the block form several umbrellas. */
  uint8_t kept;           /* VG_WORK_KEPT, VG_WORK_FIXED: corner of input
                             triangles that are kept unchanged; VG_WORK_LINE:
                             end of feature edges that are. */
  uint64_t changed;       /* Clock of the last change of its triangles. */
  struct vg_metric asked; /* Target length; the form is not set if the surface
                             is not stretched. */
  uint64_t tried;         /* Clock of the last attempt to smooth it. */
};

enum {
  VG_WORK_SWAPS,
  VG_WORK_COLLAPSES,
  VG_WORK_ACROSS,
  VG_WORK_SPLITS,
  VG_WORK_POLISH,
  VG_WORK_LOOKS
};

struct vg_stretch; /* see stretch.h */

/* Feature edge of the current surface: a segment of a curve. */
struct vg_tris_line {
  uint32_t curve, end[2];
  double at[2]; /* Arc lengths of its ends along the curve, ascending. */
};

/* Half-edge 3 t + k runs from corner k of triangle t to the next corner. */
struct vg_tris {
  const struct vg_ref *ref;
  const struct vg_curves *curves;
  double tolerance, relative; /* Largest distance from the reference: absolute,
                                 and relative to the size. */
  double far;                 /* For sizes above this only `relative` applies;
                                 0: never. */
  double (*other_size)(const void *user, const double x[3]);
  const void *user; /* Context of other_size. */
  /* Form at x, where edges have length `size` across the direction of
   * stretching. NULL: edges have the same length in all directions. */
  void (*form)(const void *of_form, const double x[3], double size,
               double form[6]);
  const void *of_form;
  const struct vg_sizing *field; /* Metric that edges follow where it requests
                                    smaller sizes; NULL: none. */
  double coarse;                 /* Factor on the sizes of the field, >= 1. */
  struct vg_stretch *stretch;    /* Set up by vg_tris_begin, for `form`; may be
                                    NULL. */
  double h_min, h_max;
  int threads;         /* Used by vg_tris_begin. */
  const uint8_t *keep; /* [points of ref] Values of vg_tris_point.kept. Input
                          triangles with three corners marked KEPT or FIXED are
                          kept unchanged; NULL: none. */
  size_t n_point, cap_point, n_tri, cap_tri, cap_mate, cap_edge, cap_first,
    cap_stamp;
  size_t n_line, cap_line;
  struct vg_tris_point *point;
  uint32_t (*tri)[3]; /* Removed triangles have three equal corners. */
  uint32_t *mate;     /* Opposite half-edge; VG_REF_NONE: open rim. */
  uint32_t *edge;     /* [3 n_tri] Feature edge + 1; 0: none. */
  uint64_t *stamp;    /* [n_tri] Clock of the last change. */
  struct vg_tris_line *line;
  /* Samples: reference points that the current surface no longer contains. Each
   * is assigned to a triangle near it, which keeps the reference within the
   * tolerance of the current surface. */
  uint32_t *first;    /* [n_tri] First sample of the triangle; VG_REF_NONE:
                         none. */
  uint32_t *follow;   /* [points of ref] Next sample of the same triangle. */
  uint8_t *is_sample; /* [points of ref] 1: sample. */
  int is_block;       /* `follow` and `is_sample` belong to the whole
                         surface. */
  uint32_t *spare;    /* Removed triangles, for reuse. */
  size_t n_spare, cap_spare;
  size_t n_split, n_collapse, n_swap, n_move, n_refused;
  double churn;  /* S104: points that a block may insert per expected point; 0:
                    any number. */
  size_t budget; /* Splits after which no more changes are made; 0: never. */
  int is_over;   /* 1: the budget has been used up in this surface or one of its
                    blocks. */
  uint64_t clock;                 /* Number of changes. */
  uint64_t looked[VG_WORK_LOOKS]; /* Clock of the last complete pass of each
                                     kind. */
  int failed;                     /* 1: out of memory. */
  struct vg_stop stop;
  int ends; /* 1: `stop` has requested the end; no more changes are made. */
};

static inline int vg_tris_ends(struct vg_tris *w)
{
  if (!w->ends) w->ends = vg_stops(&w->stop);
  return w->ends;
}

/** The reason why no more changes are made: VG_ERR_MEMORY, VG_ERR_STOPPED; else
 * VG_OK, also when the budget is used up. */
vg_status vg_tris_status(const struct vg_tris *w, struct vg_error *err);

static inline uint32_t vg_tris_from(const struct vg_tris *w, uint32_t h)
{
  assert(h < 3 * w->n_tri);
  return w->tri[h / 3][h % 3];
}

static inline uint32_t vg_tris_to(const struct vg_tris *w, uint32_t h)
{
  return w->tri[h / 3][vg_half_next(h) % 3];
}

static inline const double *vg_tris_at(const struct vg_tris *w, uint32_t p)
{
  assert(p < w->n_point);
  return w->point[p].x;
}

static inline int vg_tris_removed(const struct vg_tris *w, size_t t)
{
  assert(t < w->n_tri);
  return w->tri[t][0] == w->tri[t][1];
}

/** Have both ends of the edge been unchanged since? */
static inline int vg_tris_is_old(const struct vg_tris *w, uint32_t h,
                                 uint64_t since)
{
  return w->point[vg_tris_from(w, h)].changed <= since &&
         w->point[vg_tris_to(w, h)].changed <= since;
}

/** Is the edge on the border of a block, which must not change? */
static inline int vg_tris_is_border(const struct vg_tris *w, uint32_t h)
{
  return w->mate[h] == VG_REF_NONE && w->point[vg_tris_from(w, h)].frozen &&
         w->point[vg_tris_to(w, h)].frozen;
}

/** Does the edge, whose ends are kept, belong to a triangle with three kept
 * corners? */
int vg_tris_is_kept_side(const struct vg_tris *w, uint32_t h);

/** Must the edge stay unchanged, as part of a block border or of input
 * triangles that are kept? */
static inline int vg_tris_stays(const struct vg_tris *w, uint32_t h)
{
  const uint8_t from = w->point[vg_tris_from(w, h)].kept;
  const uint8_t to = w->point[vg_tris_to(w, h)].kept;

  if (vg_tris_is_border(w, h)) return 1;
  if (!from || !to) return 0;
  if (from == VG_WORK_LINE && to == VG_WORK_LINE) return w->edge[h] != 0;
  return from != VG_WORK_FIXED || to != VG_WORK_FIXED ||
         vg_tris_is_kept_side(w, h);
}

/** May a new edge between a and b be created? */
static inline int vg_tris_may_join(const struct vg_tris *w, uint32_t a,
                                   uint32_t b)
{
  assert(a < w->n_point && b < w->n_point);
  return w->point[a].frozen + w->point[b].frozen < VG_WORK_FANS;
}

/** Set up w as a copy of the reference surface. */
vg_status vg_tris_begin(struct vg_tris *w, struct vg_error *err);

/** Set the factor on the sizes of the field, and the target lengths of all
 * points. O(n log n). VG_ERR_STOPPED. */
vg_status vg_tris_set_level(struct vg_tris *w, double factor,
                            struct vg_error *err);

void vg_tris_release(struct vg_tris *w);

/** Number of inconsistencies among triangles, their mates, feature edges and
 * points, for stage checks (base/checks.h). O(triangles). */
size_t vg_tris_defects(const struct vg_tris *w);

/** Allocate the arrays for n triangles, w->tri to w->first, and set their
 * capacities. Feature edges and stamps are 0, other values are not set. On
 * VG_ERR_MEMORY some arrays are allocated. */
vg_status vg_tris_room(struct vg_tris *w, size_t n, struct vg_error *err);

/** Free points, triangles and feature edges and set them to NULL; counts
 * remain. */
void vg_tris_free_arrays(struct vg_tris *w);

/** Outgoing half-edges of p, one for each of its triangles. Returns their
 * number; 0 if there are too many.
 *
 * @param half  out: [VG_WORK_RING]
 * @param open  out: 1 if the point is on a rim */
size_t vg_tris_ring(const struct vg_tris *w, uint32_t p, uint32_t *half,
                    int *open);

/** Size at x. *by: as for vg_ref_size. */
double vg_tris_size(const struct vg_tris *w, const double x[3], uint32_t *by);

/** Size at x from triangle `home` and the triangles that determine the sizes of
 * n points. Correct unless there is a spot of smaller sizes between these
 * points. */
double vg_tris_size_near(const struct vg_tris *w, const double x[3],
                         uint32_t home, size_t n, const uint32_t *point,
                         uint32_t *by);

/** Set p->room from its size and position: the minimum of the tolerance and a
 * fraction of the size. The size without strips is used, because the width of a
 * strip does not determine the accuracy of the surface. Near a closed strip the
 * tolerance alone applies. */
void vg_tris_find_room(const struct vg_tris *w, struct vg_tris_point *p);

/** Do target lengths depend on the direction? */
static inline int vg_tris_is_stretched(const struct vg_tris *w)
{
  return w->form || w->field;
}

/** Set the form of a metric at x whose size is set; with a field, intersect it
 * with the metric of the field. The surface must be stretched.
 *
 * @param n  as for vg_follow_field */
void vg_tris_stretch(const struct vg_tris *w, const double x[3],
                     const double *n, struct vg_metric *m);

/** Set the target length of q, whose position, kind, home and by are set, to
 * `size`, or to a smaller one that a field requests. */
static inline void vg_tris_ask(const struct vg_tris *w, struct vg_tris_point *q,
                               double size)
{
  q->asked.size = size;
  if (vg_tris_is_stretched(w))
    vg_tris_stretch(w, q->x,
                    q->kind == VG_WORK_FACE ? w->ref->shape[q->home].n : NULL,
                    &q->asked);
  vg_tris_find_room(w, q);
}

/** Form at point p; NULL if the surface is not stretched. */
static inline const double *vg_tris_form(const struct vg_tris *w, uint32_t p)
{
  return vg_tris_is_stretched(w) ? w->point[p].asked.form : NULL;
}

/** Largest target length of q within the surface. */
static inline double vg_tris_largest(const struct vg_tris *w,
                                     const struct vg_tris_point *q)
{
  double det;

  if (!w->field) return q->asked.size;
  det = vg_form_area2(q->asked.form, w->ref->shape[q->home].n);
  return det > 0 ? q->asked.size / sqrt(det) : q->asked.size;
}

/** Length of an edge relative to the mean target length at its ends. */
static inline double vg_tris_length(const struct vg_tris *w,
                                    const struct vg_tris_point *a,
                                    const struct vg_tris_point *b)
{
  double e[3];

  vg_sub(a->x, b->x, e);
  if (w->field) return vg_metric_span(&a->asked, &b->asked, e);
  if (w->form) return vg_metric_ratio(&a->asked, &b->asked, e);
  return 2 * vg_norm(e) / (a->asked.size + b->asked.size);
}

double vg_tris_ratio(const struct vg_tris *w, uint32_t h);

/** Squared sine of the smallest angle of a triangle in the mean metric of its
 * points. */
double vg_tris_shape(const struct vg_tris *w, const struct vg_tris_point *a,
                     const struct vg_tris_point *b,
                     const struct vg_tris_point *c);

double vg_tris_tri_shape(const struct vg_tris *w, size_t t);

/* Changes. Each checks that the result is a manifold surface, within the
 * tolerance of the reference and not folded. If it is not, or work is to end,
 * nothing is changed and 0 is returned. */

/** Insert a point into edge h: at its midpoint, or on a curve at arc length
 * *at. Returns the point, or VG_REF_NONE. */
uint32_t vg_tris_split(struct vg_tris *w, uint32_t h, const double *at);

/** Collapse h by moving its start to its end. Refused if an edge would be
 * longer than `most` target lengths and longer than any edge now, or an angle
 * smaller than that of `shape` (squared sine) and smaller than any angle now.
 */
int vg_tris_collapse(struct vg_tris *w, uint32_t h, double most, double shape);

/** Replace edge h by the other diagonal if that increases the smallest
 * angle. */
int vg_tris_swap(struct vg_tris *w, uint32_t h);

/** Move a point of a face to the projection of x on the reference. Refused if
 * an angle would be smaller than that of `shape`, unless the smallest angle
 * increases. */
int vg_tris_move(struct vg_tris *w, uint32_t p, const double x[3],
                 double shape);

/* The two feature edges at a point of a curve, and the arc lengths of their
 * ends. */
struct vg_tris_span {
  uint32_t line[2], curve;
  double lo, at, hi; /* The point is at arc length `at`. */
};

/** Set s for point p. Returns 0 if p is not a curve point or may not move. */
int vg_tris_span(const struct vg_tris *w, uint32_t p, struct vg_tris_span *s);

/** Move a point of a curve to arc length `at`; `shape` as for vg_tris_move. */
int vg_tris_slide(struct vg_tris *w, uint32_t p, double at, double shape);

#endif
