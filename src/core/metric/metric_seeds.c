/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/metric/metric_seeds.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/memory.h"
#include "core/geometry/tensor.h"
#include "core/geometry/vector.h"
#include "core/metric/metrics.h"
#include "core/search/box_tree.h"

/* K49: largest complexity of the box of a seed, and least spacing within the
 * cube around the box relative to that at its centre. */
static const double seed_points = 16, falls = 1. / 3;

struct box {
  double lo[3], side[3];
};

struct seeder {
  const struct vg_sizing *sizing;
  const struct vg_region *region;
  const double (*x)[3];           /* points that bound the void */
  const struct vg_box_tree *near; /* box tree of these points */
  struct vg_metric_seeds *out;
};

/* May the box contain points that are placed along the region? */
static int near_region(const struct seeder *s, const struct box *b)
{
  const struct vg_region *r = s->region;
  double gap[VG_REGION_SIDES], far = 0, hi[3];
  double least[VG_REGION_SIDES], most[VG_REGION_SIDES];
  int n = r->n_plane + r->n_wall;

  for (int i = 0; i < n; i++) {
    int is_wall = i >= r->n_plane;
    const struct vg_plane *p = is_wall ? &r->wall[i - r->n_plane]
                                       : &r->plane[i];
    double mid[3], half = 0, d;

    for (int k = 0; k < 3; k++) {
      mid[k] = b->lo[k] + 0.5 * b->side[k];
      half += 0.5 * fabs(p->normal[k]) * b->side[k];
    }
    d = vg_plane_side(p, mid);
    gap[i] = ((is_wall ? -d : fabs(d)) - half) /
             (is_wall ? VG_BEYOND_WALLS : 1);
    far = fmax(far, gap[i]);
  }
  if (far == 0) return 1;
  for (int k = 0; k < 3; k++) hi[k] = b->lo[k] + b->side[k];
  vg_region_across_within(r, s->sizing, b->lo, hi, least, most);
  for (int i = 0; i < n; i++)
    if (gap[i] > vg_region_band(r, VG_BAND_PLACE) * most[i]) return 0;
  return 1;
}

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

/* A seed that may be too near to a point that bounds the void. */
struct candidate {
  const double (*x)[3];
  const double *at;
  struct vg_point_metric metric;
};

static int is_too_near(void *context, uint32_t item)
{
  const struct candidate *c = context;
  double d[3];

  vg_sub(c->x[item], c->at, d);
  return vg_tensor_form(c->metric.m, d) < VG_SEED_DISTANCE * VG_SEED_DISTANCE;
}

/* Is the point in the ellipsoid of the metric at x? Its half extents are the
 * square roots of the diagonal of the squared size tensor. */
static int has_point_near(const struct seeder *s, const double x[3])
{
  static const int diagonal[3] = { 0, 3, 5 };
  struct candidate c = { .x = s->x, .at = x };
  struct vg_box box;
  double h[6], square[6];

  vg_sizing_tensor_at(s->sizing, x, h);
  vg_tensor_square(h, square);
  for (int k = 0; k < 3; k++) {
    double half = VG_SEED_DISTANCE * sqrt(square[diagonal[k]]);

    box.lo[k] = x[k] - half;
    box.hi[k] = x[k] + half;
  }
  vg_tensor_invert(h, h);
  vg_metric_of_stretch(h, &c.metric);
  return vg_box_tree_touched(s->near, &box, is_too_near, &c);
}

static int add_seed(const struct seeder *s, const double x[3])
{
  struct vg_metric_seeds *out = s->out;

  if ((s->region && !vg_region_near(s->region, s->sizing, x, VG_BAND_PLACE)) ||
      has_point_near(s, x))
    return 0;
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
static int seed(const struct seeder *s, const struct box *b)
{
  double x[3], t[6], h, volume = 1, points;
  struct box half = *b;
  int axis;

  if (s->region && !near_region(s, b)) return 0;
  for (int k = 0; k < 3; k++) {
    x[k] = b->lo[k] + 0.5 * b->side[k];
    volume *= b->side[k];
  }
  h = vg_sizing_stretch_at(s->sizing, x, t);
  points = volume / (h * h * h);
  if (points <= seed_points && is_even(s->sizing, b, volume, h))
    return share_of(x) * seed_points <= points ? add_seed(s, x) : 0;
  axis = longest(b, t);
  half.side[axis] *= 0.5;
  if (seed(s, &half)) return -1;
  half.lo[axis] += half.side[axis];
  return seed(s, &half);
}

static vg_status build_tree(size_t n, const double (*x)[3],
                            struct vg_box_tree *tree, struct vg_error *err)
{
  struct vg_box *box = vg_alloc(n, sizeof *box);
  vg_status st = VG_OK;

  if (!box) return vg_fail_memory(err, "placing points");
  for (size_t i = 0; i < n; i++) {
    memcpy(box[i].lo, x[i], sizeof box->lo);
    memcpy(box[i].hi, x[i], sizeof box->hi);
  }
  st = vg_box_tree_build_items(tree, n, box, NULL, err);
  free(box);
  return st;
}

vg_status vg_metric_seeds(size_t n, const double (*x)[3],
                          const struct vg_sizing *sizing,
                          const struct vg_region *region,
                          struct vg_metric_seeds *out, struct vg_error *err)
{
  struct vg_box_tree tree = VG_BOX_TREE_INIT;
  const struct seeder s = { sizing, region, x, &tree, out };
  struct box b;
  vg_status st;

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
  st = build_tree(n, x, &tree, err);
  if (st == VG_OK && seed(&s, &b)) st = vg_fail_memory(err, "placing points");
  vg_box_tree_release(&tree);
  return st;
}
