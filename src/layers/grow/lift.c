/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Lengths of columns, first points, and evening out of columns. Declared in
 * layers/grow/grow_parts.h. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "core/geometry/nearest.h"
#include "core/geometry/vector.h"
#include "layers/grow/direct.h"

/* L9 */
/* Share of the initial visibility that is kept where cells would be lost
 * otherwise. */
#define LEAST_VISIBILITY 0.2
#define CAP_SWEEPS 8    /* Several sweeps, since caps form chains. */
#define FIRST_MOST 1.01 /* L22: largest first height, relative to delta1. */

/* Distance from the wall after a small step of length 1 along v: from the
 * triangles at the root, for all columns of a fan. */
static double gain(const struct vg_layer_work *w, uint32_t i, const double v[3])
{
  uint32_t first, end;
  double least = 1;

  vg_root_range(w->c, i, &first, &end);
  for (uint32_t j = w->t.first[first]; j < w->t.first[end]; j++) {
    uint32_t f = w->t.corner[j] / 3, k = w->t.corner[j] % 3;
    uint32_t tri = w->c->face_tri[f], *t;
    double d;

    if (tri == VG_NO_INDEX) continue;
    t = w->m->tri[tri];
    d = vg_off_corner(w->m->point[t[k]], w->m->point[t[(k + 1) % 3]],
                      w->m->point[t[(k + 2) % 3]], w->normal[f], v);
    if (d < least) least = d;
  }
  return least;
}

static void scale_body(void *context, size_t first, size_t end, int worker)
{
  struct vg_layer_work *w = ((struct vg_dir_sweep *)context)->w;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    double d = gain(w, (uint32_t)i, w->c->column[i].dir);
    double length = fmin(1 / d, VG_FACTOR_WHOLE);

    if (d * VG_FACTOR_MAX < 1) w->visibility[i] = 0;
    else
      for (int k = 0; k < 3; k++) w->c->column[i].dir[k] *= length;
  }
}

static int same_slides(const struct vg_column *a, const struct vg_column *b)
{
  return a->slide[0] == b->slide[0] && a->slide[1] == b->slide[1];
}

/* Mean of the directions interpolated between the ends of the opposite edges,
 * over the caps with apex i: a flat triangle then stays flat instead of turning
 * over. */
static void follow(const struct vg_dir_sweep *l, uint32_t i,
                   double (*normal)[3])
{
  const struct vg_layer_work *w = l->w;
  double sum[3] = { 0, 0, 0 };
  int n = 0;

  memcpy(l->to[i], l->from[i], sizeof *l->to);
  for (uint32_t j = w->t.first[i]; j < w->t.first[i + 1]; j++) {
    uint32_t f = w->t.corner[j] / 3, k = w->t.corner[j] % 3;
    uint32_t a = w->c->face[f][(k + 1) % 3], b = w->c->face[f][(k + 2) % 3];
    const double *p = w->m->point[w->c->column[a].root];
    double e[3], x[3], t;

    if ((w->cap[f] & 3) != 1 + k || w->visibility[a] == 0 ||
        w->visibility[b] == 0)
      continue;
    if (w->c->column[i].slide[0] != VG_NO_INDEX &&
        !(same_slides(&w->c->column[i], &w->c->column[a]) &&
          same_slides(&w->c->column[i], &w->c->column[b])))
      continue;
    vg_sub(w->m->point[w->c->column[b].root], p, e);
    vg_sub(w->m->point[w->c->column[i].root], p, x);
    t = vg_dot(x, e) / vg_dot(e, e);
    for (int c = 0; c < 3; c++)
      sum[c] += (1 - t) * l->from[a][c] + t * l->from[b][c];
    n++;
  }
  if (!n) return;
  for (int c = 0; c < 3; c++) sum[c] /= n;
  if (vg_least_visibility(vg_face_normals(w, i, normal), normal, sum) >=
      VG_VISIBILITY_KEPT * w->visibility[i] * vg_norm(sum))
    memcpy(l->to[i], sum, sizeof sum);
}

