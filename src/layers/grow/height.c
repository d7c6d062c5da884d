/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Number and heights of the layers, and their reduction where necessary.
 * Declared in layers/grow/grow_parts.h.
 *
 * Growth is reduced first: a column keeps its first height and its number of
 * layers and grows more slowly (with a lower cap than its law). Levels are
 * dropped only where layers of equal thickness would still be too high. */
#include <assert.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/team.h"
#include "core/geometry/vector.h"
#include "layers/grow/grow_parts.h"

#define GRAIN 2048
#define EDGE_SWEEPS 3
/* L7 */
/* Least length of an edge at the tops, along its direction at the wall and
 * relative to its length there. */
#define KEEP_EDGE 0.3
/* Share of the height of a triangle that a corner may move sideways. */
#define LEAN 0.3

/* Length of the edge of triangle t in the plane of point p of a slab; 0: the
 * triangle has none, or p is not on it. */
static double slab_edge(const struct vg_mesh *m, uint32_t t, uint32_t p)
{
  for (int k = 0; k < 3; k++) {
    const uint32_t a = m->tri[t][k], b = m->tri[t][(k + 1) % 3];

    if ((a == p || b == p) && m->point[a][2] == m->point[b][2])
      return vg_distance(m->point[a], m->point[b]);
  }
  return 0;
}

/* Mean length of the edges in the plane of each column of a slab. */
static void slab_body(void *context, size_t first, size_t end, int worker)
{
  struct vg_layer_work *w = context;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    double sum = 0;
    int n = 0;

    for (uint32_t j = w->t.first[i]; j < w->t.first[i + 1]; j++) {
      const uint32_t tri = w->c->face_tri[w->t.corner[j] / 3];
      const double l = tri == VG_NO_INDEX
                       ? 0
                       : slab_edge(w->m, tri, w->c->column[i].root);

      sum += l;
      n += l > 0;
    }
    w->edge[i] = n ? sum / n : 0;
  }
}

/* Edge length of the equilateral triangle with the mean area of the faces. */
static void edge_body(void *context, size_t first, size_t end, int worker)
{
  struct vg_layer_work *w = context;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    double area = 0;
    int n = 0;

    for (uint32_t j = w->t.first[i]; j < w->t.first[i + 1]; j++) {
      uint32_t tri = w->c->face_tri[w->t.corner[j] / 3];
      double a[3], b[3], x[3];

      if (tri == VG_NO_INDEX) continue;
      vg_sub(w->m->point[w->m->tri[tri][1]], w->m->point[w->m->tri[tri][0]], a);
      vg_sub(w->m->point[w->m->tri[tri][2]], w->m->point[w->m->tri[tri][0]], b);
      vg_cross(a, b, x);
      area += 0.5 * vg_norm(x);
      n++;
    }
    w->edge[i] = n ? sqrt(4 / sqrt(3) * area / n) : 0;
  }
}

struct relax {
  const struct vg_layer_work *w;
  const double *from;
  double *to;
};

/* Columns inside a fan, which have no face of their own, take the mean. */
static void even_body(void *context, size_t first, size_t end, int worker)
{
  struct relax *r = context;
  const struct vg_layer_work *w = r->w;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    double sum = 0;
    int n = 0;

    for (uint32_t j = w->t.near_first[i]; j < w->t.near_first[i + 1]; j++)
      if (r->from[w->t.near[j]] > 0) sum += r->from[w->t.near[j]], n++;
    if (!n) r->to[i] = r->from[i];
    else if (r->from[i] > 0) r->to[i] = 0.5 * (r->from[i] + sum / n);
    else r->to[i] = sum / n;
  }
}

static vg_status local_edges(struct vg_layer_work *w, struct vg_error *err)
{
  size_t n = w->c->n_column;
  double *other = vg_alloc(n, sizeof *other);

  if (!other) return vg_fail_memory(err, "the layers");
  vg_parallel_for(w->o->threads, n, GRAIN,
                  w->o->is_slab ? slab_body : edge_body, w);
  for (int s = 0; s < EDGE_SWEEPS; s++) {
    struct relax r = { w, w->edge, other };

    vg_parallel_for(w->o->threads, n, GRAIN, even_body, &r);
    other = w->edge;
    w->edge = r.to;
  }
  free(other);
  return VG_OK;
}

