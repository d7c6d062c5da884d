/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Messages: all arrive, complete, and those of one rank in the order of
 * posting. */
#define _GNU_SOURCE
#include "mpi_support.h"

#include <pthread.h>
#include <sched.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include "base/comm_parts.h"

/* Body: sender, number, then bytes that follow from both. */
struct head {
  uint32_t from, number;
};

static struct vg_bytes body(uint32_t from, uint32_t number, size_t n)
{
  struct head h = { from, number };
  struct vg_bytes b = { sizeof h + n, vg_alloc(sizeof h + n, 1) };

  memcpy(b.data, &h, sizeof h);
  for (size_t i = 0; i < n; i++)
    b.data[sizeof h + i] = (unsigned char)(i * 13 + i / 256 + number + from);
  return b;
}

static struct head open_body(const struct vg_bytes *b, size_t n)
{
  struct head h;
  struct vg_bytes want;

  assert_int_equal(b->n, sizeof h + n);
  memcpy(&h, b->data, sizeof h);
  want = body(h.from, h.number, n);
  assert_memory_equal(b->data, want.data, b->n);
  free(want.data);
  return h;
}

/* Allow a minute for a message that takes milliseconds: beyond that it is lost,
 * not late. */
static struct vg_message wait_message(void)
{
  struct vg_error err = VG_ERROR_INIT;
  struct timespec start, now;
  struct vg_message m;
  vg_status st;

  clock_gettime(CLOCK_MONOTONIC, &start);
  while ((st = vg_comm_poll(job, &m, &err)) == VG_BLOCKED) {
    clock_gettime(CLOCK_MONOTONIC, &now);
    assert_true(now.tv_sec - start.tv_sec < 60);
    sched_yield();
  }
  assert_string_equal(err.text, "");
  assert_int_equal(st, VG_OK);
  return m;
}

static void meet(void)
{
  uint64_t v = 0;

  assert_int_equal(vg_comm_sum(job, 1, &v, NULL), VG_OK);
}

/* Lengths around those at which MPI, or Vanguard, changes its protocol. */
static const size_t lengths[] = { 0,    1,    991,   992,    993,
                                  4000, 4096, 70000, 1000000 };
enum { N_LENGTHS = sizeof lengths / sizeof *lengths };

static void all_to_all(size_t chunk, uint32_t count)
{
  int size = vg_comm_size(job), rank = vg_comm_rank(job);
  uint32_t next[16] = { 0 };
  size_t whole = job->chunk;
  struct vg_message m;

  meet();
  job->chunk = chunk;
  for (uint32_t k = 0; k < count; k++)
    for (int i = 0; i < size; i++) {
      struct vg_bytes b = body((uint32_t)rank, k, lengths[k % N_LENGTHS]);

      assert_int_equal(vg_comm_post(job, (rank + i) % size, (int)k % 7, &b,
                                    NULL),
                       VG_OK);
      assert_null(b.data);
    }
  for (uint32_t k = 0; k < count * (uint32_t)size; k++) {
    struct head h;

    m = wait_message();
    assert_in_range(m.from, 0, size - 1);
    h = open_body(&m.bytes, lengths[next[m.from] % N_LENGTHS]);
    assert_int_equal(h.from, m.from);
    assert_int_equal(h.number, next[m.from]++);
    assert_int_equal(m.kind, h.number % 7);
    free(m.bytes.data);
  }
  meet();
  assert_int_equal(vg_comm_poll(job, &m, NULL), VG_BLOCKED);
  meet(); /* before anyone posts the next messages */
  job->chunk = whole;
}

static void in_order_and_whole(void **state)
{
  (void)state;
  all_to_all(job->chunk, 100);
}

static void in_parts(void **state)
{
  (void)state;
  all_to_all(1000, 30);
  all_to_all(100000, 30);
}

static void memory_of_sent_messages_is_freed(void **state)
{
  int to = (vg_comm_rank(job) + 1) % vg_comm_size(job);

  (void)state;
  for (uint32_t k = 0; k < 200; k++) {
    struct vg_bytes b = body(0, k, 1000000);
    struct vg_message m;

    assert_int_equal(vg_comm_post(job, to, 3, &b, NULL), VG_OK);
    m = wait_message();
    assert_int_equal(open_body(&m.bytes, 1000000).number, k);
    free(m.bytes.data);
    assert_true(job->n_request <= 4);
  }
  meet();
}

static void wrong_addresses_are_refused(void **state)
{
  static const int wrong[][2] = {
    { -1, 0 }, { 1000, 0 }, { 0, -1 }, { 0, 16384 }
  };
  struct vg_bytes b = body(0, 0, 10);

  (void)state;
  for (int i = 0; i < 4; i++) {
    struct vg_error err = VG_ERROR_INIT;

    assert_int_equal(vg_comm_post(job, wrong[i][0], wrong[i][1], &b, &err),
                     VG_ERR_INPUT);
    assert_non_null(b.data);
    assert_int_not_equal(err.text[0], 0);
  }
  free(b.data);
}

/* --- several threads post while one polls -------------------------------- */

enum { THREADS = 3, POSTS = 300 };

/* A round through all ranks of one node: each rank posts to the next after it
 * has received from the previous one, and polls only when its wakeup is
 * signalled. A rank that is not signalled, or that then finds no message,
 * sleeps for minutes. */
