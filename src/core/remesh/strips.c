/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Outline: the width of the strip on each side of every feature curve is
 * measured at many places. Stretches of the shorter of two curves along which
 * the strip is narrow are closed. Edges are split where a stretch begins or
 * ends. */
#include "core/remesh/strips.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "core/remesh/strips_cut.h"

#define STEPS 400   /* most triangles crossed by a walk over a strip */
#define ALONG 0.94  /* cosine: curves at a larger angle form a wedge */
#define CLOSED 1.0  /* S35: of the tolerance: narrower strips are closed */
#define SLENDER 3.0 /* S35: least length of a stretch, in widths */
#define AROUND -0.5 /* S81: cosine between the faces of a thin body */
#define THIN 0.02   /* S82: of the size: edges along narrower strips are */
#define STRETCH 16  /* stretched, by this ratio */
#define APART 4.0   /* tolerances between places, at most PLACES per edge */
#define PLACES 256
#define LINES 8 /* largest number of closed curves on a walk */
#define BISECTIONS 24
#define INSET 0.02 /* of an edge, but at most APART: first and last place */

/* --- width of a strip ----------------------------------------------------- */

/* Unit vectors along half-edge h (e) and normal to it in its triangle, inwards
 * (in). */
static int frame(const struct vg_ref *r, uint32_t h, double e[3], double in[3])
{
  vg_sub(vg_ref_at(r, vg_half_next(h)), vg_ref_at(r, h), e);
  if (!(vg_unit(e) > 0)) return 0;
  vg_cross(r->shape[h / 3].n, e, in);
  return vg_unit(in) > 0;
}

/* The half-edge through which the ray from x along d leaves the triangle that
 * it entered by h. *far is the distance. */
static uint32_t leave(const struct vg_ref *r, uint32_t h, const double x[3],
                      const double d[3], double *far)
{
  uint32_t best = VG_REF_NONE, g[2] = { vg_half_next(h), vg_half_prev(h) };

  *far = INFINITY;
  for (int k = 0; k < 2; k++) {
    double e[3], in[3], w[3], speed, gap;

    if (!frame(r, g[k], e, in)) continue;
    speed = -vg_dot(d, in);
    if (!(speed > 1e-12)) continue;
    vg_sub(x, vg_ref_at(r, g[k]), w);
    gap = fmax(vg_dot(w, in), 0) / speed;
    if (gap < *far) *far = gap, best = g[k];
  }
  return best;
}

double vg_strip_width(const struct vg_ref *r, const struct vg_curves *c,
                      uint32_t h, const double start[3], double most,
                      struct vg_strip_end *end)
{
  double e[3], in[3], d[3], x[3], sum = 0;

  assert(h < 3 * r->n_tri && most >= 0);
  if (!frame(r, h, e, d)) return INFINITY;
  memcpy(x, start, sizeof x);
  for (int i = 0; i < STEPS; i++) {
    double far, a;
    uint32_t g = leave(r, h, x, d, &far);

    if (g == VG_REF_NONE) return INFINITY;
    sum += far;
    if (sum > most) return INFINITY;
    for (int k = 0; k < 3; k++) x[k] += far * d[k];
    vg_sub(vg_ref_at(r, vg_half_next(g)), vg_ref_at(r, g), e);
    vg_unit(e);
    if (c->line[g] || r->mate[g] == VG_REF_NONE) {
      /* The angle is measured in the plane of the last triangle. */
      a = vg_dot(e, d);
      if (end) {
        end->half = g;
        memcpy(end->x, x, sizeof x);
      }
      return a * a < 1 - ALONG * ALONG ? sum : INFINITY;
    }
    a = vg_dot(d, e);
    h = r->mate[g];
    if (!frame(r, h, e, in)) return INFINITY;
    a = -a; /* the mate runs the other way */
    for (int k = 0; k < 3; k++)
      d[k] = a * e[k] + sqrt(fmax(0, 1 - a * a)) * in[k];
  }
  return INFINITY;
}

int vg_strip_is_edge(const struct vg_ref *r, uint32_t g, uint32_t h)
{
  const uint32_t a = r->mate[g], b = r->mate[h];

  return a != VG_REF_NONE && b != VG_REF_NONE &&
         vg_dot(r->shape[a / 3].n, r->shape[b / 3].n) < AROUND;
}

/* --- which of two curves is dropped --------------------------------------- */

/* A stretch of a curve. */
struct stretch {
  double from, to; /* Arc lengths. */
  double width;    /* Largest width of the strip. */
};

