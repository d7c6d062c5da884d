/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Gradation of size tensors (Alauzet, Finite Elem. Anal. Des. 46, 2010). The
 * tensor at each point is intersected with those at the other corners of its
 * leaves, grown over the distance (vg_size_grow). Intersections depend on their
 * order, so the sweeps are Jacobi steps: each point is computed from the values
 * of the sweep before, in the order of its leaves. A point needs the corners
 * only that changed in the sweep before, because it satisfies the conditions of
 * the others already. After the first sweep, few points change.
 *
 * Hanging points, the majority, are left out: their final tensors are means of
 * those of their parents, and the other corners of their leaves are connected
 * without them. */

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "core/geometry/tensor.h"
#include "core/sizing/sizing_build.h"

/* H15: excess of a size over the growth that is not corrected. */
#define SLACK 0.01

/* H16: share of the excess of the interpolation by which corners are lowered.
 */
#define SHARE (1.0 / 3)

struct gradation {
  struct vg_octree_build *b;
  size_t n;         /* number of points that do not hang */
  uint32_t *point;  /* [n] these points */
  uint32_t *number; /* [b->n_point] their numbers; HANGS: of other points */
  float (*now)[6];  /* [n] size tensors of the sources; the next ones are stored
                       as the field, which is updated at the end */
  uint32_t *begin;  /* [n + 1] first leaf of each point */
  uint32_t *leaf;   /* cells */
  uint32_t *due;    /* [n_due] points of this sweep */
  size_t n_due;
  uint8_t *is_new;     /* [n] changed in the sweep before */
  uint8_t *is_changed; /* [n] changed in this sweep */
  uint8_t *is_due;     /* [n] is listed in due */
  uint8_t *is_lowered; /* [n] changed in any sweep */
};

enum { NEIGHBOURS = 64, AHEAD = 2 };

#define HANGS UINT32_MAX

#define HALF_DIAGONAL 0.8660254037844387 /* of a cube of side 1 */

static const struct vg_octree_point *point_of(const struct gradation *g,
                                              size_t i)
{
  return g->b->point + g->point[i];
}

/* Number of corner j of a leaf of the list. */
static uint32_t corner(const struct gradation *g, uint32_t leaf, int j)
{
  return g->number[g->b->cell[g->leaf[leaf]].corner[j]];
}

static float *next_of(const struct gradation *g, size_t p)
{
  return g->b->tensor[g->point[p]].h;
}

static void widen(const float from[6], double h[6])
{
  for (int k = 0; k < 6; k++) h[k] = (double)from[k];
}

static void source_body(void *context, size_t first, size_t end, int worker)
{
  struct gradation *g = context;
  struct vg_octree_build *b = g->b;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    struct vg_size_axes a;
    double x[3], h[6], iso;

    vg_octree_place(b, point_of(g, i)->at, x);
    vg_stat_tensor_source(b->f, x, &a, &iso);
    vg_size_axes_tensor(&a, h);
    for (int k = 0; k < 6; k++) g->now[i][k] = (float)h[k];
  }
}

/* Limit h, the tensor of point p, by that of point q. Returns whether it
 * changed. */
static int limit_by(const struct gradation *g, size_t p, size_t q, double h[6])
{
  const struct vg_octree_build *b = g->b;
  const uint32_t *to = point_of(g, p)->at, *at = point_of(g, q)->at;
  double from[6], way[3];

  for (int k = 0; k < 3; k++)
    way[k] = b->unit * ((double)to[k] - (double)at[k]);
  widen(g->now[q], from);
  vg_size_grow(from, way, b->f->slope, from);
  if (vg_size_is_within(h, from, SLACK)) return 0;
  vg_size_intersect(h, from, h);
  return 1;
}

/* Corners of the leaves of point p that changed in the sweep before, each once,
 * in the order of the leaves. A point is a corner of at most eight leaves.
 * Returns their number. */
