/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Prepares the search for opposite surfaces: the face and columns on each
 * triangle, normals and their bounding boxes, and an order of the columns that
 * keeps neighbours together. */
#include "layers/clear/clear_ahead.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "core/geometry/vector.h"
#include "core/mesh/copies.h"

#define SHARP 0.5 /* L11: cosine between a column and its triangle. */

enum { GRAIN = 512 };

void vg_ahead_release(struct vg_ahead *x)
{
  free(x->face_of);
  free(x->column_of);
  free(x->first);
  free(x->slid);
  free(x->sides);
  free(x->order);
  free(x->normal);
  vg_boxes_release(&x->boxes);
}

void vg_add_direction(const struct vg_column *c, double sum[3])
{
  double l = sqrt(vg_dot(c->dir, c->dir));

  if (l > 0)
    for (int k = 0; k < 3; k++) sum[k] += c->dir[k] / l;
}

/* Two sharp edges that point at each other face each other with their columns,
 * but not with their triangles, whose normals n are perpendicular to that
 * direction. Such columns lean out of the triangle, so n is turned towards
 * them. */
static void turn_to_edge(const struct vg_ahead *x, size_t tri, double n[3])
{
  double(*p)[3] = x->surface->point, out[3] = { 0, 0, 0 }, l;
  const uint32_t *t = x->surface->tri[tri];
  uint32_t f = x->face_of[tri];

  if (f == VG_NO_INDEX) return;
  for (int k = 0; k < 3; k++) {
    const struct vg_column *c = &x->columns->column[x->columns->face[f][k]];
    double unit[3] = { 0, 0, 0 }, lean = 0;

    vg_add_direction(c, unit);
    for (int j = 0; j < 3; j++)
      lean += unit[j] *
              (2 * p[t[k]][j] - p[t[(k + 1) % 3]][j] - p[t[(k + 2) % 3]][j]);
    if (lean > 0 && vg_dot(unit, n) < SHARP) vg_add_direction(c, out);
  }
  for (int k = 0; k < 3; k++) n[k] += out[k];
  l = sqrt(vg_dot(n, n));
  for (int k = 0; l > 0 && k < 3; k++) n[k] /= l;
}

static void measure_normals(void *context, size_t first, size_t end, int worker)
{
  struct vg_ahead *x = context;
  double(*p)[3] = x->surface->point;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    const uint32_t *t = x->boxes.tri[i];
    double e[3], f[3], n[3], l;

    for (int k = 0; k < 3; k++) {
      e[k] = p[t[1]][k] - p[t[0]][k];
      f[k] = p[t[2]][k] - p[t[0]][k];
    }
    vg_cross(e, f, n);
    l = sqrt(vg_dot(n, n));
    for (int k = 0; k < 3; k++) n[k] = l > 0 ? n[k] / l : 0;
    if (l > 0) turn_to_edge(x, x->boxes.item[i], n);
    for (int k = 0; k < 3; k++) x->normal[i][k] = (float)n[k];
  }
}

static void range_of(const float *lo, const float *hi,
                     struct vg_normal_boxes *s, int i)
{
  for (int k = 0; k < 3; k++) {
    s->mid[k].f[i] = 0.5f * (lo[k] + hi[k]);
    s->half[k].f[i] = 0.5f * (hi[k] - lo[k]);
  }
}

/* Empty children face nothing: mid - half is NaN. */
static void measure_child(struct vg_ahead *x, int level, size_t j, int i)
{
  const struct vg_boxes *b = &x->boxes;
  size_t node = b->first[level] + j, child = 8 * j + (size_t)i;
  float lo[3] = { INFINITY, INFINITY, INFINITY };
  float hi[3] = { -INFINITY, -INFINITY, -INFINITY }, d = 0;
  struct vg_normal_boxes *s = &x->sides[node];

  for (int k = 0; k < 3; k++) {
    float h = 0.5f * (b->node[node].hi[k].f[i] - b->node[node].lo[k].f[i]);

    d += h * h;
  }
  s->radius.f[i] = sqrtf(d);
  if (!level && child < b->n) {
    range_of(x->normal[child], x->normal[child], s, i);
    return;
  }
  if (level && b->first[level - 1] + child < b->first[level]) {
    const struct vg_normal_boxes
      *below = &x->sides[b->first[level - 1] + child];

    for (int l = 0; l < 8; l++)
      for (int k = 0; k < 3; k++) {
        float m = below->mid[k].f[l], h = below->half[k].f[l];

        if (m - h < lo[k]) lo[k] = m - h;
        if (m + h > hi[k]) hi[k] = m + h;
      }
  }
  range_of(lo, hi, s, i);
}

