/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/remesh/passes.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "core/geometry/graded.h"
#include "core/geometry/hilbert.h"
#include "core/geometry/vector.h"

#define ANGLE2 0.0669873 /* (sin 15 degrees)^2: no collapse creates less */
#define FINE2 0.45       /* (sin 42 degrees)^2: good triangles */
#define ROUNDS 12
/* S72: another round of collapses follows if at least 1 in 8 of the short edges
 * was collapsed, and another round of swaps if there was one swap per 20000
 * triangles. */
#define COLLAPSED_OF 8
#define SWAPPED_OF 200
#define GIVEN_WITHIN                                                           \
  0.02                /* S73: of a step: an input point this close is used */
#define MUCH 2.0      /* S84: of the longest edge: much too long */
#define LONGEST 0.999 /* S74: of the length: sides below count as shorter */
/* S75: smoothing. The weight of a triangle is 1 / (shape + SHAPE_FLOOR). */
#define SHAPE_FLOOR 0.05
#define STEP_GOOD 0.1   /* of the size: least step among good triangles */
#define STEP_BAD 0.02   /* of the size: least step at a poor triangle */
#define SHAPE_GAIN 0.02 /* of 1 - worst shape: least gain there */
/* S77: least slide along a curve, relative to both feature edges; slides create
 * no angle below 30 degrees (squared sine). */
#define STEP_EVEN 0.02
#define EVEN2 0.25

/* --- curves -------------------------------------------------------------- */

struct curve_size {
  const struct vg_tris *w;
  size_t curve;
  uint32_t by;
};

/* Target length along the curve at arc length s, which is point x. */
static double size_of_edges(const struct curve_size *c, double s,
                            const double x[3], double size)
{
  const struct vg_tris *w = c->w;
  const double whole = vg_curve_length(w->curves, c->curve);
  struct vg_metric asked = { .size = size };
  double a[3], b[3], d[3];

  vg_tris_stretch(w, x, NULL, &asked);
  size = asked.size;
  vg_curve_at(w->curves, w->ref, c->curve, fmax(s - size / 2, 0), a);
  vg_curve_at(w->curves, w->ref, c->curve, fmin(s + size / 2, whole), b);
  vg_sub(b, a, d);
  return vg_norm(d) > 0 ? vg_metric_along(&asked, d) : size;
}

static double size_along(void *user, double s)
{
  struct curve_size *c = user;
  const struct vg_tris *w = c->w;
  double x[3], size;

  vg_curve_at(w->curves, w->ref, c->curve, s, x);
  size = vg_tris_size(w, x, &c->by);
  return vg_tris_is_stretched(w) ? size_of_edges(c, s, x, size) : size;
}

/* A half-edge of feature edge i; VG_REF_NONE: not found. */
static uint32_t half_of(const struct vg_tris *w, uint32_t i)
{
  for (int k = 0; k < 2; k++) {
    uint32_t ring[VG_WORK_RING];
    int open;
    size_t n = vg_tris_ring(w, w->line[i].end[k], ring, &open);

    for (size_t j = 0; j < n; j++) {
      if (w->edge[ring[j]] == i + 1) return ring[j];
      if (w->edge[vg_half_prev(ring[j])] == i + 1) return vg_half_prev(ring[j]);
    }
  }
  return VG_REF_NONE;
}

/* Arc lengths at which a curve is divided, from the sizes along it. */
struct steps {
  size_t n;
  double *s; /* [n + 1] Arc lengths, ascending. */
  vg_status st;
  struct vg_error err;
};

struct dividing {
  const struct vg_tris *w;
  struct steps *of; /* [n_curve] Steps of each curve. */
};

static int is_loop(const struct vg_tris *w, size_t i)
{
  const struct vg_feature_curve *c = &w->curves->curve[i];

  return w->curves->point[c->first] == w->curves->point[c->first + c->n - 1];
}