/* Does request a apply where its patch meets that of request b? The thinner
 * first layer does, and of equal ones the lower fixed number of layers. */
static int applies(const struct vg_layer_request *a,
                   const struct vg_layer_request *b)
{
  const int n_a = a->n_exact ? a->n_max : INT_MAX;
  const int n_b = b->n_exact ? b->n_max : INT_MAX;

  if (a->law.delta1 < b->law.delta1 || a->law.delta1 > b->law.delta1)
    return a->law.delta1 < b->law.delta1;
  return n_a < n_b;
}

/* Where patches meet, one request applies to all columns of a fan, so that they
 * have equal heights; of equal requests the first. */
static uint32_t patch_of(const struct vg_layer_work *w, uint32_t i)
{
  uint32_t first, end, best = VG_NO_INDEX;

  vg_root_range(w->c, i, &first, &end);
  for (uint32_t j = w->t.first[first]; j < w->t.first[end]; j++) {
    uint32_t tri = w->c->face_tri[w->t.corner[j] / 3], p;

    if (tri == VG_NO_INDEX) continue;
    p = w->m->tri_patch[tri];
    if (best == VG_NO_INDEX || applies(&w->o->patch[p], &w->o->patch[best]) ||
        (p < best && !applies(&w->o->patch[best], &w->o->patch[p])))
      best = p;
  }
  return best;
}

/* Least total height of the patches that meet at the root of column i; 0: no
 * limit. A limit of one patch also holds where another patch applies. */
static double total_at(const struct vg_layer_work *w, uint32_t i)
{
  uint32_t first, end;
  double least = 0;

  vg_root_range(w->c, i, &first, &end);
  for (uint32_t j = w->t.first[first]; j < w->t.first[end]; j++) {
    const uint32_t tri = w->c->face_tri[w->t.corner[j] / 3];
    const double total = tri == VG_NO_INDEX
                         ? 0
                         : w->o->patch[w->m->tri_patch[tri]].total;

    if (total > 0 && !(least > 0 && least <= total)) least = total;
  }
  return least;
}

/* Target edge length along column i at height d. */
static double size_along(const struct vg_layer_work *w, uint32_t i, double d)
{
  const struct vg_column *c = &w->c->column[i];
  double x[3];

  vg_column_at(c, w->m->point[c->root], d, x);
  return vg_sizing_along(w->sizing, x, c->dir);
}

/* In a metric, the edges of the wall do not determine the height of the cells
 * above the layers. */
static int levels_along(const struct vg_layer_work *w, uint32_t i, int max,
                        const struct vg_layer_request *r, const double *d)
{
  int n = 0;

  while (
    n < max &&
    (r->n_exact || d[n + 1] - d[n] <= w->o->end * size_along(w, i, d[n + 1])) &&
    !(r->total > 0 && d[n + 1] > r->total))
    n++;
  return n;
}

/* Number of levels before a level would be thicker than the local cell. */
static int levels(const struct vg_layer_work *w, uint32_t i,
                  const struct vg_layer_request *r,
                  const struct vg_growth_law *law)
{
  const struct vg_column *c = &w->c->column[i];
  int max = r->n_max > 0 && r->n_max < VG_LEVELS_MAX ? r->n_max : VG_LEVELS_MAX;
  double d[VG_LEVELS_MAX + 1], end = w->o->end * w->edge[i];
  int n = 0;

  vg_growth_law_heights(law, INFINITY, max, d);
  if (vg_sizing_is_stretched(w->sizing)) return levels_along(w, i, max, r, d);
  while (n < max && (r->n_exact || d[n + 1] - d[n] <= end) &&
         !(r->total > 0 && d[n + 1] > r->total))
    n++;
  for (; n > 0 && !r->n_exact; n--) {
    double x[3];

    vg_column_at(c, w->m->point[c->root], d[n], x);
    if (d[n] - d[n - 1] <= w->o->end * vg_sizing_at(w->sizing, x)) break;
  }
  return n;
}

