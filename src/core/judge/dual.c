/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Orthogonality of the median dual: sweep over the edges of a mesh or slice.
 *
 * The cells are entered at each of their points. The edges from a point v to
 * higher points w are then found among the cells at v; slot[w] is the place of
 * the edge in the list of edges at v. */
#include "core/judge/dual.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "core/geometry/vector.h"

enum { BITS = 40, MOST_EDGES = 12, LOWEST_TOP = -24 };

#define DEGREE 57.295779513082320877

/* --- sums ----------------------------------------------------------------- */

/* 2^e for normal numbers. */
static double power(int e)
{
  uint64_t bits = (uint64_t)(1023 + e) << 52;
  double x;

  memcpy(&x, &bits, sizeof x);
  return x;
}

/* The grid of a number: the largest t with 2^(40 t) <= |x|. */
static int grid_of(double x)
{
  uint64_t bits;
  int e;

  memcpy(&bits, &x, sizeof bits);
  e = (int)(bits >> 52 & 0x7ff) - 1023;
  return (e + 32 * BITS) / BITS - 32;
}

/* Raise the grid. */
static void lift(struct vg_grid_sum *b, int top)
{
  for (int k = 0; k < 3; k++) {
    b->part[1][k] = b->is_used && top == b->top + 1 ? b->part[0][k] : 0;
    b->part[0][k] = 0;
  }
  b->top = top;
  b->is_used = 1;
}

void vg_grid_sum_add(struct vg_grid_sum *b, const double x[3])
{
  double most = fabs(x[0]), scale;
  int t, below;

  if (fabs(x[1]) > most) most = fabs(x[1]);
  if (fabs(x[2]) > most) most = fabs(x[2]);
  t = grid_of(most);
  if (t < LOWEST_TOP) return; /* 0, or below 1e-289 */
  if (!b->is_used || t > b->top) lift(b, t);
  below = b->top - t;
  if (below > 1) return;
  scale = power(-BITS * t);
  for (int k = 0; k < 3; k++) {
    double y = x[k] * scale;
    int64_t whole = (int64_t)y;

    b->part[below][k] += whole;
    if (!below) b->part[1][k] += (int64_t)((y - (double)whole) * power(BITS));
  }
}

void vg_grid_sum_join(struct vg_grid_sum *b, const struct vg_grid_sum *more)
{
  int below;

  if (!more->is_used) return;
  if (!b->is_used || more->top > b->top) lift(b, more->top);
  below = b->top - more->top;
  for (int k = 0; k < 3 && below < 2; k++) {
    b->part[below][k] += more->part[0][k];
    if (!below) b->part[1][k] += more->part[1][k];
  }
}

void vg_grid_sum_value(const struct vg_grid_sum *b, double out[3])
{
  for (int k = 0; k < 3; k++)
    out[k] = ((double)b->part[0][k] * power(BITS) + (double)b->part[1][k]) *
             power(BITS * (b->top - 1));
}

/* --- figures -------------------------------------------------------------- */

/* Arc sine in degrees. Abramowitz and Stegun, 4.4.46: error 2e-8 rad. All
 * processors give the same bits, unlike those of libm. */
static double arc_sine(double x)
{
  static const double a[8] = { 1.5707963050,  -0.2145988016, 0.0889789874,
                               -0.0501743046, 0.0308918810,  -0.0170881256,
                               0.0066700901,  -0.0012624911 };
  double y = fabs(x) < 1 ? fabs(x) : 1, p = a[7];

  for (int i = 6; i >= 0; i--) p = p * y + a[i];
  p = 90 - DEGREE * sqrt(1 - y) * p;
  p = p > 0 ? p : 0;
  return x < 0 ? -p : p;
}

static void note(struct vg_places *list, uint32_t node, double value,
                 const double at[3])
{
  struct vg_worst_place p = { node, value, { at[0], at[1], at[2] } };

  if (vg_places_admit(list, value)) vg_places_add(list, &p);
}

