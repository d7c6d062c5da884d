/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Cores of a node, and their assignment to ranks. */
#define _GNU_SOURCE
#include "mpi_support.h"

#include <pthread.h>
#include <sched.h>

#include "base/parallel.h"

/* Simulates a launcher that binds even ranks to the first available processor
 * and odd ones to the second. This happens before the job is joined, since a
 * launcher binds before it starts a process. */
static cpu_set_t at_hand, first, second;

static void split(void)
{
  cpu_set_t *next = &first;

  assert_int_equal(sched_getaffinity(0, sizeof at_hand, &at_hand), 0);
  CPU_ZERO(&first);
  CPU_ZERO(&second);
  for (int i = 0; i < CPU_SETSIZE && next; i++) {
    if (!CPU_ISSET(i, &at_hand)) continue;
    CPU_SET(i, next);
    next = next == &first ? &second : NULL;
  }
}

static int bind_and_open(void **state)
{
  const char *rank = getenv("OMPI_COMM_WORLD_RANK");

  if (!rank) rank = getenv("PMI_RANK");
  if (!rank) rank = getenv("PMIX_RANK");
  split();
  if (rank)
    sched_setaffinity(0, sizeof first,
                      atoi(rank) % 2 && CPU_COUNT(&second) ? &second : &first);
  return open_job(state);
}

static void *cores_of_a_thread(void *out)
{
  *(int *)out = vg_cores();
  return NULL;
}

static int cores_of_new_threads(void)
{
  pthread_t thread;
  int n = 0;

  assert_int_equal(pthread_create(&thread, NULL, cores_of_a_thread, &n), 0);
  pthread_join(thread, NULL);
  return n;
}

/* Processors may be threads of one core: then two of them count as one. */
static void node_cores_are_shared_and_released(void **state)
{
  int n_used = vg_comm_size(job) > 1 && CPU_COUNT(&second) ? 2 : 1, n;

  (void)state;
  assert_int_equal(vg_cores(), 1);
  n = vg_comm_node_cores(job, 1);
  assert_in_range(n, 1, n_used);
  assert_int_equal(cores_of_new_threads(), n_used);
  assert_int_equal(vg_comm_node_cores(job, 0), 1);
  assert_int_equal(cores_of_new_threads(), 1);
}

/* One core each, or cores shared between ranks: one thread. */
static void one_thread_per_core(void **state)
{
  (void)state;
  assert_int_equal(vg_comm_default_threads(job), 1);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(node_cores_are_shared_and_released),
    cmocka_unit_test(one_thread_per_core),
  };

  return cmocka_run_group_tests(tests, bind_and_open, close_job);
}
