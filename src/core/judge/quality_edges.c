/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Edge lengths compared with the sizing field: every interior edge once.
 *
 * An edge is entered in the bucket of its lower node. Second and later entries
 * of the same edge are recognised by a mark at the upper node. As in
 * quality_faces.c, buckets are made for one range of nodes after the other to
 * save memory. Edges of boundary faces are entered first and only leave their
 * mark. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "core/judge/quality_parts.h"
#include "core/mesh/cell_edges.h"

#define LEAST_ENTRIES ((size_t)1 << 21)
#define N_PASS 4

/* Target lengths are evaluated in groups, with one call for many points. */
#define GROUP 256

struct edges {
  const struct vg_mesh *m;
  const struct vg_sizing *sizing;
  struct vg_point_metrics *metrics; /* NULL: lengths are not measured in a
                                       metric */
  uint32_t *count;      /* [n_point] entries by lower node; then ends of
                           buckets */
  uint32_t *n_boundary; /* [n_point] entries from boundary faces */
  uint32_t *mark;       /* [n_point] lower node + 1 of the last edge with
                           this upper node */
  uint8_t *is_boundary; /* [n_point] in a metric: the last edge with this
                           upper node was entered by a boundary face, and not
                           yet by a cell */
  uint32_t *entry;
  uint32_t lo, n;
  int pass; /* 0: count, 1: enter */
  struct vg_stats *f;
  struct vg_unpaired *unpaired; /* NULL: m is a whole mesh with its boundary */
  int refused;                  /* memory for unpaired edges was refused */
  uint32_t pair[GROUP][2];
  size_t n_group;
};

static const uint8_t tri_edge[3][2] = { { 0, 1 }, { 1, 2 }, { 2, 0 } };
static const uint8_t quad_edge[4][2] = {
  { 0, 1 }, { 1, 2 }, { 2, 3 }, { 3, 0 }
};

static void enter_all(struct edges *e, const uint32_t *node, size_t n_cell,
                      size_t width, const uint8_t (*edge)[2], int n_edge)
{
  for (size_t i = 0; i < n_cell; i++, node += width)
    for (int j = 0; j < n_edge; j++) {
      uint32_t a = node[edge[j][0]], b = node[edge[j][1]];
      uint32_t low = a < b ? a : b, high = a < b ? b : a;

      if (low - e->lo >= e->n) continue;
      if (e->pass) e->entry[e->count[low]++] = high;
      else e->count[low]++;
    }
}

static void enter_boundary(struct edges *e)
{
  const struct vg_mesh *m = e->m;

  enter_all(e, (const uint32_t *)m->tri, m->n_tri, 3, tri_edge, 3);
  enter_all(e, (const uint32_t *)m->quad, m->n_quad, 4, quad_edge, 4);
  for (size_t i = 0; e->unpaired && i < e->unpaired->n_face; i++) {
    const uint32_t *n = e->unpaired->face[i].node;
    int quad = n[3] != VG_NO_NODE;

    enter_all(e, n, 1, 4, quad ? quad_edge : tri_edge, quad ? 4 : 3);
  }
}

static void enter_cells(struct edges *e)
{
  const struct vg_mesh *m = e->m;

  if (e->metrics) {
    size_t first = e->metrics->first;

    if (first < m->n_tet)
      enter_all(e, m->tet[first], m->n_tet - first, 4, vg_tet_edge, 6);
    return;
  }
  enter_all(e, (const uint32_t *)m->tet, m->n_tet, 4, vg_tet_edge, 6);
  enter_all(e, (const uint32_t *)m->pyr, m->n_pyr, 5, vg_pyr_edge, 8);
  enter_all(e, (const uint32_t *)m->pri, m->n_pri, 6, vg_pri_edge, 9);
  enter_all(e, (const uint32_t *)m->hex, m->n_hex, 8, vg_hex_edge, 12);
}

static void count_entries(struct edges *e)
{
  e->pass = 0;
  e->lo = 0;
  e->n = (uint32_t)e->m->n_point;
  enter_boundary(e);
  for (size_t i = 0; i < e->m->n_point; i++) e->n_boundary[i] = e->count[i];
  enter_cells(e);
  e->pass = 1;
}