static int list_new(const struct gradation *g, uint32_t p,
                    uint32_t out[NEIGHBOURS])
{
  uint32_t all[NEIGHBOURS];
  uint64_t seen = 0; /* bit q % 64 */
  int n_all = 0, n = 0;

  for (uint32_t i = g->begin[p]; i < g->begin[p + 1]; i++)
    for (int j = 0; j < 8; j++) {
      all[n_all] = corner(g, i, j);
      n_all += all[n_all] != HANGS && all[n_all] != p;
    }
  for (int i = 0; i < n_all; i++) {
    uint64_t bit = (uint64_t)1 << all[i] % 64;
    int k = seen & bit ? 0 : n;

    while (k < n && out[k] != all[i]) k++;
    if (k < n || !g->is_new[all[i]]) continue;
    seen |= bit;
    __builtin_prefetch(point_of(g, all[i]));
    __builtin_prefetch(g->now[all[i]]);
    out[n++] = all[i];
  }
  return n;
}

/* Fetch the leaves of point i of this sweep. */
static void prefetch_leaves(const struct gradation *g, size_t i)
{
  uint32_t p;

  if (i >= g->n_due) return;
  p = g->due[i];
  for (uint32_t k = g->begin[p]; k < g->begin[p + 1]; k++)
    __builtin_prefetch(g->b->cell[g->leaf[k]].corner);
}

static void sweep_body(void *context, size_t first, size_t end, int worker)
{
  struct gradation *g = context;
  uint32_t other[NEIGHBOURS];

  (void)worker;
  for (size_t i = first; i < end; i++) {
    uint32_t p = g->due[i];
    int n = list_new(g, p, other), changed = 0;
    double h[6];

    prefetch_leaves(g, i + AHEAD);
    widen(g->now[p], h);
    for (int k = 0; k < n; k++) changed |= limit_by(g, p, other[k], h);
    g->is_changed[p] = (uint8_t)changed;
    g->is_lowered[p] |= (uint8_t)changed;
    for (int k = 0; k < 6 && changed; k++) next_of(g, p)[k] = (float)h[k];
  }
}

/* List the corners of the leaves of all points that changed. */
static void list_due(struct gradation *g)
{
  g->n_due = 0;
  for (size_t q = 0; q < g->n; q++)
    for (uint32_t i = g->begin[q]; g->is_new[q] && i < g->begin[q + 1]; i++)
      for (int j = 0; j < 8; j++) {
        uint32_t p = corner(g, i, j);

        if (p == HANGS || g->is_due[p]) continue;
        g->is_due[p] = 1;
        g->due[g->n_due++] = p;
      }
  for (size_t i = 0; i < g->n_due; i++) g->is_due[g->due[i]] = 0;
}

/* Take over the changes of a sweep, and list the points of the next one.
 * Returns their number. */
static size_t finish_sweep(struct gradation *g)
{
  memset(g->is_new, 0, g->n);
  for (size_t i = 0; i < g->n_due; i++) {
    uint32_t p = g->due[i];

    if (!g->is_changed[p]) continue;
    g->is_new[p] = 1;
    memcpy(g->now[p], next_of(g, p), sizeof *g->now);
  }
  list_due(g);

  return g->n_due;
}

/* Number the points that do not hang. */
static int number_points(struct gradation *g)
{
  struct vg_octree_build *b = g->b;
  size_t n = 0;

  for (size_t i = 0; i < b->n_point; i++) g->n += !b->point[i].n_parent;
  g->point = vg_alloc(g->n, sizeof *g->point);
  g->number = vg_alloc(b->n_point, sizeof *g->number);
  if (!g->point || !g->number) return -1;
  for (size_t i = 0; i < b->n_point; i++) {
    g->number[i] = HANGS;
    if (b->point[i].n_parent) continue;
    g->number[i] = (uint32_t)n;
    g->point[n++] = (uint32_t)i;
  }
  return 0;
}

