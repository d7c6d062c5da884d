/* partition/model.h: the same tasks on another machine. Uses spans.h.
 *
 * Discrete-event simulation of engine.h's rules: tasks become ready when the
 * tasks that made them have ended, idle workers take the one with the highest
 * priority, a task done away from home costs two messages. Inputs are the
 * spans of a real run, or ones made up from an estimate alone. */
#ifndef VG_PARTITION_MODEL_H
#define VG_PARTITION_MODEL_H

#include <stddef.h>
#include <stdint.h>

#include "partition/spans.h"

struct vg_machine {
  int ranks, threads;        /* threads per rank */
  int ranks_per_node;        /* messages within a node are free of latency */
  double latency;            /* s per message; default 2e-6 */
  double bandwidth;          /* bytes/s of a rank's link; default 1e10 */
  double rate;               /* speed of a core over the recorded one; 1 */
  double serial;             /* s before the first and after the last task,
                                done once (reading, sizes, layers, files) */
};
#define VG_MACHINE_INIT { 1, 1, 1, 2e-6, 1e10, 1, 0 }

struct vg_forecast {
  double wall;               /* s, serial part included */
  double work;               /* s of all tasks on one worker, serial included */
  double speedup, efficiency;/* work / wall; over workers */
  double critical;           /* s, longest chain of tasks, serial included */
  double cuts;               /* share of the busy time spent on P, T and J */
  double cuts_wall;          /* s until the last of P, T and J has ended */
  double idle;               /* share of the workers' time */
  double imbalance;          /* max / mean of busy time per worker */
};

/** Which task made which is in span.after; span.cpu is its duration.
 * @param timeline  out: where each span ran on the machine; may be NULL
 * VG_ERR_INPUT when the record contradicts itself (names the path).
 * Deterministic. O(n log n). */
vg_status vg_model_replay(const struct vg_spans *spans,
                          const struct vg_machine *machine,
                          struct vg_forecast *out, struct vg_spans *timeline,
                          struct vg_error *err);

/** The priority of a task as the advancing partition gives it (advance.h):
 * cuts before fills, heavier first. */
double vg_model_priority(char kind, double estimate);

#endif