static void find_steps(void *context, size_t first, size_t end, int worker)
{
  const struct dividing *d = context;

  (void)worker;
  for (size_t i = first; i < end && !vg_stops(&d->w->stop); i++) {
    struct curve_size user = { d->w, i, VG_REF_NONE };
    struct steps *of = &d->of[i];

    of->st = vg_graded_steps(vg_curve_length(d->w->curves, i), size_along,
                             &user, is_loop(d->w, i) ? 3 : 1, &of->n, &of->s,
                             &of->err);
  }
}

/* Insert points into a curve whose feature edges are first .. end - 1. Existing
 * points that are not at one of the steps are marked for removal. */
static void divide(struct vg_tris *w, const struct steps *of, uint32_t first,
                   uint32_t end)
{
  const double *s = of->s;
  uint32_t cur = first, base = first;

  for (uint32_t i = first; i + 1 < end; i++)
    w->point[w->line[i].end[1]].goes = 1;
  for (size_t k = 1; k < of->n && !w->failed; k++) {
    double slack = GIVEN_WITHIN * fmin(s[k] - s[k - 1], s[k + 1] - s[k]);
    uint32_t m = VG_REF_NONE, h;

    while (w->line[cur].at[1] < s[k] - slack && base + 1 < end) cur = ++base;
    if (w->line[cur].at[1] <= s[k] + slack) m = w->line[cur].end[1];
    else if (w->line[cur].at[0] >= s[k] - slack) m = w->line[cur].end[0];
    else if ((h = half_of(w, cur)) != VG_REF_NONE) {
      uint32_t n_line = (uint32_t)w->n_line;

      m = vg_tris_split(w, h, &s[k]);
      if (m != VG_REF_NONE) cur = n_line; /* second half of the split edge */
    }
    if (m != VG_REF_NONE) w->point[m].goes = 0;
  }
}

vg_status vg_pass_divide(struct vg_tris *w, int threads, struct vg_error *err)
{
  const size_t n = w->curves->n_curve;
  struct dividing d = { w, vg_calloc(n, sizeof *d.of) };
  size_t line = 0;
  vg_status st = VG_OK;

  if (!d.of) return vg_fail_memory(err, "the curves of the surface");
  vg_parallel_for(threads, n, 1, find_steps, &d);
  st = vg_stopped(&w->stop, err);
  for (size_t i = 0; i < n && st >= 0; i++) {
    size_t end = line + w->curves->curve[i].n - 1;

    if (d.of[i].st < 0) {
      st = d.of[i].st;
      if (err) *err = d.of[i].err;
      break;
    }
    divide(w, &d.of[i], (uint32_t)line, (uint32_t)end);
    line = end;
  }
  if (st >= 0) st = vg_tris_status(w, err);
  for (size_t i = 0; i < n; i++) free(d.of[i].s);
  free(d.of);
  return st;
}

/* Collapse p into its nearer neighbour on the curve, or else into the other
 * one. */
static int remove_point(struct vg_tris *w, uint32_t p)
{
  uint32_t ring[VG_WORK_RING], h[2], n_h = 0;
  int open;
  size_t n = vg_tris_ring(w, p, ring, &open);

  for (size_t i = 0; i < n && n_h < 2; i++)
    if (w->edge[ring[i]]) h[n_h++] = ring[i];
  if (n_h == 2 && vg_tris_ratio(w, h[1]) < vg_tris_ratio(w, h[0])) {
    uint32_t g = h[0];

    h[0] = h[1];
    h[1] = g;
  }
  for (uint32_t i = 0; i < n_h; i++)
    if (vg_tris_collapse(w, h[i], INFINITY, 0)) return 1;
  return 0;
}

void vg_pass_curves(struct vg_tris *w)
{
  size_t n = 1;

  for (int round = 0; n && round < 4; round++) {
    n = 0;
    for (uint32_t p = 0; p < w->n_point && !w->ends; p++)
      if (w->point[p].goes && w->point[p].half != VG_REF_NONE &&
          w->point[p].kind == VG_WORK_CURVE)
        n += (size_t)remove_point(w, p);
    n += vg_pass_swap(w);
  }
}

/* --- edges sorted by length ----------------------------------------------- */

struct edge_list {
  size_t n, cap;
  struct vg_key *key;
};

