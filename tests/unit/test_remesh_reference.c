/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Reference surfaces with the faults of tessellations: short edges, folds,
 * flaps, intersecting sheets, long feature edges. The remeshed surface is
 * checked. */
#include "remesh_shapes.h"

#include "core/remesh/remesh.h"

static const double one[3] = { 1, 1, 1 };

static void remesh(struct vg_mesh *m, const struct vg_remesh_options *o,
                   struct vg_remesh_report *r)
{
  struct vg_error err = VG_ERROR_INIT;

  if (vg_remesh(m, o, r, &err) < 0) fail_msg("%s", err.text);
}

/* Insert a point into triangle t, at these barycentric coordinates. */
static uint32_t divide(struct vg_mesh *m, size_t t, double a, double b,
                       double c)
{
  const uint32_t v[3] = { m->tri[t][0], m->tri[t][1], m->tri[t][2] };
  const uint32_t patch = m->tri_patch[t];
  double x[3];
  uint32_t p;

  for (int k = 0; k < 3; k++)
    x[k] = a * m->point[v[0]][k] + b * m->point[v[1]][k] +
           c * m->point[v[2]][k];
  p = shape_point(m, x[0], x[1], x[2]);
  m->tri[t][2] = p;
  shape_tri(m, v[1], v[2], p, patch);
  shape_tri(m, v[2], v[0], p, patch);
  return p;
}

/* Edges of 1e-9 produce neither corners nor triangles of their size. */
static void collapses_short_edges(void **unused)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_remesh_options o = VG_REMESH_OPTIONS_INIT;
  struct vg_remesh_report r = VG_REMESH_REPORT_INIT;

  (void)unused;
  shape_ball(&m, one, 16);
  for (size_t t = 100; t < 120; t++) divide(&m, t, 1 - 2e-9, 1e-9, 1e-9);
  o.h_max = 0.2;
  o.is_reference = 1;
  remesh(&m, &o, &r);
  assert_true(r.n_clean >= 20);
  assert_true(r.angle_min > 25);
  shape_expect_sound(&m, 0);
  vg_remesh_report_release(&r);
  vg_mesh_release(&m);
}

/* Points of the upper side of a plate that are below its lower side. */
static void repairs_crossings(void **unused)
{
  const double size[3] = { 1, 1, 0.02 };
  const uint32_t n[3] = { 12, 12, 1 };
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_remesh_options o = VG_REMESH_OPTIONS_INIT;
  struct vg_remesh_report r = VG_REMESH_REPORT_INIT;
  size_t n_moved = 0;

  (void)unused;
  shape_box(&m, size, n);
  for (size_t p = 0; p < m.n_point; p++) {
    double *x = m.point[p];

    if (!(x[2] > 0.01) || fabs(x[0] - 0.5) > 1e-9) continue;
    if (!(x[1] > 0.2 && x[1] < 0.8)) continue;
    x[2] = -0.002;
    n_moved++;
  }
  assert_true(n_moved > 3);
  o.h_max = 0.1;
  o.tolerance = 0.01;
  o.is_reference = 1;
  remesh(&m, &o, &r);
  assert_true(r.n_crossing[0] > 3);
  assert_int_equal(r.n_crossing[1], 0);
  assert_true(r.crossing_depth > 0.001 && r.crossing_depth <= 0.0021);
  shape_expect_sound(&m, 0);
  vg_remesh_report_release(&r);
  vg_mesh_release(&m);
}

/* Two triangles back to back on an edge, as at the end of a cusp. */
static void drops_flaps(void **unused)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_remesh_options o = VG_REMESH_OPTIONS_INIT;
  struct vg_remesh_report r = VG_REMESH_REPORT_INIT;
  uint32_t a, b, x;

  (void)unused;
  shape_ball(&m, one, 16);
  a = m.tri[200][0];
  b = m.tri[200][1];
  x = shape_point(&m, m.point[a][0] * 1.0001, m.point[a][1] * 1.0001,
                  m.point[a][2] * 1.0001);
  shape_tri(&m, a, b, x, m.tri_patch[200]);
  shape_tri(&m, b, a, x, m.tri_patch[200]);
  o.h_max = 0.2;
  o.tolerance = 0.01;
  o.is_reference = 1;
  remesh(&m, &o, &r);
  shape_expect_sound(&m, 0);
  assert_true(r.angle_min > 25);
  vg_remesh_report_release(&r);
  vg_mesh_release(&m);
}

