/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "run/picture/decimate.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/memory.h"
#include "base/table.h"
#include "core/geometry/vector.h"

#define COARSER 1.25 /* Factor to the next lattice if one is too fine. */
#define LEFT 3       /* Triangles per square of a lattice. */

void vg_decimated_release(struct vg_decimated *c)
{
  free(c->point);
  free(c->tri);
  free(c->from);
  *c = (struct vg_decimated)VG_DECIMATED_INIT;
}

/* Cubes that contain points, numbered in the order of their first points. */
struct cubes {
  struct vg_table table;
  uint64_t *key;   /* [n_cube] position in the lattice. */
  uint32_t *of;    /* [n_point] cube of each point. */
  uint32_t *count; /* [n_cube] number of points. */
};

static void release(struct cubes *q)
{
  vg_table_release(&q->table);
  free(q->key);
  free(q->of);
  free(q->count);
}

static vg_status reserve(const struct vg_mesh *m, struct cubes *q,
                         struct vg_decimated *c, struct vg_error *err)
{
  int bad = vg_table_init(&q->table, m->n_point);

  q->key = vg_alloc(m->n_point, sizeof *q->key);
  q->of = vg_alloc(m->n_point, sizeof *q->of);
  q->count = vg_alloc(m->n_point, sizeof *q->count);
  c->point = vg_alloc(m->n_point, sizeof *c->point);
  c->tri = vg_alloc(m->n_tri, sizeof *c->tri);
  c->from = vg_alloc(m->n_tri, sizeof *c->from);
  return !bad && q->key && q->of && q->count && c->point && c->tri && c->from
         ? VG_OK
         : vg_fail_memory(err, "a coarser surface");
}

static uint64_t key_of(const double x[3], const double lo[3], double step)
{
  uint64_t key = 0;

  for (int k = 0; k < 3; k++) {
    double at = (x[k] - lo[k]) / step;

    key = key << 21 | (uint64_t)(at < 2097151 ? at : 2097151);
  }
  return key;
}

static uint32_t find(struct cubes *q, uint64_t key, size_t *n)
{
  uint32_t *at;

  VG_TABLE_FIND(&q->table, at, vg_hash_1(key), q->key[*at] == key);
  if (*at == VG_TABLE_FREE) {
    q->key[*n] = key;
    *at = (uint32_t)(*n)++;
  }
  return *at;
}

static void merge_points(const struct vg_mesh *m, const double lo[3],
                         double step, struct cubes *q, struct vg_decimated *c)
{
  vg_table_clear(&q->table);
  memset(q->count, 0, m->n_point * sizeof *q->count);
  memset(c->point, 0, m->n_point * sizeof *c->point);
  c->n_point = 0;
  for (size_t i = 0; i < m->n_point; i++) {
    uint32_t id = find(q, step > 0 ? key_of(m->point[i], lo, step) : i,
                       &c->n_point);

    q->of[i] = id;
    q->count[id]++;
    for (int k = 0; k < 3; k++) c->point[id][k] += m->point[i][k];
  }
  for (size_t i = 0; i < c->n_point; i++)
    for (int k = 0; k < 3; k++) c->point[i][k] /= q->count[i];
}

static void keep_triangles(const struct vg_mesh *m, const struct cubes *q,
                           struct vg_decimated *c)
{
  c->n_tri = 0;
  for (size_t t = 0; t < m->n_tri; t++) {
    uint32_t n[3];

    for (int k = 0; k < 3; k++) n[k] = q->of[m->tri[t][k]];
    if (n[0] == n[1] || n[1] == n[2] || n[2] == n[0]) continue;
    memcpy(c->tri[c->n_tri], n, sizeof n);
    c->from[c->n_tri++] = (uint32_t)t;
  }
}

static double area_of(const struct vg_mesh *m, size_t t)
{
  return vg_triangle_area(m->point[m->tri[t][0]], m->point[m->tri[t][1]],
                          m->point[m->tri[t][2]]);
}

/* Estimated number of triangles that a lattice leaves: those larger than its
 * cubes, and about LEFT for each of its squares that smaller ones cover.
 * Samples every stride-th triangle. */
static double expected(const struct vg_mesh *m, size_t stride, double step)
{
  double n = 0;

  for (size_t t = 0; t < m->n_tri; t += stride)
    n += fmin(1, LEFT * area_of(m, t) / (step * step));
  return n * (double)stride;
}

/* Lower bound of the step. */
static double first_step(const struct vg_mesh *m, size_t n)
{
  size_t stride = 1 + m->n_tri / 20000;
  double step = INFINITY;

  for (size_t t = 0; t < m->n_tri; t += stride)
    if (area_of(m, t) > 0) step = fmin(step, sqrt(area_of(m, t)));
  if (!(step > 0 && step < INFINITY)) step = 1e-300;
  while (expected(m, stride, step) > (double)n) step *= COARSER;
  return step;
}

vg_status vg_decimate(const struct vg_mesh *m, size_t n_most,
                      struct vg_decimated *out, struct vg_error *err)
{
  struct cubes q = { .table = VG_TABLE_INIT };
  struct vg_decimated c = VG_DECIMATED_INIT;
  double lo[3], hi[3];
  vg_status st = reserve(m, &q, &c, err);

  if (st >= 0) {
    vg_mesh_bounds(m, lo, hi);
    merge_points(m, lo, 0, &q, &c);
    keep_triangles(m, &q, &c);
    while (c.n_tri > n_most) {
      c.step = c.step > 0 ? COARSER * c.step : first_step(m, n_most);
      merge_points(m, lo, c.step, &q, &c);
      keep_triangles(m, &q, &c);
    }
    vg_decimated_release(out);
    *out = c;
  } else {
    vg_decimated_release(&c);
  }
  release(&q);
  return st;
}
