/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Layers measured and checked, on columns built by hand. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "base/memory.h"
#include "fill_shapes.h"
#include "layers/measure/measure.h"

enum { SIDE = 8 }; /* the plate has SIDE x SIDE squares of size 1 */

/* A plate z = 0 with the fluid above; its left half is patch 0, its right half
 * patch 1. */
static void make_plate(struct vg_mesh *m, int side)
{
  vg_mesh_add_patch(m, 5, "left");
  vg_mesh_add_patch(m, 6, "right");
  for (int i = 0; i <= side; i++)
    for (int j = 0; j <= side; j++) shape_point(m, i, j, 0);
  for (int i = 0; i < side; i++)
    for (int j = 0; j < side; j++) {
      uint32_t a = (uint32_t)(i * (side + 1) + j), b = a + (uint32_t)side + 1;

      shape_tri(m, a, b, b + 1, 2 * i >= side);
      shape_tri(m, a, b + 1, a + 1, 2 * i >= side);
    }
}

/* One column per point, a face per triangle. */
static void stand(struct vg_columns *c, const struct vg_mesh *m,
                  const double dir[3], int n)
{
  c->n_column = m->n_point;
  c->n_face = m->n_tri;
  c->n_law = 1;
  c->column = vg_calloc(c->n_column, sizeof *c->column);
  c->face = vg_alloc(c->n_face, sizeof *c->face);
  c->face_tri = vg_alloc(c->n_face, sizeof *c->face_tri);
  c->law = vg_alloc(1, sizeof *c->law);
  shape_need(c->column);
  shape_need(c->face);
  shape_need(c->face_tri);
  shape_need(c->law);
  c->law[0] = (struct vg_growth_law){ 1e-5, 0.2, 0, INFINITY, 1 };
  for (size_t i = 0; i < c->n_column; i++) {
    c->column[i] = (struct vg_column){ .root = (uint32_t)i,
                                       .slide = { VG_NO_INDEX, VG_NO_INDEX },
                                       .cap = INFINITY,
                                       .bent = SIZE_MAX,
                                       .n = (uint16_t)n,
                                       .n_wanted = (uint16_t)n,
                                       .n_fit = (uint16_t)n,
                                       .cause = VG_CAUSE_SIZE };
    memcpy(c->column[i].dir, dir, 3 * sizeof *dir);
  }
  memcpy(c->face, m->tri, m->n_tri * sizeof *m->tri);
  for (size_t f = 0; f < c->n_face; f++) c->face_tri[f] = (uint32_t)f;
}

struct plate {
  struct vg_mesh m;
  struct vg_columns c;
};

static int set_up(void **state)
{
  struct plate *p = calloc(1, sizeof *p);
  const double up[3] = { 0, 0, 1 };

  shape_need(p);
  make_plate(&p->m, SIDE);
  stand(&p->c, &p->m, up, 30);
  *state = p;
  return 0;
}

static int tear_down(void **state)
{
  struct plate *p = *state;

  vg_mesh_release(&p->m);
  vg_columns_release(&p->c);
  free(p);
  return 0;
}

static struct vg_wall_fields fields(const struct plate *p)
{
  struct vg_wall_fields w = VG_WALL_FIELDS_INIT;
  struct vg_error err = VG_ERROR_INIT;

  if (vg_layers_fields(&p->m, &p->c, 0, NULL, 1, &w, &err) < 0)
    fail_msg("%s", err.text);
  return w;
}

/* A vertical strip above the border of the plate at x, in a patch of its own.
 */
static void add_strip(struct vg_mesh *m, int x, int is_image)
{
  const uint32_t patch = (uint32_t)(2 + is_image);
  const uint32_t at = (uint32_t)(x * (SIDE + 1)), top = (uint32_t)m->n_point;

  for (uint32_t j = 0; j <= SIDE; j++)
    shape_point(m, x, (int)j, m->point[at + j][2] + 1);
  for (uint32_t j = 0; j < SIDE; j++) {
    const uint32_t a[3] = { at + j, at + j + 1, top + j };
    const uint32_t b[3] = { at + j + 1, top + j + 1, top + j };

    shape_tri(m, a[0], a[1 + is_image], a[2 - is_image], patch);
    shape_tri(m, b[0], b[1 + is_image], b[2 - is_image], patch);
  }
}

