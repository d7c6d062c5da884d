/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Layers as a whole, on difficult surfaces. For any shape: valid cells, the
 * first height kept, a front that bounds the remaining void, and every limit
 * explained; then the fill and the join. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "core/geometry/predicates.h"
#include "core/geometry/vector.h"
#include "core/judge/quality.h"
#include "core/surface/surface_check.h"
#include "fill_support.h"
#include "layer_cases.h"
#include "layers/columns/layers.h"
#include "layers/expand/join.h"
#include "layers/grow/grow.h"
#include "layers/measure/measure.h"
#include "layers/slide/slide.h"
#include "tets_support.h"

/* A case in progress. All walls request the same layers: a first layer of
 * 1/1000 of the edge, ratio 1.25, which takes about 30 levels and 4.4 edges. */
struct bench {
  struct vg_mesh surface;
  struct vg_sizing *sizing;
  struct vg_layer_request request[16];
  struct vg_layer_options options;
  struct vg_layers layers;
  struct vg_layer_report report;
};

static void start(struct bench *b, double h)
{
  struct vg_layer_options options = VG_LAYER_OPTIONS_INIT;

  b->sizing = shape_sizing(&b->surface, 1.2, 0);
  assert_true(b->surface.n_patch <= 16);
  memset(b->request, 0, sizeof b->request);
  for (size_t p = 0; p < b->surface.n_patch; p++) {
    struct vg_growth_law law = VG_GROWTH_LAW_INIT;

    law.delta1 = 1e-3 * h;
    law.rate1 = 0.25;
    b->request[p].is_wall = b->surface.patch[p].bc == CASE_WALL;
    b->request[p].law = law;
  }
  b->options = options;
  b->options.patch = b->request;
}

static void finish(struct bench *b)
{
  vg_layers_release(&b->layers);
  vg_sizing_free(b->sizing);
  vg_mesh_release(&b->surface);
}

static void grow(const struct bench *b, int threads, struct vg_layers *out,
                 struct vg_layer_report *report)
{
  struct vg_layer_options options = b->options;
  struct vg_error err = VG_ERROR_INIT;

  options.threads = threads;
  if (vg_layers_grow(&b->surface, b->sizing, &options, out, report, &err) < 0)
    fail_msg("%s", err.text);
}

/* --- invariants of every case -------------------------------------------- */

static void is_clean(const struct vg_mesh *m)
{
  struct vg_surface_check_options options = { .threads = 1 };
  struct vg_surface_report r = VG_SURFACE_REPORT_INIT;
  struct vg_mesh copy = VG_MESH_INIT;
  char text[300];

  assert_int_equal(vg_mesh_copy(&copy, m, NULL), VG_OK);
  assert_int_equal(vg_surface_check(&copy, &options, &r, NULL), VG_OK);
  if (r.n_defect) {
    vg_defect_text(&copy, &r.defect[0], text, sizeof text);
    fail_msg("%zu defects: %s", r.n_defect, text);
  }
  assert_true(r.is_closed);
  vg_surface_report_release(&r);
  vg_mesh_release(&copy);
}

static void cells_are_valid(const struct bench *b)
{
  struct vg_layer_judgement r;

  assert_int_equal(vg_layers_judge(&b->surface, &b->layers.columns, 1, NULL, &r,
                                   NULL),
                   VG_OK);
  assert_int_equal(r.n_negative, 0);
  assert_int_equal(r.n_bad_corner, 0);
  assert_int_equal(r.n_bad_pyramid, 0);
  assert_int_equal(r.n_bad_wall_tet, 0);
  assert_int_equal(r.n_off_plane, 0);
  assert_int_equal(r.n_cell, b->report.n_cell);
  assert_true(r.n_cell > 0);
}

static double height_of(const struct vg_columns *c, const struct vg_column *v)
{
  double d[VG_LEVELS_MAX + 1];

  vg_growth_law_heights(&c->law[v->law], v->cap, v->n, d);
  return d[v->n];
}

static double next_layer(const struct vg_columns *c, const struct vg_column *v)
{
  double d[VG_LEVELS_MAX + 2];

  vg_growth_law_heights(&c->law[v->law], INFINITY, v->n_wanted + 1, d);
  return d[v->n_wanted + 1] - d[v->n_wanted];
}

/* The slope of the tops is limited. A compressed column may be lower than
 * allowed by less than one level; next to one that is not, tops may be higher
 * by its next layer. */
static void tops_are_no_steeper(const struct bench *b)
{
  const struct vg_columns *c = &b->layers.columns;

  for (size_t i = 0; i < 3 * c->n_face; i++)
    for (int turn = 0; turn < 2; turn++) {
      const uint32_t *f = c->face[i / 3];
      const struct vg_column *low = &c->column[f[(i + (size_t)turn) % 3]];
      const struct vg_column *high = &c->column[f[(i + !turn) % 3]];
      const double *x = b->surface.point[low->root];
      double most = b->options.slope *
                      vg_distance(x, b->surface.point[high->root]) +
                    c->law[low->law].delta1;

      if (low->root == high->root) continue;
      if (low->compressed == VG_CAUSE_NONE)
        most = fmax(most, next_layer(c, low));
      if (height_of(c, high) - height_of(c, low) > most * (1 + 1e-9))
        fail_msg("tops %g and %g at (%g, %g, %g), %g at most",
                 height_of(c, low), height_of(c, high), x[0], x[1], x[2], most);
    }
}

/* First heights are within 1 % everywhere. Growth never exceeds the law's cap;
 * 1e-9 allows for the rounding of the points, 1e-16 on layers of 1e-5 and
 * up. */
