/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Lengths of edges in a metric: short edges are collapsed, long ones split. */
#include <assert.h>
#include <math.h>

#include "core/optimise/optimise_parts.h"

/* K45: edges shorter or longer than this are changed. Collapses may not make
 * cells worse than this shape, or than the worst one. Splits may reduce the
 * worst shape around the edge by this factor. */
static const double shortest = 0.68, longest = 1.45;
static const double least_shape = 0.125, split_share = 0.6;
/* Edges shorter than `tiny` may leave edges up to `far` and cells down to this
 * shape. */
static const double tiny = 0.4, far = 2, tiny_shape = 0.027;

/* Edges of cells within this many spacings of those that a region optimises are
 * changed, too. */
static const double around = 1; /* K51 */

static int is_live(const struct vg_tets *t, uint32_t c)
{
  return !(t->flag[c] & (VG_DEAD | VG_OUTSIDE));
}

static int merge_edge(struct vg_optimiser *o, uint32_t a, uint32_t b,
                      double shape, double most)
{
  return vg_merge_onto(o, a, b, shape, most) ||
         vg_merge_onto(o, b, a, shape, most);
}

/* Does cell c have a corner within the band of the region where points are
 * placed? Beyond it, the void has no points yet, and all edges are long. */
static int concerns(const struct vg_optimiser *o, uint32_t c)
{
  const struct vg_tets *t = o->t;
  const uint32_t *v = t->cell[c].v;
  struct vg_region r;

  if (!o->region) return 1;
  r = *o->region;
  r.reach += around;
  return vg_region_has_cell(&r, o->sizing, t->x[v[0]], t->x[v[1]], t->x[v[2]],
                            t->x[v[3]]);
}

/* Bit of the edge between corners i and j of a cell. */
static uint8_t edge_bit(int i, int j)
{
  static const uint8_t edge[4][4] = {
    { 0, 0, 1, 2 }, { 0, 0, 3, 4 }, { 1, 3, 0, 5 }, { 2, 4, 5, 0 }
  };

  return (uint8_t)(VG_FAILED_LENGTH << edge[i][j]);
}

/* Length of the edge between two points in the metric, or 1 if the lengths in
 * the metrics of both ends, between which it lies, require no change. */
static double length_of(const struct vg_optimiser *o, uint32_t a, uint32_t b)
{
  double e[3], la, lb;

  vg_sub(o->t->x[b], o->t->x[a], e);
  la = vg_tensor_form(o->metrics->at[a].m, e);
  lb = vg_tensor_form(o->metrics->at[b].m, e);
  if (la >= shortest * shortest && lb >= shortest * shortest &&
      la <= longest * longest && lb <= longest * longest)
    return 1;
  return vg_log_mean(sqrt(fmax(la, 0)), sqrt(fmax(lb, 0)));
}

/* The edge a b of cell c could not be changed. In this pass, the other cells
 * around it try again only if they change. */
static void mark_edge(struct vg_optimiser *o, uint32_t c, uint32_t a,
                      uint32_t b)
{
  uint32_t cell[VG_OLD_MAX], ring[VG_OLD_MAX];
  int n = vg_cavity_ring(o->t, c, a, b, VG_OLD_MAX, 1, cell, ring);

  if (!n) cell[n++] = c;
  for (int k = 0; k < n; k++) {
    const uint32_t *v = o->t->cell[cell[k]].v;
    int i = 0, j = 0;

    while (v[i] != a) i++;
    while (v[j] != b) j++;
    o->failed_cell[cell[k]] |= edge_bit(i, j);
  }
}

/* Change edge i j of cell c if its length requires it. */
static int even_edge(struct vg_optimiser *o, uint32_t c, int i, int j)
{
  uint32_t a = o->t->cell[c].v[i], b = o->t->cell[c].v[j];
  double length;

  if (o->failed_cell[c] & edge_bit(i, j)) return 0;
  length = length_of(o, a, b);
  if (length >= shortest && length <= longest) return 0;
  if (length > longest) {
    if (vg_split_edge(o, c, a, b, split_share, shortest)) return 1;
  } else if (merge_edge(o, a, b, least_shape, longest) ||
             (length < tiny && merge_edge(o, a, b, tiny_shape, far))) {
    return 1;
  }
  mark_edge(o, c, a, b);
  return 0;
}

static int is_even(const struct vg_optimiser *o, uint32_t c)
{
  return (o->failed_cell[c] & VG_EVEN) == VG_EVEN;
}

static void even_cell(struct vg_optimiser *o, uint32_t c)
{
  if (concerns(o, c))
    for (int i = 0; i < 4; i++)
      for (int j = i + 1; j < 4; j++)
        if (even_edge(o, c, i, j)) return;
  if (!(o->failed_cell[c] & VG_EVEN)) o->failed_cell[c] |= VG_EVEN;
}

/* A cell that was even after an earlier pass remains so until it changes. */
vg_status vg_even_lengths(struct vg_optimiser *o, struct vg_error *err)
{
  assert(o->metrics);
  for (uint32_t c = 0; c < o->t->n_cell; c++)
    if (!is_even(o, c)) o->failed_cell[c] &= (uint8_t)~VG_EVEN;
  for (uint32_t c = 0; c < o->t->n_cell; c++)
    if (is_live(o->t, c) && !is_even(o, c)) even_cell(o, c);
  return o->refused ? vg_fail_memory(err, "optimisation") : VG_OK;
}