/* A slope that continues through periodic patches: the foot of a column that
 * slides in one of them is beyond the other one, whichever is the first. */
static void walls_continue_through_periodic_patches(void **state)
{
  struct plate *p = *state;
  struct vg_periodic pair = { .patch = 7,
                              .image = 8,
                              .shift = { SIDE, 0, SIDE } };

  for (size_t i = 0; i < p->m.n_point; i++) {
    p->m.point[i][2] = p->m.point[i][0];
    p->c.column[i].dir[2] = sqrt(2);
  }
  vg_mesh_add_patch(&p->m, 7, "lo");
  vg_mesh_add_patch(&p->m, 8, "hi");
  add_strip(&p->m, 0, 0);
  add_strip(&p->m, SIDE, 1);
  for (int is_back = 0; is_back < 2; is_back++) {
    struct vg_wall_fields w = VG_WALL_FIELDS_INIT;
    struct vg_error err = VG_ERROR_INIT;

    if (vg_layers_fields(&p->m, &p->c, 1, &pair, 1, &w, &err) < 0)
      fail_msg("%s", err.text);
    assert_int_equal(w.n, (SIDE + 1) * (SIDE + 1));
    for (size_t i = 0; i < w.n; i++) {
      assert_float_equal(w.first[i], 1e-5, 1e-12);
      assert_float_equal(w.total[i], w.total[0], 1e-9);
    }
    vg_wall_fields_release(&w);
    pair = vg_periodic_reverse(&pair);
  }
}

static struct vg_layer_judgement judge(const struct plate *p)
{
  struct vg_layer_judgement r;
  struct vg_error err = VG_ERROR_INIT;

  if (vg_layers_judge(&p->m, &p->c, 1, NULL, &r, &err) < 0)
    fail_msg("%s", err.text);
  return r;
}

/* Heights are sums of up to 30 terms: a few units in the last place. */
static int close_to(double a, double b)
{
  return fabs(a - b) <= 1e-14 * fabs(b);
}

static void heights_of_straight_columns(void **state)
{
  const struct plate *p = *state;
  struct vg_wall_fields w = fields(p);
  double d[31];

  vg_growth_law_heights(p->c.law, INFINITY, 30, d);
  assert_int_equal(w.n, p->m.n_point);
  for (size_t i = 0; i < w.n; i++) {
    assert_int_equal(w.point[i], i);
    assert_int_equal(w.level[i], 30);
    assert_int_equal(w.wanted[i], 30);
    assert_true(w.asked[i] == 1e-5);
    assert_true(close_to(w.first[i], 1e-5));
    assert_true(close_to(w.total[i], d[30]));
    /* differences of sums: the first layers lose digits */
    assert_true(fabs(w.growth[i] - 1.2) < 1e-12);
    assert_int_equal(w.cause[i], VG_CAUSE_SIZE);
    assert_int_equal(w.compressed[i], VG_CAUSE_NONE);
  }
  vg_wall_fields_release(&w);
}

/* A column that leans by 60 degrees and is not lengthened has half the height
 * over the middle of the plate. */
static void a_leaning_column_is_measured_to_the_wall(void **state)
{
  struct plate *p = *state;
  const size_t middle = SIDE / 2 * (SIDE + 1) + SIDE / 2;
  struct vg_column *c = &p->c.column[middle];
  struct vg_wall_fields w;
  double d[31], far;

  c->dir[0] = sqrt(0.75);
  c->dir[2] = 0.5;
  /* the foot of its top is 3.46 away: the root's own triangles are not the
   * nearest ones, but the walk finds those */
  p->c.law[0].delta1 = 0.5;
  c->n = 2;
  p->c.law[0].rate1 = 6;
  vg_growth_law_heights(p->c.law, INFINITY, 2, d);
  far = d[2];
  assert_true(far * c->dir[0] > 3 && far * c->dir[0] < 4);
  w = fields(p);
  assert_true(close_to(w.first[middle], 0.25));
  assert_true(close_to(w.total[middle], 0.5 * far));
  assert_true(fabs(w.growth[middle] - 7) < 1e-12);
  vg_wall_fields_release(&w);
}

