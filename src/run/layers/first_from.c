/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* First heights from the wall shear of a solution. Declared in
 * run/layers/layers.h.
 *
 * y_plus gives one first height for each patch, by the skin friction of a flat
 * plate. Where a solution has the skin friction coefficient c_f, the height h
 * of a point becomes
 *
 *   h' = h sqrt(c_plate / c_f) = y+ L / (Re sqrt(c_f / 2)),
 *
 * within [h / first_bound, h first_bound], since c_f vanishes at stagnation and
 * separation. Along each edge of the surface, heights then rise by a bounded
 * ratio: greater ones are lowered, so that y+ exceeds the request nowhere. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/heap.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "core/geometry/vector.h"
#include "core/mesh/edges.h"
#include "run/layers/layers.h"
#include "run/input/wall_shear.h"
#include "run/settings/resolved.h"

#define GRAIN 512

/* L32: largest ratio of the first heights at the ends of an edge; share of the
 * area that must agree on the orientation of the solution's walls. */
#define RATIO 1.2
#define AGREE 0.5

struct point {
  double normal[3];
  double edge;     /* Mean length of its edges on walls. */
  double friction; /* Negative: not known. */
  double first;    /* INFINITY: not on a wall. */
  int n_edge;
  int is_kept; /* The height of a patch that has its own. */
  int is_bound;
};

struct work {
  const struct vg_layer_stage *s;
  const struct vg_boundary *b;
  const struct vg_mesh *m;
  const struct vg_wall_shear *shear;
  int side;        /* Of the solution's walls, vg_wall_shear_at. */
  struct point *p; /* [m->n_point] */
  uint8_t *off;    /* [m->n_tri] 1: not on a wall. */
  size_t n, n_own, n_far, n_bound; /* Points of walls; of these, points with
                                      heights of their own, without skin
                                      friction, and at a bound. */
};

static vg_status no_memory(struct vg_error *err)
{
  return vg_fail_memory(err, "first heights from a solution");
}

static void add_triangle(struct work *w, const uint32_t v[3])
{
  double a[3], b[3], n[3];

  vg_sub(w->m->point[v[1]], w->m->point[v[0]], a);
  vg_sub(w->m->point[v[2]], w->m->point[v[0]], b);
  vg_cross(a, b, n);
  for (int k = 0; k < 3; k++) {
    struct point *p = &w->p[v[k]], *q = &w->p[v[(k + 1) % 3]];
    const double l = vg_distance(w->m->point[v[k]],
                                 w->m->point[v[(k + 1) % 3]]);

    for (int i = 0; i < 3; i++) p->normal[i] += n[i];
    p->edge += l;
    q->edge += l;
    p->n_edge++;
    q->n_edge++;
  }
}

/* Finds the triangles of walls, with normals and edge lengths of their points,
 * and the orientation of the solution's walls. */
static vg_status find_walls(struct work *w, struct vg_error *err)
{
  const struct vg_mesh *m = w->m;
  uint8_t *on = vg_alloc(m->n_tri, sizeof *on);
  double agree;

  w->p = vg_calloc(m->n_point, sizeof *w->p);
  w->off = vg_alloc(m->n_tri, sizeof *w->off);
  if (!w->p || !w->off || !on) {
    free(on);
    return no_memory(err);
  }
  for (size_t i = 0; i < m->n_point; i++) w->p[i].first = INFINITY;
  for (size_t t = 0; t < m->n_tri; t++) {
    on[t] = w->s->request[m->tri_patch[t]].is_wall != 0;
    w->off[t] = !on[t];
    if (on[t]) add_triangle(w, m->tri[t]);
  }
  agree = vg_wall_shear_side(w->shear, m, on);
  free(on);
  w->side = agree > AGREE ? 1 : agree < -AGREE ? -1 : 0;
  if (!w->side)
    vg_note(w->b->notes,
            "first_from: the walls of the solution have no common orientation, "
            "so that points near the edge of a thin body may take values of "
            "its other side");
  return VG_OK;
}

