/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The simulation. There are two kinds of event, processed by time: a task has
 * been computed, and its outcome has arrived at home, which ends the task. All
 * events of one moment are processed before tasks are assigned again. */
#include "partition/model/model_parts.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/heap.h"
#include "base/memory.h"

#define NONE VG_MODEL_NONE

/* Bytes of a void's front per cells^(2/3): an octant of m target edges per side
 * has 9 m^3 cells and 6 m^2 * 4 / sqrt(3) triangles of 24 bytes each, half a
 * point and three indices. */
#define FRONT_BYTES 77.0 /* M5 */
/* Outcome of a task that leaves no front. */
#define SMALL_BYTES 1024.0

enum event_kind { EVENT_COMPUTED, EVENT_ENDED };

struct event {
  double time;
  uint32_t task;
  enum event_kind kind;
};

/* Heap of ready tasks by their position in the order of priority. */
struct ready {
  size_t n, cap;
  uint32_t *place;
};

/* An idle worker is in two lists, of all and of its rank, the longest idle
 * first. The list heads have the indices n_worker + rank, and n_worker + ranks
 * for all. */
struct links {
  uint32_t *prev, *next;
};

struct sim {
  const struct vg_machine *machine;
  struct vg_model_graph g;
  uint32_t n_worker;
  uint32_t *order, *place;     /* [n] Tasks by priority, and the inverse. */
  uint32_t *left;              /* [n_group] Members that have not ended. */
  double *chain, *group_chain; /* Longest chain up to the end of a task or
                                  group. */
  double *in, *out;            /* [n] Bytes to and from a rank. */
  uint32_t *worker;            /* [n] Executing worker. */
  struct ready ready;          /* Tasks for any rank. */
  struct ready *joins;         /* [ranks] Joins that wait for their rank. */
  struct vg_assignment assignment;
  uint32_t *home; /* [n] Rank that created it, later its home. */
  struct links all, own;
  uint32_t *n_idle;             /* [ranks] */
  uint32_t *n_looping;          /* [ranks] Running tasks with loops. */
  uint32_t n_started, *started; /* [n_started] Tasks assigned at this
                                   moment. */
  struct vg_spans *helps;       /* Trace of helpers; may be NULL. */
  struct event *event;          /* Heap by time, kind, task. */
  size_t n_event;
  uint32_t n_ended;
  double *sent, *received; /* [ranks] Time until which a rank's link is busy. */
  double *busy;            /* [n_worker] */
  /* [n_touched] Ranks that may hand out joins, each once. */
  uint32_t n_touched, *touched;
  unsigned char *is_touched; /* [ranks] */
  double now, bytes, cuts_wall;
};

double vg_model_priority(char kind, double estimate)
{
  static const char kinds[] = { VG_SPAN_REPAIR, VG_SPAN_LEAF, VG_SPAN_TILE,
                                VG_SPAN_PENCIL, VG_SPAN_JOIN };
  const double most = 1e12;
  double class = 0;

  for (size_t i = 0; i < sizeof kinds; i++)
    if (kinds[i] == kind) class = (double)(i + 1);
  if (!(estimate > 0)) estimate = 0;
  return class * 2 * most + (estimate < most ? estimate : most);
}

/* --- bytes --------------------------------------------------------------- */

static int is_cut(char kind)
{
  return kind == VG_SPAN_PENCIL || kind == VG_SPAN_TILE || kind == VG_SPAN_JOIN;
}

static double front_of(const struct vg_span *s)
{
  const double most = 1e15;
  double n = (double)s->n_cell, root;

  if (n < s->estimate) n = s->estimate;
  root = cbrt(n < most ? n : most);
  return root * root;
}

static void find_bytes(struct sim *s)
{
  double in[256] = { 0 }, out[256] = { 0 }, front[256] = { 0 };

  for (uint32_t i = 0; i < s->g.n; i++) {
    const struct vg_span *one = &s->g.span[i];
    unsigned char kind = (unsigned char)one->kind;

    if (!one->bytes_in && !one->bytes_out) continue;
    in[kind] += (double)one->bytes_in;
    out[kind] += (double)one->bytes_out;
    front[kind] += front_of(one);
  }
  for (uint32_t i = 0; i < s->g.n; i++) {
    const struct vg_span *one = &s->g.span[i];
    unsigned char kind = (unsigned char)one->kind;
    double size = front_of(one);

    s->in[i] = (double)one->bytes_in;
    s->out[i] = (double)one->bytes_out;
    if (one->bytes_in || one->bytes_out) continue;
    s->in[i] = size * (front[kind] > 0 ? in[kind] / front[kind] : FRONT_BYTES);
    if (front[kind] > 0) s->out[i] = size * out[kind] / front[kind];
    else s->out[i] = is_cut(one->kind) ? size * FRONT_BYTES : SMALL_BYTES;
    if (s->g.moves[i]) s->out[i] = 0;
  }
}

