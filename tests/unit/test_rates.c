/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The speed of the machine that recorded a timeline. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "partition/model/rates.h"

static int near(double a, double b)
{
  return fabs(a - b) <= 1e-9 * fabs(b);
}

static void add(struct vg_spans *s, char kind, uint64_t cells, uint64_t faces,
                double cpu)
{
  struct vg_span one = {
    .kind = kind, .n_cell = cells, .n_face = faces, .cpu = cpu
  };
  struct vg_error err = VG_ERROR_INIT;

  snprintf(one.path, sizeof one.path, "0%zu%c", s->n, kind);
  assert_int_equal(vg_spans_add(s, &one, &err), VG_OK);
}

/* Tasks that take a us per cell and b us per face, alternately increased and
 * reduced by the share `off`. */
static void add_tasks(struct vg_spans *s, char kind, int n, double a, double b,
                      double off)
{
  for (int i = 0; i < n; i++) {
    uint64_t cells = 1000 * (uint64_t)(1 + i * i % 17),
             faces = 300 + 77 * (uint64_t)(i * 5 % 11);

    add(s, kind, cells, faces,
        (1 + (i % 2 ? off : -off)) * 1e-6 *
          (a * (double)cells + b * (double)faces));
  }
}

static struct vg_rate_fit fit_of(const struct vg_spans *s, char kind)
{
  struct vg_error err = VG_ERROR_INIT;
  struct vg_rate_fit f;

  assert_int_equal(vg_rates_fit(s, kind, &f, &err), VG_OK);
  return f;
}

static void exact_times_are_found(void **state)
{
  struct vg_spans s = VG_SPANS_INIT;
  struct vg_rate_fit f;

  (void)state;
  add_tasks(&s, 'L', 20, 1.5, 2.5, 0);
  add_tasks(&s, 'T', 7, 4, 0.5, 0);
  f = fit_of(&s, 'L');
  assert_true(f.n == 20 && near(f.cell, 1.5e-6) && near(f.face, 2.5e-6));
  assert_true(f.error < 1e-12);
  f = fit_of(&s, 'T');
  assert_true(f.n == 7 && near(f.cell, 4e-6) && near(f.face, 0.5e-6));
  vg_spans_release(&s);
}

static void scatter_gives_the_error_of_a_rate(void **state)
{
  struct vg_spans s = VG_SPANS_INIT;
  struct vg_rate_fit f;

  (void)state;
  add_tasks(&s, 'L', 200, 2, 3, 0.1);
  f = fit_of(&s, 'L');
  assert_true(fabs(f.cell - 2e-6) < 0.1e-6 && fabs(f.face - 3e-6) < 0.6e-6);
  assert_true(f.error > 0.09 && f.error < 0.11);
  vg_spans_release(&s);
}

/* No rate is below 0, and costs that cannot be separated are assigned to the
 * cells. */
static void one_column_stands_for_two(void **state)
{
  struct vg_spans less = VG_SPANS_INIT, alike = VG_SPANS_INIT,
                  none = VG_SPANS_INIT;
  struct vg_rate_fit f;

  (void)state;
  add_tasks(&less, 'L', 30, 3, -1, 0);
  f = fit_of(&less, 'L');
  assert_true(f.n == 30 && f.cell > 2e-6 && f.cell < 3e-6 && f.face == 0);
  for (int i = 0; i < 9; i++) add(&none, 'L', 1000, 0, 2e-3);
  f = fit_of(&none, 'L');
  assert_true(f.n == 9 && near(f.cell, 2e-6) && f.face == 0);
  for (int i = 0; i < 9; i++) add(&alike, 'L', 1000, 100, 2e-3);
  f = fit_of(&alike, 'L');
  assert_true(f.n == 9 && near(f.cell * 1000 + f.face * 100, 2e-3));
  vg_spans_release(&less);
  vg_spans_release(&alike);
  vg_spans_release(&none);
}

static void too_few_tasks_give_no_rate(void **state)
{
  struct vg_rate_fit f[VG_RATE_FITS];
  struct vg_error err = VG_ERROR_INIT;
  struct vg_spans s = VG_SPANS_INIT;
  struct vg_rates r = vg_rates_measured;

  (void)state;
  add_tasks(&s, 'L', 12, 1.25, 0.75, 0);
  add_tasks(&s, 'T', 3, 9, 9, 0);
  add(&s, 'P', 0, 10, 1); /* made nothing */
  assert_int_equal(vg_rates_of(&s, f, &err), VG_OK);
  vg_rates_replace(&r, f);
  assert_true(f[0].n == 12 && f[1].n == 0 && f[2].n == 0);
  assert_true(near(r.leaf.even, 1.25e-6) && near(r.leaf.graded, 1.25e-6));
  assert_true(near(r.leaf.face, 0.75e-6));
  assert_memory_equal(&r.tile, &vg_rates_measured.tile, sizeof r.tile);
  assert_memory_equal(&r.pencil, &vg_rates_measured.pencil, sizeof r.pencil);
  assert_memory_equal(&r.join, &vg_rates_measured.join, sizeof r.join);
  vg_spans_release(&s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(exact_times_are_found),
    cmocka_unit_test(scatter_gives_the_error_of_a_rate),
    cmocka_unit_test(one_column_stands_for_two),
    cmocka_unit_test(too_few_tasks_give_no_rate),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