static void heights_are_kept(const struct bench *b)
{
  struct vg_wall_fields w = VG_WALL_FIELDS_INIT;
  struct vg_error err = VG_ERROR_INIT;

  if (vg_layers_fields(&b->surface, &b->layers.columns, 0, NULL, 1, &w, &err) <
      0)
    fail_msg("%s", err.text);
  assert_int_equal(w.n, b->report.n_wall_point);
  for (size_t i = 0; i < w.n; i++) {
    const double *x = b->surface.point[w.point[i]];

    if (w.asked[i] > 0 && !(fabs(w.first[i] / w.asked[i] - 1) < 0.01))
      fail_msg("first height %g for %g at (%g, %g, %g)", w.first[i], w.asked[i],
               x[0], x[1], x[2]);
    if (!(w.growth[i] < 1.25 + 1e-9))
      fail_msg("growth %g at (%g, %g, %g)", w.growth[i], x[0], x[1], x[2]);
  }
  vg_wall_fields_release(&w);
}

static int is_limit(int cause)
{
  return cause != VG_CAUSE_NONE && cause != VG_CAUSE_SIZE && cause < VG_CAUSE_N;
}

/* Fewer levels than wanted, or less growth than the law's, have a cause. */
static void limits_are_explained(const struct bench *b)
{
  const struct vg_columns *c = &b->layers.columns;
  size_t cause[VG_CAUSE_N] = { 0 }, compressed[VG_CAUSE_N] = { 0 };

  assert_int_equal(c->n_column, b->report.n_column);
  for (size_t i = 0; i < c->n_column; i++) {
    const struct vg_column *col = &c->column[i];

    assert_true(col->n <= col->n_fit && col->n_fit <= col->n_wanted);
    assert_int_equal(col->n < col->n_fit, is_limit(col->cause));
    if (col->n && col->cap < 1.25) assert_true(is_limit(col->compressed));
    assert_true(col->cause < VG_CAUSE_N && col->compressed < VG_CAUSE_N);
    cause[col->cause]++;
    compressed[col->compressed]++;
  }
  assert_memory_equal(cause, b->report.cause, sizeof cause);
  assert_memory_equal(compressed, b->report.compressed, sizeof compressed);
}

static void minus(const double a[3], const double b[3], long double c[3])
{
  for (int k = 0; k < 3; k++) c[k] = (long double)a[k] - b[k];
}

static long double volume_of(const double a[3], const double b[3],
                             const double c[3], const double d[3])
{
  long double u[3], v[3], w[3];

  minus(b, a, u);
  minus(c, a, v);
  minus(d, a, w);
  return ((u[1] * v[2] - u[2] * v[1]) * w[0] +
          (u[2] * v[0] - u[0] * v[2]) * w[1] +
          (u[0] * v[1] - u[1] * v[0]) * w[2]) /
         6;
}

static long double enclosed(const struct vg_mesh *m)
{
  const double origin[3] = { 0, 0, 0 };
  long double sum = 0;

  for (size_t t = 0; t < m->n_tri; t++)
    sum -= volume_of(origin, m->point[m->tri[t][0]], m->point[m->tri[t][1]],
                     m->point[m->tri[t][2]]);
  return sum;
}

/* By the lift rule, coded from its definition; cells that vanish add
 * nothing. */
static long double volume_over(const struct vg_columns *c,
                               const struct vg_mesh *m, size_t f)
{
  static double x[3][VG_LEVELS_MAX + 1][3];
  double d[VG_LEVELS_MAX + 1];
  const uint32_t *v = c->face[f];
  int level[3] = { 0, 0, 0 };
  long double sum = 0;

  for (int k = 0; k < 3; k++) vg_column_points(c, m, v[k], d, x[k]);
  for (;;) {
    int k = -1, lowest = VG_LEVELS_MAX + 1;

    for (int i = 0; i < 3; i++) {
      if (level[i] == c->column[v[i]].n || level[i] > lowest) continue;
      if (level[i] < lowest || v[i] < v[k]) k = i;
      lowest = level[i];
    }
    if (k < 0) return sum;
    sum += volume_of(x[0][level[0]], x[1][level[1]], x[2][level[2]],
                     x[k][level[k] + 1]);
    level[k]++;
  }
}

/* The volumes of the layers and of the front's interior add up to the whole:
 * there are no overlaps or gaps. Sums are in extended precision, so the
 * remaining error is the rounding of the points on patches that are not
 * coordinate planes. */
static void volumes_add_up(const struct bench *b)
{
  long double whole = enclosed(&b->surface), sum;

  sum = enclosed(FRONT_MESH(&b->layers.front, &b->surface));
  assert_true(sum > 0);
  for (size_t f = 0; f < b->layers.columns.n_face; f++)
    sum += volume_over(&b->layers.columns, &b->surface, f);
  if (!(fabsl(sum - whole) < 1e-12L * whole))
    fail_msg("volume %.17Lg instead of %.17Lg", sum, whole);
}

/* Every front point is at the position that its id names; the top of a face
 * belongs to that face. */
static void front_is_what_it_says(const struct bench *b)
{
  const struct vg_front *f = &b->layers.front;
  const struct vg_columns *c = &b->layers.columns;

  for (size_t p = 0; p < f->n_point; p++) {
    uint32_t column = vg_layer_column_of(f->id[p]);
    uint32_t point = vg_layer_point_of(f->id[p]);
    double x[3];

    if (column != VG_NO_INDEX) {
      assert_true(c->column[column].n >= 1);
      vg_column_top(c, &b->surface, column, x);
      assert_memory_equal(x, f->x[p], sizeof x);
      assert_int_equal(point, VG_NO_INDEX);
    } else if (point != VG_NO_INDEX) {
      assert_memory_equal(b->surface.point[point], f->x[p], sizeof x);
    }
  }
  for (size_t t = 0; t < f->n_face; t++) {
    assert_true(f->patch[t] < b->surface.n_patch);
    if (f->face_id[t] == VG_NO_INDEX) continue;
    assert_true(f->face_id[t] < c->n_face);
    for (int k = 0; k < 3; k++) {
      const uint32_t *of = c->face[f->face_id[t]];
      uint32_t at = vg_layer_column_of(f->id[f->face[t][k]]);

      if (at == VG_NO_INDEX) continue;
      assert_true(at == of[0] || at == of[1] || at == of[2]);
    }
  }
}

