/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/curve/curve.h"
#include "core/geometry/graded.h"

#define FULL_CIRCLE 6.283185307179586
#define LEAST 1e-8 /* Edge over the length of the curve. */

enum {
  PER_EDGE = 4,     /* Samples of the requests per edge, */
  PER_INTERVAL = 8, /* and between two given points. */
  STEPS_MIN = 1,
  SAMPLES_MAX = 1 << 24
};

struct sample {
  double s, h; /* Chord length along the curve, edge length. */
};

struct division {
  const struct vg_outline *c;
  const struct vg_outline_sizes *z;
  size_t n, cap;
  struct sample *sample; /* [n] from s = 0 to the whole length. */
  double from;           /* Start of the current piece. */
  size_t at;             /* Sample of the last search. */
  size_t n_out, cap_out;
  double (*out)[2];
};

/* The least request at a place of interval i. */
static double request(const struct division *d, size_t i, double t)
{
  const struct vg_outline_sizes *z = d->z;
  double x[2], bend, h;

  vg_outline_at(d->c, i, t, x, &bend);
  h = fmin(z->largest, FULL_CIRCLE / (bend * z->per_turn));
  if (h < z->smallest) h = z->smallest;
  return z->at ? fmin(h, z->at(z->user, x)) : h;
}

/* The request at point i, on which a corner or the nose may be. */
static double request_at_point(const struct division *d, size_t i)
{
  const struct vg_outline *c = d->c;
  const struct vg_outline_sizes *z = d->z;
  double h = fmin(request(d, i, 0), request(d, i ? i - 1 : c->n - 1, INFINITY));

  if (z->corner > 0 && c->corner[i]) h = fmin(h, z->corner);
  if (z->nose > 0 && i == c->nose) h = fmin(h, z->nose);
  if (z->n_base && (i == c->base[0] || i == c->base[1]))
    h = fmin(h, vg_outline_base(c) / (double)z->n_base);
  return h;
}

static vg_status add_sample(struct division *d, double s, double h,
                            struct vg_error *err)
{
  if (d->n >= SAMPLES_MAX || !(h > LEAST * d->c->s[d->c->n]))
    return vg_fail(err, VG_ERR_INPUT,
                   "a section of length %g would need edges of length %g; "
                   "check the spacing on it",
                   d->c->s[d->c->n], h);
  if (vg_reserve(&d->sample, &d->cap, d->n + 1, sizeof *d->sample))
    return vg_fail_memory(err, "the edges of a curve");
  d->sample[d->n++] = (struct sample){ s, h };
  return VG_OK;
}

/* Samples the requests, in steps of the edge length that the growth allows. */
static vg_status sample(struct division *d, struct vg_error *err)
{
  const struct vg_outline *c = d->c;
  const double slope = d->z->growth - 1;
  double h = 0;
  vg_status st = VG_OK;

  for (size_t i = 0; i < c->n && st >= 0; i++) {
    const double len = c->s[i + 1] - c->s[i];
    double t = 0;

    h = i ? fmin(request_at_point(d, i), h) : request_at_point(d, i);
    while (st >= 0) {
      const double step = fmin(h / PER_EDGE, len / PER_INTERVAL);

      VG_TRY(add_sample(d, c->s[i] + t, h, err));
      if (len - t < 1.5 * step) break;
      t += step;
      h = fmin(request(d, i, t), h + slope * step);
    }
    h += slope * (len - t);
  }
  st = add_sample(d, c->s[c->n], fmin(h, request_at_point(d, 0)), err);
done:
  return st;
}

