/* partition/model/model_parts.h: the graph of waiting, for model*.c only. */
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

/** VG_ERR_INPUT names the path of what contradicts itself. */
vg_status vg_model_graph_new(const struct vg_spans *spans,
                             struct vg_model_graph *out,
                             struct vg_error *err);

#endif
