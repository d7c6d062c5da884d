/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The list of ready tasks on rank 0, which decides who executes what.
 *
 * A rank is given a task while it has fewer tasks than workers. It is given
 * one more per worker, so that the input arrives while the worker is busy,
 * only while the number of ready tasks is at least twice the number of workers
 * of the job: while tasks are scarce, the next task to become ready may be
 * more urgent than a task given ahead. When no task is ready any
 * more, a rank that holds a task it has not started passes it on to a waiting
 * rank (RECALL, work stealing).
 *
 * A cyclic schedule, for comparison, holds tasks with `work` > 0 back until
 * nothing else is left, and then assigns all of them to the workers in turn:
 * cutting comes first, filling afterwards, and no worker helps another. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "partition/engine/engine_parts.h"

/* A rank's own tasks are preferred while their priority is within this factor
 * of the highest one. This saves two messages and the transfer of an input. */
#define NEARLY 0.9 /* E1 */

/* State of a RECALL to a rank. */
enum { NOT_ASKED, ASKED, DECLINED };

vg_status vg_schedule_init(struct vg_schedule *l, int size,
                           struct vg_error *err)
{
  size_t n = (size_t)size;

  assert(size > 0);
  l->ready = vg_calloc(n, sizeof *l->ready);
  l->threads = vg_calloc(n, sizeof *l->threads);
  l->load = vg_calloc(n, sizeof *l->load);
  l->asked = vg_calloc(n, sizeof *l->asked);
  if (!l->ready || !l->threads || !l->load || !l->asked)
    return vg_fail_memory(err, "the list of tasks");
  return VG_OK;
}

void vg_schedule_release(struct vg_schedule *l, int size)
{
  for (int r = 0; l->ready && r < size; r++)
    while (l->ready[r]) free(vg_heap_pop(&l->ready[r]));
  for (size_t i = 0; i < l->n_held; i++) free(l->held[i]);
  free(l->held);
  free(l->ready);
  free(l->threads);
  free(l->load);
  free(l->asked);
  memset(l, 0, sizeof *l);
}

static void add_load(struct vg_schedule *l, int r, int d)
{
  l->n_underloaded -= l->load[r] < l->threads[r];
  l->load[r] += d;
  l->n_underloaded += l->load[r] < l->threads[r];
  if (d > 0 && l->asked[r] == DECLINED) l->asked[r] = NOT_ASKED;
}

/* Number of workers of rank r without a task or, if ahead is set, of free
 * slots at two tasks per worker. Rank 0 needs no tasks of its own ahead: they
 * are in its memory. */
static int free_slots(const struct vg_schedule *l, int r, int ahead)
{
  if (!ahead) return l->threads[r] - l->load[r];
  if (!r && l->ready[0]) return 0;
  return 2 * l->threads[r] - l->load[r];
}

static int most_free_slots(const struct vg_schedule *l, int size, int ahead)
{
  int best = -1;

  if (!ahead && !l->n_underloaded) return -1;
  for (int r = 0; r < size; r++)
    if (free_slots(l, r, ahead) > (best < 0 ? 0 : free_slots(l, best, ahead)))
      best = r;
  return best;
}

static int first_home(const struct vg_schedule *l, int size)
{
  int best = -1;

  for (int r = 0; r < size; r++)
    if (l->ready[r] &&
        (best < 0 || vg_heap_before(l->ready[r], l->ready[best])))
      best = r;
  return best;
}

/* Priorities may be negative; then a value nearer to zero is higher. */
static int nearly(double key, double best)
{
  return key >= (best > 0 ? best * NEARLY : best / NEARLY);
}

/* Assigns a waiting task to a rank, or to one of its workers. */
static void assign(struct vg_engine *e, struct vg_ready *task, int home, int to,
                   int lane)
{
  e->schedule.n_out++;
  add_load(&e->schedule, to, 1);
  if (home == e->rank) vg_serve_assign(e, task->handle, to, lane);
  else
    vg_engine_send(e, home, VG_MSG_ASSIGN,
                   (struct vg_msg){
                     .handle = task->handle, .to = to, .lane = lane });
  free(task);
}

/* Gives one task to a rank; 0 when no rank has a free slot. */
static int give(struct vg_engine *e, int ahead)
{
  struct vg_schedule *l = &e->schedule;
  int home = first_home(l, e->size), to;
  struct vg_ready *task;

  if (home < 0) return 0;
  to = free_slots(l, home, ahead) > 0 ? home
                                      : most_free_slots(l, e->size, ahead);
  if (to < 0) return 0;
  if (!e->options->shuffle && l->ready[to] &&
      nearly(l->ready[to]->key, l->ready[home]->key))
    home = to;
  task = (struct vg_ready *)vg_heap_pop(&l->ready[home]);
  l->n_ready--;
  assign(e, task, home, to, VG_LANE_ANY);
  return 1;
}

static int by_work(const void *a, const void *b)
{
  const struct vg_ready *s = *(struct vg_ready *const *)a;
  const struct vg_ready *t = *(struct vg_ready *const *)b;

  if (s->work != t->work) return s->work > t->work ? -1 : 1;
  return strcmp(s->path, t->path);
}

/* Assigns tasks to the workers in turn, one each: first those of rank 0, then
 * rank 1, and so on. */
static void assign_tasks(struct vg_engine *e)
{
  struct vg_schedule *l = &e->schedule;
  size_t n = l->n_held;
  int to = 0, lane = 0;

  qsort(l->held, n, sizeof *l->held, by_work);
  l->n_held = 0;
  for (size_t i = 0; i < n; i++) {
    assign(e, l->held[i], l->held[i]->home, to, lane);
    if (++lane < l->threads[to]) continue;
    lane = 0;
    to = (to + 1) % e->size;
  }
}

