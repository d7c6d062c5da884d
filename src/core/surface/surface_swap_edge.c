/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Edge swaps. The smallest angle of the two triangles grows with every swap,
 * hence also the sorted list of all smallest angles, so that the process
 * terminates. */
#include "core/surface/surface_swap_parts.h"

#include <assert.h>
#include <math.h>

#include "core/geometry/vector.h"

/* Least gain of the squared sine: rounding, and the equal diagonals of a
 * square, must not count as a gain. */
#define GAIN 1.01 /* S3 */

/* Pairs without a cap may use this fraction of the distance only: they gain
 * less, and on a curved surface the movements of all of them add up. */
#define GOOD 0.3

static const double *at(const struct vg_swapper *w, uint32_t p)
{
  return w->point[p];
}

void vg_tri_shape_of(const double *a, const double *b, const double *c,
                     struct vg_tri_shape *s)
{
  double u[3], v[3], uu, vv, ww = vg_distance2(c, b);

  vg_sub(b, a, u);
  vg_sub(c, a, v);
  uu = vg_dot(u, u);
  vv = vg_dot(v, v);
  vg_cross(u, v, s->normal);
  s->area = vg_norm(s->normal);
  s->longest2 = uu > vv ? uu : vv;
  s->shortest2 = uu > vv ? vv : uu;
  s->middle2 = ww;
  if (ww > s->longest2) {
    s->middle2 = s->longest2;
    s->longest2 = ww;
  } else if (ww < s->shortest2) {
    s->middle2 = s->shortest2;
    s->shortest2 = ww;
  }
  s->sine2 = s->area > 0 ? s->area / s->longest2 * (s->area / s->middle2) : 0;
}

int vg_tri_shape_agree(const struct vg_swapper *w, const struct vg_tri_shape *a,
                       const struct vg_tri_shape *b)
{
  double dot = vg_dot(a->normal, b->normal);

  return dot > 0 && dot >= w->cosine * a->area * b->area;
}

void vg_swap_push(struct vg_swapper *w, uint32_t h)
{
  size_t end;

  assert(h < 3 * w->n_tri);
  if (w->queued[h] || w->queued[w->mate[h]]) return;
  end = w->head + w->n_queue++;
  if (end >= 3 * w->n_tri) end -= 3 * w->n_tri;
  w->queue[end] = h;
  w->queued[h] = 1;
}

static uint32_t pop(struct vg_swapper *w)
{
  uint32_t h = w->queue[w->head++];

  if (w->head == 3 * w->n_tri) w->head = 0;
  w->n_queue--;
  w->queued[h] = 0;
  return h;
}

/* Are the start nodes of c and d connected by an edge? Searches around both
 * nodes in step, so that a node with very many edges costs no more than the
 * other one. */
static int joined(const struct vg_swapper *w, uint32_t c, uint32_t d)
{
  uint32_t from_c = vg_swap_from(w, c), from_d = vg_swap_from(w, d);
  uint32_t i = c, j = d;

  do {
    i = vg_half_turn(w, i);
    j = vg_half_turn(w, j);
    if (vg_swap_from(w, w->mate[i]) == from_d ||
        vg_swap_from(w, w->mate[j]) == from_c)
      return 1;
  } while (i != c && j != d);
  return 0;
}

/* Distance of the lines a b and c d. For a convex quadrilateral it is the
 * movement of the surface when one diagonal replaces the other. */
static double distance(const double *a, const double *b, const double *c,
                       const double *d)
{
  double u[3], v[3], x[3], y[3], size;

  vg_sub(b, a, u);
  vg_sub(d, c, v);
  vg_sub(c, a, y);
  vg_cross(u, v, x);
  size = vg_dot(x, x);
  return size > 0 ? fabs(vg_dot(x, y)) / sqrt(size) : INFINITY;
}

/* Compare new normals with those of the old pair. The larger old triangle
 * defines the normal of the surface; the other one counts only if it is not a
 * sliver. */
static int normals_fit(const struct vg_swapper *w,
                       const struct vg_tri_shape before[2],
                       const struct vg_tri_shape after[2])
{
  int big = before[1].area > before[0].area;
  int both = vg_tri_shape_sound(&before[!big]);

  if (both && !vg_tri_shape_agree(w, &before[0], &before[1])) return 0;
  for (int i = 0; i < 2; i++) {
    if (!vg_tri_shape_agree(w, &after[i], &before[big])) return 0;
    if (both && !vg_tri_shape_agree(w, &after[i], &before[!big])) return 0;
  }
  return 1;
}