static int list_leaves(struct gradation *g)
{
  const struct vg_octree_build *b = g->b;
  uint32_t q;

  for (size_t i = 0; i < b->n_cell; i++)
    for (int j = 0; j < 8 && !b->cell[i].child; j++)
      if ((q = g->number[b->cell[i].corner[j]]) != HANGS) g->begin[q]++;
  for (size_t i = 0; i < g->n; i++) g->begin[i + 1] += g->begin[i];
  g->leaf = vg_alloc(g->begin[g->n], sizeof *g->leaf);
  if (!g->leaf) return -1;
  for (size_t i = b->n_cell; i-- > 0;)
    for (int j = 0; j < 8 && !b->cell[i].child; j++)
      if ((q = g->number[b->cell[i].corner[j]]) != HANGS)
        g->leaf[--g->begin[q]] = (uint32_t)i;
  return 0;
}

static void combine_body(void *context, size_t first, size_t end, int worker)
{
  struct gradation *g = context;
  struct vg_octree_build *b = g->b;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    struct vg_octree_point *p = b->point + g->point[i];
    struct vg_size_axes a;
    double x[3], h[6];

    if (!g->is_lowered[i]) continue;
    vg_octree_place(b, p->at, x);
    widen(g->now[i], h);
    vg_size_axes_of(h, &a);
    vg_stat_tensor_limit(b->f, &a);
    vg_stat_tensor_combine(b->f, x, &a, NULL, &p->hint, b->tensor + g->point[i],
                           NULL);
  }
}

static vg_status limit(struct gradation *g, struct vg_error *err)
{
  struct vg_octree_build *b = g->b;
  const struct vg_team_out out[] = { { g->now, sizeof *g->now, 0, NULL } };
  vg_status st = vg_team_for(b->team, b->threads, g->n, VG_OCTREE_GRAIN,
                             source_body, g, 1, out, err);

  if (st < 0) return st;
  memset(g->is_new, 1, g->n);
  for (size_t i = 0; i < g->n; i++) g->due[i] = (uint32_t)i;
  g->n_due = g->n;
  do {
    vg_parallel_for(b->threads, g->n_due, VG_OCTREE_GRAIN, sweep_body, g);
  } while (finish_sweep(g));
  vg_parallel_for(b->threads, g->n, VG_OCTREE_GRAIN, combine_body, g);
  vg_octree_hang_tensors(b);
  return VG_OK;
}

static int allocate(struct gradation *g)
{
  size_t n;

  if (number_points(g)) return -1;
  n = g->n;
  g->now = vg_alloc(n, sizeof *g->now);
  g->begin = vg_calloc(n + 1, sizeof *g->begin);
  g->due = vg_alloc(n, sizeof *g->due);
  g->is_new = vg_alloc(n, 1);
  g->is_changed = vg_alloc(n, 1);
  g->is_due = vg_calloc(n, 1);
  g->is_lowered = vg_calloc(n, 1);
  return g->now && g->begin && g->due && g->is_new && g->is_changed &&
             g->is_due && g->is_lowered
         ? list_leaves(g)
         : -1;
}

/* --- kinks ---------------------------------------------------------------- */

/* The size grows from the shape of a source, so that it has a convex kink
 * there, and the interpolation between exact values at the corners exceeds it.
 * Therefore corners are lowered by a share of the largest relative excess in
 * the middle of their leaves. The octree needs fewer cells for the same
 * accuracy then, and the field keeps the complexity of the exact one. */
struct kinks {
  struct vg_octree_build *b;
  float *excess; /* [n_cell] of leaves, from 0 to the tolerance */
  float *most;   /* [n_point] largest one of the leaves at a point */
};

/* Lower bound of the values from above of the surface in the middle of a cell:
 * they change by the slope at most, and a point that does not hang has one. */
static float above_middle(const struct vg_octree_build *b,
                          const struct vg_octree_cell *c, double side)
{
  double most = 0;

  for (int i = 0; i < 8; i++) {
    const struct vg_octree_point *p = b->point + c->corner[i];

    if (!p->n_parent) most = vg_greater(most, (double)p->h);
  }
  return (float)(most - HALF_DIAGONAL * side * b->f->slope);
}

static double find_excess(const struct vg_octree_build *b,
                          const struct vg_octree_cell *c,
                          struct vg_bvh_reach *reach)
{
  double lo[3], x[3], h[6] = { 0 }, exact[6];
  struct vg_size size;
  uint32_t hint = c->hint;

