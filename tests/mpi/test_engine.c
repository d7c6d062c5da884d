/* The engine on several ranks: same results as on one, tasks that are pinned,
 * large inputs, stops and failures that every rank hears of, and what a task
 * and an idle rank cost. Ranks: 1, 2, 4 or any other number.
 * With a number as argument, the cost is measured on so many tasks. */
#define _GNU_SOURCE
#include <sys/resource.h>
#include <unistd.h>

#include "../unit/engine_support.h"

/* A failed check ends the job: a rank that left alone would leave the others
 * waiting. */
#define CHECK(what) check((what) != 0, #what, __LINE__, comm)

static void check(int ok, const char *what, int line, struct vg_comm *comm)
{
  if (ok) return;
  fprintf(stderr, "test_engine.c:%d: rank %d: %s\n", line,
          vg_comm_rank(comm), what);
  vg_comm_abort(comm, 1);
}

static uint64_t total(struct vg_comm *comm, uint64_t v)
{
  CHECK(vg_comm_sum(comm, 1, &v, NULL) == VG_OK);
  return v;
}

static void check_rest(struct vg_comm *comm, const struct forest *f)
{
  CHECK(total(comm, (uint64_t)f->bad) == 0);
  CHECK(total(comm, (uint64_t)f->alive) == 0);
  CHECK(total(comm, (uint64_t)f->n_run) == total(comm, (uint64_t)f->n_done));
}

static void check_spans(struct vg_comm *comm, const struct forest *f,
                        const struct vg_spans *s, long n)
{
  CHECK(s->n_rank == f->size && s->n_thread == f->threads);
  CHECK(f->rank ? (long)s->n == f->n_run : (long)s->n == n);
  for (size_t i = 0; i < s->n; i++) {
    const struct vg_span *a = &s->span[i];

    CHECK(!i || strcmp(s->span[i - 1].path, a->path) < 0);
    CHECK(a->home == (a->path[0] - 'a') % f->size);
    CHECK(f->rank ? a->rank == f->rank : a->rank < f->size);
    CHECK(a->thread >= 0 && a->thread < f->threads);
    CHECK(strlen(a->after) == strlen(a->path) - 1);
    CHECK(!a->after[0] || !strncmp(a->after, a->path, strlen(a->after)));
    CHECK((a->rank == a->home) ==
          (a->bytes_in < sizeof(struct forest_input) + f->ballast));
    CHECK((a->rank == a->home) ==
          (a->bytes_out < sizeof(struct forest_outcome)));
    CHECK(a->start <= a->end && a->end <= s->wall + 1);
    CHECK(a->n_cell == (uint64_t)a->estimate);
  }
}

/* trees[0]: all begin on rank 0; else one on each rank in turn. */
static void same_result(struct vg_comm *comm, int n_tree, int threads,
                        uint64_t shuffle, int pin, double spin)
{
  struct forest f = { .threads = threads, .depth = 4, .pin = pin,
                      .spin = spin };
  struct vg_spans s = VG_SPANS_INIT;
  uint64_t sum = 0;
  long n = 0;

  for (int t = 0; t < n_tree; t++)
    forest_expect(&f, (char[]){ (char)('a' + t), 0 }, &n, &sum);
  CHECK(forest_grow(&f, comm, n_tree, shuffle, &s, NULL) == VG_OK);
  CHECK(total(comm, (uint64_t)f.n_done) == (uint64_t)n);
  CHECK(total(comm, f.sum) == sum);
  check_rest(comm, &f);
  check_spans(comm, &f, &s, n);
  if (vg_comm_size(comm) > 1 && spin > 0)
    CHECK(total(comm, (uint64_t)f.n_moved) > 0);
  vg_spans_release(&s);
}