static void wanted_body(void *context, size_t first, size_t end, int worker)
{
  struct vg_layer_work *w = context;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    struct vg_column *c = &w->c->column[i];
    uint32_t p = patch_of(w, (uint32_t)i);
    struct vg_layer_request r = w->o->patch[p];
    struct vg_growth_law *law;

    r.total = total_at(w, (uint32_t)i);
    c->law = w->o->law_at ? (uint32_t)i : p;
    law = &w->c->law[c->law];
    if (w->o->law_at) {
      *law = w->o->patch[p].law;
      w->o->law_at(w->o->law_user, w->m->point[c->root], law);
    }
    c->cap = law->cap;
    c->bent = SIZE_MAX;
    c->n_wanted = (uint16_t)levels(w, (uint32_t)i, &r, law);
    w->by_size[i] = !w->o->patch[p].n_exact &&
                    (!c->n_wanted || c->n_wanted != w->o->patch[p].n_max);
  }
}

vg_status vg_columns_spread(struct vg_layer_work *w,
                            int (*change)(struct vg_layer_work *, void *,
                                          uint32_t, uint32_t),
                            void *context, struct vg_error *err)
{
  assert(change);

  uint32_t n = (uint32_t)w->c->n_column, n_now = n, n_next;
  uint32_t *now = vg_alloc(n, sizeof *now), *next = vg_alloc(n, sizeof *next);
  uint8_t *queued = vg_calloc(n, 1);

  for (uint32_t i = 0; now && i < n; i++) now[i] = i;
  for (; now && next && queued && n_now; n_now = n_next) {
    uint32_t *swap = now;

    n_next = 0;
    for (uint32_t k = 0; k < n_now; k++) queued[now[k]] = 0;
    for (uint32_t k = 0; k < n_now; k++) {
      uint32_t i = now[k];

      for (uint32_t j = w->t.near_first[i]; j < w->t.near_first[i + 1]; j++) {
        uint32_t o = w->t.near[j];

        if (change(w, context, i, j) && !queued[o])
          queued[o] = 1, next[n_next++] = o;
      }
    }
    now = next;
    next = swap;
  }
  n_now = now && next && queued;
  free(now);
  free(next);
  free(queued);
  return n_now ? VG_OK : vg_fail_memory(err, "the layers");
}

/* Columns of one root request the same number of levels. */
static int lower_wanted(struct vg_layer_work *w, void *unused, uint32_t i,
                        uint32_t j)
{
  uint32_t o = w->t.near[j];
  struct vg_column *a = &w->c->column[i], *b = &w->c->column[o];

  (void)unused;
  if (a->root != b->root || b->n_wanted <= a->n_wanted) return 0;
  b->n_wanted = a->n_wanted;
  w->by_size[o] = w->by_size[i];
  return 1;
}

/* Columns of one root have the same number of levels. For other neighbours only
 * the slope between the tops is bounded, by their allowed heights. */
static int lower_level(struct vg_layer_work *w, void *unused, uint32_t i,
                       uint32_t j)
{
  uint32_t o = w->t.near[j];
  struct vg_column *a = &w->c->column[i], *b = &w->c->column[o];

  (void)unused;
  if (a->root != b->root || b->n <= a->n) return 0;
  b->n = a->n;
  b->cause = a->cause;
  return 1;
}

static int same_request(const struct vg_layer_request *a,
                        const struct vg_layer_request *b)
{
  return a->law.delta1 == b->law.delta1 && a->law.rate1 == b->law.rate1 &&
         a->law.rate2 == b->law.rate2 && a->law.cap == b->law.cap &&
         a->n_max == b->n_max && a->total == b->total &&
         a->n_exact == b->n_exact;
}

/* Why column i, whose height nothing limits, limits that of its neighbour o. */
static uint8_t why_lower(const struct vg_layer_work *w, uint32_t i, uint32_t o)
{
  const struct vg_layer_request *a = &w->o->patch[patch_of(w, i)];
  const struct vg_layer_request *b = &w->o->patch[patch_of(w, o)];

  return same_request(a, b) && !(total_at(w, i) < total_at(w, o)) &&
             !(total_at(w, i) > total_at(w, o))
         ? VG_CAUSE_GRADATION
         : VG_CAUSE_NEIGHBOUR;
}

/* Height of column i with one level more than it requests. */
static double one_more(const struct vg_layer_work *w, uint32_t i)
{
  const struct vg_column *c = &w->c->column[i];
  double d[VG_LEVELS_MAX + 1];
  const int n = c->n_wanted < VG_LEVELS_MAX ? c->n_wanted + 1 : VG_LEVELS_MAX;

  vg_growth_law_heights(&w->c->law[c->law], INFINITY, n, d);
  return d[n];
}

