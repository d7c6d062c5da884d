/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/sizing/sizing_stretch.h"

#include <math.h>
#include <string.h>

#include "core/geometry/vector.h"
#include "core/sizing/sizing_shape.h"

enum { PROJECTIONS = 4 };

static int is_vgrid(const struct vg_source *s)
{
  return s->kind == VG_SOURCE_VGRID_NODE || s->kind == VG_SOURCE_VGRID_LINE;
}

/* Is the stretching that of a VGRID file, with a flag instead of a ratio? */
static int has_flag(const struct vg_source *s)
{
  return is_vgrid(s) && s->stretch == 1;
}

const char *vg_source_stretch_defect(const struct vg_source *s)
{
  const double *axis = has_flag(s) ? s->p : s->u;

  if (s->kind == VG_SOURCE_MACHCONE) return NULL; /* vg_mach_cone_defect */
  if (!isfinite(s->stretch) || s->stretch < 0)
    return "its stretching is negative or not finite; 0 means none";
  if (s->stretch == 0 || (s->stretch == 1 && !is_vgrid(s))) return NULL;
  if (!isfinite(vg_dot(axis, axis)) || !(vg_dot(axis, axis) > 0))
    return has_flag(s) ? "its stretching vector P (px, py, pz) has no length; "
                         "give a direction, or 0 as stretching flag"
                       : "its stretching direction (ux, uy, uz) has no "
                         "length; give a vector, or 0 as stretch";
  if (!has_flag(s)) return NULL;
  if (!(s->sp0 > 0 && isfinite(s->sp0)))
    return "its secondary spacing SP (sp0) is not positive; give a length, or "
           "0 as stretching flag";
  if (s->kind == VG_SOURCE_VGRID_LINE && !(s->sp1 > 0 && isfinite(s->sp1)))
    return "its secondary spacing SP at point 2 (sp1) is not positive; give a "
           "length, or 0 as stretching flag";
  return NULL;
}

int vg_source_stretch(const struct vg_source *s, double axis[3],
                      double ratio[2])
{
  int by_flag = has_flag(s);

  ratio[0] = ratio[1] = 1;
  if (s->stretch == 0) return 0;
  if (s->kind == VG_SOURCE_MACHCONE) { /* Its axes depend on the point. */
    vg_sub(s->p1, s->p0, axis);
    vg_unit(axis);
    ratio[0] = ratio[1] = s->stretch;
    return s->stretch != 1;
  }
  memcpy(axis, by_flag ? s->p : s->u, 3 * sizeof *axis);
  if (!(vg_unit(axis) > 0)) return 0;
  if (by_flag) {
    ratio[0] = s->sp0 / s->h0;
    ratio[1] = s->kind == VG_SOURCE_VGRID_LINE ? s->sp1 / s->h1 : ratio[0];
  } else {
    ratio[0] = ratio[1] = s->stretch;
  }
  return ratio[0] != 1 || ratio[1] != 1;
}

int vg_source_is_stretched(const struct vg_source *s)
{
  double axis[3], ratio[2];

  return vg_source_stretch(s, axis, ratio);
}

void vg_stretched_prepare(struct vg_stretched *s)
{
  double thin = fmin(1, fmin(s->ratio[0], s->ratio[1]));
  double wide = fmax(1, fmax(s->ratio[0], s->ratio[1]));

  vg_normals(s->axis[0], s->axis[1], s->axis[2]);
  if (s->law.kind == VG_SOURCE_MACHCONE)
    vg_mach_cones_prepare(&s->law, s->slope, &s->cones);
  s->least = fmin(s->law.h0 * fmin(1, s->ratio[0]),
                  s->law.h1 * fmin(1, s->ratio[1]));
  s->rise = s->slope *
            (1 - VG_GROWTH_IN_METRIC + VG_GROWTH_IN_METRIC * thin / wide);
}

/* Size tensor of a source with one axis. */
static void shape_at(const struct vg_stretched *s, const double x[3],
                     struct vg_size_axes *a)
{
  double way[3], t, d = vg_shape_way(&s->law, x, &t, way), size, along;
  double l2, factor, more;

  size = s->law.h0 + t * (s->law.h1 - s->law.h0);
  along = size * (s->ratio[0] + t * (s->ratio[1] - s->ratio[0]));
  l2 = vg_dot(way, s->axis[0]) * vg_dot(way, s->axis[0]);
  l2 = l2 / (along * along) + fmax(d * d - l2, 0) / (size * size);
  factor = 1 + VG_GROWTH_IN_METRIC * s->slope * sqrt(l2);
  more = (1 - VG_GROWTH_IN_METRIC) * s->slope * d;
  a->size[0] = factor * along + more;
  a->size[1] = a->size[2] = factor * size + more;
  memcpy(a->axis, s->axis, sizeof a->axis);
}

void vg_stretched_at(const struct vg_stretched *s, const double x[3],
                     struct vg_size_axes *a)
{
  if (s->law.kind == VG_SOURCE_MACHCONE) vg_mach_cones_axes(&s->cones, x, a);
  else shape_at(s, x, a);
}

static double shape_way(const struct vg_stretched *s, const double x[3],
                        double way[3])
{
  double t;

  return s->law.kind == VG_SOURCE_MACHCONE
         ? vg_mach_cones_way(&s->cones, x, &t, way)
         : vg_shape_way(&s->law, x, &t, way);
}

double vg_stretched_floor(const struct vg_stretched *s, const double lo[3],
                          const double hi[3])
{
  double d2 = 0;

  for (int k = 0; k < 3; k++) {
    double d = vg_greater(vg_greater(s->lo[k] - hi[k], lo[k] - s->hi[k]), 0);

    d2 += d * d;
  }
  return s->least + s->rise * sqrt(d2);
}

int vg_stretched_near(const struct vg_stretched *s, const double lo[3],
                      const double hi[3], double x[3])
{
  double way[3];

  for (int k = 0; k < 3; k++) x[k] = 0.5 * (lo[k] + hi[k]);
  for (int i = 0; i < PROJECTIONS; i++) {
    if (!(shape_way(s, x, way) > 0)) return i == 0;
    for (int k = 0; k < 3; k++)
      x[k] = vg_lesser(vg_greater(x[k] - way[k], lo[k]), hi[k]);
  }
  return 0;
}
