/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Front point placement in a Delaunay triangulation (Rebay, "Efficient
 * unstructured mesh generation by means of Delaunay triangulation and
 * Bowyer-Watson algorithm", J. Comput. Phys. 106, 1993). The front separates
 * triangles of the target size (done) from triangles that are too large. The
 * point for a front edge is placed on the dual Voronoi segment, no farther than
 * the circumcentre, so that no vertex is nearer to it than the ends of the
 * edge. */
#include "core/domain/planar_front.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/buckets.h"
#include "base/memory.h"
#include "core/geometry/predicates.h"

/* A triangle is done if its circumradius is below this factor times its target
 * edge length. The ratio is 1 / sqrt(3) for an equilateral triangle of the
 * target size. */
#define DONE_RADIUS 0.80 /* S6 */
/* A new point must not see a fixed edge under an angle with a cosine below this
 * (110 degrees): the flat triangle would remain, since fixed edges are never
 * split. */
#define FLAT_COSINE (-0.342)

/* One list per octave of the length of the front edge: shortest octave first,
 * and first in, first out within a list, so that a uniform front advances in
 * uniform rows. The octaves are centred on the shortest boundary segment: if
 * all edges are about as long as the boundary segments, they are in one
 * list. */
enum { N_BUCKET = 2200, BUCKET_ZERO = 1100 };

struct entry {
  uint32_t face, stamp;
};

struct front {
  struct vg_tri2 *t;
  const struct vg_planar_law *law;
  struct entry *entry; /* [n] Items of the queue. */
  uint32_t *free;      /* [n_free] Entries no longer in the queue. */
  size_t n, cap, n_free, cap_free;
  struct vg_buckets queue;
  double scale;
};

static double distance(const double a[2], const double b[2])
{
  const double dx = a[0] - b[0], dy = a[1] - b[1];

  return sqrt(dx * dx + dy * dy);
}

/* Returns the circumradius and sets the centre. INFINITY for a degenerate
 * triangle. */
static double circumcircle(const double a[2], const double b[2],
                           const double c[2], double centre[2])
{
  const double bx = b[0] - a[0], by = b[1] - a[1];
  const double cx = c[0] - a[0], cy = c[1] - a[1];
  const double d = 2 * (bx * cy - by * cx);
  const double bb = bx * bx + by * by, cc = cx * cx + cy * cy;
  double ux, uy;

  if (!(d > 0)) {
    centre[0] = a[0];
    centre[1] = a[1];
    return INFINITY;
  }
  ux = (cy * bb - by * cc) / d;
  uy = (bx * cc - cx * bb) / d;
  centre[0] = a[0] + ux;
  centre[1] = a[1] + uy;
  return sqrt(ux * ux + uy * uy);
}

static int is_done(const struct vg_tri2 *t, uint32_t at)
{
  const uint32_t *v = t->face[at].v;
  const double h = (t->h[v[0]] + t->h[v[1]] + t->h[v[2]]) / 3;
  double centre[2];

  return circumcircle(t->x[v[0]], t->x[v[1]], t->x[v[2]], centre) <
         DONE_RADIUS * h;
}

/* Shortest front edge of an unfinished triangle; NONE if it has no front
 * edge. */
static uint32_t front_edge(const struct vg_tri2 *t, uint32_t at, double *len)
{
  uint32_t best = VG_T2_NONE;

  *len = INFINITY;
  for (uint32_t k = 0; k < 3; k++) {
    const uint32_t e = 4 * at + k, o = vg_t2_twin(t, e);
    double l;

    if (!vg_t2_is_fixed(t, e) && o != VG_T2_NONE &&
        !(t->face[o >> 2].flag & VG_T2_DONE))
      continue;
    l = distance(t->x[vg_t2_from(t, e)], t->x[vg_t2_to(t, e)]);
    if (l < *len) {
      *len = l;
      best = e;
    }
  }
  return best;
}

static int push(struct front *f, uint32_t at)
{
  double len;
  int octave;
  uint32_t slot;

  if (front_edge(f->t, at, &len) == VG_T2_NONE) return 0;
  frexp(len * f->scale, &octave);
  if (f->n_free) {
    slot = f->free[--f->n_free];
  } else {
    if (f->n >= VG_T2_NONE - 1 ||
        vg_reserve(&f->entry, &f->cap, f->n + 1, sizeof *f->entry) ||
        vg_reserve(&f->free, &f->cap_free, f->n + 1, sizeof *f->free) ||
        vg_buckets_reserve(&f->queue, f->n + 1))
      return -1;
    slot = (uint32_t)f->n++;
  }
  f->entry[slot] = (struct entry){ at, f->t->face[at].stamp };
  vg_buckets_push(&f->queue, octave + BUCKET_ZERO, slot);
  return 0;
}

/* The next unfinished triangle in the queue; NONE if the queue is empty. */
static uint32_t pop(struct front *f)
{
  uint32_t slot;

  while ((slot = vg_buckets_pop(&f->queue)) != VG_BUCKETS_NONE) {
    const struct entry e = f->entry[slot];

    f->free[f->n_free++] = slot;
    if (f->t->face[e.face].stamp == e.stamp &&
        !(f->t->face[e.face].flag & (VG_T2_DONE | VG_T2_DEAD)))
      return e.face;
  }
  return VG_T2_NONE;
}

/* Target edge length at x, with its gradient relative to the corners of
 * triangle `at` limited to VG_T2_GROWTH. */
static double target(const struct front *f, const double x[2], uint32_t at)
{
  const struct vg_tri2 *t = f->t;
  const uint32_t *v = t->face[at].v;
  double lo = 0, hi = INFINITY, h = f->law->at(f->law->user, x);

  for (int k = 0; k < 3; k++) {
    const double reach = VG_T2_GROWTH * distance(x, t->x[v[k]]);

    if (t->h[v[k]] + reach < hi) hi = t->h[v[k]] + reach;
    if (t->h[v[k]] - reach > lo) lo = t->h[v[k]] - reach;
  }
  if (!(h <= hi && h > 0)) h = hi;
  return h < lo ? lo < hi ? lo : hi : h;
}

/* Place the point for front edge e in x. Returns its target edge length. */
static double place(const struct front *f, uint32_t e, double x[2])
{
  const struct vg_tri2 *t = f->t;
  const uint32_t ia = vg_t2_from(t, e), ib = vg_t2_to(t, e);
  const double *a = t->x[ia], *b = t->x[ib], *c = t->x[vg_t2_apex(t, e)];
  const double len = distance(a, b), hab = 0.5 * (t->h[ia] + t->h[ib]);
  const double mid[2] = { 0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]) };
  const double n[2] = { (a[1] - b[1]) / len, (b[0] - a[0]) / len };
  double centre[2], far, h = hab;

  circumcircle(a, b, c, centre);
  far = (centre[0] - mid[0]) * n[0] + (centre[1] - mid[1]) * n[1];
  for (int step = 0; step < 2; step++) {
    const double side = 0.5 * (hab + h) < 0.75 * len ? 0.75 * len
                                                     : 0.5 * (hab + h);
    double d = sqrt(side * side - 0.25 * len * len);

    if (!(d <= far)) d = far;
    x[0] = mid[0] + d * n[0];
    x[1] = mid[1] + d * n[1];
    h = target(f, x, e >> 2);
  }
  return h;
}