/* Length / target of up to GROUP edges; the order of an edge's ends does not
 * affect the result. */
static void measure(const struct vg_mesh *m, const struct vg_sizing *sizing,
                    size_t n, const uint32_t (*pair)[2], double *ratio)
{
  double mid[GROUP][3], target[GROUP];

  for (size_t i = 0; i < n; i++) {
    const double *p = m->point[pair[i][0]], *q = m->point[pair[i][1]];
    double sum = 0;

    for (int k = 0; k < 3; k++) {
      double d = q[k] - p[k];

      mid[i][k] = p[k] / 2 + q[k] / 2;
      sum += d * d;
    }
    ratio[i] = sqrt(sum);
  }
  vg_sizing_eval(sizing, n, (const double(*)[3])mid, target);
  for (size_t i = 0; i < n; i++) ratio[i] /= target[i];
}

static void flush(struct edges *e)
{
  double ratio[GROUP];

  measure(e->m, e->sizing, e->n_group, (const uint32_t(*)[2])e->pair, ratio);
  for (size_t i = 0; i < e->n_group; i++) vg_stats_edge(e->f, ratio[i]);
  e->n_group = 0;
}

static void add(struct edges *e, uint32_t a, uint32_t b)
{
  e->pair[e->n_group][0] = a;
  e->pair[e->n_group++][1] = b;
  if (e->n_group == GROUP) flush(e);
}

static void add_unpaired(struct edges *e, uint32_t a, uint32_t b)
{
  struct vg_unpaired *unpaired = e->unpaired;

  if (vg_reserve(&unpaired->edge, &unpaired->cap_edge, unpaired->n_edge + 1,
                 sizeof *unpaired->edge)) {
    e->refused = 1;
    return;
  }
  unpaired->edge[unpaired->n_edge++] = (struct vg_unpaired_edge){ { a, b }, 0 };
}

static void measure_unpaired(struct edges *e)
{
  uint32_t pair[GROUP][2];
  double ratio[GROUP];

  for (size_t at = 0, n; at < e->unpaired->n_edge; at += n) {
    struct vg_unpaired_edge *edge = e->unpaired->edge + at;

    if (e->metrics) {
      n = 1;
      edge->ratio = vg_length_in_metric(e->metrics, edge->node[0],
                                        edge->node[1]);
      continue;
    }
    n = e->unpaired->n_edge - at;
    if (n > GROUP) n = GROUP;
    for (size_t i = 0; i < n; i++)
      for (int k = 0; k < 2; k++) pair[i][k] = edge[i].node[k];
    measure(e->m, e->sizing, n, (const uint32_t(*)[2])pair, ratio);
    for (size_t i = 0; i < n; i++) edge[i].ratio = ratio[i];
  }
}

static void count_in_metric(struct edges *e, uint32_t a, uint32_t b,
                            int is_boundary)
{
  double length;

  if (is_boundary && e->unpaired) {
    add_unpaired(e, a, b);
    return;
  }
  length = vg_length_in_metric(e->metrics, a, b);
  vg_stats_length(e->f, length);
  if (!is_boundary) vg_stats_edge(e->f, length);
}

/* As measure_range. An edge of a boundary face counts when the first
 * tetrahedron enters it. */
static void measure_range_in_metric(struct edges *e)
{
  size_t at = 0;

  for (uint32_t v = e->lo; v < e->lo + e->n; v++) {
    size_t inner = at + e->n_boundary[v], end = e->count[v];

    for (; at < inner; at++) {
      e->mark[e->entry[at]] = v + 1;
      e->is_boundary[e->entry[at]] = 1;
    }
    for (; at < end; at++) {
      uint32_t w = e->entry[at];
      int is_seen = e->mark[w] == v + 1, is_boundary = e->is_boundary[w];

      if (is_seen && !is_boundary) continue;
      e->mark[w] = v + 1;
      e->is_boundary[w] = 0;
      count_in_metric(e, v, w, is_seen);
    }
  }
}