/* The bit patterns of positive doubles sort like their values. */
static int list_edge(const struct vg_tris *w, uint32_t h, double lo, double hi,
                     int falls, struct edge_list *l)
{
  double r;
  uint64_t bits;

  if (w->mate[h] != VG_REF_NONE && w->mate[h] < h) return 0;
  r = vg_tris_ratio(w, h);
  if (r >= lo && r <= hi) return 0;
  memcpy(&bits, &r, sizeof bits);
  if (vg_reserve(&l->key, &l->cap, l->n + 1, sizeof *l->key)) return -1;
  l->key[l->n++] = (struct vg_key){ falls ? ~bits : bits, h };
  return 0;
}

/* Edges whose ratio of length to target length is out of bounds, by ascending
 * (or with `falls` descending) ratio. Edges that were examined before and have
 * not changed since are left out. */
static vg_status edges_by_ratio(struct vg_tris *w, int look, double lo,
                                double hi, int falls, struct vg_key **key,
                                size_t *n, struct vg_error *err)
{
  const uint64_t since = w->looked[look];
  struct edge_list l = { 0 };
  int failed = 0;

  w->looked[look] = w->clock;
  for (uint32_t t = 0; t < w->n_tri; t++) {
    int is_new[3];

    for (int k = 0; k < 3; k++)
      is_new[k] = w->point[w->tri[t][k]].changed > since;
    if (!(is_new[0] | is_new[1] | is_new[2]) || vg_tris_removed(w, t)) continue;
    for (uint32_t k = 0; k < 3; k++)
      if (is_new[k] || is_new[(k + 1) % 3])
        failed |= list_edge(w, 3 * t + k, lo, hi, falls, &l);
  }
  *key = l.key;
  *n = l.n;
  if (failed) return vg_fail_memory(err, "the edges of the surface");
  return *n ? vg_sort_keys(*n, *key, err) : VG_OK;
}

static int try_collapse(struct vg_tris *w, uint32_t h, double most)
{
  uint32_t g = w->mate[h];

  /* Move the less constrained end first. Of equal ends, try both directions. */
  if (g != VG_REF_NONE) {
    const struct vg_tris_point *a = &w->point[vg_tris_from(w, h)];
    const struct vg_tris_point *b = &w->point[vg_tris_to(w, h)];

    if (a->kind > b->kind) {
      uint32_t k = h;

      h = g;
      g = k;
    }
  }
  return vg_tris_collapse(w, h, most, ANGLE2) ||
         (g != VG_REF_NONE && vg_tris_collapse(w, g, most, ANGLE2));
}

vg_status vg_pass_collapse(struct vg_tris *w, double least, double most,
                           size_t *n, struct vg_error *err)
{
  vg_status st = VG_OK;
  struct vg_key *key = NULL;
  size_t n_key, done = 1;

  assert(least >= 0 && most > 0 && n);
  *n = 0;
  for (int round = 0; done && round < ROUNDS; round++) {
    done = 0;
    free(key);
    VG_TRY(edges_by_ratio(w, VG_WORK_COLLAPSES, least, INFINITY, 0, &key,
                          &n_key, err));
    for (size_t i = 0; i < n_key && !w->ends; i++) {
      uint32_t h = key[i].index;

      if (vg_tris_removed(w, h / 3) || vg_tris_ratio(w, h) >= least) continue;
      done += (size_t)try_collapse(w, h, most);
    }
    *n += done;
    if (COLLAPSED_OF * done < n_key) done = 0;
    vg_pass_swap(w);
  }
  VG_TRY(vg_tris_status(w, err));
done:
  free(key);
  return st;
}

/* Is the edge the longest of both its triangles? Needles are then cut across,
 * not along. */
static int is_longest(const struct vg_tris *w, uint32_t h)
{
  const double l = LONGEST * vg_tris_ratio(w, h);

  for (int side = 0; side < 2; side++, h = w->mate[h]) {
    if (h == VG_REF_NONE) break;
    if (vg_tris_ratio(w, vg_half_next(h)) > l ||
        vg_tris_ratio(w, vg_half_prev(h)) > l)
      return 0;
  }
  return 1;
}

