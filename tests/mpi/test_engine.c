/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The engine on several ranks: the same results as on one, pinned tasks, large
 * inputs, stops and failures that every rank learns of, and the cost of a task
 * and of an idle rank (printed). */
#define _GNU_SOURCE
#include "mpi_support.h"

#include <sys/resource.h>
#include <unistd.h>

#include "../unit/engine_support.h"

static uint64_t total(uint64_t v)
{
  assert_true(vg_comm_sum(job, 1, &v, NULL) == VG_OK);
  return v;
}

static void check_rest(const struct forest *f)
{
  assert_true(total((uint64_t)f->bad) == 0);
  assert_true(total((uint64_t)f->alive) == 0);
  assert_true(total((uint64_t)f->n_run) == total((uint64_t)f->n_done));
}

static void check_spans(const struct forest *f, const struct vg_spans *s,
                        long n)
{
  assert_true(s->n_rank == f->size && s->n_thread == f->threads);
  assert_true(f->rank ? (long)s->n == f->n_run : (long)s->n == n);
  for (size_t i = 0; i < s->n; i++) {
    const struct vg_span *a = &s->span[i];

    assert_true(!i || strcmp(s->span[i - 1].path, a->path) < 0);
    assert_true(a->home == (a->path[0] - 'a') % f->size);
    assert_true(f->rank ? a->rank == f->rank : a->rank < f->size);
    assert_true(a->thread >= 0 && a->thread < f->threads);
    assert_true(strlen(a->after) == strlen(a->path) - 1);
    assert_true(!a->after[0] || !strncmp(a->after, a->path, strlen(a->after)));
    assert_true((a->rank == a->home) ==
                (a->bytes_in < sizeof(struct forest_input) + f->ballast));
    assert_true((a->rank == a->home) ==
                (a->bytes_out < sizeof(struct forest_outcome)));
    assert_true(a->start <= a->end && a->end <= s->wall);
    assert_true(a->n_cell == (uint64_t)a->estimate);
  }
}

/* Tasks run away from their home rank. Which rank is fast enough is random in a
 * single run, but not over all runs together. */
static uint64_t n_away;

/* Trees begin on the ranks in turn; a single tree is on rank 0 only. */
static void same_result(int n_tree, int threads, uint64_t shuffle, int pin,
                        double spin)
{
  struct forest f = {
    .threads = threads, .depth = 4, .pin = pin, .spin = spin
  };
  struct vg_spans s = VG_SPANS_INIT;
  uint64_t sum = 0;
  long n = 0;

  for (int t = 0; t < n_tree; t++)
    forest_expect(&f, (char[]){ (char)('a' + t), 0 }, &n, &sum);
  assert_true(forest_grow(&f, job, n_tree, shuffle, &s, NULL) == VG_OK);
  assert_true(total((uint64_t)f.n_done) == (uint64_t)n);
  assert_true(total(f.sum) == sum);
  check_rest(&f);
  check_spans(&f, &s, n);
  n_away += total((uint64_t)f.n_moved);
  vg_spans_release(&s);
}

static void all_schedules(void **state)
{
  (void)state;
  for (int threads = 1; threads < 4; threads++)
    for (uint64_t shuffle = 0; shuffle < 3; shuffle++) {
      same_result(1, threads, shuffle, 0, 0);
      same_result(3, threads, shuffle, 3, 0);
      same_result(1, threads, shuffle, 4, 2e-4);
    }
  same_result(0, 2, 0, 0, 0);
  same_result(2, 2, 0, 1, 0); /* all pinned */
  if (vg_comm_size(job) > 1) assert_true(n_away > 0);
}

/* For every task that moves its home, `done` is called on the executing rank:
 * the children are at home there, and the outcome does not travel. One task of
 * three moves, then all. */
