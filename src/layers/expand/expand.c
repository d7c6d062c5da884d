/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Numbers and coordinates of the points of columns. Cells are in
 * expand_cells.c. */
#include "layers/expand/expand.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "layers/expand/expand_parts.h"
#include "layers/expand/join.h"
#include "layers/expand/pairs.h"

#define COLUMN_GRAIN 512

static void mark_columns(struct vg_expand *e)
{
  const struct vg_columns *c = e->columns;

  for (size_t i = 0; i < c->n_column; i++) {
    e->mark[i] = c->column[i].n;
    if (vg_shares_root(c, i)) e->mark[i] |= VG_MARK_SHARED;
  }
  for (size_t r = 0; r < c->n_border; r++)
    for (int k = 0; k < 2; k++) e->mark[c->border[r][k]] |= VG_MARK_FLANK;
  for (size_t i = 0; i < c->n_column; i++)
    e->n_point[vg_mark_group(e->mark[i])] += vg_mark_n(e->mark[i]);
}

static vg_status reserve(struct vg_expand *e, struct vg_error *err)
{
  size_t n = e->columns->n_column;
  int refused;

  e->n_block = (e->columns->n_face + VG_FACE_BLOCK - 1) / VG_FACE_BLOCK;
  e->mark = vg_alloc(n, sizeof *e->mark);
  e->foot = vg_alloc(n, sizeof *e->foot);
  e->base = vg_alloc(n, sizeof *e->base);
  e->inner = vg_calloc(e->n_block + 1, sizeof *e->inner);
  refused = !e->mark || !e->foot || !e->base || !e->inner;
  for (int k = 0; k < VG_N_KIND; k++) {
    e->cell[k] = vg_calloc(e->n_block + 1, sizeof *e->cell[k]);
    refused |= !e->cell[k];
  }
  return refused ? vg_fail_memory(err, "the numbers of layer points and cells")
                 : VG_OK;
}

vg_status vg_expand_open(struct vg_expand *e, const struct vg_mesh *surface,
                         const struct vg_columns *columns,
                         enum vg_layer_cells cells, int threads,
                         struct vg_error *err)
{
  vg_status st;

  assert(e && columns && threads >= 0);
  memset(e, 0, sizeof *e);
  e->columns = columns;
  e->mixed = cells != VG_LAYER_TETS;
  e->threads = threads;
  for (size_t i = 0; i < columns->n_column; i++)
    if (columns->column[i].n > VG_LEVELS_MAX)
      return vg_fail(err, VG_ERR_INPUT,
                     "the column on point %zu has %u levels, but at most %d "
                     "are supported",
                     (size_t)columns->column[i].root + 1, columns->column[i].n,
                     VG_LEVELS_MAX);
  st = reserve(e, err);
  if (st >= 0) {
    mark_columns(e);
    if (e->mixed) st = vg_pairs_find(e, surface, err);
    if (st >= 0 && cells == VG_LAYER_HEX)
      st = vg_pairs_find_wall(e, surface, err);
    e->n_point[VG_INNER] += e->n_pair;
  }
  if (st < 0) vg_expand_close(e);
  return st;
}

void vg_expand_close(struct vg_expand *e)
{
  free(e->mark);
  free(e->foot);
  free(e->base);
  free(e->inner);
  for (int k = 0; k < VG_N_KIND; k++) free(e->cell[k]);
  free(e->partner);
  free(e->middle);
  memset(e, 0, sizeof *e);
}

/* Sequential, because the number of a column depends on all columns before it.
 * Takes a few nanoseconds per face, regardless of its levels. */
static void number_columns(struct vg_expand *e, const size_t first[2])
{
  const struct vg_columns *c = e->columns;
  size_t next[2] = { first[0], first[1] };
  uint32_t column[4];
  int n;

  memset(e->base, 0xff, c->n_column * sizeof *e->base);
  for (size_t i = 0; i < c->n_face; i++) {
    if (i % VG_FACE_BLOCK == 0) e->inner[i / VG_FACE_BLOCK] = next[VG_INNER];
    n = vg_expand_corners(e, i, column);
    for (int k = 0; k < n; k++) {
      uint32_t at = column[k];
      uint16_t mark = e->mark[at];

      if (e->base[at] != VG_NO_INDEX || !vg_mark_n(mark)) continue;
      e->base[at] = (uint32_t)next[vg_mark_group(mark)];
      next[vg_mark_group(mark)] += vg_mark_n(mark);
    }
    if (n == 4) e->middle[i] = (uint32_t)next[VG_INNER]++;
  }
  e->inner[e->n_block] = next[VG_INNER];
}