static void ask_body(void *context, size_t first, size_t end, int worker)
{
  struct work *w = context;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    struct point *p = &w->p[i];

    p->friction = -1;
    if (p->n_edge)
      p->friction = vg_wall_shear_at(w->shear, w->m->point[i], p->normal,
                                     w->side, p->edge / p->n_edge);
  }
}

/* Height at a point of patch i, which gives the height of y_plus. */
static double height(const struct work *w, size_t i, double friction,
                     int *is_bound)
{
  const struct vg_layer_request *q = &w->s->request[i];
  const struct vg_layer_settings *l = &w->b->read->settings.layer;
  const double bound = l->first_bound, first = q->law.delta1;
  double ratio = 1, h;

  *is_bound = 0;
  if (friction >= 0) {
    const double wanted = vg_y_plus(first, l->reynolds, l->length);
    const double got = vg_y_plus_at(first, l->reynolds, l->length, friction);

    ratio = got * bound > wanted ? wanted / got : bound;
    *is_bound = !(got * bound > wanted) || ratio * bound < 1;
    if (ratio * bound < 1) ratio = 1 / bound;
  }
  h = first * ratio;
  return q->total > 0 && h > q->total ? q->total : h;
}

/* Where patches meet, the least height applies, as without a solution. */
static void set_heights(struct work *w)
{
  const struct vg_settings *set = &w->b->read->settings;
  const struct vg_mesh *m = w->m;

  for (size_t i = 0; i < m->n_tri; i++) {
    const uint32_t patch = m->tri_patch[i];
    const struct vg_layer_row row = vg_wall_layer_row(set, m, patch);

    for (int k = 0; k < 3 && !w->off[i]; k++) {
      struct point *p = &w->p[m->tri[i][k]];
      int is_bound = 0;
      const double h = row.first > 0 ? w->s->request[patch].law.delta1
                                     : height(w, patch, p->friction, &is_bound);

      p->first = fmin(p->first, h);
      p->is_kept |= row.first > 0;
      p->is_bound |= is_bound;
    }
  }
}

static void count(struct work *w)
{
  for (size_t i = 0; i < w->m->n_point; i++) {
    const struct point *p = &w->p[i];

    w->n += p->n_edge > 0;
    w->n_own += p->n_edge && p->is_kept;
    w->n_far += p->n_edge && !p->is_kept && p->friction < 0;
    w->n_bound += p->n_edge && !p->is_kept && p->is_bound;
  }
}

/* --- gradation ------------------------------------------------------------ */

struct front_point {
  double first;
  uint32_t point;
};

static inline int before(const struct front_point *a,
                         const struct front_point *b)
{
  return a->first < b->first || (a->first <= b->first && a->point < b->point);
}

VG_HEAP_DEFINE(front, struct front_point, before)

/* Lowers the other end of half-edge h of the point that leaves the heap. */
static void lower(struct work *w, const struct front_point *from, uint32_t to,
                  struct front_point *heap, size_t *n)
{
  struct point *p = &w->p[to];
  const double most = RATIO * from->first;

  if (p->is_kept || !(p->first > most)) return;
  p->first = most;
  front_push(heap, n, (struct front_point){ most, to });
}

/* Half-edges by the points from which they start: start[p] to start[p + 1]. */
static void sort_halves(const struct work *w, uint32_t *start, uint32_t *half)
{
  const struct vg_mesh *m = w->m;

  for (size_t i = 0; i < 3 * m->n_tri; i++)
    if (!w->off[i / 3]) start[m->tri[i / 3][i % 3] + 2]++;
  for (size_t p = 2; p < m->n_point + 2; p++) start[p] += start[p - 1];
  for (size_t i = 0; i < 3 * m->n_tri; i++)
    if (!w->off[i / 3]) half[start[m->tri[i / 3][i % 3] + 1]++] = (uint32_t)i;
}

