/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The dependency graph of the tasks. Rules: model.h. */
#include "partition/model/model_parts.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

#define NONE VG_MODEL_NONE

/* Times of a trace are rounded, to the microsecond in files. */
#define LOOPS_ROUNDED 2e-6

/* A task in a group; the pairs are sorted into lists later. */
struct member {
  uint32_t task, group;
};

struct members {
  size_t n, cap;
  struct member *item;
};

/* A stage is identified by its creating task, its node and its class. A node
 * is the first `len` bytes of a path. */
struct key {
  uint32_t after, task;
  int class;
  size_t len;
  const char *path;
};

struct keys {
  size_t n;
  struct key *item;
};

void vg_model_graph_release(struct vg_model_graph *g)
{
  free(g->span);
  free(g->after);
  free(g->wait);
  free(g->moves);
  free(g->in_first);
  free(g->in);
  free(g->dep_first);
  free(g->dep);
  free(g->size);
  memset(g, 0, sizeof *g);
}

static size_t node_length(const char *path)
{
  return strcspn(path, "ABCDEFGHIJKLMNOPQRSTUVWXYZ");
}

static int class_of(char kind)
{
  if (kind == VG_SPAN_PENCIL || kind == VG_SPAN_TILE) return 1;
  return kind == VG_SPAN_REPAIR ? 2 : 0;
}

static int by_path(const void *a, const void *b)
{
  const struct vg_span *s = a, *t = b;

  return strcmp(s->path, t->path);
}

static int node_order(const struct key *a, const struct key *b)
{
  size_t len = a->len < b->len ? a->len : b->len;
  int order = memcmp(a->path, b->path, len);

  return order ? order : (a->len > b->len) - (a->len < b->len);
}

static int by_stage(const void *a, const void *b)
{
  const struct key *s = a, *t = b;
  int order;

  if (s->after != t->after) return s->after < t->after ? -1 : 1;
  if (s->class != t->class) return s->class - t->class;
  order = node_order(s, t);
  return order ? order : (s->task > t->task) - (s->task < t->task);
}

static int by_node(const void *a, const void *b)
{
  return node_order(a, b);
}

static vg_status check_span(const struct vg_span *s, struct vg_error *err)
{
  if (!s->path[0] || !memchr(s->path, 0, sizeof s->path) ||
      !memchr(s->after, 0, sizeof s->after))
    return vg_fail(err, VG_ERR_INPUT,
                   "a task of the trace has an empty path, or "
                   "one without a terminator");
  if (!(s->cpu >= 0 && s->cpu <= 1e9))
    return vg_fail(err, VG_ERR_INPUT,
                   "task '%s' of the trace took %g "
                   "seconds",
                   s->path, s->cpu);
  if (!(s->loops >= 0 && s->loops <= s->cpu + LOOPS_ROUNDED))
    return vg_fail(err, VG_ERR_INPUT,
                   "task '%s' of the trace took %g "
                   "seconds, of which %g in loops",
                   s->path, s->cpu, s->loops);
  if (s->home < 0)
    return vg_fail(err, VG_ERR_INPUT,
                   "task '%s' of the trace has the home "
                   "rank %d",
                   s->path, (int)s->home);
  return VG_OK;
}

static vg_status copy_spans(const struct vg_spans *spans,
                            struct vg_model_graph *g, struct vg_error *err)
{
  vg_status st = VG_OK;

  if (spans->n >= NONE / 4)
    return vg_fail(err, VG_ERR_INPUT,
                   "a trace of %zu tasks is too long "
                   "to be replayed",
                   spans->n);
  g->n = (uint32_t)spans->n;
  g->span = vg_alloc(g->n, sizeof *g->span);
  if (!g->span) return vg_fail_memory(err, "the tasks of the trace");
  for (uint32_t i = 0; i < g->n && st >= 0; i++) {
    struct vg_span *one = &g->span[i];

    *one = spans->span[i];
    st = check_span(one, err);
    if (one->loops > one->cpu) one->loops = one->cpu;
  }
  if (st < 0) return st;
  qsort(g->span, g->n, sizeof *g->span, by_path);
  for (uint32_t i = 1; i < g->n; i++)
    if (!strcmp(g->span[i - 1].path, g->span[i].path))
      return vg_fail(err, VG_ERR_INPUT,
                     "task '%s' is in the trace more "
                     "than once",
                     g->span[i].path);
  return VG_OK;
}

static vg_status find_after(struct vg_model_graph *g, struct vg_error *err)
{
  for (uint32_t i = 0; i < g->n; i++) {
    struct vg_span wanted, *found;

    g->after[i] = NONE;
    if (!g->span[i].after[0]) continue;
    memcpy(wanted.path, g->span[i].after, sizeof wanted.path);
    found = bsearch(&wanted, g->span, g->n, sizeof *g->span, by_path);
    if (!found)
      return vg_fail(err, VG_ERR_INPUT,
                     "task '%s' of the trace was created by "
                     "'%s', which is not in it",
                     g->span[i].path, g->span[i].after);
    g->after[i] = (uint32_t)(found - g->span);
  }
  return VG_OK;
}