/* The tops of neighbours differ by the slack at the most. Next to a column of
 * its requested height, they may also differ by a level, since numbers of
 * levels are whole. */
static int lower_allowed(struct vg_layer_work *w, void *unused, uint32_t i,
                         uint32_t j)
{
  uint32_t o = w->t.near[j];
  double limit = w->allowed[i] + w->slack[j];

  (void)unused;
  if (!(w->allowed[o] > limit)) return 0;
  if (w->why[i] == VG_CAUSE_NONE &&
      w->c->column[i].root != w->c->column[o].root) {
    limit = fmax(limit, one_more(w, i));
    if (!(w->allowed[o] > limit)) return 0;
  }
  w->allowed[o] = limit;
  w->why[o] = w->why[i] == VG_CAUSE_NONE ? why_lower(w, i, o) : w->why[i];
  return 1;
}

static vg_status all_wanted(struct vg_layer_work *w, struct vg_error *err)
{
  const struct vg_columns *c = w->c;
  const struct vg_team_out out[] = {
    { c->column, sizeof *c->column, 0, NULL },
    { w->by_size, sizeof *w->by_size, 0, NULL },
    { c->law, sizeof *c->law, 0, NULL }
  }; /* One law per column with law_at. */

  return vg_team_for(w->o->team, w->o->threads, c->n_column, GRAIN, wanted_body,
                     w, w->o->law_at ? 3 : 2, out, err);
}

static void along_body(void *context, size_t first, size_t end, int worker)
{
  struct vg_layer_work *w = context;

  (void)worker;
  for (size_t i = first; i < end; i++)
    w->edge[i] = size_along(w, (uint32_t)i, w->wanted[i]);
}

vg_status vg_heights_wanted(struct vg_layer_work *w, struct vg_error *err)
{
  struct vg_columns *c = w->c;
  vg_status st;

  c->n_law = w->o->law_at ? c->n_column : w->m->n_patch;
  c->law = vg_alloc(c->n_law, sizeof *c->law);
  if (!c->law) return vg_fail_memory(err, "the layers");
  for (size_t p = 0; !w->o->law_at && p < c->n_law; p++)
    c->law[p] = w->o->patch[p].law;
  VG_TRY(local_edges(w, err));
  VG_TRY(all_wanted(w, err));
  vg_twins_laws(w);
  do VG_TRY(vg_columns_spread(w, lower_wanted, NULL, err));
  while (vg_twins_wanted(w));
  for (size_t i = 0; i < c->n_column; i++) {
    double d[VG_LEVELS_MAX + 1];

    vg_growth_law_heights(&c->law[c->column[i].law], INFINITY,
                          c->column[i].n_wanted, d);
    w->wanted[i] = w->allowed[i] = d[c->column[i].n_wanted];
    w->why[i] = VG_CAUSE_NONE;
    w->settled[i] = -1;
  }
  if (vg_sizing_is_stretched(w->sizing))
    vg_parallel_for(w->o->threads, c->n_column, GRAIN, along_body, w);
  vg_twins_edges(w);
done:
  return st;
}

void vg_heights_lower(struct vg_layer_work *w, size_t i, double limit,
                      enum vg_layer_cause why)
{
  assert(i < w->c->n_column && limit >= 0);
  assert(why > VG_CAUSE_NONE && why < VG_CAUSE_N);
  if (!(limit < w->allowed[i])) return;
  w->allowed[i] = limit > 0 ? limit : 0;
  w->why[i] = (uint8_t)why;
}

/* In a face with inclined columns, a column that is higher by d moves its
 * corner sideways by d times its inclination. Perpendicular to the longest edge
 * this must stay below LEAN of the height of the triangle. */