/* Heights leave the heap from the least on, so that each point is lowered to
 * its final height at most once by each of its edges. */
static void grade(struct work *w, const uint32_t *start, const uint32_t *half,
                  struct front_point *heap)
{
  size_t n = 0;

  for (size_t i = 0; i < w->m->n_point; i++)
    if (w->p[i].n_edge)
      front_push(heap, &n, (struct front_point){ w->p[i].first, (uint32_t)i });
  while (n) {
    const struct front_point from = front_pop(heap, &n);

    if (from.first > w->p[from.point].first) continue;
    for (uint32_t j = start[from.point]; j < start[from.point + 1]; j++) {
      lower(w, &from, vg_half_to(w->m->tri, half[j]), heap, &n);
      lower(w, &from, vg_half_from(w->m->tri, vg_half_prev(half[j])), heap, &n);
    }
  }
}

static vg_status smooth(struct work *w, struct vg_error *err)
{
  const size_t n_half = 3 * w->m->n_tri;
  uint32_t *start = vg_calloc(w->m->n_point + 2, sizeof *start);
  uint32_t *half = vg_alloc(n_half, sizeof *half);
  struct front_point *heap = vg_alloc(w->m->n_point + 2 * n_half, sizeof *heap);
  const int ok = start && half && heap;

  if (ok) {
    sort_halves(w, start, half);
    grade(w, start, half, heap);
  }
  free(start);
  free(half);
  free(heap);
  return ok ? VG_OK : no_memory(err);
}

/* --- result --------------------------------------------------------------- */

/* Both sides of an inner surface take the lower of their heights. */
static void join_sides(struct vg_point_heights *h)
{
  for (size_t i = 1; i < h->n; i++) {
    const struct vg_point_height *a = &h->item[i - 1];
    struct vg_point_height *b = &h->item[i];

    if (!(vg_distance2(a->x, b->x) > 0)) *b = *a;
  }
}

static vg_status list(const struct work *w, struct vg_point_heights *out,
                      struct vg_error *err)
{
  out->item = vg_alloc(w->n, sizeof *out->item);
  if (!out->item) return no_memory(err);
  for (size_t i = 0; i < w->m->n_point; i++) {
    const struct point *p = &w->p[i];
    struct vg_point_height *to = &out->item[out->n];

    if (!p->n_edge) continue;
    memcpy(to->x, w->m->point[i], sizeof to->x);
    to->first = p->first;
    to->friction = p->friction;
    out->n++;
  }
  assert(out->n == w->n);
  vg_point_heights_sort(out);
  join_sides(out);
  return VG_OK;
}

static vg_status refuse_own(struct vg_error *err)
{
  return vg_fail(err, VG_ERR_INPUT,
                 "first_from is given, but all walls have first heights of "
                 "their own (column first of the table layers): remove those "
                 "or first_from");
}

static vg_status refuse_far(const struct work *w, struct vg_error *err)
{
  double lo[3] = { INFINITY, INFINITY, INFINITY }, a[3];
  double hi[3] = { -INFINITY, -INFINITY, -INFINITY }, b[3];

  for (size_t i = 0; i < w->m->n_point; i++)
    for (int k = 0; k < 3 && w->p[i].n_edge; k++) {
      lo[k] = fmin(lo[k], w->m->point[i][k]);
      hi[k] = fmax(hi[k], w->m->point[i][k]);
    }
  vg_wall_shear_box(w->shear, a, b);
  return vg_fail(err, VG_ERR_INPUT,
                 "first_from: only %zu of %zu points of walls are near a wall "
                 "of %s, less than half. Its walls are between (%g %g %g) and "
                 "(%g %g %g), those of the surface between (%g %g %g) and "
                 "(%g %g %g): give a solution of this body in the unit and at "
                 "the place of the surface",
                 w->n - w->n_own - w->n_far, w->n - w->n_own,
                 w->b->read->settings.layer.first_from, a[0], a[1], a[2], b[0],
                 b[1], b[2], lo[0], lo[1], lo[2], hi[0], hi[1], hi[2]);
}