static void waiting_ranks_are_woken(void **state)
{
  int size = vg_comm_size(job), rank = vg_comm_rank(job);

  (void)state;
  if (vg_comm_node_size(job) < size || job->apart) skip();
  meet();
  for (uint32_t turn = 0; turn < 50; turn++) {
    struct vg_bytes b = body((uint32_t)rank, turn, 9);
    struct vg_message m;
    unsigned wakes;

    if (!rank)
      assert_int_equal(vg_comm_post(job, 1 % size, 1, &b, NULL), VG_OK);
    for (wakes = vg_comm_wake_count(job); vg_comm_poll(job, &m, NULL) != VG_OK;
         wakes = vg_comm_wake_count(job))
      vg_comm_sleep(job, wakes, 600);
    assert_int_equal(open_body(&m.bytes, 9).number, turn);
    free(m.bytes.data);
    if (rank)
      assert_int_equal(vg_comm_post(job, (rank + 1) % size, 1, &b, NULL),
                       VG_OK);
  }
  meet();
}

static void *post_many(void *data)
{
  int size = vg_comm_size(job), kind = *(int *)data;

  for (uint32_t k = 0; k < POSTS; k++) {
    struct vg_bytes b = body((uint32_t)kind, k, lengths[k % (N_LENGTHS - 1)]);

    if (vg_comm_post(job, (int)k % size, kind, &b, NULL)) abort();
  }
  return NULL;
}

static void from_threads(void **state)
{
  int size = vg_comm_size(job), rank = vg_comm_rank(job), n = 0;
  int kind[THREADS];
  uint32_t next[16][THREADS];
  pthread_t thread[THREADS];

  (void)state;
  for (int i = 0; i < THREADS; i++) {
    kind[i] = i;
    assert_int_equal(pthread_create(&thread[i], NULL, post_many, &kind[i]), 0);
  }
  for (int i = 0; i < 16; i++)
    for (int k = 0; k < THREADS; k++) next[i][k] = (uint32_t)rank;
  for (uint32_t k = 0; k < POSTS; k++) n += (int)k % size == rank;
  for (int i = 0; i < n * size * THREADS; i++) {
    struct vg_message m = wait_message();
    uint32_t *want = &next[m.from][m.kind];

    open_body(&m.bytes, lengths[*want % (N_LENGTHS - 1)]);
    assert_memory_equal(m.bytes.data + sizeof(uint32_t), want, sizeof *want);
    *want += (uint32_t)size;
    free(m.bytes.data);
  }
  for (int i = 0; i < THREADS; i++) pthread_join(thread[i], NULL);
  meet();
}

/* Larger than MPI's counts. This takes half a minute and gigabytes, so it runs
 * only on request. */
static void messages_of_more_than_two_gigabytes(void **state)
{
  const size_t n = ((size_t)5 << 29) + 12345;
  int size = vg_comm_size(job), rank = vg_comm_rank(job);
  struct vg_bytes b = { 0, NULL }, to[16] = { { 0, NULL } }, from[16];

  (void)state;
  if (!getenv("VG_TEST_HUGE") || size < 2) skip();
  if (!rank) b = body(0, 1, n);
  assert_int_equal(vg_comm_bcast(job, 0, &b, NULL), VG_OK);
  open_body(&b, n);
  if (!rank) to[1] = b;
  assert_int_equal(vg_comm_exchange(job, to, from, NULL), VG_OK);
  if (rank == 1) open_body(&from[0], n);
  for (int i = 0; i < size; i++) free(from[i].data);
  if (!rank) assert_int_equal(vg_comm_post(job, 1, 5, &b, NULL), VG_OK);
  if (rank == 1) {
    struct vg_message m = wait_message();

    open_body(&m.bytes, n);
    free(m.bytes.data);
  }
  while (job->n_request) {
    struct vg_message m;

    assert_int_equal(vg_comm_poll(job, &m, NULL), VG_BLOCKED);
  }
  free(b.data);
  meet();
}

/* Address space of this process. */
static uint64_t bytes_in_use(void)
{
  unsigned long pages = 0;
  FILE *from = fopen("/proc/self/statm", "r");

  assert_non_null(from);
  assert_int_equal(fscanf(from, "%lu", &pages), 1);
  fclose(from);
  return (uint64_t)pages * (uint64_t)sysconf(_SC_PAGESIZE);
}

/* There is memory for the bytes of a message, but not for the requests of its
 * parts: the failure is reported, and then the message is delivered without
 * data. Only its announcement is sent. */
static void without_memory(void **state)
{
  const int size = vg_comm_size(job), to = (vg_comm_rank(job) + 1) % size;
  const uint64_t n = 1 << 28;
  struct vg_error err = VG_ERROR_INIT;
  struct rlimit was, less;
  struct vg_message m;
  vg_status st;

  (void)state;
#ifdef __SANITIZE_ADDRESS__
  skip();
#endif
  if (size == 1) skip();
  meet();
  job->chunk = 1;
  MPI_Send(&n, sizeof n, MPI_BYTE, to, 2 * 3 + 1, job->message_comm);
  job->posted++;
  getrlimit(RLIMIT_AS, &was);
  less = was;
  less.rlim_cur = bytes_in_use() + 2 * n;
  setrlimit(RLIMIT_AS, &less);
  while ((st = vg_comm_poll(job, &m, &err)) == VG_BLOCKED) sched_yield();
  setrlimit(RLIMIT_AS, &was);
  assert_int_equal(st, VG_ERR_MEMORY);
  m = wait_message();
  assert_null(m.bytes.data);
  meet();
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(in_order_and_whole),
    cmocka_unit_test(in_parts),
    cmocka_unit_test(memory_of_sent_messages_is_freed),
    cmocka_unit_test(wrong_addresses_are_refused),
    cmocka_unit_test(waiting_ranks_are_woken),
    cmocka_unit_test(from_threads),
    cmocka_unit_test(messages_of_more_than_two_gigabytes),
    cmocka_unit_test(without_memory), /* long messages are lost afterwards */
  };

  return RUN_IN_JOB(tests);
}