/* --- heaps and lists ----------------------------------------------------- */

static int is_lower(const uint32_t *a, const uint32_t *b)
{
  return *a < *b;
}

VG_HEAP_DEFINE(place, uint32_t, is_lower)

static vg_status ready_push(struct ready *r, uint32_t place,
                            struct vg_error *err)
{
  if (vg_reserve(&r->place, &r->cap, r->n + 1, sizeof *r->place))
    return vg_fail_memory(err, "the simulation");
  place_push(r->place, &r->n, place);
  return VG_OK;
}

static uint32_t ready_pop(struct sim *s, struct ready *r)
{
  return s->order[place_pop(r->place, &r->n)];
}

static int is_before(const struct event *a, const struct event *b)
{
  if (a->time != b->time) return a->time < b->time;
  if (a->kind != b->kind) return a->kind < b->kind;
  return a->task < b->task;
}

VG_HEAP_DEFINE(event, struct event, is_before)

static void add_event(struct sim *s, double time, enum event_kind kind,
                      uint32_t task)
{
  event_push(s->event, &s->n_event, (struct event){ time, task, kind });
}

static void link_last(struct links *l, uint32_t head, uint32_t item)
{
  l->prev[item] = l->prev[head];
  l->next[item] = head;
  l->next[l->prev[head]] = item;
  l->prev[head] = item;
}

static void unlink_item(struct links *l, uint32_t item)
{
  l->next[l->prev[item]] = l->next[item];
  l->prev[l->next[item]] = l->prev[item];
}

static uint32_t rank_of(const struct sim *s, uint32_t worker)
{
  return worker / (uint32_t)s->machine->threads;
}

static void touch(struct sim *s, uint32_t rank)
{
  if (s->is_touched[rank]) return;
  s->is_touched[rank] = 1;
  s->touched[s->n_touched++] = rank;
}

static void set_idle(struct sim *s, uint32_t worker)
{
  uint32_t ranks = (uint32_t)s->machine->ranks, rank = rank_of(s, worker);

  link_last(&s->all, s->n_worker + ranks, worker);
  link_last(&s->own, s->n_worker + rank, worker);
  s->assignment.is_idle[worker] = 1;
  s->n_idle[rank]++;
  touch(s, rank);
}

/* An idle worker of a rank, or NONE. */
static uint32_t idle_of(const struct sim *s, uint32_t rank)
{
  uint32_t first = s->own.next[s->n_worker + rank];

  return first < s->n_worker ? first : NONE;
}

static uint32_t idle_any(const struct sim *s)
{
  uint32_t head = s->n_worker + (uint32_t)s->machine->ranks;
  uint32_t first = s->all.next[head];

  return first < s->n_worker ? first : NONE;
}

/* --- events -------------------------------------------------------------- */

/* Arrival time of bytes sent now. Both links are occupied. */
static double send(struct sim *s, uint32_t from, uint32_t to, double bytes)
{
  const struct vg_machine *m = s->machine;
  uint32_t node = (uint32_t)m->ranks_per_node;
  double start = s->now, took = bytes / m->bandwidth;

  if (s->sent[from] > start) start = s->sent[from];
  if (s->received[to] > start) start = s->received[to];
  s->sent[from] = s->received[to] = start + took;
  s->bytes += bytes;
  return start + took + (from / node == to / node ? 0 : m->latency);
}

static void hand_out(struct sim *s, uint32_t task, uint32_t worker)
{
  struct vg_span *span = &s->g.span[task];
  uint32_t rank = rank_of(s, worker), home = s->home[task];

  unlink_item(&s->all, worker);
  unlink_item(&s->own, worker);
  s->assignment.is_idle[worker] = 0;
  s->n_idle[rank]--;
  s->n_looping[rank] += span->loops > 0;
  s->worker[task] = worker;
  span->rank = (int32_t)rank;
  span->thread = (int32_t)(worker % (uint32_t)s->machine->threads);
  span->home = (int32_t)home;
  span->start = rank == home ? s->now : send(s, home, rank, s->in[task]);
  span->cpu /= s->machine->rate;
  span->loops /= s->machine->rate;
  if (s->g.moves[task]) s->home[task] = rank;
  s->started[s->n_started++] = task;
}

