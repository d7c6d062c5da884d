/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* partition/model/model_parts.h: the dependency graph, and the assignment of a
 * cyclic schedule; for model*.c only. */
#ifndef VG_PARTITION_MODEL_MODEL_PARTS_H
#define VG_PARTITION_MODEL_MODEL_PARTS_H

#include "partition/model/model.h"

#define VG_MODEL_NONE UINT32_MAX

/* A task waits for at most one group of tasks; the first n groups are the
 * single tasks. */
struct vg_model_graph {
  uint32_t n, n_group;
  struct vg_span *span; /* [n] Copy of the spans, by path. */
  uint32_t *after;      /* [n] Task that created it, or NONE. */
  uint32_t *wait;       /* [n] Group it waits for, or NONE. */
  unsigned char *moves; /* [n] 1: executed anywhere, and its home is there. */
  uint32_t *in_first, *in;   /* [n + 1] Groups that a task is in. */
  uint32_t *dep_first, *dep; /* [n_group + 1] Tasks that wait for a group. */
  uint32_t *size;            /* [n_group] Number of members. */
};

void vg_model_graph_release(struct vg_model_graph *g);

/* The leaves of a cyclic machine and the workers they are assigned to. */
struct vg_assignment {
  uint32_t n_worker;
  uint32_t n_held, *held; /* [n_held] Tasks to be assigned. */
  uint32_t *first, *last; /* [n_worker] First and last task of each, or NONE. */
  uint32_t *next;         /* [n] Next task of the same worker, or NONE. */
  uint32_t n_woken, *woken; /* [n_woken] Workers that became idle since tasks
                               were last assigned. */
  unsigned char *is_idle;   /* [n_worker] */
};

/** Initialises d for n tasks. */
vg_status vg_assignment_new(struct vg_assignment *d, uint32_t n,
                            uint32_t n_worker, struct vg_error *err);
void vg_assignment_release(struct vg_assignment *d);

/** Assigns all held tasks to the workers in turn, most work first. */
vg_status vg_assignment_make(struct vg_assignment *d,
                             const struct vg_span *span, struct vg_error *err);

/** VG_ERR_INPUT if no leaf of the trace has `work`. */
vg_status vg_assignment_check(const struct vg_model_graph *g,
                              struct vg_error *err);

/** Builds the graph. VG_ERR_INPUT names the path of a contradiction. */
vg_status vg_model_graph_new(const struct vg_spans *spans,
                             struct vg_model_graph *out, struct vg_error *err);

#endif
