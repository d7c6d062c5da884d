/* core/remesh/work.h: a surface that changes, and the checks that every change
 * must pass. Private to core/remesh. */
#ifndef VG_CORE_REMESH_WORK_H
#define VG_CORE_REMESH_WORK_H

#include <assert.h>

#include "base/stop.h"
#include "core/remesh/curves.h"
#include "core/remesh/metric.h"

#define VG_WORK_RING 256   /* triangles around a point that may change */
#define VG_WORK_NEARER 1.5 /* S25: than another sheet */
#define VG_WORK_SHORT 0.7  /* S21: sizes: shorter edges go */
#define VG_WORK_LONG 1.4   /* longer ones are split */

enum { VG_WORK_FACE, VG_WORK_CURVE, VG_WORK_CORNER };

enum { VG_WORK_FREE, VG_WORK_FROZEN, VG_WORK_FANS };

struct vg_tris_point {
  double x[3];
  double room;    /* vg_tris_find_room: largest distance there */
  uint32_t half;  /* one that leaves it; VG_REF_NONE: removed */
  uint32_t home;  /* triangle of the reference near it */
  uint32_t by;    /* that which asks for its size */
  uint32_t given; /* its sample, once removed; VG_REF_NONE: none */
  uint8_t kind;
  uint8_t goes;           /* a point of a curve that is to be taken away */
  uint8_t frozen;         /* on the border of a block: stays, and no edges
                             are made to others; FANS: none to it at all, as
                             its triangles in the block do not hang together
                             */
  uint8_t kept;           /* point of given triangles that stay as they are */
  uint64_t changed;       /* when triangles at it changed */
  struct vg_metric asked; /* form: not set where the surface has none */
  uint64_t tried;         /* when it was last looked at */
};

enum {
  VG_WORK_SWAPS,
  VG_WORK_COLLAPSES,
  VG_WORK_ACROSS,
  VG_WORK_SPLITS,
  VG_WORK_POLISH,
  VG_WORK_LOOKS
};

struct vg_stretch; /* stretch.h */

/* Edge along a curve. */
struct vg_tris_line {
  uint32_t curve, end[2];
  double at[2]; /* lengths along the curve, rising */
};

/* Half-edge 3 t + k runs from corner k of triangle t to the next one. */
struct vg_tris {
  const struct vg_ref *ref;
  const struct vg_curves *curves;
  double tolerance, relative; /* largest distance, and in parts of the size */
  double far; /* where sizes are larger only the latter holds; 0:
                 nowhere */
  double (*other_size)(const void *user, const double x[3]);
  const void *user; /* of other_size */
  /* The form at x, where edges are `size` long across what stretches them;
   * NULL: they are as long in all directions */
  void (*form)(const void *of_form, const double x[3], double size,
               double form[6]);
  const void *of_form;
  struct vg_stretch *stretch; /* made to begin with, for the form; or NULL */
  double h_min, h_max;
  int threads;         /* to begin with */
  const uint8_t *keep; /* [points of ref] given triangles of three such
                          points stay as they are; NULL: none */
  size_t n_point, cap_point, n_tri, cap_tri, cap_mate, cap_edge, cap_first,
    cap_stamp;
  size_t n_line, cap_line;
  struct vg_tris_point *point;
  uint32_t (*tri)[3]; /* removed: three times the same point */
  uint32_t *mate;     /* VG_REF_NONE: open rim */
  uint32_t *edge;     /* [3 n_tri] line + 1 of it; 0: none */
  uint64_t *stamp;    /* [n_tri] when it changed */
  struct vg_tris_line *line;
  /* Samples: points of the reference that are none of this surface's any more
   * are each kept with the triangle near them, which keeps the given surface
   * near this one. */
  uint32_t *first;    /* [n_tri] VG_REF_NONE: none */
  uint32_t *follow;   /* [points of ref] the next one of the triangle */
  uint8_t *is_sample; /* [the same] */
  int is_block;       /* follow and is_sample are another's */
  uint32_t *spare;    /* removed triangles */
  size_t n_spare, cap_spare;
  size_t n_split, n_collapse, n_swap, n_move, n_refused;
  uint64_t clock;                 /* counts changes */
  uint64_t looked[VG_WORK_LOOKS]; /* when all was last looked at */
  int failed;                     /* no memory */
  struct vg_stop stop;
  int ends; /* it said so: nothing is changed any more */
};

static inline int vg_tris_ends(struct vg_tris *w)
{
  if (!w->ends) w->ends = vg_stops(&w->stop);
  return w->ends;
}

/** What has kept changes from being made: VG_ERR_MEMORY, VG_ERR_STOPPED. */
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

/** Has neither end of the edge changed since? */
static inline int vg_tris_is_old(const struct vg_tris *w, uint32_t h,
                                 uint64_t since)
{
  return w->point[vg_tris_from(w, h)].changed <= since &&
         w->point[vg_tris_to(w, h)].changed <= since;
}

/** An edge of the border of a block, which stays as it is. */
static inline int vg_tris_is_border(const struct vg_tris *w, uint32_t h)
{
  return w->mate[h] == VG_REF_NONE && w->point[vg_tris_from(w, h)].frozen &&
         w->point[vg_tris_to(w, h)].frozen;
}