/* Would x create a flat triangle on a fixed edge of its cavity? */
static int is_flat(const struct vg_tri2 *t, const double x[2])
{
  for (size_t i = 0; i < t->n_border; i++) {
    const double *a = t->x[t->border[i].a], *b = t->x[t->border[i].b];
    double ax, ay, bx, by, dot;

    if (!t->border[i].constrained) continue;
    ax = a[0] - x[0], ay = a[1] - x[1];
    bx = b[0] - x[0], by = b[1] - x[1];
    dot = ax * bx + ay * by;
    if (dot < 0 &&
        dot < FLAT_COSINE * sqrt(ax * ax + ay * ay) * sqrt(bx * bx + by * by))
      return 1;
  }
  return 0;
}

/* Mark new triangles as done or queue them, and queue neighbours that are now
 * on the front. */
static int classify(struct front *f)
{
  struct vg_tri2 *t = f->t;
  const size_t n = t->n_border;

  for (size_t i = 0; i < n; i++)
    if (is_done(t, t->cavity[i])) t->face[t->cavity[i]].flag |= VG_T2_DONE;
  for (size_t i = 0; i < n; i++) {
    const uint32_t at = t->cavity[i], out = t->border[i].outer;

    if (!(t->face[at].flag & VG_T2_DONE)) {
      if (push(f, at)) return -1;
    } else if (out != VG_T2_NONE && !t->border[i].constrained &&
               !(t->face[out >> 2].flag & VG_T2_DONE) && push(f, out >> 2))
      return -1;
  }
  return 0;
}