/* Limits the growth in both directions around the closed curve. */
static void limit(struct division *d)
{
  const double slope = d->z->growth - 1;
  struct sample *a = d->sample;

  for (int round = 0; round < 2; round++) {
    a[0].h = a[d->n - 1].h = fmin(a[0].h, a[d->n - 1].h);
    for (size_t i = 1; i < d->n; i++)
      a[i].h = fmin(a[i].h, a[i - 1].h + slope * (a[i].s - a[i - 1].s));
    a[0].h = a[d->n - 1].h = fmin(a[0].h, a[d->n - 1].h);
    for (size_t i = d->n - 1; i-- > 0;)
      a[i].h = fmin(a[i].h, a[i + 1].h + slope * (a[i + 1].s - a[i].s));
  }
}

/* Edge length at a distance from the start of the current piece. */
static double size_at(void *user, double s)
{
  struct division *d = user;
  const double all = d->c->s[d->c->n];
  const struct sample *a;
  double x = d->from + s, u;

  if (x > all) x -= all;
  if (d->sample[d->at].s > x) d->at = 0;
  while (d->at + 2 < d->n && d->sample[d->at + 1].s < x) d->at++;
  a = d->sample + d->at;
  u = (x - a[0].s) / (a[1].s - a[0].s);
  u = u < 0 ? 0 : u > 1 ? 1 : u;
  return a[0].h + u * (a[1].h - a[0].h);
}

/* Appends the point at a distance along the whole curve. */
static vg_status put(struct division *d, double s, struct vg_error *err)
{
  const struct vg_outline *c = d->c;
  const double all = c->s[c->n], x = s >= all ? s - all : s;
  size_t lo = 0, hi = c->n;
  double bend;

  while (hi - lo > 1) {
    const size_t mid = (lo + hi) / 2;

    if (c->s[mid] <= x) lo = mid;
    else hi = mid;
  }
  if (vg_reserve(&d->out, &d->cap_out, d->n_out + 1, sizeof *d->out))
    return vg_fail_memory(err, "the edges of a curve");
  vg_outline_at(c, lo, x - c->s[lo], d->out[d->n_out++], &bend);
  return VG_OK;
}

/* Divides the piece from point a to point b, without its last point. */
static vg_status divide_piece(struct division *d, size_t a, size_t b,
                              struct vg_error *err)
{
  const struct vg_outline *c = d->c;
  const double len = b > a ? c->s[b] - c->s[a] : c->s[c->n] - c->s[a] + c->s[b];
  const int is_base = a == c->base[0] && b == c->base[1];
  size_t n = d->z->n_base;
  double *s = NULL;
  vg_status st = VG_OK;

  d->from = c->s[a];
  if (!is_base || !n)
    VG_TRY(vg_graded_steps(len, size_at, d, STEPS_MIN, &n, &s, err));
  for (size_t i = 0; i < n; i++)
    VG_TRY(put(d, d->from + (s ? s[i] : len * ((double)i / (double)n)), err));
done:
  free(s);
  return st;
}

/* Whether pieces end at point i: at corners and the nose, so that the edges of
 * a symmetric section are symmetric, and without corners also at the start. */
static int is_end(const struct vg_outline *c, size_t i)
{
  return c->corner[i] || i == c->nose || (!i && !c->n_corner);
}

vg_status vg_outline_divide(const struct vg_outline *c,
                            const struct vg_outline_sizes *sizes, size_t *n,
                            double (**x)[2], struct vg_error *err)
{
  assert(c->n && sizes->largest > 0 && sizes->growth > 1 && n && x);
  assert(sizes->per_turn > 0);

  struct division d = { .c = c, .z = sizes };
  size_t first = 0, a, b;
  vg_status st;

  VG_TRY(sample(&d, err));
  limit(&d);
  while (!is_end(c, first)) first++;
  a = first;
  do {
    b = a;
    do b = b + 1 < c->n ? b + 1 : 0;
    while (!is_end(c, b));
    VG_TRY(divide_piece(&d, a, b, err));
    a = b;
  } while (a != first);
  *n = d.n_out;
  *x = d.out;
  d.out = NULL;
done:
  free(d.sample);
  free(d.out);
  return st;
}
