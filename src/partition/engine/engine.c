/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "partition/engine/engine.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/hash.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "partition/engine/engine_parts.h"

void vg_engine_lock(struct vg_engine *e)
{
  pthread_mutex_lock(&e->lock);
}

void vg_engine_unlock(struct vg_engine *e)
{
  pthread_mutex_unlock(&e->lock);
}

int vg_engine_stopping(const struct vg_engine *e)
{
  return atomic_load(&e->stopping);
}

static int stopping(void *e)
{
  return vg_engine_stopping(e);
}

struct vg_stop vg_engine_stop(const struct vg_engine *e)
{
  return (struct vg_stop){ e ? stopping : NULL, (void *)(uintptr_t)e };
}

void vg_task_state_free(struct vg_engine *e, struct vg_task_state *j)
{
  if (!j) return;
  if (j->task.input) e->ops->release_input(e->user, j->task.input);
  if (j->outcome) e->ops->release_outcome(e->user, j->outcome);
  free(j->bytes.data);
  free(j);
}

/* --- tasks --------------------------------------------------------------- */

/* A number in [0, 1) that depends on path and seed alone. */
static double draw(const char *path, uint64_t seed)
{
  uint64_t h = seed;

  for (; *path; path++) h = vg_hash_add(h, (unsigned char)*path);
  return (double)(vg_hash_mix(h) >> 11) * 0x1p-53;
}

static int legal(const struct vg_task *t)
{
  return t->path[0] && memchr(t->path, 0, sizeof t->path) &&
         isfinite(t->priority) && isfinite(t->weight) && isfinite(t->work);
}

/* Reserves room for the new tasks in all lists, so that entering them cannot
 * fail. */
static int make_room(struct vg_engine *e)
{
  size_t n = e->n_new + 1;

  return vg_reserve(&e->new_task, &e->cap_new, n, sizeof *e->new_task) ||
         vg_reserve(&e->notice, &e->cap_notice, n, sizeof *e->notice) ||
         vg_reserve(&e->home, &e->cap_home, e->n_home + n, sizeof *e->home);
}

vg_status vg_engine_submit(struct vg_engine *e, const struct vg_task *task,
                           struct vg_error *err)
{
  struct vg_task_state *j = NULL;
  vg_status st = VG_OK;
  int bad;

  assert(e && task);
  if (!legal(task)) {
    st = vg_fail(err, VG_ERR_INPUT,
                 "task '%.*s': its path is empty, or its priority "
                 "or weight is not a number",
                 VG_PATH_MAX - 1, task->path);
  } else {
    vg_engine_lock(e);
    bad = make_room(e);
    vg_engine_unlock(e);
    if (bad || !(j = vg_calloc(1, sizeof *j)))
      st = vg_fail_memory(err, "a task");
  }
  if (st) {
    if (task->input) e->ops->release_input(e->user, task->input);
    return st;
  }
  j->task = *task;
  memcpy(j->after, e->doing, sizeof j->after);
  j->home = e->rank;
  j->lane = VG_LANE_ANY;
  j->place.path = j->task.path;
  j->place.key = e->options->shuffle ? draw(task->path, e->options->shuffle)
                                     : task->priority;
  e->new_task[e->n_new++] = j;
  return VG_OK;
}

static vg_status submit_first(struct vg_engine *e, size_t n,
                              const struct vg_task *first, struct vg_error *err)
{
  vg_status st = VG_OK;
  size_t i;

  for (i = 0; i < n && !st; i++) st = vg_engine_submit(e, &first[i], err);
  for (; i < n; i++)
    if (first[i].input) e->ops->release_input(e->user, first[i].input);
  return st;
}

/* --- start and end ------------------------------------------------------- */