static vg_status check_columns(const struct vg_expand *e, struct vg_error *err)
{
  const struct vg_columns *c = e->columns;

  for (size_t i = 0; i < c->n_column; i++)
    if (vg_mark_n(e->mark[i]) && e->base[i] == VG_NO_INDEX)
      return vg_fail(err, VG_ERR_INPUT,
                     "the column on point %zu has %u levels but no face",
                     (size_t)c->column[i].root + 1, c->column[i].n);
  return VG_OK;
}

vg_status vg_expand_number(struct vg_expand *e, const uint32_t *root,
                           const size_t first[2], struct vg_error *err)
{
  vg_status st;

  for (size_t i = 0; i < e->columns->n_column; i++)
    e->foot[i] = root[e->columns->column[i].root];
  number_columns(e, first);
  st = check_columns(e, err);
  if (st >= 0) vg_expand_count(e);
  return st;
}

void vg_expand_column(const struct vg_expand *e, const struct vg_mesh *surface,
                      size_t i, double (*out)[3])
{
  double d[VG_LEVELS_MAX + 1], x[VG_LEVELS_MAX + 1][3];

  assert(i < e->columns->n_column && out);
  vg_column_points(e->columns, surface, i, d, x);
  memcpy(out, x[1], vg_mark_n(e->mark[i]) * sizeof *x);
}

struct points {
  const struct vg_expand *e;
  const struct vg_mesh *surface;
  int flanks_only;
  double (*point)[3];
};

static void place_columns(void *context, size_t first, size_t end, int worker)
{
  const struct points *p = context;
  const struct vg_expand *e = p->e;

  (void)worker;
  for (size_t i = first; i < end; i++)
    if (vg_mark_n(e->mark[i]) &&
        (!p->flanks_only || vg_mark_group(e->mark[i]) == VG_FLANK))
      vg_expand_column(e, p->surface, i, p->point + e->base[i]);
}

/* After the columns. */
static void place_middles(void *context, size_t first, size_t end, int worker)
{
  const struct points *p = context;
  const struct vg_expand *e = p->e;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    uint32_t q[4], base[4];

    if (!vg_pair_is_first(e, i)) continue;
    vg_pair_corners(e, i, q);
    for (int k = 0; k < 4; k++) base[k] = e->base[q[k]];
    vg_pair_middle_of((const double(*)[3])p->point, base, vg_pair_levels(e, q),
                      p->point[e->middle[i]]);
  }
}

void vg_expand_points(const struct vg_expand *e, const struct vg_mesh *surface,
                      int flanks_only, double (*point)[3])
{
  struct points p = { e, surface, flanks_only, point };

  vg_parallel_for(e->threads, e->columns->n_column, COLUMN_GRAIN, place_columns,
                  &p);
  if (e->n_pair && !flanks_only)
    vg_parallel_for(e->threads, e->columns->n_face, COLUMN_GRAIN, place_middles,
                    &p);
}

vg_status vg_layers_count(const struct vg_mesh *surface,
                          const struct vg_layers *layers,
                          enum vg_layer_cells cells, int threads, uint64_t *n,
                          struct vg_error *err)
{
  assert(n && threads >= 0);

  struct vg_expand e;
  vg_status st = vg_expand_open(&e, surface, &layers->columns, cells, threads,
                                err);

  if (st < 0) return st;
  /* Any numbers will do if columns of one root have the same. */
  for (size_t i = 0; i < layers->columns.n_column; i++) {
    const struct vg_column *c = &layers->columns.column[i];

    e.foot[i] = i && c[-1].root == c->root ? e.foot[i - 1] : (uint32_t)i;
    e.base[i] = (uint32_t)(layers->columns.n_column + i);
  }
  vg_expand_count(&e);
  *n = 0;
  for (int k = 0; k < VG_N_KIND; k++) *n += e.n_cell[k];
  vg_expand_close(&e);
  return VG_OK;
}
