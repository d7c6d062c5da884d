/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The calling thread of vg_engine_run serves messages and polls the caller's
 * stop and progress.
 *
 * MPI has no way to wait for a message without occupying a core, so this
 * thread sleeps between polls: briefly after a message was received or sent,
 * and longer and longer while nothing happens, until the polls take the share
 * SHARE of a core. The cost of a poll is measured, since it differs tenfold
 * between machines; where a wakeup is cheap, messages wait less. Messages from
 * the same node do not wait, because the sender wakes the receiver. In a job
 * of one rank the thread wakes only for stop and progress. */
#define _GNU_SOURCE
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/clock.h"
#include "base/memory.h"
#include "partition/engine/engine_parts.h"

/* Seconds. */
#define SLEEP_MIN                                                              \
  50e-6 /* E2: plus the same again from the kernel's timer                     \
           slack */
#define SLEEP_MORE 1.5
#define SLEEP_LOW 300e-6 /* bounds of the longest sleep */
#define SLEEP_HIGH 5e-3
#define SLEEP_ALONE 20e-3
#define SHARE 0.005
#define STOP_EVERY 20e-3
#define PROGRESS_EVERY 0.2
#define PATIENCE 30.0 /* until a failing mailbox aborts the job */

static void push_out(struct vg_engine *e, struct vg_task_state *j, int to)
{
  j->to = to;
  j->next = NULL;
  if (e->out.last) e->out.last->next = j;
  else e->out.first = j;
  e->out.last = j;
  vg_engine_wake(e);
}

void vg_serve_assign(struct vg_engine *e, uint64_t handle, int to, int lane)
{
  assert(handle < e->n_home && e->home[handle]);
  assert(to >= 0 && to < e->size && lane >= VG_LANE_ANY);

  struct vg_task_state *j = e->home[handle];

  j->lane = lane;
  if (to == e->rank) vg_work_queue(e, j);
  else push_out(e, j, to);
}

void vg_serve_recall(struct vg_engine *e, int to)
{
  assert(to >= 0 && to < e->size);

  struct vg_task_state *j = (struct vg_task_state *)vg_heap_pop(&e->queue[0]);

  if (j) push_out(e, j, to);
  vg_notify_moved(e, to, j != NULL);
}

void vg_serve_drain(struct vg_engine *e)
{
  atomic_store(&e->stopping, 1);
  pthread_cond_broadcast(&e->work);
}

/* --- sending inputs ------------------------------------------------------ */

static vg_status pack(struct vg_engine *e, struct vg_task_state *j,
                      struct vg_error *err)
{
  struct vg_bytes *b = &j->bytes;
  struct vg_input_trailer c;
  unsigned char *data;

  memset(&c, 0, sizeof c);
  if (!j->packed && j->task.input) {
    vg_status st = e->ops->pack_input(e->user, j->task.input, b, err);

    if (st) return st;
    j->packed = 1;
  }
  data = vg_realloc(b->data, b->n + sizeof c, 1);
  if (!data) return vg_fail_memory(err, "the input of a task");
  b->data = data;
  memcpy(c.path, j->task.path, sizeof c.path);
  memcpy(c.after, j->after, sizeof c.after);
  c.key = j->place.key;
  c.priority = j->task.priority;
  c.weight = j->task.weight;
  c.work = j->task.work;
  c.lane = j->lane;
  c.handle = j->handle;
  c.home = j->home;
  c.kind = j->task.kind;
  c.moves = j->task.moves;
  c.has = j->packed;
  memcpy(data + b->n, &c, sizeof c);
  b->n += sizeof c;
  return VG_OK;
}

static void send_input(struct vg_engine *e, struct vg_task_state *j)
{
  struct vg_error err = VG_ERROR_INIT;
  vg_status st = VG_OK;
  int at_home = j->home == e->rank, to = j->to;

  if (vg_engine_stopping(e) || (st = pack(e, j, &err))) {
    vg_engine_lock(e);
    if (st) vg_notify_fail(e, st, j->task.path, &err);
    vg_engine_unlock(e);
    vg_work_drop(e, j);
    return;
  }
  if (at_home && j->task.input) {
    e->ops->release_input(e->user, j->task.input);
    j->task.input = NULL;
  }
  j->packed = 0;
  vg_engine_lock(e);
  vg_engine_post(e, to, VG_MSG_INPUT, &j->bytes);
  j->bytes = (struct vg_bytes){ 0 };
  vg_engine_unlock(e);
  if (!at_home) vg_task_state_free(e, j);
}

static int send_inputs(struct vg_engine *e)
{
  struct vg_task_state *j;
  int n = 0;

  for (;; n++) {
    vg_engine_lock(e);
    j = e->out.first;
    if (j && !(e->out.first = j->next)) e->out.last = NULL;
    vg_engine_unlock(e);
    if (!j) return n;
    send_input(e, j);
  }
}

