/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Fields over the wall: levels and distances, measured on the points.
 *
 * The distance of a point from the wall is that from triangles near its root.
 * For the first level these are the triangles at the root. For the top the
 * search continues from the nearest triangle to its neighbours until none is
 * nearer, because in a concave corner the foot of a top may be several edges
 * away from its root. A wall continues through a periodic patch: for roots in
 * it, the search is repeated from the images of root and point. */
#include "layers/measure/measure.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "core/geometry/nearest.h"
#include "core/geometry/vector.h"
#include "layers/slide/twins.h"

enum { GRAIN = 512 }; /* Wall points per chunk. */
enum { PLACES = 16 }; /* Copies of a point by periodic pairs; 4 is usual. */

/* One direction of a periodic pair. */
struct link {
  struct vg_periodic pair;
  uint32_t *partner; /* [surface->n_point] or VG_NO_INDEX. */
};

struct fields_job {
  const struct vg_mesh *surface;
  const struct vg_columns *columns;
  size_t *tri_first;    /* [surface->n_point + 1] offsets into tri[]. */
  uint32_t *tri;        /* Wall triangles at each point, sorted. */
  size_t *column_first; /* [w->n + 1] offsets into columns->column. */
  size_t n_link;
  struct link *link; /* [n_link] both directions of all pairs. */
  struct vg_wall_fields *w;
};

/* A point of a column, or its image by periodic pairs, and its root there. */
struct place {
  uint32_t root;
  double x[3];
};

struct nearest {
  double d2;
  uint32_t tri;
};

void vg_wall_fields_release(struct vg_wall_fields *w)
{
  free(w->point);
  free(w->level);
  free(w->wanted);
  free(w->first);
  free(w->asked);
  free(w->total);
  free(w->share);
  free(w->growth);
  free(w->cause);
  free(w->compressed);
  memset(w, 0, sizeof *w);
}

/* Tests the wall triangles at point `at`. */
static void scan(const struct fields_job *j, uint32_t at, const double x[3],
                 struct nearest *best)
{
  const struct vg_mesh *m = j->surface;

  for (size_t i = j->tri_first[at]; i < j->tri_first[at + 1]; i++) {
    const uint32_t *t = m->tri[j->tri[i]];
    int k = t[0] == at ? 0 : t[1] == at ? 1 : 2;
    double d2 = vg_to_triangle2(x, m->point[t[k]], m->point[t[(k + 1) % 3]],
                                m->point[t[(k + 2) % 3]]);

    if (d2 >= best->d2) continue;
    best->d2 = d2;
    best->tri = j->tri[i];
  }
}

static double distance_at(const struct fields_job *j, const struct place *at)
{
  struct nearest best = { INFINITY, VG_NO_INDEX };

  scan(j, at->root, at->x, &best);
  return best.d2;
}

/* Each iteration reduces the distance or is the last. */
static double distance_near(const struct fields_job *j, const struct place *at)
{
  struct nearest best = { INFINITY, VG_NO_INDEX };
  uint32_t done[3] = { at->root, at->root, at->root };
  double before = INFINITY;

  scan(j, at->root, at->x, &best);
  while (best.d2 < before) {
    const uint32_t *t = j->surface->tri[best.tri];
    uint32_t corner[3] = { t[0], t[1], t[2] };

    before = best.d2;
    for (int k = 0; k < 3; k++)
      if (corner[k] != done[0] && corner[k] != done[1] && corner[k] != done[2])
        scan(j, corner[k], at->x, &best);
    memcpy(done, corner, sizeof done);
  }
  return best.d2;
}

/* Whether the image `next` of place i is not in the list. A root on the axis of
 * a rotation is its own image: only its first two images are adjacent. */
static int is_new_place(const struct place *list, int n, int i, uint32_t next)
{
  if (list[i].root == next) return i == 0;
  for (int k = 0; k < n; k++)
    if (list[k].root == next) return 0;
  return 1;
}

/* The point x above a root and all its images. Returns their number. */
static int places_of(const struct fields_job *j, uint32_t root,
                     const double x[3], struct place list[PLACES])
{
  int n = 1;

  list[0].root = root;
  memcpy(list[0].x, x, sizeof list[0].x);
  for (int i = 0; i < n; i++)
    for (size_t k = 0; k < j->n_link && n < PLACES; k++) {
      const uint32_t next = j->link[k].partner[list[i].root];

      if (next == VG_NO_INDEX || !is_new_place(list, n, i, next)) continue;
      list[n].root = next;
      vg_periodic_image(&j->link[k].pair, list[i].x, list[n].x);
      n++;
    }
  return n;
}