static void all_ways(struct vg_comm *comm)
{
  for (int threads = 1; threads < 4; threads++)
    for (uint64_t shuffle = 0; shuffle < 3; shuffle++) {
      same_result(comm, 1, threads, shuffle, 0, 0);
      same_result(comm, 3, threads, shuffle, 3, 0);
      same_result(comm, 1, threads, shuffle, 4, 2e-4);
    }
  same_result(comm, 0, 2, 0, 0, 0);
  same_result(comm, 2, 2, 0, 1, 0);          /* all pinned */
}

static int ends_with(const char *text, const char *end)
{
  size_t n = strlen(text), m = strlen(end);

  return n >= m && !strcmp(text + n - m, end);
}

static void a_failure_is_heard(struct vg_comm *comm)
{
  for (uint64_t shuffle = 0; shuffle < 4; shuffle++) {
    struct forest f = { .threads = 2, .depth = 4, .spin = 1e-4,
                        .fail_at = "a12" };
    struct vg_error err = VG_ERROR_INIT;
    int run_here;

    CHECK(forest_grow(&f, comm, 3, shuffle, NULL, &err) == VG_ERR_GEOMETRY);
    CHECK(ends_with(err.text, "task a12 fails"));
    run_here = !strncmp(err.text, "task", 4);
    CHECK(run_here || !strncmp(err.text, "rank ", 5));
    CHECK(total(comm, (uint64_t)run_here) == 1);
    check_rest(comm, &f);
  }
}

static void other_failures(struct vg_comm *comm)
{
  struct forest f = { .threads = 1, .depth = 4, .done_fails_at = "a3" };
  struct forest g = { .threads = 1, .depth = 4, .spin = 1e-3,
                      .pack_fails_at = "a3" };
  struct vg_error err = VG_ERROR_INIT;
  vg_status st;

  CHECK(forest_grow(&f, comm, 1, 0, NULL, &err) == VG_ERR_INPUT);
  CHECK(ends_with(err.text, "done of a3 fails"));
  check_rest(comm, &f);
  st = forest_grow(&g, comm, 1, 0, NULL, &err);   /* it may stay at home */
  CHECK(st == VG_OK || (st == VG_ERR_MEMORY &&
                        ends_with(err.text, "packing fails")));
  check_rest(comm, &g);
}

static void it_stops(struct vg_comm *comm)
{
  for (int threads = 1; threads < 3; threads++) {
    struct forest f = { .threads = threads, .depth = 4, .spin = 1e-4,
                        .stop_at = "a12" };
    struct vg_error err = VG_ERROR_INIT;

    CHECK(forest_grow(&f, comm, 4, 0, NULL, &err) == VG_BLOCKED);
    check_rest(comm, &f);
  }
}

/* One rank is told to stop, before anything has begun. */
static void one_rank_stops_all(struct vg_comm *comm)
{
  struct forest f = { .threads = 1, .depth = 9, .spin = 2e-3 };

  f.stop = vg_comm_rank(comm) == vg_comm_size(comm) - 1;
  CHECK(forest_grow(&f, comm, 4, 0, NULL, NULL) == VG_BLOCKED);
  check_rest(comm, &f);
}

static void large_inputs(struct vg_comm *comm)
{
  struct forest f = { .threads = 2, .depth = 1, .ballast = 10 << 20 };

  CHECK(forest_grow(&f, comm, 4, 0, NULL, NULL) == VG_OK);
  CHECK(total(comm, (uint64_t)f.n_done) == 20);
  check_rest(comm, &f);
}

/* --- tiny tasks, and the cost ------------------------------------------- */

struct tiny { long n_run, n_done; double sleep; };

static vg_status tiny_run(void *user, const struct vg_engine *e,
                          const struct vg_task *task, int worker,
                          void **outcome, size_t *n_cell,
                          struct vg_error *err)
{
  struct tiny *t = user;

