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

/* Least part of a probe in tetrahedra. */
#define COVERED 0.5

struct measure {
  size_t n;
  const struct vg_wake_probe *probe;
  struct vg_box_tree tree;
  atomic_ullong *cells, *covered; /* [n] in UNIT */
};

/* A tetrahedron, with the gradients of the barycentric coordinates of its
 * points 1 to 3. */
struct tet {
  struct measure *m;
  double x0[3], gradient[3][3];
};

static int shape(const struct vg_slice *s, const uint32_t v[4], struct tet *t)
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

/* Part of the probe within the tetrahedron. */
static double clip(const struct tet *t, const struct vg_wake_probe *p)
{
  double from = 0, to = 1, a[4] = { 1 }, b[4] = { 1 }, d[2][3];

  for (int end = 0; end < 2; end++) vg_sub(p->x[end], t->x0, d[end]);
  for (int k = 0; k < 3; k++) {
    a[k + 1] = vg_dot(d[0], t->gradient[k]);
    b[k + 1] = vg_dot(d[1], t->gradient[k]);
    a[0] -= a[k + 1];
    b[0] -= b[k + 1];
  }
  for (int k = 0; k < 4; k++) {
    if (a[k] < 0 && b[k] < 0) return 0;
    if (a[k] < 0) from = fmax(from, a[k] / (a[k] - b[k]));
    if (b[k] < 0) to = fmin(to, a[k] / (a[k] - b[k]));
  }
  return fmax(to - from, 0);
}

/* Edge lengths per length of the probe: the length of its vector in the metric
 * in which the tetrahedron is regular with edges of length 1. */
static double edges_along(const struct tet *t, const struct vg_wake_probe *p)
{
  double d[3], g[3];

  vg_sub(p->x[1], p->x[0], d);
  for (int k = 0; k < 3; k++) g[k] = vg_dot(d, t->gradient[k]);
  return sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2] + g[0] * g[1] +
              g[1] * g[2] + g[2] * g[0]);
}

static int visit(void *context, uint32_t i)
{
  struct tet *t = context;
  struct measure *m = t->m;
  const double part = clip(t, m->probe + i);

  if (!(part > 0)) return 0;
  atomic_fetch_add(m->covered + i, (unsigned long long)(part / UNIT));
  atomic_fetch_add(m->cells + i,
                   (unsigned long long)(part * edges_along(t, m->probe + i) /
                                        UNIT));
  return 0;
}

static vg_status measure_slice(void *context, const struct vg_slice *s,
                               struct vg_error *err)
{
  struct measure *m = context;
  const uint32_t *v = s->cell[VG_SLICE_TET];
  struct tet t = { .m = m };

  (void)err;
  for (size_t i = 0; i < s->n_cell[VG_SLICE_TET]; i++, v += 4) {
    struct vg_box box = VG_BOX_EMPTY;

    for (int k = 0; k < 4; k++) vg_box_add(&box, s->x[v[k]]);
    if (!vg_box_touch(&box, vg_box_tree_node(&m->tree, 0))) continue;
    if (shape(s, v, &t)) vg_box_tree_touched(&m->tree, &box, visit, &t);
  }
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

vg_status vg_wake_measure(struct vg_comm *c, const struct vg_slices *s,
                          int threads, size_t n, struct vg_wake_probe *probe,
                          struct vg_error *err)
{
  struct measure m = { .n = n, .probe = probe, .tree = VG_BOX_TREE_INIT };
  uint64_t *sum;
  vg_status st;

  if (!n) return VG_OK;
  m.cells = vg_calloc(n, sizeof *m.cells);
  m.covered = vg_calloc(n, sizeof *m.covered);
  sum = vg_calloc(2 * n, sizeof *sum);
  st = m.cells && m.covered && sum
       ? build_tree(&m, err)
       : vg_fail_memory(err, "the lines across wakes");
  if (st >= 0) st = vg_slices_each(s, threads, measure_slice, &m, err);
  VG_TRY(vg_comm_agree(c, st, err));
  for (size_t i = 0; i < n; i++) {
    sum[2 * i] = m.cells[i];
    sum[2 * i + 1] = m.covered[i];
  }
  VG_TRY(vg_comm_sum(c, 2 * n, sum, err));
  for (size_t i = 0; i < n; i++)
    probe[i].got = UNIT * (double)sum[2 * i + 1] >= COVERED
                   ? (double)sum[2 * i] / (double)sum[2 * i + 1]
                   : NAN;
done:
  vg_box_tree_release(&m.tree);
  free(m.cells);
  free(m.covered);
  free(sum);
  return st;
}