static void tasks_can_move_their_home(void **state)
{
  uint64_t away = 0, elsewhere = 0;

  (void)state;
  for (int move = 3; move > 0; move -= 2)
    for (uint64_t shuffle = 0; shuffle < 2; shuffle++) {
      struct forest f = {
        .threads = 2, .depth = 4, .move = move, .pin = 5, .spin = 2e-4
      };
      struct vg_spans s = VG_SPANS_INIT;
      uint64_t sum = 0;
      long n = 0;

      forest_expect(&f, "a", &n, &sum);
      assert_true(forest_grow(&f, job, 1, shuffle, &s, NULL) == VG_OK);
      assert_true(total((uint64_t)f.n_done) == (uint64_t)n);
      assert_true(total(f.sum) == sum);
      check_rest(&f);
      for (size_t i = 0; i < s.n; i++) {
        uint64_t digest = forest_digest(s.span[i].path);

        if (digest / 5 % (uint64_t)move) continue;
        assert_true(s.span[i].bytes_out == 0);
        away += s.span[i].rank != s.span[i].home;
        elsewhere += s.span[i].home != 0;
      }
      vg_spans_release(&s);
    }
  if (vg_comm_size(job) > 1) assert_true(total(away) > 0);
  if (vg_comm_size(job) > 1) assert_true(total(elsewhere) > 0);
}

/* Loops in tasks of several ranks; rank 0 learns who helped. */
static void ranks_have_loops(void **state)
{
  struct forest f = { .threads = 2, .depth = 3, .loop = 13, .spin_item = 2e-4 };
  struct vg_spans s = VG_SPANS_INIT;
  uint64_t sum = 0, helped[2] = { 0, 0 };
  long n = 0;

  (void)state;
  forest_expect(&f, "a", &n, &sum);
  assert_true(forest_grow(&f, job, 1, 0, &s, NULL) == VG_OK);
  assert_true(total((uint64_t)f.n_done) == (uint64_t)n);
  check_rest(&f);
  for (size_t i = 0; i < s.n_help; i++) {
    const struct vg_help *h = &s.help[i];

    assert_true(h->path[0] == 'a' && h->start <= h->end);
    assert_true(h->rank >= 0 && h->rank < f.size);
    assert_true(h->thread >= 0 && h->thread < 2);
    helped[0] += h->rank == f.rank;
  }
  helped[1] = total(helped[0]);
  if (!f.rank) assert_true(helped[1] == s.n_help);
  assert_true((total((uint64_t)f.n_foreign) > 0) == (helped[1] > 0));
  vg_spans_release(&s);
}

/* Moved tasks that fail, or are stopped, leave no data on any rank. */
static void moved_and_stopped(void **state)
{
  struct forest f = {
    .threads = 2, .depth = 4, .move = 1, .spin = 1e-4, .fail_at = "a12"
  };
  struct forest g = {
    .threads = 2, .depth = 4, .move = 1, .spin = 1e-4, .stop_at = "a12"
  };

  (void)state;
  assert_true(forest_grow(&f, job, 2, 0, NULL, NULL) == VG_ERR_GEOMETRY);
  check_rest(&f);
  assert_true(forest_grow(&g, job, 2, 0, NULL, NULL) == VG_ERR_STOPPED);
  check_rest(&g);
}

static int ends_with(const char *text, const char *end)
{
  size_t n = strlen(text), m = strlen(end);

  return n >= m && !strcmp(text + n - m, end);
}

static void a_failure_reaches_all_ranks(void **state)
{
  (void)state;
  for (uint64_t shuffle = 0; shuffle < 4; shuffle++) {
    struct forest f = {
      .threads = 2, .depth = 4, .spin = 1e-4, .fail_at = "a12"
    };
    struct vg_error err = VG_ERROR_INIT;
    int run_here;

    assert_int_equal(forest_grow(&f, job, 3, shuffle, NULL, &err),
                     VG_ERR_GEOMETRY);
    assert_true(ends_with(err.text, "task a12 fails"));
    run_here = !strncmp(err.text, "task", 4);
    assert_true(run_here || !strncmp(err.text, "rank ", 5));
    assert_true(total((uint64_t)run_here) == 1);
    check_rest(&f);
  }
}

