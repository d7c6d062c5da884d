/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/wake/wake_sheet.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"

#define ROW_GROWTH 1.1
#define ROW_MOST 3.0 /* longest row over the first one, at least */
#define NONE UINT32_MAX

/* A point of the trailing edge. */
struct column {
  uint32_t point;
  size_t n; /* edges */
  double chord;
};

struct maker {
  const struct vg_mesh *m;
  const struct vg_trailing *t;
  const struct vg_wake_sheet *s;
  uint8_t *keeps;        /* [t->n] 1: the sheet leaves this edge */
  struct column *column; /* [n_column] by points */
  size_t n_column, n_row;
  double *row; /* [n_row + 1] distances from the trailing edge, in chords */
};

/* --- edges ---------------------------------------------------------------- */

static int by_points(const void *pa, const void *pb)
{
  const struct vg_trailing_edge *a = pa, *b = pb;

  if (a->point[0] != b->point[0]) return a->point[0] < b->point[0] ? -1 : 1;
  return (a->point[1] > b->point[1]) - (a->point[1] < b->point[1]);
}

/* |n flow| of a triangle, n: its unit normal. */
static double facing(const struct maker *k, size_t t)
{
  const uint32_t *v = k->m->tri[t];
  double a[3], b[3], n[3], size;

  vg_sub(k->m->point[v[1]], k->m->point[v[0]], a);
  vg_sub(k->m->point[v[2]], k->m->point[v[0]], b);
  vg_cross(a, b, n);
  size = vg_norm(n);
  return size > 0 ? fabs(vg_dot(n, k->s->flow)) / size : 0;
}

static int is_below(const struct maker *k, uint32_t p,
                    const struct vg_trailing_edge *e)
{
  const double *a = k->m->point[e->point[0]], *b = k->m->point[e->point[1]];
  double d = 0;

  for (int i = 0; i < 3; i++)
    d += k->s->up[i] * (k->m->point[p][i] - 0.5 * (a[i] + b[i]));
  return d < 0;
}

/* Of blunt trailing edges, the rim above the base: the base is the triangle
 * that faces downstream most. */
static vg_status keep_upper(struct maker *k, struct vg_error *err)
{
  const struct vg_mesh *m = k->m;
  double *most = vg_calloc(k->t->n, sizeof *most);

  if (!most) return vg_fail_memory(err, "a wake sheet");
  for (size_t t = 0; t < m->n_tri; t++)
    for (int i = 0; i < 3; i++) {
      const uint32_t p = m->tri[t][i], q = m->tri[t][(i + 1) % 3];
      const struct vg_trailing_edge key = { .point = { p < q ? p : q,
                                                       p < q ? q : p } };
      const struct vg_trailing_edge *e = bsearch(&key, k->t->edge, k->t->n,
                                                 sizeof key, by_points);
      const size_t at = e ? (size_t)(e - k->t->edge) : 0;
      double f;

      if (!e || !(e->thickness > 0) || !k->keeps[at]) continue;
      f = facing(k, t);
      if (f <= most[at]) continue;
      most[at] = f;
      k->keeps[at] = is_below(k, m->tri[t][(i + 2) % 3], e) ? 1 : 2;
    }
  for (size_t i = 0; i < k->t->n; i++) k->keeps[i] = k->keeps[i] == 1;
  free(most);
  return VG_OK;
}

/* --- columns and rows ----------------------------------------------------- */

static int by_point(const void *pa, const void *pb)
{
  const struct column *a = pa, *b = pb;

  return (a->point > b->point) - (a->point < b->point);
}

static vg_status take_columns(struct maker *k, struct vg_error *err)
{
  size_t n = 0;

  k->column = vg_alloc(2 * k->t->n, sizeof *k->column);
  if (!k->column) return vg_fail_memory(err, "a wake sheet");
  for (size_t i = 0; i < k->t->n; i++)
    for (int j = 0; j < 2 && k->keeps[i]; j++)
      k->column[n++] = (struct column){ k->t->edge[i].point[j], 1,
                                        k->t->edge[i].chord };
  qsort(k->column, n, sizeof *k->column, by_point);
  for (size_t i = 0; i < n; i++) {
    struct column *c = &k->column[k->n_column];

    if (k->n_column && c[-1].point == k->column[i].point) {
      c[-1].chord += k->column[i].chord;
      c[-1].n++;
    } else {
      *c = k->column[i];
      k->n_column++;
    }
  }
  for (size_t i = 0; i < k->n_column; i++)
    k->column[i].chord /= (double)k->column[i].n;
  return VG_OK;
}

/* Mean edge of the trailing edge, in chords. */
static double mean_edge(const struct maker *k)
{
  double sum = 0;
  size_t n = 0;

  for (size_t i = 0; i < k->t->n; i++) {
    const struct vg_trailing_edge *e = &k->t->edge[i];

    if (!k->keeps[i]) continue;
    sum += vg_distance(k->m->point[e->point[0]], k->m->point[e->point[1]]) /
           e->chord;
    n++;
  }
  return sum / (double)n;
}