/** An edge that stays as it is: of the border of a block, or of given triangles
 * that are kept. */
static inline int vg_tris_stays(const struct vg_tris *w, uint32_t h)
{
  return vg_tris_is_border(w, h) ||
         (w->point[vg_tris_from(w, h)].kept && w->point[vg_tris_to(w, h)].kept);
}

/** May there be a new edge between a and b? */
static inline int vg_tris_may_join(const struct vg_tris *w, uint32_t a,
                                   uint32_t b)
{
  assert(a < w->n_point && b < w->n_point);
  return w->point[a].frozen + w->point[b].frozen < VG_WORK_FANS;
}

/** The surface of the reference, ready to be changed. */
vg_status vg_tris_begin(struct vg_tris *w, struct vg_error *err);

void vg_tris_release(struct vg_tris *w);

/** Number of inconsistencies of live triangles, their mates, edges of curves
 * and points; a check of stages (base/checks.h). O(triangles). */
size_t vg_tris_defects(const struct vg_tris *w);

/** Arrays for n triangles, w->tri to w->first, and their counts; edges and
 * stamps 0, the others not set. VG_ERR_MEMORY: some are there. */
vg_status vg_tris_room(struct vg_tris *w, size_t n, struct vg_error *err);

/** Free points, triangles and lines: NULL then. Counts stay. */
void vg_tris_free_arrays(struct vg_tris *w);

/** Half-edges that leave p, one for each of its triangles: [VG_WORK_RING];
 * *open: the point is on a rim. 0 when there are too many. */
size_t vg_tris_ring(const struct vg_tris *w, uint32_t p, uint32_t *half,
                    int *open);

/** Size asked for at x. *by: as vg_ref_size. */
double vg_tris_size(const struct vg_tris *w, const double x[3], uint32_t *by);

/** The same, from what asks for the sizes of the n points, and the triangle
 * home: right but where a spot of finer sizes lies between them all. */
double vg_tris_size_near(const struct vg_tris *w, const double x[3],
                         uint32_t home, size_t n, const uint32_t *point,
                         uint32_t *by);

/** Set p->room by its size and place: the tolerance, and a part of the size. Of
 * the size without strips, whose width says nothing of how exact the surface
 * has to be; and not where one is closed. */
void vg_tris_find_room(const struct vg_tris *w, struct vg_tris_point *p);

/** Let q, which is in its place, with home and by, ask for this size. */
static inline void vg_tris_ask(const struct vg_tris *w, struct vg_tris_point *q,
                               double size)
{
  q->asked.size = size;
  if (w->form) w->form(w->of_form, q->x, size, q->asked.form);
  vg_tris_find_room(w, q);
}

/** That of the point; NULL where nothing is stretched. */
static inline const double *vg_tris_form(const struct vg_tris *w, uint32_t p)
{
  return w->form ? w->point[p].asked.form : NULL;
}

/** Length of an edge in parts of what its ends ask for. */
static inline double vg_tris_length(const struct vg_tris *w,
                                    const struct vg_tris_point *a,
                                    const struct vg_tris_point *b)
{
  double e[3];

  vg_sub(a->x, b->x, e);
  if (w->form) return vg_metric_length(&a->asked, &b->asked, e);
  return 2 * vg_norm(e) / (a->asked.size + b->asked.size);
}

double vg_tris_ratio(const struct vg_tris *w, uint32_t h);

/** Square of the sine of the smallest angle of a triangle, measured by the mean
 * of its points' forms. */
double vg_tris_shape(const struct vg_tris *w, const struct vg_tris_point *a,
                     const struct vg_tris_point *b,
                     const struct vg_tris_point *c);

double vg_tris_tri_shape(const struct vg_tris *w, size_t t);

/* The changes. Each looks whether the outcome is a surface like the one given,
 * within the distance, and nowhere folded, and else does nothing and returns
 * 0; so do all once work is to end. */

/** Put a point into the edge, in its middle or, on a curve, at `at`. Returns
 * it, or VG_REF_NONE. */
uint32_t vg_tris_split(struct vg_tris *w, uint32_t h, const double *at);

/** Take the start of h away, onto its end. No edge gets longer than `most`
 * sizes, unless one is now; no angle smaller than `shape` (square of the
 * sine), unless one is now. */
int vg_tris_collapse(struct vg_tris *w, uint32_t h, double most, double shape);

/** The other diagonal, where the smallest angle gets larger. */
int vg_tris_swap(struct vg_tris *w, uint32_t h);

/** Move a point of a face near x, on the reference; no angle smaller than
 * `shape` unless that is better than now. */
int vg_tris_move(struct vg_tris *w, uint32_t p, const double x[3],
                 double shape);

/* The two lines at a point of a curve: lengths along it of their ends. */
struct vg_tris_span {
  uint32_t line[2], curve;
  double lo, at, hi; /* the point is at `at` */
};

/** That of p; 0 where it has none, or may not move. */
int vg_tris_span(const struct vg_tris *w, uint32_t p, struct vg_tris_span *s);

/** Move a point of a curve along it to the length `at`; shape as above. */
int vg_tris_slide(struct vg_tris *w, uint32_t p, double at, double shape);

#endif
