/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Smooth functions with exact derivatives. They are only used for reports and
 * call libm. */
#include "core/accuracy/analytic.h"

#include <math.h>
#include <string.h>

#include "core/geometry/vector.h"

/* Coordinates relative to the centre, in lengths. */
static void scaled(const struct vg_field_scale *s, const struct vg_place *p,
                   double y[3])
{
  for (int k = 0; k < 3; k++) y[k] = (p->x[k] - s->centre[k]) / s->length;
}

static void rescale(const struct vg_field_scale *s, struct vg_field_value *out)
{
  for (int k = 0; k < 3; k++) out->gradient[k] /= s->length;
  out->laplacian /= s->length * s->length;
}

static void linear(const struct vg_field_scale *s, const struct vg_place *p,
                   struct vg_field_value *out)
{
  static const double a[3] = { 1, 0.7, -0.4 };
  double y[3];

  scaled(s, p, y);
  out->value = 1 + vg_dot(a, y);
  memcpy(out->gradient, a, sizeof a);
  out->laplacian = 0;
  rescale(s, out);
}

static void quadratic(const struct vg_field_scale *s, const struct vg_place *p,
                      struct vg_field_value *out)
{
  static const double q[3][3] = { { 1, 0.3, -0.2 },
                                  { 0.3, 0.8, 0.4 },
                                  { -0.2, 0.4, 0.6 } };
  double y[3];

  scaled(s, p, y);
  out->value = 0;
  for (int k = 0; k < 3; k++) {
    out->gradient[k] = 2 * vg_dot(q[k], y);
    out->value += y[k] * vg_dot(q[k], y);
  }
  out->laplacian = 2 * (q[0][0] + q[1][1] + q[2][2]);
  rescale(s, out);
}

/* The sphere has the radius a = 1/4; within a / 2, where the potential is
 * singular, r is a / 2. */
static void sphere(const struct vg_field_scale *s, const struct vg_place *p,
                   struct vg_field_value *out)
{
  const double a = 0.25;
  double y[3], r, dipole;

  scaled(s, p, y);
  r = fmax(vg_norm(y), 0.5 * a);
  dipole = 0.5 * a * a * a / (r * r * r);
  out->value = y[0] * (1 + dipole);
  for (int k = 0; k < 3; k++)
    out->gradient[k] = (k ? 0 : 1 + dipole) -
                       3 * dipole * y[0] * y[k] / (r * r);
  out->laplacian = 0;
  rescale(s, out);
}

/* The axis is along x, the core has the radius c = 1/10. */
static void vortex(const struct vg_field_scale *s, const struct vg_place *p,
                   struct vg_field_value *out)
{
  const double c2 = 0.01;
  double y[3], r2, t, f, df;

  scaled(s, p, y);
  r2 = y[1] * y[1] + y[2] * y[2];
  t = r2 / c2;
  /* f = (1 - exp(-t)) / r2, df = its derivative by r2 */
  if (t > 1e-3) {
    f = -expm1(-t) / r2;
    df = (exp(-t) / c2 - f) / r2;
  } else {
    f = (1 - t / 2 + t * t / 6) / c2;
    df = (-0.5 + t / 3 - t * t / 8) / (c2 * c2);
  }
  out->value = -y[2] * f;
  out->gradient[0] = 0;
  out->gradient[1] = -2 * y[1] * y[2] * df;
  out->gradient[2] = -f - 2 * y[2] * y[2] * df;
  out->laplacian = 4 * y[2] * exp(-t) / (c2 * c2);
  rescale(s, out);
}

/* The layer is not aligned with an axis; its half width is 1/20. */
static void shear(const struct vg_field_scale *s, const struct vg_place *p,
                  struct vg_field_value *out)
{
  static const double n[3] = { 1 / 3., 2 / 3., 2 / 3. };
  const double width = 0.05;
  double y[3], f, slope;

  scaled(s, p, y);
  f = tanh(vg_dot(n, y) / width);
  slope = (1 - f * f) / width;
  out->value = f;
  for (int k = 0; k < 3; k++) out->gradient[k] = slope * n[k];
  out->laplacian = -2 * f * slope / width;
  rescale(s, out);
}

/* Reichardt (1951): u+ as a function of y+, for all y+. */
static void wall(const struct vg_field_scale *s, const struct vg_place *p,
                 struct vg_field_value *out)
{
  const double kappa = 0.4, a = 1 / 11., b = 0.33, c = 7.8;
  const double y = p->distance / s->viscous, log_part = 1 + kappa * y;
  const double slow = exp(-a * y), fast = exp(-b * y);
  const double slope = 1 / log_part + c * a * (slow - (1 - b * y) * fast);

  out->value = log1p(kappa * y) / kappa + c * (1 - slow - a * y * fast);
  for (int k = 0; k < 3; k++)
    out->gradient[k] = slope * p->normal[k] / s->viscous;
  out->laplacian = (c * a * (b * (2 - b * y) * fast - a * slow) -
                    kappa / (log_part * log_part)) /
                   (s->viscous * s->viscous);
}

const struct vg_field vg_fields[VG_FIELDS] = {
  [VG_FIELD_LINEAR] = { "degree 1", 0, 0, linear },
  [VG_FIELD_QUADRATIC] = { "degree 2", 0, 1, quadratic },
  [VG_FIELD_SPHERE] = { "sphere", 0, 0, sphere },
  [VG_FIELD_VORTEX] = { "vortex", 0, 1, vortex },
  [VG_FIELD_SHEAR] = { "shear layer", 0, 1, shear },
  [VG_FIELD_WALL] = { "wall profile", 1, 1, wall }
};

const char *vg_accuracy_field_name(enum vg_accuracy_field f)
{
  return vg_fields[f].name;
}

const char *vg_accuracy_zone_name(enum vg_accuracy_zone z)
{
  static const char *const name[VG_ZONES] = {
    [VG_ZONE_SUBLAYER] = "y+ 0 to 5", [VG_ZONE_BUFFER] = "y+ 5 to 30",
    [VG_ZONE_LOG] = "y+ 30 to 1000",  [VG_ZONE_FIELD] = "field",
    [VG_ZONE_FAR] = "far from walls", [VG_ZONE_LAYERS] = "y+ 0 to 1000",
    [VG_ZONE_ALL] = "whole mesh"
  };

  return name[z];
}