static void other_failures(void **state)
{
  struct forest f = { .threads = 1, .depth = 4, .done_fails_at = "a3" };
  struct forest g = {
    .threads = 1, .depth = 4, .spin = 1e-3, .pack_fails_at = "a3"
  };
  struct vg_error err = VG_ERROR_INIT;
  vg_status st;

  (void)state;
  assert_true(forest_grow(&f, job, 1, 0, NULL, &err) == VG_ERR_INPUT);
  assert_true(ends_with(err.text, "done of a3 fails"));
  check_rest(&f);
  st = forest_grow(&g, job, 1, 0, NULL, &err); /* it may stay at home */
  assert_true(st == VG_OK ||
              (st == VG_ERR_MEMORY && ends_with(err.text, "packing fails")));
  check_rest(&g);
}

static void it_stops(void **state)
{
  (void)state;
  for (int threads = 1; threads < 3; threads++) {
    struct forest f = {
      .threads = threads, .depth = 4, .spin = 1e-4, .stop_at = "a12"
    };

    assert_true(forest_grow(&f, job, 4, 0, NULL, NULL) == VG_ERR_STOPPED);
    check_rest(&f);
  }
}

/* One rank receives the stop signal before anything has begun. */
static void one_rank_stops_all(void **state)
{
  struct forest f = { .threads = 1, .depth = 9, .spin = 2e-3 };

  (void)state;
  f.stop = vg_comm_rank(job) == vg_comm_size(job) - 1;
  assert_true(forest_grow(&f, job, 4, 0, NULL, NULL) == VG_ERR_STOPPED);
  check_rest(&f);
}

static void large_inputs(void **state)
{
  struct forest f = { .threads = 2, .depth = 1, .ballast = 10 << 20 };

  (void)state;
  assert_true(forest_grow(&f, job, 4, 0, NULL, NULL) == VG_OK);
  assert_true(total((uint64_t)f.n_done) == 20);
  check_rest(&f);
}

/* --- tiny tasks, and the cost ------------------------------------------- */

struct tiny {
  long n_run, n_done;
  double sleep;
};

static vg_status tiny_run(void *user, const struct vg_engine *e,
                          const struct vg_task *task, int worker,
                          void **outcome, struct vg_done *done,
                          struct vg_error *err)
{
  struct tiny *t = user;

  (void)e, (void)task, (void)worker, (void)outcome, (void)err;
  if (t->sleep > 0) usleep((useconds_t)(1e6 * t->sleep));
  t->n_run++;
  done->n_cell = 1;
  return VG_OK;
}

static vg_status tiny_done(void *user, struct vg_engine *e,
                           const struct vg_task *task, void *outcome, int rank,
                           struct vg_error *err)
{
  (void)e, (void)task, (void)outcome, (void)rank, (void)err;
  ((struct tiny *)user)->n_done++;
  return VG_OK;
}

/* n tasks without input, all of rank 0; `pinned` or free. Returns seconds. */
static double run_tiny(size_t n, int pinned, double sleep, long *n_run)
{
  static const struct vg_engine_ops ops = { .run = tiny_run,
                                            .done = tiny_done };
  struct vg_engine_options options = { .threads = 1 };
  struct tiny tiny = { .sleep = sleep };
  struct vg_task *task = vg_calloc(n, sizeof *task);
  struct vg_spans s = VG_SPANS_INIT;
  double wall;

  assert_true(task != NULL);
  for (size_t i = 0; i < n; i++) {
    snprintf(task[i].path, sizeof task[i].path, "%zu", i);
    task[i].pinned = pinned;
  }
  if (vg_comm_rank(job)) n = 0;
  assert_int_equal(vg_engine_run(job, &options, &ops, &tiny, n, task, &s, NULL),
                   VG_OK);
  assert_true(tiny.n_done == (long)n);
  assert_true(total((uint64_t)tiny.n_run) == total(n));
  *n_run = tiny.n_run;
  wall = s.wall;
  vg_spans_release(&s);
  free(task);
  return wall;
}