/* Speedup of loops with the given number of helpers. */
static double sped_up(const struct sim *s, double helpers)
{
  return fmin(1 + helpers, s->machine->loop_threads);
}

/* Distributes `helped` seconds of a task's loops evenly among idle workers. */
static vg_status add_help(struct sim *s, const struct vg_span *task,
                          double helped, double helpers, struct vg_error *err)
{
  uint32_t n = (uint32_t)ceil(helpers), left = n;
  uint32_t head = s->n_worker + (uint32_t)task->rank;
  vg_status st = VG_OK;

  for (uint32_t w = s->own.next[head]; left && w != head && !st;
       w = s->own.next[w], left--) {
    struct vg_help h;

    s->busy[w] += helped / n;
    if (!s->helps) continue;
    memset(&h, 0, sizeof h);
    memcpy(h.path, task->path, sizeof h.path);
    h.rank = task->rank;
    h.thread = (int32_t)(w % (uint32_t)s->machine->threads);
    h.start = task->start;
    h.end = task->start + helped / n;
    st = vg_spans_add_help(s->helps, &h, err);
  }
  return st;
}

/* Sets the durations of the tasks that start, now that the idle workers are
 * known. */
static vg_status set_durations(struct sim *s, struct vg_error *err)
{
  vg_status st = VG_OK;

  for (uint32_t i = 0; i < s->n_started && !st; i++) {
    struct vg_span *span = &s->g.span[s->started[i]];
    uint32_t rank = (uint32_t)span->rank;
    double took = span->cpu, k;

    if (span->loops > 0 && s->n_idle[rank]) {
      k = sped_up(s, (double)s->n_idle[rank] / s->n_looping[rank]);
      took -= span->loops - span->loops / k;
      st = add_help(s, span, span->cpu - took, k - 1, err);
    }
    span->end = span->start + took;
    s->busy[s->worker[s->started[i]]] += took;
    add_event(s, span->end, EVENT_COMPUTED, s->started[i]);
  }
  s->n_started = 0;
  return st;
}

static vg_status make_ready(struct sim *s, uint32_t task, struct vg_error *err)
{
  const struct vg_span *span = &s->g.span[task];
  uint32_t after = s->g.after[task], *home = &s->home[task];

  *home = after != NONE ? s->home[after]
                        : (uint32_t)span->home % (uint32_t)s->machine->ranks;
  if (s->machine->cyclic && span->kind == VG_SPAN_LEAF && span->work > 0) {
    s->assignment.held[s->assignment.n_held++] = task;
    return VG_OK;
  }
  if (span->kind != VG_SPAN_JOIN || s->g.moves[task] || s->machine->joins_roam)
    return ready_push(&s->ready, s->place[task], err);
  touch(s, *home);
  return ready_push(&s->joins[*home], s->place[task], err);
}

static void hand_out_joins(struct sim *s, uint32_t rank)
{
  while (s->joins[rank].n && idle_of(s, rank) != NONE)
    hand_out(s, ready_pop(s, &s->joins[rank]), idle_of(s, rank));
}

static void start_assigned(struct sim *s)
{
  struct vg_assignment *d = &s->assignment;

  for (uint32_t i = 0; i < d->n_woken; i++) {
    uint32_t w = d->woken[i], task = d->first[w];

    if (!d->is_idle[w] || task == NONE) continue;
    d->first[w] = d->next[task];
    hand_out(s, task, w);
  }
  d->n_woken = 0;
}

/* Joins come first, since no kind has a higher priority. Other tasks go to a
 * worker of their home rank if one is idle. */
static vg_status hand_out_all(struct sim *s, struct vg_error *err)
{
  while (s->n_touched) {
    uint32_t rank = s->touched[--s->n_touched];

    s->is_touched[rank] = 0;
    hand_out_joins(s, rank);
  }
  while (s->ready.n && idle_any(s) != NONE) {
    uint32_t task = ready_pop(s, &s->ready);
    uint32_t worker = idle_of(s, s->home[task]);

    hand_out(s, task, worker != NONE ? worker : idle_any(s));
  }
  start_assigned(s);
  return set_durations(s, err);
}

/* Minimum time of a task, with all the help that its rank can give. */
static double least_time(const struct sim *s, const struct vg_span *span)
{
  double k = sped_up(s, s->machine->threads - 1);

  return (span->cpu - span->loops + span->loops / k) / s->machine->rate;
}

