/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Tasks of the advancing partition: their execution, the tasks that follow,
 * and their transfer to other ranks and back. */
#include "partition/advance/advance_tasks.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/bytes.h"
#include "base/memory.h"
#include "partition/model/model.h"

/* --- execution ----------------------------------------------------------- */

/* The outcome of a task for its home rank. */
struct outcome {
  int what;
  struct vg_node *node; /* START, and overloaded LEAF: owned; JOIN, ZONE:
                           borrowed, at home only. */
  uint64_t home_node; /* On other ranks, the number of the node at its home. */
  size_t index;
  struct vg_change change;
};

static void free_outcome(struct outcome *o)
{
  if (o->what == VG_WORK_START || o->what == VG_WORK_LEAF)
    vg_node_free(o->node);
  vg_change_release(&o->change);
  free(o);
}

/* A leaf that cannot be filled is set aside. */
static vg_status run_leaf(struct vg_partition *p, struct vg_work *w,
                          struct outcome *o, const struct vg_engine *e,
                          struct vg_error *err)
{
  int outgrown;
  vg_status st = vg_work_leaf(p, w, &outgrown, &o->change.made.n_cell, e, err);

  if (st == VG_ERR_GEOMETRY) {
    w->node->serial = w->serial;
    st = vg_recut_note_leaf(p, w->node, err, err);
    if (st == VG_OK) w->node = NULL;
    return st;
  }
  if (st == VG_OK && outgrown) {
    o->node = w->node;
    w->node = NULL;
  }
  return st;
}

static vg_status run_work(struct vg_partition *p, struct vg_work *w,
                          struct outcome *o, const struct vg_engine *e,
                          struct vg_error *err)
{
  o->what = w->what;
  if (w->what == VG_WORK_LEAF) return run_leaf(p, w, o, e, err);
  o->node = w->node;
  o->home_node = w->home_node;
  o->index = w->index;
  if (w->what == VG_WORK_ZONE) return vg_work_zone(p, w, &o->change, e, err);
  if (w->what == VG_WORK_JOIN) return vg_node_join(p, w->node, e, err);
  w->node = NULL;
  return vg_node_start(p, o->node, e, err);
}

/* Faces of the front that a task works on; its time depends on them and on its
 * cells. */
static size_t faces_of(const struct vg_work *w)
{
  return w->what == VG_WORK_ZONE ? w->part.n_face : w->node->front.n_face;
}

static vg_status run(void *user, const struct vg_engine *e,
                     const struct vg_task *task, int worker, void **outcome,
                     struct vg_done *done, struct vg_error *err)
{
  struct outcome *o = vg_calloc(1, sizeof *o);
  vg_status st;

  (void)worker;
  if (!o) return vg_fail_memory(err, "the outcome of a task");
  done->n_face = faces_of(task->input);
  st = run_work(user, task->input, o, e, err);
  done->n_cell = o->change.made.n_cell;
  if (o->what == VG_WORK_START) done->other_seconds = o->node->other_seconds;
  if (st == VG_OK) *outcome = o;
  else free_outcome(o);
  return st;
}

/* --- tasks that follow --------------------------------------------------- */

static double work_of(struct vg_node *leaf)
{
  if (!(leaf->fill_work > 0)) leaf->fill_work = vg_front_work(&leaf->front);
  return leaf->fill_work;
}

static vg_status submit(struct vg_engine *e, const char *path, char kind,
                        int pinned, int moves, double estimate,
                        struct vg_work *w, struct vg_error *err)
{
  struct vg_task t = { .kind = kind,
                       .pinned = pinned,
                       .moves = moves,
                       .priority = vg_model_priority(kind, estimate),
                       .weight = estimate,
                       .input = w };

  if (kind == VG_SPAN_LEAF) t.work = work_of(w->node);

  snprintf(t.path, sizeof t.path, "%s", path);
  return vg_engine_submit(e, &t, err);
}

static struct vg_work *new_work(int what, struct vg_node *n)
{
  struct vg_work *w = vg_calloc(1, sizeof *w);

  if (!w) return NULL;
  w->what = what;
  w->node = n;
  return w;
}

static vg_status submit_start(struct vg_engine *e, struct vg_node *n,
                              struct vg_error *err)
{
  struct vg_work *w = new_work(VG_WORK_START, n);
  char path[VG_PATH_MAX];

  if (!w) {
    vg_node_free(n);
    return vg_fail_memory(err, "a task");
  }
  snprintf(path, sizeof path, "%.*sJ0", VG_PATH_MAX - 3, n->path);
  return submit(e, path, VG_SPAN_JOIN, 0, 1, n->load.cells, w, err);
}

static vg_status submit_leaf(struct vg_partition *p, struct vg_engine *e,
                             struct vg_node *n, struct vg_error *err)
{
  struct vg_work *w = new_work(VG_WORK_LEAF, n);
  char path[VG_PATH_MAX];

