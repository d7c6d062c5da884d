/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The workers: they execute tasks, and call `done` for tasks that have
 * ended. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/memory.h"
#include "partition/engine/engine_parts.h"

/* A signal wakes any sleeping worker. A task that is assigned to one worker
 * therefore needs a broadcast. */
void vg_work_queue(struct vg_engine *e, struct vg_task_state *j)
{
  assert(j->lane >= VG_LANE_ANY && j->lane < e->threads);
  if (j->lane == VG_LANE_ANY) {
    vg_heap_push(&e->queue[j->task.pinned != 0], &j->place);
    pthread_cond_signal(&e->work);
  } else {
    vg_heap_push(&e->worker[j->lane].assigned, &j->place);
    pthread_cond_broadcast(&e->work);
  }
}

static struct vg_task_state *next_job(struct vg_worker *w)
{
  struct vg_heap **q[] = { &w->e->queue[0], &w->e->queue[1], &w->assigned };
  struct vg_heap **first = NULL;

  for (size_t i = 0; i < sizeof q / sizeof *q; i++)
    if (*q[i] && (!first || vg_heap_before(*q[i], *first))) first = q[i];
  return first ? (struct vg_task_state *)vg_heap_pop(first) : NULL;
}

/* A worker that ends a task of its own rank calls `done` itself, or leaves it
 * to the thread that already runs `done`. Outcomes from other ranks wake the
 * progress thread. */
void vg_work_end(struct vg_engine *e, struct vg_task_state *j)
{
  j->next = NULL;
  if (e->ended.last) e->ended.last->next = j;
  else e->ended.first = j;
  e->ended.last = j;
}

/* Drops a task that will not be done. If its home is another rank, that rank
 * releases its state of the task at the end. */
void vg_work_drop(struct vg_engine *e, struct vg_task_state *j)
{
  double weight = j->task.weight;

  vg_engine_lock(e);
  if (j->home == e->rank) e->home[j->handle] = NULL;
  vg_engine_unlock(e);
  vg_task_state_free(e, j);
  vg_engine_lock(e);
  vg_notify_dropped(e, weight);
  vg_engine_unlock(e);
}

static vg_status unpack(struct vg_engine *e, struct vg_task_state *j,
                        struct vg_error *err)
{
  vg_status st;

  if (!j->packed) return VG_OK;
  st = e->ops->unpack_input(e->user, &j->bytes, &j->task.input, err);
  free(j->bytes.data);
  j->bytes = (struct vg_bytes){ 0 };
  j->packed = 0;
  return st;
}

/* Packs the outcome as bytes, with a vg_outcome_trailer at the end. */
static vg_status pack_return(struct vg_engine *e, struct vg_task_state *j,
                             struct vg_error *err)
{
  struct vg_outcome_trailer ret = { j->handle, j->n_cell, j->outcome != NULL };
  struct vg_bytes *b = &j->bytes;
  unsigned char *data;
  vg_status st = VG_OK;

  if (j->outcome) {
    st = e->ops->pack_outcome(e->user, j->outcome, b, err);
    e->ops->release_outcome(e->user, j->outcome);
    j->outcome = NULL;
  }
  if (st < 0) return st;
  data = vg_realloc(b->data, b->n + sizeof ret, 1);
  if (!data) return vg_fail_memory(err, "the outcome of a task");
  memcpy(data + b->n, &ret, sizeof ret);
  b->data = data;
  b->n += sizeof ret;
  return VG_OK;
}

static void record(struct vg_worker *w, const struct vg_task_state *j,
                   struct vg_span *span, double start, double cpu)
{
  memcpy(span->path, j->task.path, sizeof span->path);
  memcpy(span->after, j->after, sizeof span->after);
  span->kind = j->task.kind;
  span->rank = w->e->rank;
  span->thread = w->number;
  span->home = j->home;
  span->start = start - w->e->begin;
  span->end = vg_clock() - w->e->begin;
  span->cpu += vg_clock_thread() - cpu + w->helped;
  span->loops = w->loops;
  span->estimate = j->task.weight;
  span->work = j->task.work;
  span->n_cell = j->n_cell;
}

/* Is `done` called on this rank? */
static int stays(const struct vg_engine *e, const struct vg_task_state *j)
{
  return j->home == e->rank || j->task.moves;
}

static vg_status run(struct vg_worker *w, struct vg_task_state *j,
                     struct vg_span *span, struct vg_error *err)
{
  struct vg_engine *e = w->e;
  struct vg_done done = { 0 };
  vg_status st;