/* Must edge h wait? If an edge that is not the longest is split, needles are
 * cut along, not across. The longest edge is the next to be split, unless it is
 * at the border of a block:
 *
 *      o--------------------o     border: the needle below cannot be split
 *       `-.__             .'
 *            `-.__      .'        ever thinner needles arise if the shorter
 *                 `-._.'          of its long edges is split instead
 *                     o
 */
static int waits(const struct vg_tris *w, uint32_t h, double most,
                 enum vg_split which)
{
  /* In a metric, needles along thin strips are as requested. */
  const int is_near = which == VG_SPLIT_NEAR && !vg_tris_is_stretched(w);

  return (which == VG_SPLIT_LONGEST ||
          (is_near && vg_tris_ratio(w, h) > MUCH * most)) &&
         !is_longest(w, h);
}

vg_status vg_pass_split(struct vg_tris *w, double most, enum vg_split which,
                        size_t *n, struct vg_error *err)
{
  const int one = which == VG_SPLIT_LONGEST;
  const int look = one ? VG_WORK_ACROSS : VG_WORK_SPLITS;
  vg_status st = VG_OK;
  struct vg_key *key = NULL;
  size_t n_key, done = 1;

  assert(most > 0 && n);
  *n = 0;
  for (int round = 0; done && round < (one ? 1 : ROUNDS); round++) {
    done = 0;
    free(key);
    VG_TRY(edges_by_ratio(w, look, 0, most, 1, &key, &n_key, err));
    for (size_t i = 0; i < n_key && !w->ends; i++) {
      uint32_t h = key[i].index;

      if (vg_tris_removed(w, h / 3) || vg_tris_ratio(w, h) <= most) continue;
      if (waits(w, h, most, which)) {
        w->point[vg_tris_from(w, h)].changed = ++w->clock; /* list it again */
        continue;
      }
      done += vg_tris_split(w, h, NULL) != VG_REF_NONE;
    }
    *n += done;
    vg_pass_swap(w);
  }
  VG_TRY(vg_tris_status(w, err));
done:
  free(key);
  return st;
}

/* --- swap ---------------------------------------------------------------- */

size_t vg_pass_swap(struct vg_tris *w)
{
  size_t n = 0, now = 1;

  for (int round = 0; now && round < ROUNDS; round++) {
    const uint64_t before = w->looked[VG_WORK_SWAPS];

    now = 0;
    w->looked[VG_WORK_SWAPS] = w->clock;
    for (uint32_t t = 0; t < w->n_tri && !w->ends; t++) {
      if (w->stamp[t] <= before || vg_tris_removed(w, t)) continue;
      for (uint32_t h = 3 * t; h < 3 * t + 3; h++) {
        uint32_t g = w->mate[h];

        if (g == VG_REF_NONE || w->edge[h] ||
            (g < h && w->stamp[g / 3] > before))
          continue;
        now += (size_t)vg_tris_swap(w, h);
      }
    }
    n += now;
    if (SWAPPED_OF * now < w->n_tri / 100) now = 0;
  }
  return n;
}

/* --- smooth -------------------------------------------------------------- */

/* Weighted mean of the positions at which p would make each of its triangles
 * equilateral, on the opposite edge and in the metric at p. */