static vg_status end_task(struct sim *s, uint32_t task, struct vg_error *err)
{
  struct vg_model_graph *g = &s->g;
  vg_status st = VG_OK;

  s->n_ended++;
  for (uint32_t i = g->in_first[task]; i < g->in_first[task + 1]; i++) {
    uint32_t group = g->in[i];

    if (s->group_chain[group] < s->chain[task])
      s->group_chain[group] = s->chain[task];
    if (--s->left[group]) continue;
    for (uint32_t j = g->dep_first[group]; j < g->dep_first[group + 1]; j++) {
      uint32_t next = g->dep[j];

      s->chain[next] = s->group_chain[group] + least_time(s, &g->span[next]);
      VG_TRY(make_ready(s, next, err));
    }
  }
done:
  return st;
}

static void computed(struct sim *s, uint32_t task)
{
  const struct vg_span *span = &s->g.span[task];
  uint32_t rank = (uint32_t)span->rank, home = s->home[task];

  set_idle(s, s->worker[task]);
  s->assignment.woken[s->assignment.n_woken++] = s->worker[task];
  s->n_looping[rank] -= span->loops > 0;
  if (is_cut(span->kind) && s->cuts_wall < span->end) s->cuts_wall = span->end;
  if (rank == home) add_event(s, s->now, EVENT_ENDED, task);
  else add_event(s, send(s, rank, home, s->out[task]), EVENT_ENDED, task);
}

/* --- a run --------------------------------------------------------------- */

static void sim_release(struct sim *s)
{
  vg_model_graph_release(&s->g);
  free(s->order);
  free(s->place);
  free(s->left);
  free(s->chain);
  free(s->group_chain);
  free(s->in);
  free(s->out);
  free(s->worker);
  free(s->ready.place);
  vg_assignment_release(&s->assignment);
  free(s->home);
  for (int r = 0; s->joins && r < s->machine->ranks; r++)
    free(s->joins[r].place);
  free(s->joins);
  free(s->all.prev);
  free(s->all.next);
  free(s->own.prev);
  free(s->own.next);
  free(s->n_idle);
  free(s->n_looping);
  free(s->started);
  free(s->event);
  free(s->sent);
  free(s->received);
  free(s->busy);
  free(s->touched);
  free(s->is_touched);
}

static vg_status sim_allocate(struct sim *s, struct vg_error *err)
{
  size_t n = s->g.n, ranks = (size_t)s->machine->ranks;
  size_t n_link = s->n_worker + ranks + 1;

  s->order = vg_alloc(n, sizeof *s->order);
  s->place = vg_alloc(n, sizeof *s->place);
  s->left = vg_alloc(s->g.n_group, sizeof *s->left);
  s->chain = vg_calloc(n, sizeof *s->chain);
  s->group_chain = vg_calloc(s->g.n_group, sizeof *s->group_chain);
  s->in = vg_alloc(n, sizeof *s->in);
  s->out = vg_alloc(n, sizeof *s->out);
  s->worker = vg_alloc(n, sizeof *s->worker);
  s->home = vg_alloc(n, sizeof *s->home);
  s->joins = vg_calloc(ranks, sizeof *s->joins);
  s->all.prev = vg_alloc(n_link, sizeof *s->all.prev);
  s->all.next = vg_alloc(n_link, sizeof *s->all.next);
  s->own.prev = vg_alloc(n_link, sizeof *s->own.prev);
  s->own.next = vg_alloc(n_link, sizeof *s->own.next);
  s->n_idle = vg_calloc(ranks, sizeof *s->n_idle);
  s->n_looping = vg_calloc(ranks, sizeof *s->n_looping);
  s->started = vg_alloc(n, sizeof *s->started);
  s->event = vg_alloc(n, sizeof *s->event);
  s->sent = vg_calloc(ranks, sizeof *s->sent);
  s->received = vg_calloc(ranks, sizeof *s->received);
  s->busy = vg_calloc(s->n_worker, sizeof *s->busy);
  s->touched = vg_alloc(ranks, sizeof *s->touched);
  s->is_touched = vg_calloc(ranks, sizeof *s->is_touched);
  if (!s->order || !s->place || !s->left || !s->chain || !s->group_chain ||
      !s->in || !s->out || !s->worker || !s->home || !s->joins ||
      !s->all.prev || !s->all.next || !s->own.prev || !s->own.next ||
      !s->n_idle || !s->n_looping || !s->started || !s->event || !s->sent ||
      !s->received || !s->busy || !s->touched || !s->is_touched)
    return vg_fail_memory(err, "the simulation");
  return vg_assignment_new(&s->assignment, s->g.n, s->n_worker, err);
}

