/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Collective operations. */
#define _GNU_SOURCE
#include "mpi_support.h"

#include <sys/resource.h>
#include <time.h>

#include "base/comm_parts.h"

static void ranks_are_those_of_the_launcher(void **state)
{
  const char *ranks = getenv("VG_TEST_RANKS");

  (void)state;
  assert_non_null(job);
  if (ranks) assert_int_equal(vg_comm_size(job), atoi(ranks));
  assert_in_range(vg_comm_rank(job), 0, vg_comm_size(job) - 1);
  assert_int_equal(vg_comm_node_size(job), vg_comm_size(job));
  assert_int_equal(vg_comm_node_rank(job), vg_comm_rank(job));
  assert_non_null(vg_comm_mpi(job));
}

/* Transfers in chunks of this many bytes; the last one takes all at once. */
static const size_t chunks[] = { 64, 1000, (size_t)1 << 28 };
enum { N_CHUNKS = sizeof chunks / sizeof *chunks };

static void sums_and_maxima(void **state)
{
  uint64_t n = (uint64_t)vg_comm_size(job), r = (uint64_t)vg_comm_rank(job);
  size_t whole = job->chunk;

  (void)state;
  assert_int_equal(vg_comm_sum(job, 0, NULL, NULL), VG_OK);
  for (int k = 0; k < N_CHUNKS; k++) {
    uint64_t sum[300];
    double max[300];

    job->chunk = chunks[k];
    for (uint64_t i = 0; i < 300; i++) {
      sum[i] = (i + r) << 32;
      max[i] = i % n == r ? (double)i : -1e300;
    }
    assert_int_equal(vg_comm_sum(job, 300, sum, NULL), VG_OK);
    assert_int_equal(vg_comm_max(job, 300, max, NULL), VG_OK);
    for (uint64_t i = 0; i < 300; i++) {
      assert_true(sum[i] == (n * i + n * (n - 1) / 2) << 32);
      assert_true(max[i] == (double)i);
    }
  }
  job->chunk = whole;
}

/* Bytes that depend on their sender and receiver. */
static struct vg_bytes make(size_t n, int from, int to)
{
  struct vg_bytes b = { n, vg_alloc(n, 1) };

  for (size_t i = 0; i < n; i++)
    b.data[i] = (unsigned char)(i * 7 + i / 256 + (size_t)(from * 31 + to));
  return b;
}

static void check(const struct vg_bytes *b, size_t n, int from, int to)
{
  struct vg_bytes want = make(n, from, to);

  assert_int_equal(b->n, n);
  assert_memory_equal(b->data, want.data, n);
  free(want.data);
}

static const size_t lengths[] = { 0, 1, 63, 64, 65, 999, 1000, 1001, 123457 };
enum { N_LENGTHS = sizeof lengths / sizeof *lengths };

static void broadcasts(void **state)
{
  int size = vg_comm_size(job), rank = vg_comm_rank(job);
  size_t whole = job->chunk;

  (void)state;
  for (int k = 0; k < N_CHUNKS * N_LENGTHS; k++)
    for (int root = 0; root < size; root++) {
      size_t n = lengths[k % N_LENGTHS];
      struct vg_bytes b = rank == root ? make(n, root, 5) : make(17, 1, 1);

      job->chunk = chunks[k / N_LENGTHS];
      assert_int_equal(vg_comm_bcast(job, root, &b, NULL), VG_OK);
      check(&b, n, root, 5);
      free(b.data);
      b = rank ? (struct vg_bytes){ 0, NULL } : make(n, 0, 3);
      assert_int_equal(vg_comm_node_bcast(job, &b, NULL), VG_OK);
      check(&b, n, 0, 3);
      free(b.data);
    }
  job->chunk = whole;
}

static void gathers(void **state)
{
  int size = vg_comm_size(job), rank = vg_comm_rank(job);
  size_t whole = job->chunk;

  (void)state;
  for (int k = 0; k < N_CHUNKS * N_LENGTHS; k++) {
    struct vg_bytes out[16],
      mine = make(lengths[(k + rank) % N_LENGTHS], rank, 0);

    job->chunk = chunks[k / N_LENGTHS];
    assert_int_equal(vg_comm_allgather(job, &mine, out, NULL), VG_OK);
    for (int i = 0; i < size; i++) {
      check(&out[i], lengths[(k + i) % N_LENGTHS], i, 0);
      free(out[i].data);
    }
    free(mine.data);
  }
  job->chunk = whole;
}

static void exchanges(void **state)
{
  int size = vg_comm_size(job), rank = vg_comm_rank(job);
  size_t whole = job->chunk;

  (void)state;
  for (int k = 0; k < N_CHUNKS * N_LENGTHS; k++) {
    struct vg_bytes to[16], from[16];

    job->chunk = chunks[k / N_LENGTHS];
    for (int i = 0; i < size; i++)
      to[i] = make(lengths[(k + rank + 3 * i) % N_LENGTHS], rank, i);
    assert_int_equal(vg_comm_exchange(job, to, from, NULL), VG_OK);
    for (int i = 0; i < size; i++) {
      check(&from[i], lengths[(k + i + 3 * rank) % N_LENGTHS], i, rank);
      free(from[i].data);
      free(to[i].data);
    }
  }
  job->chunk = whole;
}