/* --- messages ------------------------------------------------------------ */

/* Removes the last n bytes and copies them to `end`. */
static void cut(struct vg_bytes *b, void *end, size_t n)
{
  b->n -= n;
  memcpy(end, b->data + b->n, n);
}

/* Takes a task to be executed here; a task of this rank may return
 * unstarted. */
static void take_input(struct vg_engine *e, struct vg_bytes *b)
{
  struct vg_input_trailer c;
  struct vg_task_state *j;

  cut(b, &c, sizeof c);
  j = c.home == e->rank ? e->home[c.handle] : vg_calloc(1, sizeof *j);
  if (!j) {
    struct vg_error err = VG_ERROR_INIT;

    vg_fail_memory(&err, "a task");
    vg_notify_fail(e, err.code, c.path, &err);
    vg_notify_dropped(e, c.weight);
    return;
  }
  memcpy(j->task.path, c.path, sizeof c.path);
  memcpy(j->after, c.after, sizeof c.after);
  j->task.kind = (char)c.kind;
  j->task.moves = c.moves;
  j->task.priority = c.priority;
  j->task.weight = c.weight;
  j->task.work = c.work;
  j->lane = c.lane;
  j->handle = c.handle;
  j->home = c.home;
  j->place.key = c.key;
  j->place.path = j->task.path;
  j->packed = c.has;
  j->bytes = *b;
  *b = (struct vg_bytes){ 0 };
  vg_work_queue(e, j);
}

static void take_outcome(struct vg_engine *e, int from, struct vg_bytes *b)
{
  struct vg_outcome_trailer ret;
  struct vg_task_state *j;

  cut(b, &ret, sizeof ret);
  j = e->home[ret.handle];
  j->n_cell = ret.n_cell;
  j->runner = from;
  j->packed = ret.has != 0;
  j->bytes = *b;
  *b = (struct vg_bytes){ 0 };
  vg_work_end(e, j);
  pthread_cond_signal(&e->handler);
}

static void take_update(struct vg_engine *e, int from, const struct vg_bytes *b)
{
  struct vg_update update;

  memcpy(&update, b->data, sizeof update);
  vg_schedule_update(e, from, &update,
                     (const struct vg_task_notice *)(b->data + sizeof update));
}

static void take_final_status(struct vg_engine *e, const struct vg_message *m)
{
  struct vg_final_status v;

  memcpy(&v, m->bytes.data, sizeof v);
  if (m->kind == VG_MSG_FAIL) {
    vg_schedule_fail(e, &v);
    return;
  }
  e->final_status = v;
  e->said[0] = v.sent;
  e->ending = 1;
}

static void take_short(struct vg_engine *e, const struct vg_message *m)
{
  struct vg_msg msg;

  memcpy(&msg, m->bytes.data, sizeof msg);
  switch (m->kind) {
  case VG_MSG_FREE: vg_schedule_free(e, m->from); break;
  case VG_MSG_MOVED: vg_schedule_moved(e, m->from, msg.to, msg.ok); break;
  case VG_MSG_ASSIGN: vg_serve_assign(e, msg.handle, msg.to, msg.lane); break;
  case VG_MSG_RECALL: vg_serve_recall(e, msg.to); break;
  case VG_MSG_DRAIN: vg_serve_drain(e); break;
  case VG_MSG_BYE: e->said[m->from] = msg.handle; break;
  }
}

/* There was no memory for a message, as vg_comm_poll has reported. If the
 * message carried a task, the task is dropped. */
static void lose(struct vg_engine *e, const struct vg_message *m)
{
  if (m->kind != VG_MSG_INPUT && m->kind != VG_MSG_OUTCOME)
    vg_comm_abort(e->comm, 1, VG_ENGINE_NO_MEMORY);
  vg_notify_dropped(e, 0);
}

static void take(struct vg_engine *e, struct vg_message *m)
{
  vg_engine_lock(e);
  e->received[m->from]++;
  if (!m->bytes.data) lose(e, m);
  else switch (m->kind) {
    case VG_MSG_UPDATE: take_update(e, m->from, &m->bytes); break;
    case VG_MSG_INPUT: take_input(e, &m->bytes); break;
    case VG_MSG_OUTCOME: take_outcome(e, m->from, &m->bytes); break;
    case VG_MSG_FAIL:
    case VG_MSG_END: take_final_status(e, m); break;
    default: take_short(e, m);
    }
  vg_engine_unlock(e);
  free(m->bytes.data);
}

/* Takes all messages. If one cannot be received, the job fails, and dropping
 * tasks may free the memory it needs. After PATIENCE the rank aborts the job,
 * since the others would wait for it. Returns the number of messages. */
