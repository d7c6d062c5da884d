/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* partition/engine/spans.h: the trace of a run: which worker did what and
 * when. It serves the report and plots, and can be replayed on other machines
 * (model.h). */
#ifndef VG_PARTITION_ENGINE_SPANS_H
#define VG_PARTITION_ENGINE_SPANS_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

/* Voids with longer paths than VG_PATH_CUT characters are not cut, so that
 * there is room for the suffixes of their parts and tasks: paths are unique. */
enum { VG_PATH_MAX = 96, VG_PATH_CUT = 55 };

/* Kinds of task. */
enum {
  VG_SPAN_PENCIL = 'P', /* edge separator: cells along a line */
  VG_SPAN_TILE = 'T',   /* face separator between pencils, or a whole
                           separator zone */
  VG_SPAN_LEAF = 'L',   /* filling of a leaf */
  /* front update: inserts the outcomes of one stage into the front of a
   * void, finds its components and plans the next stage */
  VG_SPAN_JOIN = 'J',
  VG_SPAN_REPAIR = 'R' /* improvement of cells at interfaces */
};

struct vg_span {
  char path[VG_PATH_MAX];  /* Path of the task; "0.2P3": see advance.h. */
  char after[VG_PATH_MAX]; /* Task whose end created this one; "" at the
                              start. */
  char kind;
  char unused[3];       /* 0, since spans are sent as bytes. */
  int32_t rank, thread; /* Executing rank and worker. */
  int32_t home;         /* Home rank. */
  double start, end;    /* Wall time in s since the engine started. */
  double cpu; /* Processor time in s, including helpers and child processes. */
  double loops;    /* The part of `cpu` in loops that idle threads of
                      the rank help with (vg_engine_loop). */
  double estimate; /* Expected cells. */
  double work;     /* Expected work for static assignment (vg_task); 0:
                      never assigned statically. */
  uint64_t n_cell; /* Cells created; 0 if they were dropped. */
  uint64_t n_face; /* Faces of the front that the task received. */
  uint64_t bytes_in, bytes_out; /* Bytes that a remote rank receives and
                                   returns; 0 if executed at home. */
};

/* Time that a worker spent in loops of another worker's task. */
struct vg_help {
  char path[VG_PATH_MAX]; /* Path of the helped task. */
  int32_t rank, thread;   /* The helping worker. */
  double start, end;      /* As in a span. */
};

struct vg_spans {
  size_t n, cap;
  struct vg_span *span; /* [n] Sorted by path. */
  size_t n_help, cap_help;
  struct vg_help *help; /* [n_help] Sorted by path, worker and start. */
  int32_t n_rank, n_thread;
  double wall; /* Wall time in s of the engine. */
};
#define VG_SPANS_INIT                                                          \
  {                                                                            \
    .n = 0                                                                     \
  }

void vg_spans_release(struct vg_spans *s);

/** Appends a span. VG_ERR_MEMORY. */
vg_status vg_spans_add(struct vg_spans *s, const struct vg_span *span,
                       struct vg_error *err);

vg_status vg_spans_add_help(struct vg_spans *s, const struct vg_help *help,
                            struct vg_error *err);

/** Appends a later trace of the same workers; its times are shifted to start
 * where *s ends. */
vg_status vg_spans_append(struct vg_spans *s, const struct vg_spans *more,
                          struct vg_error *err);

/** Sorts by path, then kind, the order of every list of tasks. */
void vg_spans_sort(struct vg_spans *s);

/** Share of the workers' time spent on tasks, including helping; maximum over
 * mean of the workers' busy time. */
double vg_spans_busy(const struct vg_spans *s);
double vg_spans_imbalance(const struct vg_spans *s);

/** Processor time in s of all tasks in loops. */
double vg_spans_loops(const struct vg_spans *s);

#endif