struct ranked {
  double priority;
  uint32_t task;
};

static int by_priority(const void *a, const void *b)
{
  const struct ranked *s = a, *t = b;

  if (s->priority != t->priority) return s->priority > t->priority ? -1 : 1;
  return (s->task > t->task) - (s->task < t->task);
}

/* Tasks are sorted by path first, so that paths break ties between equal
 * priorities. */
static vg_status sort_tasks(struct sim *s, struct vg_error *err)
{
  struct ranked *list = vg_alloc(s->g.n, sizeof *list);

  if (!list) return vg_fail_memory(err, "the simulation");
  for (uint32_t i = 0; i < s->g.n; i++) {
    const struct vg_span *one = &s->g.span[i];

    list[i].priority = vg_model_priority(one->kind, one->estimate);
    list[i].task = i;
  }
  qsort(list, s->g.n, sizeof *list, by_priority);
  for (uint32_t i = 0; i < s->g.n; i++) {
    s->order[i] = list[i].task;
    s->place[list[i].task] = i;
  }
  free(list);
  return VG_OK;
}

static void set_lists(struct sim *s)
{
  uint32_t ranks = (uint32_t)s->machine->ranks;

  for (uint32_t i = s->n_worker; i <= s->n_worker + ranks; i++)
    s->all.prev[i] = s->all.next[i] = s->own.prev[i] = s->own.next[i] = i;
  for (uint32_t w = 0; w < s->n_worker; w++) set_idle(s, w);
}

static vg_status simulate(struct sim *s, struct vg_error *err)
{
  vg_status st = VG_OK;

  memcpy(s->left, s->g.size, s->g.n_group * sizeof *s->left);
  set_lists(s);
  for (uint32_t i = 0; i < s->g.n; i++) {
    if (s->g.wait[i] != NONE) continue;
    s->chain[i] = least_time(s, &s->g.span[i]);
    VG_TRY(make_ready(s, i, err));
  }
  VG_TRY(hand_out_all(s, err));
  for (;;) {
    if (!s->n_event && s->assignment.n_held) {
      VG_TRY(vg_assignment_make(&s->assignment, s->g.span, err));
      VG_TRY(hand_out_all(s, err));
    }
    if (!s->n_event) break;
    s->now = s->event[0].time;
    while (s->n_event && s->event[0].time == s->now) {
      struct event e = event_pop(s->event, &s->n_event);

      if (e.kind == EVENT_ENDED) VG_TRY(end_task(s, e.task, err));
      else computed(s, e.task);
    }
    VG_TRY(hand_out_all(s, err));
  }
  for (uint32_t i = 0; i < s->g.n && s->n_ended < s->g.n; i++)
    if (s->left[i])
      return vg_fail(err, VG_ERR_INPUT,
                     "task '%s' of the trace waits for "
                     "tasks that wait for it",
                     s->g.span[i].path);
done:
  return st;
}

/* s of one traced core outside the tasks. */
static double once(const struct vg_machine *m)
{
  return m->serial + m->by_node + m->by_all;
}

double vg_model_outside(const struct vg_machine *m)
{
  double all = (double)m->ranks * m->threads, node = all;

  if (m->ranks > m->ranks_per_node)
    node = (double)m->ranks_per_node * m->threads;
  return (m->serial + m->by_node / node + m->by_all / all) / m->rate;
}

static vg_status check_machine(const struct vg_machine *m, struct vg_error *err)
{
  if (m->ranks < 1 || m->threads < 1 ||
      m->threads > VG_MODEL_WORKERS_MAX / m->ranks)
    return vg_fail(err, VG_ERR_INPUT,
                   "a machine of %d ranks with %d threads "
                   "each cannot be simulated: it must have 1 to %d workers",
                   m->ranks, m->threads, VG_MODEL_WORKERS_MAX);
  if (m->ranks_per_node < 1)
    return vg_fail(err, VG_ERR_INPUT,
                   "%d ranks per node: at least 1 is required",
                   m->ranks_per_node);
  if (m->loop_threads < 1)
    return vg_fail(err, VG_ERR_INPUT,
                   "loops in %d threads: at least 1 is required",
                   m->loop_threads);
  if (!(m->latency >= 0) || !(m->bandwidth > 0) || !(m->rate > 0) ||
      !(m->serial >= 0) || !(m->by_node >= 0) || !(m->by_all >= 0) ||
      isinf(m->latency) || isinf(once(m)))
    return vg_fail(err, VG_ERR_INPUT,
                   "latency %g s, bandwidth %g bytes/s, "
                   "rate %g and serial time %g s do not describe a machine: "
                   "bandwidth and rate must be positive, the other values "
                   "must not be negative",
                   m->latency, m->bandwidth, m->rate, once(m));
  return VG_OK;
}

