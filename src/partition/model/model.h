/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* partition/model/model.h: replay of the same tasks on another machine. Uses
 * spans.h.
 *
 * Discrete-event simulation of the rules of engine.h: tasks become ready when
 * the tasks that they wait for have ended, idle workers take the ready task
 * with the highest priority, and a task executed away from home costs two
 * messages. The input is the trace of a real run or a forecast from an
 * estimate.
 *
 * Dependencies. A trace records only the task whose end created a task, which
 * is the last one of those it waited for in that run. On another machine
 * another one may be last. The rule therefore depends on the kind of `after`:
 * - J: this task alone.
 * - P, T: the whole stage: all tasks of kind P and T of the same node (the
 *   path up to the first letter) created by the same task.
 * - R: in the same way all tasks of kind R.
 * - L: this task alone; but a task of kind R whose node is the leaf's node or
 *   an ancestor waits for all leaves at or below that node.
 *
 * A task is created on the home rank of the task that created it; the first
 * tasks keep their own, modulo the number of ranks. Leaves, and joins that
 * start a node (created by a task of another node, or by none), move: any rank
 * may execute them and becomes their home, and nothing is sent back. Other
 * joins are executed at home. All other tasks are executed by any rank, and
 * their outcome returns.
 *
 * On a cyclic machine, leaves wait until nothing else is left. They are then
 * assigned to the workers in turn, most `work` first, as in the engine with a
 * cyclic schedule, and each worker executes only its own.
 *
 * Idle workers of a rank help with the loops inside its tasks (engine.h). A
 * task takes cpu - loops + loops / k. Here k is 1 plus the ratio of the rank's
 * idle workers to its tasks with loops, when the task starts and after all
 * ready tasks have been assigned; k is at most loop_threads. It stays
 * constant, because these tasks (joins) are short compared with those that
 * workers come from and go to. A helper still takes a task that becomes ready,
 * as in the engine. */
#ifndef VG_PARTITION_MODEL_MODEL_H
#define VG_PARTITION_MODEL_MODEL_H

#include <stddef.h>
#include <stdint.h>

#include "partition/engine/spans.h"

/** Maximum number of simulated workers. */
#define VG_MODEL_WORKERS_MAX (1 << 20)

struct vg_machine {
  int ranks, threads; /* threads: per rank */
  int ranks_per_node; /* Messages within a node have no latency. */
  double latency;     /* s per message; default 2e-6. */
  double bandwidth;   /* bytes/s of a rank's link in each direction; default
                         1e10. Messages of a rank are sequential. */
  double rate;      /* Speed of a core relative to the traced one; default 1. */
  double serial;    /* s of the traced core before the first and after the
                       last task, done once. */
  double by_node;   /* The same, shared by the workers of a node (check,
                       sizes, layers). */
  double by_all;    /* The same, shared by all workers (mesh check, files). */
  int joins_roam;   /* 1: any rank may execute any join. */
  int cyclic;       /* 1: leaves are assigned statically. */
  int loop_threads; /* Maximum speedup of a loop by more workers, since
                       they share the rank's memory; default 16. */
};
#define VG_MACHINE_INIT                                                        \
  {                                                                            \
    .ranks = 1, .threads = 1, .ranks_per_node = 1, .latency = 2e-6,            \
    .bandwidth = 1e10, .rate = 1, .loop_threads = 16                           \
  }

struct vg_model_result {
  double wall;                /* s, including the time outside the tasks. */
  double work;                /* s of all this on one worker. */
  double speedup, efficiency; /* work / wall; divided by the workers. */
  /* s of the longest chain of tasks, with maximum help in loops, including
   * the time outside the tasks. */
  double critical;
  double cuts; /* Share of the busy time spent on P, T and J. */
  /* Share of the busy time that cutting costs: time of P, T and J beyond
   * the cost of their cells in leaves. */
  double cuts_extra;
  double cuts_wall; /* s from the start of the first task to the
                       end of the last P, T or J. */
  double idle;      /* Idle share of the workers' time. */
  double imbalance; /* Maximum over mean busy time per worker. */
  double bytes;     /* Bytes sent between ranks. */
};

/** Replays a trace. span.after names the task that created a task; span.cpu is
 * its duration without help, span.loops the part of it that helpers can share.
 *
 * Message sizes are the traced ones. A task that was executed at home has
 * none: its size is derived from its cells, as bytes per cells^(2/3) of the
 * tasks of its kind that were sent, or else of a void with the same number of
 * cells.
 * @param timeline  out: when and where each span ran on the machine, by path;
 *   helpers count as present from the start; may be NULL
 * VG_ERR_INPUT if the trace contradicts itself (the message names the path),
 * for invalid machine parameters, or for a cyclic machine if leaves have no
 * `work`.
 * Deterministic. O(n log n). */
vg_status vg_model_replay(const struct vg_spans *spans,
                          const struct vg_machine *machine,
                          struct vg_model_result *out,
                          struct vg_spans *timeline, struct vg_error *err);

/** Seconds that the machine spends outside the tasks. */
double vg_model_outside(const struct vg_machine *machine);

/** Priority of a task in the advancing partition (advance.h): cuts before fills
 * (J, P, T, L, R, then others), larger estimates first. */
double vg_model_priority(char kind, double estimate);

#endif
