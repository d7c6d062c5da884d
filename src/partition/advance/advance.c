/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "partition/advance/advance.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/memory.h"
#include "partition/advance/advance_tasks.h"
#include "partition/advance/coarse.h"
#include "partition/cut/node.h"
#include "partition/cut/select.h"
#include "partition/discrete/discrete.h"
#include "partition/repair/repair.h"

/* Shows tasks as long as all of them plan, grow zones or update fronts; then
 * cells. */
static void progress(void *user, double done_cells, double known, size_t n_done,
                     size_t n_known)
{
  struct vg_partition *p = user;
  double all = p->report.estimate;
  uint64_t n_leaf;

  (void)known;
  pthread_mutex_lock(&p->lock);
  n_leaf = p->report.n_leaf;
  pthread_mutex_unlock(&p->lock);
  if (done_cells > all) all = done_cells;
  if (!n_leaf && n_known > 1)
    vg_partition_tell(p, "cut and join", n_done, n_known);
  else vg_partition_tell(p, p->stage, (size_t)done_cells, (size_t)all);
}

/* Makes the root node: the whole void with its load. Rank 0 does this on the
 * cores of its node, since all other ranks wait for it. */
static vg_status make_root(struct vg_partition *p, struct vg_comm *comm,
                           struct vg_node **out, struct vg_error *err)
{
  const struct vg_mesh *m = &p->boundary;
  struct vg_front f = VG_FRONT_INIT;
  struct vg_node *n = NULL;
  vg_status st = VG_OK;

  f.n_point = m->n_point;
  f.n_face = m->n_tri;
  f.x = vg_alloc(m->n_point, sizeof *f.x);
  f.id = vg_alloc(m->n_point, sizeof *f.id);
  f.face = vg_alloc(m->n_tri, sizeof *f.face);
  if (f.x && f.id && f.face) n = vg_node_new("0", &f);
  if (!n) {
    vg_front_release(&f);
    return vg_fail_memory(err, "the front");
  }
  memcpy(n->front.x, m->point, m->n_point * sizeof *n->front.x);
  memcpy(n->front.face, m->tri, m->n_tri * sizeof *n->front.face);
  for (size_t k = 0; k < m->n_point; k++) n->front.id[k] = VG_POINT_ID(0, k);
  VG_TRY(vg_doubled_merge(&p->doubled, &n->front, err));
  n->levels = p->options.levels;
  n->per_cube = p->options.cells_per_cube;
  vg_comm_bind_node(comm, 1);
  st = vg_load_new(&n->front, p->sizing, n->per_cube,
                   p->options.threads * vg_comm_node_size(comm), &n->load, err);
  vg_comm_bind_node(comm, 0);
  VG_TRY(st);
  p->report.estimate = n->load.cells;
  n->to_part = p->options.maker != NULL;
  *out = n;
  n = NULL;
done:
  vg_node_free(n);
  return st;
}

static vg_status within_limit(const struct vg_partition *p, double cells,
                              const char *how, struct vg_error *err)
{
  double all = cells + (double)p->options.layer_cells;
  char layers[64] = "";

  if (!p->options.max_cells || all <= (double)p->options.max_cells)
    return VG_OK;
  if (p->options.layer_cells)
    snprintf(layers, sizeof layers, ", %llu of them in layers",
             (unsigned long long)p->options.layer_cells);
  return vg_fail(err, VG_ERR_UNSUPPORTED,
                 "the mesh %s %.0f cells%s; %llu are "
                 "allowed (max_cells); use a coarser spacing or raise the "
                 "limit",
                 how, all, layers, (unsigned long long)p->options.max_cells);
}

/* Runs the tasks that follow from these voids, which are taken over.
 * Collective. */
static vg_status run_tasks(struct vg_partition *p, struct vg_comm *comm,
                           size_t n, struct vg_node **node,
                           struct vg_spans *spans, struct vg_error *err)
{
  struct vg_engine_options o = { .threads = p->options.threads,
                                 .shuffle = p->options.shuffle,
                                 .cyclic = p->options.cyclic,
                                 .progress = progress,
                                 .stop = p->options.stop,
                                 .user = p };
  struct vg_task *first = vg_calloc(n, sizeof *first);
  vg_status st = first ? VG_OK : vg_fail_memory(err, "a task");

