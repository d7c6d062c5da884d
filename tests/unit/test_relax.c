/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Lowering tops of layers under flat cells of the field. */
#include <limits.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "base/comm.h"
#include "base/memory.h"
#include "core/geometry/shape.h"
#include "core/judge/quality.h"
#include "layer_cases.h"
#include "layers/expand/stack.h"
#include "layers/grow/grow.h"
#include "layers/relax/relax.h"
#include "slices_support.h"

static void build(struct model *m, double h)
{
  struct vg_layer_request request[16];
  struct vg_layer_options o = VG_LAYER_OPTIONS_INIT;
  struct vg_fill_options fill = VG_FILL_OPTIONS_INIT;
  struct vg_layer_report report;
  struct vg_fill_report filled;
  struct vg_sizing *sizing = shape_sizing(&m->surface, 1.2, 0);
  struct vg_error err = VG_ERROR_INIT;

  memset(request, 0, sizeof request);
  for (size_t p = 0; p < m->surface.n_patch; p++) {
    request[p].law = (struct vg_growth_law)VG_GROWTH_LAW_INIT;
    request[p].law.delta1 = 1e-2 * h;
    request[p].is_wall = m->surface.patch[p].bc == CASE_WALL;
  }
  o.patch = request;
  o.fan_angle = 60;
  if (vg_layers_grow(&m->surface, sizing, &o, &m->layers, &report, &err) < 0)
    fail_msg("%s", err.text);
  vg_sizing_free(sizing);
  sizing = shape_sizing(FRONT_MESH(&m->layers.front, &m->surface), 1.3, 0);
  if (fill_mesh(FRONT_MESH(&m->layers.front, &m->surface), sizing, &fill,
                &m->field, &filled, &err) < 0)
    fail_msg("%s", err.text);
  vg_sizing_free(sizing);
}

static double shape_at(const struct vg_mesh *m, size_t i)
{
  const uint32_t *v = m->tet[i];

  return vg_shape(m->point[v[0]], m->point[v[1]], m->point[v[2]],
                  m->point[v[3]]);
}

/* Least shape of all cells, and of those at a point. */
static double worst(const struct vg_mesh *m, uint32_t point)
{
  double least = INFINITY;

  for (size_t i = 0; i < m->n_tet; i++) {
    int is_at = point == VG_NO_INDEX;

    for (int k = 0; k < 4; k++) is_at |= m->tet[i][k] == point;
    if (is_at) least = fmin(least, shape_at(m, i));
  }
  return least;
}

/* Moves points of the field close to a top face of a cell, as long as all cells
 * remain positive. Returns the number of points that moved. */
static size_t spoil(struct model *m, uint64_t *seed)
{
  struct vg_mesh *f = &m->field;
  size_t n_front = m->layers.front.n_point, n = 0;

  for (size_t i = 0; i < f->n_tet && n < 12; i++) {
    uint32_t *v = f->tet[i], p = VG_NO_INDEX;
    double old[3], middle[3] = { 0, 0, 0 };
    int n_top = 0;

    for (int k = 0; k < 4; k++) {
      if (v[k] >= n_front) p = v[k];
      else if (vg_layer_column_of(m->layers.front.id[v[k]]) != VG_NO_INDEX) {
        for (int d = 0; d < 3; d++) middle[d] += f->point[v[k]][d] / 3;
        n_top++;
      }
    }
    if (n_top != 3 || p == VG_NO_INDEX || model_random(seed) % 8) continue;
    memcpy(old, f->point[p], sizeof old);
    for (int d = 0; d < 3; d++)
      f->point[p][d] = 0.06 * old[d] + 0.94 * middle[d];
    if (worst(f, p) > 1e-6) n++;
    else memcpy(f->point[p], old, sizeof old);
  }
  return n;
}

static void copy_tops(struct model *m)
{
  for (size_t i = 0; i < m->layers.front.n_point; i++)
    memcpy(m->field.point[i], m->layers.front.x[i], sizeof *m->field.point);
}