void vg_dual_count_face(struct vg_stats *f, const struct vg_dual_face *face,
                        double sum[3])
{
  double s[3], e[3], at[3], area, scale, angle = -90;

  vg_grid_sum_value(&face->area, s);
  vg_sub(face->x[1], face->x[0], e);
  area = vg_norm(s);
  scale = area * vg_norm(e);
  if (scale > 0) angle = arc_sine(vg_dot(s, e) / scale);
  for (int k = 0; k < 3; k++) at[k] = 0.5 * face->x[0][k] + 0.5 * face->x[1][k];
  f->n.n_dual_face++;
  f->n.n_dual_opposed += angle <= 0;
  note(&f->places[VG_PLACES_DUAL + VG_WORST_DUAL_FACE], face->node[0], angle,
       at);
  sum[0] = angle * area;
  sum[1] = area;
  sum[2] = 0;
}

void vg_dual_count_point(struct vg_stats *f, const struct vg_dual_point *p)
{
  static const double limit[3] = { 1, 10, 20 };
  double sum[3], angle = -90;

  vg_grid_sum_value(&p->sum, sum);
  if (sum[1] > 0) angle = sum[0] / sum[1];
  f->n.n_dual_point++;
  for (int i = 0; i < 3; i++) f->n.dual_below[i] += angle < limit[i];
  note(&f->places[VG_PLACES_DUAL + VG_WORST_DUAL_POINT], p->node, angle, p->x);
  note(&f->places[VG_PLACES_DUAL + VG_WORST_DUAL_VOLUME], p->node,
       -(double)p->range[1] / (double)p->range[0], p->x);
}

/* --- sweep ---------------------------------------------------------------- */

/* Edges of a kind of cell, from a to b: the face that runs from a to b, and the
 * one that runs from b to a. */
struct cell_edges {
  int n;
  uint8_t a[MOST_EDGES], b[MOST_EDGES], face[MOST_EDGES][2];
};

struct dual {
  const struct vg_mesh *m;
  const struct vg_dual_shared *shared;
  struct vg_stats *f;
  struct cell_edges edges[VG_CELL_KINDS];
  uint32_t *end;             /* [n_point + 1] ends of the cells at each point */
  uint32_t *cell;            /* cells at points */
  uint32_t *slot;            /* [n_point] edge to this point, + 1; 0: none */
  struct vg_grid_sum *sum;   /* [n_point] */
  float (*range)[2];         /* [n_point] as in struct vg_dual_point */
  struct vg_dual_face *edge; /* edges at the present point */
  size_t n_edge, room;
};

static int width_of(int kind, int face)
{
  return face < vg_cell_faces[kind].n_tri ? 3 : 4;
}

static void add_sides(struct cell_edges *e, int kind, int face)
{
  const uint8_t *node = vg_cell_faces[kind].node[face];

  for (int i = 0, n = width_of(kind, face); i < n; i++) {
    uint8_t a = node[i], b = node[(i + 1) % n], from = a < b ? a : b;
    uint8_t to = a < b ? b : a;
    int k = 0;

    while (k < e->n && (e->a[k] != from || e->b[k] != to)) k++;
    if (k == e->n) e->n++;
    e->a[k] = from;
    e->b[k] = to;
    e->face[k][a > b] = (uint8_t)face;
  }
}

static void list_edges(struct dual *d)
{
  for (int kind = 0; kind < VG_CELL_KINDS; kind++)
    for (int j = 0; j < vg_cell_faces[kind].n_face; j++)
      add_sides(&d->edges[kind], kind, j);
}

/* Nodes of a cell, and its kind. */
static const uint32_t *nodes_of(const struct vg_mesh *m, size_t cell, int *kind)
{
  struct vg_cells c;

  *kind = VG_CELL_TET;
  if (cell < m->n_tet) return m->tet[cell];
  do c = vg_mesh_cells(m, ++*kind);
  while (cell - c.first >= c.n);
  return c.node + (cell - c.first) * (size_t)vg_cell_faces[*kind].n_node;
}

static void mean_of(const struct vg_mesh *m, const uint32_t *node,
                    const uint8_t *which, int n, double out[3])
{
  double scale = 1. / n;

  for (int k = 0; k < 3; k++) {
    double sum = 0;

    for (int i = 0; i < n; i++) sum += m->point[node[which ? which[i] : i]][k];
    out[k] = sum * scale;
  }
}

/* The part of the dual face of edge j in a cell with the centre g: the
 * triangles from the middle of the edge to g and to the centres of the two
 * faces. Out: its area vector, from a to b, and the volumes of the tetrahedra
 * from the triangles to a, which are also those to b. */
