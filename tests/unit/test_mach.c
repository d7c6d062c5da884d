/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The farfield that is swept along the Mach cone. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "ball_support.h"
#include "core/domain/farfield.h"
#include "core/domain/mach.h"
#include "core/geometry/vector.h"
#include "core/mesh/mesh_defects.h"

#define PI 3.14159265358979324

static double length_of(const struct vg_mesh *m)
{
  double lo[3], hi[3];

  vg_mesh_bounds(m, lo, hi);
  return fmax(hi[0] - lo[0], fmax(hi[1] - lo[1], hi[2] - lo[2]));
}

/* Volume enclosed by the faces, positive if normals point into it. */
static double volume(const struct vg_mesh *m)
{
  double sum = 0;

  for (size_t i = 0; i < m->n_tri; i++) {
    double n[3];

    vg_cross(m->point[m->tri[i][1]], m->point[m->tri[i][2]], n);
    sum -= vg_dot(m->point[m->tri[i][0]], n) / 6;
  }
  return sum;
}

/* Volume of the solid of revolution of a profile. */
static double solid(const struct vg_mach *d)
{
  double sum = 0;

  for (int i = 0; i + 1 < VG_MACH_CORNERS; i++) {
    const double *p = d->corner[i], *q = d->corner[i + 1];

    sum += (q[0] - p[0]) * (p[1] * p[1] + p[1] * q[1] + q[1] * q[1]);
  }
  return sum * PI / 3;
}

static const struct scene {
  double mach, flow[3], centre[3];
  int half;
} scenes[] = {
  { 1.6, { 1, 0, 0 }, { 0, 0, 0 }, -1 },
  { 1.05, { 1, 0, 0 }, { 3, 1, -2 }, -1 },
  { 4, { -2, 0, 0 }, { 0, 0, 0 }, -1 },
  { 2, { 0.99, 0, 0.14 }, { 1, 0.3, 0 }, 3 },
  { 1.4, { 0.9, 0.2, 0.1 }, { 0, 0, 0 }, -1 },
  { 1.4, { 0, 0, 1 }, { 0, 0, 0.5 }, 0 },
};

enum { N_SCENE = sizeof scenes / sizeof *scenes };

static struct vg_farfield farfield_of(const struct scene *c, double spacing)
{
  struct vg_farfield far = VG_FARFIELD_INIT;

  far.kind = VG_FARFIELD_MACH;
  far.symmetry = c->half < 0 ? -1 : 1;
  far.has_centre = 1;
  memcpy(far.centre, c->centre, sizeof far.centre);
  far.extent.mach = c->mach;
  memcpy(far.extent.flow, c->flow, sizeof c->flow);
  far.extent.radial = 3;
  far.spacing = spacing;
  return far;
}

/* Closed, oriented into the fluid, around the body, and of the expected
 * volume. Chords of the circles cut off less than 1 % with edges of 0.15
 * radii. */
static void is_closed_around_the_body(void **state)
{
  (void)state;
  for (int i = 0; i < N_SCENE; i++) {
    const struct scene *c = &scenes[i];
    struct vg_mesh m = ball(c->centre, c->half, 0.3);
    const struct vg_farfield far = farfield_of(c, 0.9);
    struct vg_domain_report report = { 0 };
    struct vg_error err = VG_ERROR_INIT;
    struct vg_mach d;
    double want, lo[3], hi[3];

    assert_int_equal(vg_mach_place(&m, &far.extent, length_of(&m), c->centre,
                                   c->half, &d, &err),
                     VG_OK);
    want = (solid(&d) - 4 * PI / 3) * (c->half < 0 ? 1 : 0.5);
    vg_domain_bounds(&m, &far, lo, hi);
    if (vg_domain_complete(&m, &far, NULL, &report, &err) != VG_OK)
      fail_msg("%s", err.text);
    for (size_t j = 0; j < m.n_point; j++)
      for (int k = 0; k < 3; k++)
        assert_true(m.point[j][k] > lo[k] && m.point[j][k] < hi[k]);
    assert_true(report.added_farfield);
    assert_int_equal(report.added_symmetry, c->half >= 0);
    assert_int_equal(vg_mesh_open_edges(&m), 0);
    assert_true(fabs(volume(&m) / want - 1) < 0.01);
    vg_mesh_release(&m);
  }
}

/* Face of the domain with this point, from the profile: 0 and 1 the inflow and
 * outflow cone, 2 a cap or the cylinder; -1: none. Points of two faces are on
 * the cone. */
static int face_of(const struct vg_mach *d, double mach, const double x[3])
{
  const double cot = sqrt(mach * mach - 1), tol = 1e-9;
  double z, r;

  vg_revolution_locate(&d->shape, x, &z, &r);
  for (int i = 0; i < 2; i++)
    if (fabs(z - d->corner[i ? 4 : 1][0] - (r - d->cap) * cot) < tol) return i;
  return fabs(z - d->corner[0][0]) < tol || fabs(z - d->corner[5][0]) < tol ||
             fabs(r - d->corner[2][1]) < tol
         ? 2
         : -1;
}

/* Each point of the farfield is on the profile. The normal of a cone has the
 * component sin = 1 / M along the axis: that of a triangle is off by up to
 * 0.15, since a chord of 0.4 radii is 0.02 radii from the cone, and heights are
 * half as long; the mean by less than 1 %. */