/* Some tasks have a work estimate and some do not. The tasks without one end
 * before any task with one begins; the latter are assigned to the workers in
 * turn, largest first. */
static void work_is_assigned_statically(void **state)
{
  enum { N = 29, N_FREE = 3, THREADS = 3 };
  static const struct vg_engine_ops ops = { .run = tiny_run,
                                            .done = tiny_done };
  struct vg_engine_options options = { .threads = THREADS, .cyclic = 1 };
  struct tiny tiny = { .sleep = 1e-3 };
  struct vg_spans s = VG_SPANS_INIT;
  struct vg_task task[N] = { { .input = NULL } };
  double ended = 0;

  (void)state;
  for (int i = 0; i < N; i++) {
    snprintf(task[i].path, sizeof task[i].path, "%02d", i);
    task[i].weight = 1;
    if (i >= N_FREE) task[i].work = 1 + i * 7 % N; /* all different */
    task[i].moves = i % 2;
  }
  assert_int_equal(vg_engine_run(job, &options, &ops, &tiny,
                                 vg_comm_rank(job) ? 0 : N, task, &s, NULL),
                   VG_OK);
  assert_true(total((uint64_t)tiny.n_done) == N);
  for (size_t i = 0; i < s.n && !vg_comm_rank(job); i++)
    if (!(s.span[i].work > 0) && s.span[i].end > ended) ended = s.span[i].end;
  for (size_t i = 0; i < s.n && !vg_comm_rank(job); i++) {
    const struct vg_span *a = &s.span[i];
    int before = 0;

    if (!(a->work > 0)) continue;
    for (size_t k = 0; k < s.n; k++) before += s.span[k].work > a->work;
    assert_true(a->rank == before / THREADS % vg_comm_size(job));
    assert_true(a->thread == before % THREADS);
    if (!a->rank) assert_true(a->start >= ended); /* clocks of ranks differ */
  }
  vg_spans_release(&s);
}

/* Static assignment does not change the results; failures and stops leave no
 * data. */
static void static_assignment_keeps_the_results(void **state)
{
  struct forest f = { .threads = 2, .depth = 4, .spin = 1e-4, .deal = 1 };
  struct forest g = {
    .threads = 2, .depth = 4, .spin = 1e-4, .deal = 1, .fail_at = "a12"
  };
  struct forest h = { .threads = 2,
                      .depth = 4,
                      .spin = 1e-4,
                      .deal = 1,
                      .stop_at = "a12",
                      .move = 3 };
  uint64_t sum = 0;
  long n = 0;

  (void)state;
  for (int t = 0; t < 3; t++)
    forest_expect(&f, (char[]){ (char)('a' + t), 0 }, &n, &sum);
  assert_true(forest_grow(&f, job, 3, 0, NULL, NULL) == VG_OK);
  assert_true(total((uint64_t)f.n_done) == (uint64_t)n);
  assert_true(total(f.sum) == sum);
  check_rest(&f);
  assert_true(forest_grow(&g, job, 3, 0, NULL, NULL) == VG_ERR_GEOMETRY);
  check_rest(&g);
  assert_true(forest_grow(&h, job, 3, 0, NULL, NULL) == VG_ERR_STOPPED);
  check_rest(&h);
}

static void many_tiny_tasks(void **state)
{
  size_t n = 20000;
  long n_run;
  double wall = run_tiny(n, 0, 0, &n_run);

  (void)state;
  printf("rank %d: %zu tiny tasks, %ld here: %.2f us/task\n", vg_comm_rank(job),
         n, n_run, 1e6 * wall / (double)n);
  for (double sleep = 1e-3; sleep < 0.02; sleep *= 4) {
    size_t m = (size_t)(0.25 / sleep) * (size_t)vg_comm_size(job);

    wall = run_tiny(m, 0, sleep, &n_run);
    if (!vg_comm_rank(job))
      printf("%zu tasks of %g ms: %.2f ms each per worker\n", m, 1e3 * sleep,
             1e3 * wall * vg_comm_size(job) / (double)m);
  }
}