static void part_in(const struct dual *d, int kind, const uint32_t *node, int j,
                    const double g[3], double area[3], double volume[2])
{
  const struct cell_edges *e = &d->edges[kind];
  const double *a = d->m->point[node[e->a[j]]], *b = d->m->point[node[e->b[j]]];
  double middle[3], to[3], edge[3], twice[2][3];

  for (int k = 0; k < 3; k++) middle[k] = 0.5 * (a[k] + b[k]);
  vg_sub(g, middle, to);
  vg_sub(b, a, edge);
  for (int i = 0; i < 2; i++) {
    int face = e->face[j][i];
    double centre[3];

    mean_of(d->m, node, vg_cell_faces[kind].node[face], width_of(kind, face),
            centre);
    vg_sub(centre, middle, centre);
    vg_cross(to, centre, twice[i]);
    volume[i] = fabs(vg_dot(edge, twice[i])) / 12;
  }
  for (int k = 0; k < 3; k++) area[k] = 0.5 * (twice[0][k] - twice[1][k]);
}

static void widen(float range[2], double volume)
{
  float v = (float)volume;

  if (v < range[0]) range[0] = v;
  if (v > range[1]) range[1] = v;
}

/* The edge from v to w. */
static struct vg_dual_face *edge_to(struct dual *d, uint32_t v, uint32_t w)
{
  struct vg_dual_face *e;

  if (d->slot[w]) return &d->edge[d->slot[w] - 1];
  if (vg_reserve(&d->edge, &d->room, d->n_edge + 1, sizeof *d->edge))
    return NULL;
  e = &d->edge[d->n_edge++];
  memset(e, 0, sizeof *e);
  e->node[0] = v;
  e->node[1] = w;
  d->slot[w] = (uint32_t)d->n_edge;
  return e;
}

static vg_status add_cell(struct dual *d, uint32_t v, size_t cell,
                          struct vg_error *err)
{
  int kind;
  const uint32_t *node = nodes_of(d->m, cell, &kind);
  const struct cell_edges *e = &d->edges[kind];
  double g[3], area[3], volume[2];

  mean_of(d->m, node, NULL, vg_cell_faces[kind].n_node, g);
  for (int j = 0; j < e->n; j++) {
    uint32_t a = node[e->a[j]], b = node[e->b[j]];
    struct vg_dual_face *to;

    if ((a < b ? a : b) != v) continue;
    to = edge_to(d, v, a < b ? b : a);
    if (!to) return vg_fail_memory(err, "the median dual");
    part_in(d, kind, node, j, g, area, volume);
    for (int i = 0; i < 2; i++) {
      widen(d->range[a], volume[i]);
      widen(d->range[b], volume[i]);
    }
    for (int k = 0; k < 3 && a != v; k++) area[k] = -area[k];
    vg_grid_sum_add(&to->area, area);
  }
  return VG_OK;
}

/* Name an edge by points of the mesh, the lower one first. */
static void complete(const struct dual *d, struct vg_dual_face *e)
{
  const uint32_t *id = d->shared ? d->shared->id : NULL;
  uint32_t a = e->node[0], b = e->node[1];
  int turn = id && id[a] > id[b];

  memcpy(e->x[turn], d->m->point[a], sizeof e->x[0]);
  memcpy(e->x[!turn], d->m->point[b], sizeof e->x[0]);
  if (!id) return;
  e->node[turn] = id[a];
  e->node[!turn] = id[b];
  for (int i = 0; i < 6 && turn; i++)
    e->area.part[i / 3][i % 3] = -e->area.part[i / 3][i % 3];
}

static vg_status measure_edges(struct dual *d, struct vg_error *err)
{
  const struct vg_dual_shared *s = d->shared;

  for (size_t i = 0; i < d->n_edge; i++) {
    struct vg_dual_face *e = &d->edge[i], *to;
    uint32_t v = e->node[0], w = e->node[1];
    double sum[3];

    d->slot[w] = 0;
    complete(d, e);
    if (s && s->is_open[v] && s->is_open[w]) {
      to = vg_item_blocks_add(s->face, sizeof *to);
      if (!to) return vg_fail_memory(err, "the median dual");
      *to = *e;
      continue;
    }
    vg_dual_count_face(d->f, e, sum);
    vg_grid_sum_add(&d->sum[v], sum);
    vg_grid_sum_add(&d->sum[w], sum);
  }
  d->n_edge = 0;
  return VG_OK;
}

