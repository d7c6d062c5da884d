/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "base/parallel.h"

#include <assert.h>
#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <unistd.h>

#define WORKERS_MAX 256

struct loop {
  size_t n, grain;
  vg_loop_body body;
  void *context;
  atomic_size_t next; /* next chunk */
};

struct worker {
  struct loop *loop;
  int number;
  void *data; /* vg_thread_data of the thread that started this one */
  pthread_t thread;
};

static _Thread_local void *thread_data;

void *vg_thread_data(void)
{
  return thread_data;
}

void vg_thread_data_set(void *data)
{
  thread_data = data;
}

int vg_cores(void)
{
  cpu_set_t set;
  long n;

  if (!sched_getaffinity(0, sizeof set, &set))
    return CPU_COUNT(&set) > 0 ? CPU_COUNT(&set) : 1;
  /* sched_getaffinity fails with more processors than a cpu_set_t holds */
  n = sysconf(_SC_NPROCESSORS_ONLN);
  return n < 1 ? 1 : n > WORKERS_MAX ? WORKERS_MAX : (int)n;
}

static void *work(void *argument)
{
  struct worker *w = argument;
  struct loop *l = w->loop;
  size_t n_chunk = (l->n - 1) / l->grain + 1, c;

  thread_data = w->data;
  while ((c = atomic_fetch_add(&l->next, 1)) < n_chunk) {
    size_t first = c * l->grain, left = l->n - first;

    l->body(l->context, first, first + (left < l->grain ? left : l->grain),
            w->number);
  }
  return NULL;
}

void vg_parallel_for(int threads, size_t n, size_t grain, vg_loop_body body,
                     void *context)
{
  struct loop loop = { n, grain ? grain : 1, body, context, 0 };
  struct worker w[WORKERS_MAX];
  int started = 1;

  assert(threads >= 0);
  assert(body);
  if (!n) return;
  if (threads <= 0) threads = vg_cores();
  if (threads > WORKERS_MAX) threads = WORKERS_MAX;
  if ((size_t)threads > (n - 1) / loop.grain + 1)
    threads = (int)((n - 1) / loop.grain + 1);
  w[0] = (struct worker){ .loop = &loop, .data = thread_data };
  for (; started < threads; started++) {
    w[started] = (struct worker){ .loop = &loop,
                                  .number = started,
                                  .data = thread_data };
    if (pthread_create(&w[started].thread, NULL, work, &w[started])) break;
  }
  work(&w[0]);
  while (started-- > 1) pthread_join(w[started].thread, NULL);
}