/* Faces f = a b c and g = b a d become d c a and c d b. A half-edge keeps its
 * place unless it is one of the two that move to the other face. */
static void swap(struct vg_swapper *w, uint32_t f, uint32_t g, uint32_t c,
                 uint32_t d)
{
  uint32_t f1 = vg_half_next(f), f2 = vg_half_next(f1);
  uint32_t g1 = vg_half_next(g), g2 = vg_half_next(g1);
  uint32_t a = vg_swap_from(w, f), b = vg_swap_from(w, g);
  uint32_t bc = w->mate[f1], ca = w->mate[f2];
  uint32_t ad = w->mate[g1], db = w->mate[g2];

  w->tri[f / 3][f % 3] = d;
  w->tri[f / 3][f1 % 3] = c;
  w->tri[f / 3][f2 % 3] = a;
  w->tri[g / 3][g % 3] = c;
  w->tri[g / 3][g1 % 3] = d;
  w->tri[g / 3][g2 % 3] = b;
  vg_half_pair(w, f1, ca);
  vg_half_pair(w, f2, ad);
  vg_half_pair(w, g1, db);
  vg_half_pair(w, g2, bc);
  vg_swap_push(w, f1);
  vg_swap_push(w, f2);
  vg_swap_push(w, g1);
  vg_swap_push(w, g2);
}

/* Add the movement to the two faces if it is within the limit. */
static int may_move(struct vg_swapper *w, size_t s, size_t t, double by,
                    double length)
{
  double sum = by + (w->moved[s] > w->moved[t] ? w->moved[s] : w->moved[t]);

  if (!(sum <= w->o->distance * length)) return 0;
  w->moved[s] = w->moved[t] = sum;
  if (sum > w->moved_max) w->moved_max = sum;
  if (sum > w->moved_relative * length) w->moved_relative = sum / length;
  return 1;
}

/* Reference length for the permitted movement of a pair. A cap cannot move by
 * more than its height. Two needles of a narrow strip could move by a large
 * part of its width if their length were used. */
static double length_of(const struct vg_tri_shape pair[2])
{
  if (vg_tri_shape_cap(&pair[0]) || vg_tri_shape_cap(&pair[1]))
    return sqrt(fmin(pair[0].longest2, pair[1].longest2));
  return GOOD * sqrt(fmin(pair[0].shortest2, pair[1].shortest2));
}

static void try_swap(struct vg_swapper *w, uint32_t f)
{
  uint32_t g = w->mate[f];
  uint32_t a = vg_swap_from(w, f), b = vg_swap_from(w, g);
  uint32_t hc = vg_half_prev(f), hd = vg_half_prev(g);
  uint32_t c = vg_swap_from(w, hc), d = vg_swap_from(w, hd);
  struct vg_tri_shape before[2], after[2];

  if (w->patch[f / 3] != w->patch[g / 3] || c == d || w->locked[a] ||
      w->locked[b] || w->locked[c] || w->locked[d])
    return;
  vg_tri_shape_of(at(w, a), at(w, b), at(w, c), &before[0]);
  vg_tri_shape_of(at(w, b), at(w, a), at(w, d), &before[1]);
  if (w->caps_only && !vg_tri_shape_cap(&before[0]) &&
      !vg_tri_shape_cap(&before[1]))
    return;
  vg_tri_shape_of(at(w, a), at(w, d), at(w, c), &after[0]);
  vg_tri_shape_of(at(w, d), at(w, b), at(w, c), &after[1]);
  if (!(fmin(after[0].sine2, after[1].sine2) >
        GAIN * fmin(before[0].sine2, before[1].sine2)) ||
      !normals_fit(w, before, after) || joined(w, hc, hd))
    return;
  if (!may_move(w, f / 3, g / 3,
                distance(at(w, a), at(w, b), at(w, c), at(w, d)),
                length_of(before)))
    return;
  w->changed[f / 3] = w->changed[g / 3] = 1;
  w->n_swapped++;
  swap(w, f, g, c, d);
}

void vg_swap_edges(struct vg_swapper *w)
{
  while (w->n_queue) {
    uint32_t h = pop(w);

    if (!vg_tri_removed(w, h / 3)) try_swap(w, h);
  }
}