static void note(const struct work *w)
{
  const struct vg_layer_settings *l = &w->b->read->settings.layer;

  vg_note(w->b->notes,
          "first heights at %zu points of walls follow from the skin friction "
          "'%s' of %s; at %zu of them they are bounded by the factor %g "
          "(first_bound)",
          w->n - w->n_own - w->n_far, vg_wall_shear_field(w->shear),
          l->first_from, w->n_bound, l->first_bound);
  if (w->n_far)
    vg_note(w->b->notes,
            "%zu of %zu points of walls are too far from the walls of the "
            "solution: they have the first height of y_plus, without a "
            "correction",
            w->n_far, w->n - w->n_own);
}

vg_status vg_first_from(const struct vg_layer_stage *s,
                        const struct vg_boundary *b,
                        struct vg_point_heights *out, struct vg_error *err)
{
  struct work w = { .s = s, .b = b, .m = &b->surface, .shear = b->read->shear };
  vg_status st;

  assert(w.shear && !out->n && !out->item);
  VG_TRY(find_walls(&w, err));
  vg_parallel_for(b->threads, w.m->n_point, GRAIN, ask_body, &w);
  set_heights(&w);
  count(&w);
  if (w.n_own == w.n) VG_TRY(refuse_own(err));
  if (2 * w.n_far > w.n - w.n_own) VG_TRY(refuse_far(&w, err));
  VG_TRY(smooth(&w, err));
  VG_TRY(list(&w, out, err));
  note(&w);
done:
  free(w.p);
  free(w.off);
  return st;
}

/* --- y+ ------------------------------------------------------------------- */

struct measure {
  const struct vg_layer_stage *s;
  const struct vg_mesh *m;
  const struct vg_point_heights *at;
  uint32_t *field; /* [m->n_point] index into s->fields; UINT32_MAX: none */
  uint32_t *seen;  /* [m->n_point] last patch + 1 that has the point */
  uint32_t *start, *tri; /* Triangles of patch i: start[i] to start[i + 1]. */
  double *value[2];      /* [m->n_tri * 3] y+ before and after. */
  double *share[2];      /* The same relative to the request. */
  size_t n;
};

static void add_value(struct measure *k, size_t patch, uint32_t p)
{
  const struct vg_layer_stage *s = k->s;
  const struct vg_point_height *h = vg_point_height(k->at, k->m->point[p]);
  const double first = s->request[patch].law.delta1;
  const double wanted = vg_y_plus(first, s->reynolds, s->length);
  const uint32_t i = k->field[p];

  if (!h || h->friction < 0 || i == UINT32_MAX || !(s->fields.first[i] > 0))
    return;
  k->value[0][k->n] = vg_y_plus_at(first, s->reynolds, s->length, h->friction);
  k->value[1][k->n] = vg_y_plus_at(s->fields.first[i], s->reynolds, s->length,
                                   h->friction);
  for (int j = 0; j < 2; j++) k->share[j][k->n] = k->value[j][k->n] / wanted;
  k->n++;
}

static int compare(const void *a, const void *b)
{
  const double x = *(const double *)a, y = *(const double *)b;

  return (x > y) - (x < y);
}

/* Summary of the values from `first` on, which are sorted. */
static struct vg_y_plus_range summary(double *value, const double *share,
                                      size_t n)
{
  struct vg_y_plus_range r = { 0, 0, 0, 0 };
  size_t within = 0;

  if (!n) return r;
  for (size_t i = 0; i < n; i++)
    within += share[i] >= VG_Y_PLUS_LOW && share[i] <= VG_Y_PLUS_HIGH;
  qsort(value, n, sizeof *value, compare);
  r.min = value[0];
  r.median = value[n / 2];
  r.max = value[n - 1];
  r.within = 100 * (double)within / (double)n;
  return r;
}

