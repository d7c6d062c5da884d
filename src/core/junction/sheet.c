/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Changes of the triangles at a curve. Corners are listed at their points. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "core/junction/junction_parts.h"

enum { RING = 96 }; /* most points of a polygon */
#define FLAT 1e-10  /* least height of a triangle over its longest edge */

static void link(struct vg_junction_sheet *s, uint32_t corner)
{
  const uint32_t p = s->m->tri[corner / 3][corner % 3];

  s->next[corner] = s->head[p];
  s->head[p] = corner;
}

static void unlink_corner(struct vg_junction_sheet *s, uint32_t corner)
{
  uint32_t *at = &s->head[s->m->tri[corner / 3][corner % 3]];

  while (*at != corner) {
    assert(*at != VG_JUNCTION_NONE);
    at = &s->next[*at];
  }
  *at = s->next[corner];
}

static void put(struct vg_junction_sheet *s, uint32_t t, uint32_t a, uint32_t b,
                uint32_t c)
{
  uint32_t *v = s->m->tri[t];

  v[0] = a;
  v[1] = b;
  v[2] = c;
  for (uint32_t k = 0; k < 3; k++) link(s, 3 * t + k);
}

static void take(struct vg_junction_sheet *s, uint32_t t)
{
  for (uint32_t k = 0; k < 3; k++) unlink_corner(s, 3 * t + k);
  memset(s->m->tri[t], 0, sizeof s->m->tri[t]);
}

vg_status vg_junction_sheet_open(struct vg_junction_sheet *s, struct vg_mesh *m,
                                 struct vg_error *err)
{
  s->m = m;
  s->cap[0] = s->cap_head = m->n_point;
  s->cap[1] = s->cap[2] = m->n_tri;
  s->cap_next = 3 * m->n_tri;
  s->head = vg_alloc(m->n_point, sizeof *s->head);
  s->next = vg_alloc(3 * m->n_tri, sizeof *s->next);
  if (!s->head || !s->next)
    return vg_fail_memory(err, "the junctions of inner surfaces");
  memset(s->head, 0xff, m->n_point * sizeof *s->head);
  for (uint32_t k = 0; k < 3 * m->n_tri; k++) link(s, k);
  return VG_OK;
}

void vg_junction_sheet_release(struct vg_junction_sheet *s)
{
  free(s->head);
  free(s->next);
  s->head = s->next = NULL;
}

/* The corner at a of the triangle with an edge from a to b. */
static uint32_t corner_of(const struct vg_junction_sheet *s, uint32_t a,
                          uint32_t b)
{
  uint32_t c = s->head[a];

  while (c != VG_JUNCTION_NONE && s->m->tri[c / 3][(c % 3 + 1) % 3] != b)
    c = s->next[c];
  return c;
}

static vg_status room(struct vg_junction_sheet *s, struct vg_error *err)
{
  struct vg_mesh *m = s->m;

  if (vg_reserve(&m->point, &s->cap[0], m->n_point + 1, sizeof *m->point) ||
      vg_reserve(&m->tri, &s->cap[1], m->n_tri + 2, sizeof *m->tri) ||
      vg_reserve(&m->tri_patch, &s->cap[2], m->n_tri + 2,
                 sizeof *m->tri_patch) ||
      vg_reserve(&s->head, &s->cap_head, m->n_point + 1, sizeof *s->head) ||
      vg_reserve(&s->next, &s->cap_next, 3 * (m->n_tri + 2), sizeof *s->next))
    return vg_fail_memory(err, "the junctions of inner surfaces");
  return VG_OK;
}

vg_status vg_junction_split(struct vg_junction_sheet *s, uint32_t a, uint32_t b,
                            const double x[3], uint32_t *made,
                            struct vg_error *err)
{
  struct vg_mesh *m = s->m;
  const uint32_t side[2] = { corner_of(s, a, b), corner_of(s, b, a) };
  const uint32_t p = (uint32_t)m->n_point;
  vg_status st = room(s, err);

  if (st < 0) return st;
  memcpy(m->point[m->n_point++], x, sizeof *m->point);
  s->head[p] = VG_JUNCTION_NONE;
  for (int k = 0; k < 2; k++) {
    const uint32_t c = side[k], t = c / 3, u = (uint32_t)m->n_tri;
    uint32_t v[3];

    if (c == VG_JUNCTION_NONE) continue;
    for (uint32_t i = 0; i < 3; i++) v[i] = m->tri[t][(c % 3 + i) % 3];
    take(s, t);
    m->tri_patch[u] = m->tri_patch[t];
    m->n_tri++;
    put(s, t, v[0], p, v[2]);
    put(s, u, p, v[1], v[2]);
  }
  *made = p;
  return VG_OK;
}

/* --- removal of a point ----------------------------------------------------
 */

/* The polygon that the triangles of a point form on one side of a curve,
 * counter-clockwise, and its new triangles. */
struct polygon {
  uint32_t n, n_tri, point[RING], old[RING];
  uint32_t tri[RING][3];
};

/* Triangles around v from that with an edge from v to `from` on, up to `to`.
 * Returns 0 if they do not lead there. Without such a triangle g is empty. */