/* Least distance of the point x and its images from the wall. */
static double distance(const struct fields_job *j, uint32_t root,
                       const double x[3],
                       double (*from)(const struct fields_job *,
                                      const struct place *))
{
  struct place list[PLACES];
  const int n = places_of(j, root, x, list);
  double d2 = INFINITY;

  for (int i = 0; i < n; i++) d2 = fmin(d2, from(j, &list[i]));
  return isinf(d2) ? 0 : sqrt(d2);
}

/* Largest ratio of neighbouring layers of a column, 1 for a single layer. */
static double growth_of(const double (*x)[3], int n)
{
  double before = 0, most = 0;

  for (int l = 1; l <= n; l++) {
    double e[3], now;

    vg_sub(x[l], x[l - 1], e);
    now = vg_dot(e, e);
    if (l > 1 && now > most * before) most = now / before;
    before = now;
  }
  return n > 1 ? sqrt(most) : 1;
}

/* Height of a column relative to that of all its levels at the growth law. */
static double share_of(const struct vg_growth_law *law,
                       const struct vg_column *c)
{
  double d[VG_LEVELS_MAX + 1], height;

  if (c->n >= c->n_wanted && !(c->cap < law->cap)) return 1;
  vg_growth_law_heights(law, c->cap, c->n, d);
  height = d[c->n];
  vg_growth_law_heights(law, INFINITY, c->n_wanted, d);
  return height < d[c->n_wanted] ? height / d[c->n_wanted] : 1;
}

static void measure_column(const struct fields_job *j, size_t c, size_t i)
{
  const struct vg_column *col = &j->columns->column[c];
  struct vg_wall_fields *w = j->w;
  double d[VG_LEVELS_MAX + 1], x[VG_LEVELS_MAX + 1][3];
  double asked = j->columns->law[col->law].delta1, first, total, growth;
  double share;

  if (col->n < w->level[i]) w->level[i] = col->n;
  if (col->n_fit < w->wanted[i]) w->wanted[i] = col->n_fit;
  if (!col->n) {
    w->total[i] = w->share[i] = 0;
    return;
  }
  vg_column_points(j->columns, j->surface, c, d, x);
  first = distance(j, col->root, x[1], distance_at);
  total = distance(j, col->root, x[col->n], distance_near);
  growth = growth_of((const double(*)[3])x, col->n);
  if (w->asked[i] == 0 || fabs(first - asked) * w->asked[i] >
                            fabs(w->first[i] - w->asked[i]) * asked) {
    w->first[i] = first;
    w->asked[i] = asked;
  }
  if (total < w->total[i]) w->total[i] = total;
  share = share_of(&j->columns->law[col->law], col);
  if (share < w->share[i]) w->share[i] = share;
  if (growth > w->growth[i]) w->growth[i] = growth;
}

/* Columns with fewer levels than wanted are worse than others; of equals, the
 * column with fewer levels is worse. */
int vg_column_is_worse(const struct vg_column *a, const struct vg_column *b)
{
  assert(a && b);

  int a_short = a->n < a->n_fit, b_short = b->n < b->n_fit;

  return a_short != b_short ? a_short : a->n < b->n;
}

int vg_column_is_tighter(const struct vg_column *a, const struct vg_column *b)
{
  assert(a && b);

  int a_tight = a->compressed != VG_CAUSE_NONE;
  int b_tight = b->compressed != VG_CAUSE_NONE;

  return a_tight != b_tight ? a_tight : a_tight && a->cap < b->cap;
}

static void measure_points(void *context, size_t first, size_t end, int worker)
{
  const struct fields_job *j = context;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    size_t c = j->column_first[i];
    const struct vg_column *worst = &j->columns->column[c], *tightest = worst;

    j->w->point[i] = worst->root;
    j->w->level[i] = j->w->wanted[i] = INT32_MAX;
    j->w->first[i] = j->w->asked[i] = j->w->growth[i] = 0;
    j->w->total[i] = INFINITY;
    j->w->share[i] = 1;
    for (; c < j->column_first[i + 1]; c++) {
      const struct vg_column *col = &j->columns->column[c];

      if (vg_column_is_worse(col, worst)) worst = col;
      if (vg_column_is_tighter(col, tightest)) tightest = col;
      measure_column(j, c, i);
    }
    j->w->cause[i] = worst->cause;
    j->w->compressed[i] = tightest->compressed;
  }
}

/* Finds the wall triangles at each point. */
static vg_status find_triangles(struct fields_job *j, struct vg_error *err)
{
  const struct vg_columns *c = j->columns;
  const struct vg_mesh *m = j->surface;
  size_t *first = vg_calloc(m->n_point + 2, sizeof *first);

  j->tri_first = first;
  j->tri = vg_alloc(3 * c->n_face, sizeof *j->tri);
  if (!first || !j->tri) return vg_fail_memory(err, "triangles at the wall");
  for (size_t f = 0; f < c->n_face; f++)
    for (int k = 0; k < 3; k++)
      if (c->face_tri[f] != VG_NO_INDEX) first[m->tri[c->face_tri[f]][k] + 2]++;
  for (size_t p = 2; p <= m->n_point + 1; p++) first[p] += first[p - 1];
  /* Filling advances first[p + 1] to the end of p, which is the start of p +
   * 1. */
  for (size_t f = 0; f < c->n_face; f++)
    for (int k = 0; k < 3; k++)
      if (c->face_tri[f] != VG_NO_INDEX)
        j->tri[first[m->tri[c->face_tri[f]][k] + 1]++] = c->face_tri[f];
  return VG_OK;
}