  vg_octree_place(b, vg_octree_corner(b, c), lo);
  vg_octree_place(b, b->point[c->corner[7]].at, x);
  reach->above = above_middle(b, c, x[0] - lo[0]);
  for (int k = 0; k < 3; k++) x[k] = 0.5 * (lo[k] + x[k]);
  vg_stat_tensor_at(b->f, x, reach, &hint, &size, NULL);
  for (int k = 0; k < 6; k++) {
    exact[k] = (double)size.h[k];
    for (int i = 0; i < 8; i++)
      h[k] += 0.125 * (double)b->tensor[c->corner[i]].h[k];
  }
  vg_tensor_invert(exact, exact);
  return fmin(fmax(vg_tensor_trace2(exact, h) / 3 - 1, 0),
              vg_octree_tolerance(b));
}

/* The centre of a family is the last corner of its first cell. */
static void start_family(const struct vg_octree_build *b,
                         const struct vg_octree_cell *c,
                         struct vg_bvh_reach *reach)
{
  double lo[3];

  vg_octree_place(b, vg_octree_corner(b, c), lo);
  vg_octree_place(b, b->point[c->corner[7]].at, reach->mid);
  vg_bvh_reach_clear(reach, reach->mid[0] - lo[0], 0.25f * c->floor);
}

/* Families of eight cells follow the root. */
static void excess_body(void *context, size_t first, size_t end, int worker)
{
  struct kinks *f = context;
  const struct vg_octree_build *b = f->b;
  struct vg_bvh_reach reach;
  size_t family = SIZE_MAX;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    size_t at = i ? (i - 1) / 8 * 8 + 1 : 0;

    f->excess[i] = 0;
    if (b->cell[i].child) continue;
    if (at != family) start_family(b, b->cell + at, &reach);
    family = at;
    f->excess[i] = (float)find_excess(b, b->cell + i, &reach);
  }
}

/* Hanging points are means of their parents. */
static void lower(struct kinks *f)
{
  struct vg_octree_build *b = f->b;

  for (size_t i = 0; i < b->n_cell; i++)
    for (int j = 0; j < 8; j++) {
      float *most = f->most + b->cell[i].corner[j];

      *most = fmaxf(*most, f->excess[i]);
    }
  for (size_t i = 0; i < b->n_point; i++) {
    struct vg_size *s = b->tensor + i;
    double factor = 1 - SHARE * (double)f->most[i];

    if (b->point[i].n_parent) continue;
    factor = fmin(fmax(factor, b->f->h_min / (double)s->least), 1);
    for (int k = 0; k < 6; k++) s->h[k] = (float)(factor * (double)s->h[k]);
  }
  vg_octree_hang_tensors(b);
}

static vg_status fit_kinks(struct vg_octree_build *b, struct vg_error *err)
{
  struct kinks f = { .b = b,
                     .excess = vg_alloc(b->n_cell, sizeof *f.excess),
                     .most = vg_calloc(b->n_point, sizeof *f.most) };
  const struct vg_team_out out[] = { { f.excess, sizeof *f.excess, 0, NULL } };
  vg_status st;

  if (!f.excess || !f.most)
    st = vg_fail_memory(err, "the octree of the sizing field");
  else
    st = vg_team_for(b->team, b->threads, b->n_cell, VG_OCTREE_GRAIN,
                     excess_body, &f, 1, out, err);
  if (st >= 0) lower(&f);
  free(f.excess);
  free(f.most);
  return st;
}

vg_status vg_octree_limit_tensors(struct vg_octree_build *b,
                                  struct vg_error *err)
{
  struct gradation g = { .b = b };
  vg_status st = allocate(&g)
                 ? vg_fail_memory(err, "the octree of the sizing field")
                 : limit(&g, err);

  free(g.point);
  free(g.number);
  free(g.now);
  free(g.begin);
  free(g.leaf);
  free(g.due);
  free(g.is_new);
  free(g.is_changed);
  free(g.is_due);
  free(g.is_lowered);
  return st >= 0 && vg_octree_has_kinks(b) ? fit_kinks(b, err) : st;
}