/* Boxes that intersect by more than any tolerance hides. */
static void refuses_large_crossings(void **unused)
{
  const uint32_t n[3] = { 2, 2, 2 };
  struct vg_mesh m = VG_MESH_INIT, b = VG_MESH_INIT;
  struct vg_remesh_options o = VG_REMESH_OPTIONS_INIT;
  struct vg_error err = VG_ERROR_INIT;
  uint32_t first;
  size_t n_tri;

  (void)unused;
  shape_box(&m, one, n);
  shape_box(&b, one, n);
  first = (uint32_t)m.n_point;
  for (size_t p = 0; p < b.n_point; p++)
    shape_point(&m, b.point[p][0] + 0.31, b.point[p][1] + 0.31,
                b.point[p][2] + 0.31);
  for (size_t t = 0; t < b.n_tri; t++)
    shape_tri(&m, b.tri[t][0] + first, b.tri[t][1] + first, b.tri[t][2] + first,
              0);
  vg_mesh_release(&b);
  n_tri = m.n_tri;
  o.h_max = 0.2;
  o.is_reference = 1;
  assert_int_equal(vg_remesh(&m, &o, NULL, &err), VG_ERR_GEOMETRY);
  assert_non_null(strstr(err.text, "near ("));
  assert_int_equal(m.n_tri, n_tri);
  vg_mesh_release(&m);
}

/* All corners of a side with a point in its middle. */
static void shape_fan(struct vg_mesh *m, const uint32_t *v, uint32_t n)
{
  double x[3] = { 0, 0, 0 };
  uint32_t p;

  for (uint32_t i = 0; i < n; i++)
    for (int k = 0; k < 3; k++) x[k] += m->point[v[i]][k] / n;
  p = shape_point(m, x[0], x[1], x[2]);
  for (uint32_t i = 0; i < n; i++) shape_tri(m, v[i], v[(i + 1) % n], p, 0);
}

/* A polygon in x and z, extruded from y = 0 to 1. */
static void shape_prism(struct vg_mesh *m, const double (*at)[2], uint32_t n)
{
  uint32_t end[2][16];

  vg_mesh_add_patch(m, 1, NULL);
  for (uint32_t i = 0; i < 2 * n; i++) {
    shape_point(m, at[i % n][0], i / n, at[i % n][1]);
    end[i / n][i / n ? 2 * n - 1 - i : i] = i;
  }
  shape_fan(m, end[0], n);
  shape_fan(m, end[1], n);
  for (uint32_t i = 0; i < n; i++) {
    const uint32_t k = (i + 1) % n, side[4] = { i, n + i, n + k, k };

    shape_fan(m, side, 4);
  }
  shape_weld(m);
}

/* A long edge between two narrow chamfers, which require small sizes at both
 * its ends but not in its middle. */
static void cuts_long_lines(void **unused)
{
  const double c = 0.01;
  const double at[][2] = { { c, 0 }, { 4 - c, 0 }, { 4, c },
                           { 4, 1 }, { 0, 1 },     { 0, c } };
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_remesh_options o = VG_REMESH_OPTIONS_INIT;
  struct vg_remesh_report r = VG_REMESH_REPORT_INIT;
  size_t n_middle = 0;

  (void)unused;
  shape_prism(&m, at, sizeof at / sizeof *at);
  o.h_max = 0.5;
  remesh(&m, &o, &r);
  shape_expect_sound(&m, 0);
  for (size_t p = 0; p < m.n_point; p++)
    n_middle += fabs(m.point[p][1]) + fabs(m.point[p][2]) < 1e-9 &&
                fabs(m.point[p][0] - 2) < 1;
  /* Two lengths at sizes of 0.2 and more; at the chamfers' it would be 140. */
  assert_true(n_middle > 2 && n_middle < 14);
  assert_true(r.angle_min > 15);
  vg_remesh_report_release(&r);
  vg_mesh_release(&m);
}

