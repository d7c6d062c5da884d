/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Outline: triangles with a small angle are treated one by one. The gain of
 * each possible change is first computed from the surrounding points, which is
 * cheap; only the best change is checked against the reference surface. */
#include "core/remesh/passes.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "core/geometry/vector.h"

#define LONGEST 1.7 /* sizes: a collapse makes no longer edges */
#define MOST 16     /* most triangles around a moved point */
#define STEP 0.2    /* of the size: first step of a search */
#define LEAST 0.01  /* of the size: last step of a search */
#define GAIN 1.01   /* least gain around a moved point, in squared sines */
#define BETTER 1.01 /* least gain of a move for the triangle */

/* A point and its neighbours. */
struct ring {
  size_t n; /* Number of triangles. */
  int is_stretched;
  uint32_t half[VG_WORK_RING];
  const struct vg_tris_point *at[MOST + 1]; /* Neighbours; the first is repeated
                                               at the end unless the point is on
                                               a rim. */
  double form[MOST][6];                     /* Forms of the triangles if edges
                                               are stretched. */
  double rim2[MOST];                        /* Squared lengths of the edges
                                               opposite the point. */
};

static const double *form_of(const struct ring *r, size_t i)
{
  return r->is_stretched ? r->form[i] : NULL;
}

static double length2(const double *form, const double *a, const double *b)
{
  double e[3];

  vg_sub(b, a, e);
  return vg_form_dot(form, e, e);
}

/* Form of the triangle p a b; that of p if it has no area. */
static void mean_form(const struct vg_tris *w, uint32_t p,
                      const struct vg_tris_point *a,
                      const struct vg_tris_point *b, double form[6])
{
  const struct vg_tris_point *o = &w->point[p];
  double u[3], v[3], n[3];

  vg_sub(a->x, o->x, u);
  vg_sub(b->x, o->x, v);
  vg_cross(u, v, n);
  if (!vg_form_mean(o->asked.form, a->asked.form, b->asked.form, n, form))
    memcpy(form, o->asked.form, sizeof o->asked.form);
}

static int take_ring(const struct vg_tris *w, uint32_t p, struct ring *r)
{
  const double *own = w->point[p].asked.form;
  int open;

  if (w->point[p].kind == VG_WORK_CORNER || w->point[p].frozen ||
      w->point[p].kept)
    return 0;
  r->n = vg_tris_ring(w, p, r->half, &open);
  if (!r->n || r->n > MOST) return 0;
  r->is_stretched = vg_tris_is_stretched(w);
  for (size_t i = 0; i < r->n; i++)
    r->at[i] = &w->point[vg_tris_to(w, r->half[i])];
  r->at[r->n] = &w->point[vg_tris_from(w, vg_half_prev(r->half[r->n - 1]))];
  for (size_t i = 0; i < r->n; i++) {
    const struct vg_tris_point *a = r->at[i], *b = r->at[i + 1];

    if (w->field) mean_form(w, p, a, b, r->form[i]);
    for (int k = 0; k < 6 && r->is_stretched && !w->field; k++)
      r->form[i][k] = (own[k] + a->asked.form[k] + b->asked.form[k]) / 3;
    r->rim2[i] = length2(form_of(r, i), a->x, b->x);
  }
  return 1;
}

/* As vg_tris_shape, from the squared side lengths. Inaccurate if it is tiny. */
static inline double shape_of(double a, double b, double c)
{
  const double dot2 = a + b - c;
  double least = a < b ? a : b, product = a * b;

  if (c < least) least = c;
  return product > 0 ? (product - dot2 * dot2 / 4) * least / (product * c) : 0;
}

/* The least shape of the triangles around the point if it were at x; 0 if that
 * does not exceed `bound`. */