static int gather(const struct vg_junction_sheet *s, uint32_t from, uint32_t v,
                  uint32_t to, struct polygon *g)
{
  uint32_t c = corner_of(s, v, from);

  g->n = g->n_tri = 0;
  if (c == VG_JUNCTION_NONE) return 1;
  g->point[g->n] = from;
  while (g->point[g->n] != to) {
    if (c == VG_JUNCTION_NONE || g->n + 2 >= RING) return 0;
    g->old[g->n++] = c / 3;
    g->point[g->n] = s->m->tri[c / 3][(c % 3 + 2) % 3];
    c = corner_of(s, v, g->point[g->n]);
  }
  g->n++;
  return 1;
}

static void normal(const struct vg_mesh *m, const uint32_t v[3], double n[3])
{
  double a[3], b[3];

  vg_sub(m->point[v[1]], m->point[v[0]], a);
  vg_sub(m->point[v[2]], m->point[v[0]], b);
  vg_cross(a, b, n);
}

static int has_edge(const struct vg_junction_sheet *s, uint32_t a, uint32_t b)
{
  return corner_of(s, a, b) != VG_JUNCTION_NONE ||
         corner_of(s, b, a) != VG_JUNCTION_NONE;
}

/* Height of a triangle over its longest edge, seen along the normal; 0 or less:
 * it faces away. */
static double shape_of(const struct vg_mesh *m, const uint32_t v[3],
                       const double up[3])
{
  double n[3], most = 0;

  normal(m, v, n);
  for (int e = 0; e < 3; e++)
    most = fmax(most, vg_distance2(m->point[v[e]], m->point[v[(e + 1) % 3]]));
  return most > 0 ? vg_dot(n, up) / most : 0;
}

/* The best triangles of parts of a polygon: from corner i to corner j > i and
 * back along a diagonal. */
struct division {
  double least[RING][RING];  /* Their least shape. */
  uint8_t third[RING][RING]; /* The third corner of the triangle on the
                                diagonal. */
};

static void choose(const struct vg_junction_sheet *s, const struct polygon *g,
                   const double up[3], uint32_t i, uint32_t j,
                   struct division *d)
{
  const int is_new = i > 0 || j + 1 < g->n;

  d->least[i][j] = 0;
  if (is_new && has_edge(s, g->point[i], g->point[j])) return;
  for (uint32_t k = i + 1; k < j; k++) {
    const uint32_t v[3] = { g->point[i], g->point[k], g->point[j] };
    const double least = fmin(shape_of(s->m, v, up),
                              fmin(d->least[i][k], d->least[k][j]));

    if (!(least > d->least[i][j])) continue;
    d->least[i][j] = least;
    d->third[i][j] = (uint8_t)k;
  }
}

static void take_part(const struct division *d, uint32_t i, uint32_t j,
                      struct polygon *g)
{
  const uint32_t k = d->third[i][j];
  uint32_t *v = g->tri[g->n_tri];

  if (j < i + 2) return;
  v[0] = g->point[i];
  v[1] = g->point[k];
  v[2] = g->point[j];
  g->n_tri++;
  take_part(d, i, k, g);
  take_part(d, k, j, g);
}

/* Divides the polygon into triangles of which the worst is as good as possible
 * (dynamic programming: Klincsek 1980). If none faces away, none overlap. */
static int divide(const struct vg_junction_sheet *s, struct polygon *g)
{
  double up[3] = { 0, 0, 0 }, own[3];
  struct division d;

  if (g->n < 3) return 1;
  for (uint32_t i = 0; i + 1 < g->n; i++) {
    normal(s->m, s->m->tri[g->old[i]], own);
    for (int k = 0; k < 3; k++) up[k] += own[k];
  }
  if (!(vg_unit(up) > 0)) return 0;
  for (uint32_t i = 0; i + 1 < g->n; i++) d.least[i][i + 1] = INFINITY;
  for (uint32_t span = 2; span < g->n; span++)
    for (uint32_t i = 0; i + span < g->n; i++)
      choose(s, g, up, i, i + span, &d);
  if (!(d.least[0][g->n - 1] > FLAT)) return 0;
  take_part(&d, 0, g->n - 1, g);
  return 1;
}

static uint32_t n_corner(const struct vg_junction_sheet *s, uint32_t v)
{
  uint32_t n = 0;

  for (uint32_t c = s->head[v]; c != VG_JUNCTION_NONE; c = s->next[c]) n++;
  return n;
}

int vg_junction_drop(struct vg_junction_sheet *s, uint32_t a, uint32_t v,
                     uint32_t b)
{
  struct polygon g[2];
  uint32_t n_old = 0;

  if (!gather(s, b, v, a, &g[0]) || !gather(s, a, v, b, &g[1])) return 0;
  for (int k = 0; k < 2; k++) n_old += g[k].n ? g[k].n - 1 : 0;
  if (n_old != n_corner(s, v) || a == b) return 0;
  /* The new edge from a to b must not be one of other triangles. */
  if (g[0].n != 2 && g[1].n != 2 && has_edge(s, a, b)) return 0;
  if (g[0].n == 2 && g[1].n == 2) return 0;
  if (!divide(s, &g[0]) || !divide(s, &g[1])) return 0;
  for (int k = 0; k < 2; k++)
    for (uint32_t i = 0; i + 1 < g[k].n; i++) take(s, g[k].old[i]);
  for (int k = 0; k < 2; k++)
    for (uint32_t i = 0; i < g[k].n_tri; i++)
      put(s, g[k].old[i], g[k].tri[i][0], g[k].tri[i][1], g[k].tri[i][2]);
  return 1;
}