  if (!w) {
    vg_node_free(n);
    return vg_fail_memory(err, "a task");
  }
  w->serial = n->serial ? n->serial : vg_partition_serial(p);
  snprintf(path, sizeof path, "%.*sL", VG_PATH_MAX - 2, n->path);
  return submit(e, path, VG_SPAN_LEAF, 0, 1, n->load.cells, w, err);
}

static vg_status submit_join(struct vg_engine *e, struct vg_node *n,
                             struct vg_error *err)
{
  struct vg_work *w = new_work(VG_WORK_JOIN, n);
  char path[VG_PATH_MAX];

  if (!w) return vg_fail_memory(err, "a task");
  snprintf(path, sizeof path, "%.*sJ%d", VG_PATH_MAX - 14, n->path,
           ++n->n_join);
  return submit(e, path, VG_SPAN_JOIN, 1, 0, n->load.cells, w, err);
}

static vg_status submit_child(struct vg_partition *p, struct vg_engine *e,
                              struct vg_node *c, struct vg_error *err)
{
  double leaf = p->options.rule.leaf_cells;

  if (vg_node_wants_cut(p, c)) return submit_start(e, c, err);
  pthread_mutex_lock(&p->lock);
  p->report.n_leaf++;
  /* subdomains of a decomposition have a serial and the requested size */
  p->report.n_uncut += leaf > 0 && !c->serial &&
                       c->load.cells > VG_OUTGROWN * leaf;
  pthread_mutex_unlock(&p->lock);
  return submit_leaf(p, e, c, err);
}

/* Registers a node; from its first stage to its last only this rank holds
 * it. */
static void hold(struct vg_partition *p, struct vg_node *n)
{
  pthread_mutex_lock(&p->lock);
  n->number = ++p->n_cutting;
  n->next = p->cutting;
  n->link = &p->cutting;
  if (n->next) n->next->link = &n->next;
  p->cutting = n;
  pthread_mutex_unlock(&p->lock);
}

/* Finds a node by number; NULL: not found. */
static struct vg_node *held(struct vg_partition *p, uint64_t number)
{
  struct vg_node *n;

  pthread_mutex_lock(&p->lock);
  for (n = p->cutting; n && n->number != number;) n = n->next;
  pthread_mutex_unlock(&p->lock);
  return n;
}

static void unlink_node(struct vg_partition *p, struct vg_node *n)
{
  pthread_mutex_lock(&p->lock);
  *n->link = n->next;
  if (n->next) n->next->link = n->link;
  pthread_mutex_unlock(&p->lock);
}

/* Continues a node after planning or a join: submits its works or its
 * children. */
static vg_status follow(struct vg_partition *p, struct vg_engine *e,
                        struct vg_node *n, struct vg_error *err)
{
  size_t n_work = n->n_work;
  vg_status st = VG_OK;

  for (size_t k = 0; st == VG_OK && k < n_work; k++) {
    struct vg_work *w = n->work[k];

    n->work[k] = NULL;
    pthread_mutex_lock(&p->lock);
    p->report.n_pencil += w->kind == VG_SPAN_PENCIL;
    p->report.n_tile += w->kind == VG_SPAN_TILE;
    pthread_mutex_unlock(&p->lock);
    st = submit(e, w->path, w->kind, 0, 0, w->estimate, w, err);
  }
  if (n_work || st < 0) return st;
  unlink_node(p, n);
  if (n->n_child != 1 || n->child[0] != n) {
    pthread_mutex_lock(&p->lock);
    p->report.n_node++;
    pthread_mutex_unlock(&p->lock);
  }
  for (size_t k = 0; st == VG_OK && k < n->n_child; k++) {
    struct vg_node *c = n->child[k];

    n->child[k] = NULL;
    if (c == n) {
      n->n_child = 0;
      return submit_child(p, e, c, err);
    }
    st = submit_child(p, e, c, err);
  }
  vg_node_free(n);
  return st;
}

/* The last outcome of a stage submits the join of the node. */
static vg_status zone_done(struct vg_partition *p, struct vg_engine *e,
                           struct outcome *o, struct vg_error *err)
{
  /* a task that was packed and returned to its home has only the number */
  struct vg_node *n = o->node ? o->node : held(p, o->home_node);
  struct vg_change *change;

  if (!n) return vg_fail_damaged(err, "the outcome of a task");
  change = &n->change[o->index];
  *change = o->change;
  memset(&o->change, 0, sizeof o->change);
  pthread_mutex_lock(&p->lock);
  p->report.n_blocked += (uint64_t)change->blocked;
  p->report.n_zone_cell += change->made.n_cell;
  pthread_mutex_unlock(&p->lock);
  return --n->n_left ? VG_OK : submit_join(e, n, err);
}

