/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Assigns triangles to blocks: recursive bisection of their centroids across
 * the longest side of the bounding box, by histogram. */
#include "core/remesh/blocks_parts.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"

#define BLOCK 6000.0 /* S29: triangles per block, about: fits into a cache */
#define OLD 0.25     /* work of an existing triangle, in new ones */
#define BINS 1024

struct cutting {
  const struct vg_tris *w;
  int phase;
  double *weight;         /* [n_tri] */
  double (*middle)[3];    /* [n_tri] */
  uint32_t *list, *spare; /* [n_tri] Triangles, sorted by block. */
  uint32_t *of;           /* [n_tri] Block of each triangle. */
};

static double weight_of(const struct vg_tris *w, size_t t)
{
  const struct vg_tris_point *p[3];
  double u[3], v[3], n[3], size, area2;

  if (vg_tris_removed(w, t)) return 0;
  for (int k = 0; k < 3; k++) p[k] = &w->point[w->tri[t][k]];
  vg_sub(p[1]->x, p[0]->x, u);
  vg_sub(p[2]->x, p[0]->x, v);
  vg_cross(u, v, n);
  size = (p[0]->asked.size + p[1]->asked.size + p[2]->asked.size) / 3;
  area2 = vg_form_area2(vg_tris_form(w, w->tri[t][0]), n);
  return OLD + sqrt(area2) / (0.8660254037844386 * size * size);
}

size_t vg_blocks_number(const struct vg_tris *w)
{
  double sum = 0;

  for (size_t t = 0; t < w->n_tri; t++) sum += weight_of(w, t);
  return sum < 2 * BLOCK ? 1 : (size_t)(sum / BLOCK);
}

/* Number of blocks, of k, on the first side; it differs between phases. */
static size_t first_side(size_t k, int phase)
{
  static const size_t share[3][2] = { { 1, 2 }, { 1, 3 }, { 2, 5 } };
  size_t n = k * share[phase % 3][0] / share[phase % 3][1];

  return n ? n : 1;
}

static int longest_side(const struct cutting *c, const uint32_t *list, size_t n,
                        double *lo, double *hi)
{
  double a[3] = { INFINITY, INFINITY, INFINITY };
  double b[3] = { -INFINITY, -INFINITY, -INFINITY };
  int axis = 0;

  for (size_t i = 0; i < n; i++)
    for (int d = 0; d < 3; d++) {
      double x = c->middle[list[i]][d];

      if (x < a[d]) a[d] = x;
      if (x > b[d]) b[d] = x;
    }
  for (int d = 1; d < 3; d++)
    if (b[d] - a[d] > b[axis] - a[axis]) axis = d;
  *lo = a[axis];
  *hi = b[axis];
  return axis;
}

/* Number of leading bins that hold the given share of the weight. */
static int bins_of(const double *sum, double share)
{
  double total = 0, so_far = 0;
  int k;

  for (int i = 0; i < BINS; i++) total += sum[i];
  for (k = 0; k < BINS && so_far + sum[k] / 2 < share * total; k++)
    so_far += sum[k];
  return k;
}

/* Distribute the triangles of list over blocks first .. first + k - 1. */
static void bisect(const struct cutting *c, uint32_t *list, size_t n,
                   size_t first, size_t k)
{
  double sum[BINS] = { 0 }, lo, hi, scale;
  size_t left = first_side(k, c->phase), n_left = 0, n_right = 0;
  int axis, cut;

  if (k == 1 || n < 2) {
    for (size_t i = 0; i < n; i++) c->of[list[i]] = (uint32_t)first;
    return;
  }
  axis = longest_side(c, list, n, &lo, &hi);
  scale = hi > lo ? (BINS - 1) / (hi - lo) : 0;
  for (size_t i = 0; i < n; i++)
    sum[(int)((c->middle[list[i]][axis] - lo) * scale)] += c->weight[list[i]];
  cut = bins_of(sum, (double)left / (double)k);
  for (size_t i = 0; i < n; i++)
    if ((int)((c->middle[list[i]][axis] - lo) * scale) < cut)
      list[n_left++] = list[i];
    else c->spare[n_right++] = list[i];
  memcpy(list + n_left, c->spare, n_right * sizeof *list);
  bisect(c, list, n_left, first, left);
  bisect(c, list + n_left, n_right, first + left, k - left);
}

vg_status vg_blocks_cut(const struct vg_tris *w, size_t k, int phase,
                        uint32_t *of, struct vg_block *block,
                        struct vg_error *err)
{
  struct cutting c = { .w = w, .phase = phase, .of = of };
  size_t n = 0;
  vg_status st = VG_OK;

  assert(k > 0 && phase >= 0 && block && (of || !w->n_tri));
  c.weight = vg_alloc(w->n_tri, sizeof *c.weight);
  c.middle = vg_alloc(w->n_tri, sizeof *c.middle);
  c.list = vg_alloc(w->n_tri, sizeof *c.list);
  c.spare = vg_alloc(w->n_tri, sizeof *c.spare);
  if (!c.weight || !c.middle || !c.list || !c.spare)
    VG_TRY(vg_fail_memory(err, "the blocks of the surface"));
  for (uint32_t t = 0; t < w->n_tri; t++) {
    of[t] = VG_REF_NONE;
    if (vg_tris_removed(w, t)) continue;
    c.weight[t] = weight_of(w, t);
    for (int d = 0; d < 3; d++)
      c.middle[t][d] = (vg_tris_at(w, w->tri[t][0])[d] +
                        vg_tris_at(w, w->tri[t][1])[d] +
                        vg_tris_at(w, w->tri[t][2])[d]) /
                       3;
    c.list[n++] = t;
  }
  bisect(&c, c.list, n, 0, k);
  for (size_t i = 0; i < n; i++)
    block[of[c.list[i]]].weight += c.weight[c.list[i]];
done:
  free(c.weight);
  free(c.middle);
  free(c.list);
  free(c.spare);
  return st;
}
