/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/sizing/sizing_map.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "core/sizing/sizing_bvh.h"

struct vg_size_samples {
  struct vg_bvh *tree;
  struct vg_size_map map;
};

vg_status vg_size_place_check(const char *name, size_t i, const double x[3],
                              struct vg_error *err)
{
  for (int k = 0; k < 3; k++)
    if (!(fabs(x[k]) <= VG_COORDINATE_MAX))
      return vg_fail(err, VG_ERR_INPUT,
                     "%s: point %zu, (%g, %g, %g), is not finite, or beyond %g",
                     name, i + 1, x[0], x[1], x[2], VG_COORDINATE_MAX);
  return VG_OK;
}

vg_status vg_size_samples_check(const char *name, size_t n,
                                const double (*x)[3], const double *h,
                                struct vg_error *err)
{
  for (size_t i = 0; i < n; i++) {
    if (vg_size_place_check(name, i, x[i], err) < 0) return VG_ERR_INPUT;
    if (!(h[i] > 0 && isfinite(h[i])))
      return vg_fail(err, VG_ERR_INPUT,
                     "%s: the edge length at point %zu, "
                     "(%.9g, %.9g, %.9g), is %g; it must be above 0 and "
                     "finite",
                     name, i + 1, x[i][0], x[i][1], x[i][2], h[i]);
  }
  return VG_OK;
}

static double least(void *user, const double lo[3], const double hi[3])
{
  const struct vg_size_samples *s = user;
  uint32_t hint = 0;

  return vg_bvh_above(s->tree, lo, hi, INFINITY, NULL, &hint);
}

static double at(void *user, const double x[3])
{
  return least(user, x, x);
}

vg_status vg_size_samples_new(size_t n, const double (*x)[3], const double *h,
                              double growth, int threads,
                              struct vg_size_samples **out,
                              struct vg_error *err)
{
  assert(n > 0 && x && h && growth > 1 && out);

  struct vg_size_samples *s = vg_calloc(1, sizeof *s);
  vg_status st;

  if (!s) return vg_fail_memory(err, "the spacings at points");
  st = vg_bvh_new(n, x, h, growth - 1, threads, &s->tree, err);
  if (st < 0) {
    free(s);
    return st;
  }
  s->map = (struct vg_size_map){ .at = at, .least = least, .user = s };
  for (size_t i = 0; i < n; i++)
    if (h[i] > s->map.most) s->map.most = h[i];
  *out = s;
  return VG_OK;
}

void vg_size_samples_free(struct vg_size_samples *s)
{
  if (!s) return;
  vg_bvh_free(s->tree);
  free(s);
}

const struct vg_size_map *vg_size_samples_map(const struct vg_size_samples *s)
{
  return &s->map;
}