static void layers_are_sound(const struct model *m, const struct vg_column *old)
{
  const struct vg_columns *c = &m->layers.columns;
  struct vg_stack *s = vg_alloc(1, sizeof *s);
  double d[VG_LEVELS_MAX + 1], e[VG_LEVELS_MAX + 1];
  uint8_t faulty;

  for (size_t f = 0; f < c->n_face; f++)
    assert_int_equal(vg_stack_first_bad(s, c, &m->surface, f, &faulty), -1);
  for (size_t i = 0; i < c->n_column; i++) {
    const struct vg_column *k = &c->column[i];

    assert_int_equal(k->n, old[i].n);
    assert_true(k->cap <= old[i].cap && k->cap >= 1);
    if (!k->n) continue;
    vg_growth_law_heights(&c->law[k->law], k->cap, k->n, d);
    vg_growth_law_heights(&c->law[k->law], old[i].cap, k->n, e);
    assert_true(d[1] == e[1]);
  }
  free(s);
}

static void whole_mesh_is_valid(const struct model *m)
{
  for (int cells = VG_LAYER_TETS; cells <= VG_LAYER_HEX; cells++) {
    struct vg_mesh all = VG_MESH_INIT;
    struct vg_join_info info;
    struct vg_mesh_report q;
    struct vg_error err = VG_ERROR_INIT;

    if (vg_layers_join(&m->surface, &m->layers, &m->field,
                       (enum vg_layer_cells)cells, 1, &all, &info, &err) < 0)
      fail_msg("%s", err.text);
    assert_int_equal(vg_mesh_judge(&all, NULL, &q, &err), VG_OK);
    assert_true(q.is_valid);
    vg_mesh_release(&all);
  }
}

static void relax(struct model *m, size_t n_slice, int threads, uint64_t seed,
                  struct vg_relax_report *r)
{
  struct vg_slices_point *point;
  struct cut c;
  struct vg_error err = VG_ERROR_INIT;
  size_t n_point;

  cut_make(&c, &m->field, n_slice, m->layers.front.n_point, NULL, seed);
  if (vg_layers_relax(NULL, &m->surface, &m->layers, &c.s, threads, &n_point,
                      &point, r, &err) < 0)
    fail_msg("%s", err.text);
  cut_release(&c);
  copy_tops(m);
  assert_int_equal(n_point, r->n_point);
  for (size_t i = 0; i < n_point; i++)
    memcpy(m->field.point[point[i].id], point[i].x, sizeof point->x);
  free(point);
}

static uint64_t n_moved; /* Points that were moved, in all cases. */

/* The caps of all columns do not depend on slices and threads. */
static void check_case(struct model *m, double h, uint64_t seed)
{
  struct vg_relax_report first, again;
  struct vg_columns *c = &m->layers.columns;
  struct vg_column *old, *once;
  double(*x)[3], (*field)[3], before;
  size_t n_x, n_field;

  build(m, h);
  n_x = m->layers.front.n_point;
  n_field = m->field.n_point;
  assert_true(spoil(m, &seed) > 3);
  before = worst(&m->field, VG_NO_INDEX);
  assert_true(before < 0.03);
  old = vg_alloc(c->n_column, sizeof *old);
  once = vg_alloc(c->n_column, sizeof *once);
  x = vg_alloc(n_x, sizeof *x);
  field = vg_alloc(2 * n_field, sizeof *field);
  memcpy(old, c->column, c->n_column * sizeof *old);
  memcpy(x, m->layers.front.x, n_x * sizeof *x);
  memcpy(field, m->field.point, n_field * sizeof *field);
  relax(m, 1, 1, 1, &first);
  assert_true(first.n_flat > 3 && first.n_column > 0);
  n_moved += first.n_point;
  assert_true(first.n_left < first.n_flat);
  assert_true(worst(&m->field, VG_NO_INDEX) > before);
  layers_are_sound(m, old);
  whole_mesh_is_valid(m);
  memcpy(once, c->column, c->n_column * sizeof *once);
  memcpy(field + n_field, m->field.point, n_field * sizeof *field);
  for (int k = 2; k < 5; k++) {
    memcpy(c->column, old, c->n_column * sizeof *old);
    memcpy(m->layers.front.x, x, n_x * sizeof *x);
    memcpy(m->field.point, field, n_field * sizeof *field);
    relax(m, (size_t)k * 3, k, (uint64_t)k, &again);
    assert_memory_equal(c->column, once, c->n_column * sizeof *once);
    assert_memory_equal(&again, &first, sizeof first);
    assert_memory_equal(m->field.point, field + n_field,
                        n_field * sizeof *field);
  }
  free(old);
  free(once);
  free(x);
  free(field);
  model_release(m);
}

static void flat_cells_on_a_sphere(void **state)
{
  (void)state;
  for (uint64_t seed = 1; seed < 4; seed++) {
    struct model m;

    memset(&m, 0, sizeof m);
    case_sphere(&m.surface, 0.2, 1, CASE_SYMMETRY);
    check_case(&m, 0.2, seed);
  }
  assert_true(n_moved > 0);
}