/* Finds the wall points and their columns, which are sorted by root. */
static vg_status find_points(struct fields_job *j, struct vg_error *err)
{
  const struct vg_columns *c = j->columns;
  struct vg_wall_fields *w = j->w;

  j->column_first = vg_alloc(c->n_column + 1, sizeof *j->column_first);
  if (!j->column_first) return vg_fail_memory(err, "points of the wall");
  for (size_t i = 0; i < c->n_column; i++) {
    if (c->column[i].n > VG_LEVELS_MAX)
      return vg_fail(err, VG_ERR_INPUT,
                     "column %zu has %d levels, but at most %d are supported",
                     i + 1, c->column[i].n, VG_LEVELS_MAX);
    if (!i || c->column[i].root != c->column[i - 1].root)
      j->column_first[w->n++] = i;
  }
  j->column_first[w->n] = c->n_column;
  w->point = vg_alloc(w->n, sizeof *w->point);
  w->level = vg_alloc(w->n, sizeof *w->level);
  w->wanted = vg_alloc(w->n, sizeof *w->wanted);
  w->first = vg_alloc(w->n, sizeof *w->first);
  w->asked = vg_alloc(w->n, sizeof *w->asked);
  w->total = vg_alloc(w->n, sizeof *w->total);
  w->share = vg_alloc(w->n, sizeof *w->share);
  w->growth = vg_alloc(w->n, sizeof *w->growth);
  w->cause = vg_alloc(w->n, sizeof *w->cause);
  w->compressed = vg_alloc(w->n, sizeof *w->compressed);
  if (!w->point || !w->level || !w->wanted || !w->first || !w->asked ||
      !w->total || !w->share || !w->growth || !w->cause || !w->compressed)
    return vg_fail_memory(err, "fields over the wall");
  return VG_OK;
}

static vg_status find_links(struct fields_job *j, size_t n,
                            const struct vg_periodic *pair,
                            struct vg_error *err)
{
  const size_t n_point = j->surface->n_point;
  struct vg_twins twins = VG_TWINS_INIT;
  vg_status st = VG_OK;

  if (!n) return VG_OK;
  VG_TRY(vg_twins_open(j->surface, n, pair, &twins, err));
  j->link = vg_calloc(2 * n, sizeof *j->link);
  if (!j->link) VG_TRY(vg_fail_memory(err, "the periodic patches"));
  for (; j->n_link < 2 * n; j->n_link++) {
    const struct vg_periodic_match *match = &twins.match[j->n_link / 2];
    struct link *link = &j->link[j->n_link];
    const int is_back = j->n_link & 1;

    link->pair = pair[j->n_link / 2];
    if (is_back) link->pair = vg_periodic_reverse(&link->pair);
    link->partner = vg_alloc(n_point, sizeof *link->partner);
    if (!link->partner) VG_TRY(vg_fail_memory(err, "the periodic patches"));
    memset(link->partner, 0xff, n_point * sizeof *link->partner);
    for (uint32_t i = 0; i < n_point; i++)
      if (match->point[i] != VG_PERIODIC_NONE)
        link->partner[is_back ? match->point[i] : i] = is_back
                                                       ? i
                                                       : match->point[i];
  }
done:
  vg_twins_release(&twins);
  return st;
}

vg_status vg_layers_fields(const struct vg_mesh *surface,
                           const struct vg_columns *columns, size_t n_periodic,
                           const struct vg_periodic *periodic, int threads,
                           struct vg_wall_fields *out, struct vg_error *err)
{
  vg_status st = VG_OK;
  struct vg_wall_fields w = VG_WALL_FIELDS_INIT;
  struct fields_job j = { .surface = surface, .columns = columns, .w = &w };

  assert(threads >= 0 && out);
  VG_TRY(find_points(&j, err));
  VG_TRY(find_triangles(&j, err));
  VG_TRY(find_links(&j, n_periodic, periodic, err));
  vg_parallel_for(threads, w.n, GRAIN, measure_points, &j);
  *out = w;
  memset(&w, 0, sizeof w);
done:
  for (size_t i = 0; i < j.n_link; i++) free(j.link[i].partner);
  free(j.link);
  free(j.tri_first);
  free(j.tri);
  free(j.column_first);
  vg_wall_fields_release(&w);
  return st;
}
