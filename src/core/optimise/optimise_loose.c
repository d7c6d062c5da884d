/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Smoothing of points among cells that are only listed, without links between
 * them. There are few such points, so each of them gets more steps than in a
 * sweep of the optimisation. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/checks.h"
#include "base/memory.h"
#include "core/optimise/optimise_ball.h"

/* Balls (cells around a point) of all points, one after the other. */
struct balls {
  uint32_t *slot; /* [t.n_point] index in the list, or VG_NONE */
  size_t *first;  /* [n + 2] */
  uint32_t *link; /* 4 * cell + index of the point */
};

static void balls_release(struct balls *b)
{
  free(b->slot);
  free(b->first);
  free(b->link);
}

/* Index in the list of the points that have a cell below the limit. */
static vg_status find_slots(const struct vg_tets *t, size_t n,
                            const uint32_t *point, float below, const float *q,
                            uint32_t *slot)
{
  uint8_t *wants = vg_calloc(t->n_point, 1);

  if (!wants) return VG_ERR_MEMORY;
  for (size_t c = 0; c < t->n_cell; c++)
    for (int i = 0; i < 4 && q[c] < below; i++) wants[t->cell[c].v[i]] = 1;
  memset(slot, 0xff, t->n_point * sizeof *slot);
  for (size_t k = 0; k < n; k++)
    if (wants[point[k]]) slot[point[k]] = (uint32_t)k;
  free(wants);
  return VG_OK;
}

static vg_status balls_new(const struct vg_tets *t, size_t n,
                           const uint32_t *point, float below, const float *q,
                           struct balls *b)
{
  b->slot = vg_alloc(t->n_point, sizeof *b->slot);
  b->first = vg_calloc(n + 2, sizeof *b->first);
  if (!b->slot || !b->first) return VG_ERR_MEMORY;
  if (find_slots(t, n, point, below, q, b->slot) < 0) return VG_ERR_MEMORY;
  for (size_t c = 0; c < t->n_cell; c++)
    for (int i = 0; i < 4; i++) {
      uint32_t k = b->slot[t->cell[c].v[i]];

      if (k != VG_NONE) b->first[k + 2]++;
    }
  for (size_t k = 0; k < n; k++) b->first[k + 2] += b->first[k + 1];
  b->link = vg_alloc(b->first[n + 1], sizeof *b->link);
  if (!b->link) return VG_ERR_MEMORY;
  for (uint32_t c = 0; c < t->n_cell; c++)
    for (uint32_t i = 0; i < 4; i++) {
      uint32_t k = b->slot[t->cell[c].v[i]];

      if (k != VG_NONE) b->link[b->first[k + 1]++] = 4 * c + i;
    }
  return VG_OK;
}

/* --- one point ------------------------------------------------------------ */

/* A position of a point, the shapes of the cells around it there, and the
 * rating: their sum plus the terms of vg_ball_other. */
struct stand {
  double x[3], q[VG_BALL_MAX], worst, sum;
  size_t at; /* index of the worst cell */
};

struct mover {
  struct vg_ball_faces faces;
  struct stand now;
};

static void weigh(struct stand *s, size_t n)
{
  s->worst = 2;
  s->sum = 0;
  s->at = 0;
  for (size_t k = 0; k < n; k++) {
    if (s->q[k] < s->worst) {
      s->worst = s->q[k];
      s->at = k;
    }
    s->sum += s->q[k];
  }
}

/* Points with a cell that is flat in plain arithmetic are left alone, because
 * the sign of its volume is unreliable. */
static int take_ball(struct mover *m, const struct vg_tets *t, size_t n,
                     const uint32_t *link, uint32_t p, float below,
                     const struct vg_sizing *sizing, const float *q)
{
  if (!n || n > VG_BALL_MAX) return 0;
  for (size_t k = 0; k < n; k++) m->now.q[k] = q[link[k] >> 2];
  weigh(&m->now, n);
  if (m->now.worst <= VG_SHAPE_FLAT || m->now.worst >= (double)below) return 0;
  vg_ball_faces(t, n, link, &m->faces);
  vg_ball_target(sizing, t->x[p], &m->faces);
  memcpy(m->now.x, t->x[p], sizeof m->now.x);
  m->now.sum += vg_ball_other(&m->faces, m->now.x);
  return 1;
}

/* Move to x + length g if that is better: the worst shape improves, or it is
 * at least the target shape and the rating improves. */
static int move(struct mover *m, const double g[3], double length)
{
  const double aim = VG_SHAPE_TARGET;
  struct stand to;

  for (int a = 0; a < 3; a++) to.x[a] = m->now.x[a] + length * g[a];
  if (!vg_ball_shapes(&m->faces, to.x, m->now.worst < aim ? m->now.worst : aim,
                      to.q))
    return 0;
  weigh(&to, m->faces.n);
  to.sum += vg_ball_other(&m->faces, to.x);
  if (to.worst < aim
        ? to.worst <= m->now.worst * VG_GAIN_WORST + VG_SHAPE_FLAT
        : m->now.worst >= aim && to.sum <= m->now.sum * VG_GAIN_SUM)
    return 0;
  m->now = to;
  return 1;
}