struct claim {
  int stays; /* Never dropped: it contains rims or fixed edges. */
  double length;
  size_t curve;
};

struct finder {
  const struct vg_ref *r;
  const struct vg_curves *c;
  const struct vg_strips_options *o;
  uint32_t (*side)[2];   /* [feature edges] Half-edges along the curve, and
                            against it. */
  struct claim *claim;   /* [n_curve] By descending priority: the last one is
                            dropped first. */
  size_t *rank;          /* [n_curve] Position of each curve in `claim`. */
  struct stretch *found; /* Closed stretches, ascending along each curve. */
  size_t n_found, cap_found;
  size_t *first, *end; /* [n_curve] Range of each curve in `found`. */
  struct vg_strips *s;
};

static vg_status list_sides(struct finder *f, struct vg_error *err)
{
  const struct vg_curves *c = f->c;
  size_t n = c->n_point - c->n_curve;

  f->side = vg_alloc(n, sizeof *f->side);
  f->claim = vg_calloc(c->n_curve, sizeof *f->claim);
  if (!f->side || !f->claim) return vg_fail_memory(err, "narrow strips");
  memset(f->side, 0xff, n * sizeof *f->side);
  for (uint32_t h = 0; h < 3 * f->r->n_tri; h++) {
    uint32_t l = c->line[h];
    size_t i;

    if (!l) continue;
    i = vg_curve_of(c, l);
    f->side[l - 1][f->r->tri[h / 3][h % 3] != c->point[l - 1 + i]] = h;
    f->claim[i].stays |= vg_curves_is_hard(f->o->lines, f->r, h);
  }
  return VG_OK;
}

/* Curves that must stay, then longer ones, then those found first. */
static int by_claim(const void *a, const void *b)
{
  const struct claim *p = a, *q = b;

  if (p->stays != q->stays) return p->stays ? -1 : 1;
  if (p->length != q->length) return p->length > q->length ? -1 : 1;
  return p->curve < q->curve ? -1 : p->curve > q->curve;
}

static vg_status rank_curves(struct finder *f, struct vg_error *err)
{
  const size_t n = f->c->n_curve;

  f->rank = vg_alloc(n, sizeof *f->rank);
  f->first = vg_calloc(n, sizeof *f->first);
  f->end = vg_calloc(n, sizeof *f->end);
  if (!f->rank || !f->first || !f->end)
    return vg_fail_memory(err, "narrow strips");
  for (size_t i = 0; i < n; i++) {
    f->claim[i].length = vg_curve_length(f->c, i);
    f->claim[i].curve = i;
  }
  qsort(f->claim, n, sizeof *f->claim, by_claim);
  for (size_t i = 0; i < n; i++) f->rank[f->claim[i].curve] = i;
  return VG_OK;
}

/* --- narrow stretches of a curve ------------------------------------------ */

static int is_closed(const struct finder *f, size_t curve, double s)
{
  for (size_t k = f->first[curve]; k < f->end[curve]; k++)
    if (s >= f->found[k].from && s <= f->found[k].to) return 1;
  return 0;
}

/* At position t of edge k of the curve, is the strip on the side of h narrow,
 * up to a curve that stays? Closed stretches are crossed. *width is the width
 * of the strip. */
static int is_narrow(struct finder *f, size_t curve, size_t k, uint32_t h,
                     double t, double *width)
{
  const struct vg_curves *c = f->c;
  const double *a = f->r->point[c->point[k]];
  const double *b = f->r->point[c->point[k + 1]];
  const double most = CLOSED * f->o->tolerance;
  const uint32_t begin = h;
  struct vg_strip_end end;
  double x[3], s;
  uint32_t l;
  size_t j;

  for (int d = 0; d < 3; d++) x[d] = a[d] + t * (b[d] - a[d]);
  *width = 0;
  for (int i = 0; i < LINES && h != VG_REF_NONE; i++) {
    *width += vg_strip_width(f->r, c, h, x, most - *width, &end);
    if (!(*width <= most)) return 0;
    l = c->line[end.half];
    if (!l) return 0;
    j = vg_curve_of(c, l);
    if (j == curve) return 0;
    s = c->at[l - 1 + j] + vg_distance(end.x, f->r->point[c->point[l - 1 + j]]);
    if (!is_closed(f, j, s)) {
      if (f->o->closes_edges || *width < VG_STRIP_LEAST * most ||
          !vg_strip_is_edge(f->r, begin, end.half))
        return f->rank[j] < f->rank[curve];
      f->s->has_edges = 1;
      return 0;
    }
    h = f->r->mate[end.half];
    memcpy(x, end.x, sizeof x);
  }
  return 0;
}