/* Patches without layers in a coordinate plane stay exactly in it. */
static void planes_stay_planes(const struct bench *b)
{
  const struct vg_mesh *s = &b->surface,
                       *f = FRONT_MESH(&b->layers.front, &b->surface);

  for (size_t p = 0; p < s->n_patch; p++)
    for (int k = 0; k < 3; k++) {
      double at = NAN;
      int is_plane = !b->request[p].is_wall;

      for (size_t i = 0; i < 3 * s->n_tri; i++) {
        if (s->tri_patch[i / 3] != p) continue;
        if (at != at) at = s->point[s->tri[i / 3][i % 3]][k];
        is_plane &= s->point[s->tri[i / 3][i % 3]][k] == at;
      }
      for (size_t i = 0; i < 3 * f->n_tri && is_plane; i++)
        if (f->tri_patch[i / 3] == p)
          assert_true(f->point[f->tri[i / 3][i % 3]][k] == at);
    }
}

static void same(const void *a, const void *b, size_t n, size_t size)
{
  if (n) assert_memory_equal(a, b, n * size);
}

static void same_layers(const struct vg_layers *a, const struct vg_layers *b)
{
  const struct vg_columns *c = &a->columns, *d = &b->columns;
  const struct vg_front *m = &a->front, *n = &b->front;

  assert_int_equal(c->n_column, d->n_column);
  assert_int_equal(c->n_face, d->n_face);
  assert_int_equal(c->n_border, d->n_border);
  assert_int_equal(c->n_path, d->n_path);
  for (size_t i = 0; i < c->n_column; i++) {
    assert_memory_equal(c->column[i].dir, d->column[i].dir, 3 * sizeof(double));
    assert_true(c->column[i].cap == d->column[i].cap);
    assert_int_equal(c->column[i].n, d->column[i].n);
    assert_int_equal(c->column[i].cause, d->column[i].cause);
    assert_int_equal(c->column[i].compressed, d->column[i].compressed);
  }
  same(c->path, d->path, c->n_path, sizeof *c->path);
  assert_int_equal(m->n_point, n->n_point);
  assert_int_equal(m->n_face, n->n_face);
  same(m->x, n->x, m->n_point, sizeof *m->x);
  same(m->id, n->id, m->n_point, sizeof *m->id);
  same(m->face, n->face, m->n_face, sizeof *m->face);
  same(m->patch, n->patch, m->n_face, sizeof *m->patch);
  same(m->face_id, n->face_id, m->n_face, sizeof *m->face_id);
}

static void grow_and_check(struct bench *b)
{
  grow(b, 1, &b->layers, &b->report);
  cells_are_valid(b);
  tops_are_no_steeper(b);
  heights_are_kept(b);
  limits_are_explained(b);
  is_clean(FRONT_MESH(&b->layers.front, &b->surface));
  front_is_what_it_says(b);
  planes_stay_planes(b);
  volumes_add_up(b);
  for (int threads = 2; threads <= 3; threads++) {
    struct vg_layers again = VG_LAYERS_INIT;
    struct vg_layer_report report;

    grow(b, threads, &again, &report);
    same_layers(&b->layers, &again);
    vg_layers_release(&again);
  }
}

static void join_and_judge(const struct bench *b, const struct vg_mesh *field,
                           enum vg_layer_cells cells)
{
  struct vg_mesh_report r;
  struct vg_error err = VG_ERROR_INIT;
  long double whole = enclosed(&b->surface);
  struct vg_mesh m[2] = { VG_MESH_INIT, VG_MESH_INIT };
  struct vg_join_info info[2];

  for (int i = 0; i < 2; i++)
    if (vg_layers_join(&b->surface, &b->layers, field, cells, 2 * i + 1, &m[i],
                       &info[i], &err) < 0)
      fail_msg("%s", err.text);
  assert_int_equal(vg_mesh_judge(&m[0], NULL, &r, NULL), VG_OK);
  assert_int_equal(r.not_positive, 0);
  assert_int_equal(r.open_face, 0);
  assert_int_equal(r.crowded_face, 0);
  assert_int_equal(r.same_side_face, 0);
  assert_int_equal(r.orphan_boundary, 0);
  assert_int_equal(r.outward_boundary, 0);
  assert_int_equal(r.unused_point, 0);
  assert_int_equal(r.duplicate_point, 0);
  assert_true(r.is_valid);
  /* Quadrilaterals of the wall are the mean of their triangulations. */
  assert_true(fabs(r.volume - (double)whole) <
              (cells == VG_LAYER_HEX ? 1e-2 : 1e-9) * (double)whole);
  if (cells == VG_LAYER_TETS)
    assert_int_equal(info[0].n_layer_tet, b->report.n_cell);
  else assert_true(info[0].n_layer_pri + info[0].n_layer_hex > 0);
  same(m[0].point, m[1].point, m[0].n_point, sizeof *m[0].point);
  same(m[0].tet, m[1].tet, m[0].n_tet, sizeof *m[0].tet);
  same(m[0].pri, m[1].pri, m[0].n_pri, sizeof *m[0].pri);
  same(m[0].pyr, m[1].pyr, m[0].n_pyr, sizeof *m[0].pyr);
  same(m[0].hex, m[1].hex, m[0].n_hex, sizeof *m[0].hex);
  vg_mesh_release(&m[0]);
  vg_mesh_release(&m[1]);
}