static vg_status init(struct vg_engine *e, struct vg_error *err)
{
  pthread_condattr_t clock;
  size_t n = (size_t)e->size;

  pthread_mutex_init(&e->lock, NULL);
  pthread_cond_init(&e->work, NULL);
  pthread_cond_init(&e->handler, NULL);
  pthread_condattr_init(&clock);
  pthread_condattr_setclock(&clock, CLOCK_MONOTONIC);
  pthread_cond_init(&e->serve, &clock);
  pthread_condattr_destroy(&clock);
  e->sent = vg_calloc(n, sizeof *e->sent);
  e->received = vg_calloc(n, sizeof *e->received);
  e->said = vg_calloc(n, sizeof *e->said);
  if (!e->sent || !e->received || !e->said)
    return vg_fail_memory(err, "the list of ranks");
  return e->rank ? VG_OK : vg_schedule_init(&e->schedule, e->size, err);
}

static void release(struct vg_engine *e)
{
  for (size_t i = 0; i < e->n_new; i++) vg_task_state_free(e, e->new_task[i]);
  for (size_t i = 0; i < e->n_home; i++) vg_task_state_free(e, e->home[i]);
  free(e->new_task);
  free(e->notice);
  free(e->home);
  free(e->worker);
  free(e->sent);
  free(e->received);
  free(e->said);
  vg_spans_release(&e->spans);
  if (!e->rank) vg_schedule_release(&e->schedule, e->size);
  pthread_mutex_destroy(&e->lock);
  pthread_cond_destroy(&e->work);
  pthread_cond_destroy(&e->handler);
  pthread_cond_destroy(&e->serve);
}

/* Starts up to `threads` workers, as many as the system allows, and the
 * progress thread as worker[threads]. */
static vg_status start(struct vg_engine *e, int threads, struct vg_error *err)
{
  int n = 0, handler = e->size > 1, bad = 0;

  e->worker = vg_calloc((size_t)threads + 1, sizeof *e->worker);
  if (!e->worker) return vg_fail_memory(err, "threads");
  if (handler) {
    struct vg_worker *w = &e->worker[threads];

    w->e = e;
    w->data = vg_thread_data();
    bad = pthread_create(&w->thread, NULL, vg_work_handler, w);
    e->handler_index = bad ? 0 : threads;
  }
  for (; n < threads && !bad; n++) {
    struct vg_worker *w = &e->worker[n];

    *w = (struct vg_worker){ .e = e, .number = n, .data = vg_thread_data() };
    if (pthread_create(&w->thread, NULL, vg_work_thread, w)) break;
  }
  e->threads = n;
  if (n) return VG_OK;
  return vg_fail(err, VG_ERR_MEMORY,
                 "no thread can be started; raise the "
                 "limit of processes (ulimit -u) or of memory");
}

static void stop_threads(struct vg_engine *e)
{
  vg_engine_lock(e);
  e->over = 1;
  pthread_cond_broadcast(&e->work);
  pthread_cond_broadcast(&e->handler);
  vg_engine_unlock(e);
  for (int i = 0; i < e->threads; i++) pthread_join(e->worker[i].thread, NULL);
  if (e->handler_index) pthread_join(e->worker[e->handler_index].thread, NULL);
  e->threads = e->handler_index = 0;
}

/* The final status that rank 0 has sent. */
static vg_status final_status(const struct vg_engine *e, struct vg_error *err)
{
  const struct vg_final_status *v = &e->final_status;

  if (v->status >= 0) return (vg_status)v->status;
  if (v->status == VG_ERR_STOPPED)
    return vg_fail(err, VG_ERR_STOPPED, "stopped on request before completion");
  if (v->from == e->rank)
    return vg_fail(err, (vg_status)v->status, "%s", v->text);
  return vg_fail(err, (vg_status)v->status, "rank %d: %s", v->from, v->text);
}

/* Appends the lists of other ranks to the list of rank 0. list: address of the
 * pointer to items of `size` bytes. Collective. */
