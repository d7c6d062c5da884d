/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/domain/mach.h"

#include <assert.h>
#include <math.h>

#include "core/geometry/vector.h"

/* S63: least radius of the caps over the upstream extent. */
#define CAP_LEAST 0.25
/* S64: largest distance of the body from the axis over the radius of the
 * domain. */
#define RADIAL_ROOM 0.9
/* S65: largest edge over the local radius, about 16 edges per circle. */
#define ROUND 0.4
/* S66: least number of edges between inflow and outflow face. */
#define WINDOW_EDGES 6

/* Axial positions and radii of the body. */
struct reach {
  double front, back;
  double cap;    /* Least radius of the upstream cap. */
  double radius; /* Largest distance from the axis, at point `widest`. */
  size_t widest;
};

static vg_status check_extent(const struct vg_mach_extent *e,
                              struct vg_error *err)
{
  const double length[3] = { e->upstream, e->downstream, e->radial };
  static const char *const name[3] = { "upstream", "downstream", "radial" };

  if (!(e->mach > 1) || !isfinite(e->mach))
    return vg_fail(err, VG_ERR_INPUT,
                   "farfield mach: the Mach number is %g, but a Mach cone "
                   "exists above 1 only; give the Mach number of the flow, or "
                   "use a farfield sphere or box",
                   e->mach);
  for (int i = 0; i < 3; i++)
    if (!(length[i] > 0) || !isfinite(length[i]))
      return vg_fail(err, VG_ERR_INPUT,
                     "farfield mach: %s is %g; give a number of body lengths "
                     "above 0",
                     name[i], length[i]);
  return VG_OK;
}

static vg_status take_axis(const struct vg_mach_extent *e, int half,
                           struct vg_revolution *r, struct vg_error *err)
{
  const double len = sqrt(vg_dot(e->flow, e->flow));

  if (!(len > 0) || !isfinite(len))
    return vg_fail(err, VG_ERR_INPUT,
                   "farfield mach: the direction of the flow (ux uy uz) is "
                   "(%g, %g, %g); give a vector that is not zero",
                   e->flow[0], e->flow[1], e->flow[2]);
  if (half >= 0 && e->flow[half / 2] != 0)
    return vg_fail(err, VG_ERR_INPUT,
                   "farfield mach: the flow in direction (%g, %g, %g) crosses "
                   "the symmetry plane of the half model; u%c must be 0",
                   e->flow[0], e->flow[1], e->flow[2], "xyz"[half / 2]);
  for (int k = 0; k < 3; k++) r->axis[k] = e->flow[k] / len;
  vg_revolution_frame(r, half);
  return VG_OK;
}

/* tangent: of the half angle of the Mach cone. */
static struct reach measure(const struct vg_mesh *body,
                            const struct vg_revolution *r, double tangent)
{
  struct reach b = { INFINITY, -INFINITY, 0, 0, 0 };
  double z, radius;

  for (size_t i = 0; i < body->n_point; i++) {
    vg_revolution_locate(r, body->point[i], &z, &radius);
    b.front = fmin(b.front, z);
    b.back = fmax(b.back, z);
    if (radius <= b.radius) continue;
    b.radius = radius;
    b.widest = i;
  }
  for (size_t i = 0; i < body->n_point; i++) {
    vg_revolution_locate(r, body->point[i], &z, &radius);
    b.cap = fmax(b.cap, radius - (z - b.front) * tangent);
  }
  return b;
}

vg_status vg_mach_place(const struct vg_mesh *body,
                        const struct vg_mach_extent *e, double length,
                        const double centre[3], int half, struct vg_mach *out,
                        struct vg_error *err)
{
  assert(body->n_point > 0 && length > 0);

  const double cot = sqrt((e->mach - 1) * (e->mach + 1));
  const double radius = e->radial * length;
  struct reach b;
  double front, back, cone;
  vg_status st;

  VG_TRY(check_extent(e, err));
  out->shape = (struct vg_revolution){ .n = VG_MACH_CORNERS,
                                       .profile = out->corner };
  for (int k = 0; k < 3; k++) out->shape.origin[k] = centre[k];
  VG_TRY(take_axis(e, half, &out->shape, err));
  b = measure(body, &out->shape, 1 / cot);
  out->cap = fmax(b.cap, CAP_LEAST * e->upstream * length);
  if (!(fmax(b.radius, out->cap) <= RADIAL_ROOM * radius)) {
    const double *x = body->point[b.widest];

    return vg_fail(err, VG_ERR_GEOMETRY,
                   "farfield mach: the domain has a radius of %.6g (radial "
                   "%g), but point %zu (%.9g, %.9g, %.9g) of the body is %.6g "
                   "from the axis, and the upstream cap has a radius of %.6g; "
                   "increase radial to %.3g or more",
                   radius, e->radial, b.widest + 1, x[0], x[1], x[2], b.radius,
                   out->cap,
                   1.01 * fmax(b.radius, out->cap) / RADIAL_ROOM / length);
  }
  front = b.front - e->upstream * length;
  back = b.back + e->downstream * length;
  cone = (radius - out->cap) * cot;
  out->window = back - front;
  {
    const double corner[VG_MACH_CORNERS][2] = { { front, 0 },
                                                { front, out->cap },
                                                { front + cone, radius },
                                                { back + cone, radius },
                                                { back, out->cap },
                                                { back, 0 } };

    for (int i = 0; i < VG_MACH_CORNERS; i++)
      for (int k = 0; k < 2; k++) out->corner[i][k] = corner[i][k];
  }
done:
  return st;
}

void vg_mach_bounds(const struct vg_mach *d, double lo[3], double hi[3])
{
  for (int k = 0; k < 3; k++) {
    const double a = d->shape.axis[k], wide = sqrt(fmax(0, 1 - a * a));

    lo[k] = INFINITY;
    hi[k] = -INFINITY;
    for (int i = 0; i < VG_MACH_CORNERS; i++) {
      const double at = d->shape.origin[k] + d->corner[i][0] * a;

      lo[k] = fmin(lo[k], at - d->corner[i][1] * wide);
      hi[k] = fmax(hi[k], at + d->corner[i][1] * wide);
    }
  }
}

double vg_mach_edge(const struct vg_mach *d, const double x[3])
{
  double z, radius;

  vg_revolution_locate(&d->shape, x, &z, &radius);
  return fmin(ROUND * fmax(radius, d->cap), d->window / WINDOW_EDGES);
}
