/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* cli/plot/timeline.h: the trace of a run as a file, STEM.timeline.json: facts
 * of the run and the tasks of each worker with their times. vanguard plan
 * replays it, and vanguard sweep plots it. Uses partition/model/model.h and
 * partition/model/phase.h.
 *
 *   {"vanguard_timeline": 1,
 *    "facts": {"title": "wing", "ranks": 2, "threads": 4, "cells": 123,
 *              "points": 45, "cyclic": 0, "digest": "", "seconds_read": 0.1,
 *              ...},
 *    "columns": ["path", "after", "kind", "rank", ...],
 *    "spans": [["0J1", "", "J", 0, ...], ...],
 *    "help_columns": ["path", "rank", "thread", "start", "end"],
 *    "help": [["0J1", 1, 2, 0.25, 0.375], ...]}
 *
 * "help": times in which workers helped in loops of another worker's task.
 * "loops" of a span is the portion of its "cpu" spent in loops; both include
 * the time of helpers. Times are rounded to microseconds. Readers accept
 * columns in any order and ignore unknown ones; absent facts are 0, and so are
 * "loops", "faces" and "work" in files of versions that did not have them. */
#ifndef VG_CLI_PLOT_TIMELINE_H
#define VG_CLI_PLOT_TIMELINE_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "partition/model/model.h"
#include "partition/model/phase.h"

/** Largest number of ranks, and of threads per rank, in a file. */
#define VG_TIMELINE_MAX (1 << 20)

struct vg_timeline {
  char title[128];
  double seconds[VG_PHASE_N]; /* [VG_PHASE_ENGINE] is spans.wall */
  uint64_t n_cell, n_point;   /* of the mesh */
  char digest[64];            /* of the files written; "" if unknown */
  int cyclic;                 /* 1: leaves were assigned in turn */
  struct vg_spans spans;      /* also contains ranks, threads and wall time */
};
#define VG_TIMELINE_INIT                                                       \
  {                                                                            \
    .title = ""                                                                \
  }

void vg_timeline_release(struct vg_timeline *t);

/** Set serial, by_node and by_all of *m to the times of the run outside the
 * engine, in seconds on one core. The ranks of the record are taken as those of
 * one node, and a fixed fraction of each phase as serial
 * (docs/lab/performance-parallel.md, "Model"). */
void vg_timeline_outside(const struct vg_timeline *t, struct vg_machine *m);

/** Write a timeline. The time of the engine is spans.wall. The order of the
 * spans is kept. */
vg_status vg_timeline_write(const char *path, const struct vg_timeline *t,
                            struct vg_error *err);

/** Parse a timeline in memory; entry point of the fuzzer. The spans are sorted
 * by path. Ranks and threads of spans and help are checked to be below n_rank
 * and n_thread, and times to be finite, not negative and at most 1e9 s; whether
 * the tasks form a graph is checked by vg_model_replay.
 *
 * @param name  file name for messages, which all begin with it
 * @param out   unchanged on failure; to be released by the caller
 * VG_ERR_FORMAT. */
vg_status vg_timeline_parse(const char *name, const void *data, size_t size,
                            struct vg_timeline *out, struct vg_error *err);

/** As vg_timeline_parse, but reads a file. */
vg_status vg_timeline_read(const char *path, struct vg_timeline *out,
                           struct vg_error *err);

#endif