/* Two walls at a right angle: the direction between them needs the factor
 * sqrt(2). */
static void the_first_height_in_a_corner(void **state)
{
  struct plate *p = *state;
  const double diagonal[3] = { -1, 0, 1 };
  struct vg_wall_fields w;
  double d[31];

  for (size_t i = 0; i < p->m.n_point; i++)
    if (p->m.point[i][0] > SIDE / 2) {
      p->m.point[i][2] = p->m.point[i][0] - SIDE / 2;
      p->m.point[i][0] = SIDE / 2;
    }
  for (size_t i = 0; i < p->c.n_column; i++)
    memcpy(p->c.column[i].dir, diagonal, sizeof diagonal);
  vg_growth_law_heights(p->c.law, INFINITY, 30, d);
  w = fields(p);
  for (size_t i = 0; i < w.n; i++) {
    const double *x = p->m.point[i];

    if (x[0] == 0 || x[2] == SIDE / 2) continue; /* leaves the plate */
    /* 1e-5 on coordinates of up to 8: 1e-15 / 1e-5 */
    assert_true(fabs(w.first[i] - 1e-5) < 1e-10 * 1e-5);
    assert_true(fabs(w.total[i] - d[30]) < 1e-10 * d[30]);
  }
  vg_wall_fields_release(&w);
}

static void a_point_reports_its_worst_column(void **state)
{
  struct plate *p = *state;
  struct vg_column *c = p->c.column;
  struct vg_wall_fields w;

  /* columns 0 and 1 both stand on point 0 */
  c[1].root = 0;
  c[0].n = 10;
  c[0].n_wanted = c[0].n_fit = 10;
  c[1].n = 12;
  c[1].cause = VG_CAUSE_CORNER;
  c[0].cap = 1.1;
  c[0].compressed = VG_CAUSE_PROXIMITY;
  c[0].dir[2] = 1.05;
  w = fields(p);
  assert_int_equal(w.n, p->m.n_point - 1);
  assert_int_equal(w.level[0], 10);
  assert_int_equal(w.wanted[0], 10);
  assert_int_equal(w.cause[0], VG_CAUSE_CORNER);
  assert_int_equal(w.compressed[0], VG_CAUSE_PROXIMITY);
  assert_true(close_to(w.first[0], 1.05e-5));
  assert_true(fabs(w.growth[0] - 1.2) < 1e-12);
  c[0].n = 0;
  vg_wall_fields_release(&w);
  w = fields(p);
  assert_int_equal(w.level[0], 0);
  assert_true(w.total[0] == 0);
  assert_true(close_to(w.first[0], 1e-5));
  c[1].n = 0;
  vg_wall_fields_release(&w);
  w = fields(p);
  assert_true(w.first[0] == 0 && w.asked[0] == 0 && w.growth[0] == 0);
  vg_wall_fields_release(&w);
}