static int better_place(const struct vg_tris *w, uint32_t p, double x[3],
                        double *worst)
{
  const double *form = vg_tris_form(w, p), *o = vg_tris_at(w, p);
  uint32_t ring[VG_WORK_RING];
  int open;
  size_t n = vg_tris_ring(w, p, ring, &open);
  double sum = 0;

  if (!n || open) return 0;
  *worst = 1;
  memset(x, 0, 3 * sizeof *x);
  for (size_t i = 0; i < n; i++) {
    const uint32_t to = vg_tris_to(w, ring[i]);
    const uint32_t last = vg_tris_from(w, vg_half_prev(ring[i]));
    const double *a = vg_tris_at(w, to), *b = vg_tris_at(w, last);
    double e[3], d[3], mid[3], l2, along, high, weight;
    double shape = vg_tris_shape(w, &w->point[p], &w->point[to],
                                 &w->point[last]);

    *worst = fmin(*worst, shape);
    vg_sub(b, a, e);
    l2 = vg_form_dot(form, e, e);
    for (int k = 0; k < 3; k++) mid[k] = (a[k] + b[k]) / 2;
    vg_sub(o, mid, d);
    along = vg_form_dot(form, d, e) / l2;
    for (int k = 0; k < 3; k++) d[k] -= along * e[k];
    high = vg_form_norm(form, d);
    if (!(high > 0)) continue;
    weight = 1 / (SHAPE_FLOOR + shape);
    for (int k = 0; k < 3; k++)
      x[k] += weight * (mid[k] + d[k] * 0.8660254037844386 * sqrt(l2) / high);
    sum += weight;
  }
  if (!(sum > 0)) return 0;
  for (int k = 0; k < 3; k++) x[k] /= sum;
  return 1;
}

static int smooth_point(struct vg_tris *w, uint32_t p)
{
  double x[3], worst, step = 1;
  const double *o = w->point[p].x;

  if (w->point[p].tried > w->point[p].changed) return 0;
  w->point[p].tried = ++w->clock;
  if (!better_place(w, p, x, &worst)) return 0;
  for (int i = 0; i < 2; i++, step /= 2) {
    double y[3], d[3];

    for (int k = 0; k < 3; k++) y[k] = o[k] + step * (x[k] - o[k]);
    vg_sub(y, o, d);
    if (vg_form_norm(vg_tris_form(w, p), d) <
        (worst > FINE2 ? STEP_GOOD : STEP_BAD) * w->point[p].asked.size)
      return 0;
    if (vg_tris_move(w, p, y,
                     worst > FINE2 ? worst : worst + SHAPE_GAIN * (1 - worst)))
      return 1;
  }
  return 0;
}

size_t vg_pass_smooth(struct vg_tris *w, int sweeps)
{
  size_t n = 0;

  assert(sweeps >= 0);
  for (int i = 0; i < sweeps; i++)
    for (uint32_t p = 0; p < w->n_point && !w->ends; p++)
      if (w->point[p].half != VG_REF_NONE && w->point[p].kind == VG_WORK_FACE)
        n += (size_t)smooth_point(w, p);
  return n;
}

/* --- curve points --------------------------------------------------------- */

/* Arc length at which the two feature edges of a span have equal lengths in
 * the metric, if each keeps its ratio of both lengths. */
static double even_place(const struct vg_tris *w, uint32_t p,
                         const struct vg_tris_span *s)
{
  const struct vg_tris_line *line[2] = { &w->line[s->line[0]],
                                         &w->line[s->line[1]] };
  const double a = vg_tris_length(w, &w->point[line[0]->end[0]], &w->point[p]);
  const double b = vg_tris_length(w, &w->point[p], &w->point[line[1]->end[1]]);
  const double half = (a + b) / 2;

  if (!(a > 0 && b > 0)) return s->at;
  return a > half ? s->lo + (s->at - s->lo) * half / a
                  : s->hi - (s->hi - s->at) * half / b;
}

static int even_point(struct vg_tris *w, uint32_t p)
{
  struct vg_tris_span s;
  double at;

  if (!vg_tris_span(w, p, &s)) return 0;
  at = even_place(w, p, &s);
  if (fabs(at - s.at) < STEP_EVEN * (s.hi - s.lo)) return 0;
  return vg_tris_slide(w, p, at, EVEN2);
}

size_t vg_pass_even(struct vg_tris *w, int sweeps)
{
  size_t n = 0;

  assert(sweeps >= 0);
  for (int i = 0; i < sweeps; i++)
    for (uint32_t p = 0; p < w->n_point && !w->ends; p++)
      if (w->point[p].half != VG_REF_NONE && w->point[p].kind == VG_WORK_CURVE)
        n += (size_t)even_point(w, p);
  return n;
}