/* K40: steps along the gradient of all cells, relative to an edge length. */
#define ALL_FIRST 0.05
#define ALL_LEAST 0.015

/* Step along the gradient g by a fraction of an edge. */
static int climb(struct mover *m, const double g[3], double share, double least)
{
  const struct stand *s = &m->now;
  double size, edge2 = 0;

  for (int a = 0; a < 3; a++) {
    double d = m->faces.x[0][a][s->at] - s->x[a];

    edge2 += d * d;
  }
  size = g[0] * g[0] + g[1] * g[1] + g[2] * g[2];
  if (!(size > 0)) return 0;
  for (; share > least; share *= VG_CLIMB_NEXT)
    if (move(m, g, share * sqrt(edge2 / size))) return 1;
  return 0;
}

/* Move towards the ideal position for all cells, then along the gradient of
 * the worst cell if that is bad, and along the gradient of all cells. The
 * latter uses logarithms, in which bad cells have the largest weight, and
 * target lengths. */
static int improve(struct mover *m)
{
  double to[3], g[3];
  int better = 0;

  vg_ball_ideal(&m->faces, m->now.q, m->now.x, to);
  for (int a = 0; a < 3; a++) g[a] = to[a] - m->now.x[a];
  for (double share = 1; share > VG_SHARE_LEAST && !better; share *= 0.5)
    better = move(m, g, share);
  for (int k = 0; k < 4 && m->now.worst < VG_SHAPE_TARGET; k++) {
    vg_ball_slope_of(&m->faces, m->now.at, m->now.x, g);
    if (!climb(m, g, VG_CLIMB_FIRST, VG_CLIMB_LEAST)) return better;
    better = 1;
  }
  for (int k = 0; k < 2; k++) {
    vg_ball_slope(&m->faces, m->now.x, g);
    if (!climb(m, g, ALL_FIRST, ALL_LEAST)) return better;
    better = 1;
  }
  return better;
}

/* Smooth a point among Euclidean shapes. Returns 1 if it moves. */
static int smooth(struct mover *m, struct vg_tets *t, uint32_t p, size_t n,
                  const uint32_t *link, float below,
                  const struct vg_sizing *sizing, float *q)
{
  if (!take_ball(m, t, n, link, p, below, sizing, q) || !improve(m)) return 0;
  memcpy(t->x[p], m->now.x, sizeof m->now.x);
  for (size_t c = 0; c < n; c++) q[link[c] >> 2] = (float)m->now.q[c];
  return 1;
}

/* K50: largest number of moves of one point in a metric. A point whose last
 * move decreased the function by this share or less is not moved again. */
enum { MOVES_IN_METRIC = 4 };
static const double enough = 0.02;

/* The same in metrics. */
static int smooth_in_metric(struct mover *m, struct vg_tets *t, uint32_t p,
                            size_t n, const uint32_t *link, float below,
                            struct vg_metrics *metrics, float *q)
{
  float worst = 2;
  double gain = 1;
  int moves;

  if (!n || n > VG_BALL_MAX) return 0;
  for (size_t c = 0; c < n; c++) worst = fminf(worst, q[link[c] >> 2]);
  if (worst >= below) return 0;
  for (moves = 0; moves < MOVES_IN_METRIC && gain > enough; moves++) {
    gain = vg_move_in_metric(t, metrics, p, n, link, m->now.q);
    if (!(gain > 0)) break;
    for (size_t c = 0; c < n; c++) q[link[c] >> 2] = (float)m->now.q[c];
  }
  return moves > 0;
}

vg_status vg_optimise_points(struct vg_tets *t, size_t n, const uint32_t *point,
                             float below, const struct vg_sizing *sizing,
                             struct vg_metrics *metrics, float *q,
                             struct vg_optimise_report *report,
                             struct vg_error *err)
{
  assert((point || !n) && (q || !t->n_cell) && report);

  struct mover *m = vg_alloc(1, sizeof *m);
  struct balls b = { NULL, NULL, NULL };
  vg_status st = VG_OK;

  memset(report, 0, sizeof *report);
  if (!m || balls_new(t, n, point, below, q, &b) < 0)
    st = vg_fail_memory(err, "optimisation");
  for (size_t k = 0; st == VG_OK && k < n; k++) {
    const uint32_t *link = b.link + b.first[k];
    size_t n_cell = b.first[k + 1] - b.first[k];

    report->n_smoothed += (size_t)(metrics
                                     ? smooth_in_metric(m, t, point[k], n_cell,
                                                        link, below, metrics, q)
                                     : smooth(m, t, point[k], n_cell, link,
                                              below, sizing, q));
  }
  VG_CHECK("the smoothing of points", vg_tets_inverted(t));
  balls_release(&b);
  free(m);
  return st;
}
