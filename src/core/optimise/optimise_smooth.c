/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Smoothing: a point moves within its ball if the worst cell around it
 * improves, or, if all of them are good already, if their mean improves.
 * Targets are the volume-weighted mean of the cells' centroids, which evens
 * out sizes and shapes together (Chen, "Mesh smoothing schemes based on
 * optimal Delaunay triangulations", 2004), then steps along the gradient of
 * the worst cell. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "core/geometry/vector.h"
#include "core/optimise/optimise_ball.h"

struct ball_state {
  double worst, sum;
};

/* A point that is smoothed: the faces around it, and the shapes of the cells
 * at the position that is tried. */
struct mover {
  struct vg_ball_faces faces;
  double q[VG_BALL_MAX];
};

/* Shapes of the cells around the point at x. Returns 0 as soon as one is not
 * above `stop`. */
static int try_at(struct mover *m, const double x[3], double stop,
                  struct ball_state *s)
{
  s->worst = 2;
  s->sum = 0;
  if (!vg_ball_shapes(&m->faces, x, stop, m->q)) return 0;
  for (size_t k = 0; k < m->faces.n; k++) {
    if (m->q[k] < s->worst) s->worst = m->q[k];
    s->sum += m->q[k];
  }
  return 1;
}

/* Move the worst cell to the front of the ball, where it rejects positions
 * soonest. */
static void present(struct vg_optimiser *o, struct ball_state *s)
{
  size_t worst = 0;
  uint32_t first;

  s->worst = 2;
  s->sum = 0;
  for (size_t k = 0; k < o->n_ball; k++) {
    double q = o->q[o->ball[k] >> 2];

    if (q < s->worst) {
      s->worst = q;
      worst = k;
    }
    s->sum += q;
  }
  first = o->ball[worst];
  o->ball[worst] = o->ball[0];
  o->ball[0] = first;
}

static void keep(struct vg_optimiser *o, uint32_t p, const double x[3],
                 const double *q)
{
  memcpy(o->t->x[p], x, 3 * sizeof *x);
  for (size_t k = 0; k < o->n_ball; k++) {
    o->q[o->ball[k] >> 2] = (float)q[k];
    vg_changed(o, o->ball[k] >> 2);
  }
  o->report->n_smoothed++;
}

/* Gradient of the worst cell's shape, by central differences. */
static double gradient(const struct vg_optimiser *o, uint32_t p, size_t worst,
                       double step, double g[3])
{
  const struct vg_tets *t = o->t;
  const uint32_t *v = t->cell[o->ball[worst] >> 2].v;
  const uint8_t *f = vg_face[o->ball[worst] & 3];
  double length = 0;

  for (int i = 0; i < 3; i++) {
    double x[3], up;

    memcpy(x, t->x[p], sizeof x);
    x[i] += step;
    up = vg_shape(t->x[v[f[0]]], t->x[v[f[1]]], t->x[v[f[2]]], x);
    x[i] -= 2 * step;
    g[i] = up - vg_shape(t->x[v[f[0]]], t->x[v[f[1]]], t->x[v[f[2]]], x);
    length += g[i] * g[i];
  }
  return sqrt(length);
}

/* K40: smallest step next to a flat cell, and half the width of the
 * differences, relative to an edge length. */
#define STEP_FLAT 1e-5
#define DIFFERENCE 1e-3

/* Next to a flat cell much smaller steps help, too, since any positive sign is
 * a gain. */
static int climb(struct vg_optimiser *o, uint32_t p, struct mover *m,
                 struct ball_state *now)
{
  const double least = now->worst < VG_SHAPE_FLAT ? STEP_FLAT : VG_CLIMB_LEAST;
  size_t worst = 0;
  double g[3], length, scale = 0, x[3];
  const double *other;
  struct ball_state s;

  for (size_t k = 1; k < o->n_ball; k++)
    if (o->q[o->ball[k] >> 2] < o->q[o->ball[worst] >> 2]) worst = k;
  other =
    o->t->x[o->t->cell[o->ball[worst] >> 2].v[vg_face[o->ball[worst] & 3][0]]];
  for (int i = 0; i < 3; i++) {
    double d = other[i] - o->t->x[p][i];

    scale += d * d;
  }
  scale = sqrt(scale);
  length = gradient(o, p, worst, DIFFERENCE * scale, g);
  if (!(length > 0)) return 0;
  for (double step = VG_CLIMB_FIRST; step > least; step *= VG_CLIMB_NEXT) {
    for (int i = 0; i < 3; i++)
      x[i] = o->t->x[p][i] + g[i] / length * step * scale;
    if (!try_at(m, x, now->worst * VG_GAIN_WORST + VG_SHAPE_FLAT, &s)) continue;
    keep(o, p, x, m->q);
    *now = s;
    return 1;
  }
  return 0;
}

static int smooth_ball(struct vg_optimiser *o, uint32_t p, double aim)
{
  struct mover m;
  struct ball_state now, s;
  double to[3], x[3], stop;
  int better = 0;

  present(o, &now);
  vg_ball_faces(o->t, o->n_ball, o->ball, &m.faces);
  vg_ball_centre(&m.faces, o->t->x[p], to);
  for (double share = 1; share > VG_SHARE_LEAST && !better; share *= 0.5) {
    for (int i = 0; i < 3; i++)
      x[i] = o->t->x[p][i] + share * (to[i] - o->t->x[p][i]);
    stop = now.worst < aim ? now.worst : aim;
    if (!try_at(&m, x, stop, &s)) continue;
    if (s.worst < aim ? s.worst > now.worst * VG_GAIN_WORST + VG_SHAPE_FLAT
                      : now.worst < aim || s.sum > now.sum * VG_GAIN_SUM) {
      keep(o, p, x, m.q);
      now = s;
      better = 1;
    }
  }
  for (int k = 0; k < 4 && now.worst < aim && climb(o, p, &m, &now); k++)
    better = 1;
  return better;
}

int vg_smooth(struct vg_optimiser *o, uint32_t p, double aim)
{
  assert(p < o->t->n_point && aim >= 0);
  if (p < o->n_fixed || o->failed[p] & VG_FAILED_SMOOTH || !vg_ball(o, p))
    return 0;
  if (o->metrics ? vg_smooth_metric(o, p) : smooth_ball(o, p, aim)) return 1;
  o->failed[p] |= VG_FAILED_SMOOTH;
  return 0;
}

int vg_smooth_within(struct vg_optimiser *o, const struct vg_balls *b,
                     uint32_t p, double aim)
{
  assert(p < o->t->n_point && aim >= 0);
  size_t n = b->first[p + 1] - b->first[p];

  if (p < o->n_fixed || o->failed[p] & VG_FAILED_SMOOTH || b->is_open[p] ||
      !n || n > VG_BALL_MAX)
    return 0;
  o->n_ball = n;
  memcpy(o->ball, b->link + b->first[p], n * sizeof *o->ball);
  if (o->metrics ? vg_smooth_metric(o, p) : smooth_ball(o, p, aim)) return 1;
  o->failed[p] |= VG_FAILED_SMOOTH;
  return 0;
}