/* An overloaded leaf becomes a node. Its front is unchanged, and it has at
 * least the number of cells at which it was stopped. */
static vg_status leaf_done(struct vg_partition *p, struct vg_engine *e,
                           struct outcome *o, struct vg_error *err)
{
  struct vg_node *n = o->node;
  double leaf = p->options.rule.leaf_cells, more;

  if (!n) return VG_OK;
  o->node = NULL;
  pthread_mutex_lock(&p->lock);
  p->report.n_outgrown++;
  p->report.n_leaf--;
  pthread_mutex_unlock(&p->lock);
  more = VG_OUTGROWN * (n->load.cells > leaf ? n->load.cells : leaf) /
         (n->load.cells > 1 ? n->load.cells : 1);
  for (size_t k = 0; k < n->load.n; k++) n->load.octant[k].cells *= (float)more;
  n->load.cells *= more;
  n->is_planned = 0;
  snprintf(n->path + strlen(n->path), sizeof n->path - strlen(n->path), "+");
  return submit_child(p, e, n, err);
}

static vg_status done(void *user, struct vg_engine *e,
                      const struct vg_task *task, void *outcome, int rank,
                      struct vg_error *err)
{
  struct vg_partition *p = user;
  struct outcome *o = outcome;
  struct vg_node *n = o->node;
  vg_status st;

  (void)task;
  (void)rank;
  if (o->what == VG_WORK_ZONE) {
    st = zone_done(p, e, o, err);
  } else if (o->what == VG_WORK_LEAF) {
    st = leaf_done(p, e, o, err);
  } else {
    o->node = NULL; /* continues by itself */
    if (o->what == VG_WORK_START) hold(p, n);
    st = follow(p, e, n, err);
  }
  free_outcome(o);
  return st;
}

/* --- transfer to other ranks --------------------------------------------- */

static vg_status packed(struct vg_writer *w, struct vg_bytes *out,
                        struct vg_error *err)
{
  if (w->refused) {
    free(w->bytes.data);
    return vg_fail_memory(err, "a message");
  }
  *out = w->bytes;
  return VG_OK;
}

enum { N_NUMBER = 10 }; /* integers of a node */

static vg_status put_node(struct vg_writer *w, const struct vg_node *n,
                          struct vg_error *err)
{
  const struct vg_lattice *l = &n->lattice;
  int32_t number[N_NUMBER] = { n->levels,     n->retry,       n->is_final,
                               n->is_planned, n->n_bisection, l->n[0],
                               l->n[1],       l->n[2],        l->lines_at_once,
                               n->to_part };
  struct vg_bytes load = { 0, NULL };
  uint64_t size;
  vg_status st = vg_load_pack(&n->load, &load, err);

  if (st < 0) return st;
  size = load.n;
  vg_put(w, sizeof n->path, 1, n->path);
  vg_put(w, N_NUMBER, sizeof *number, number);
  vg_put(w, 1, sizeof l->at, l->at); /* ribs are made by the rank that cuts */
  vg_put(w, 1, sizeof n->per_cube, &n->per_cube);
  vg_put(w, 1, sizeof size, &size);
  vg_put(w, load.n, 1, load.data);
  vg_front_put(w, &n->front, 1);
  free(load.data);
  return VG_OK;
}

static struct vg_node *get_node(struct vg_reader *r)
{
  struct vg_front empty = VG_FRONT_INIT;
  struct vg_node *n = vg_node_new("", &empty);
  int32_t number[N_NUMBER] = { 0 };
  struct vg_bytes load = { 0, NULL };
  uint64_t size = 0;

  if (!n) return NULL;
  vg_get(r, sizeof n->path, 1, n->path);
  vg_get(r, N_NUMBER, sizeof *number, number);
  vg_get(r, 1, sizeof n->lattice.at, n->lattice.at);
  vg_get(r, 1, sizeof n->per_cube, &n->per_cube);
  vg_get(r, 1, sizeof size, &size);
  n->levels = number[0];
  n->retry = number[1];
  n->is_final = number[2];
  n->is_planned = number[3];
  n->n_bisection = number[4];
  for (int k = 0; k < 3; k++) n->lattice.n[k] = number[5 + k];
  n->lattice.lines_at_once = number[8];
  n->to_part = number[9];
  load.n = size;
  load.data = vg_get_array(r, size, 1);
  if (!r->bad) r->bad = vg_load_unpack(&load, &n->load, NULL) < 0;
  free(load.data);
  vg_front_get(r, &n->front, 1);
  if (!r->bad) return n;
  vg_node_free(n);
  return NULL;
}

static vg_status pack_input(void *user, const void *input, struct vg_bytes *out,
                            struct vg_error *err)
{
  const struct vg_work *k = input;
  struct vg_writer w = { .cap = 0 };
  int32_t what = k->what;
  uint64_t home[2] = { k->node ? k->node->number : 0, k->index };