static double face_slack(const struct vg_layer_work *w, uint32_t f)
{
  const uint32_t *c = w->c->face[f];
  const double *x[3], *n = w->normal[f];
  double lean[3] = { 0, 0, 0 }, longest[3] = { 0, 0, 0 };
  double e[3], across[3], area[3];
  double most = 0, side;

  for (int k = 0; k < 3; k++) x[k] = w->m->point[w->c->column[c[k]].root];
  for (int k = 0; k < 3; k++) {
    double l;

    vg_sub(x[(k + 1) % 3], x[k], e);
    l = vg_dot(e, e);
    if (l > most) most = l, memcpy(longest, e, sizeof e);
    for (int i = 0; i < 3; i++) lean[i] += w->c->column[c[k]].dir[i] / 3;
  }
  vg_sub(x[1], x[0], e);
  vg_sub(x[2], x[0], across);
  vg_cross(e, across, area);
  vg_cross(n, longest, across);
  side = fabs(vg_dot(lean, across)); /* Times the longest edge. */
  return side > 0 ? LEAN * vg_norm(area) / side : INFINITY;
}

static void slack_body(void *context, size_t first, size_t end, int worker)
{
  struct vg_layer_work *w = context;

  (void)worker;
  for (uint32_t i = (uint32_t)first; i < end; i++) {
    for (uint32_t j = w->t.near_first[i]; j < w->t.near_first[i + 1]; j++)
      w->slack[j] = w->o->slope * vg_root_distance(w, i, w->t.near[j]);
    for (uint32_t k = w->t.first[i]; k < w->t.first[i + 1]; k++) {
      uint32_t f = w->t.corner[k] / 3;
      double s;

      if (w->c->face_tri[f] == VG_NO_INDEX) continue;
      s = face_slack(w, f);
      for (uint32_t j = w->t.near_first[i]; j < w->t.near_first[i + 1]; j++)
        if ((w->t.near[j] == w->c->face[f][0] ||
             w->t.near[j] == w->c->face[f][1] ||
             w->t.near[j] == w->c->face[f][2]) &&
            s < w->slack[j])
          w->slack[j] = s;
    }
  }
}

vg_status vg_heights_slack(struct vg_layer_work *w, struct vg_error *err)
{
  w->slack = vg_alloc(w->t.near_first[w->c->n_column], sizeof *w->slack);
  if (!w->slack) return vg_fail_memory(err, "the layers");
  vg_parallel_for(w->o->threads, w->c->n_column, GRAIN, slack_body, w);
  return VG_OK;
}

/* Relative change in length of the edge between two roots, along itself, when
 * columns i and j grow by h_i and h_j along their directions. 0 for columns of
 * one root. */
static double edge_change(const struct vg_layer_work *w, uint32_t i, uint32_t j,
                          double h_i, double h_j)
{
  const struct vg_column *a = &w->c->column[i], *b = &w->c->column[j];
  double e[3], l, sum = 0;

  vg_sub(w->m->point[b->root], w->m->point[a->root], e);
  l = vg_dot(e, e);
  if (!(l > 0)) return 0;
  for (int k = 0; k < 3; k++) sum += (h_j * b->dir[k] - h_i * a->dir[k]) * e[k];
  return sum / l;
}

struct corner {
  const struct vg_layer_work *w;
  double *limit;
};

/* Where the edge to a neighbour would shrink below KEEP_EDGE, both heights are
 * scaled by the same factor. */
static void corner_body(void *context, size_t first, size_t end, int worker)
{
  struct corner *c = context;
  const struct vg_layer_work *w = c->w;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    c->limit[i] = INFINITY;
    for (uint32_t j = w->t.near_first[i]; j < w->t.near_first[i + 1]; j++) {
      uint32_t o = w->t.near[j];
      double s = edge_change(w, (uint32_t)i, o, w->allowed[i], w->allowed[o]);
      double h = (1 - KEEP_EDGE) / -s * w->allowed[i];

      if (1 + s < KEEP_EDGE && h < c->limit[i]) c->limit[i] = h;
    }
  }
}

vg_status vg_heights_corner(struct vg_layer_work *w, struct vg_error *err)
{
  struct corner c = { w, vg_alloc(w->c->n_column, sizeof(double)) };

  if (!c.limit) return vg_fail_memory(err, "the layers");
  vg_parallel_for(w->o->threads, w->c->n_column, GRAIN, corner_body, &c);
  for (size_t i = 0; i < w->c->n_column; i++)
    vg_heights_lower(w, i, c.limit[i], VG_CAUSE_CORNER);
  free(c.limit);
  return VG_OK;
}

/* L20: volume ratio across the top, times the last layer over the edge. */
#define JUMP_SHAPE 1.25

