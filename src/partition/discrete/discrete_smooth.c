/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Smooths interfaces: a point moves towards the mean of its neighbours on the
 * interfaces or, on a curve where subdomains meet, of its neighbours on the
 * curve, as long as the coarse cells stay good. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/shape.h"
#include "core/geometry/vector.h"
#include "partition/discrete/discrete_parts.h"

enum { SWEEPS = 8, TRIES = 3 };
/* Fractions of the way to the mean: forwards, then backwards by slightly more,
 * which removes roughness without shrinking round shapes. Otherwise an inner
 * subdomain would lose cells to those around it. After Taubin, "A signal
 * processing approach to fair surface design", SIGGRAPH 1995. */
static const double share[2] = { 0.6, -0.63 }; /* D6 */
/* A cell must not get worse than this shape (core/geometry/shape.h), or than
 * it was. */
static const double least_shape = 0.03; /* D7 */

/* Lists indexed by point. */
struct lists {
  size_t *begin;
  uint32_t *of;
};

static vg_status lists_new(struct lists *l, size_t n, size_t n_all,
                           struct vg_error *err)
{
  l->begin = vg_calloc(n + 2, sizeof *l->begin);
  l->of = vg_alloc(n_all, sizeof *l->of);
  return l->begin && l->of ? VG_OK : vg_fail_memory(err, "the interfaces");
}

static void lists_release(struct lists *l)
{
  free(l->begin);
  free(l->of);
}

/* Turns counts at begin[k + 2] into starts, which filling moves to the ends. */
static void lists_open(struct lists *l, size_t n)
{
  for (size_t k = 2; k < n + 2; k++) l->begin[k] += l->begin[k - 1];
}

static vg_status list_cells(const struct vg_coarse *c, struct lists *l,
                            struct vg_error *err)
{
  const struct vg_tets *t = &c->t;
  vg_status st = lists_new(l, t->n_point, 4 * t->n_cell, err);

  if (st < 0) return st;
  for (size_t q = 0; q < t->n_cell; q++)
    for (int i = 0; i < 4; i++) l->begin[t->cell[q].v[i] + 2]++;
  lists_open(l, t->n_point);
  for (size_t q = 0; q < t->n_cell; q++)
    for (int i = 0; i < 4; i++)
      l->of[l->begin[t->cell[q].v[i] + 1]++] = (uint32_t)q;
  return VG_OK;
}

/* Lists the edges between subdomains by their ends. */
static vg_status list_edges(const struct vg_coarse *c,
                            const struct vg_interface *f, struct lists *l,
                            struct vg_error *err)
{
  vg_status st = lists_new(l, c->t.n_point, 2 * f->n_edge, err);

  if (st < 0) return st;
  for (size_t k = 0; k < 2 * f->n_edge; k++)
    l->begin[f->end[k / 2][k % 2] + 2]++;
  lists_open(l, c->t.n_point);
  for (size_t k = 0; k < 2 * f->n_edge; k++)
    l->of[l->begin[f->end[k / 2][k % 2] + 1]++] = (uint32_t)(k / 2);
  return VG_OK;
}

static double worst_at(const struct vg_tets *t, const struct lists *cells,
                       size_t p)
{
  double worst = 1;

  for (size_t k = cells->begin[p]; k < cells->begin[p + 1]; k++) {
    const uint32_t *v = t->cell[cells->of[k]].v;
    double s = vg_shape(t->x[v[0]], t->x[v[1]], t->x[v[2]], t->x[v[3]]);

    if (s < worst) worst = s;
  }
  return worst;
}

/* Mean of the neighbours of a point. 0: the point stays. */
static int middle(const struct vg_coarse *c, const struct vg_interface *f,
                  const struct lists *edges, size_t p, double to[3])
{
  size_t n_curve = 0, n = 0;

  for (size_t k = edges->begin[p]; k < edges->begin[p + 1]; k++)
    n_curve += f->n_around[edges->of[k]] != 2;
  if (n_curve && n_curve != 2) return 0;
  memset(to, 0, 3 * sizeof *to);
  for (size_t k = edges->begin[p]; k < edges->begin[p + 1]; k++) {
    uint32_t e = edges->of[k];
    const double *x = c->t.x[f->end[e][f->end[e][0] == p]];

    if (n_curve && f->n_around[e] == 2) continue;
    for (int i = 0; i < 3; i++) to[i] += x[i];
    n++;
  }
  for (int i = 0; i < 3 && n; i++) to[i] /= (double)n;
  return n > 0;
}

static void move(struct vg_coarse *c, const struct lists *cells, size_t p,
                 const double to[3], double part)
{
  double *x = c->t.x[p], was[3], worst = worst_at(&c->t, cells, p);

  memcpy(was, x, sizeof was);
  if (worst > least_shape) worst = least_shape;
  for (int k = 0; k < TRIES; k++, part *= 0.5) {
    for (int i = 0; i < 3; i++) x[i] = was[i] + part * (to[i] - was[i]);
    if (worst_at(&c->t, cells, p) >= worst) return;
  }
  memcpy(x, was, sizeof was);
}

vg_status vg_interface_smooth(struct vg_coarse *c, const struct vg_interface *f,
                              struct vg_error *err)
{
  struct lists cells = { NULL, NULL }, edges = { NULL, NULL };
  vg_status st;

  assert(c->n_front <= c->t.n_point && (f->side || !f->n_face));
  VG_TRY(list_cells(c, &cells, err));
  VG_TRY(list_edges(c, f, &edges, err));
  for (int sweep = 0; sweep < SWEEPS; sweep++)
    for (size_t p = c->n_front; p < c->t.n_point; p++) {
      double to[3];

      if (edges.begin[p] < edges.begin[p + 1] && middle(c, f, &edges, p, to))
        move(c, &cells, p, to, share[sweep % 2]);
    }
done:
  lists_release(&cells);
  lists_release(&edges);
  return st;
}