static void fill_and_join(const struct bench *b)
{
  const struct vg_mesh *front = FRONT_MESH(&b->layers.front, &b->surface);
  struct vg_fill_options options = VG_FILL_OPTIONS_INIT;
  struct vg_sizing *sizing = shape_sizing(front, 1.3, 0);
  struct vg_mesh field = VG_MESH_INIT;
  struct vg_fill_report report;
  struct vg_error err = VG_ERROR_INIT;

  if (fill_mesh(front, sizing, &options, &field, &report, &err) < 0)
    fail_msg("%s", err.text);
  join_and_judge(b, &field, VG_LAYER_TETS);
  join_and_judge(b, &field, VG_LAYER_MIXED);
  join_and_judge(b, &field, VG_LAYER_HEX);
  vg_mesh_release(&field);
  vg_sizing_free(sizing);
}

/* Shares of wall faces, in per cent. */
static void at_least(const struct bench *b, double full, double uncompressed,
                     double any)
{
  struct vg_wall_fields w = VG_WALL_FIELDS_INIT;
  struct vg_patch_layers *list = NULL, all;
  size_t n;

  assert_int_equal(vg_layers_fields(&b->surface, &b->layers.columns, 0, NULL, 1,
                                    &w, NULL),
                   VG_OK);
  assert_int_equal(vg_layers_patches(&b->surface, &b->layers.columns, &w, 0, 0,
                                     &n, &list, &all, NULL),
                   VG_OK);
  assert_int_equal(all.n_face, b->report.n_wall_tri);
  if (all.full < full || all.uncompressed < uncompressed || all.any < any)
    fail_msg("%g %% full, %g %% uncompressed, %g %% any", all.full,
             all.uncompressed, all.any);
  vg_wall_fields_release(&w);
  free(list);
}

static void all_of_it(struct bench *b, double h)
{
  start(b, h);
  grow_and_check(b);
  fill_and_join(b);
}

/* --- local checks -------------------------------------------------------- */

struct place_figures {
  size_t n, n_full, n_loose,
    n_none;       /* columns: all, full, not compressed, without a level */
  double top_max; /* highest, by wall distance */
};

/* Columns with a root in a box. */
static struct place_figures look(const struct bench *b, const double lo[3],
                                 const double hi[3])
{
  const struct vg_columns *c = &b->layers.columns;
  struct place_figures p = { .n = 0 };

  for (size_t i = 0; i < c->n_column; i++) {
    const struct vg_column *col = &c->column[i];
    const double *x = b->surface.point[col->root];
    double top[3], d2 = 0;
    int in = 1;

    for (int k = 0; k < 3; k++) in &= x[k] >= lo[k] && x[k] <= hi[k];
    if (!in) continue;
    vg_column_top(c, &b->surface, i, top);
    for (int k = 0; k < 3; k++) d2 += (top[k] - x[k]) * (top[k] - x[k]);
    p.n++;
    p.n_full += col->n == col->n_fit;
    p.n_loose += col->compressed == VG_CAUSE_NONE;
    p.n_none += col->n == 0;
    p.top_max = fmax(p.top_max, sqrt(d2));
  }
  return p;
}

static void is_full(const struct bench *b, double x0, double x1, double y0,
                    double y1, double z0, double z1)
{
  struct place_figures p = look(b, (const double[3]){ x0, y0, z0 },
                                (const double[3]){ x1, y1, z1 });

  assert_true(p.n > 0);
  assert_int_equal(p.n_full, p.n);
  assert_int_equal(p.n_loose, p.n);
}

/* --- the cases ----------------------------------------------------------- */

static void two_plates_that_close_to_a_gap(void **state)
{
  const double lo[3] = { 1.6, 0, -1 }, hi[3] = { 2.4, 1, 2 };
  struct bench b = { .options.smooth = 0 };
  struct place_figures p;

  (void)state;
  /* a complete stack is 0.44 high: the slot has space for a tenth of two
   * stacks */
  case_slot(&b.surface, 0.1, 0.08);
  all_of_it(&b, 0.1);
  at_least(&b, 100, 0, 100);
  p = look(&b, lo, hi);
  assert_true(p.n > 0 && p.n_none == 0);
  assert_true(p.top_max < 0.5 * 0.08);
  for (size_t i = 0; i < b.layers.columns.n_column; i++) {
    const struct vg_column *c = &b.layers.columns.column[i];
    double x = b.surface.point[c->root][0];

    if (x > 1.6 && x < 2.4)
      assert_true(is_limit(c->cause) || is_limit(c->compressed));
  }
  finish(&b);
}

/* Levels, last layer and top of each column of the slot, [n_column]. */
struct slot_columns {
  size_t n;
  int *level;
  double *last, (*top)[3];
};

static struct slot_columns grow_slot(double jump)
{
  struct bench b = { .options.smooth = 0 };
  struct slot_columns out = { .n = 0 };
  double d[VG_LEVELS_MAX + 1];

  case_slot(&b.surface, 0.1, 0.08);
  start(&b, 0.1);
  b.options.jump = jump;
  grow_and_check(&b);
  out.n = b.layers.columns.n_column;
  out.level = malloc(out.n * sizeof *out.level);
  out.last = calloc(out.n, sizeof *out.last);
  out.top = malloc(out.n * sizeof *out.top);
  assert_true(out.level && out.last && out.top);
  for (size_t i = 0; i < out.n; i++) {
    const struct vg_column *c = &b.layers.columns.column[i];

    vg_growth_law_heights(&b.layers.columns.law[c->law], c->cap, c->n, d);
    out.level[i] = c->n;
    if (c->n) out.last[i] = d[c->n] - d[c->n - 1];
    vg_column_top(&b.layers.columns, &b.surface, i, out.top[i]);
  }
  finish(&b);
  return out;
}