/* The rows end at the length of the sheet. */
static vg_status set_rows(struct maker *k, struct vg_error *err)
{
  const double edge = fmin(mean_edge(k), k->s->length);
  const double most = fmax(ROW_MOST * edge, k->s->row);
  double step = edge, at = 0;

  while (at < k->s->length) {
    k->n_row++;
    at += step;
    step = fmin(step * ROW_GROWTH, most);
  }
  k->row = vg_alloc(k->n_row + 1, sizeof *k->row);
  if (!k->row) return vg_fail_memory(err, "a wake sheet");
  k->row[0] = 0;
  step = edge;
  for (size_t i = 1; i <= k->n_row; i++) {
    k->row[i] = k->row[i - 1] + step * (k->s->length / at);
    step = fmin(step * ROW_GROWTH, most);
  }
  return VG_OK;
}

/* --- triangles ------------------------------------------------------------ */

static uint32_t column_of(const struct maker *k, uint32_t point)
{
  const struct column key = { .point = point };
  const struct column *c = bsearch(&key, k->column, k->n_column, sizeof key,
                                   by_point);

  assert(c);
  return (uint32_t)(c - k->column);
}

static void add_points(const struct maker *k, struct vg_mesh *to)
{
  for (size_t i = 0; i < k->n_column; i++)
    for (size_t j = 0; j <= k->n_row; j++, to->n_point++)
      for (int d = 0; d < 3; d++)
        to->point[to->n_point][d] = k->m->point[k->column[i].point][d] +
                                    k->row[j] * k->column[i].chord *
                                      k->s->flow[d];
}

static void add_triangles(const struct maker *k, struct vg_mesh *to,
                          uint32_t patch)
{
  const uint32_t first = (uint32_t)(to->n_point - k->n_column * (k->n_row + 1));

  for (size_t i = 0; i < k->t->n; i++)
    for (uint32_t j = 0; j < k->n_row && k->keeps[i]; j++) {
      const uint32_t n = (uint32_t)k->n_row + 1;
      const uint32_t a = first + n * column_of(k, k->t->edge[i].point[0]) + j;
      const uint32_t b = first + n * column_of(k, k->t->edge[i].point[1]) + j;
      const uint32_t tri[2][3] = { { a, a + 1, b + 1 }, { a, b + 1, b } };

      for (int h = 0; h < 2; h++, to->n_tri++) {
        memcpy(to->tri[to->n_tri], tri[h], sizeof tri[h]);
        to->tri_patch[to->n_tri] = patch;
      }
    }
}

static vg_status fill(const struct maker *k, struct vg_mesh *to, uint32_t patch,
                      struct vg_error *err)
{
  size_t cap[3] = { to->n_point, to->n_tri, to->n_tri };
  size_t n_edge = 0, n_point, n_tri;

  for (size_t i = 0; i < k->t->n; i++) n_edge += k->keeps[i];
  n_point = to->n_point + k->n_column * (k->n_row + 1);
  n_tri = to->n_tri + 2 * n_edge * k->n_row;
  if (n_point >= NONE || n_tri >= NONE / 3)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "a wake sheet would have %zu triangles; reduce its length",
                   2 * n_edge * k->n_row);
  if (vg_reserve(&to->point, &cap[0], n_point, sizeof *to->point) ||
      vg_reserve(&to->tri, &cap[1], n_tri, sizeof *to->tri) ||
      vg_reserve(&to->tri_patch, &cap[2], n_tri, sizeof *to->tri_patch))
    return vg_fail_memory(err, "a wake sheet");
  add_points(k, to);
  add_triangles(k, to, patch);
  return VG_OK;
}

vg_status vg_wake_sheet_add(const struct vg_mesh *m,
                            const struct vg_trailing *t, const uint8_t *on,
                            const struct vg_wake_sheet *s, struct vg_mesh *to,
                            uint32_t patch, struct vg_error *err)
{
  struct maker k = { .m = m, .t = t, .s = s };
  vg_status st;

  assert(m && t && on && s && s->length > 0 && to && patch < to->n_patch);
  k.keeps = vg_calloc(t->n, 1);
  if (!k.keeps) VG_TRY(vg_fail_memory(err, "a wake sheet"));
  for (size_t i = 0; i < t->n; i++)
    k.keeps[i] = on[t->edge[i].patch[0]] || on[t->edge[i].patch[1]];
  VG_TRY(keep_upper(&k, err));
  VG_TRY(take_columns(&k, err));
  if (!k.n_column) goto done;
  VG_TRY(set_rows(&k, err));
  st = fill(&k, to, patch, err);
done:
  free(k.keeps);
  free(k.column);
  free(k.row);
  return st;
}
