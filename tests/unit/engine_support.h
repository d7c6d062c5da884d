/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* A tree of tasks for the tests of the engine. A node's children depend on its
 * path; its value depends on its path and on its children's values, in order.
 * The root's value therefore proves that every task ran once and its outcome
 * reached the right place, for any distribution and timing. */
#ifndef VG_TEST_ENGINE_SUPPORT_H
#define VG_TEST_ENGINE_SUPPORT_H

#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/memory.h"
#include "partition/engine/engine.h"

enum { ANY = -1 };

struct forest {
  int rank, size, threads;
  int depth;           /* nodes with longer paths are leaves */
  double spin;         /* s of work per task */
  size_t ballast;      /* additional bytes in each input */
  int pin;             /* every pin-th task (by its path) is pinned */
  int move;            /* every move-th task moves its home */
  int deal;            /* 1: two of three are assigned statically */
  int loop;            /* loop items in each task, no power of 2; 0: no loops */
  double spin_item;    /* s of work per item */
  const char *fail_at; /* path of a task whose run fails */
  const char *done_fails_at; /* path of a task whose done fails */
  const char *pack_fails_at;
  const char *stop_at; /* after this task has run, stop() returns 1 */
  atomic_int stop;
  atomic_int in_done; /* threads inside `done` */
  atomic_int bad;     /* violated rules */
  atomic_long alive;  /* inputs and outcomes on this rank */
  atomic_long n_run, n_done, n_moved;
  atomic_int busy[64];           /* by worker */
  atomic_int inside[64];         /* loop bodies in progress, by worker */
  atomic_long n_body, n_foreign; /* loop bodies, and those elsewhere */
  uint64_t sum;                  /* sum of all tasks' digests, in done */
  double last_done, last_known;
};

struct forest_input {
  uint64_t digest;
  size_t n;
  unsigned char data[];
};
struct forest_outcome {
  uint64_t digest;
  int n_child;
};

static inline uint64_t forest_mix(uint64_t h)
{
  h = (h ^ h >> 30) * 0xbf58476d1ce4e5b9u;
  h = (h ^ h >> 27) * 0x94d049bb133111ebu;
  return h ^ h >> 31;
}

static inline uint64_t forest_digest(const char *path)
{
  uint64_t h = 1;

  for (; *path; path++) h = forest_mix(h * 31 + (unsigned char)*path);
  return h;
}

static inline int forest_children(const struct forest *f, const char *path)
{
  size_t depth = strlen(path);

  if ((int)depth > f->depth) return 0;
  return depth < 3 ? 4 : (int)(forest_digest(path) % 9);
}

static inline void forest_spin(double seconds)
{
  struct timespec t0, t;

  if (seconds <= 0) return;
  clock_gettime(CLOCK_MONOTONIC, &t0);
  do clock_gettime(CLOCK_MONOTONIC, &t);
  while ((double)(t.tv_sec - t0.tv_sec) +
           1e-9 * (double)(t.tv_nsec - t0.tv_nsec) <
         seconds);
}

static inline struct vg_task forest_task(struct forest *f, const char *path)
{
  uint64_t digest = forest_digest(path);
  struct forest_input *in = vg_alloc(1, sizeof *in + f->ballast);
  struct vg_task t = { .kind = 'T', .weight = (double)(digest % 1000) };

  if (!in) abort();
  atomic_fetch_add(&f->alive, 1);
  in->digest = digest;
  in->n = f->ballast;
  memset(in->data, (int)(digest & 255), in->n);
  snprintf(t.path, sizeof t.path, "%s", path);
  t.pinned = f->pin && !(digest / 7 % (uint64_t)f->pin);
  t.moves = f->move && !(digest / 5 % (uint64_t)f->move);
  t.priority = (double)(digest % 1000);
  t.work = (double)(digest / 3 % 3);
  t.input = in;
  return t;
}

/* A loop counts its items. Each worker passes its own number; a loop inside a
 * loop body runs on that worker alone. */