/* layer_jump moves levels within columns of limited height. Their tops stay,
 * except next to columns whose cells it changes. */
static void fewer_levels_for_a_smaller_jump(void **state)
{
  struct slot_columns all = grow_slot(1000), few = grow_slot(1.5);
  size_t n_fewer = 0, n_moved = 0;

  (void)state;
  assert_int_equal(all.n, few.n);
  for (size_t i = 0; i < all.n; i++) {
    if (vg_distance(few.top[i], all.top[i]) > 1e-6) {
      n_moved++;
      continue;
    }
    assert_true(few.level[i] <= all.level[i]);
    assert_true(few.last[i] >= all.last[i] * (1 - 1e-6));
    n_fewer += few.level[i] < all.level[i];
  }
  assert_true(n_fewer > all.n / 10);
  assert_true(n_moved < all.n / 50);
  free(all.level), free(all.last), free(all.top);
  free(few.level), free(few.last), free(few.top);
}

/* Edges ten times as long as the slot is wide: the fronts leave half of it, and
 * the columns lose levels. In its corners four columns slide in two patches
 * each. */
static void a_slot_narrower_than_an_edge(void **state)
{
  struct bench b = { .options.smooth = 0 };

  (void)state;
  case_slot(&b.surface, 0.2, 0.02);
  all_of_it(&b, 0.2);
  at_least(&b, 50, 0, 100);
  finish(&b);
}

/* A gap too narrow for a level: fans at its rims without levels, next to
 * columns that have many. */
static void fans_without_levels(void **state)
{
  struct bench b = { .options.smooth = 0 };

  (void)state;
  case_cubes(&b.surface, 0.125, 0.002);
  start(&b, 0.125);
  b.options.fan_angle = 60;
  for (size_t p = 0; p < b.surface.n_patch; p++) b.request[p].law.delta1 = 1e-3;
  grow_and_check(&b);
  assert_true(b.report.n_virtual_face > 0);
  assert_true(b.report.cause[VG_CAUSE_PROXIMITY] > 0);
  fill_and_join(&b);
  finish(&b);
}

static void a_right_angle(void **state)
{
  struct bench b = { .options.smooth = 0 };

  (void)state;
  case_corner(&b.surface, 0.05, 0, 1);
  all_of_it(&b, 0.05);
  at_least(&b, 100, 60, 100);
  is_full(&b, 0.5, 0.9, 0, 0.8, 0, 0);
  finish(&b);
}

static void an_angle_of_30_degrees(void **state)
{
  struct bench b = { .options.smooth = 0 };

  (void)state;
  case_corner(&b.surface, 0.06, sqrt(0.75), 0.5);
  all_of_it(&b, 0.06);
  at_least(&b, 100, 0, 100);
  finish(&b);
}

static void a_cube(void **state)
{
  struct bench b = { .options.smooth = 0 };

  (void)state;
  case_cube(&b.surface, 0.125);
  all_of_it(&b, 0.125);
  at_least(&b, 100, 100, 100);
  is_full(&b, -0.3, 0.3, -0.3, 0.3, 0.5, 0.5);
  finish(&b);
}

static void a_cube_with_fans(void **state)
{
  struct bench b = { .options.smooth = 0 };

  (void)state;
  case_cube(&b.surface, 0.125);
  start(&b, 0.125);
  b.options.fan_angle = 60;
  grow_and_check(&b);
  assert_true(b.report.n_virtual_face > 0);
  assert_true(b.report.n_column > b.report.n_wall_point);
  fill_and_join(&b);
  at_least(&b, 100, 100, 100);
  finish(&b);
}

static void a_cone(void **state)
{
  struct bench b = { .options.smooth = 0 };

  (void)state;
  case_cone(&b.surface, 0.1, 1);
  all_of_it(&b, 0.1);
  at_least(&b, 100, 100, 100);
  finish(&b);
}

static void a_needle(void **state)
{
  struct bench b = { .options.smooth = 0 };

  (void)state;
  case_cone(&b.surface, 0.15, 2.5);
  all_of_it(&b, 0.15);
  at_least(&b, 100, 85, 100);
  finish(&b);
}

static void a_sphere_over_a_wall(void **state)
{
  struct bench b = { .options.smooth = 0 };
  struct place_figures p;

  (void)state;
  case_sphere(&b.surface, 0.1, 0.02, CASE_WALL);
  all_of_it(&b, 0.1);
  /* Below the sphere the gap is a fifth of an edge wide. */
  at_least(&b, 99, 5, 100);
  is_full(&b, -0.2, 0.2, -0.2, 0.2, 0.9, 1.1); /* the sphere's far side */
  p = look(&b, (const double[3]){ -0.02, -0.02, 0 },
           (const double[3]){ 0.02, 0.02, 0.1 });
  assert_true(p.top_max < 0.01 + 1e-12);
  finish(&b);
}

static void a_sphere_over_a_symmetry_plane(void **state)
{
  struct bench b = { .options.smooth = 0 };
  struct place_figures p;

  (void)state;
  case_sphere(&b.surface, 0.1, 0.02, CASE_SYMMETRY);
  all_of_it(&b, 0.1);
  at_least(&b, 100, 10, 100);
  is_full(&b, -0.2, 0.2, -0.2, 0.2, 0.9, 1.1);
  p = look(&b, (const double[3]){ -0.02, -0.02, 0 },
           (const double[3]){ 0.02, 0.02, 0.1 });
  assert_true(p.n == 1 && p.top_max < 0.02);
  finish(&b);
}

static void a_thin_plate(void **state)
{
  struct bench b = { .options.smooth = 0 };

  (void)state;
  case_plate(&b.surface, 0.1, 0.04);
  all_of_it(&b, 0.1);
  at_least(&b, 100, 100, 100);
  is_full(&b, -0.2, 0.2, -0.2, 0.2, -0.1, 0.1);
  finish(&b);
}