struct level {
  struct vg_ahead *x;
  int level;
};

static void measure_level(void *context, size_t first, size_t end, int worker)
{
  const struct level *l = context;

  (void)worker;
  for (size_t j = first; j < end; j++)
    for (int i = 0; i < 8; i++) measure_child(l->x, l->level, j, i);
}

static void measure_sides(struct vg_ahead *x, size_t n_node, int threads)
{
  const struct vg_boxes *b = &x->boxes;

  vg_parallel_for(threads, b->n, GRAIN, measure_normals, x);
  for (int i = 0; i < b->n_level; i++) {
    struct level l = { x, i };
    size_t end = i + 1 < b->n_level ? b->first[i + 1] : n_node;

    vg_parallel_for(threads, end - b->first[i], GRAIN, measure_level, &l);
  }
}

/* Orders columns as their faces in the tree; columns without a face come
 * last. */
static vg_status order_columns(struct vg_ahead *x, struct vg_error *err)
{
  const struct vg_columns *c = x->columns;
  uint8_t *seen = vg_calloc(c->n_column, 1);
  size_t n = 0;

  if (!seen) return vg_fail_memory(err, "an order of the columns");
  for (size_t i = 0; i < x->boxes.n; i++) {
    uint32_t f = x->face_of[x->boxes.item[i]];

    for (int k = 0; k < 3 && f != VG_NO_INDEX; k++) {
      uint32_t column = c->face[f][k];

      if (!seen[column]) x->order[n++] = column;
      seen[column] = 1;
    }
  }
  for (size_t i = 0; i < c->n_column; i++)
    if (!seen[i]) x->order[n++] = (uint32_t)i;
  free(seen);
  return VG_OK;
}

/* Columns are sorted by root: those of point p are column_of[p] to column_of[p
 * + 1] - 1. */
static void index_columns(struct vg_ahead *x)
{
  const struct vg_columns *c = x->columns;
  const struct vg_mesh *m = x->surface;
  size_t i = 0;

  for (size_t p = 0; p <= m->n_point; p++) {
    while (i < c->n_column && c->column[i].root < p) i++;
    x->column_of[p] = (uint32_t)i;
  }
  for (size_t t = 0; t < m->n_tri; t++) x->face_of[t] = VG_NO_INDEX;
  for (size_t f = 0; f < c->n_face; f++)
    if (c->face_tri[f] != VG_NO_INDEX) x->face_of[c->face_tri[f]] = (uint32_t)f;
  for (i = 0; i < c->n_column; i++)
    for (int k = 0; k < 2; k++)
      if (c->column[i].slide[k] < m->n_patch)
        x->slid[c->column[i].slide[k]] = 1;
}

vg_status vg_ahead_prepare(struct vg_ahead *x, int threads,
                           struct vg_error *err)
{
  assert(x->surface && x->columns && x->topology && x->gap > 0);

  const struct vg_mesh *m = x->surface;
  struct vg_boxes *b = &x->boxes;
  vg_status st;
  size_t n_node;

  st = vg_boxes_build(b, (const double(*)[3])m->point,
                      (const uint32_t(*)[3])m->tri, m->n_tri, NULL, 0, threads,
                      err);
  if (st < 0) return st;
  n_node = b->n ? b->first[b->n_level - 1] + 1 : 0;
  x->face_of = vg_alloc(m->n_tri, sizeof *x->face_of);
  x->column_of = vg_alloc(m->n_point + 1, sizeof *x->column_of);
  x->slid = vg_calloc(m->n_patch, 1);
  x->sides = vg_alloc(n_node, sizeof *x->sides);
  x->normal = vg_alloc(b->n, sizeof *x->normal);
  x->order = vg_alloc(x->columns->n_column, sizeof *x->order);
  if (!x->face_of || !x->column_of || !x->slid || !x->sides || !x->normal ||
      !x->order)
    return vg_fail_memory(err, "the search for surfaces opposite the layers");
  st = vg_mesh_inner_points(m, &x->first, err);
  if (st < 0) return st;
  index_columns(x);
  measure_sides(x, n_node, threads);
  return order_columns(x, err);
}