static void check_generators(const struct scene *c)
{
  struct vg_mesh m = ball(c->centre, c->half, 0.3);
  const struct vg_farfield far = farfield_of(c, 0.5);
  struct vg_error err = VG_ERROR_INIT;
  struct vg_mach d;
  double sum[2] = { 0 }, area[2] = { 0 };

  assert_int_equal(vg_mach_place(&m, &far.extent, length_of(&m), c->centre,
                                 c->half, &d, &err),
                   VG_OK);
  assert_int_equal(vg_domain_complete(&m, &far, NULL, NULL, &err), VG_OK);
  for (size_t t = 0; t < m.n_tri; t++) {
    double a[3], b[3], n[3], along;
    int face[3];

    if (strcmp(m.patch[m.tri_patch[t]].name, "farfield") != 0) continue;
    for (int k = 0; k < 3; k++) {
      face[k] = face_of(&d, c->mach, m.point[m.tri[t][k]]);
      assert_true(face[k] >= 0);
    }
    if (face[0] == 2 || face[1] != face[0] || face[2] != face[0]) continue;
    vg_sub(m.point[m.tri[t][1]], m.point[m.tri[t][0]], a);
    vg_sub(m.point[m.tri[t][2]], m.point[m.tri[t][0]], b);
    vg_cross(a, b, n);
    along = vg_dot(n, d.shape.axis);
    if (fabs(along) > 0.999 * sqrt(vg_dot(n, n))) continue; /* of a cap */
    sum[face[0]] += along;
    area[face[0]] += sqrt(vg_dot(n, n));
    assert_true(fabs(fabs(along) / sqrt(vg_dot(n, n)) - 1 / c->mach) < 0.15);
  }
  assert_true(area[0] > 10 && area[1] > 10);
  assert_true(fabs(sum[0] / area[0] - 1 / c->mach) < 0.01);
  assert_true(fabs(sum[1] / area[1] + 1 / c->mach) < 0.01);
  vg_mesh_release(&m);
}

static void has_generators_at_the_mach_angle(void **state)
{
  (void)state;
  for (int i = 0; i < N_SCENE; i++) check_generators(&scenes[i]);
}

/* The body is as far behind the inflow face as its foremost point, and the
 * extents are those of the settings. */
static void keeps_its_extents(void **state)
{
  const double centre[3] = { 0, 0, 0 };
  struct vg_mesh m = ball(centre, -1, 0.3);
  struct vg_mach_extent e = { 1.5, { 1, 0, 0 }, 0.7, 1.3, 4 };
  struct vg_error err = VG_ERROR_INIT;
  const double tangent = 1 / sqrt(1.25);
  double front = INFINITY, back = -INFINITY, clear = INFINITY;
  struct vg_mach d;

  (void)state;
  assert_int_equal(vg_mach_place(&m, &e, 2, centre, -1, &d, &err), VG_OK);
  for (size_t i = 0; i < m.n_point; i++) {
    const double *x = m.point[i];

    front = fmin(front, x[0]);
    back = fmax(back, x[0]);
    clear = fmin(clear, (x[0] - d.corner[0][0]) * tangent + d.cap -
                          sqrt(x[1] * x[1] + x[2] * x[2]));
  }
  assert_true(fabs(d.corner[0][0] - (front - 1.4)) < 1e-12);
  assert_true(fabs(d.corner[5][0] - (back + 2.6)) < 1e-12);
  assert_true(d.corner[2][1] == 8 && d.corner[3][1] == 8);
  assert_true(clear >= 1.4 * tangent - 1e-12);
  assert_true(d.cap >= 0.25 * 1.4);
  vg_mesh_release(&m);
}

static void refuse(const struct vg_mach_extent *e, int half, vg_status want,
                   const char *text)
{
  const double centre[3] = { 0, 0, 0 };
  struct vg_mesh m = ball(centre, -1, 0.3);
  struct vg_error err = VG_ERROR_INIT;
  struct vg_mach d;

  assert_int_equal(vg_mach_place(&m, e, 2, centre, half, &d, &err), want);
  if (!strstr(err.text, text)) fail_msg("'%s' lacks '%s'", err.text, text);
  vg_mesh_release(&m);
}

static void refuses_bad_extents(void **state)
{
  const struct vg_mach_extent good = { 1.5, { 1, 0, 0 }, 0.7, 1.3, 4 };
  const double bad[] = { 0, -1, NAN, INFINITY };
  const double bad_mach[] = { 1, 0.5, -3, NAN, INFINITY };
  struct vg_mach_extent e;

  (void)state;
  for (size_t i = 0; i < sizeof bad_mach / sizeof *bad_mach; i++) {
    e = good;
    e.mach = bad_mach[i];
    refuse(&e, -1, VG_ERR_INPUT, "exists above 1 only; give");
  }
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    e = good;
    e.upstream = bad[i];
    refuse(&e, -1, VG_ERR_INPUT, "upstream is");
    e = good;
    e.downstream = bad[i];
    refuse(&e, -1, VG_ERR_INPUT, "downstream is");
    e = good;
    e.radial = bad[i];
    refuse(&e, -1, VG_ERR_INPUT, "radial is");
  }
  e = good;
  e.flow[0] = 0;
  refuse(&e, -1, VG_ERR_INPUT, "not zero");
  e = good;
  refuse(&e, 1, VG_ERR_INPUT, "ux must be 0");
  e.radial = 0.5;
  refuse(&e, -1, VG_ERR_GEOMETRY, "increase radial to 0.561");
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(is_closed_around_the_body),
    cmocka_unit_test(has_generators_at_the_mach_angle),
    cmocka_unit_test(keeps_its_extents),
    cmocka_unit_test(refuses_bad_extents),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