static void a_thin_plate_with_fans(void **state)
{
  struct bench b = { .options.smooth = 0 };

  (void)state;
  case_plate(&b.surface, 0.1, 0.04);
  start(&b, 0.1);
  b.options.fan_angle = 60;
  grow_and_check(&b);
  fill_and_join(&b);
  at_least(&b, 100, 100, 100);
  finish(&b);
}

/* Edges of 11 degrees that end in two symmetry planes. */
static void sharp_edges_between_two_planes(void **state)
{
  struct bench b = { .options.smooth = 0 };

  (void)state;
  case_wedge(&b.surface, 0.1, 0.1);
  all_of_it(&b, 0.1);
  at_least(&b, 100, 100, 100);
  is_full(&b, -0.2, 0.2, -0.4, 0.4, -1, 1);
  finish(&b);
}

static void sharp_edges_with_fans(void **state)
{
  struct bench b = { .options.smooth = 0 };

  (void)state;
  case_wedge(&b.surface, 0.1, 0.1);
  start(&b, 0.1);
  b.options.fan_angle = 60;
  grow_and_check(&b);
  fill_and_join(&b);
  at_least(&b, 100, 100, 100);
  finish(&b);
}

static void a_post_at_90_degrees(void **state)
{
  struct bench b = { .options.smooth = 0 };

  (void)state;
  case_post(&b.surface, 0.1, 0);
  all_of_it(&b, 0.1);
  at_least(&b, 100, 100, 100);
  is_full(&b, -1, 1, -1, 1, 0, 0.4);
  assert_int_equal(b.report.n_slide_patch, 1);
  finish(&b);
}

static void a_post_at_60_to_120_degrees(void **state)
{
  struct bench b = { .options.smooth = 0 };

  (void)state;
  case_post(&b.surface, 0.1, 0.57735);
  all_of_it(&b, 0.1);
  at_least(&b, 100, 50, 100);
  finish(&b);
}

/* 45 to 135 degrees: "and worse". */
static void a_post_at_45_to_135_degrees(void **state)
{
  struct bench b = { .options.smooth = 0 };

  (void)state;
  case_post(&b.surface, 0.1, 1);
  all_of_it(&b, 0.1);
  at_least(&b, 100, 40, 100);
  finish(&b);
}

/* Four sides of a box as one patch touch the floor: no plane fits it. Parts
 * that cannot be remeshed cost levels, but the mesh stays valid. */
static void a_slide_patch_with_folds(void **state)
{
  struct bench b = { .options.smooth = 0 };
  uint32_t first;

  (void)state;
  case_sphere(&b.surface, 0.15, 0.5, CASE_WALL);
  first = VG_NO_INDEX;
  for (size_t t = 0; t < b.surface.n_tri; t++) {
    uint32_t *p = &b.surface.tri_patch[t];

    if (b.surface.patch[*p].bc != CASE_FARFIELD) continue;
    if (first == VG_NO_INDEX) first = *p;
    *p = first;
  }
  all_of_it(&b, 0.15);
  at_least(&b, 0, 0, 90);
  finish(&b);
}

static void a_point_without_visibility(void **state)
{
  const double at[3] = { 0, 0, 0 };
  struct bench b = { .options.smooth = 0 };
  struct place_figures p;

  (void)state;
  case_octants(&b.surface);
  start(&b, 1.0 / 6);
  b.options.fan_angle = 180;
  grow_and_check(&b);
  fill_and_join(&b);
  at_least(&b, 0, 0, 95);
  p = look(&b, at, at);
  assert_int_equal(p.n, 1);
  assert_int_equal(p.n_none, 1);
  assert_true(b.report.cause[VG_CAUSE_VISIBILITY] > 0);
  finish(&b);
}

/* Without a request: a fan at this point and nowhere else, and it has
 * layers. */
static void a_point_without_visibility_gets_a_fan(void **state)
{
  struct bench b = { .options.smooth = 0 };

  (void)state;
  case_octants(&b.surface);
  all_of_it(&b, 1.0 / 6);
  at_least(&b, 0, 0, 99.9);
  assert_int_equal(b.report.cause[VG_CAUSE_VISIBILITY], 0);
  assert_true(b.report.n_column > b.report.n_wall_point);
  finish(&b);
}

/* With requested fans too, and layers so thin that nothing else limits their
 * height. */
static void a_point_without_visibility_with_fans(void **state)
{
  struct bench b = { .options.smooth = 0 };

  (void)state;
  case_octants(&b.surface);
  start(&b, 1.0 / 6);
  b.options.fan_angle = 60;
  for (size_t p = 0; p < b.surface.n_patch; p++) b.request[p].law.delta1 = 1e-6;
  grow_and_check(&b);
  fill_and_join(&b);
  at_least(&b, 0, 0, 90);
  finish(&b);
}

/* A slip patch in the plane of the wall: columns at its edge cannot slide in
 * it, and the layers continue over it. */
static void a_slip_patch_in_the_plane(int is_window)
{
  struct bench b = { .options.smooth = 0 };
  uint8_t is_wall[16] = { 0 }, may[16] = { 0 };
  uint32_t from[16];

  case_flush(&b.surface, 0.15, is_window);
  is_clean(&b.surface);
  start(&b, 0.15);
  grow_and_check(&b);
  assert_true(b.report.cause[VG_CAUSE_SLIDE] > 0);
  assert_int_equal(b.report.cause[VG_CAUSE_VISIBILITY], 0);
  vg_layers_release(&b.layers);
  is_wall[0] = 1;
  assert_int_equal(vg_slides_extend(&b.surface, is_wall, may, from, NULL),
                   VG_OK);
  for (size_t p = 0; p < b.surface.n_patch; p++)
    assert_int_equal(from[p], VG_NO_INDEX);
  memset(may, 1, sizeof may);
  may[0] = 0;
  assert_int_equal(vg_slides_extend(&b.surface, is_wall, may, from, NULL),
                   VG_OK);
  for (size_t p = 0; p < b.surface.n_patch; p++)
    assert_int_equal(from[p], p == 1 ? 0 : VG_NO_INDEX);
  b.request[1] = b.request[0];
  grow_and_check(&b);
  at_least(&b, 100, 0, 100);
  fill_and_join(&b);
  finish(&b);
}