/* Bisect between two positions, of which one is narrow, for the end of the
 * narrow part. *width is raised to the widths found. */
static double change_at(struct finder *f, size_t curve, size_t k, uint32_t h,
                        double narrow, double wide, double *width)
{
  for (int i = 0; i < BISECTIONS; i++) {
    double t = (narrow + wide) / 2, w;

    if (is_narrow(f, curve, k, h, t, &w)) narrow = t, *width = fmax(*width, w);
    else wide = t;
  }
  return narrow;
}

/* Append a stretch to those of the curve from `first` on, or extend the last
 * one if they touch. */
static vg_status add_stretch(struct finder *f, size_t first,
                             const struct stretch *s, struct vg_error *err)
{
  struct stretch *last = f->n_found > first ? &f->found[f->n_found - 1] : NULL;

  if (last && s->from <= last->to) {
    last->to = fmax(last->to, s->to);
    last->width = fmax(last->width, s->width);
    return VG_OK;
  }
  if (vg_reserve(&f->found, &f->cap_found, f->n_found + 1, sizeof *f->found))
    return vg_fail_memory(err, "narrow strips");
  f->found[f->n_found++] = *s;
  return VG_OK;
}

/* Find the stretches of edge k of a curve that are narrow on the side of h. */
static vg_status look_along(struct finder *f, size_t curve, size_t k,
                            uint32_t h, size_t first, struct vg_error *err)
{
  const double s0 = f->c->at[k], length = f->c->at[k + 1] - s0;
  const double apart = APART * f->o->tolerance, places = length / apart + 2;
  const double inset = fmin(INSET, apart / length);
  const int n = places < PLACES ? (int)places : PLACES;
  struct stretch s = { 0 };
  double last = 0, w;
  int was = 0;
  vg_status st = VG_OK;

  for (int i = 0; i <= n; i++) {
    double t = inset + (1 - 2 * inset) * i / n;
    int is = is_narrow(f, curve, k, h, t, &w);

    if (is && !was) {
      s = (struct stretch){ s0, 0, 0 };
      if (i) s.from += length * change_at(f, curve, k, h, t, last, &s.width);
    }
    if (is) s.width = fmax(s.width, w);
    if (was && !is) {
      s.to = s0 + length * change_at(f, curve, k, h, last, t, &s.width);
      VG_TRY(add_stretch(f, first, &s, err));
    }
    was = is;
    last = t;
  }
  if (!was) goto done;
  s.to = f->c->at[k + 1];
  VG_TRY(add_stretch(f, first, &s, err));
done:
  return st;
}

static int by_start(const void *a, const void *b)
{
  const struct stretch *p = a, *q = b;

  return p->from < q->from ? -1 : p->from > q->from;
}

/* Merge the stretches of both sides. Those that are too short for their width
 * are dropped and stay feature edges. */
static void merge(struct finder *f, size_t first)
{
  size_t n = first;

  if (f->n_found - first > 1)
    qsort(&f->found[first], f->n_found - first, sizeof *f->found, by_start);
  for (size_t k = first; k < f->n_found; k++) {
    const struct stretch *s = &f->found[k];

    if (s->to - s->from < SLENDER * s->width ||
        s->to - s->from < f->o->tolerance)
      continue;
    if (n > first && s->from <= f->found[n - 1].to) {
      f->found[n - 1].to = fmax(f->found[n - 1].to, s->to);
      f->found[n - 1].width = fmax(f->found[n - 1].width, s->width);
    } else f->found[n++] = *s;
  }
  f->n_found = n;
}

static vg_status inspect_curve(struct finder *f, size_t i, struct vg_error *err)
{
  const struct vg_feature_curve *curve = &f->c->curve[i];
  const double *across = f->o->across;
  const size_t first = f->n_found;
  vg_status st = VG_OK;

  for (int side = 0; side < 2; side++) {
    size_t begun = f->n_found;

    for (size_t k = curve->first; k + 1 < curve->first + curve->n; k++) {
      uint32_t h = f->side[k - i][side];

      if (h == VG_REF_NONE) continue;
      if (across && across[f->o->lines->tri_patch[h / 3]] > 1) continue;
      VG_TRY(look_along(f, i, k, h, begun, err));
    }
  }
  merge(f, first);
  f->first[i] = first;
  f->end[i] = f->n_found;
done:
  return st;
}

