/* partition/engine/engine.h: tasks over ranks and threads. Uses base only.
 *
 * A task is made on a rank, its home, and done by some worker thread of some
 * rank; its outcome returns home, where it may make further tasks. There are
 * no levels and no barriers: whoever is idle takes the task at hand with the
 * highest priority. No rank only manages: a thread of rank 0 that sleeps
 * nearly always keeps the schedule, and each rank has one that serves messages.
 * For comparison tasks can be dealt out beforehand instead (cyclic below).
 *
 * Which worker does what depends on timing. So what a task computes must
 * follow from its input alone, and what it makes be named by its path. */
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
  char path[VG_PATH_MAX]; /* unique; decides between equal priorities */
  char kind;              /* VG_SPAN_...; for records, and 'A'..'Z' */
  int pinned;             /* 1: to be done by its home rank */
  int moves;              /* 1: wherever it is done becomes its home: its
                             outcome stays there, and `done` is called
                             there */
  double priority;        /* higher first */
  double weight;          /* expected work, in cells, for progress */
  double work;            /* > 0: what it is dealt out by, where tasks are;
                             0: never dealt out */
  void *input;            /* owned by the engine once submitted; may be
                             NULL, and is in `done` */
};

/* What a task did. */
struct vg_done {
  size_t n_cell;    /* cells made */
  size_t n_face;    /* faces of the front that it was given */
  double elsewhere; /* s of processor time in processes that it had
                       work for it meanwhile */
};

struct vg_engine; /* one per rank while vg_engine_run runs */

/** What tasks are. All but `done` may run in several threads at once. */
struct vg_engine_ops {
  /** Do the task. Allowed to keep results on this rank (in user).
   * outcome out: what its home needs to know, for `done` (may be left NULL).
   * worker: 0 .. threads - 1, names scratch space.
   * VG_ERR_STOPPED: abandoned because vg_engine_stopping(e). The task counts as
   * not done, and the job stops if it was not stopping yet.
   * done in: zeros; out: what was done, for progress and records. */
  vg_status (*run)(void *user, const struct vg_engine *e,
                   const struct vg_task *task, int worker, void **outcome,
                   struct vg_done *done, struct vg_error *err);
  /** On the task's home rank: take the outcome over (always frees it), and
   * submit what follows. One call at a time per rank, in a thread of the
   * engine that need not be a worker; keep it short. Called for every task
   * that was done, also after a stop or a failure. rank: which rank ran it. */
  vg_status (*done)(void *user, struct vg_engine *e, const struct vg_task *task,
                    void *outcome, int rank, struct vg_error *err);
  /** For the way to another rank and back: never called in a job of one rank,
   * nor for what is NULL. unpack makes what release_input / done frees. */
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
  int threads;      /* workers on this rank, at least 1 */
  uint64_t shuffle; /* 0: by priority; else: in an order drawn from
                       this number, to show that order is no matter */
  int cyclic;       /* 1: tasks with a `work` wait until no other one
                       is left, and are dealt out to all workers in
                       turn, most work first: a worker does those it
                       was dealt, and none of others */
  /** Called on rank 0 now and then: cells done and known so far, tasks done
   * and known. May be NULL. */
  void (*progress)(void *user, double done, double known, size_t n_done,
                   size_t n_known);
  void *user;          /* of progress */
  struct vg_stop stop; /* asked on every rank; stops all ranks after the
                          tasks under way */
};

/** Run until no task is left anywhere. Collective.
 *
 * @param first  tasks that this rank submits at the start: [n_first]
 * @param spans  out: what this rank's workers did when (all of the job's on
 *               rank 0), by path, also after a stop; owned by the caller:
 *               vg_spans_release; may be NULL
 * Returns on all ranks VG_OK; VG_ERR_STOPPED; or the first failure,
 * on other ranks too, with its message ("rank 3: ..."). Tasks that were not
 * done are released. A rank that dies ends the job through the launcher. */
vg_status vg_engine_run(struct vg_comm *comm,
                        const struct vg_engine_options *options,
                        const struct vg_engine_ops *ops, void *user,
                        size_t n_first, const struct vg_task *first,
                        struct vg_spans *spans, struct vg_error *err);

/** Hand a task over; it is copied, its input taken over, released on failure.
 * For `done` only. VG_ERR_INPUT: no path, or a priority or weight that is no
 * number. */
vg_status vg_engine_submit(struct vg_engine *e, const struct vg_task *task,
                           struct vg_error *err);

/** 1 when the job is being stopped (by a failure, too): for a long `run` to
 * ask now and then. Threads: safe. */
int vg_engine_stopping(const struct vg_engine *e);

/** The same question for those who take a vg_stop. e NULL: never. */
struct vg_stop vg_engine_stop(const struct vg_engine *e);

/** As vg_parallel_for, in the calling worker and in those of this rank that
 * have nothing else to do: for `run`.
 *
 * worker < the rank's threads; bodies that run at the same time have different
 * ones, also those of loops in other tasks, and in the calling thread it is
 * that of `run`. Runs to its end also when the job is being stopped. A loop of
 * one chunk costs nothing; others some microseconds, and as much again until
 * help is there: chunks should be tens of microseconds and more. In a body a
 * further loop is done by its thread alone.
 * e: NULL: in the calling thread alone, worker 0. */
void vg_engine_loop(const struct vg_engine *e, size_t n, size_t grain,
                    vg_loop_body body, void *context);

#endif
