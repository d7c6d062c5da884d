/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The engine on one rank: order, counts, records, stops and failures. Also run
 * under the thread sanitizer. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <math.h>
#include <sys/resource.h>

#include "engine_support.h"

static void check_tree(int threads, uint64_t shuffle, int pin)
{
  struct forest f = { .threads = threads, .depth = 5, .pin = pin };
  struct vg_spans s = VG_SPANS_INIT;
  struct vg_error err = VG_ERROR_INIT;
  uint64_t sum = 0;
  long n = 0;

  for (int t = 0; t < 3; t++)
    forest_expect(&f, (char[]){ (char)('a' + t), 0 }, &n, &sum);
  assert_true(n > 500); /* else the test shows nothing */
  assert_int_equal(forest_grow(&f, NULL, 3, shuffle, &s, &err), VG_OK);
  assert_int_equal(f.n_done, n);
  assert_true(f.sum == sum);
  assert_int_equal(f.bad, 0);
  assert_int_equal(f.alive, 0);
  assert_int_equal(s.n, n);
  assert_true(f.last_done == f.last_known);
  vg_spans_release(&s);
}

static void every_task_of_a_tree_runs_once(void **state)
{
  (void)state;
  for (int threads = 1; threads < 5; threads++)
    for (uint64_t shuffle = 0; shuffle < 3; shuffle++)
      check_tree(threads, shuffle, threads % 2 ? 3 : 0);
}

static void nothing_to_do(void **state)
{
  struct forest f = { .threads = 3 };
  struct vg_spans s = VG_SPANS_INIT;

  (void)state;
  assert_int_equal(forest_grow(&f, NULL, 0, 0, &s, NULL), VG_OK);
  assert_int_equal(s.n, 0);
  assert_int_equal(s.n_rank, 1);
  assert_int_equal(s.n_thread, 3);
  vg_spans_release(&s);
}

/* The spans in the order in which one worker ran them. */
static int by_start(const void *a, const void *b)
{
  double s = ((const struct vg_span *)a)->start;
  double t = ((const struct vg_span *)b)->start;

  return s < t ? -1 : s > t;
}

/* One worker takes the task of highest priority among those created so far. */
static void one_worker_keeps_the_order(void **state)
{
  struct forest f = { .threads = 1, .depth = 4 };
  struct vg_spans s = VG_SPANS_INIT;

  (void)state;
  assert_int_equal(forest_grow(&f, NULL, 2, 0, &s, NULL), VG_OK);
  qsort(s.span, s.n, sizeof *s.span, by_start);
  for (size_t i = 0; i < s.n; i++)
    for (size_t k = i + 1; k < s.n; k++) {
      const struct vg_span *a = &s.span[i], *b = &s.span[k];
      size_t made = 0;

      while (made < i && strcmp(s.span[made].path, b->after)) made++;
      if (made < i || !b->after[0]) assert_true(b->estimate <= a->estimate);
    }
  vg_spans_release(&s);
}

static void spans_say_what_happened(void **state)
{
  struct forest f = { .threads = 2, .depth = 4, .spin = 1e-3 };
  struct vg_spans s = VG_SPANS_INIT;

  (void)state;
  assert_int_equal(forest_grow(&f, NULL, 2, 0, &s, NULL), VG_OK);
  for (size_t i = 0; i < s.n; i++) {
    const struct vg_span *a = &s.span[i];
    size_t n = strlen(a->path);

    assert_true(!i || strcmp(s.span[i - 1].path, a->path) < 0);
    assert_int_equal(strlen(a->after), n - 1);
    assert_int_equal(strncmp(a->after, a->path, n - 1), 0);
    assert_true(a->start >= 0 && a->end >= a->start + 1e-3);
    assert_true(a->end <= s.wall);
    assert_true(a->cpu > 0 && a->cpu <= a->end - a->start + 1e-3);
    assert_true(a->rank == 0 && a->home == 0);
    assert_in_range(a->thread, 0, 1);
    assert_int_equal(a->kind, 'T');
    assert_int_equal(a->n_cell, (uint64_t)a->estimate);
    assert_true(!a->bytes_in && !a->bytes_out);
  }
  vg_spans_release(&s);
}

