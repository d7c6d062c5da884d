/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The graph of the units, and its partitioning by METIS. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/memory.h"
#include "partition/solver/solver_parts.h"

/* Imbalance (maximum over mean weight) passed to METIS: its own default for
 * k-way partitioning. */
static const double imbalance = 1.03; /* P2 */

void vg_unit_graph_release(struct vg_unit_graph *g)
{
  free(g->begin);
  free(g->to);
  free(g->faces);
  memset(g, 0, sizeof *g);
}

static int by_value(const void *a, const void *b)
{
  uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;

  return (x > y) - (x < y);
}

/* Insertion sort for short rows, as most are. */
static void sort_row(uint32_t *v, size_t n)
{
  if (n > 32) {
    qsort(v, n, sizeof *v, by_value);
    return;
  }
  for (size_t i = 1; i < n; i++) {
    uint32_t x = v[i];
    size_t k = i;

    for (; k && v[k - 1] > x; k--) v[k] = v[k - 1];
    v[k] = x;
  }
}

/* --- from links ---------------------------------------------------------- */

typedef void (*visit)(struct vg_unit_graph *g, uint32_t a, uint32_t b);

static void each_half_face(const struct vg_cell_links *l,
                           const struct vg_units *u, visit meet,
                           struct vg_unit_graph *g)
{
  for (uint32_t cell = 0; cell < l->n_cell; cell++) {
    const uint32_t *link = l->link + vg_first_half(l, cell);
    int n = vg_half_faces(l, cell);

    for (int i = 0; i < n; i++)
      if (link[i] != VG_NO_CELL && u->of[link[i] >> 3] != u->of[cell])
        meet(g, u->of[cell], u->of[link[i] >> 3]);
  }
}

static void count(struct vg_unit_graph *g, uint32_t a, uint32_t b)
{
  (void)b;
  g->begin[a]++;
}

/* begin[a] moves from the end of the row to its beginning. */
static void enter(struct vg_unit_graph *g, uint32_t a, uint32_t b)
{
  g->to[--g->begin[a]] = b;
}

static void add_up(struct vg_unit_graph *g)
{
  uint64_t sum = 0;

  for (size_t k = 0; k < g->n; k++) g->begin[k] = sum += g->begin[k];
  g->begin[g->n] = sum;
}

/* Sorts each row and merges equal entries into one with a count. */
static vg_status merge_rows(struct vg_unit_graph *g, struct vg_error *err)
{
  uint64_t n = 0, from = 0;

  g->faces = vg_alloc(g->begin[g->n], sizeof *g->faces);
  if (!g->faces) return vg_fail_memory(err, "the graph of a mesh");
  for (size_t k = 0; k < g->n; k++) {
    uint64_t end = g->begin[k + 1], first = n;

    sort_row(g->to + from, (size_t)(end - from));
    g->begin[k] = first;
    for (; from < end; from++)
      if (n > first && g->to[n - 1] == g->to[from]) {
        g->faces[n - 1]++;
      } else {
        g->to[n] = g->to[from];
        g->faces[n++] = 1;
      }
  }
  g->begin[g->n] = n;
  return VG_OK;
}

vg_status vg_unit_graph_of_links(const struct vg_cell_links *l,
                                 const struct vg_units *u,
                                 struct vg_unit_graph *out,
                                 struct vg_error *err)
{
  struct vg_unit_graph g = { .n = u->n_unit };
  vg_status st = VG_OK;

  g.begin = vg_calloc(g.n + 1, sizeof *g.begin);
  if (g.begin) {
    each_half_face(l, u, count, &g);
    add_up(&g);
    g.to = vg_alloc(g.begin[g.n], sizeof *g.to);
  }
  if (!g.to) {
    st = vg_fail_memory(err, "the graph of a mesh");
  } else {
    each_half_face(l, u, enter, &g);
    st = merge_rows(&g, err);
  }
  if (st < 0) vg_unit_graph_release(&g);
  else *out = g;
  return st;
}

/* --- from pairs ---------------------------------------------------------- */

struct entry {
  uint32_t to;
  int32_t faces;
};

static int by_unit(const void *a, const void *b)
{
  return by_value(&((const struct entry *)a)->to,
                  &((const struct entry *)b)->to);
}