static void statistics_by_patch(void **state)
{
  struct plate *p = *state;
  const double half = SIDE * SIDE; /* triangles of each patch */
  struct vg_patch_layers *list = NULL, all;
  struct vg_wall_fields w;
  size_t n = 0;

  /* point 0 is a corner of 2 triangles of patch 0; the last point one of 2 of
   * patch 1 */
  p->c.column[0].n = 0;
  p->c.column[0].cause = VG_CAUSE_VISIBILITY;
  p->c.column[p->c.n_column - 1].cap = 1.1;
  p->c.column[p->c.n_column - 1].compressed = VG_CAUSE_CORNER;
  w = fields(p);
  assert_int_equal(vg_layers_patches(&p->m, &p->c, &w, 5e6, 1, &n, &list, &all,
                                     NULL),
                   VG_OK);
  assert_int_equal(n, 2);
  assert_int_equal(list[0].patch, 0);
  assert_int_equal(list[1].patch, 1);
  assert_int_equal(list[0].n_face, SIDE * SIDE);
  assert_int_equal(list[0].n_point, (SIDE / 2 + 1) * (SIDE + 1) - 1);
  assert_int_equal(list[1].n_point, (SIDE / 2 + 1) * (SIDE + 1));
  assert_int_equal(all.n_point, (SIDE + 1) * (SIDE + 1) - 1);
  assert_int_equal(all.n_face, 2 * SIDE * SIDE);
  assert_true(close_to(list[0].full, 100 * (half - 2) / half));
  assert_true(close_to(list[0].any, 100 * (half - 2) / half));
  assert_true(close_to(list[0].uncompressed, 100 * (half - 2) / half));
  assert_true(list[1].full == 100 && list[1].any == 100);
  assert_true(close_to(list[1].uncompressed, 100 * (half - 2) / half));
  assert_true(close_to(all.full, 100 * (half - 1) / half));
  assert_true(close_to(all.uncompressed, 100 * (half - 2) / half));
  assert_int_equal(list[0].cause[VG_CAUSE_VISIBILITY], 2);
  assert_int_equal(list[0].cause[VG_CAUSE_SIZE], SIDE * SIDE - 2);
  assert_int_equal(list[1].compressed[VG_CAUSE_CORNER], 2);
  assert_int_equal(all.compressed[VG_CAUSE_NONE], 2 * SIDE * SIDE - 2);
  assert_true(list[0].level.min == 30 && list[0].level.max == 30);
  assert_true(list[0].level.mean == 30);
  assert_true(list[1].total.min < list[1].total.max);
  assert_true(list[0].first_error < 1e-12);
  assert_true(fabs(all.y_plus.mean / vg_y_plus(1e-5, 5e6, 1) - 1) < 1e-12);
  free(list);
  assert_int_equal(vg_layers_patches(&p->m, &p->c, &w, 0, 0, &n, &list, NULL,
                                     NULL),
                   VG_OK);
  assert_true(list[0].y_plus.max == 0);
  free(list);
  vg_wall_fields_release(&w);
}

/* Columns for which the local size requests no level: their faces have no
 * layers and are not full. */
static void faces_without_a_request_are_not_full(void **state)
{
  struct plate *p = *state;
  struct vg_patch_layers *list = NULL, all;
  struct vg_wall_fields w;
  size_t n = 0, n_bare = 0;

  for (size_t i = 0; i < p->c.n_column; i++) {
    struct vg_column *c = &p->c.column[i];

    if (i < p->c.n_column / 2) c->n = c->n_fit = c->n_wanted = 0;
  }
  for (size_t f = 0; f < p->c.n_face; f++)
    n_bare += p->c.face[f][0] < p->c.n_column / 2 ||
              p->c.face[f][1] < p->c.n_column / 2 ||
              p->c.face[f][2] < p->c.n_column / 2;
  w = fields(p);
  assert_true(w.share[0] == 0 && w.share[w.n - 1] == 1);
  assert_int_equal(vg_layers_patches(&p->m, &p->c, &w, 0, 0, &n, &list, &all,
                                     NULL),
                   VG_OK);
  assert_true(n_bare > 0 && n_bare < all.n_face);
  assert_int_equal(all.n_bare, n_bare);
  assert_int_equal(list[0].n_bare + list[1].n_bare, n_bare);
  assert_true(
    close_to(all.full, 100 * (1 - (double)n_bare / (double)all.n_face)));
  assert_true(all.full == all.any && all.uncompressed == all.full);
  assert_true(all.share_mean < 0.6 && all.share_low == 0);
  assert_int_equal(all.cause[VG_CAUSE_SIZE], all.n_face);
  free(list);
  vg_wall_fields_release(&w);
}

static void straight_columns_are_valid(void **state)
{
  const struct plate *p = *state;
  struct vg_layer_judgement r = judge(p);

  assert_int_equal(r.n_cell, 3 * 30 * p->m.n_tri);
  assert_int_equal(r.n_prism, 30 * p->m.n_tri);
  assert_int_equal(r.n_negative + r.n_bad_corner + r.n_pyramid, 0);
  assert_int_equal(r.n_step + r.n_off_plane, 0);
  assert_true(fabs(r.top_angle_min - 45) < 1e-6);
}