static void a_plate_with_slip_upstream(void **state)
{
  (void)state;
  a_slip_patch_in_the_plane(0);
}

static void a_window_in_a_wall(void **state)
{
  (void)state;
  a_slip_patch_in_the_plane(1);
}

/* --- requests ------------------------------------------------------------ */

static void levels_and_height_as_requested(void **state)
{
  struct bench b = { .options.smooth = 0 };

  (void)state;
  case_post(&b.surface, 0.1, 0);
  start(&b, 0.1);
  for (size_t p = 0; p < b.surface.n_patch; p++) {
    b.request[p].n_max = 9;
    b.request[p].n_exact = 1;
  }
  grow_and_check(&b);
  for (size_t i = 0; i < b.layers.columns.n_column; i++)
    assert_int_equal(b.layers.columns.column[i].n_wanted, 9);
  vg_layers_release(&b.layers);
  for (size_t p = 0; p < b.surface.n_patch; p++) {
    b.request[p].n_max = b.request[p].n_exact = 0;
    b.request[p].total = 0.05;
  }
  grow_and_check(&b);
  assert_true(
    look(&b, (const double[3]){ -1, -1, 0.2 }, (const double[3]){ 1, 1, 0.4 })
      .top_max <= 0.05);
  finish(&b);
}

/* The growth law varies in space; each point gets its own first height. */
static void law_of_the_place(void *user, const double x[3],
                             struct vg_growth_law *law)
{
  const struct vg_growth_law *base = user;

  *law = *base;
  law->delta1 *= 1 + x[2];
}

static void a_varying_growth_law(void **state)
{
  struct bench b = { .options.smooth = 0 };
  struct vg_growth_law base;
  struct vg_wall_fields w = VG_WALL_FIELDS_INIT;

  (void)state;
  case_post(&b.surface, 0.1, 0);
  start(&b, 0.1);
  base = b.request[0].law;
  b.options.law_at = law_of_the_place;
  b.options.law_user = &base;
  grow_and_check(&b);
  assert_int_equal(vg_layers_fields(&b.surface, &b.layers.columns, 0, NULL, 1,
                                    &w, NULL),
                   VG_OK);
  for (size_t i = 0; i < w.n; i++) {
    double z = b.surface.point[w.point[i]][2];

    if (w.asked[i] > 0)
      assert_true(fabs(w.asked[i] - base.delta1 * (1 + z)) < 1e-12);
  }
  vg_wall_fields_release(&w);
  finish(&b);
}

/* A uniform metric with half the size along z. */
static void half_along_z(void *user, const double x[3], double m[6])
{
  const double h = *(const double *)user;

  (void)x;
  memset(m, 0, 6 * sizeof *m);
  m[0] = m[3] = 1 / (h * h);
  m[5] = 4 / (h * h);
}

static double uniform_size(void *user, const double x[3])
{
  (void)x;
  return *(const double *)user;
}

/* Layers of a cube end at 0.1 on its sides and at 0.05 on its top and bottom;
 * edges of its surface are 0.1 long everywhere. */
static void layers_end_at_the_size_along_them(void **state)
{
  double h = 0.1;
  const struct vg_size_map map = {
    .at = uniform_size, .metric = half_along_z, .most = h, .user = &h
  };
  struct vg_sizing_options o = VG_SIZING_OPTIONS_INIT;
  struct bench b = { .options.smooth = 0 };
  size_t n[2] = { 0, 0 };

  (void)state;
  case_cube(&b.surface, 0.1);
  start(&b, 0.1);
  vg_sizing_free(b.sizing);
  o.map = &map;
  o.from_surface = 0;
  o.h_max = 0.1;
  assert_int_equal(vg_sizing_new(&o, 0, NULL, &b.surface, &b.sizing, NULL),
                   VG_OK);
  b.options.end = 1;
  grow(&b, 1, &b.layers, &b.report);
  for (size_t i = 0; i < b.layers.columns.n_column; i++) {
    const struct vg_column *c = &b.layers.columns.column[i];
    const int along_z = fabs(c->dir[2]) > 0.999999;
    double d[VG_LEVELS_MAX + 1];

    if (!along_z && fabs(c->dir[0]) < 0.999999) continue;
    vg_growth_law_heights(&b.layers.columns.law[c->law], INFINITY,
                          c->n_wanted + 1, d);
    assert_true(d[c->n_wanted] - d[c->n_wanted - 1] <= h / (1 + along_z));
    n[along_z] += d[c->n_wanted + 1] - d[c->n_wanted] > h / (1 + along_z);
  }
  assert_true(n[0] > 8 && n[1] > 8);
  finish(&b);
}

/* Requests of one side of a cube at random: first height, ratio, number of
 * layers (fixed, at most, or none), total height. */
static void random_request(struct vg_layer_request *r, double h, uint64_t *seed)
{
  r->law.delta1 = h * pow(10, -1 - 3 * tets_random(seed));
  r->law.rate1 = 0.1 + 0.2 * tets_random(seed);
  r->n_max = tets_random(seed) < 0.7 ? 1 + (int)(30 * tets_random(seed)) : 0;
  r->n_exact = r->n_max > 0 && tets_random(seed) < 0.5;
  r->total = tets_random(seed) < 0.3 ? h * (0.5 + 3 * tets_random(seed)) : 0;
}

