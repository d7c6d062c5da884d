/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* partition/engine/engine.h: task scheduler over ranks and threads. Uses base
 * only.
 *
 * A task is created on a rank, its home rank, and executed by a worker thread
 * of any rank. Its outcome returns to the home rank, where it may create
 * further tasks. There are no levels and no barriers: an idle worker takes the
 * available task with the highest priority. No rank is set aside for
 * management: one thread of rank 0, which sleeps nearly all the time, keeps
 * the schedule, and each rank has one thread that serves messages. For
 * comparison, tasks can be assigned statically instead (`cyclic` below).
 *
 * Which worker executes a task depends on timing. The result of a task must
 * therefore depend on its input alone, and everything it creates must be named
 * by the path of the task. */
#ifndef VG_PARTITION_ENGINE_ENGINE_H
#define VG_PARTITION_ENGINE_ENGINE_H

#include <stddef.h>
#include <stdint.h>

#include "base/comm.h"
#include "base/stop.h"
#include "base/parallel.h"
#include "base/status.h"
#include "partition/engine/spans.h"

struct vg_task {
  char path[VG_PATH_MAX]; /* Unique; breaks ties between equal priorities. */
  char kind;              /* VG_SPAN_... or 'A'..'Z', for traces. */
  int pinned;             /* 1: must be executed by its home rank. */
  int moves;              /* 1: the executing rank becomes the home rank: the
                             outcome stays there, and `done` is called there. */
  double priority;        /* Higher values first. */
  double weight;          /* Expected work in cells, for progress. */
  double work;            /* > 0: expected work by which a static assignment
                             sorts the tasks; 0: never assigned statically. */
  void *input;            /* Owned by the engine once submitted; may be NULL,
                             and is NULL in `done`. */
};

/* Statistics of an executed task. */
struct vg_done {
  size_t n_cell;        /* Cells created. */
  size_t n_face;        /* Faces of the front that the task received. */
  double other_seconds; /* Processor time in s of child processes that worked
                       for the task. */
};

struct vg_engine; /* One per rank during vg_engine_run. */

/** Operations on tasks. All except `done` may run in several threads at
 * once. */
struct vg_engine_ops {
  /** Executes the task. It may keep results on this rank (in user).
   * outcome out: the data that the home rank needs for `done`; may stay NULL.
   * worker: 0 .. threads - 1, selects scratch space.
   * VG_ERR_STOPPED: abandoned because vg_engine_stopping(e). The task counts
   * as not done, and the job stops if it was not stopping yet.
   * done in: zeros; out: statistics for progress and traces. */
  vg_status (*run)(void *user, const struct vg_engine *e,
                   const struct vg_task *task, int worker, void **outcome,
                   struct vg_done *done, struct vg_error *err);
  /** Called on the home rank: takes over the outcome (and always frees it), and
   * submits the tasks that follow from it. One call at a time per rank, in an
   * engine thread that need not be a worker; keep it short. Called for every
   * task that was done, also after a stop or a failure. rank: the executing
   * rank. */
  vg_status (*done)(void *user, struct vg_engine *e, const struct vg_task *task,
                    void *outcome, int rank, struct vg_error *err);
  /** Transfer to another rank and back. Never called in a job of one rank, nor
   * for NULL. The unpack functions create objects that release_input and
   * `done` free. */
  vg_status (*pack_input)(void *user, const void *input, struct vg_bytes *out,
                          struct vg_error *err);
  vg_status (*unpack_input)(void *user, const struct vg_bytes *in, void **input,
                            struct vg_error *err);
  vg_status (*pack_outcome)(void *user, const void *outcome,
                            struct vg_bytes *out, struct vg_error *err);
  vg_status (*unpack_outcome)(void *user, const struct vg_bytes *in,
                              void **outcome, struct vg_error *err);
  void (*release_input)(void *user, void *input);
  void (*release_outcome)(void *user, void *outcome);
};

struct vg_engine_options {
  int threads;      /* Worker threads on this rank, at least 1. */
  uint64_t shuffle; /* 0: by priority; otherwise in a random order seeded by
                       this number, to show that the order does not matter. */
  /* 1: tasks with `work` > 0 wait until no other task is left. They are
   * then assigned to all workers in turn, most work first, and each worker
   * executes only its own. */
  int cyclic;
  /** Called on rank 0 from time to time with the cells done and known so far,
   * and the tasks done and known. May be NULL. */
  void (*progress)(void *user, double done, double known, size_t n_done,
                   size_t n_known);
  void *user;          /* Passed to progress. */
  struct vg_stop stop; /* Polled on every rank; stops all ranks after the
                          running tasks. */
};

/** Runs until no task is left on any rank. Collective.
 *
 * @param first  initial tasks of this rank: [n_first]
 * @param spans  out: the trace of this rank's workers (of the whole job on
 *   rank 0), by path, also after a stop; owned by the caller:
 *   vg_spans_release; may be NULL
 * Returns on all ranks VG_OK, VG_ERR_STOPPED, or the first failure, which
 * other ranks report with its message ("rank 3: ..."). Tasks that were not
 * done are released. If a rank dies, the launcher ends the job. */
vg_status vg_engine_run(struct vg_comm *comm,
                        const struct vg_engine_options *options,
                        const struct vg_engine_ops *ops, void *user,
                        size_t n_first, const struct vg_task *first,
                        struct vg_spans *spans, struct vg_error *err);

/** Submits a task. The struct is copied. The input is taken over, and released
 * on failure. Only from `done`. VG_ERR_INPUT: the path is empty, or the
 * priority or weight is NaN. */
vg_status vg_engine_submit(struct vg_engine *e, const struct vg_task *task,
                           struct vg_error *err);

/** Returns 1 when the job is being stopped, also by a failure. A long `run`
 * should poll it. Threads: safe. */
int vg_engine_stopping(const struct vg_engine *e);

/** The same test as a vg_stop. e NULL: never stops. */
struct vg_stop vg_engine_stop(const struct vg_engine *e);

/** Parallel loop as vg_parallel_for, for use in `run`: in the calling worker
 * and in idle workers of this rank.
 *
 * worker < the rank's threads. Bodies that run at the same time have different
 * worker numbers, also across loops of different tasks. In the calling thread
 * it is the number passed to `run`. The loop runs to its end also when the job
 * is being stopped. A loop of one chunk costs nothing. Other loops cost a few
 * microseconds, and about the same again until helpers arrive, so chunks
 * should take tens of microseconds or more. A nested loop runs serially in the
 * thread of its body.
 * e NULL: in the calling thread alone, as worker 0. */
void vg_engine_loop(const struct vg_engine *e, size_t n, size_t grain,
                    vg_loop_body body, void *context);

#endif