/* Time of cuts beyond the time of leaves for the same number of cells. */
static double extra_of_cuts(const struct sim *s, double cuts)
{
  double leaves = 0, n_leaf = 0, n_zone = 0;

  for (uint32_t i = 0; i < s->g.n; i++) {
    const struct vg_span *one = &s->g.span[i];

    if (is_cut(one->kind)) n_zone += (double)one->n_cell;
    if (one->kind != VG_SPAN_LEAF || !one->n_cell) continue;
    leaves += one->cpu;
    n_leaf += (double)one->n_cell;
  }
  return n_leaf > 0 ? cuts - n_zone * leaves / n_leaf : cuts;
}

static struct vg_model_result judge(const struct sim *s)
{
  double outside = vg_model_outside(s->machine), sum = 0, most = 0;
  double cuts = 0, workers = s->n_worker, longest = 0;
  struct vg_model_result f = { .imbalance = 1 };

  for (uint32_t i = 0; i < s->g.n; i++) {
    sum += s->g.span[i].cpu;
    if (is_cut(s->g.span[i].kind)) cuts += s->g.span[i].cpu;
    if (s->chain[i] > longest) longest = s->chain[i];
  }
  for (uint32_t w = 0; w < s->n_worker; w++)
    if (s->busy[w] > most) most = s->busy[w];
  f.wall = s->now + outside;
  f.work = sum + once(s->machine) / s->machine->rate;
  f.speedup = f.wall > 0 ? f.work / f.wall : 1;
  f.efficiency = f.speedup / workers;
  f.critical = longest + outside;
  f.cuts_wall = s->cuts_wall;
  f.bytes = s->bytes;
  if (sum > 0) {
    f.cuts = cuts / sum;
    f.cuts_extra = extra_of_cuts(s, cuts) / sum;
    f.imbalance = most * workers / sum;
    f.idle = 1 - sum / (s->now * workers);
    if (f.idle < 0) f.idle = 0; /* from rounding */
  }
  return f;
}

/* Bytes actually sent: none for a task executed at home. */
static void hand_over(struct sim *s, struct vg_spans *timeline)
{
  for (uint32_t i = 0; i < s->g.n; i++) {
    struct vg_span *one = &s->g.span[i];
    const double most = 1e18;
    int away = one->rank != one->home;

    one->bytes_in = away ? (uint64_t)fmin(s->in[i] + 0.5, most) : 0;
    one->bytes_out = away ? (uint64_t)fmin(s->out[i] + 0.5, most) : 0;
  }
  *timeline = *s->helps;
  timeline->n = timeline->cap = s->g.n;
  timeline->span = s->g.span;
  timeline->n_rank = s->machine->ranks;
  timeline->n_thread = s->machine->threads;
  timeline->wall = s->now;
  s->g.span = NULL;
}

vg_status vg_model_replay(const struct vg_spans *spans,
                          const struct vg_machine *machine,
                          struct vg_model_result *out,
                          struct vg_spans *timeline, struct vg_error *err)
{
  struct vg_spans helps = VG_SPANS_INIT;
  struct sim s = { .machine = machine, .helps = timeline ? &helps : NULL };
  vg_status st;

  assert(spans && machine && out);
  VG_TRY(check_machine(machine, err));
  s.n_worker = (uint32_t)(machine->ranks * machine->threads);
  VG_TRY(vg_model_graph_new(spans, &s.g, err));
  if (machine->cyclic) VG_TRY(vg_assignment_check(&s.g, err));
  VG_TRY(sim_allocate(&s, err));
  VG_TRY(sort_tasks(&s, err));
  find_bytes(&s);
  VG_TRY(simulate(&s, err));
  *out = judge(&s);
  if (timeline) {
    hand_over(&s, timeline);
    vg_spans_sort(timeline);
    memset(&helps, 0, sizeof helps);
  }
done:
  vg_spans_release(&helps);
  sim_release(&s);
  return st;
}