/* Walks up from each task until a visited one; each task is visited once. A
 * walk that meets itself is a cycle. */
static vg_status find_circles(struct vg_model_graph *g, struct vg_error *err)
{
  uint32_t *walk = vg_calloc(g->n, sizeof *walk);
  vg_status st = VG_OK;

  if (!walk) return vg_fail_memory(err, "the order of the trace");
  for (uint32_t i = 0; i < g->n && st >= 0; i++) {
    uint32_t at = i;

    if (walk[i]) continue;
    while (at != NONE && !walk[at]) {
      walk[at] = i + 1;
      at = g->after[at];
    }
    if (at != NONE && walk[at] == i + 1)
      st = vg_fail(err, VG_ERR_INPUT,
                   "task '%s' of the trace comes after "
                   "itself",
                   g->span[at].path);
  }
  free(walk);
  return st;
}

static vg_status add_member(struct members *m, uint32_t task, uint32_t group,
                            struct vg_error *err)
{
  if (vg_reserve(&m->item, &m->cap, m->n + 1, sizeof *m->item))
    return vg_fail_memory(err, "the dependencies of tasks");
  m->item[m->n].task = task;
  m->item[m->n++].group = group;
  return VG_OK;
}

static struct key key_of(const struct vg_model_graph *g, uint32_t task)
{
  struct key k = { .after = g->after[task],
                   .task = task,
                   .class = class_of(g->span[task].kind),
                   .len = node_length(g->span[task].path),
                   .path = g->span[task].path };

  return k;
}

/* Finds the group of each task's stage: stage[n], NONE for joins and leaves. */
static vg_status find_stages(struct vg_model_graph *g, uint32_t *stage,
                             struct members *m, struct vg_error *err)
{
  struct keys k = { 0, vg_alloc(g->n, sizeof *k.item) };
  vg_status st = VG_OK;

  if (!k.item) return vg_fail_memory(err, "the stages of the trace");
  for (uint32_t i = 0; i < g->n; i++) {
    stage[i] = NONE;
    if (class_of(g->span[i].kind)) k.item[k.n++] = key_of(g, i);
  }
  qsort(k.item, k.n, sizeof *k.item, by_stage);
  for (size_t i = 0; i < k.n && st >= 0; i++) {
    const struct key *one = &k.item[i];

    if (!i || one->after != one[-1].after || one->class != one[-1].class ||
        node_order(one, one - 1))
      g->n_group++;
    stage[one->task] = g->n_group - 1;
    st = add_member(m, one->task, g->n_group - 1, err);
  }
  free(k.item);
  return st;
}

/* Returns 1 when the node of task a is that of b or an ancestor. */
static int is_above(const struct key *a, const struct key *b)
{
  return a->len <= b->len && !memcmp(a->path, b->path, a->len) &&
         (a->len == b->len || b->path[a->len] == '.');
}

/* Finds the nodes of repairs that wait for all leaves of a node, sorted, each
 * once; their task is the first of its kind, `after` becomes the group. */
static void find_repaired(struct vg_model_graph *g, struct keys *k)
{
  size_t n = 0;

  for (uint32_t i = 0; i < g->n; i++) {
    struct key one = key_of(g, i), leaf;

    if (g->span[i].kind != VG_SPAN_REPAIR || g->after[i] == NONE ||
        g->span[g->after[i]].kind != VG_SPAN_LEAF)
      continue;
    leaf = key_of(g, g->after[i]);
    if (is_above(&one, &leaf)) k->item[k->n++] = one;
  }
  qsort(k->item, k->n, sizeof *k->item, by_node);
  for (size_t i = 0; i < k->n; i++) {
    if (n && !node_order(&k->item[n - 1], &k->item[i])) continue;
    k->item[n] = k->item[i];
    k->item[n++].after = g->n_group++;
  }
  k->n = n;
}

/* A leaf belongs to the groups of all repaired nodes above it. */
static vg_status join_repaired(const struct vg_model_graph *g,
                               const struct keys *k, uint32_t task,
                               struct members *m, struct vg_error *err)
{
  struct key at = key_of(g, task);
  vg_status st = VG_OK;

  for (;;) {
    const struct key *found = bsearch(&at, k->item, k->n, sizeof *k->item,
                                      by_node);

    if (found) VG_TRY(add_member(m, task, found->after, err));
    while (at.len && at.path[at.len - 1] != '.') at.len--;
    if (!at.len--) break;
  }
done:
  return st;
}

/* Finds the tasks whose executing rank becomes their home: leaves, and joins
 * that start a node. */
static void find_moves(struct vg_model_graph *g)
{
  for (uint32_t i = 0; i < g->n; i++) {
    struct key one = key_of(g, i), maker;

    g->moves[i] = g->span[i].kind == VG_SPAN_LEAF;
    if (g->span[i].kind != VG_SPAN_JOIN) continue;
    g->moves[i] = 1;
    if (g->after[i] == NONE) continue;
    maker = key_of(g, g->after[i]);
    g->moves[i] = node_order(&one, &maker) != 0;
  }
}