/* Level 30 removed from one corner point: each of its two faces loses a cell
 * and has a pyramid on top instead of a prism. */
static void a_missing_level_makes_pyramids(void **state)
{
  struct plate *p = *state;
  struct vg_layer_judgement r;

  p->c.column[0].n = 29;
  r = judge(p);
  assert_int_equal(r.n_cell, 3 * 30 * p->m.n_tri - 2);
  assert_int_equal(r.n_prism, 30 * p->m.n_tri - 2);
  assert_int_equal(r.n_pyramid, 2);
  assert_int_equal(r.n_negative + r.n_bad_corner + r.n_bad_pyramid, 0);
  assert_int_equal(r.n_step, 0);
  p->c.column[0].n = 28;
  r = judge(p);
  assert_int_equal(r.n_cell, 3 * 30 * p->m.n_tri - 4);
  assert_int_equal(r.n_step, 3); /* edges, not faces */
  assert_int_equal(r.n_negative, 0);
}

/* Columns that lean across each other invert the cells above some height. */
static void crossing_columns_are_found(void **state)
{
  struct plate *p = *state;
  const size_t middle = SIDE / 2 * (SIDE + 1) + SIDE / 2;
  struct vg_layer_judgement r;

  p->c.law[0] = (struct vg_growth_law){ 0.25, 0, 0, INFINITY, 1 };
  for (size_t i = 0; i < p->c.n_column; i++) p->c.column[i].n = 5;
  p->c.column[middle].dir[0] = 1;
  r = judge(p);
  /* at level 4 it reaches its neighbour's column: exactly zero volume */
  assert_true(r.n_negative > 0 && r.n_bad_corner > 0);
  for (size_t i = 0; i < p->c.n_column; i++) p->c.column[i].n = 3;
  r = judge(p);
  assert_int_equal(r.n_negative + r.n_bad_corner, 0);
  for (size_t i = 0; i < p->c.n_column; i++) p->c.column[i].dir[2] = -1;
  r = judge(p);
  assert_int_equal(r.n_negative, r.n_cell);
  assert_int_equal(r.n_bad_corner, r.n_prism);
}

/* A column within the plate: its first cells are exactly flat. */
static void zero_volume_is_not_positive(void **state)
{
  struct plate *p = *state;
  struct vg_layer_judgement r;

  p->c.column[0].dir[2] = 0;
  p->c.column[0].dir[1] = 1;
  r = judge(p);
  assert_true(r.n_negative >= 2);
}

static void points_that_leave_a_slide_plane(void **state)
{
  struct plate *p = *state;
  struct vg_layer_judgement r;
  size_t side;

  /* a third patch in the plane y = 0, below the plate: one triangle */
  vg_mesh_add_patch(&p->m, 7, "symmetry");
  side = p->m.n_point;
  shape_point(&p->m, 0, 0, -1);
  shape_tri(&p->m, 0, (uint32_t)side, SIDE + 1, 2);
  for (uint32_t i = 0; i <= SIDE; i++) p->c.column[i * (SIDE + 1)].slide[0] = 2;
  r = judge(p);
  assert_int_equal(r.n_off_plane, 0);
  p->c.column[SIDE + 1].dir[1] = 1e-12;
  r = judge(p);
  assert_int_equal(r.n_off_plane, 1);
}

/* Two columns on each point of a ridge along y, and two virtual faces on each
 * of its edges: the fan of a right angle. */