static void enter_pairs(struct vg_unit_graph *g, struct entry *row,
                        const struct vg_unit_pair *pair, size_t n_pair)
{
  for (size_t i = 0; i < n_pair; i++) {
    const struct vg_unit_pair *p = &pair[i];

    row[--g->begin[p->a]] = (struct entry){ p->b, (int32_t)p->n };
    row[--g->begin[p->b]] = (struct entry){ p->a, (int32_t)p->n };
  }
}

static void merge_entries(struct vg_unit_graph *g, struct entry *row)
{
  uint64_t n = 0, from = 0;

  for (size_t k = 0; k < g->n; k++) {
    uint64_t end = g->begin[k + 1], first = n;

    qsort(row + from, (size_t)(end - from), sizeof *row, by_unit);
    g->begin[k] = first;
    for (; from < end; from++)
      if (n > first && g->to[n - 1] == row[from].to) {
        g->faces[n - 1] += row[from].faces;
      } else {
        g->to[n] = row[from].to;
        g->faces[n++] = row[from].faces;
      }
  }
  g->begin[g->n] = n;
}

vg_status vg_unit_graph_of_pairs(size_t n, const struct vg_unit_pair *pair,
                                 size_t n_pair, struct vg_unit_graph *out,
                                 struct vg_error *err)
{
  assert(pair || !n_pair);

  struct vg_unit_graph g = { .n = n };
  struct entry *row = vg_alloc(2 * n_pair, sizeof *row);

  g.begin = vg_calloc(n + 1, sizeof *g.begin);
  g.to = vg_alloc(2 * n_pair, sizeof *g.to);
  g.faces = vg_alloc(2 * n_pair, sizeof *g.faces);
  if (!row || !g.begin || !g.to || !g.faces) {
    free(row);
    vg_unit_graph_release(&g);
    return vg_fail_memory(err, "the graph of a mesh");
  }
  for (size_t i = 0; i < n_pair; i++) {
    g.begin[pair[i].a]++;
    g.begin[pair[i].b]++;
  }
  add_up(&g);
  enter_pairs(&g, row, pair, n_pair);
  merge_entries(&g, row);
  free(row);
  *out = g;
  return VG_OK;
}

/* --- partitions ---------------------------------------------------------- */

/* A partition that METIS left empty gets the first unit of the partition with
 * the most units, since solvers fail on empty ones. There are enough units. */
static vg_status fill_empty(size_t n, uint64_t n_part, uint32_t *part,
                            struct vg_solver_report *r, struct vg_error *err)
{
  uint64_t *have = vg_calloc(n_part, sizeof *have);

  if (!have) return vg_fail_memory(err, "the sizes of partitions");
  for (size_t k = 0; k < n; k++) have[part[k]]++;
  for (uint32_t p = 0; p < n_part; p++) {
    uint32_t most = 0;
    size_t k = 0;

    if (have[p]) continue;
    for (uint32_t q = 1; q < n_part; q++)
      if (have[q] > have[most]) most = q;
    while (part[k] != most) k++;
    part[k] = p;
    have[most]--;
    have[p]++;
    r->n_moved++;
  }
  free(have);
  return VG_OK;
}

vg_status vg_unit_graph_part(const struct vg_unit_graph *g,
                             const double *weight, uint64_t n_part,
                             uint32_t *part, struct vg_solver_report *r,
                             struct vg_error *err)
{
  assert((weight && part) || !g->n);

  struct vg_graph graph = { g->n, g->begin, g->to, weight, g->faces };
  struct vg_graph_options o = { (int)n_part, imbalance, 0, NULL };
  double t = vg_clock();
  vg_status st;

  if (n_part < 1 || n_part > g->n || n_part > INT32_MAX)
    return vg_fail(err, VG_ERR_INPUT,
                   "%llu solver partitions were requested, but the mesh "
                   "has %zu stacks and cells to distribute; request 1 to "
                   "%zu partitions",
                   (unsigned long long)n_part, g->n,
                   g->n < INT32_MAX ? g->n : (size_t)INT32_MAX);
  st = vg_graph_part(&graph, &o, part, err);
  if (st >= 0) st = fill_empty(g->n, n_part, part, r, err);
  r->n_vertex = g->n;
  r->time_metis = vg_clock() - t;
  return st;
}
