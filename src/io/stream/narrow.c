/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "io/stream/narrow.h"

#include <assert.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/judge/quality.h"

static const char *const cell_name[] = { "tetrahedron", "pyramid", "prism",
                                         "hexahedron" };
static const int cell_width[] = { 4, 5, 6, 8 };

void vg_narrow_round(size_t n, const double (*x)[3], double (*rounded)[3])
{
  assert((x && rounded) || !n);
  for (size_t i = 0; i < n; i++)
    for (int k = 0; k < 3; k++) rounded[i][k] = (double)(float)x[i][k];
}

/* Order by kind, then by number. */
static int is_before(const struct vg_narrow *a, const struct vg_narrow *b)
{
  return a->kind != b->kind ? a->kind < b->kind : a->cell < b->cell;
}

void vg_narrow_add(struct vg_narrow *to, const struct vg_narrow *more)
{
  assert(to && more);
  if (!more->n_cell) return;
  if (!to->n_cell || is_before(more, to)) {
    to->kind = more->kind;
    to->cell = more->cell;
    memcpy(to->at, more->at, sizeof to->at);
  }
  to->n_cell += more->n_cell;
}

void vg_narrow_cells(const double (*x)[3], const double (*rounded)[3], int kind,
                     size_t n, const uint32_t *node, uint64_t first,
                     struct vg_narrow *to)
{
  assert(kind >= 0 && kind < 4 && to);
  assert((x && rounded && node) || !n);

  int width = cell_width[kind];

  for (size_t i = 0; i < n; i++) {
    const uint32_t *v = node + i * (size_t)width;
    struct vg_narrow one = { .n_cell = 1,
                             .kind = (uint64_t)kind,
                             .cell = first + i };

    if (vg_cell_positive(rounded, kind, v) || !vg_cell_positive(x, kind, v))
      continue;
    for (int k = 0; k < width; k++)
      for (int c = 0; c < 3; c++) one.at[c] += x[v[k]][c] / width;
    vg_narrow_add(to, &one);
  }
}

struct place {
  float x[3];
  uint32_t point;
};

static int by_place(const void *a, const void *b)
{
  const struct place *p = a, *q = b;

  for (int k = 0; k < 3; k++)
    if (p->x[k] < q->x[k] || p->x[k] > q->x[k])
      return p->x[k] < q->x[k] ? -1 : 1;
  return p->point < q->point ? -1 : p->point > q->point;
}

static int is_same(const struct place *p, const struct place *q)
{
  return p->x[0] == q->x[0] && p->x[1] == q->x[1] && p->x[2] == q->x[2];
}

static void note_point(struct vg_narrow *to, uint32_t point, const double x[3])
{
  if (!to->n_point++ || point < to->point) {
    to->point = point;
    memcpy(to->x, x, sizeof to->x);
  }
}

vg_status vg_narrow_points(size_t n, const double (*x)[3], struct vg_narrow *to,
                           struct vg_error *err)
{
  assert((x || !n) && to);

  struct place *p = vg_alloc(n, sizeof *p);

  if (!p) return vg_fail_memory(err, "the points of a file");
  for (size_t i = 0; i < n; i++) {
    for (int k = 0; k < 3; k++) p[i].x[k] = (float)x[i][k];
    p[i].point = (uint32_t)i;
  }
  if (n) qsort(p, n, sizeof *p, by_place);
  for (size_t i = 0, first = 0; i < n; i++) {
    const double *a, *b = x[p[i].point];

    if (!is_same(&p[i], &p[first])) first = i;
    a = x[p[first].point];
    if (a[0] != b[0] || a[1] != b[1] || a[2] != b[2])
      note_point(to, p[i].point, b);
  }
  free(p);
  return VG_OK;
}

vg_status vg_narrow_share(struct vg_comm *comm, struct vg_narrow *n,
                          struct vg_error *err)
{
  size_t size = (size_t)vg_comm_size(comm);
  struct vg_bytes mine = { sizeof *n, (unsigned char *)n };
  struct vg_bytes *all = vg_calloc(size, sizeof *all);
  struct vg_narrow sum = VG_NARROW_INIT;
  vg_status st = all ? VG_OK : vg_fail_memory(err, "the cells of a file");

  VG_TRY(vg_comm_agree(comm, st, err));
  VG_TRY(vg_comm_allgather(comm, &mine, all, err));
  for (size_t r = 0; r < size; r++) {
    struct vg_narrow part;

    memcpy(&part, all[r].data, sizeof part);
    vg_narrow_add(&sum, &part);
  }
  *n = sum;
done:
  vg_bytes_release(all, size);
  return st;
}

vg_status vg_narrow_accept(const struct vg_narrow *n, const char *kind,
                           const char *instead, struct vg_error *err)
{
  char cells[200] = "", points[200] = "";

  assert(kind && instead);
  if (!n->n_cell && !n->n_point) return VG_OK;
  if (n->n_cell)
    snprintf(cells, sizeof cells,
             "%" PRIu64 " flat or inverted cell%s, the first %s %" PRIu64
             " at (%.9g, %.9g, %.9g)",
             n->n_cell, n->n_cell > 1 ? "s" : "", cell_name[n->kind],
             n->cell + 1, n->at[0], n->at[1], n->at[2]);
  if (n->n_point)
    snprintf(points, sizeof points,
             "%s%" PRIu64 " coincident point%s, the first %" PRIu64
             " (%.9g, %.9g, %.9g)",
             n->n_cell ? ", and " : "", n->n_point, n->n_point > 1 ? "s" : "",
             n->point + 1, n->x[0], n->x[1], n->x[2]);
  return vg_fail(err, VG_ERR_GEOMETRY,
                 "with the 4-byte reals of a .%s.ugrid the mesh would have "
                 "%s%s, which no solver can use; write 8-byte reals, as in "
                 ".%s.ugrid, or move the geometry closer to the origin",
                 kind, cells, points, instead);
}