  if (j->home != e->rank) span->bytes_in = j->bytes.n;
  st = unpack(e, j, err);
  if (!st)
    st = e->ops->run(e->user, e, &j->task, w->number, &j->outcome, &done, err);
  j->n_cell = done.n_cell;
  span->n_face = done.n_face;
  span->cpu = done.other_seconds;
  if (j->task.input) e->ops->release_input(e->user, j->task.input);
  j->task.input = NULL;
  if (st || stays(e, j)) return st;
  vg_engine_lock(e);
  w->unreported = 0;
  vg_notify_free(e);
  vg_engine_unlock(e);
  st = pack_return(e, j, err);
  span->bytes_out = st ? 0 : j->bytes.n - sizeof(struct vg_outcome_trailer);
  return st;
}

/* A stop is not a failure. A task that stops although no stop was requested
 * stops the job. */
static void fail(struct vg_engine *e, const struct vg_task_state *j,
                 vg_status st, const struct vg_error *err)
{
  vg_engine_lock(e);
  if (st != VG_ERR_STOPPED) vg_notify_fail(e, st, j->task.path, err);
  else if (!vg_engine_stopping(e)) vg_notify_fail(e, st, "", NULL);
  vg_engine_unlock(e);
}

static void do_job(struct vg_worker *w, struct vg_task_state *j)
{
  struct vg_engine *e = w->e;
  struct vg_error err = VG_ERROR_INIT;
  double start = vg_clock(), cpu = vg_clock_thread();
  struct vg_span span;
  vg_status st;

  if (vg_engine_stopping(e)) {
    vg_work_drop(e, j);
    return;
  }
  memset(&span, 0, sizeof span);
  w->doing = j->task.path;
  w->loops = w->helped = 0;
  st = run(w, j, &span, &err);
  if (st) {
    fail(e, j, st, &err);
    vg_work_drop(e, j);
    return;
  }
  record(w, j, &span, start, cpu);
  vg_engine_lock(e);
  if (vg_spans_add(&e->spans, &span, &err))
    vg_notify_fail(e, err.code, j->task.path, &err);
  if (stays(e, j)) {
    j->runner = e->rank;
    vg_work_end(e, j); /* freed by the thread that calls `done` */
    j = NULL;
  } else {
    vg_engine_post(e, j->home, VG_MSG_OUTCOME, &j->bytes);
  }
  vg_engine_unlock(e);
  vg_task_state_free(e, j);
}

/* Calls `done` for one task, with the lock released meanwhile. */
static void end_one(struct vg_engine *e)
{
  struct vg_task_state *j = e->ended.first;
  struct vg_error err = VG_ERROR_INIT;
  vg_status st = VG_OK;

  e->ended.first = j->next;
  if (!j->next) e->ended.last = NULL;
  e->in_done = 1;
  memcpy(e->doing, j->task.path, sizeof e->doing);
  vg_engine_unlock(e);
  if (j->packed)
    st = e->ops->unpack_outcome(e->user, &j->bytes, &j->outcome, &err);
  if (!st) {
    void *outcome = j->outcome;

    j->outcome = NULL;
    st = e->ops->done(e->user, e, &j->task, outcome, j->runner, &err);
  }
  if (st) fail(e, j, st, &err);
  vg_engine_lock(e);
  if (j->home == e->rank) e->home[j->handle] = NULL;
  vg_notify_update(e, j);
  e->in_done = 0;
  vg_engine_unlock(e);
  vg_task_state_free(e, j);
  vg_engine_lock(e);
}

void *vg_work_thread(void *worker)
{
  struct vg_worker *w = worker;
  struct vg_engine *e = w->e;
  struct vg_task_state *j;

  vg_thread_data_set(w->data);
  vg_loop_enter(w);
  vg_engine_lock(e);
  while (!e->over) {
    if (e->ended.first && !e->in_done) {
      w->doing = e->doing;
      end_one(e);
    } else if (w->unreported) {
      w->unreported = 0;
      vg_notify_free(e);
    } else if ((j = next_job(w))) {
      w->unreported = 1;
      vg_engine_unlock(e);
      do_job(w, j);
      vg_engine_lock(e);
    } else if (!vg_loop_help(w)) {
      e->n_idle++;
      pthread_cond_wait(&e->work, &e->lock);
      e->n_idle--;
    }
  }
  vg_engine_unlock(e);
  return NULL;
}

void *vg_work_handler(void *worker)
{
  struct vg_worker *w = worker;
  struct vg_engine *e = w->e;

  vg_thread_data_set(w->data);
  vg_engine_lock(e);
  while (!e->over) {
    if (e->ended.first && !e->in_done) end_one(e);
    else pthread_cond_wait(&e->handler, &e->lock);
  }
  vg_engine_unlock(e);
  return NULL;
}