static void make_ridge(struct plate *p, int n)
{
  struct vg_columns *c = &p->c;
  uint32_t edge;
  size_t f;

  vg_mesh_release(&p->m);
  vg_columns_release(c);
  vg_mesh_add_patch(&p->m, 5, "both");
  for (int j = 0; j <= n; j++) { /* ridge, top, side */
    shape_point(&p->m, 0, j, 0);
    shape_point(&p->m, -1, j, 0);
    shape_point(&p->m, 0, j, -1);
  }
  for (uint32_t j = 0; j < (uint32_t)n; j++) {
    uint32_t a = 3 * j, b = a + 3;

    shape_tri(&p->m, a, b, b + 1, 0);
    shape_tri(&p->m, a, b + 1, a + 1, 0);
    shape_tri(&p->m, a, a + 2, b + 2, 0);
    shape_tri(&p->m, a, b + 2, b, 0);
  }
  stand(c, &p->m, (const double[3]){ 0, 0, 1 }, 3);
  c->law[0].delta1 = 0.1;
  /* columns 4 j: up from the ridge, 4 j + 1: sideways, then top and side */
  free(c->column);
  c->n_column = 4 * ((size_t)n + 1);
  c->column = vg_calloc(c->n_column, sizeof *c->column);
  shape_need(c->column);
  for (size_t i = 0; i < c->n_column; i++) {
    c->column[i] = (struct vg_column){
      .root = (uint32_t)(i / 4 * 3 + (i % 4 > 1 ? i % 4 - 1 : 0)),
      .slide = { VG_NO_INDEX, VG_NO_INDEX },
      .cap = INFINITY,
      .bent = SIZE_MAX,
      .n = 3,
      .n_wanted = 3,
      .n_fit = 3
    };
    c->column[i].dir[i % 2 ? 0 : 2] = 1;
  }
  c->face = vg_realloc(c->face, 6 * (size_t)n, sizeof *c->face);
  c->face_tri = vg_realloc(c->face_tri, 6 * (size_t)n, sizeof *c->face_tri);
  shape_need(c->face);
  shape_need(c->face_tri);
  for (f = 0; f < c->n_face; f++) {
    int is_top = f % 4 < 2;

    for (int k = 0; k < 3; k++) {
      uint32_t point = p->m.tri[f][k], at = point / 3 * 4;

      c->face[f][k] = point % 3 ? at + point % 3 + 1 : at + !is_top;
    }
  }
  for (int j = 0; j < n; j++, f += 2) {
    edge = 4 * (uint32_t)j;
    memcpy(c->face[f], (uint32_t[3]){ edge, edge + 1, edge + 5 },
           sizeof c->face[f]);
    memcpy(c->face[f + 1], (uint32_t[3]){ edge, edge + 5, edge + 4 },
           sizeof c->face[f]);
    c->face_tri[f] = c->face_tri[f + 1] = VG_NO_INDEX;
  }
  c->n_face = f;
}

static void virtual_faces_of_a_ridge(void **state)
{
  struct plate *p = *state;
  struct vg_layer_judgement r;
  struct vg_wall_fields w;

  make_ridge(p, 4);
  r = judge(p);
  /* 16 faces of triangles with 9 cells. Of the 8 virtual faces those with two
   * columns at the near point lose one cell of level 0, the others two */
  assert_int_equal(r.n_cell, 16 * 9 + 4 * 8 + 4 * 7);
  assert_int_equal(r.n_negative + r.n_bad_corner, 0);
  /* mixed cells: all faces touch the ridge, so there is no prism at level 0;
   * real faces have one corner on it or two */
  assert_int_equal(r.n_prism, 24 * 2);
  assert_int_equal(r.n_pyramid, 8);
  assert_int_equal(r.n_wall_tet, 8 * 1 + 8 * 3 + 4 * 2 + 4 * 1);
  assert_int_equal(r.n_bad_pyramid + r.n_bad_wall_tet + r.n_step, 0);
  w = fields(p);
  assert_int_equal(w.n, 15);
  for (size_t i = 0; i < w.n; i++) assert_true(fabs(w.first[i] - 0.1) < 1e-14);
  vg_wall_fields_release(&w);
  /* reversed faces give only inverted cells */
  for (size_t f = 16; f < p->c.n_face; f++) {
    uint32_t t = p->c.face[f][0];

    p->c.face[f][0] = p->c.face[f][1];
    p->c.face[f][1] = t;
  }
  r = judge(p);
  assert_int_equal(r.n_negative, 4 * 8 + 4 * 7);
  assert_int_equal(r.n_bad_corner, 8 * 2);
  assert_int_equal(r.n_bad_wall_tet, 4 * 2 + 4 * 1);
}