static int receive(struct vg_engine *e, double *failing)
{
  struct vg_error err = VG_ERROR_INIT;
  struct vg_message m;
  vg_status st;
  int n = 0;

  for (; (st = vg_comm_poll(e->comm, &m, &err)) == VG_OK; n++) take(e, &m);
  if (st > 0) {
    *failing = 0;
    return n;
  }
  if (!*failing) {
    *failing = vg_clock();
    vg_engine_lock(e);
    vg_notify_fail(e, st, "", &err);
    vg_engine_unlock(e);
  } else if (vg_clock() - *failing > PATIENCE) {
    vg_comm_abort(e->comm, 1, VG_ENGINE_NO_MEMORY);
  }
  return n;
}

/* --- the loop ------------------------------------------------------------ */

static void ask_stop(struct vg_engine *e)
{
  if (vg_engine_stopping(e) || !vg_stops(&e->options->stop)) return;
  vg_engine_lock(e);
  vg_notify_fail(e, VG_ERR_STOPPED, "", NULL);
  vg_engine_unlock(e);
}

static void show_progress(struct vg_engine *e)
{
  const struct vg_engine_options *o = e->options;
  struct vg_schedule *l = &e->schedule;
  double cells, known;
  size_t n_done, n_known;

  if (e->rank || !o->progress) return;
  vg_engine_lock(e);
  cells = l->cells;
  known = l->cells + (l->open > 0 && l->n_done < l->n_known ? l->open : 0);
  n_done = l->n_done;
  n_known = l->n_known;
  vg_engine_unlock(e);
  o->progress(o->user, cells, known, n_done, n_known);
}

/* Nothing is left, and no message to this rank is in transit. */
static int all_over(const struct vg_engine *e)
{
  int first = e->rank ? 0 : 1, end = e->rank ? 1 : e->size;

  if (!e->ending) return 0;
  for (int r = first; r < end; r++)
    if (!e->said[r] || e->said[r] != e->received[r]) return 0;
  return 1;
}

struct pace {
  double sleep, longest; /* in s */
  double cpu; /* Processor time of this thread at the start of the sample. */
  int n;      /* Idle polls since then. */
};

static void set_pace(struct pace *p, int active)
{
  enum { SAMPLE = 32 };
  double cpu;

  if (active) {
    p->sleep = SLEEP_MIN;
    p->n = -1;
  } else {
    p->sleep = fmin(SLEEP_MORE * p->sleep, p->longest);
  }
  p->n++;
  if (p->n % SAMPLE) return;
  cpu = vg_clock_thread();
  if (p->n)
    p->longest = fmax(SLEEP_LOW,
                      fmin((cpu - p->cpu) / (SAMPLE * SHARE), SLEEP_HIGH));
  p->cpu = cpu;
  p->n = 0;
}

/* Called with the lock held; with several ranks the lock is released during
 * the sleep. */
static void sleep_for(struct vg_engine *e, double seconds, unsigned wakes)
{
  struct timespec until;
  double t = vg_clock() + seconds;

  if (e->size > 1) {
    vg_engine_unlock(e);
    vg_comm_sleep(e->comm, wakes, seconds);
    vg_engine_lock(e);
    return;
  }
  until.tv_sec = (time_t)t;
  until.tv_nsec = (long)(1e9 * (t - (double)until.tv_sec));
  pthread_cond_timedwait(&e->serve, &e->lock, &until);
}

/* Sleeps, unless the engine is done, there is something to send, or a wakeup
 * came since the count was read. Returns 1 when the engine is done. */
static int doze(struct vg_engine *e, struct pace *pace, int active,
                unsigned wakes)
{
  int over;

  vg_engine_lock(e);
  if (e->size > 1) set_pace(pace, active || e->poll_soon);
  e->poll_soon = 0;
  over = all_over(e);
  if (!over && !e->out.first) {
    sleep_for(e, pace->sleep, wakes);
    over = all_over(e);
  }
  vg_engine_unlock(e);
  return over;
}

void vg_serve(struct vg_engine *e)
{
  struct pace pace = { .sleep = e->size > 1 ? SLEEP_MIN : SLEEP_ALONE,
                       .longest = SLEEP_LOW };
  double failing = 0, stop = 0, progress = e->begin;
  unsigned wakes = 0;
  int active;

  do {
    double now = vg_clock();

    if (e->size > 1) wakes = vg_comm_wake_count(e->comm);
    active = e->size > 1 ? receive(e, &failing) : 0;
    active += send_inputs(e);
    if (now - stop >= STOP_EVERY) {
      ask_stop(e);
      stop = now;
    }
    if (now - progress >= PROGRESS_EVERY) {
      show_progress(e);
      progress = now;
    }
  } while (!doze(e, &pace, active, wakes));
  show_progress(e);
}