struct forest_loop {
  struct forest *f;
  const struct vg_engine *e;
  int worker;    /* of the task */
  int count[64]; /* by item; not locked except by the loop itself */
};

static inline void forest_inner(void *context, size_t first, size_t end,
                                int worker)
{
  int *seen = context;

  for (size_t i = first; i < end; i++) seen[i] += 1 + worker;
}

static inline void forest_body(void *context, size_t first, size_t end,
                               int worker)
{
  struct forest_loop *l = context;
  struct forest *f = l->f;
  int seen[5] = { 0 };

  if (worker < 0 || worker >= f->threads) abort();
  if (atomic_fetch_add(&f->inside[worker], 1)) f->bad++;
  f->n_body++;
  if (worker != l->worker) f->n_foreign++;
  for (size_t i = first; i < end; i++) {
    l->count[i]++;
    forest_spin(f->spin_item);
  }
  vg_engine_loop(l->e, 5, 2, forest_inner, seen);
  for (int i = 0; i < 5; i++)
    if (seen[i] != 1 + worker) f->bad++;
  atomic_fetch_sub(&f->inside[worker], 1);
}

static inline void forest_loops(struct forest *f, const struct vg_engine *e,
                                int worker)
{
  for (size_t grain = 1; f->loop && grain <= (size_t)f->loop; grain *= 2) {
    struct forest_loop l = { .f = f, .e = e, .worker = worker };

    vg_engine_loop(e, (size_t)f->loop, grain, forest_body, &l);
    for (int i = 0; i < f->loop; i++)
      if (l.count[i] != 1) f->bad++;
  }
}

static inline vg_status forest_run(void *user, const struct vg_engine *e,
                                   const struct vg_task *task, int worker,
                                   void **outcome, struct vg_done *done,
                                   struct vg_error *err)
{
  struct forest *f = user;
  const struct forest_input *in = task->input;
  struct forest_outcome *out;

  if (worker < 0 || worker >= f->threads) abort();
  if (atomic_fetch_add(&f->busy[worker], 1)) f->bad++;
  if (in->digest != forest_digest(task->path)) f->bad++;
  for (size_t i = 0; i < in->n; i++)
    if (in->data[i] != (in->digest & 255)) f->bad++;
  forest_spin(f->spin);
  forest_loops(f, e, worker);
  atomic_fetch_sub(&f->busy[worker], 1);
  if (f->fail_at && !strcmp(task->path, f->fail_at))
    return vg_fail(err, VG_ERR_GEOMETRY, "task %s fails", task->path);
  if (f->stop_at && !strcmp(task->path, f->stop_at)) {
    atomic_store(&f->stop, 1);
    while (!vg_engine_stopping(e)) forest_spin(1e-4);
    forest_loops(f, e, worker);
    return VG_ERR_STOPPED;
  }
  out = vg_alloc(1, sizeof *out);
  if (!out) return vg_fail_memory(err, "an outcome");
  atomic_fetch_add(&f->alive, 1);
  atomic_fetch_add(&f->n_run, 1);
  out->digest = forest_mix(in->digest);
  out->n_child = forest_children(f, task->path);
  *outcome = out;
  done->n_cell = (size_t)task->weight;
  return VG_OK;
}

static inline vg_status forest_done(void *user, struct vg_engine *e,
                                    const struct vg_task *task, void *outcome,
                                    int rank, struct vg_error *err)
{
  struct forest *f = user;
  struct forest_outcome *out = outcome;
  vg_status st = VG_OK;
  int n_child = out->n_child;

  if (atomic_fetch_add(&f->in_done, 1) || task->input) f->bad++;
  if (out->digest != forest_mix(forest_digest(task->path))) f->bad++;
  if ((task->pinned || task->moves) && rank != f->rank) f->bad++;
  if (rank != f->rank) f->n_moved++;
  f->sum += out->digest;
  f->n_done++;
  free(out);
  atomic_fetch_sub(&f->alive, 1);
  for (int i = 0; i < n_child && !st; i++) {
    char path[VG_PATH_MAX];
    struct vg_task child;

    snprintf(path, sizeof path, "%.60s%c", task->path, '0' + i);
    child = forest_task(f, path);
    st = vg_engine_submit(e, &child, err);
  }
  if (f->done_fails_at && !strcmp(task->path, f->done_fails_at))
    st = vg_fail(err, VG_ERR_INPUT, "done of %s fails", task->path);
  atomic_fetch_sub(&f->in_done, 1);
  return st;
}

