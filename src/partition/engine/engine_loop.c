/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Parallel loops inside a task. While a loop is open, idle workers of the rank
 * take chunks of it. The worker that opened it also takes chunks, so the loop
 * ends with or without help. Tasks take precedence over loops, but a helper
 * stays until no chunk is left, since its work is useful either way. */
#include <assert.h>
#include <string.h>

#include "base/clock.h"
#include "partition/engine/engine_parts.h"

struct vg_loop {
  size_t n, grain, n_chunk;
  vg_loop_body body;
  void *context;
  atomic_size_t next; /* Next chunk. */
  /* guarded by the engine's lock: */
  const char *path;      /* Path of the task that opened the loop. */
  size_t free_slots;     /* Helpers that may still join. */
  int n_helper;          /* Helpers at work. */
  double helped;         /* Processor time in s of helpers that have left. */
  pthread_cond_t left;   /* Signalled when the last helper leaves. */
  struct vg_loop *other; /* Next open loop. */
};

/* The worker of a thread, since the caller of a loop does not pass it. */
static _Thread_local struct vg_worker *self;

void vg_loop_enter(struct vg_worker *w)
{
  self = w;
}

/* Returns the number of chunks done. */
static size_t do_chunks(struct vg_loop *l, int worker)
{
  size_t c, count = 0;

  for (; (c = atomic_fetch_add(&l->next, 1)) < l->n_chunk; count++) {
    size_t first = c * l->grain, left = l->n - first;

    l->body(l->context, first, first + (left < l->grain ? left : l->grain),
            worker);
  }
  return count;
}

/* Each helper that joins wakes two more. All are awake after a few steps, and
 * the caller need not wake each of them. */
static void call_helpers(struct vg_engine *e, const struct vg_loop *l)
{
  for (size_t i = 0; i < 2 && i < l->free_slots && i < e->n_idle; i++)
    pthread_cond_signal(&e->work);
}

static void open_loop(struct vg_engine *e, struct vg_loop *l)
{
  pthread_cond_init(&l->left, NULL);
  vg_engine_lock(e);
  l->free_slots = l->n_chunk - 1;
  l->other = e->loops;
  e->loops = l;
  call_helpers(e, l);
  vg_engine_unlock(e);
}

static void close_loop(struct vg_engine *e, struct vg_loop *l)
{
  struct vg_loop **at = &e->loops;

  vg_engine_lock(e);
  while (*at != l) at = &(*at)->other;
  *at = l->other;
  while (l->n_helper) pthread_cond_wait(&l->left, &e->lock);
  vg_engine_unlock(e);
  pthread_cond_destroy(&l->left);
}

static void record(struct vg_worker *w, struct vg_help *h)
{
  struct vg_engine *e = w->e;
  struct vg_error err = VG_ERROR_INIT;

  h->rank = e->rank;
  h->thread = w->number;
  h->start -= e->begin;
  h->end -= e->begin;
  if (vg_spans_add_help(&e->spans, h, &err))
    vg_notify_fail(e, err.code, h->path, &err);
}

int vg_loop_help(struct vg_worker *w)
{
  struct vg_engine *e = w->e;
  struct vg_loop *l = e->loops;
  struct vg_help h;
  double cpu;
  size_t n;

  while (l && (!l->free_slots || atomic_load(&l->next) >= l->n_chunk))
    l = l->other;
  if (!l) return 0;
  memset(&h, 0, sizeof h);
  memcpy(h.path, l->path, sizeof h.path);
  l->free_slots--;
  l->n_helper++;
  call_helpers(e, l);
  vg_engine_unlock(e);
  w->in_loop = 1;
  h.start = vg_clock();
  cpu = vg_clock_thread();
  n = do_chunks(l, w->number);
  cpu = vg_clock_thread() - cpu;
  h.end = vg_clock();
  w->in_loop = 0;
  vg_engine_lock(e);
  l->helped += cpu;
  if (!--l->n_helper) pthread_cond_signal(&l->left);
  if (n) record(w, &h);
  return 1;
}

/* A nested loop runs in its own thread alone: other threads have chunks of the
 * outer loop to do, and its time is part of the outer loop's time. */
void vg_engine_loop(const struct vg_engine *e, size_t n, size_t grain,
                    vg_loop_body body, void *context)
{
  assert(body || !n);

  struct vg_worker *w = e && self && self->e == e ? self : NULL;
  struct vg_loop l = {
    .n = n, .grain = grain ? grain : 1, .body = body, .context = context
  };
  double cpu;
  int shared;

  if (!n) return;
  l.n_chunk = (n - 1) / l.grain + 1;
  if (!w || w->in_loop || l.n_chunk == 1) {
    do_chunks(&l, w ? w->number : 0);
    return;
  }
  l.path = w->doing;
  shared = e->threads > 1;
  w->in_loop = 1;
  if (shared) open_loop(w->e, &l);
  cpu = vg_clock_thread();
  do_chunks(&l, w->number);
  cpu = vg_clock_thread() - cpu;
  if (shared) close_loop(w->e, &l);
  w->in_loop = 0;
  w->helped += l.helped;
  w->loops += l.helped + cpu;
}