static double shape_at(const struct ring *r, const double x[3], double bound)
{
  double least = 1, a = 0, b = 0;

  for (size_t i = 0; i < r->n; i++) {
    const double *form = form_of(r, i);
    double s;

    a = i && !form ? b : length2(form, x, r->at[i]->x);
    b = length2(form, x, r->at[i + 1]->x);
    s = shape_of(a, b, r->rim2[i]);
    if (s <= bound) return 0;
    if (s < least) least = s;
  }
  return least;
}

/* Two orthogonal directions normal to the mean normal of the triangles around
 * p. */
static int tangents(const struct vg_tris *w, const struct ring *r, uint32_t p,
                    double u[3], double v[3])
{
  const double *x = vg_tris_at(w, p);
  double n[3] = { 0, 0, 0 }, a[3], b[3], m[3];

  for (size_t i = 0; i < r->n; i++) {
    vg_sub(r->at[i]->x, x, a);
    vg_sub(r->at[i + 1]->x, x, b);
    vg_cross(a, b, m);
    for (int k = 0; k < 3; k++) n[k] += m[k];
  }
  vg_sub(r->at[0]->x, x, u);
  vg_cross(n, u, v);
  vg_cross(v, n, u);
  if (!(vg_unit(u) > 0 && vg_unit(v) > 0)) return 0;
  if (r->is_stretched) vg_form_frame(w->point[p].asked.form, u, v);
  return 1;
}

/* Best position of a point, and the least shape around it there; 0: no better
 * position was found. */
struct place {
  uint32_t p;
  double shape, x[3]; /* Position of a point of a face. */
  double at;          /* Arc length of a point of a curve. */
};

/* Maximise the smallest angle by a pattern search in the tangent plane. */
static void search_face(const struct vg_tris *w, const struct ring *r,
                        struct place *to)
{
  static const double way[8][2] = { { 1, 0 },      { -1, 0 },     { 0, 1 },
                                    { 0, -1 },     { 0.7, 0.7 },  { -0.7, 0.7 },
                                    { 0.7, -0.7 }, { -0.7, -0.7 } };
  const double size = w->point[to->p].asked.size;
  double u[3], v[3];

  if (!tangents(w, r, to->p, u, v)) return;
  for (double step = STEP * size; step > LEAST * size;) {
    double y[3], best[3];
    int found = 0;

    for (int k = 0; k < 8; k++) {
      double s;

      for (int d = 0; d < 3; d++)
        y[d] = to->x[d] + step * (way[k][0] * u[d] + way[k][1] * v[d]);
      s = shape_at(r, y, to->shape);
      if (!(s > to->shape)) continue;
      to->shape = s;
      memcpy(best, y, sizeof best);
      found = 1;
    }
    if (found) memcpy(to->x, best, sizeof to->x);
    else step /= 3;
  }
}

/* The same search along a curve, forwards and backwards. */
static void search_curve(const struct vg_tris *w, const struct ring *r,
                         struct place *to)
{
  struct vg_tris_span s;

  if (!vg_tris_span(w, to->p, &s)) return;
  to->at = s.at;
  for (double step = STEP * (s.hi - s.lo); step > LEAST * (s.hi - s.lo);) {
    const double from = to->at;

    for (int way = -1; way <= 1; way += 2) {
      const double at = from + way * step;
      double x[3], shape;

      if (!(at > s.lo && at < s.hi)) continue;
      vg_curve_at(w->curves, w->ref, s.curve, at, x);
      shape = shape_at(r, x, to->shape);
      if (shape > to->shape) to->shape = shape, to->at = at;
    }
    if (to->at == from) step /= 3;
  }
}

static void search_place(const struct vg_tris *w, uint32_t p, struct place *to)
{
  struct ring r;
  double before;

  *to = (struct place){ .p = p };
  if (!take_ring(w, p, &r)) return;
  memcpy(to->x, w->point[p].x, sizeof to->x);
  before = to->shape = shape_at(&r, to->x, 0);
  if (w->point[p].kind == VG_WORK_FACE) search_face(w, &r, to);
  else search_curve(w, &r, to);
  if (!(to->shape > GAIN * before)) to->shape = 0;
}