static vg_status gather_list(struct vg_engine *e, void *list, size_t *count,
                             size_t *cap, size_t size, struct vg_error *err)
{
  size_t n = (size_t)e->size;
  struct vg_bytes *to = vg_calloc(n, sizeof *to);
  struct vg_bytes *from = vg_calloc(n, sizeof *from);
  unsigned char *item;
  vg_status st = VG_OK;

  if (!to || !from) st = vg_fail_memory(err, "the trace of tasks");
  VG_TRY(vg_comm_agree(e->comm, st, err));
  memcpy(&item, list, sizeof item);
  if (e->rank) to[0] = (struct vg_bytes){ *count * size, item };
  VG_TRY(vg_comm_exchange(e->comm, to, from, err));
  for (size_t r = 1; r < n && !e->rank; r++) {
    size_t more = from[r].n / size;

    if (vg_reserve(list, cap, *count + more, size)) {
      st = vg_fail_memory(err, "the trace of tasks");
      goto done;
    }
    memcpy(&item, list, sizeof item);
    if (more) memcpy(item + *count * size, from[r].data, more * size);
    *count += more;
  }
done:
  vg_bytes_release(from, n);
  free(to);
  return vg_comm_agree(e->comm, st, err);
}

/* Gathers all spans of the job on rank 0; other ranks keep their own. A span's
 * times are relative to the start of its rank, so the wall time is the largest
 * of all ranks. Collective. */
static vg_status gather(struct vg_engine *e, struct vg_error *err)
{
  struct vg_spans *s = &e->spans;
  vg_status st = vg_comm_max(e->comm, 1, &s->wall, err);

  if (!st) st = gather_list(e, &s->span, &s->n, &s->cap, sizeof *s->span, err);
  if (st) return st;
  return gather_list(e, &s->help, &s->n_help, &s->cap_help, sizeof *s->help,
                     err);
}

/* Everything that may fail at the start, on all ranks or none. */
static vg_status begin(struct vg_engine *e, size_t n_first,
                       const struct vg_task *first, double *n_thread,
                       struct vg_error *err)
{
  int threads = e->options->threads > 1 ? e->options->threads : 1;
  vg_status st = init(e, err), submitted;

  submitted = submit_first(e, n_first, first, st ? NULL : err);
  if (!st) st = submitted;
  if (!st) st = start(e, threads, err);
  if (e->size == 1) return st;
  st = vg_comm_agree(e->comm, st, err);
  return st ? st : vg_comm_max(e->comm, 1, n_thread, err);
}

static vg_status conduct(struct vg_engine *e, struct vg_error *err)
{
  vg_status st = VG_OK;

  e->begin = vg_clock();
  vg_engine_lock(e);
  vg_notify_update(e, NULL);
  vg_engine_unlock(e);
  vg_serve(e);
  stop_threads(e);
  if (e->rank)
    vg_engine_send(e, 0, VG_MSG_BYE,
                   (struct vg_msg){ .handle = e->sent[0] + 1 });
  e->spans.wall = vg_clock() - e->begin;
  if (e->size > 1) st = gather(e, err);
  return st < 0 ? st : final_status(e, err);
}

vg_status vg_engine_run(struct vg_comm *comm,
                        const struct vg_engine_options *options,
                        const struct vg_engine_ops *ops, void *user,
                        size_t n_first, const struct vg_task *first,
                        struct vg_spans *spans, struct vg_error *err)
{
  assert(options->threads >= 1 && ops->run && ops->done);
  assert(first || !n_first);

  struct vg_spans none = VG_SPANS_INIT;
  struct vg_engine e = { .comm = comm,
                         .rank = vg_comm_rank(comm),
                         .size = vg_comm_size(comm),
                         .options = options,
                         .ops = ops,
                         .user = user };
  double n_thread = options->threads > 1 ? options->threads : 1;
  vg_status st = begin(&e, n_first, first, &n_thread, err);

  if (!st) st = conduct(&e, err);
  else stop_threads(&e);
  if (st >= 0 && spans) {
    e.spans.n_rank = e.size;
    e.spans.n_thread = (int32_t)n_thread;
    vg_spans_sort(&e.spans);
    *spans = e.spans;
    e.spans = none;
  }
  release(&e);
  return st;
}
