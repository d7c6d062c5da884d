/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Cells along lines across wakes. Declared in core/wake/wake.h. */
#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>

#include "base/comm.h"
#include "base/memory.h"
#include "core/geometry/vector.h"
#include "core/mesh/slices.h"
#include "core/search/box_tree.h"
#include "core/wake/wake.h"

/* Sums are integers, so that they do not depend on the order of the cells. */
#define UNIT 1e-9

/* Least part of a probe in cells that count. */
#define COVERED 0.5

/* Of one probe: cells along it, cells along its flow, part in cells. */
enum { ACROSS, ALONG, COVER, SUMS };

struct measure {
  size_t n;
  const struct vg_wake_probe *probe;
  uint64_t n_layer_prism;
  struct vg_box_tree tree;
  atomic_ullong (*sum)[SUMS]; /* [n] in UNIT */
};

/* A tetrahedron or a prism: gradients of its coordinates, which are 0 at its
 * first node. They are 1 at nodes 1, 2 and 3 of a tetrahedron, and for a prism
 * at nodes 1 and 2 and on the triangle of nodes 3 to 5. */
struct cell {
  struct measure *m;
  int is_prism;
  double x0[3], gradient[3][3];
};

static int shape(const struct vg_slice *s, const uint32_t *v, struct cell *t)
{
  double e[3][3], volume;

  for (int k = 0; k < 3; k++) {
    t->x0[k] = s->x[v[0]][k];
    vg_sub(s->x[v[k + 1]], s->x[v[0]], e[k]);
  }
  volume = vg_triple(e[0], e[1], e[2]);
  if (!(volume > 0)) return 0;
  for (int k = 0; k < 3; k++) {
    vg_cross(e[(k + 1) % 3], e[(k + 2) % 3], t->gradient[k]);
    for (int i = 0; i < 3; i++) t->gradient[k][i] /= volume;
  }
  return 1;
}

/* The functions that are positive inside of the cell, at the coordinates g. */
static int inside(const struct cell *t, const double g[3], double f[5])
{
  for (int k = 0; k < 3; k++) f[k] = g[k];
  f[3] = 1 - g[0] - g[1] - (t->is_prism ? 0 : g[2]);
  f[4] = 1 - g[2];
  return t->is_prism ? 5 : 4;
}

/* Part of the probe within the cell. */
static double clip(const struct cell *t, const struct vg_wake_probe *p)
{
  double from = 0, to = 1, f[2][5];
  int n = 0;

  for (int end = 0; end < 2; end++) {
    double d[3], g[3];

    vg_sub(p->x[end], t->x0, d);
    for (int k = 0; k < 3; k++) g[k] = vg_dot(d, t->gradient[k]);
    n = inside(t, g, f[end]);
  }
  for (int k = 0; k < n; k++) {
    const double a = f[0][k], b = f[1][k];

    if (a < 0 && b < 0) return 0;
    if (a < 0) from = fmax(from, a / (a - b));
    if (b < 0) to = fmin(to, a / (a - b));
  }
  return fmax(to - from, 0);
}

/* Edge lengths of the cell along d: the length of d in the metric in which the
 * cell is regular with edges of length 1. */
static double edges_along(const struct cell *t, const double d[3])
{
  double g[3], slant;

  for (int k = 0; k < 3; k++) g[k] = vg_dot(d, t->gradient[k]);
  slant = t->is_prism ? 0 : g[1] * g[2] + g[2] * g[0];
  return sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2] + g[0] * g[1] + slant);
}

static void add(struct measure *m, uint32_t i, int which, double value)
{
  atomic_fetch_add(&m->sum[i][which], (unsigned long long)(value / UNIT));
}

