/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "io/cgns/cgns_block.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

void vg_cgns_block_release(struct vg_cgns_block *b)
{
  for (int k = 0; k < 3; k++) free(b->x[k]);
  free(b->point);
  memset(b, 0, sizeof *b);
}

/* The other two axes, in cyclic order: u x v is along the axis. */
static void other_axes(int axis, int *u, int *v)
{
  *u = (axis + 1) % 3;
  *v = (axis + 2) % 3;
}

int vg_cgns_range_is_thin(const struct vg_cgns_range *range, int axis)
{
  int u, v;

  assert(axis >= 0 && axis < 3);
  other_axes(axis, &u, &v);
  return range->lo[u] == range->hi[u] || range->lo[v] == range->hi[v];
}

size_t vg_cgns_block_cells(const struct vg_cgns_block *b, int axis)
{
  int u, v;

  assert(axis >= 0 && axis < 3 && b->n[axis] == 1);
  other_axes(axis, &u, &v);
  return (size_t)(b->n[u] - 1) * (size_t)(b->n[v] - 1);
}

void vg_cgns_block_mark(const struct vg_cgns_block *b,
                        const struct vg_cgns_range *range, int axis,
                        uint32_t patch, uint32_t *cell)
{
  int u, v;

  assert(axis >= 0 && axis < 3 && b->n[axis] == 1 && cell);
  other_axes(axis, &u, &v);
  for (int64_t j = range->lo[v]; j < range->hi[v]; j++)
    for (int64_t i = range->lo[u]; i < range->hi[u]; i++)
      cell[(j - 1) * (b->n[u] - 1) + i - 1] = patch;
}

static size_t place(const struct vg_cgns_block *b, const int64_t at[3])
{
  return (size_t)(at[0] - 1 + b->n[0] * (at[1] - 1 + b->n[1] * (at[2] - 1)));
}

/* Vertices of the face with the lowest indices at[], counter-clockwise around
 * the axis. */
static void corners(const struct vg_cgns_block *b, const int64_t at[3],
                    int axis, size_t corner[4])
{
  int64_t to[3] = { at[0], at[1], at[2] };
  int u, v;

  other_axes(axis, &u, &v);
  corner[0] = place(b, to);
  to[u]++;
  corner[1] = place(b, to);
  to[v]++;
  corner[2] = place(b, to);
  to[u]--;
  corner[3] = place(b, to);
}

static double diagonal2(const struct vg_cgns_block *b, size_t p, size_t q)
{
  double sum = 0;

  for (int k = 0; k < 3; k++)
    sum += (b->x[k][p] - b->x[k][q]) * (b->x[k][p] - b->x[k][q]);
  return sum;
}

static vg_status take_point(struct vg_cgns_block *b, size_t i,
                            struct vg_soup *soup, struct vg_error *err)
{
  const double x[3] = { b->x[0][i], b->x[1][i], b->x[2][i] };

  if (b->point[i] != UINT32_MAX) return VG_OK;
  return vg_soup_weld(soup, x, &b->point[i], err);
}

static vg_status take_face(struct vg_cgns_block *b, const int64_t at[3],
                           int axis, int turned, uint32_t patch,
                           struct vg_soup *soup, struct vg_error *err)
{
  size_t c[4];
  int first;
  vg_status st = VG_OK;

  corners(b, at, axis, c);
  for (int k = 0; k < 4 && st >= 0; k++) st = take_point(b, c[k], soup, err);
  first = diagonal2(b, c[1], c[3]) < diagonal2(b, c[0], c[2]);
  for (int k = first; k < 4 && st >= 0; k += 2) {
    const uint32_t p = b->point[c[k]], q = b->point[c[(k + 1) % 4]];
    const uint32_t r = b->point[c[(k + 2) % 4]];
    const uint32_t node[3] = { p, turned ? r : q, turned ? q : r };

    if (p == q || q == r || r == p) continue;
    st = vg_soup_triangle(soup, node, patch, err);
  }
  return st;
}

vg_status vg_cgns_block_surface(struct vg_cgns_block *b, int axis,
                                const uint32_t *cell, struct vg_soup *soup,
                                struct vg_error *err)
{
  int64_t at[3] = { 1, 1, 1 };
  vg_status st = VG_OK;
  int u, v;

  assert(axis >= 0 && axis < 3 && b->n[axis] == 1 && cell);
  other_axes(axis, &u, &v);
  for (at[v] = 1; at[v] < b->n[v]; at[v]++)
    for (at[u] = 1; at[u] < b->n[u] && st >= 0; at[u]++)
      st = take_face(b, at, axis, 0, *cell++, soup, err);
  return st;
}

/* Six times the volume between the face and the next layer of points, negative
 * if the face points out of the block. */
static double look(const struct vg_cgns_block *b, const int64_t at[3], int axis)
{
  int64_t next[3] = { at[0], at[1], at[2] };
  double d[2][3], to[3] = { 0, 0, 0 }, n[3], sum = 0;
  size_t c[4], inner[4];

  next[axis] += at[axis] == 1 ? 1 : -1;
  corners(b, at, axis, c);
  corners(b, next, axis, inner);
  for (int k = 0; k < 3; k++) {
    const double *x = b->x[k];

    d[0][k] = x[c[2]] - x[c[0]];
    d[1][k] = x[c[3]] - x[c[1]];
    for (int i = 0; i < 4; i++) to[k] += x[inner[i]] - x[c[i]];
  }
  for (int k = 0; k < 3; k++) {
    int i = (k + 1) % 3, j = (k + 2) % 3;

    n[k] = d[0][i] * d[1][j] - d[0][j] * d[1][i];
    sum += n[k] * to[k];
  }
  return sum;
}

vg_status vg_cgns_block_boundary(struct vg_cgns_block *b,
                                 const struct vg_cgns_range *range, int axis,
                                 uint32_t patch, struct vg_soup *soup,
                                 struct vg_error *err)
{
  int64_t at[3] = { range->lo[0], range->lo[1], range->lo[2] };
  double sum = 0;
  vg_status st = VG_OK;
  int u, v;

  assert(axis >= 0 && axis < 3 && range->lo[axis] == range->hi[axis]);
  other_axes(axis, &u, &v);
  for (at[v] = range->lo[v]; at[v] < range->hi[v]; at[v]++)
    for (at[u] = range->lo[u]; at[u] < range->hi[u]; at[u]++)
      sum += look(b, at, axis);
  for (at[v] = range->lo[v]; at[v] < range->hi[v]; at[v]++)
    for (at[u] = range->lo[u]; at[u] < range->hi[u] && st >= 0; at[u]++)
      st = take_face(b, at, axis, sum < 0, patch, soup, err);
  return st;
}