static inline vg_status forest_copy(const void *from, size_t n,
                                    struct vg_bytes *to, struct vg_error *err)
{
  to->data = vg_alloc(n, 1);
  if (!to->data) return vg_fail_memory(err, "bytes");
  memcpy(to->data, from, n);
  to->n = n;
  return VG_OK;
}

static inline vg_status forest_pack_input(void *user, const void *input,
                                          struct vg_bytes *out,
                                          struct vg_error *err)
{
  const struct forest *f = user;
  const struct forest_input *in = input;

  if (f->pack_fails_at && in->digest == forest_digest(f->pack_fails_at))
    return vg_fail(err, VG_ERR_MEMORY, "packing fails");
  return forest_copy(in, sizeof *in + in->n, out, err);
}

static inline vg_status forest_unpack(void *user, const struct vg_bytes *in,
                                      void **out, struct vg_error *err)
{
  struct forest *f = user;

  *out = vg_alloc(in->n, 1);
  if (!*out) return vg_fail_memory(err, "a copy");
  memcpy(*out, in->data, in->n);
  atomic_fetch_add(&f->alive, 1);
  return VG_OK;
}

static inline vg_status forest_pack_outcome(void *user, const void *outcome,
                                            struct vg_bytes *out,
                                            struct vg_error *err)
{
  (void)user;
  return forest_copy(outcome, sizeof(struct forest_outcome), out, err);
}

static inline void forest_release(void *user, void *what)
{
  struct forest *f = user;

  free(what);
  atomic_fetch_sub(&f->alive, 1);
}

static inline int forest_stop(void *user)
{
  return atomic_load(&((struct forest *)user)->stop);
}

static inline void forest_progress(void *user, double done, double known,
                                   size_t n_done, size_t n_known)
{
  struct forest *f = user;

  if (done < f->last_done || known < 0 || n_done > n_known) f->bad++;
  f->last_done = done;
  f->last_known = known;
}

/* Run `n_tree` trees, from ranks in turn: tree t begins at rank t % size. */
static inline vg_status forest_grow(struct forest *f, struct vg_comm *comm,
                                    int n_tree, uint64_t shuffle,
                                    struct vg_spans *spans,
                                    struct vg_error *err)
{
  static const struct vg_engine_ops ops = {
    forest_run,          forest_done,   forest_pack_input, forest_unpack,
    forest_pack_outcome, forest_unpack, forest_release,    forest_release
  };
  struct vg_engine_options options = { f->threads, shuffle,
                                       f->deal,    forest_progress,
                                       f,          { forest_stop, f } };
  struct vg_task first[64];
  size_t n = 0;

  f->rank = vg_comm_rank(comm);
  f->size = vg_comm_size(comm);
  for (int t = 0; t < n_tree && n < 64; t++) {
    char path[2] = { (char)('a' + t), 0 };

    if (t % f->size == f->rank) first[n++] = forest_task(f, path);
  }
  return vg_engine_run(comm, &options, &ops, f, n, first, spans, err);
}

/* The expected result of a run: number of tasks and sum of digests of a
 * tree. */
static inline void forest_expect(const struct forest *f, const char *path,
                                 long *n, uint64_t *sum)
{
  int n_child = forest_children(f, path);

  ++*n;
  *sum += forest_mix(forest_digest(path));
  for (int i = 0; i < n_child; i++) {
    char child[VG_PATH_MAX];

    snprintf(child, sizeof child, "%.60s%c", path, '0' + i);
    forest_expect(f, child, n, sum);
  }
}

#endif