static int visit(void *context, uint32_t i)
{
  struct cell *t = context;
  const struct vg_wake_probe *p = t->m->probe + i;
  const double part = clip(t, p);
  double across[3], along[3], length;

  if (!(part > 0)) return 0;
  vg_sub(p->x[1], p->x[0], across);
  length = vg_norm(across);
  for (int k = 0; k < 3; k++) along[k] = length * p->flow[k];
  add(t->m, i, ACROSS, part * edges_along(t, across));
  add(t->m, i, ALONG, part * edges_along(t, along));
  add(t->m, i, COVER, part);
  return 0;
}

/* The cells of a kind from `first` on. */
static void measure_kind(struct measure *m, const struct vg_slice *s, int kind,
                         size_t first)
{
  const size_t width = vg_slice_width[kind];
  struct cell t = { .m = m, .is_prism = kind == VG_SLICE_PRI };

  for (size_t i = first; i < s->n_cell[kind]; i++) {
    const uint32_t *v = s->cell[kind] + i * width;
    struct vg_box box = VG_BOX_EMPTY;

    for (size_t k = 0; k < width; k++) vg_box_add(&box, s->x[v[k]]);
    if (!vg_box_touch(&box, vg_box_tree_node(&m->tree, 0))) continue;
    if (shape(s, v, &t)) vg_box_tree_touched(&m->tree, &box, visit, &t);
  }
}

static vg_status measure_slice(void *context, const struct vg_slice *s,
                               struct vg_error *err)
{
  struct measure *m = context;
  const uint64_t at = s->cell_at[VG_SLICE_PRI];

  (void)err;
  measure_kind(m, s, VG_SLICE_TET, 0);
  measure_kind(m, s, VG_SLICE_PRI,
               at < m->n_layer_prism ? (size_t)(m->n_layer_prism - at) : 0);
  return VG_OK;
}

static vg_status build_tree(struct measure *m, struct vg_error *err)
{
  struct vg_box *box = vg_alloc(m->n, sizeof *box);
  vg_status st;

  if (!box) return vg_fail_memory(err, "the lines across wakes");
  for (size_t i = 0; i < m->n; i++) {
    box[i] = (struct vg_box)VG_BOX_EMPTY;
    for (int k = 0; k < 2; k++) vg_box_add(&box[i], m->probe[i].x[k]);
  }
  st = vg_box_tree_build_items(&m->tree, m->n, box, NULL, err);
  free(box);
  return st;
}

static void take(const uint64_t sum[SUMS], struct vg_wake_probe *p)
{
  const double across = (double)sum[ACROSS], along = (double)sum[ALONG];
  const int is_measured = UNIT * (double)sum[COVER] >= COVERED;

  p->got = is_measured ? across / (double)sum[COVER] : NAN;
  p->stretch = is_measured && along > 0 ? across / along : NAN;
}

vg_status vg_wake_measure(struct vg_comm *c, const struct vg_slices *s,
                          int threads, size_t n, struct vg_wake_probe *probe,
                          struct vg_error *err)
{
  struct measure m = { .n = n,
                       .probe = probe,
                       .n_layer_prism = s->n_layer_cell[VG_SLICE_PRI],
                       .tree = VG_BOX_TREE_INIT };
  uint64_t(*sum)[SUMS];
  vg_status st;

  if (!n) return VG_OK;
  m.sum = vg_calloc(n, sizeof *m.sum);
  sum = vg_calloc(n, sizeof *sum);
  st = m.sum && sum ? build_tree(&m, err)
                    : vg_fail_memory(err, "the lines across wakes");
  if (st >= 0) st = vg_slices_each(s, threads, measure_slice, &m, err);
  VG_TRY(vg_comm_agree(c, st, err));
  for (size_t i = 0; i < n; i++)
    for (int k = 0; k < SUMS; k++) sum[i][k] = m.sum[i][k];
  VG_TRY(vg_comm_sum(c, SUMS * n, sum[0], err));
  for (size_t i = 0; i < n; i++) take(sum[i], &probe[i]);
done:
  vg_box_tree_release(&m.tree);
  free(m.sum);
  free(sum);
  return st;
}
