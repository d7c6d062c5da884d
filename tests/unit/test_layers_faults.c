/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Layers: each allocation while they grow fails once. There is an error, and no
 * layers, or the same layers; nothing is leaked (ASan). The linker replaces the
 * calls. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/checks.h"
#include "layer_cases.h"
#include "layers/grow/grow.h"

static long n_alloc, fails_at; /* 0: none */

static int fails(void)
{
  return ++n_alloc == fails_at;
}

#include "failing_calls.h"

FAILS_MEMORY

/* wall: condition of the patches with layers. */
static vg_status grow(const struct vg_mesh *m, const struct vg_sizing *sizing,
                      double h, int wall, struct vg_layers *out,
                      struct vg_error *err)
{
  struct vg_layer_request request[16] = { { .is_wall = 0 } };
  struct vg_layer_options o = VG_LAYER_OPTIONS_INIT;
  struct vg_layer_report report;

  assert_true(m->n_patch <= 16);
  for (size_t p = 0; p < m->n_patch; p++) {
    request[p].law = (struct vg_growth_law)VG_GROWTH_LAW_INIT;
    request[p].law.delta1 = 0.05 * h;
    request[p].is_wall = m->patch[p].bc == wall;
  }
  o.patch = request;
  o.fan_angle = 60;
  o.threads = 1;
  return vg_layers_grow(m, sizing, &o, out, &report, err);
}

static void are_same(const struct vg_layers *a, const struct vg_layers *b)
{
  assert_int_equal(a->columns.n_column, b->columns.n_column);
  assert_int_equal(a->front.n_point, b->front.n_point);
  assert_int_equal(a->front.n_face, b->front.n_face);
  assert_memory_equal(a->front.x, b->front.x,
                      a->front.n_point * sizeof *a->front.x);
  assert_memory_equal(a->front.face, b->front.face,
                      a->front.n_face * sizeof *a->front.face);
}

/* Frees the surface. */
static void every_allocation_fails(struct vg_mesh *m, double h, int wall)
{
  struct vg_sizing *sizing = shape_sizing(m, 1.4, 0);
  struct vg_layers first = VG_LAYERS_INIT;
  long n = 0, n_failed = 0;

  for (fails_at = 0; fails_at <= n; fails_at++) {
    struct vg_layers l = VG_LAYERS_INIT;
    struct vg_error err = VG_ERROR_INIT;
    vg_status st;

    n_alloc = 0;
    st = grow(m, sizing, h, wall, fails_at ? &l : &first, &err);
    if (st != VG_OK && (st != VG_ERR_MEMORY || !fails_at || !*err.text))
      fail_msg("allocation %ld: status %d, %s", fails_at, st, err.text);
    if (n_alloc > n) n = n_alloc;
    n_failed += st < 0;
    if (st == VG_OK && fails_at) are_same(&l, &first);
    vg_layers_release(&l);
  }
  fails_at = 0;
  assert_true(n_failed > 100);
  vg_layers_release(&first);
  vg_sizing_free(sizing);
  vg_mesh_release(m);
}

static void on_a_post(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;

  (void)state;
  if (VG_CHECKS_ON) skip(); /* a check without memory ends the program */
  case_post(&m, 0.4, 0.5);
  every_allocation_fails(&m, 0.4, CASE_WALL);
}

/* Their side faces follow the curved post. */
static void around_a_post(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;

  (void)state;
  if (VG_CHECKS_ON) skip();
  case_post(&m, 0.3, 0.2);
  every_allocation_fails(&m, 0.3, CASE_SYMMETRY);
}

static void in_a_wedge(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;

  (void)state;
  if (VG_CHECKS_ON) skip();
  case_wedge(&m, 0.4, 0.12);
  every_allocation_fails(&m, 0.4, CASE_WALL);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(on_a_post),
    cmocka_unit_test(around_a_post),
    cmocka_unit_test(in_a_wedge),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