  (void)e, (void)task, (void)worker, (void)outcome, (void)err;
  if (t->sleep > 0) usleep((useconds_t)(1e6 * t->sleep));
  t->n_run++;
  *n_cell = 1;
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
static double run_tiny(struct vg_comm *comm, size_t n, int pinned,
                       double sleep, long *n_run)
{
  static const struct vg_engine_ops ops = { .run = tiny_run,
                                            .done = tiny_done };
  struct vg_engine_options options = { .threads = 1 };
  struct tiny tiny = { .sleep = sleep };
  struct vg_task *task = vg_calloc(n, sizeof *task);
  struct vg_spans s = VG_SPANS_INIT;
  double wall;

  CHECK(task != NULL);
  for (size_t i = 0; i < n; i++) {
    snprintf(task[i].path, sizeof task[i].path, "%zu", i);
    task[i].pinned = pinned;
  }
  if (vg_comm_rank(comm)) n = 0;
  CHECK(vg_engine_run(comm, &options, &ops, &tiny, n, task, &s, NULL) ==
        VG_OK);
  CHECK(tiny.n_done == (long)n);
  CHECK(total(comm, (uint64_t)tiny.n_run) == total(comm, n));
  *n_run = tiny.n_run;
  wall = s.wall;
  vg_spans_release(&s);
  free(task);
  return wall;
}

static void many_tiny_tasks(struct vg_comm *comm, size_t n, int tell)
{
  long n_run;
  double wall = run_tiny(comm, n, 0, 0, &n_run);

  if (!tell) return;
  printf("rank %d: %zu tiny tasks, %ld here: %.2f us/task\n",
         vg_comm_rank(comm), n, n_run, 1e6 * wall / (double)n);
  for (double sleep = 1e-3; sleep < 0.02; sleep *= 4) {
    size_t m = (size_t)(0.5 / sleep) * (size_t)vg_comm_size(comm);

    wall = run_tiny(comm, m, 0, sleep, &n_run);
    printf("rank %d: %zu tasks of %g ms, %ld here: %.2f ms each\n",
           vg_comm_rank(comm), m, 1e3 * sleep, n_run, 1e3 * wall * 
           vg_comm_size(comm) / (double)m);
  }
}

static double cpu_time(void)
{
  struct rusage r;

  getrusage(RUSAGE_SELF, &r);
  return (double)(r.ru_utime.tv_sec + r.ru_stime.tv_sec) +
         1e-6 * (double)(r.ru_utime.tv_usec + r.ru_stime.tv_usec);
}

/* Rank 0 has one task that sleeps; nobody may spin meanwhile. The bar of the
 * engine is 1 % of a core; ten times that is allowed here, since a machine
 * that is busy or that runs sanitizers wakes threads at a higher price. */
static void idle_ranks_sleep(struct vg_comm *comm, int tell)
{
  double cpu = cpu_time(), wall;
  long n_run;

  wall = run_tiny(comm, 1, 1, 1, &n_run);
  cpu = cpu_time() - cpu;
  CHECK(wall >= 1);
  if (tell) printf("rank %d: idle, %.2f %% of a core\n", vg_comm_rank(comm),
                   100 * cpu / wall);
  CHECK(cpu < 0.1 * wall);
}

/* Eight equal tasks for each rank that only sleep: shared out so evenly that
 * it takes eight times one of them, and at most one more at the end. */
static void nobody_hoards(struct vg_comm *comm)
{
  int size = vg_comm_size(comm);
  long n_run;
  double wall = run_tiny(comm, 8 * (size_t)size, 0, 0.05, &n_run);

  CHECK(wall >= 0.4);
  CHECK(n_run <= 9);
}

int main(int argc, char **argv)
{
  struct vg_comm *comm = NULL;
  size_t n = argc > 1 ? strtoul(argv[1], NULL, 10) : 2000;

  if (vg_comm_open(&comm, NULL) < 0) return 1;
  all_ways(comm);
  a_failure_is_heard(comm);
  other_failures(comm);
  it_stops(comm);
  one_rank_stops_all(comm);
  large_inputs(comm);
  many_tiny_tasks(comm, n, argc > 1);
  idle_ranks_sleep(comm, argc > 1);
  nobody_hoards(comm);
  vg_comm_close(comm);
  return 0;
}
