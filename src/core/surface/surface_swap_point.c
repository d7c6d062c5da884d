/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Removes points by collapsing a short edge into one of its ends. */
#include "core/surface/surface_swap_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"

#define RING 64 /* points with more edges stay */

/* The outgoing half-edges of a point, beginning with the one to collapse. */
struct ring {
  uint32_t half[RING];
  size_t n;
};

static const double *from(const struct vg_swapper *w, uint32_t h)
{
  return w->point[vg_swap_from(w, h)];
}

static double dot_of(const double *a, const double *b, const double n[3])
{
  return (b[0] - a[0]) * n[0] + (b[1] - a[1]) * n[1] + (b[2] - a[2]) * n[2];
}

static int collect(const struct vg_swapper *w, uint32_t h, struct ring *r)
{
  uint32_t i = h;

  r->n = 0;
  do {
    if (r->n == RING) return 0;
    r->half[r->n++] = i;
    i = vg_half_turn(w, i);
  } while (i != h);
  return 1;
}

/* Link condition: the ends share only the two nodes opposite the edge. */
static int link_fits(struct vg_swapper *w, const struct ring *a,
                     const struct ring *b)
{
  int n = 0;

  w->turn++;
  for (size_t i = 0; i < a->n; i++)
    w->mark[vg_swap_from(w, w->mate[a->half[i]])] = w->turn;
  for (size_t i = 0; i < b->n; i++)
    n += w->mark[vg_swap_from(w, w->mate[b->half[i]])] == w->turn;
  return n == 2;
}

static int between_patches(const struct vg_swapper *w, uint32_t h)
{
  return w->patch[h / 3] != w->patch[w->mate[h] / 3];
}

/* A point on a patch border may only move along that border, and must not be
 * far from it after the collapse. *by: its distance. */
static int edge_fits(const struct vg_swapper *w, const struct ring *r,
                     double *by)
{
  const double *a = from(w, r->half[0]), *b = from(w, w->mate[r->half[0]]);
  const double *x = NULL;
  size_t n = 0;
  struct vg_tri_shape s;
  double u[3];

  *by = 0;
  for (size_t i = 0; i < r->n; i++)
    if (between_patches(w, r->half[i])) {
      n++;
      if (i) x = from(w, w->mate[r->half[i]]);
    }
  if (!n) return 1;
  if (n != 2 || !between_patches(w, r->half[0])) return 0;
  for (int k = 0; k < 3; k++) u[k] = b[k] - a[k];
  if (!(dot_of(a, x, u) < 0)) return 0;
  vg_tri_shape_of(b, a, x, &s);
  *by = s.area / sqrt(vg_distance2(b, x));
  return 1;
}

/* Does the new triangle agree with the old one at i or, if that is a sliver,
 * with the triangle opposite? A sliver does not define the normal of the
 * surface. */
static int normal_fits(const struct vg_swapper *w, uint32_t i,
                       const struct vg_tri_shape *old,
                       const struct vg_tri_shape *now)
{
  uint32_t across = w->mate[vg_half_next(i)];
  struct vg_tri_shape s;

  if (vg_tri_shape_agree(w, old, now)) return 1;
  if (vg_tri_shape_sound(old) || w->patch[across / 3] != w->patch[i / 3])
    return 0;
  vg_tri_shape_of(from(w, across), from(w, vg_half_next(across)),
                  from(w, vg_half_prev(across)), &s);
  return vg_tri_shape_sound(&s) && vg_tri_shape_agree(w, &s, now);
}

/* Movement of the surface if the start of h is removed; INFINITY if it must
 * stay. */
static double price(struct vg_swapper *w, uint32_t h, double length)
{
  const double *a = from(w, h), *b = from(w, w->mate[h]);
  struct ring r, other;
  struct vg_tri_shape old, now;
  double worst = INFINITY, worst_now = INFINITY, by, most = 0;

  if (!collect(w, h, &r) || !collect(w, w->mate[h], &other) ||
      !edge_fits(w, &r, &by) || !link_fits(w, &r, &other))
    return INFINITY;
  for (size_t i = 0; i < r.n; i++) {
    const double *x = from(w, w->mate[r.half[i]]);
    const double *y = from(w, vg_half_prev(r.half[i]));

    if (w->locked[vg_swap_from(w, w->mate[r.half[i]])]) return INFINITY;
    vg_tri_shape_of(a, x, y, &old);
    worst = fmin(worst, old.sine2);
    most = fmax(most, w->moved[r.half[i] / 3]);
    if (i == 0 || i + 1 == r.n) continue;
    vg_tri_shape_of(b, x, y, &now);
    if (!normal_fits(w, r.half[i], &old, &now)) return INFINITY;
    worst_now = fmin(worst_now, now.sine2);
    by = fmax(by, fabs(dot_of(b, a, now.normal)) / now.area);
  }
  if (!(worst_now >= worst) || w->locked[vg_swap_from(w, h)]) return INFINITY;
  return by + most <= w->o->distance * length ? by + most : INFINITY;
}