static void measure_range(struct edges *e)
{
  size_t at = 0;

  for (uint32_t v = e->lo; v < e->lo + e->n; v++) {
    size_t inner = at + e->n_boundary[v], end = e->count[v];

    for (; at < inner; at++) {
      if (e->unpaired && e->mark[e->entry[at]] != v + 1)
        add_unpaired(e, v, e->entry[at]);
      e->mark[e->entry[at]] = v + 1;
    }
    for (; at < end; at++) {
      if (e->mark[e->entry[at]] == v + 1) continue;
      e->mark[e->entry[at]] = v + 1;
      add(e, v, e->entry[at]);
    }
  }
}

/* Find the end of the next range of nodes, as in quality_faces.c. */
static uint32_t make_range(struct edges *e, uint32_t lo, size_t room,
                           int change, size_t *n_entry)
{
  size_t n = 0, hi = lo;

  for (; hi < e->m->n_point; hi++) {
    uint32_t count = e->count[hi];

    if (hi > lo && n + count > room) break;
    if (change) e->count[hi] = (uint32_t)n;
    n += count;
  }
  *n_entry = n;
  return (uint32_t)hi;
}

static vg_status prepare(struct edges *e, size_t *room, struct vg_error *err)
{
  const struct vg_mesh *m = e->m;
  size_t total = 6 * m->n_tet + 8 * m->n_pyr + 9 * m->n_pri + 12 * m->n_hex +
                 3 * m->n_tri + 4 * m->n_quad +
                 (e->unpaired ? 4 * e->unpaired->n_face : 0);
  size_t most = 0, n;

  e->count = vg_calloc(m->n_point, sizeof *e->count);
  e->n_boundary = vg_calloc(m->n_point, sizeof *e->n_boundary);
  e->mark = vg_calloc(m->n_point, sizeof *e->mark);
  if (e->metrics) {
    e->is_boundary = vg_calloc(m->n_point, 1);
    if (!e->is_boundary) return vg_fail_memory(err, "the edges of the mesh");
  }
  if (!e->count || !e->n_boundary || !e->mark)
    return vg_fail_memory(err, "the edges of the mesh");
  count_entries(e);
  *room = total / N_PASS;
  if (*room < LEAST_ENTRIES) *room = LEAST_ENTRIES;
  for (uint32_t lo = 0; lo < m->n_point;) {
    lo = make_range(e, lo, *room, 0, &n);
    if (n > most) most = n;
  }
  e->entry = vg_alloc(most, sizeof *e->entry);
  if (!e->entry) return vg_fail_memory(err, "the table of edges");
  return VG_OK;
}

vg_status vg_judge_edges(const struct vg_mesh *m,
                         const struct vg_sizing *sizing,
                         struct vg_point_metrics *metrics, struct vg_stats *f,
                         struct vg_unpaired *unpaired, struct vg_error *err)
{
  assert(sizing && f);

  struct edges *e = vg_calloc(1, sizeof *e);
  size_t room = 0, n;
  vg_status st = VG_OK;

  if (!e) return vg_fail_memory(err, "the edges of the mesh");
  e->m = m;
  e->sizing = sizing;
  e->metrics = metrics;
  e->f = f;
  e->unpaired = unpaired;
  VG_TRY(prepare(e, &room, err));
  for (uint32_t lo = 0, hi; lo < m->n_point; lo = hi) {
    hi = make_range(e, lo, room, 1, &n);
    e->lo = lo;
    e->n = hi - lo;
    enter_boundary(e);
    enter_cells(e);
    if (metrics) measure_range_in_metric(e);
    else measure_range(e);
  }
  flush(e);
  if (e->refused) {
    st = vg_fail_memory(err, "the unmatched edges of a slice");
    goto done;
  }
  if (unpaired) measure_unpaired(e);
done:
  free(e->count);
  free(e->n_boundary);
  free(e->mark);
  free(e->is_boundary);
  free(e->entry);
  free(e);
  return st;
}
