/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/remesh/stretch.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/graded.h"
#include "core/geometry/vector.h"
#include "core/remesh/work_parts.h"

#define CHORD 0.6   /* S45: of the tolerance: largest sagitta of an edge */
#define BEND 0.033  /* of an edge: its sagitta at 24 edges per turn */
#define SHORTER 0.8 /* factor applied until the sagitta is small enough */

/* --- construction --------------------------------------------------------- */

/* Part of a curve with a constant stretching ratio. */
struct part {
  const struct vg_tris *w;
  size_t curve;
  double from, to, by;
  uint32_t hint;
};

static double size_at(void *user, double s)
{
  struct part *p = user;
  double x[3];

  vg_curve_at(p->w->curves, p->w->ref, p->curve, p->from + s, x);
  return vg_tris_size(p->w, x, &p->hint);
}

static double chord(const struct part *p, double at, double along)
{
  return vg_curve_chord(p->w->curves, p->w->ref, p->curve,
                        fmax(at - along / 2, p->from),
                        fmin(at + along / 2, p->to));
}

static struct vg_stretch_place place_at(const struct vg_stretch *s,
                                        struct part *p, double at)
{
  struct vg_stretch_place q = { .at = at };
  const double size = size_at(p, at - p->from);
  const double room = CHORD * vg_tris_tolerance(p->w, size);
  double a[3], b[3];

  q.along = fmax(fmin(p->by * size, s->h_max), size);
  while (q.along > size && chord(p, at, q.along) > fmin(room, BEND * q.along))
    q.along = fmax(SHORTER * q.along, size);
  vg_curve_at(p->w->curves, p->w->ref, p->curve, at, q.x);
  vg_curve_at(p->w->curves, p->w->ref, p->curve,
              fmax(at - q.along / 2, p->from), a);
  vg_curve_at(p->w->curves, p->w->ref, p->curve, fmin(at + q.along / 2, p->to),
              b);
  vg_sub(b, a, q.way);
  vg_unit(q.way);
  return q;
}

/* Build the tree of the segments of a run. */
static vg_status make_tree(const struct vg_stretch *s, struct vg_stretch_run *r,
                           struct vg_error *err)
{
  const struct vg_stretch_place *p = s->place + r->first;
  const size_t n = r->n - 1;
  struct vg_box *box = vg_alloc(n, sizeof *box);
  uint32_t *order = vg_alloc(n, sizeof *order);
  vg_status st;

  if (!box || !order)
    VG_TRY(vg_fail_memory(err, "the stretched feature "
                               "curves"));
  for (size_t i = 0; i < n; i++) {
    order[i] = (uint32_t)i;
    box[i] = (struct vg_box)VG_BOX_EMPTY;
    vg_box_add(&box[i], p[i].x);
    vg_box_add(&box[i], p[i + 1].x);
  }
  VG_TRY(vg_box_tree_build(&r->tree, n, box, order, sizeof *box, err));
done:
  free(box);
  free(order);
  return st;
}

/* Limit the change of lengths along the curve to the growth of sizes. */
static void grade(const struct vg_stretch *s, struct vg_stretch_run *r)
{
  struct vg_stretch_place *p = s->place + r->first;

  for (size_t i = 1; i < r->n; i++)
    p[i].along = fmin(p[i].along,
                      p[i - 1].along + s->slope * (p[i].at - p[i - 1].at));
  for (size_t i = r->n - 1; i > 0; i--)
    p[i - 1].along = fmin(p[i - 1].along,
                          p[i].along + s->slope * (p[i].at - p[i - 1].at));
  for (size_t i = 0; i < r->n; i++) r->most = fmax(r->most, p[i].along);
}

static vg_status add_run(struct vg_stretch *s, struct part *p,
                         struct vg_error *err)
{
  struct vg_stretch_run r = { .first = s->n_place, .by = p->by };
  double *step = NULL;
  size_t n;
  vg_status st;

  VG_TRY(vg_graded_steps(p->to - p->from, size_at, p, 1, &n, &step, err));
  r.n = n + 1;
  if (vg_reserve(&s->place, &s->cap_place, s->n_place + r.n,
                 sizeof *s->place) ||
      vg_reserve(&s->run, &s->cap_run, s->n_run + 1, sizeof *s->run))
    VG_TRY(vg_fail_memory(err, "the stretched feature curves"));
  for (size_t i = 0; i < r.n; i++)
    s->place[s->n_place++] = place_at(s, p, p->from + step[i]);
  grade(s, &r);
  VG_TRY(make_tree(s, &r, err));
  s->run[s->n_run++] = r;
done:
  free(step);
  return st;
}

vg_status vg_stretch_make(struct vg_stretch *s, const struct vg_tris *w,
                          struct vg_error *err)
{
  assert(s->by && !s->run && !s->place);