static double cpu_time(void)
{
  struct rusage r;

  getrusage(RUSAGE_SELF, &r);
  return (double)(r.ru_utime.tv_sec + r.ru_stime.tv_sec) +
         1e-6 * (double)(r.ru_utime.tv_usec + r.ru_stime.tv_usec);
}

/* Rank 0 has one task that sleeps; no rank may spin meanwhile. The engine's
 * target is 1 % of a core. Ten times that is allowed here, since waking threads
 * costs more on a busy machine and with sanitizers. */
static void idle_ranks_sleep(void **state)
{
  double cpu = cpu_time(), wall;
  long n_run;

  (void)state;
  wall = run_tiny(1, 1, 1, &n_run);
  cpu = cpu_time() - cpu;
  assert_true(wall > 0.5); /* of a second, minus the delay of late ranks */
  printf("rank %d: idle, %.2f %% of a core\n", vg_comm_rank(job),
         100 * cpu / wall);
  assert_true(cpu < 0.1 * wall);
}

/* Eight equal tasks for each rank that only sleep must be distributed evenly;
 * three more are allowed because other ranks may wake late. */
static void equal_tasks_are_distributed_evenly(void **state)
{
  size_t size = (size_t)vg_comm_size(job);
  long n_run;
  double wall = run_tiny(8 * size, 0, 0.05, &n_run);

  (void)state;
  assert_true(wall >= 0.05 * 8);
  assert_true(n_run <= 11);
}

static vg_status uneven_run(void *user, const struct vg_engine *e,
                            const struct vg_task *task, int worker,
                            void **outcome, struct vg_done *done,
                            struct vg_error *err)
{
  (void)user, (void)e, (void)worker, (void)outcome, (void)done, (void)err;
  usleep((useconds_t)(1e6 * task->weight));
  return VG_OK;
}

/* One task takes 2 s, on the last rank, where all tasks are created. Meanwhile
 * the other ranks do 0.2 s of work each, including tasks that were given to the
 * last rank in advance; also on a busy machine. */
static void tasks_given_in_advance_are_returned(void **state)
{
  static const struct vg_engine_ops ops = { .run = uneven_run,
                                            .done = tiny_done };
  struct vg_engine_options options = { .threads = 1 };
  size_t n = 1 + 40 * (size_t)(vg_comm_size(job) - 1);
  struct vg_task *task = vg_calloc(n, sizeof *task);
  struct vg_spans s = VG_SPANS_INIT;
  struct tiny tiny = { 0 };

  (void)state;
  for (size_t i = 0; i < n; i++) {
    snprintf(task[i].path, sizeof task[i].path, "%04zu", i);
    task[i].weight = i ? 0.005 : 2;
    task[i].priority = i ? 1 : 2;
  }
  if (vg_comm_rank(job) != vg_comm_size(job) - 1) n = 0;
  assert_int_equal(vg_engine_run(job, &options, &ops, &tiny, n, task, &s, NULL),
                   VG_OK);
  for (size_t i = 1; i < s.n && !vg_comm_rank(job); i++)
    assert_true(s.span[i].end < s.span[0].end);
  vg_spans_release(&s);
  free(task);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(all_schedules),
    cmocka_unit_test(tasks_can_move_their_home),
    cmocka_unit_test(ranks_have_loops),
    cmocka_unit_test(moved_and_stopped),
    cmocka_unit_test(a_failure_reaches_all_ranks),
    cmocka_unit_test(other_failures),
    cmocka_unit_test(it_stops),
    cmocka_unit_test(one_rank_stops_all),
    cmocka_unit_test(large_inputs),
    cmocka_unit_test(work_is_assigned_statically),
    cmocka_unit_test(static_assignment_keeps_the_results),
    cmocka_unit_test(many_tiny_tasks),
    cmocka_unit_test(idle_ranks_sleep),
    cmocka_unit_test(equal_tasks_are_distributed_evenly),
    cmocka_unit_test(tasks_given_in_advance_are_returned),
  };

  return RUN_IN_JOB(tests);
}