/* Many chunks, some of them shared by workers. */
static void any_number_of_threads(void **state)
{
  const double up[3] = { 0.1, 0.2, 1 };
  struct plate p = { .m = VG_MESH_INIT };
  struct vg_layer_judgement r[3];
  struct vg_wall_fields w[3];

  (void)state;
  make_plate(&p.m, 60);
  stand(&p.c, &p.m, up, 25);
  for (size_t i = 0; i < p.c.n_column; i++) {
    p.c.column[i].n = (uint16_t)(20 + i % 5);
    p.c.column[i].dir[0] = (double)(i % 7);
  }
  for (int t = 0; t < 3; t++) {
    assert_int_equal(vg_layers_judge(&p.m, &p.c, t + 1, NULL, &r[t], NULL),
                     VG_OK);
    assert_int_equal(vg_layers_fields(&p.m, &p.c, 0, NULL, t + 1, &w[t], NULL),
                     VG_OK);
    assert_memory_equal(&r[t], &r[0], sizeof r[0]);
    assert_memory_equal(w[t].first, w[0].first, w[0].n * sizeof *w[0].first);
    assert_memory_equal(w[t].total, w[0].total, w[0].n * sizeof *w[0].total);
    assert_memory_equal(w[t].growth, w[0].growth, w[0].n * sizeof *w[0].first);
  }
  assert_true(r[0].n_negative == 0 && r[0].n_step > 0);
  for (int t = 0; t < 3; t++) vg_wall_fields_release(&w[t]);
  vg_mesh_release(&p.m);
  vg_columns_release(&p.c);
}

static void too_many_levels_are_refused(void **state)
{
  struct plate *p = *state;
  struct vg_layer_judgement r = { .n_cell = 7 };
  struct vg_wall_fields w = VG_WALL_FIELDS_INIT;
  struct vg_error err = VG_ERROR_INIT;

  p->c.column[3].n = VG_LEVELS_MAX + 1;
  assert_int_equal(vg_layers_judge(&p->m, &p->c, 1, NULL, &r, &err),
                   VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "column 4"));
  assert_int_equal(r.n_cell, 7);
  assert_int_equal(vg_layers_fields(&p->m, &p->c, 0, NULL, 1, &w, &err),
                   VG_ERR_INPUT);
  assert_null(w.point);
}

static void no_columns_give_empty_results(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_columns c = { .n_column = 0 };
  struct vg_layer_judgement r;
  struct vg_wall_fields w = VG_WALL_FIELDS_INIT;
  struct vg_patch_layers *list = NULL, all;
  size_t n = 9;

  (void)state;
  assert_int_equal(vg_layers_judge(&m, &c, 0, NULL, &r, NULL), VG_OK);
  assert_int_equal(r.n_cell, 0);
  assert_true(r.top_angle_min == 180);
  assert_int_equal(vg_layers_fields(&m, &c, 0, NULL, 0, &w, NULL), VG_OK);
  assert_int_equal(vg_layers_patches(&m, &c, &w, 0, 0, &n, &list, &all, NULL),
                   VG_OK);
  assert_int_equal(n, 0);
  assert_true(all.full == 0 && all.first.max == 0);
  free(list);
  vg_wall_fields_release(&w);
}

#define ON_PLATE(test) cmocka_unit_test_setup_teardown(test, set_up, tear_down)

int main(void)
{
  const struct CMUnitTest tests[] = {
    ON_PLATE(heights_of_straight_columns),
    ON_PLATE(a_leaning_column_is_measured_to_the_wall),
    ON_PLATE(the_first_height_in_a_corner),
    ON_PLATE(a_point_reports_its_worst_column),
    ON_PLATE(statistics_by_patch),
    ON_PLATE(faces_without_a_request_are_not_full),
    ON_PLATE(straight_columns_are_valid),
    ON_PLATE(a_missing_level_makes_pyramids),
    ON_PLATE(crossing_columns_are_found),
    ON_PLATE(zero_volume_is_not_positive),
    ON_PLATE(points_that_leave_a_slide_plane),
    ON_PLATE(virtual_faces_of_a_ridge),
    ON_PLATE(walls_continue_through_periodic_patches),
    cmocka_unit_test(any_number_of_threads),
    ON_PLATE(too_many_levels_are_refused),
    cmocka_unit_test(no_columns_give_empty_results),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