/* Remove faces f and g at the half-edge; the other faces at its start use its
 * end instead. All surrounding edges are queued. */
static void collapse(struct vg_swapper *w, uint32_t f, double moved)
{
  uint32_t g = w->mate[f], f1 = vg_half_next(f), f2 = vg_half_next(f1);
  uint32_t g1 = vg_half_next(g), g2 = vg_half_next(g1);
  uint32_t a = vg_swap_from(w, f), b = vg_swap_from(w, g);
  struct ring r;

  collect(w, f, &r);
  for (size_t i = 1; i + 1 < r.n; i++) {
    uint32_t h = r.half[i];

    w->tri[h / 3][h % 3] = b;
    w->changed[h / 3] = 1;
    w->moved[h / 3] = moved;
  }
  vg_half_pair(w, w->mate[f1], w->mate[f2]);
  vg_half_pair(w, w->mate[g1], w->mate[g2]);
  for (size_t i = 1; i + 1 < r.n; i++) {
    vg_swap_push(w, r.half[i]);
    vg_swap_push(w, vg_half_next(r.half[i]));
    vg_swap_push(w, vg_half_prev(r.half[i]));
  }
  for (int k = 0; k < 3; k++) w->tri[f / 3][k] = w->tri[g / 3][k] = b;
  w->removed[a] = 1;
  w->n_collapsed++;
}

static int try_collapse(struct vg_swapper *w, uint32_t h, double length)
{
  double here = price(w, h, length), there = price(w, w->mate[h], length);
  double by = fmin(here, there);

  if (!(by < INFINITY)) return 0;
  collapse(w, here <= there ? h : w->mate[h], by);
  if (by > w->moved_max) w->moved_max = by;
  if (by > w->moved_relative * length) w->moved_relative = by / length;
  return 1;
}

/* Sum and number of the edges of each point. */
static void measure(const struct vg_swapper *w, double *sum, uint32_t *n)
{
  for (uint32_t h = 0; h < 3 * w->n_tri; h++) {
    if (vg_tri_removed(w, h / 3)) continue;
    sum[vg_swap_from(w, h)] += sqrt(
      vg_distance2(from(w, h), from(w, w->mate[h])));
    n[vg_swap_from(w, h)]++;
  }
}

/* A short side of a cap: swaps did not remove the cap, but its apex can be
 * collapsed. */
static int at_cap(const struct vg_swapper *w, uint32_t h)
{
  const double *a = from(w, h), *b = from(w, vg_half_next(h));
  struct vg_tri_shape s;

  vg_tri_shape_of(a, b, from(w, vg_half_prev(h)), &s);
  return vg_tri_shape_cap(&s) && vg_distance2(a, b) < s.longest2;
}

vg_status vg_swap_points(struct vg_swapper *w, size_t *n_removed,
                         struct vg_error *err)
{
  double *sum = vg_calloc(w->n_point, sizeof *sum);
  uint32_t *n = vg_calloc(w->n_point, sizeof *n);

  *n_removed = 0;
  if (!sum || !n) {
    free(sum);
    free(n);
    return vg_fail_memory(err, "the lengths of the edges");
  }
  measure(w, sum, n);
  for (uint32_t h = 0; h < 3 * w->n_tri; h++) {
    uint32_t a = vg_swap_from(w, h), b;
    double own, mean;

    if (vg_tri_removed(w, h / 3) || h > w->mate[h]) continue;
    b = vg_swap_from(w, w->mate[h]);
    own = sqrt(vg_distance2(w->point[a], w->point[b]));
    mean = (sum[a] + sum[b] - 2 * own) / (double)(n[a] + n[b] - 2);
    if (own < w->o->short_edge * mean || at_cap(w, h) || at_cap(w, w->mate[h]))
      *n_removed += (size_t)try_collapse(w, h, mean);
  }
  free(sum);
  free(n);
  return VG_OK;
}