/* Workers wait and no task is ready: ask ranks to pass on tasks that they have
 * not started. Only the rank itself knows whether it has one. A load above its
 * number of workers is a hint, and the rank may decline. */
static void recall(struct vg_engine *e)
{
  struct vg_schedule *l = &e->schedule;

  for (int r = 0; r < e->size && l->n_underloaded; r++) {
    int to;

    if (l->load[r] <= l->threads[r] || l->asked[r] != NOT_ASKED) continue;
    to = most_free_slots(l, e->size, 0);
    add_load(l, to, 1);
    l->asked[r] = ASKED;
    if (r == e->rank) vg_serve_recall(e, to);
    else vg_engine_send(e, r, VG_MSG_RECALL, (struct vg_msg){ .to = to });
  }
}

static void finish(struct vg_engine *e)
{
  struct vg_schedule *l = &e->schedule;

  l->ended = 1;
  for (int r = 1; r < e->size; r++) {
    struct vg_final_status *v = vg_alloc(1, sizeof *v);
    struct vg_bytes b = { sizeof *v, (unsigned char *)v };

    if (v) {
      *v = l->final_status;
      v->sent = e->sent[r] + 1;
    }
    vg_engine_post(e, r, VG_MSG_END, &b);
  }
  e->final_status = l->final_status;
  e->ending = 1;
  vg_engine_wake(e);
}

static void dispatch(struct vg_engine *e)
{
  struct vg_schedule *l = &e->schedule;

  if (l->ended) return;
  if (!l->draining) {
    while (l->n_ready && l->n_underloaded && give(e, 0))
      ;
    while (e->size > 1 && l->n_ready >= 2 * l->n_worker && give(e, 1))
      ;
    if (e->size > 1 && !l->n_ready && l->n_underloaded) recall(e);
    if (l->n_held && !l->n_ready && !l->n_out && l->n_joined == (size_t)e->size)
      assign_tasks(e);
  }
  if (!l->ended && l->n_joined == (size_t)e->size && !l->n_out &&
      (l->draining || !(l->n_ready + l->n_held)))
    finish(e);
}

/* Is the task held back for static assignment? */
static int holds(const struct vg_engine *e, const struct vg_task_notice *n)
{
  return e->options->cyclic && n->work > 0;
}

static void add_ready(struct vg_engine *e, int from,
                      const struct vg_task_notice *n)
{
  struct vg_schedule *l = &e->schedule;
  struct vg_ready *task = vg_alloc(1, sizeof *task);

  if (!task ||
      vg_reserve(&l->held, &l->cap_held, l->n_held + 1, sizeof *l->held)) {
    struct vg_error err = VG_ERROR_INIT;

    vg_fail_memory(&err, "the list of tasks");
    vg_notify_fail(e, err.code, n->path, &err);
    free(task);
    return;
  }
  *task = (struct vg_ready){ .handle = n->handle,
                             .work = n->work,
                             .home = from };
  memcpy(task->path, n->path, sizeof task->path);
  task->place.key = n->key;
  task->place.path = task->path;
  if (holds(e, n)) {
    l->held[l->n_held++] = task;
    return;
  }
  vg_heap_push(&l->ready[from], &task->place);
  l->n_ready++;
}

/* Pinned tasks are in the queue of their rank already. */
void vg_schedule_update(struct vg_engine *e, int from,
                        const struct vg_update *update,
                        const struct vg_task_notice *notice)
{
  assert(from >= 0 && from < e->size && (notice || !update->n));

  struct vg_schedule *l = &e->schedule;

  if (update->ended) {
    l->n_done++;
    l->n_out--;
    l->cells += (double)update->n_cell;
    l->open -= update->weight;
  } else {
    l->n_joined++;
    l->threads[from] = update->threads;
    l->n_worker += (size_t)update->threads;
    l->n_underloaded += l->load[from] < update->threads;
  }
  for (uint64_t i = 0; i < update->n; i++) {
    l->n_known++;
    l->open += notice[i].weight;
    if (notice[i].pinned) {
      l->n_out++;
      add_load(l, from, 1);
    } else {
      add_ready(e, from, &notice[i]);
    }
  }
  assert(l->n_done <= l->n_known && l->n_out <= l->n_known - l->n_done);
  dispatch(e);
}

void vg_schedule_free(struct vg_engine *e, int from)
{
  assert(from >= 0 && from < e->size);
  add_load(&e->schedule, from, -1);
  dispatch(e);
}

void vg_schedule_moved(struct vg_engine *e, int from, int to, int ok)
{
  assert(from >= 0 && from < e->size && to >= 0 && to < e->size);

  struct vg_schedule *l = &e->schedule;

  l->asked[from] = ok ? NOT_ASKED : DECLINED;
  add_load(l, ok ? from : to, -1);
  dispatch(e);
}

static int is_failure(const struct vg_final_status *v)
{
  return v->status < 0 && v->status != VG_ERR_STOPPED;
}

/* Of several failures the one with the lowest path is reported, so that
 * messages are as reproducible as possible. Any failure takes precedence over
 * a stop. */
void vg_schedule_fail(struct vg_engine *e, const struct vg_final_status *v)
{
  assert(v->status != VG_OK);

  struct vg_schedule *l = &e->schedule;
  struct vg_final_status *w = &l->final_status;

  if (l->ended) return;
  if (!w->status ||
      (is_failure(v) && (!is_failure(w) || strcmp(v->path, w->path) < 0)))
    *w = *v;
  if (!l->draining) {
    l->draining = 1;
    for (int r = 1; r < e->size; r++)
      vg_engine_send(e, r, VG_MSG_DRAIN, (struct vg_msg){ 0 });
  }
  vg_serve_drain(e);
  dispatch(e);
}