  for (size_t k = 0; k < n; k++) {
    if (st == VG_OK) st = vg_tasks_first(p, node[k], &first[k], err);
    else vg_node_free(node[k]);
    node[k] = NULL;
  }
  st = vg_comm_agree(comm, st, err);
  if (st == VG_OK) {
    st = vg_engine_run(comm, &o, &vg_tasks_ops, p, n, first, spans, err);
  } else {
    for (size_t k = 0; first && k < n; k++) vg_work_free(first[k].input);
  }
  free(first);
  return st;
}

/* Sets the leaf size from the number of subdomains, on all ranks. A void that
 * is not cut is filled whole, with its front in the input order. Collective. */
static vg_status cut_like_parts(struct vg_partition *p, struct vg_comm *comm,
                                struct vg_node *root, struct vg_error *err)
{
  struct vg_cut_rule *rule = &p->options.rule;
  double cells = p->report.estimate;
  vg_status st = vg_comm_max(comm, 1, &cells, err);

  if (st < 0) return st;
  rule->leaf_cells = vg_decomposition_leaf_cells(
    cells, p->options.decomposition.n_part, p->options.maker != NULL,
    rule->leaf_cells);
  if (root && (root->to_part || vg_node_wants_cut(p, root)))
    st = vg_select_sort(&root->front, err);
  return vg_comm_agree(comm, st, err);
}

static vg_status run_whole(struct vg_partition *p, struct vg_comm *comm,
                           struct vg_spans *spans, struct vg_error *err)
{
  struct vg_coarse_cells coarse = { .n_cell = 0 };
  struct vg_spans before = VG_SPANS_INIT;
  struct vg_node *root = NULL;
  vg_status st = VG_OK;

  if (p->rank == 0) st = make_root(p, comm, &root, err);
  /* no estimate is wrong by more than half */
  if (st == VG_OK && p->rank == 0)
    st = within_limit(p, p->report.estimate / 1.5, "would have about", err);
  st = vg_comm_agree(comm, st, err);
  if (st == VG_OK) st = cut_like_parts(p, comm, root, err);
  if (st == VG_OK && p->options.admit) {
    st = p->options.admit(p->options.admit_user, root ? &root->front : NULL,
                          root ? &root->load : NULL, &p->options.rule, err);
    st = vg_comm_agree(comm, st, err);
  }
  if (st == VG_OK && p->options.maker == vg_discrete_part) {
    st = vg_coarse_mesh(p, comm, root, &coarse, spans ? &before : NULL, err);
    if (root) p->options.decomposition.coarse = &coarse;
  }
  if (st == VG_OK) {
    st = run_tasks(p, comm, root != NULL, &root, spans, err);
    root = NULL;
  }
  if (st == VG_OK && before.n) st = vg_coarse_record(&before, spans, err);
  st = vg_comm_agree(comm, st, err);
  vg_spans_release(&before);
  vg_node_free(root);
  p->options.decomposition.coarse = NULL;
  vg_coarse_cells_release(&coarse);
  return st;
}

/* Leaves that could not be filled are merged with adjacent pieces and filled
 * again, until none is left. */
static vg_status run_again(struct vg_partition *p, struct vg_comm *comm,
                           struct vg_spans *spans, struct vg_error *err)
{
  struct vg_spans more = VG_SPANS_INIT;
  size_t n_void = 1;
  vg_status st = VG_OK;

  while (st == VG_OK && n_void) {
    double t0 = vg_clock();
    struct vg_node **node;
    size_t n;

    st = vg_partition_drop(p, comm, spans, err);
    if (st < 0) break;
    st = vg_recut_voids(p, comm, spans, &n_void, &node, &n, err);
    if (st == VG_OK && n_void) {
      p->stage = "recut";
      st = run_tasks(p, comm, n, node, spans ? &more : NULL, err);
      if (spans && st == VG_OK) st = vg_spans_append(spans, &more, err);
      st = vg_comm_agree(comm, st, err);
      p->report.widened += vg_clock() - t0;
    }
    for (size_t k = 0; k < n; k++) vg_node_free(node[k]);
    free(node);
    vg_spans_release(&more);
  }
  return st;
}

/* Memory of the pieces of this rank. */
static uint64_t bytes_of_pieces(const struct vg_partition *p)
{
  uint64_t sum = 0;

  for (size_t i = 0; i < p->n_piece; i++) sum += vg_piece_bytes(&p->piece[i]);
  return sum;
}