/* --- agreement ----------------------------------------------------------- */

/* Agreement where rank `on` reports `st` and the other ranks succeed. */
static vg_status say(int on, vg_status st, const char *text,
                     struct vg_error *err)
{
  return vg_comm_rank(job) == on ? vg_fail(err, st, "%s", text) : VG_OK;
}

static void one_failure_fails_the_whole_team(void **state)
{
  int size = vg_comm_size(job), rank = vg_comm_rank(job);
  char want[64];

  (void)state;
  for (int on = 0; on < size; on++) {
    struct vg_error err = VG_ERROR_INIT;
    vg_status st = say(on, VG_ERR_IO, "disk", &err);

    assert_int_equal(vg_comm_agree(job, st, &err), VG_ERR_IO);
    snprintf(want, sizeof want, "rank %d: disk", on);
    assert_string_equal(err.text, rank == on ? "disk" : want);
    assert_int_equal(err.code, VG_ERR_IO);
    /* once more, as the next stage does: still the same rank's error */
    assert_int_equal(vg_comm_agree(job, VG_ERR_IO, &err), VG_ERR_IO);
    if (on) assert_string_equal(err.text, want);
    /* without an error struct */
    assert_int_equal(vg_comm_agree(job, rank == on ? VG_ERR_MEMORY : VG_OK,
                                   NULL),
                     VG_ERR_MEMORY);
  }
}

static void the_lowest_rank_speaks(void **state)
{
  int size = vg_comm_size(job), rank = vg_comm_rank(job);
  struct vg_error err = VG_ERROR_INIT;
  vg_status st = rank ? vg_fail(&err, rank == 1 ? VG_ERR_FORMAT : VG_ERR_IO,
                                "reason %d", rank)
                      : VG_OK;

  (void)state;
  assert_int_equal(vg_comm_agree(job, VG_OK, &err), VG_OK);
  if (rank) assert_int_equal(err.code, st);
  assert_int_equal(vg_comm_agree(job, st, &err),
                   size > 1 ? VG_ERR_FORMAT : VG_OK);
  assert_string_equal(err.text, size == 1   ? ""
                                : rank == 1 ? "reason 1"
                                            : "rank 1: reason 1");
}

/* The cause ranks above its consequences, a failure above an outcome. */
static void the_most_severe_status_wins(void **state)
{
  int size = vg_comm_size(job), rank = vg_comm_rank(job);
  struct vg_error err = VG_ERROR_INIT;
  vg_status st = rank < size - 1 ? vg_fail(&err, VG_ERR_REMOTE, "lost")
                                 : vg_fail(&err, VG_ERR_INPUT, "cause");

  (void)state;
  assert_int_equal(vg_comm_agree(job, st, &err), VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "cause"));
  st = rank < size - 1 ? VG_BLOCKED : VG_ERR_INPUT;
  assert_int_equal(vg_comm_agree(job, st, &err), VG_ERR_INPUT);
  st = rank < size - 1 ? VG_OK : VG_BLOCKED;
  assert_int_equal(vg_comm_agree(job, st, &err), VG_BLOCKED);
}

/* --- waiting ------------------------------------------------------------- */

static double cpu_s(void)
{
  struct rusage u;

  getrusage(RUSAGE_SELF, &u);
  return (double)(u.ru_utime.tv_sec + u.ru_stime.tv_sec) +
         1e-6 * (double)(u.ru_utime.tv_usec + u.ru_stime.tv_usec);
}

static double now_s(void)
{
  struct timespec t;

  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void waiting_takes_no_core(void **state)
{
  const struct timespec second = { 1, 0 };
  uint64_t v = 1;
  double before, start, share;

  (void)state;
  assert_int_equal(vg_comm_sum(job, 1, &v, NULL), VG_OK);
  before = cpu_s();
  start = now_s();
  if (!vg_comm_rank(job)) nanosleep(&second, NULL);
  assert_int_equal(vg_comm_sum(job, 1, &v, NULL), VG_OK);
  share = (cpu_s() - before) / (now_s() - start);
  if (vg_comm_rank(job) == 1)
    print_message("waiting took %.1f %% of a core\n", 100 * share);
  assert_true(share < 0.05);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(ranks_are_those_of_the_launcher),
    cmocka_unit_test(sums_and_maxima),
    cmocka_unit_test(broadcasts),
    cmocka_unit_test(gathers),
    cmocka_unit_test(exchanges),
    cmocka_unit_test(one_failure_fails_the_whole_team),
    cmocka_unit_test(the_lowest_rank_speaks),
    cmocka_unit_test(the_most_severe_status_wins),
    cmocka_unit_test(waiting_takes_no_core),
  };

  return RUN_IN_JOB(tests);
}