static void a_failure_is_reported(void **state)
{
  (void)state;
  for (int threads = 1; threads < 4; threads++) {
    struct forest f = { .threads = threads, .depth = 6, .fail_at = "a12" };
    struct forest g = { .threads = threads, .depth = 6, .done_fails_at = "b2" };
    struct vg_error err = VG_ERROR_INIT;

    assert_int_equal(forest_grow(&f, NULL, 3, 0, NULL, &err), VG_ERR_GEOMETRY);
    assert_string_equal(err.text, "task a12 fails");
    assert_int_equal(f.alive, 0);
    assert_int_equal(f.n_run, f.n_done);
    assert_int_equal(forest_grow(&g, NULL, 3, 5, NULL, &err), VG_ERR_INPUT);
    assert_string_equal(err.text, "done of b2 fails");
    assert_int_equal(g.alive, 0);
  }
}

static void it_stops_on_request(void **state)
{
  (void)state;
  for (int threads = 1; threads < 4; threads++) {
    struct forest f = { .threads = threads, .depth = 6, .stop_at = "a12" };

    assert_int_equal(forest_grow(&f, NULL, 3, 0, NULL, NULL), VG_ERR_STOPPED);
    assert_int_equal(f.alive, 0);
    assert_int_equal(f.n_run, f.n_done);
    assert_int_equal(f.bad, 0);
  }
}

/* Loops in tasks that create each other, several open at a time. */
static void loops_are_done_once(void **state)
{
  (void)state;
  for (int threads = 1; threads < 5; threads++) {
    struct forest f = {
      .threads = threads, .depth = 4, .loop = 13, .spin_item = 2e-5
    };
    struct vg_spans s = VG_SPANS_INIT;
    uint64_t sum = 0;
    long n = 0, chunks = 13 + 7 + 4 + 2;

    for (int t = 0; t < 3; t++)
      forest_expect(&f, (char[]){ (char)('a' + t), 0 }, &n, &sum);
    assert_int_equal(forest_grow(&f, NULL, 3, 0, &s, NULL), VG_OK);
    assert_int_equal(f.n_done, n);
    assert_true(f.sum == sum);
    assert_int_equal(f.bad, 0);
    assert_int_equal(f.n_body, n * chunks);
    if (threads == 1) assert_int_equal(f.n_foreign, 0);
    vg_spans_release(&s);
  }
}

/* One task with a long loop, all other workers idle: they help, and the record
 * shows it without losing time or counting it twice. */
static void idle_workers_help(void **state)
{
  struct forest f = { .threads = 3, .loop = 60, .spin_item = 2e-3 };
  struct vg_spans s = VG_SPANS_INIT;
  double help = 0, wall;
  const struct vg_span *a;

  (void)state;
  assert_int_equal(forest_grow(&f, NULL, 1, 0, &s, NULL), VG_OK);
  a = &s.span[0];
  assert_int_equal(f.bad, 0);
  assert_true(f.n_foreign > 0);
  assert_true(s.n_help > 0);
  for (size_t i = 0; i < s.n_help; i++) {
    const struct vg_help *h = &s.help[i];

    assert_string_equal(h->path, a->path);
    assert_true(h->rank == 0 && h->thread != a->thread);
    assert_in_range(h->thread, 0, 2);
    assert_true(a->start <= h->start && h->start <= h->end && h->end <= a->end);
    help += h->end - h->start;
  }
  wall = a->end - a->start;
  assert_true(a->loops > 0 && a->loops <= a->cpu);
  /* clocks of three threads, one of which may be sampled between ticks */
  assert_true(a->cpu <= wall + help + 5e-3);
  assert_true(fabs(vg_spans_busy(&s) - (wall + help) / (3 * s.wall)) < 1e-9);
  vg_spans_release(&s);
}