/* Combines counts and times of all ranks. */
static vg_status sum_report(struct vg_partition_report *r, struct vg_comm *comm,
                            struct vg_error *err)
{
  vg_status st = vg_entries_agree(&vg_fill_entries, &r->fill, comm, err);

  if (st == VG_OK) st = vg_entries_agree(&vg_partition_entries, r, comm, err);
  if (st == VG_OK)
    st = vg_entries_agree(&vg_decomposition_entries, &r->decomposition, comm,
                          err);
  return st;
}

vg_status vg_partition_grow(struct vg_comm *comm, const struct vg_mesh *front,
                            const struct vg_sizing *sizing,
                            const struct vg_partition_options *options,
                            struct vg_partition **out,
                            struct vg_partition_report *report,
                            struct vg_spans *spans, struct vg_error *err)
{
  struct vg_partition *p = vg_calloc(1, sizeof *p);
  double t0 = vg_clock();
  vg_status st;

  assert(front && sizing && options && out && report);
  st = vg_comm_agree(comm, p ? VG_OK : vg_fail_memory(err, "the partition"),
                     err);
  if (st < 0) {
    free(p);
    return st;
  }
  pthread_mutex_init(&p->lock, NULL);
  p->rank = vg_comm_rank(comm);
  p->size = vg_comm_size(comm);
  p->boundary = *front;
  p->sizing = sizing;
  p->options = *options;
  if (p->options.threads < 1) p->options.threads = 1;
  p->stage = "fill";
  st = vg_comm_agree(comm, vg_doubled_new(&p->doubled, &p->boundary, err), err);
  if (st == VG_OK) st = run_whole(p, comm, spans, err);
  if (st == VG_OK)
    vg_partition_tell(p, p->stage, (size_t)p->report.estimate,
                      (size_t)p->report.estimate);
  if (st == VG_OK) st = run_again(p, comm, spans, err);
  p->report.wall = vg_clock() - t0;
  if (st == VG_OK) st = vg_partition_repair(p, comm, spans, err);
  if (st == VG_OK)
    st = vg_comm_agree(comm, vg_stopped(&p->options.stop, err), err);
  if (st == VG_OK) vg_partition_tell(p, "numbering", p->n_piece, 0);
  if (st == VG_OK) st = vg_partition_number(p, comm, err);
  p->report.cell_bytes = (double)bytes_of_pieces(p);
  if (st == VG_OK) st = sum_report(&p->report, comm, err);
  p->report.number = vg_clock() - t0 - p->report.wall - p->report.repair;
  if (st == VG_OK)
    st = within_limit(p, (double)p->slices.n_cell[VG_SLICE_TET], "has", err);
  *report = p->report;
  if (st == VG_OK) *out = p;
  else vg_partition_free(p);
  return st;
}

void vg_partition_move_front(struct vg_partition *p)
{
  for (size_t i = 0; i < p->n_piece; i++) {
    struct vg_piece *q = &p->piece[i];

    for (size_t k = 0; k < q->n_in; k++)
      if (!(q->in[k] >> 32)) /* serial 0: the boundary */
        memcpy(q->x[k], p->boundary.point[(uint32_t)q->in[k]], sizeof *q->x);
  }
}

const struct vg_slices *vg_partition_slices(const struct vg_partition *p)
{
  return &p->slices;
}

vg_status vg_partition_leaves(const struct vg_partition *p, size_t *n,
                              uint64_t **sizes, struct vg_error *err)
{
  assert(p && n && sizes);
  *n = 0;
  *sizes = vg_alloc(p->n_piece, sizeof **sizes);
  if (!*sizes) return vg_fail_memory(err, "sizes of leaves");
  for (size_t k = 0; k < p->n_piece; k++)
    if (p->piece[k].kind == VG_SPAN_LEAF) (*sizes)[(*n)++] = p->piece[k].n_cell;
  return VG_OK;
}

void vg_partition_free(struct vg_partition *p)
{
  struct vg_node *n;

  if (!p) return;
  while ((n = p->cutting)) {
    p->cutting = n->next;
    vg_node_free(n);
  }
  for (size_t k = 0; k < p->n_piece; k++) vg_piece_release(&p->piece[k]);
  vg_recut_release(p);
  vg_doubled_release(&p->doubled);
  free(p->piece);
  free(p->drop);
  free(p->place);
  free(p->point_at);
  free(p->cell_at);
  free(p->domain);
  free(p->front_id);
  pthread_mutex_destroy(&p->lock);
  free(p);
}