  (void)user;
  vg_put(&w, 1, sizeof what, &what);
  vg_put(&w, 1, sizeof k->serial, &k->serial);
  if (k->what == VG_WORK_ZONE) {
    vg_put(&w, sizeof k->path, 1, k->path);
    vg_put(&w, 1, 1, &k->kind);
    vg_put(&w, 2, sizeof *home, home);
    vg_put(&w, 1, sizeof k->region, &k->region);
    vg_front_put(&w, &k->part, 1);
  } else {
    vg_status st = put_node(&w, k->node, err);

    if (st < 0) {
      free(w.bytes.data);
      return st;
    }
  }
  return packed(&w, out, err);
}

static vg_status unpack_input(void *user, const struct vg_bytes *in,
                              void **input, struct vg_error *err)
{
  struct vg_reader r = { .data = in->data, .n = in->n };
  struct vg_work *k = new_work(0, NULL);
  int32_t what = 0;
  uint64_t home[2] = { 0, 0 };

  (void)user;
  if (!k) return vg_fail_memory(err, "a message");
  vg_get(&r, 1, sizeof what, &what);
  vg_get(&r, 1, sizeof k->serial, &k->serial);
  k->what = what;
  if (what == VG_WORK_ZONE) {
    vg_get(&r, sizeof k->path, 1, k->path);
    vg_get(&r, 1, 1, &k->kind);
    vg_get(&r, 2, sizeof *home, home);
    vg_get(&r, 1, sizeof k->region, &k->region);
    vg_front_get(&r, &k->part, 1);
    k->home_node = home[0];
    k->index = home[1];
  } else if (!r.bad && !(k->node = get_node(&r))) {
    r.bad = 1;
  }
  if (r.bad) {
    free(k);
    return vg_fail_damaged(err, "a task");
  }
  *input = k;
  return VG_OK;
}

static vg_status pack_outcome(void *user, const void *outcome,
                              struct vg_bytes *out, struct vg_error *err)
{
  const struct outcome *o = outcome;
  struct vg_writer w = { .cap = 0 };
  uint64_t home[2] = { o->home_node, o->index };

  (void)user; /* only outcomes of zones are sent */
  vg_put(&w, 2, sizeof *home, home);
  vg_change_put(&w, &o->change);
  return packed(&w, out, err);
}

static vg_status unpack_outcome(void *user, const struct vg_bytes *in,
                                void **outcome, struct vg_error *err)
{
  struct vg_reader r = { .data = in->data, .n = in->n };
  struct outcome *o = vg_calloc(1, sizeof *o);
  uint64_t home[2] = { 0, 0 };

  (void)user;
  if (!o) return vg_fail_memory(err, "a message");
  vg_get(&r, 2, sizeof *home, home);
  vg_change_get(&r, &o->change);
  o->what = VG_WORK_ZONE;
  o->home_node = home[0];
  o->index = home[1];
  if (r.bad) {
    free_outcome(o);
    return vg_fail_damaged(err, "the outcome of a task");
  }
  *outcome = o;
  return VG_OK;
}

static void release_input(void *user, void *input)
{
  (void)user;
  vg_work_free(input);
}

static void release_outcome(void *user, void *outcome)
{
  (void)user;
  free_outcome(outcome);
}

/* --- interface to the engine --------------------------------------------- */

const struct vg_engine_ops vg_tasks_ops = { run,           done,
                                            pack_input,    unpack_input,
                                            pack_outcome,  unpack_outcome,
                                            release_input, release_outcome };

vg_status vg_tasks_first(struct vg_partition *p, struct vg_node *n,
                         struct vg_task *t, struct vg_error *err)
{
  int cut = n->to_part || vg_node_wants_cut(p, n);
  struct vg_work *w = new_work(cut ? VG_WORK_START : VG_WORK_LEAF, n);

  assert(p && n && t);
  if (!w) {
    vg_node_free(n);
    return vg_fail_memory(err, "a task");
  }
  /* a void that will be decomposed stays on the rank of its coarse mesh */
  *t = (struct vg_task){ .kind = cut ? VG_SPAN_JOIN : VG_SPAN_LEAF,
                         .moves = !n->to_part,
                         .pinned = n->to_part,
                         .weight = n->load.cells,
                         .input = w };
  t->priority = vg_model_priority(t->kind, t->weight);
  snprintf(t->path, sizeof t->path, cut ? "%.*sJ0" : "%.*sL", VG_PATH_MAX - 3,
           n->path);
  if (cut) return VG_OK;
  w->serial = n->serial ? n->serial : vg_partition_serial(p);
  t->work = work_of(n);
  p->report.n_leaf++;
  return VG_OK;
}
