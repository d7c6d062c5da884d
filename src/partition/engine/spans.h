/* partition/engine/spans.h: what was done when, by whom: the record of a run,
 * for its report, for pictures, and to be replayed on other machines (model.h).
 * */
#ifndef VG_PARTITION_ENGINE_SPANS_H
#define VG_PARTITION_ENGINE_SPANS_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

enum { VG_PATH_MAX = 64 };

/* Kinds of task. */
enum {
  VG_SPAN_PENCIL = 'P', /* cells along a line */
  VG_SPAN_TILE = 'T',   /* a zone between pencils, or a whole zone */
  VG_SPAN_LEAF = 'L',   /* what is left, filled */
  VG_SPAN_JOIN = 'J',   /* outcomes of one stage put into a void, its
                           components found, the next stage planned */
  VG_SPAN_REPAIR = 'R'  /* cells at interfaces improved */
};

struct vg_span {
  char path[VG_PATH_MAX];  /* task; "0.2P3": see advance.h */
  char after[VG_PATH_MAX]; /* the task whose end made it; "" at the start */
  char kind;
  char unused[3];       /* 0: spans are sent as bytes */
  int32_t rank, thread; /* who did it */
  int32_t home;         /* where it was made */
  double start, end;    /* seconds since the engine began, wall */
  double cpu;           /* seconds of processor time, helpers' and other
                           processes' too */
  double loops;         /* of these, in loops that idle threads of the
                           rank help with (vg_engine_loop) */
  double estimate;      /* cells expected */
  double work;          /* what it is dealt out by (vg_task); 0: never */
  uint64_t n_cell;      /* cells made; 0 where they were forgotten */
  uint64_t n_face;      /* faces of the front that it was given */
  uint64_t bytes_in, bytes_out; /* what a remote rank receives and returns;
                                   0 where it was done at home */
};

/* A worker in loops of another one's task. */
struct vg_help {
  char path[VG_PATH_MAX]; /* task */
  int32_t rank, thread;   /* who helped */
  double start, end;      /* as in a span */
};

struct vg_spans {
  size_t n, cap;
  struct vg_span *span; /* [n] by path */
  size_t n_help, cap_help;
  struct vg_help *help; /* [n_help] by path, worker and start */
  int32_t n_rank, n_thread;
  double wall; /* seconds the engine ran */
};
#define VG_SPANS_INIT                                                          \
  {                                                                            \
    .n = 0                                                                     \
  }

void vg_spans_release(struct vg_spans *s);

/** Append a span. VG_ERR_MEMORY. */
vg_status vg_spans_add(struct vg_spans *s, const struct vg_span *span,
                       struct vg_error *err);

vg_status vg_spans_add_help(struct vg_spans *s, const struct vg_help *help,
                            struct vg_error *err);

/** What the same workers did afterwards: its times begin where *s ends. */
vg_status vg_spans_append(struct vg_spans *s, const struct vg_spans *more,
                          struct vg_error *err);

/** By path, then kind: the order of every list of tasks. */
void vg_spans_sort(struct vg_spans *s);

/** Share of the workers' time spent on tasks, their own or in help; max over
 * mean of the workers' busy time. */
double vg_spans_busy(const struct vg_spans *s);
double vg_spans_imbalance(const struct vg_spans *s);

/** Seconds of all tasks in loops. */
double vg_spans_loops(const struct vg_spans *s);

#endif