/* Columns of fans, and columns that slide in a plane. */
static void flat_cells_on_a_wedge(void **state)
{
  struct model m;

  (void)state;
  memset(&m, 0, sizeof m);
  case_wedge(&m.surface, 0.15, 0.2);
  check_case(&m, 0.15, 9);
}

static void nothing_to_do(void **state)
{
  struct vg_relax_report r;
  struct vg_column *old;
  struct model m;

  (void)state;
  memset(&m, 0, sizeof m);
  case_cube(&m.surface, 0.2);
  build(&m, 0.2);
  old = vg_alloc(m.layers.columns.n_column, sizeof *old);
  memcpy(old, m.layers.columns.column, m.layers.columns.n_column * sizeof *old);
  relax(&m, 5, 2, 1, &r);
  assert_true(r.n_left <= r.n_flat);
  if (!r.n_flat)
    assert_memory_equal(m.layers.columns.column, old,
                        m.layers.columns.n_column * sizeof *old);
  free(old);
  model_release(&m);
}

/* --- calls that fail ------------------------------------------------------ */

static long n_call, fails_at; /* 0: none */

static int fails(void)
{
  return fails_at && ++n_call == fails_at;
}

#include "failing_calls.h"

FAILS_MEMORY
FAILS(vg_status, vg_comm_bcast,
      (struct vg_comm * c, int root, struct vg_bytes *b, struct vg_error *err),
      (c, root, b, err), vg_fail(err, VG_ERR_MEMORY, "no broadcast"))
FAILS(vg_status, vg_comm_allgather,
      (struct vg_comm * c, const struct vg_bytes *mine, struct vg_bytes *out,
       struct vg_error *err),
      (c, mine, out, err), vg_fail(err, VG_ERR_MEMORY, "no exchange"))

/* The slices of the test are always there. */
static vg_status get_slice(const struct vg_slices *s, size_t i,
                           struct vg_slice *out, struct vg_error *err)
{
  const long at = fails_at;
  vg_status st;

  fails_at = 0;
  st = cut_get(s, i, out, err);
  fails_at = at;
  return st;
}

/* There is an error, or the same heights. The linker replaces the calls. */
static void every_call_fails(void **state)
{
  struct vg_relax_report r;
  struct vg_column *old, *once;
  uint64_t seed = 2;
  struct model m;
  struct cut c;
  long n_failed = 0;
  size_t size;

  (void)state;
  memset(&m, 0, sizeof m);
  case_sphere(&m.surface, 0.3, 1, CASE_SYMMETRY);
  build(&m, 0.3);
  assert_true(spoil(&m, &seed) > 0);
  size = m.layers.columns.n_column * sizeof *old;
  old = vg_alloc(1, size);
  once = vg_alloc(1, size);
  memcpy(old, m.layers.columns.column, size);
  cut_make(&c, &m.field, 3, m.layers.front.n_point, NULL, 1);
  c.s.get = get_slice;
  for (long last = 1, at = LONG_MAX; last; at = at == LONG_MAX ? 1 : at + 1) {
    struct vg_error err = VG_ERROR_INIT;
    struct vg_slices_point *moved = NULL;
    size_t n_gone = 0;
    vg_status st;

    n_call = 0;
    fails_at = at;
    st = vg_layers_relax(NULL, &m.surface, &m.layers, &c.s, 1, &n_gone, &moved,
                         &r, &err);
    fails_at = 0;
    free(moved);
    last = n_call >= at || at == LONG_MAX;
    n_failed += st < 0;
    assert_true(st == VG_OK || (st == VG_ERR_MEMORY && *err.text));
    if (at == LONG_MAX) memcpy(once, m.layers.columns.column, size);
    if (st == VG_OK) assert_memory_equal(m.layers.columns.column, once, size);
    memcpy(m.layers.columns.column, old, size);
    for (size_t i = 0; i < m.layers.front.n_point; i++)
      memcpy(m.layers.front.x[i], m.field.point[i], sizeof *m.field.point);
  }
  assert_true(n_failed > 10);
  free(old);
  free(once);
  cut_release(&c);
  model_release(&m);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(flat_cells_on_a_sphere),
    cmocka_unit_test(flat_cells_on_a_wedge),
    cmocka_unit_test(nothing_to_do),
    cmocka_unit_test(every_call_fails),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
