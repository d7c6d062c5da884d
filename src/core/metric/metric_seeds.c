/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/metric/metric_seeds.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/hash.h"
#include "base/memory.h"
#include "core/geometry/tensor.h"
#include "core/geometry/vector.h"

/* K49: largest complexity of the box of a seed, and least spacing within the
 * cube around the box relative to that at its centre. */
static const double seed_points = 32, falls = 1. / 3;

struct box {
  double lo[3], side[3];
};

/* The axis along which the box is longest in the metric of stretch t. */
static int longest(const struct box *b, const double t[6])
{
  double most = -1;
  int axis = 0;

  for (int k = 0; k < 3; k++) {
    double e[3] = { 0 }, l2;

    e[k] = b->side[k];
    vg_tensor_apply(t, e, e);
    l2 = vg_dot(e, e);
    if (!(l2 > most)) continue;
    most = l2;
    axis = k;
  }
  return axis;
}

/* Lower bound of the spacing within the cube around the box. */
static double least_around(const struct vg_sizing *sizing, const struct box *b)
{
  double side = fmax(b->side[0], fmax(b->side[1], b->side[2])), lo[3];

  for (int k = 0; k < 3; k++) lo[k] = b->lo[k] + 0.5 * (b->side[k] - side);
  return vg_sizing_bound(sizing, lo, side);
}

/* A number from 0 to 1 that depends on the position alone. */
static double share_of(const double x[3])
{
  uint64_t bits[3];

  memcpy(bits, x, sizeof bits);
  return (double)(vg_hash_mix(vg_hash_3(bits[0], bits[1], bits[2])) >> 11) *
         0x1p-53;
}

static int add_seed(struct vg_metric_seeds *out, const double x[3])
{
  if (vg_reserve(&out->x, &out->cap, out->n + 1, sizeof *out->x)) return -1;
  memcpy(out->x[out->n++], x, sizeof *out->x);
  return 0;
}

/* Is the complexity of the box, in which the spacing at the centre is h, as
 * small as h suggests? A part of the box may be much finer. */
static int is_even(const struct vg_sizing *sizing, const struct box *b,
                   double volume, double h)
{
  double least = least_around(sizing, b);

  return least >= falls * h || volume <= seed_points * least * least * least;
}

/* Halve the box along its longest side in the metric until its complexity is
 * small. A box with less than seed_points gets a seed with the corresponding
 * probability. */
static int seed(const struct vg_sizing *sizing, const struct box *b,
                struct vg_metric_seeds *out)
{
  double x[3], t[6], h, volume = 1, points;
  struct box half = *b;
  int axis;

  for (int k = 0; k < 3; k++) {
    x[k] = b->lo[k] + 0.5 * b->side[k];
    volume *= b->side[k];
  }
  h = vg_sizing_stretch_at(sizing, x, t);
  points = volume / (h * h * h);
  if (points <= seed_points && is_even(sizing, b, volume, h))
    return share_of(x) * seed_points <= points ? add_seed(out, x) : 0;
  axis = longest(b, t);
  half.side[axis] *= 0.5;
  if (seed(sizing, &half, out)) return -1;
  half.lo[axis] += half.side[axis];
  return seed(sizing, &half, out);
}

vg_status vg_metric_seeds(size_t n, const double (*x)[3],
                          const struct vg_sizing *sizing,
                          struct vg_metric_seeds *out, struct vg_error *err)
{
  struct box b;

  assert(sizing && out && !out->n && (x || !n));
  if (!n) return VG_OK;
  for (int k = 0; k < 3; k++) {
    double hi = x[0][k];

    b.lo[k] = hi;
    for (size_t i = 0; i < n; i++) {
      b.lo[k] = fmin(b.lo[k], x[i][k]);
      hi = fmax(hi, x[i][k]);
    }
    b.side[k] = hi - b.lo[k];
    if (!(b.side[k] > 0)) return VG_OK;
  }
  return seed(sizing, &b, out) ? vg_fail_memory(err, "placing points") : VG_OK;
}