static void loops_are_finished_after_a_stop(void **state)
{
  (void)state;
  for (int threads = 1; threads < 4; threads++) {
    struct forest f = { .threads = threads,
                        .depth = 5,
                        .stop_at = "a12",
                        .loop = 9,
                        .spin_item = 2e-5 };

    assert_int_equal(forest_grow(&f, NULL, 3, 0, NULL, NULL), VG_ERR_STOPPED);
    assert_int_equal(f.alive, 0);
    assert_int_equal(f.n_run, f.n_done);
    assert_int_equal(f.bad, 0);
  }
}

/* Without an engine, and with an empty loop. */
static void a_single_loop(void **state)
{
  int seen[7] = { 0 };

  (void)state;
  vg_engine_loop(NULL, 0, 1, forest_inner, NULL);
  vg_engine_loop(NULL, 7, 3, forest_inner, seen);
  vg_engine_loop(NULL, 7, 0, forest_inner, seen);
  for (int i = 0; i < 7; i++) assert_int_equal(seen[i], 2);
}

static vg_status nop_run(void *user, const struct vg_engine *e,
                         const struct vg_task *task, int worker, void **outcome,
                         struct vg_done *done, struct vg_error *err)
{
  (void)user, (void)e, (void)task, (void)worker, (void)outcome, (void)err;
  done->n_cell = 1;
  return VG_OK;
}

static vg_status nop_done(void *user, struct vg_engine *e,
                          const struct vg_task *task, void *outcome, int rank,
                          struct vg_error *err)
{
  (void)e, (void)task, (void)outcome, (void)rank, (void)err;
  ++*(long *)user;
  return VG_OK;
}

/* Input and outcome NULL: their callbacks are never called. */
static void tasks_without_input(void **state)
{
  static const struct vg_engine_ops ops = { .run = nop_run, .done = nop_done };
  struct vg_engine_options options = { .threads = 2 };
  struct vg_task *t = vg_calloc(5000, sizeof *t);
  long n = 0;

  (void)state;
  for (int i = 0; i < 5000; i++) {
    snprintf(t[i].path, sizeof t[i].path, "%d", i);
    t[i].pinned = i % 2;
  }
  assert_int_equal(vg_engine_run(NULL, &options, &ops, &n, 5000, t, NULL, NULL),
                   VG_OK);
  assert_int_equal(n, 5000);
  free(t);
}

static void refuses_bad_tasks(void **state)
{
  struct forest f = { .threads = 1 };
  struct vg_engine_ops ops = { .run = forest_run,
                               .done = forest_done,
                               .release_input = forest_release };
  struct vg_engine_options options = { .threads = 1 };
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  for (int bad = 0; bad < 4; bad++) {
    struct vg_task t[3] = { forest_task(&f, "a"), forest_task(&f, "b"),
                            forest_task(&f, "c") };

    if (bad == 0) t[1].path[0] = 0;
    if (bad == 1) memset(t[1].path, 'x', sizeof t[1].path);
    if (bad == 2) t[1].priority = strtod("nan", NULL);
    if (bad == 3) t[1].weight = strtod("inf", NULL);
    assert_int_equal(vg_engine_run(NULL, &options, &ops, &f, 3, t, NULL, &err),
                     VG_ERR_INPUT);
    assert_int_equal(f.alive, 0);
    assert_int_equal(f.n_run, 0);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(every_task_of_a_tree_runs_once),
    cmocka_unit_test(nothing_to_do),
    cmocka_unit_test(one_worker_keeps_the_order),
    cmocka_unit_test(spans_say_what_happened),
    cmocka_unit_test(a_failure_is_reported),
    cmocka_unit_test(it_stops_on_request),
    cmocka_unit_test(loops_are_done_once),
    cmocka_unit_test(idle_workers_help),
    cmocka_unit_test(loops_are_finished_after_a_stop),
    cmocka_unit_test(a_single_loop),
    cmocka_unit_test(tasks_without_input),
    cmocka_unit_test(refuses_bad_tasks),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