/* --- random search ------------------------------------------------------- */

static double uniform(uint32_t *seed)
{
  *seed = *seed * 1664525u + 1013904223u;
  return (*seed >> 8) * (1.0 / 16777216);
}

/* A lens with a sharp edge all around, of thickness `edge` there. */
static void shape_lens(struct vg_mesh *m, double thick, double edge, uint32_t n)
{
  const double r[3] = { 1, 1, 1 };

  shape_ball(m, r, n);
  for (size_t p = 0; p < m->n_point; p++) {
    double *x = m->point[p];
    const double q = x[0] * x[0] + x[1] * x[1];

    x[2] = (x[2] > 1e-9) - (x[2] < -1e-9)
           ? (x[2] > 0 ? 1 : -1) * (thick * (1 - q) + edge / 2)
           : 0;
  }
}

static void disturb(struct vg_mesh *m, double by, uint32_t *seed)
{
  for (size_t p = 0; p < m->n_point; p++)
    for (int k = 0; k < 3; k++) m->point[p][k] += by * (2 * uniform(seed) - 1);
}

/* Any fault ends in a valid surface within the tolerance, or in a refusal that
 * names a location. */
static void random_faults(void **unused)
{
  size_t n_done = 0;

  (void)unused;
  for (uint32_t i = 0; i < 40; i++) {
    const double tolerance = 0.005;
    uint32_t seed = 77 + i;
    struct vg_mesh m = VG_MESH_INIT, old = VG_MESH_INIT;
    struct vg_remesh_options o = VG_REMESH_OPTIONS_INIT;
    struct vg_error err = VG_ERROR_INIT;
    double noise = tolerance * uniform(&seed) / 3;
    size_t n;

    shape_lens(&m, 0.02 + 0.2 * uniform(&seed),
               i % 3 ? tolerance * uniform(&seed) : 0,
               8 + (uint32_t)(8 * uniform(&seed)));
    n = m.n_tri;
    for (int k = 0; k < 6; k++)
      divide(&m, (size_t)((double)n * uniform(&seed)), i % 2 ? -0.01 : 1e-8,
             0.5, i % 2 ? 0.51 : 0.5 - 1e-8);
    disturb(&m, noise, &seed);
    assert_int_equal(vg_mesh_copy(&old, &m, &err), VG_OK);
    o.h_max = 0.15 + 0.2 * uniform(&seed);
    o.h_min = 0.02;
    o.tolerance = tolerance;
    o.is_reference = 1;
    if (vg_remesh(&m, &o, NULL, &err) < 0) {
      if (!strstr(err.text, "near (")) fail_msg("%u: %s", i, err.text);
    } else {
      struct vg_remesh_distance d[2];

      shape_expect_sound(&m, 0);
      assert_int_equal(vg_remesh_measure(&m, &old, 1, NULL, NULL, d, &err),
                       VG_OK);
      /* The repair moves the reference surface by at most one tolerance, and
       * the remeshed surface deviates by at most one from that. */
      assert_true(fmax(d[0].most, d[1].most) < 2.2 * tolerance);
      n_done++;
    }
    vg_mesh_release(&m);
    vg_mesh_release(&old);
  }
  assert_true(n_done >= 30);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(collapses_short_edges),
    cmocka_unit_test(repairs_crossings),
    cmocka_unit_test(drops_flaps),
    cmocka_unit_test(refuses_large_crossings),
    cmocka_unit_test(cuts_long_lines),
    cmocka_unit_test(random_faults),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