static void follow_body(void *context, size_t first, size_t end, int worker)
{
  struct vg_dir_sweep *l = context;

  for (size_t k = first; k < end; k++)
    follow(l, l->list[k], l->scratch + (size_t)worker * l->w->max_valence);
}

/* Columns at the apex of a cap that may follow, in order. Returns their number.
 * list: [n_column]. */
static size_t apices(const struct vg_layer_work *w, uint32_t *list)
{
  size_t n = 0;

  for (uint32_t i = 0; i < w->c->n_column; i++) {
    int is_apex = 0;

    if (w->visibility[i] == 0 || vg_shares_root(w->c, i)) continue;
    for (uint32_t j = w->t.first[i]; j < w->t.first[i + 1] && !is_apex; j++)
      is_apex = (w->cap[w->t.corner[j] / 3] & 3) == 1 + w->t.corner[j] % 3;
    if (is_apex) list[n++] = i;
  }
  return n;
}

struct shift {
  struct vg_layer_work *w;
  const uint8_t *which;
};

/* Shortens dir where the second layer, measured along the column, would be
 * thicker than the cap of the law times the first one, which has the length
 * `first`. */
static void shorten(const struct vg_growth_law *law, double first,
                    double dir[3])
{
  double d[3], most;

  if (!isfinite(law->cap)) return;
  vg_growth_law_heights(law, INFINITY, 2, d);
  most = law->cap * first / ((d[2] - d[1]) * vg_norm(dir));
  for (int k = 0; most < 1 && k < 3; k++) dir[k] *= most;
}

/* Whether the first point of column i is delta1 away from the triangles at the
 * root. gain() extends these triangles to infinity, but the first point of a
 * column in an acute wedge may be several edges away from the root. */
static int first_is_kept(const struct vg_layer_work *w, uint32_t i)
{
  const struct vg_column *c = &w->c->column[i];
  const double *root = w->m->point[c->root];
  double delta1 = w->c->law[c->law].delta1, x[3], least = INFINITY;
  uint32_t first, end;

  vg_column_at(c, root, delta1, x);
  vg_root_range(w->c, i, &first, &end);
  for (uint32_t j = w->t.first[first]; j < w->t.first[end]; j++) {
    uint32_t f = w->t.corner[j] / 3, k = w->t.corner[j] % 3;
    const uint32_t tri = w->c->face_tri[f], *t;

    if (tri == VG_NO_INDEX) continue;
    t = w->m->tri[tri];
    least = fmin(least, vg_to_triangle2(x, w->m->point[t[k]],
                                        w->m->point[t[(k + 1) % 3]],
                                        w->m->point[t[(k + 2) % 3]]));
  }
  return sqrt(least) <= FIRST_MOST * delta1;
}

/* Shifts along dir or, where that leaves no room for the first point, along the
 * direction before smoothing. Without room along both, a column has no
 * levels. */
static void shift_body(void *context, size_t first, size_t end, int worker)
{
  const struct shift *s = context;
  struct vg_layer_work *w = s->w;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    struct vg_column *c = &w->c->column[i];
    const double dir[3] = { c->dir[0], c->dir[1], c->dir[2] };
    double v[3], delta1 = w->c->law[c->law].delta1, d;
    int is_seen = 0, is_kept = 0;

    if (s->which && !s->which[i]) continue;
    memset(c->shift, 0, sizeof c->shift);
    for (int try = 0; try < 2 && w->visibility[i] > 0 && !is_kept; try++) {
      memcpy(c->dir, dir, sizeof dir);
      memcpy(v, try ? w->root_dir[i] : dir, sizeof v);
      vg_unit(v);
      d = gain(w, (uint32_t)i, v);
      if (d * VG_FACTOR_MAX < 1) continue;
      is_seen = 1;
      shorten(&w->c->law[c->law], delta1 / d, c->dir);
      for (int k = 0; k < 3; k++)
        c->shift[k] = fabs(d * vg_norm(c->dir) - 1) > 1e-9
                      ? delta1 * (v[k] / d - c->dir[k])
                      : 0;
      is_kept = first_is_kept(w, (uint32_t)i);
    }
    if (!is_seen) w->visibility[i] = 0;
    else if (!is_kept) vg_heights_lower(w, i, 0, VG_CAUSE_CORNER);
  }
}

