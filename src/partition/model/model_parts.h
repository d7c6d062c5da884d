/* partition/model/model_parts.h: the graph of waiting, and what a cyclic
 * schedule deals out; for model*.c only. */
#ifndef VG_PARTITION_MODEL_MODEL_PARTS_H
#define VG_PARTITION_MODEL_MODEL_PARTS_H

#include "partition/model/model.h"

#define VG_MODEL_NONE UINT32_MAX

/* A task waits for at most one group of tasks; the first n groups are the
 * tasks one by one. */
struct vg_model_graph {
  uint32_t n, n_group;
  struct vg_span *span;      /* [n] by path; a copy */
  uint32_t *after;           /* [n] task, or NONE */
  uint32_t *wait;            /* [n] group, or NONE */
  unsigned char *moves;      /* [n] 1: done anywhere, and its home is there */
  uint32_t *in_first, *in;   /* [n + 1], groups that a task is in */
  uint32_t *dep_first, *dep; /* [n_group + 1], tasks that wait for a group */
  uint32_t *size;            /* [n_group] members */
};

void vg_model_graph_release(struct vg_model_graph *g);

/* Leaves of a cyclic machine, and whose they are. */
struct vg_dealt {
  uint32_t n_worker;
  uint32_t n_held, *held;   /* [n_held] tasks to be dealt out */
  uint32_t *first, *last;   /* [n_worker] of each, or NONE */
  uint32_t *next;           /* [n] of the same worker, or NONE */
  uint32_t n_woken, *woken; /* [n_woken] workers that became idle since some
                               were handed out */
  unsigned char *is_idle;   /* [n_worker] */
};

/** For n tasks. */
vg_status vg_dealt_new(struct vg_dealt *d, uint32_t n, uint32_t n_worker,
                       struct vg_error *err);
void vg_dealt_release(struct vg_dealt *d);

/** All that is held to the workers in turn, most work first. */
vg_status vg_dealt_out(struct vg_dealt *d, const struct vg_span *span,
                       struct vg_error *err);

/** VG_ERR_INPUT where no leaf of the record has a `work`. */
vg_status vg_dealt_check(const struct vg_model_graph *g, struct vg_error *err);

/** VG_ERR_INPUT names the path of what contradicts itself. */
vg_status vg_model_graph_new(const struct vg_spans *spans,
                             struct vg_model_graph *out, struct vg_error *err);

#endif