/* A column away from other sides has what its own side requests, or a cause
 * says why not; because of another side, it is not lower than the lowest
 * request of all. */
static void keeps_its_request(const struct bench *b, size_t i, uint32_t patch,
                              double lowest)
{
  const struct vg_columns *c = &b->layers.columns;
  const struct vg_column *v = &c->column[i];
  const struct vg_layer_request *r = &b->request[patch];
  double d[VG_LEVELS_MAX + 1];

  assert_true(c->law[v->law].delta1 == r->law.delta1);
  vg_growth_law_heights(&r->law, INFINITY, v->n_wanted, d);
  if (r->n_exact && r->total == 0) assert_int_equal(v->n_wanted, r->n_max);
  if (r->n_max) assert_true(v->n_wanted <= r->n_max);
  if (height_of(c, v) < d[v->n_wanted] * (1 - 1e-9))
    assert_true(is_limit(v->compressed) || is_limit(v->cause));
  else assert_int_equal(v->n, v->n_wanted);
  if (v->compressed == VG_CAUSE_NEIGHBOUR && v->n > 0) {
    assert_int_equal(v->n_fit, v->n_wanted);
    assert_true(height_of(c, v) > lowest - r->law.delta1);
  }
}

static void requests_of_sides(void **state)
{
  uint64_t seed = 7;
  size_t n_lower = 0;

  (void)state;
  for (int round = 0; round < 30; round++) {
    struct bench b = { .options.smooth = 0 };
    const struct vg_columns *c = &b.layers.columns;
    uint32_t *patch;
    double lowest = INFINITY;

    case_cube(&b.surface, 0.12);
    start(&b, 0.12);
    for (int p = 0; p < 6; p++) random_request(&b.request[p], 0.12, &seed);
    grow(&b, 2, &b.layers, &b.report);
    cells_are_valid(&b);
    tops_are_no_steeper(&b);
    patch = malloc(c->n_column * sizeof *patch);
    assert_non_null(patch);
    for (size_t i = 0; i < c->n_column; i++) patch[i] = VG_NO_INDEX;
    for (size_t f = 0; f < 3 * c->n_face; f++) {
      const uint32_t tri = c->face_tri[f / 3], i = c->face[f / 3][f % 3];
      const uint32_t p = tri == VG_NO_INDEX ? 99 : b.surface.tri_patch[tri];

      patch[i] = patch[i] == VG_NO_INDEX || patch[i] == p ? p : 99;
    }
    for (size_t i = 0; i < c->n_column; i++) {
      double d[VG_LEVELS_MAX + 1];

      vg_growth_law_heights(&c->law[c->column[i].law], INFINITY,
                            c->column[i].n_wanted, d);
      lowest = fmin(lowest, d[c->column[i].n_wanted]);
    }
    for (size_t i = 0; i < c->n_column; i++) {
      n_lower += c->column[i].compressed == VG_CAUSE_NEIGHBOUR;
      if (patch[i] < 6) keeps_its_request(&b, i, patch[i], lowest);
    }
    free(patch);
    finish(&b);
  }
  assert_true(n_lower > 1000);
}

static int stop_at_once(void *user)
{
  (void)user;
  return 1;
}

static void refusals_leave_nothing(void **state)
{
  struct bench b = { .options.smooth = 0 };
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  case_post(&b.surface, 0.2, 0);
  start(&b, 0.2);
  b.request[0].law.delta1 = 0;
  assert_int_equal(vg_layers_grow(&b.surface, b.sizing, &b.options, &b.layers,
                                  &b.report, &err),
                   VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "patch 21"));
  assert_null(b.layers.columns.column);
  b.request[0].law.delta1 = 2e-4;
  b.options.stop.ask = stop_at_once;
  assert_int_equal(vg_layers_grow(&b.surface, b.sizing, &b.options, &b.layers,
                                  &b.report, &err),
                   VG_ERR_STOPPED);
  assert_null(b.layers.columns.column);
  assert_null(b.layers.front.x);
  finish(&b);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(two_plates_that_close_to_a_gap),
    cmocka_unit_test(fewer_levels_for_a_smaller_jump),
    cmocka_unit_test(a_slot_narrower_than_an_edge),
    cmocka_unit_test(fans_without_levels),
    cmocka_unit_test(a_right_angle),
    cmocka_unit_test(an_angle_of_30_degrees),
    cmocka_unit_test(a_cube),
    cmocka_unit_test(a_cube_with_fans),
    cmocka_unit_test(a_cone),
    cmocka_unit_test(a_needle),
    cmocka_unit_test(a_sphere_over_a_wall),
    cmocka_unit_test(a_sphere_over_a_symmetry_plane),
    cmocka_unit_test(a_thin_plate),
    cmocka_unit_test(a_thin_plate_with_fans),
    cmocka_unit_test(sharp_edges_between_two_planes),
    cmocka_unit_test(sharp_edges_with_fans),
    cmocka_unit_test(a_post_at_90_degrees),
    cmocka_unit_test(a_post_at_60_to_120_degrees),
    cmocka_unit_test(a_post_at_45_to_135_degrees),
    cmocka_unit_test(a_slide_patch_with_folds),
    cmocka_unit_test(a_point_without_visibility),
    cmocka_unit_test(a_point_without_visibility_gets_a_fan),
    cmocka_unit_test(a_point_without_visibility_with_fans),
    cmocka_unit_test(a_plate_with_slip_upstream),
    cmocka_unit_test(a_window_in_a_wall),
    cmocka_unit_test(levels_and_height_as_requested),
    cmocka_unit_test(a_varying_growth_law),
    cmocka_unit_test(layers_end_at_the_size_along_them),
    cmocka_unit_test(requests_of_sides),
    cmocka_unit_test(refusals_leave_nothing),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