  double *by = vg_calloc(w->n_line, sizeof *by); /* stretching ratio of each
                                                    feature edge */
  vg_status st = VG_OK;

  if (!by) return vg_fail_memory(err, "the stretched feature curves");
  s->slope = w->ref->slope;
  s->h_max = w->h_max;
  for (uint32_t h = 0; h < 3 * w->n_tri; h++)
    if (w->edge[h]) by[w->edge[h] - 1] = s->by[h];
  for (size_t i = 0, end; i < w->n_line; i = end) {
    const struct vg_tris_line *l = &w->line[i];
    struct part p = { w, l->curve, l->at[0], l->at[1], by[i], VG_REF_NONE };

    for (end = i + 1;
         end < w->n_line && w->line[end].curve == p.curve && by[end] == p.by;
         end++)
      p.to = w->line[end].at[1];
    if (p.by > 1) VG_TRY(add_run(s, &p, err));
  }
done:
  free(by);
  if (st < 0) vg_stretch_release(s);
  return st;
}

void vg_stretch_release(struct vg_stretch *s)
{
  for (size_t i = 0; i < s->n_run; i++) vg_box_tree_release(&s->run[i].tree);
  free(s->run);
  free(s->place);
  *s = (struct vg_stretch){ .by = s->by };
}

/* --- evaluation ----------------------------------------------------------- */

/* Squared distance of x from the segment p[0] p[1]; *t is the position of the
 * nearest point on it, 0 to 1. */
static double piece2(const struct vg_stretch_place *p, const double x[3],
                     double *t)
{
  double e[3], d[3], ee;

  vg_sub(p[1].x, p[0].x, e);
  vg_sub(x, p[0].x, d);
  ee = vg_dot(e, e);
  *t = ee > 0 ? fmin(fmax(vg_dot(d, e) / ee, 0), 1) : 0;
  for (int k = 0; k < 3; k++) d[k] -= *t * e[k];
  return vg_dot(d, d);
}

/* A search for the segment of a run nearest to x. */
struct finding {
  const struct vg_stretch_place *place; /* Places of the run. */
  const struct vg_box_tree *tree;
  const double *x;
  double d2;   /* Squared distance: limit, or that of `best`. */
  double t;    /* Position on the segment, 0 to 1. */
  size_t best; /* Segment; SIZE_MAX: none yet. */
};

static inline int enter_nearer(void *context, size_t node, double d2)
{
  const struct finding *f = context;

  (void)node;
  return d2 < f->d2;
}

static inline void find_nearer(void *context, size_t node)
{
  struct finding *f = context;
  const size_t end = vg_box_tree_end(f->tree, node);

  for (size_t i = vg_box_tree_first(f->tree, node); i < end; i++) {
    double t, d2 = piece2(f->place + i, f->x, &t);

    if (!(d2 < f->d2)) continue;
    f->d2 = d2;
    f->t = t;
    f->best = i;
  }
}

/* Stretching ratio at x due to a run, and its direction; 1 if x is out of
 * reach. */
static double ask(const struct vg_stretch *s, const struct vg_stretch_run *r,
                  const double x[3], double size, double way[3])
{
  const double reach = (r->most - size) / s->slope;
  struct finding f = { s->place + r->first, &r->tree, x,
                       reach * reach,       0,        SIZE_MAX };
  const struct vg_stretch_place *p;
  double along;

  if (!(reach > 0)) return 1;
  vg_box_tree_approach(&r->tree, x, enter_nearer, find_nearer, &f);
  if (f.best == SIZE_MAX) return 1;
  p = f.place + f.best;
  for (int k = 0; k < 3; k++)
    way[k] = p[0].way[k] + f.t * (p[1].way[k] - p[0].way[k]);
  along = p[0].along + f.t * (p[1].along - p[0].along) - s->slope * sqrt(f.d2);
  return vg_unit(way) > 0 ? fmin(along / size, r->by) : 1;
}

void vg_stretch_form(const void *stretch, const double x[3], double size,
                     double form[6])
{
  const struct vg_stretch *s = stretch;
  double best = 1, way[3] = { 0, 0, 0 }, other[3], rest;
  size_t first = SIZE_MAX;

  assert(stretch && size > 0);
  for (size_t i = 0; i < s->n_run; i++) {
    double by = ask(s, &s->run[i], x, size, other);

    if (!(by > best)) continue;
    best = by;
    first = i;
    memcpy(way, other, sizeof way);
  }
  rest = best;
  for (size_t i = 0; first != SIZE_MAX && i < s->n_run; i++) {
    double by = i == first ? 1 : ask(s, &s->run[i], x, size, other), c;

    if (!(by > 1)) continue;
    c = vg_dot(way, other);
    rest = fmin(rest, best - (by - 1) * (1 - c * c));
  }
  vg_form_stretch(form, way, fmax(rest, 1));
}