static struct vg_y_plus_patch summarise(struct measure *k, uint32_t patch,
                                        size_t first, double wanted)
{
  const size_t n = k->n - first;

  return (struct vg_y_plus_patch){
    .patch = patch,
    .n_point = n,
    .wanted = wanted,
    .before = summary(k->value[0] + first, k->share[0] + first, n),
    .after = summary(k->value[1] + first, k->share[1] + first, n)
  };
}

static vg_status open_measure(struct measure *k, struct vg_error *err)
{
  const struct vg_mesh *m = k->m;
  const struct vg_wall_fields *f = &k->s->fields;

  k->field = vg_alloc(m->n_point, sizeof *k->field);
  k->seen = vg_calloc(m->n_point, sizeof *k->seen);
  k->start = vg_calloc(m->n_patch + 2, sizeof *k->start);
  k->tri = vg_alloc(m->n_tri, sizeof *k->tri);
  for (int j = 0; j < 2; j++) {
    k->value[j] = vg_alloc(3 * m->n_tri, sizeof **k->value);
    k->share[j] = vg_alloc(3 * m->n_tri, sizeof **k->share);
  }
  if (!k->field || !k->seen || !k->start || !k->tri || !k->value[0] ||
      !k->value[1] || !k->share[0] || !k->share[1])
    return vg_fail_memory(err, "the y+ of walls");
  for (size_t i = 0; i < m->n_point; i++) k->field[i] = UINT32_MAX;
  for (size_t i = 0; i < f->n; i++) k->field[f->point[i]] = (uint32_t)i;
  for (size_t t = 0; t < m->n_tri; t++) k->start[m->tri_patch[t] + 2]++;
  for (size_t i = 2; i < m->n_patch + 2; i++) k->start[i] += k->start[i - 1];
  for (size_t t = 0; t < m->n_tri; t++)
    k->tri[k->start[m->tri_patch[t] + 1]++] = (uint32_t)t;
  return VG_OK;
}

static void measure_patches(struct measure *k, struct vg_y_plus_patch *out)
{
  const struct vg_layer_stage *s = k->s;

  for (size_t i = 0; i < s->n_wall; i++) {
    const uint32_t patch = s->wall[i].patch;
    const size_t first = k->n;

    for (uint32_t j = k->start[patch]; j < k->start[patch + 1]; j++)
      for (int c = 0; c < 3; c++) {
        const uint32_t p = k->m->tri[k->tri[j]][c];

        if (k->seen[p] == patch + 1) continue;
        k->seen[p] = patch + 1;
        add_value(k, patch, p);
      }
    out[i] = summarise(k, patch, first,
                       vg_y_plus(s->request[patch].law.delta1, s->reynolds,
                                 s->length));
  }
}

vg_status vg_first_measure(struct vg_layer_stage *s,
                           const struct vg_mesh *surface,
                           const struct vg_point_heights *at,
                           struct vg_error *err)
{
  struct measure k = { .s = s, .m = surface, .at = at };
  struct vg_y_plus_patch *out = vg_alloc(s->n_wall + 1, sizeof *out);
  vg_status st = open_measure(&k, err);

  if (st >= 0 && !out) st = vg_fail_memory(err, "the y+ of walls");
  if (st >= 0) {
    measure_patches(&k, out);
    out[s->n_wall] = summarise(&k, UINT32_MAX, 0, NAN);
    free(s->y_plus);
    s->y_plus = out;
    out = NULL;
  }
  free(out);
  free(k.field);
  free(k.seen);
  free(k.start);
  free(k.tri);
  for (int j = 0; j < 2; j++) {
    free(k.value[j]);
    free(k.share[j]);
  }
  return st;
}