void vg_directions_shift(struct vg_layer_work *w, const uint8_t *which)
{
  struct shift s = { w, which };

  vg_parallel_for(w->o->threads, w->c->n_column, VG_GRAIN, shift_body, &s);
  vg_twins_farther(w);
}

vg_status vg_directions_scale(struct vg_layer_work *w, struct vg_error *err)
{
  struct vg_dir_sweep l = { .w = w };
  uint32_t *list = vg_alloc(w->c->n_column, sizeof *list);
  size_t n;
  vg_status st;

  if (!list) return vg_fail_memory(err, "the directions");
  vg_parallel_for(w->o->threads, w->c->n_column, VG_GRAIN, scale_body, &l);
  l.list = list;
  n = apices(w, list);
  VG_TRY(vg_dir_sweep_scratch(w, &l, err));
  VG_TRY(vg_dir_sweep_new(w, &l, err));
  for (int s = 0; s < CAP_SWEEPS; s++) {
    vg_parallel_for(w->o->threads, n, VG_GRAIN, follow_body, &l);
    vg_dir_sweep_swap(&l);
  }
  for (size_t i = 0; i < w->c->n_column; i++)
    memcpy(w->c->column[i].dir, l.from[i], sizeof *l.from);
  vg_twins_farther(w);
done:
  vg_dir_sweep_free(&l);
  free(list);
  return st;
}

/* Moves a direction half way or less to the mean over the faces to be
 * turned. */
static int even(struct vg_layer_work *w, size_t i, const uint8_t *turn,
                double (*from)[3], double (*n)[3], double v[3])
{
  double slide[2][3], mean[3] = { 0, 0, 0 }, step = 0.5;
  int n_slide = vg_slide_normals(w, i, slide), n_mean = 0, k;

  for (uint32_t j = w->t.first[i]; j < w->t.first[i + 1]; j++) {
    uint32_t f = w->t.corner[j] / 3;

    for (int c = 0; turn[f] && c < 3; c++) {
      for (int x = 0; x < 3; x++) mean[x] += from[w->c->face[f][c]][x];
      n_mean++;
    }
  }
  if (!n_mean || w->visibility[i] == 0 || vg_shares_root(w->c, i)) return 0;
  k = vg_face_normals(w, i, n);
  for (int try = 0; try < 4; try++, step *= 0.5) {
    for (int x = 0; x < 3; x++)
      v[x] = (1 - step) * from[i][x] + step * mean[x] / n_mean;
    vg_constrain(n_slide, slide, v);
    if (vg_least_visibility(k, n, v) >=
        LEAST_VISIBILITY * w->visibility[i] * vg_norm(v))
      return 1;
  }
  return 0;
}

vg_status vg_directions_even(struct vg_layer_work *w, const uint8_t *turn,
                             uint8_t *turned, struct vg_error *err)
{
  struct vg_dir_sweep l = { 0 };
  vg_status st;

  VG_TRY(vg_dir_sweep_scratch(w, &l, err));
  VG_TRY(vg_dir_sweep_new(w, &l, err));
  for (size_t i = 0; i < w->c->n_column; i++)
    if (even(w, i, turn, l.from, l.scratch, l.to[i])) {
      memcpy(w->c->column[i].dir, l.to[i], sizeof *l.to);
      turned[i] = 1;
    }
  vg_twins_turned(w, turned);
  vg_twins_agree(w, turned, l.from, LEAST_VISIBILITY, l.scratch);
  vg_directions_shift(w, turned);
  for (size_t i = 0; i < w->c->n_column; i++)
    if (w->visibility[i] == 0 && w->allowed[i] > 0) {
      vg_heights_lower(w, i, 0, vg_unseen_cause(w, i, l.scratch));
      turned[i] = 1;
    }
done:
  vg_dir_sweep_free(&l);
  return st;
}