static vg_status find_waits(struct vg_model_graph *g, struct members *m,
                            struct vg_error *err)
{
  uint32_t *stage = vg_alloc(g->n, sizeof *stage);
  struct keys k = { 0, vg_alloc(g->n, sizeof *k.item) };
  vg_status st = VG_OK;

  g->n_group = g->n;
  if (!stage || !k.item) {
    st = vg_fail_memory(err, "the order of the trace");
    goto done;
  }
  for (uint32_t i = 0; i < g->n; i++) VG_TRY(add_member(m, i, i, err));
  VG_TRY(find_stages(g, stage, m, err));
  find_repaired(g, &k);
  for (uint32_t i = 0; i < g->n; i++) {
    uint32_t after = g->after[i];
    struct key node = key_of(g, i), *found = NULL;

    g->wait[i] = after;
    if (after == NONE) continue;
    if (stage[after] != NONE) g->wait[i] = stage[after];
    if (g->span[i].kind == VG_SPAN_REPAIR &&
        g->span[after].kind == VG_SPAN_LEAF) {
      struct key leaf = key_of(g, after);

      if (is_above(&node, &leaf))
        found = bsearch(&node, k.item, k.n, sizeof *k.item, by_node);
    }
    if (found) g->wait[i] = found->after;
  }
  for (uint32_t i = 0; i < g->n && k.n; i++)
    if (g->span[i].kind == VG_SPAN_LEAF)
      VG_TRY(join_repaired(g, &k, i, m, err));
done:
  free(stage);
  free(k.item);
  return st;
}

/* Counting sort of `n` pairs (row, item) into lists by row, each in the order
 * of the pairs; first: [n_row + 1] zeroed. */
static void list_pairs(size_t n, const struct member *pair, int by_group,
                       uint32_t n_row, uint32_t *first, uint32_t *list)
{
  for (size_t i = 0; i < n; i++)
    first[by_group ? pair[i].group : pair[i].task]++;
  for (uint32_t i = 0, sum = 0; i <= n_row; i++) {
    uint32_t count = first[i];

    first[i] = sum;
    sum += count;
  }
  for (size_t i = 0; i < n; i++)
    list[first[by_group ? pair[i].group : pair[i].task]++] = by_group
                                                             ? pair[i].task
                                                             : pair[i].group;
  for (uint32_t i = n_row; i > 0; i--) first[i] = first[i - 1];
  first[0] = 0;
}

static vg_status list_all(struct vg_model_graph *g, const struct members *m,
                          struct vg_error *err)
{
  struct member *waiting = vg_alloc(g->n, sizeof *waiting);
  size_t n = 0;

  g->in_first = vg_calloc((size_t)g->n + 1, sizeof *g->in_first);
  g->in = vg_alloc(m->n, sizeof *g->in);
  g->dep_first = vg_calloc((size_t)g->n_group + 1, sizeof *g->dep_first);
  g->dep = vg_alloc(g->n, sizeof *g->dep);
  g->size = vg_calloc(g->n_group, sizeof *g->size);
  if (!waiting || !g->in_first || !g->in || !g->dep_first || !g->dep ||
      !g->size || m->n >= NONE) {
    free(waiting);
    return vg_fail_memory(err, "the order of the trace");
  }
  list_pairs(m->n, m->item, 0, g->n, g->in_first, g->in);
  for (size_t i = 0; i < m->n; i++) g->size[m->item[i].group]++;
  for (uint32_t i = 0; i < g->n; i++) {
    if (g->wait[i] == NONE) continue;
    waiting[n].task = i;
    waiting[n++].group = g->wait[i];
  }
  list_pairs(n, waiting, 1, g->n_group, g->dep_first, g->dep);
  free(waiting);
  return VG_OK;
}

vg_status vg_model_graph_new(const struct vg_spans *spans,
                             struct vg_model_graph *out, struct vg_error *err)
{
  struct vg_model_graph g = { .n = 0 };
  struct members m = { 0, 0, NULL };
  vg_status st;

  VG_TRY(copy_spans(spans, &g, err));
  g.after = vg_alloc(g.n, sizeof *g.after);
  g.wait = vg_alloc(g.n, sizeof *g.wait);
  g.moves = vg_alloc(g.n, sizeof *g.moves);
  if (!g.after || !g.wait || !g.moves) {
    st = vg_fail_memory(err, "the order of the trace");
    goto done;
  }
  VG_TRY(find_after(&g, err));
  VG_TRY(find_circles(&g, err));
  find_moves(&g);
  VG_TRY(find_waits(&g, &m, err));
  VG_TRY(list_all(&g, &m, err));
  *out = g;
  memset(&g, 0, sizeof g);
done:
  vg_model_graph_release(&g);
  free(m.item);
  return st;
}
