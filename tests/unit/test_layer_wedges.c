/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* First heights in acute wedges, by random search: two walls at an angle, and
 * balls and cones sunk into a plane, in any orientation. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "fill_support.h"
#include "layer_cases.h"
#include "layers/grow/grow.h"
#include "layers/measure/measure.h"

enum { N_CASES = 60 };

/* Between 0 and 1, reproducible. */
static double chance(uint64_t *state)
{
  *state = *state * 6364136223846793005u + 1442695040888963407u;
  return (double)(*state >> 33) / 2147483648.0;
}

static double between(uint64_t *state, double lo, double hi)
{
  return lo + (hi - lo) * chance(state);
}

static void turn(struct vg_mesh *m, uint64_t *state)
{
  double q[4], length = 0;

  for (int k = 0; k < 4; k++) {
    q[k] = between(state, -1, 1);
    length += q[k] * q[k];
  }
  for (int k = 0; k < 4; k++) q[k] /= sqrt(length);
  case_rotate(m, q);
}

/* Every column with a level keeps its first height. The random heights are up
 * to 0.2 edges, so that some wedges leave no room for it: these columns have no
 * level and a cause. Returns the number of columns of cause "corner". */
static size_t check(struct vg_mesh *surface, double delta1, const char *what,
                    int number)
{
  struct vg_layer_request request[16] = { { .is_wall = 0 } };
  struct vg_layer_options o = VG_LAYER_OPTIONS_INIT;
  struct vg_layers layers = VG_LAYERS_INIT;
  struct vg_layer_report report;
  struct vg_layer_judgement judged;
  struct vg_wall_fields w = VG_WALL_FIELDS_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_sizing *sizing = shape_sizing(surface, 1.2, 0);

  assert_true(surface->n_patch <= 16);
  for (size_t p = 0; p < surface->n_patch; p++) {
    request[p].law = (struct vg_growth_law)VG_GROWTH_LAW_INIT;
    request[p].law.delta1 = delta1;
    request[p].is_wall = surface->patch[p].bc == CASE_WALL;
  }
  o.patch = request;
  if (vg_layers_grow(surface, sizing, &o, &layers, &report, &err) < 0)
    fail_msg("%s %d: %s", what, number, err.text);
  assert_int_equal(vg_layers_judge(surface, &layers.columns, 1, NULL, &judged,
                                   NULL),
                   VG_OK);
  if (judged.n_negative || judged.n_bad_corner || judged.n_bad_pyramid)
    fail_msg(
      "%s %d: %zu cells not positive, %zu prisms and %zu pyramids with a "
      "bad corner",
      what, number, judged.n_negative, judged.n_bad_corner,
      judged.n_bad_pyramid);
  assert_int_equal(vg_layers_fields(surface, &layers.columns, 0, NULL, 1, &w,
                                    NULL),
                   VG_OK);
  for (size_t i = 0; i < w.n; i++) {
    const double *x = surface->point[w.point[i]];

    if (w.level[i] > 0 && !(w.first[i] < 1.0101 * delta1))
      fail_msg("%s %d: first height %g for %g at (%g, %g, %g)", what, number,
               w.first[i], delta1, x[0], x[1], x[2]);
    if (w.level[i] == 0 && w.wanted[i] > 0)
      assert_true(w.cause[i] != VG_CAUSE_NONE && w.cause[i] != VG_CAUSE_SIZE);
  }
  vg_wall_fields_release(&w);
  vg_layers_release(&layers);
  vg_sizing_free(sizing);
  vg_mesh_release(surface);
  return report.cause[VG_CAUSE_CORNER];
}

static void two_walls(void **state)
{
  uint64_t seed = 1;
  size_t n_corner = 0;

  (void)state;
  for (int i = 0; i < N_CASES; i++) {
    struct vg_mesh m = VG_MESH_INIT;
    double angle = between(&seed, 3, 60) * M_PI / 180;
    double h = between(&seed, 0.1, 0.25);

    case_corner(&m, h, cos(angle), sin(angle));
    turn(&m, &seed);
    n_corner += check(&m, h * pow(10, between(&seed, -4, -0.7)), "wedge", i);
  }
  assert_true(n_corner > 0);
}

static void sunk(int is_ball, uint64_t seed)
{
  for (int i = 0; i < N_CASES; i++) {
    struct vg_mesh m = VG_MESH_INIT;
    struct case_sunk body = { .radius = 0.5, .is_ball = is_ball };
    int n = 4 + (int)(8 * chance(&seed));
    double h;

    body.height = is_ball ? 0.5 : between(&seed, 0.05, 0.5);
    body.sunk = body.height * pow(10, between(&seed, -2.5, -0.3));
    /* The edges of the ground follow those of the rim. */
    h = is_ball ? 0.5 * M_PI / n : 1. / n;
    case_sunk_body(&m, h, n, &body);
    turn(&m, &seed);
    check(&m, h * pow(10, between(&seed, -4, -0.7)), is_ball ? "ball" : "cone",
          i);
  }
}

static void balls(void **state)
{
  (void)state;
  sunk(1, 2);
}

static void cones(void **state)
{
  (void)state;
  sunk(0, 3);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(two_walls),
    cmocka_unit_test(balls),
    cmocka_unit_test(cones),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
