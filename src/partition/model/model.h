/* partition/model/model.h: the same tasks on another machine. Uses spans.h.
 *
 * Discrete-event simulation of engine.h's rules: tasks become ready when the
 * tasks that they wait for have ended, idle workers take the one with the
 * highest priority, a task done away from home costs two messages. Inputs are
 * the spans of a real run, or ones made up from an estimate alone.
 *
 * What a task waits for. A record tells only which task's end made it, of
 * several that were waited for the last one in that run; on another machine
 * another one would be last. So, by the kind of `after`:
 * - J: this task alone.
 * - P, T: the stage that it belongs to: all tasks of kind P and T of the same
 *   node (the path up to the first letter) made by the same task.
 * - R: in the same way all tasks of kind R.
 * - L: this task alone; but for a task of kind R whose node is the leaf's or
 *   above it, all leaves at or below that node.
 *
 * A task is made on the home of the task that made it; the first ones keep
 * their own, modulo the number of ranks. Leaves, and joins that start a node
 * (made by a task of another node, or by none), move: they are done by any
 * rank, which is their home from then on, and nothing goes back. Other joins
 * are done at home. The rest is done by any rank and returns.
 *
 * On a cyclic machine leaves wait until nothing else is left and are dealt out
 * to the workers in turn, most `work` first, as the engine does when it is told
 * to: each does its own.
 *
 * Loops inside a task (engine.h) are helped with by workers of its rank that
 * are idle: the task takes cpu - loops + loops / k, where k is 1 and the
 * workers that are idle when it starts, once all that is ready has been handed
 * out, over the tasks with loops that the rank does at that time; at most
 * loop_threads. It stays so: these tasks, joins, are short against those that
 * workers come from and go to. Who helps still takes a task that becomes
 * ready, as in the engine. */
#ifndef VG_PARTITION_MODEL_MODEL_H
#define VG_PARTITION_MODEL_MODEL_H

#include <stddef.h>
#include <stdint.h>

#include "partition/engine/spans.h"

/** Most workers that are simulated. */
#define VG_MODEL_WORKERS_MAX (1 << 20)

struct vg_machine {
  int ranks, threads; /* threads per rank */
  int ranks_per_node; /* messages within a node are free of latency */
  double latency;     /* s per message; default 2e-6 */
  double bandwidth;   /* bytes/s of a rank's link, each way; 1e10.
                         Messages of a rank wait for each other */
  double rate;        /* speed of a core over the recorded one; 1 */
  double serial;      /* s of the recorded core, before the first and
                         after the last task, done once */
  double by_node;     /* the same, shared by the workers of a node
                         (check, sizes, layers) */
  double by_all;      /* the same, shared by all (judge, files) */
  int joins_roam;     /* 1: all joins are done by any rank */
  int cyclic;         /* 1: leaves are dealt out beforehand */
  int loop_threads;   /* most that a loop is sped up by more workers:
                         they share the rank's memory; 16 */
};
#define VG_MACHINE_INIT                                                        \
  {                                                                            \
    .ranks = 1, .threads = 1, .ranks_per_node = 1, .latency = 2e-6,            \
    .bandwidth = 1e10, .rate = 1, .loop_threads = 16                           \
  }

struct vg_model_result {
  double wall;                /* s, what is outside the tasks included */
  double work;                /* s of all that on one worker */
  double speedup, efficiency; /* work / wall; over workers */
  double critical;            /* s, longest chain of tasks, loops with all the
                                 help they may have, and what is outside */
  double cuts;                /* share of the busy time spent on P, T and J */
  double cuts_extra;          /* share of it that their final cells would
                                 not have cost in leaves: what cutting costs */
  double cuts_wall;           /* s, from the first task's start until the last
                                 of P, T and J has ended */
  double idle;                /* share of the workers' time */
  double imbalance;           /* max / mean of busy time per worker */
  double bytes;               /* sent between ranks */
};

/** Which task made which is in span.after; span.cpu is its duration without
 * help, span.loops how much of that help can share.
 *
 * Sizes of messages are the recorded ones. A task that was done at home has
 * none: what it would have sent follows from its cells, as bytes per
 * cells^(2/3) of the tasks of its kind that did travel, or of a void of equal
 * cells in all.
 * @param timeline  out: where each span ran on the machine, by path; help, as
 *                  if helpers had come at the start; may be NULL
 * VG_ERR_INPUT when the record contradicts itself (names the path), for a
 * machine that cannot be, or a cyclic one where leaves have no `work`.
 * Deterministic. O(n log n). */
vg_status vg_model_replay(const struct vg_spans *spans,
                          const struct vg_machine *machine,
                          struct vg_model_result *out,
                          struct vg_spans *timeline, struct vg_error *err);

/** Seconds that the machine takes outside the tasks. */
double vg_model_outside(const struct vg_machine *machine);

/** The priority of a task as the advancing partition gives it (advance.h):
 * cuts before fills (J, P, T, L, R, then others), heavier first. */
double vg_model_priority(char kind, double estimate);

#endif