/* Move the corner of t that improves it most; if that is refused, the next best
 * one. */
static int move_corner(struct vg_tris *w, uint32_t t, double shape)
{
  struct place to[3];

  for (int k = 0; k < 3; k++) search_place(w, w->tri[t][k], &to[k]);
  for (;;) {
    struct place *best = &to[0];

    for (int k = 1; k < 3; k++)
      if (to[k].shape > best->shape) best = &to[k];
    if (!(best->shape > BETTER * shape)) return 0;
    if (w->point[best->p].kind == VG_WORK_FACE
          ? vg_tris_move(w, best->p, best->x, 1)
          : vg_tris_slide(w, best->p, best->at, 1))
      return 1;
    best->shape = 0;
  }
}

/* The least shape of the remaining triangles if the point is collapsed into
 * neighbour i; 0 if that does not exceed `bound`. */
static double shape_without(const struct vg_tris *w, const struct ring *r,
                            size_t i, double bound)
{
  double least = 1;

  for (size_t k = 1; k + 1 < r->n; k++) {
    size_t j = (i + k) % r->n;
    double s = vg_tris_shape(w, r->at[i], r->at[j], r->at[j + 1]);

    if (s <= bound) return 0;
    if (s < least) least = s;
  }
  return least;
}

/* Remove p by a collapse into the neighbour that gives the best angles. */
static int remove_point(struct vg_tris *w, uint32_t p)
{
  struct ring r;
  double best;
  size_t at = SIZE_MAX;

  if (w->point[p].kind != VG_WORK_FACE || !take_ring(w, p, &r) || r.n > 6)
    return 0;
  best = shape_at(&r, w->point[p].x, 0);
  for (size_t i = 0; i < r.n; i++) {
    double s = shape_without(w, &r, i, best);

    if (s > best) best = s, at = i;
  }
  return at != SIZE_MAX && vg_tris_collapse(w, r.half[at], VG_WORK_LONG, 1);
}

static void sort_edges(const struct vg_tris *w, uint32_t *order)
{
  for (int i = 0; i < 2; i++)
    for (int k = 0; k < 2 - i; k++)
      if (vg_tris_ratio(w, order[k]) > vg_tris_ratio(w, order[k + 1])) {
        uint32_t h = order[k];

        order[k] = order[k + 1];
        order[k + 1] = h;
      }
}

static int polish_tri(struct vg_tris *w, uint32_t t)
{
  uint32_t order[3] = { 3 * t, 3 * t + 1, 3 * t + 2 };
  const double shape = vg_tris_tri_shape(w, t);

  sort_edges(w, order);
  for (int k = 2; k >= 0; k--)
    if (vg_tris_swap(w, order[k])) return 1;
  for (int k = 0; k < 3; k++)
    if (remove_point(w, w->tri[t][k])) return 1;
  if (move_corner(w, t, shape)) return 1;
  for (int k = 0; k < 2; k++) {
    uint32_t h = order[k], g = w->mate[h];

    if (vg_tris_ratio(w, h) > 1) break;
    if (vg_tris_collapse(w, h, LONGEST, 1) ||
        (g != VG_REF_NONE && vg_tris_collapse(w, g, LONGEST, 1)))
      return 1;
  }
  return 0;
}

vg_status vg_pass_polish(struct vg_tris *w, double shape, size_t *n,
                         struct vg_error *err)
{
  assert(shape >= 0 && n);

  const uint64_t before = w->looked[VG_WORK_POLISH];

  *n = 0;
  w->looked[VG_WORK_POLISH] = w->clock;
  for (uint32_t t = 0; t < w->n_tri && !w->ends; t++)
    if (w->stamp[t] > before && !vg_tris_removed(w, t) &&
        vg_tris_tri_shape(w, t) < shape)
      *n += (size_t)polish_tri(w, t);
  return vg_tris_status(w, err);
}