static vg_status measure_points(struct dual *d, struct vg_error *err)
{
  const struct vg_dual_shared *s = d->shared;

  for (uint32_t v = 0; v < d->m->n_point; v++) {
    struct vg_dual_point p = { .node = s ? s->id[v] : v, .sum = d->sum[v] };
    struct vg_dual_point *to;

    if (d->end[v] == d->end[v + 1]) continue; /* no cells */
    memcpy(p.x, d->m->point[v], sizeof p.x);
    memcpy(p.range, d->range[v], sizeof p.range);
    if (!s || !s->is_open[v]) {
      vg_dual_count_point(d->f, &p);
      continue;
    }
    to = vg_item_blocks_add(s->point, sizeof *to);
    if (!to) return vg_fail_memory(err, "the median dual");
    *to = p;
  }
  return VG_OK;
}

static size_t n_corner(const struct vg_mesh *m)
{
  return 4 * m->n_tet + 5 * m->n_pyr + 6 * m->n_pri + 8 * m->n_hex;
}

size_t vg_dual_bytes(const struct vg_mesh *m)
{
  return n_corner(m) * sizeof(uint32_t) +
         m->n_point * (4 * sizeof(uint32_t) + sizeof(struct vg_grid_sum));
}

/* Enter the cells at their points, in ascending order. */
static vg_status enter_cells(struct dual *d, struct vg_error *err)
{
  const struct vg_mesh *m = d->m;
  size_t n_entry = n_corner(m);
  uint32_t *at;

  if (n_entry > UINT32_MAX)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "the cells are too many for the median dual");
  d->end = vg_calloc(m->n_point + 2, sizeof *d->end);
  d->cell = vg_alloc(n_entry, sizeof *d->cell);
  d->slot = vg_calloc(m->n_point, sizeof *d->slot);
  d->sum = vg_calloc(m->n_point, sizeof *d->sum);
  d->range = vg_calloc(m->n_point, sizeof *d->range);
  if (!d->end || !d->cell || !d->slot || !d->sum || !d->range)
    return vg_fail_memory(err, "the median dual");
  for (size_t v = 0; v < m->n_point; v++) d->range[v][0] = INFINITY;
  at = d->end + 1; /* at[v] becomes the end of v, the beginning of v + 1 */
  for (int pass = 0; pass < 2; pass++) {
    for (int kind = 0; kind < VG_CELL_KINDS; kind++) {
      struct vg_cells c = vg_mesh_cells(m, kind);
      size_t width = (size_t)vg_cell_faces[kind].n_node;

      for (size_t i = 0; i < c.n * width; i++)
        if (pass) d->cell[at[c.node[i]]++] = (uint32_t)(c.first + i / width);
        else at[c.node[i] + 1]++;
    }
    for (size_t v = 1; v <= m->n_point && !pass; v++) at[v] += at[v - 1];
  }
  return VG_OK;
}

vg_status vg_dual_measure(const struct vg_mesh *m,
                          const struct vg_dual_shared *shared,
                          struct vg_stats *f, struct vg_error *err)
{
  assert(m && f);

  struct dual d = { .m = m, .shared = shared, .f = f };
  vg_status st;

  list_edges(&d);
  VG_TRY(enter_cells(&d, err));
  for (uint32_t v = 0; v < m->n_point; v++) {
    for (size_t i = d.end[v]; i < d.end[v + 1]; i++)
      VG_TRY(add_cell(&d, v, d.cell[i], err));
    VG_TRY(measure_edges(&d, err));
  }
  st = measure_points(&d, err);
done:
  free(d.end);
  free(d.cell);
  free(d.slot);
  free(d.sum);
  free(d.range);
  free(d.edge);
  return st;
}

vg_status vg_mesh_judge_dual(const struct vg_mesh *m,
                             struct vg_mesh_report *report,
                             struct vg_error *err)
{
  assert(m && report);

  struct vg_stats *f;
  vg_status st;

  if (!report->is_valid) return VG_OK;
  f = vg_stats_new();
  if (!f) return vg_fail_memory(err, "the median dual");
  VG_TRY(vg_dual_measure(m, NULL, f, err));
  report->has_dual = 1;
  vg_stats_report_dual(f, &report->dual);
done:
  free(f);
  return st;
}
