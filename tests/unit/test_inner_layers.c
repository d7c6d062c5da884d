/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Layers on both sides of inner surfaces, and on walls that these touch. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "core/mesh/copies.h"
#include "core/mesh/mesh_defects.h"
#include "inner_shapes.h"
#include "layers/grow/grow.h"
#include "partition/cut/doubled.h"

#define LEVELS 5

enum { SHEET = 6, BACK = 7 }; /* Patches after the six of the box. */

struct made {
  struct vg_mesh m;
  struct vg_sizing *sizing;
  struct vg_layers l;
};

/* Layers in a box from -1 to 1 of 8 x 8 x 8 with a sheet of n x n; on the
 * patches whose bits are set. */
static void grow(struct made *s, const double o[3], const double u[3],
                 const double v[3], int n, unsigned walls)
{
  struct vg_layer_request request[BACK + 1] = { { .is_wall = 0 } };
  struct vg_layer_options options = VG_LAYER_OPTIONS_INIT;
  struct vg_layer_report report;
  struct vg_inner_report inner;
  struct vg_error err = VG_ERROR_INIT;

  memset(s, 0, sizeof *s);
  shape_box(&s->m, 8, 1);
  add_sheet(&s->m, o, u, v, n);
  assert_int_equal(put_back(&s->m, &inner, &err), VG_OK);
  s->sizing = shape_sizing(&s->m, 1.2, .3);
  for (int i = 0; i <= BACK; i++) {
    request[i].is_wall = walls >> i & 1;
    request[i].law = (struct vg_growth_law)VG_GROWTH_LAW_INIT;
    request[i].law.delta1 = .004;
    request[i].law.rate1 = .2;
    request[i].n_max = LEVELS;
    request[i].n_exact = 1;
  }
  options.patch = request;
  if (vg_layers_grow(&s->m, s->sizing, &options, &s->l, &report, &err) < 0)
    fail_msg("%s", err.text);
}

static void made_release(struct made *s)
{
  vg_layers_release(&s->l);
  vg_sizing_free(s->sizing);
  vg_mesh_release(&s->m);
}

/* The front is closed, encloses the box without the layers, and has this number
 * of copies of points. */
static void check_front(const struct made *s, uint64_t n_copy)
{
  struct vg_mesh front = vg_front_mesh(&s->l.front, &s->m);
  struct vg_doubled d = { .first = NULL };
  double volume;

  assert_int_equal(vg_mesh_open_edges(&front), 0);
  volume = vg_front_volume(&(const struct vg_front){ .n_point = front.n_point,
                                                     .n_face = front.n_tri,
                                                     .x = front.point,
                                                     .face = front.tri });
  assert_true(volume > 7 && volume < 8);
  assert_int_equal(vg_doubled_new(&d, &front, NULL), VG_OK);
  assert_int_equal(vg_doubled_copies(&d), n_copy);
  vg_doubled_release(&d);
}

static const double *root_of(const struct made *s, size_t column)
{
  return s->m.point[s->l.columns.column[column].root];
}

/* Full layers on both sides but at the free edge, whose points have one
 * column. */
static void layers_taper_to_free_edges(void **state)
{
  const double o[3] = { -.5, -.5, .1 }, u[3] = { 1, 0, 0 }, v[3] = { 0, 1, 0 };
  const struct vg_columns *c;
  struct made s;
  size_t n[2] = { 0, 0 }, n_edge = 0;

  (void)state;
  grow(&s, o, u, v, 8, 1u << SHEET | 1u << BACK);
  c = &s.l.columns;
  for (size_t i = 0; i < c->n_column; i++) {
    const double *p = root_of(&s, i);

    if (fabs(p[0]) == .5 || fabs(p[1]) == .5) {
      n_edge++;
      assert_int_equal(c->column[i].n, 0);
      assert_int_equal(c->column[i].cause, VG_CAUSE_INNER);
      continue;
    }
    assert_int_equal(c->column[i].n, LEVELS);
    assert_int_equal(c->column[i].cause, VG_CAUSE_NONE);
    assert_true(fabs(c->column[i].dir[2]) > .999);
    n[c->column[i].dir[2] > 0]++;
  }
  assert_int_equal(n_edge, 32);
  assert_int_equal(n[0], 49 + 2); /* with the middles of two cut edges */
  assert_int_equal(n[1], 49 + 2);
  check_front(&s, 0);
  made_release(&s);
}

/* On one side only: its other side has no columns. */
static void layers_on_one_side(void **state)
{
  const double o[3] = { -.5, -.5, .1 }, u[3] = { 1, 0, 0 }, v[3] = { 0, 1, 0 };
  struct made s;

  (void)state;
  grow(&s, o, u, v, 8, 1u << BACK);
  assert_int_equal(s.l.columns.n_column, 32 + 49 + 2);
  for (size_t i = 0; i < s.l.columns.n_column; i++)
    assert_true(s.l.columns.column[i].dir[2] < .001);
  check_front(&s, 0);
  made_release(&s);
}

/* A sheet across the box meets walls with layers all around: a column in each
 * corner, and no point is left without layers. */
static void layers_in_corners(void **state)
{
  const double o[3] = { -1, -1, 0 }, u[3] = { 2, 0, 0 }, v[3] = { 0, 2, 0 };
  struct made s;
  size_t n = 0;

  (void)state;
  grow(&s, o, u, v, 8, 0xff);
  for (size_t i = 0; i < s.l.columns.n_column; i++) {
    assert_int_equal(s.l.columns.column[i].n, LEVELS);
    n += root_of(&s, i)[2] == 0;
  }
  assert_int_equal(n, 2 * 81);
  check_front(&s, 0);
  made_release(&s);
}

/* A sheet without layers stands on a wall with layers: these end at it. */
static void walls_taper_to_bare_sheets(void **state)
{
  const double o[3] = { -.5, 0, -1 }, u[3] = { 1, 0, 0 }, v[3] = { 0, 0, 1 };
  struct made s;
  size_t n = 0;

  (void)state;
  grow(&s, o, u, v, 4, 1u << 4);
  for (size_t i = 0; i < s.l.columns.n_column; i++) {
    const double *p = root_of(&s, i);
    const int is_at_sheet = p[1] == 0 && fabs(p[0]) <= .5;

    assert_int_equal(s.l.columns.column[i].n, is_at_sheet ? 0 : LEVELS);
    if (is_at_sheet)
      assert_int_equal(s.l.columns.column[i].cause, VG_CAUSE_INNER);
    n += (size_t)is_at_sheet;
  }
  assert_int_equal(n, 5 + 3);
  check_front(&s, 9 + 3 + 1);
  made_release(&s);
}

/* Columns of the floor slide in a side of the box in which a sheet without
 * layers ends: the side is remeshed around a slit. */
static void a_slit_in_a_slide_patch(void **state)
{
  const double o[3] = { 0, -1, -.5 }, u[3] = { 0, .75, 0 },
               v[3] = { 0, 0, .75 };
  struct made s;

  (void)state;
  grow(&s, o, u, v, 3, 1u << 4);
  for (size_t i = 0; i < s.l.columns.n_column; i++)
    assert_int_equal(s.l.columns.column[i].n, LEVELS);
  check_front(&s, 4 + 2 + 1);
  made_release(&s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(layers_taper_to_free_edges),
    cmocka_unit_test(layers_on_one_side),
    cmocka_unit_test(layers_in_corners),
    cmocka_unit_test(walls_taper_to_bare_sheets),
    cmocka_unit_test(a_slit_in_a_slide_patch),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