/* Thickness of the last of n layers that fill the height, or 0 if n layers of
 * equal thickness are higher. */
static double last_layer(const struct vg_growth_law *law, int n, double height)
{
  double d[VG_LEVELS_MAX + 1];
  const double cap = vg_growth_law_compress(law, n, height);

  if (!(cap > 0)) return 0;
  vg_growth_law_heights(law, cap, n, d);
  return d[n] - d[n - 1];
}

/* The most levels, up to `most`, whose last layer is at least `last` thick when
 * they fill the height. If no number of levels achieves that, as many as fill
 * the height at the growth law, since fewer levels have thicker layers. */
static int levels_within(const struct vg_growth_law *law, int most,
                         double height, double last)
{
  double d[VG_LEVELS_MAX + 1];
  int n = 1;

  assert(most > 0);
  vg_growth_law_heights(law, INFINITY, most, d);
  while (n < most && d[n] < height) n++;
  while (n < most) {
    const int mid = (n + most + 1) / 2;

    if (last_layer(law, mid, height) >= last) n = mid;
    else most = mid - 1;
  }
  return n;
}

/* Growth and levels that fit into the allowed height of a column. If all
 * requested levels would fit at a lower growth, fewer levels at a higher growth
 * are chosen for the sake of the volume ratio across the top. */
static void fit(struct vg_layer_work *w, size_t i)
{
  struct vg_column *c = &w->c->column[i];
  const struct vg_growth_law *law = &w->c->law[c->law];

  w->settled[i] = w->allowed[i];
  w->own[i] = c->n_fit = c->n_wanted;
  c->cap = law->cap;
  if (w->allowed[i] >= w->wanted[i]) return;
  c->cap = vg_growth_law_compress(law, c->n_wanted, w->allowed[i]);
  if (c->cap > 0) {
    uint32_t first, end; /* one edge for all columns of a root */

    if (w->o->patch[patch_of(w, (uint32_t)i)].n_exact) return;
    vg_root_range(w->c, (uint32_t)i, &first, &end);
    w->own[i] = c->n_fit = (uint16_t)levels_within(law, c->n_wanted,
                                                   w->allowed[i],
                                                   JUMP_SHAPE / w->o->jump *
                                                     w->edge[first]);
    if (c->n_fit < c->n_wanted)
      c->cap = vg_growth_law_compress(law, c->n_fit, w->allowed[i]);
    if (w->why[i] == VG_CAUSE_NEIGHBOUR) c->n_fit = c->n_wanted;
    return;
  }
  c->cap = 1;
  w->own[i] = (uint16_t)(w->allowed[i] / law->delta1);
}

static void settle_body(void *context, size_t first, size_t end, int worker)
{
  struct vg_layer_work *w = context;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    struct vg_column *c = &w->c->column[i];

    if (w->allowed[i] != w->settled[i]) fit(w, i);
    c->n = w->own[i];
    c->compressed = w->allowed[i] < w->wanted[i] ? w->why[i] : VG_CAUSE_NONE;
    c->cause = c->n < c->n_fit ? w->why[i]
             : w->by_size[i]   ? VG_CAUSE_SIZE
                               : VG_CAUSE_NONE;
  }
}

vg_status vg_heights_settle(struct vg_layer_work *w, uint8_t *moved,
                            struct vg_error *err)
{
  size_t n = w->c->n_column;
  struct {
    double cap;
    uint16_t n;
  } *before = vg_alloc(n, sizeof *before);
  vg_status st = VG_OK;

  if (!before) return vg_fail_memory(err, "the layers");
  for (size_t i = 0; i < n; i++) {
    before[i].cap = w->c->column[i].cap;
    before[i].n = w->c->column[i].n;
  }
  do VG_TRY(vg_columns_spread(w, lower_allowed, NULL, err));
  while (vg_twins_allowed(w));
  vg_parallel_for(w->o->threads, n, GRAIN, settle_body, w);
  do VG_TRY(vg_columns_spread(w, lower_level, NULL, err));
  while (vg_twins_levels(w));
  for (size_t i = 0; moved && i < n; i++)
    moved[i] = before[i].cap != w->c->column[i].cap ||
               before[i].n != w->c->column[i].n;
done:
  free(before);
  return st;
}