/* Returns 1 if x was inserted, 0 if it cannot be inserted here, -1 without
 * memory. */
static int insert(struct front *f, const double x[2], double h)
{
  struct vg_tri2 *t = f->t;
  const uint32_t in = vg_tri2_locate(t, x, 1);
  uint32_t p;
  int ok;

  if (in == VG_T2_NONE) return 0;
  ok = vg_tri2_cavity(t, x, in);
  if (ok != 1 || is_flat(t, x)) {
    vg_tri2_cancel(t);
    return ok < 0 ? -1 : 0;
  }
  p = vg_tri2_add_point(t, x, h);
  if (p == VG_T2_NONE || vg_tri2_commit(t, p, VG_T2_INSIDE) || classify(f))
    return -1;
  return 1;
}

/* Mark a triangle as done although it is too large: its neighbours are then on
 * the front. */
static int give_up(struct front *f, uint32_t at)
{
  f->t->face[at].flag |= VG_T2_DONE;
  for (int k = 0; k < 3; k++) {
    const uint32_t o = f->t->face[at].adj[k];

    if (o != VG_T2_NONE && !vg_t2_is_fixed(f->t, 4 * at + (uint32_t)k) &&
        !(f->t->face[o >> 2].flag & VG_T2_DONE) && push(f, o >> 2))
      return -1;
  }
  return 0;
}

static int advance(struct front *f)
{
  size_t n_step = 0;

  for (uint32_t at; (at = pop(f)) != VG_T2_NONE;) {
    double x[2], len, h;
    const uint32_t e = front_edge(f->t, at, &len);
    int ok;

    if (vg_tri2_stops(f->law, n_step++)) return 1;
    if (e == VG_T2_NONE) continue;
    h = place(f, e, x);
    f->t->walk = at;
    ok = insert(f, x, h);
    if (ok < 0 || (ok == 0 && give_up(f, at))) return -1;
  }
  return 0;
}

static double shortest_fixed(const struct vg_tri2 *t)
{
  double least = INFINITY;

  for (uint32_t i = 0; i < t->n_face; i++)
    for (uint32_t e = 4 * i; e < 4 * i + 3; e++)
      if (!(t->face[i].flag & VG_T2_DEAD) && vg_t2_is_fixed(t, e))
        least = fmin(least,
                     distance(t->x[vg_t2_from(t, e)], t->x[vg_t2_to(t, e)]));
  return least;
}

int vg_tri2_fill(struct vg_tri2 *t, const struct vg_planar_law *law)
{
  assert(law->at);

  struct front f = { .t = t,
                     .law = law,
                     .scale = 1.41421356 / shortest_fixed(t) };
  int bad = vg_buckets_init(&f.queue, N_BUCKET);

  for (uint32_t i = 0; i < t->n_face; i++)
    if (!(t->face[i].flag & VG_T2_DEAD) && is_done(t, i))
      t->face[i].flag |= VG_T2_DONE;
  for (uint32_t i = 0; !bad && i < t->n_face; i++)
    if (!(t->face[i].flag & (VG_T2_DEAD | VG_T2_DONE))) bad = push(&f, i);
  if (!bad) bad = advance(&f);
  vg_buckets_release(&f.queue);
  free(f.entry);
  free(f.free);
  return bad;
}
