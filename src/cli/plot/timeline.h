/* cli/plot/timeline.h: a run's record as a file, STEM.timeline.json: facts of
 * the run and what each worker did when. It is what vanguard plan replays and
 * vanguard sweep draws. Uses partition/model/model.h.
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
 * "help": when workers were in loops of another one's task. "loops" of a span
 * is what of its "cpu" was in loops; both have the helpers' time in them.
 * Times are kept to the microsecond. Readers take columns in any order, pass
 * over those that they do not know and take as 0 a fact that is absent, and
 * "loops", "faces" and "work" in records of versions that had none. */
#ifndef VG_CLI_PLOT_TIMELINE_H
#define VG_CLI_PLOT_TIMELINE_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "partition/model/model.h"

/* Phases of a run in their order. VG_PHASE_ENGINE is cutting and filling. */
enum vg_phase {
  VG_PHASE_READ,
  VG_PHASE_CHECK,
  VG_PHASE_SIZES,
  VG_PHASE_LAYERS,
  VG_PHASE_ENGINE,
  VG_PHASE_NUMBER,
  VG_PHASE_JUDGE,
  VG_PHASE_WRITE,
  VG_PHASE_TOTAL,
  VG_PHASE_N
};

/** "read", "check", "sizes", "layers", "cut+fill", "number", "judge", "write",
 * "total". Static. */
const char *vg_phase_name(enum vg_phase phase);

/** Parts of a phase's seconds of one core that one thread of all does, and that
 * every node does for itself; the rest is shared by all (row M8). */
void vg_phase_shares(enum vg_phase phase, double *alone, double *by_node);

/** Most ranks, and threads of a rank, that a file may name. */
#define VG_TIMELINE_MAX (1 << 20)

struct vg_timeline {
  char title[128];
  double seconds[VG_PHASE_N]; /* [VG_PHASE_ENGINE] is spans.wall */
  uint64_t n_cell, n_point;   /* of the mesh */
  char digest[64];            /* of the files written; "" if not known */
  int cyclic;                 /* 1: leaves were dealt out beforehand */
  struct vg_spans spans;      /* ranks, threads and wall too */
};
#define VG_TIMELINE_INIT                                                       \
  {                                                                            \
    .title = ""                                                                \
  }

void vg_timeline_release(struct vg_timeline *t);

/** What a run does outside the engine, as serial, by_node and by_all of *m, in
 * seconds of one core. The ranks of the record are taken as those of one node,
 * and of each phase the same part is taken to be done by one thread
 * (docs/lab/performance-parallel.md, "Model"). */
void vg_timeline_outside(const struct vg_timeline *t, struct vg_machine *m);

/** Write; the engine's time is spans.wall. Spans in their order. */
vg_status vg_timeline_write(const char *path, const struct vg_timeline *t,
                            struct vg_error *err);

/** Read from memory; the entry for fuzzing. Spans come out by path, with
 * ranks and threads below n_rank and n_thread, and times that are finite, not
 * negative and not beyond 1e9 s, help too; whether they make a graph is left to
 * vg_model_replay.
 *
 * @param name  for messages, which all begin with it
 * @param out   untouched on failure; release it
 * VG_ERR_FORMAT. */
vg_status vg_timeline_parse(const char *name, const void *data, size_t size,
                            struct vg_timeline *out, struct vg_error *err);

/** As vg_timeline_parse, from a file. */
vg_status vg_timeline_read(const char *path, struct vg_timeline *out,
                           struct vg_error *err);

#endif