/* --- closing -------------------------------------------------------------- */

static void count(struct finder *f, size_t i)
{
  struct vg_strips *s = f->s;

  s->n += f->end[i] - f->first[i];
  for (size_t j = f->first[i]; j < f->end[i]; j++) {
    const struct stretch *p = &f->found[j];

    s->length += p->to - p->from;
    if (p->width <= s->widest) continue;
    s->widest = p->width;
    vg_curve_at(f->c, f->r, i, (p->from + p->to) / 2, s->at);
  }
}

static vg_status close_all(struct finder *f, const struct vg_mesh *m,
                           struct vg_error *err)
{
  struct vg_strip_cutter cut = { .s = f->s };
  vg_status st;

  VG_TRY(vg_strip_cutter_begin(&cut, f->r, m, err));
  for (size_t i = 0; i < f->c->n_curve; i++) {
    const struct vg_feature_curve *curve = &f->c->curve[i];
    size_t j = f->first[i];

    count(f, i);
    for (size_t k = curve->first; k + 1 < curve->first + curve->n; k++) {
      double s0 = f->c->at[k], s1 = f->c->at[k + 1];
      uint32_t h = f->side[k - i][0];

      for (; j < f->end[i] && f->found[j].from < s1; j++) {
        VG_TRY(vg_strip_cut(&cut, h, (f->found[j].from - s0) / (s1 - s0),
                            (f->found[j].to - s0) / (s1 - s0), err));
        if (f->found[j].to > s1) break;
      }
    }
  }
done:
  vg_strip_cutter_release(&cut);
  return st;
}

vg_status vg_strips_find(const struct vg_ref *r, const struct vg_curves *c,
                         const struct vg_mesh *m,
                         const struct vg_strips_options *o, struct vg_strips *s,
                         struct vg_error *err)
{
  struct finder f = { .r = r, .c = c, .o = o, .s = s };
  vg_status st;

  assert(o->tolerance >= 0 && !s->n);
  VG_TRY(list_sides(&f, err));
  VG_TRY(rank_curves(&f, err));
  for (size_t i = 0; i < c->n_curve; i++)
    if (!f.claim[i].stays) VG_TRY(inspect_curve(&f, f.claim[i].curve, err));
  if (f.n_found) VG_TRY(close_all(&f, m, err));
done:
  free(f.side);
  free(f.claim);
  free(f.rank);
  free(f.first);
  free(f.end);
  free(f.found);
  if (st < 0) vg_strips_release(s);
  return st;
}

/* --- stretching ----------------------------------------------------------- */

/* Is the strip inwards of feature edge h a thin edge of a body everywhere? */
static int is_thin(const struct vg_ref *r, const struct vg_curves *c,
                   uint32_t h)
{
  static const double share[3] = { 0.1, 0.5, 0.9 };
  const double *a = vg_ref_at(r, h), *b = vg_ref_at(r, vg_half_next(h));
  const double most = THIN * fmin(r->plain[vg_ref_from(r, h)],
                                  r->plain[vg_ref_to(r, h)]);

  for (int i = 0; i < 3; i++) {
    struct vg_strip_end end;
    double x[3];

    for (int k = 0; k < 3; k++) x[k] = a[k] + share[i] * (b[k] - a[k]);
    if (!(vg_strip_width(r, c, h, x, most, &end) < most) ||
        !vg_strip_is_edge(r, h, end.half))
      return 0;
  }
  return 1;
}

size_t vg_strips_stretch(const struct vg_ref *r, const struct vg_curves *c,
                         const double *across, const uint32_t *tri_patch,
                         double *by)
{
  size_t n = 0;

  for (uint32_t h = 0; h < 3 * r->n_tri; h++) {
    if (!c->line[h] || by[h] > 0 || (across && across[tri_patch[h / 3]] > 1) ||
        !is_thin(r, c, h))
      continue;
    by[h] = STRETCH;
    if (r->mate[h] != VG_REF_NONE) by[r->mate[h]] = STRETCH;
    n++;
  }
  return n;
}

void vg_strips_release(struct vg_strips *s)
{
  vg_mesh_release(&s->mesh);
  free(s->closed);
  free(s->tri_from);
  free(s->half_from);
  free(s->ends);
  memset(s, 0, sizeof *s);
}
