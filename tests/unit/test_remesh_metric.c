/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Surfaces remeshed in the metric of a stretched sizing field: planes and a
 * cylinder in random smooth metrics, sizes of the shape, and fixed patches. */
#include "remesh_shapes.h"

#include "core/geometry/tensor.h"
#include "core/remesh/remesh.h"
#include "core/sizing/sizing.h"

/* --- metrics -------------------------------------------------------------- */

/* The size across a direction that turns in space varies around `h` by a
 * factor of up to 1.5 both ways; along it sizes are smaller by the aspect. */
struct smooth {
  double h, aspect, wave[3][3], phase[3];
};

static struct smooth draw_metric(uint32_t seed, double h, double aspect)
{
  /* Within the length of an edge, its direction turns by a small part of its
   * width. */
  const double turn = 1.2 * fmin(1, 10 / aspect);
  struct smooth s = { .h = h, .aspect = aspect };

  for (int i = 0; i < 3; i++) {
    for (int k = 0; k < 3; k++) {
      seed = seed * 1664525u + 1013904223u;
      s.wave[i][k] = turn * ((double)(seed >> 8) / (1 << 24) - 0.5);
    }
    seed = seed * 1664525u + 1013904223u;
    s.phase[i] = 2 * M_PI * (double)(seed >> 8) / (1 << 24);
  }
  return s;
}

static void smooth_metric(void *user, const double x[3], double m[6])
{
  const struct smooth *s = user;
  double value[3], d[3], f[3], far, axis[3][3];

  for (int i = 0; i < 3; i++) f[i] = s->phase[i] + vg_dot(s->wave[i], x);
  d[0] = sin(f[0]) * cos(f[1]);
  d[1] = sin(f[0]) * sin(f[1]);
  d[2] = cos(f[0]);
  far = s->h * exp(0.4 * sin(f[2] + 2 * x[0] - x[1]));
  memcpy(axis[0], d, sizeof d);
  axis[1][0] = axis[1][1] = axis[1][2] = 0;
  axis[1][fabs(d[0]) < 0.6 ? 0 : 1] = 1;
  vg_cross(d, axis[1], axis[2]);
  vg_unit(axis[2]);
  vg_cross(axis[2], d, axis[1]);
  value[0] = s->aspect * s->aspect / (far * far);
  value[1] = value[2] = 1 / (far * far);
  vg_tensor_from_eigen(value, (const double(*)[3])axis, m);
}

static double smooth_size(void *user, const double x[3])
{
  (void)x;
  return ((const struct smooth *)user)->h;
}

static struct vg_sizing *make_field(struct smooth *metric,
                                    const struct vg_mesh *m)
{
  const struct vg_size_map map = { .at = smooth_size,
                                   .metric = smooth_metric,
                                   .most = 2 * metric->h,
                                   .user = metric };
  struct vg_sizing_options o = VG_SIZING_OPTIONS_INIT;
  struct vg_sizing *s = NULL;
  struct vg_error err = VG_ERROR_INIT;

  o.map = &map;
  o.from_surface = 0;
  o.h_max = 2 * metric->h;
  if (vg_sizing_new(&o, 0, NULL, m, &s, &err) < 0) fail_msg("%s", err.text);
  assert_true(vg_sizing_is_stretched(s));
  return s;
}

/* --- checks --------------------------------------------------------------- */

struct lengths {
  size_t n, n_fit;
  double least, most;
};

/* Length of an edge in the metric at its ends. */
static double length_of(const struct vg_sizing *field, const double *a,
                        const double *b)
{
  double t[6], e[3], v[3], l[2];

  vg_sub(b, a, e);
  for (int i = 0; i < 2; i++) {
    vg_sizing_stretch_at(field, i ? b : a, t);
    vg_tensor_apply(t, e, v);
    l[i] = vg_norm(v);
  }
  return vg_log_mean(l[0], l[1]);
}

/* Lengths of the edges of all triangles but those of fixed patches; most count
 * twice. */
static struct lengths measure(const struct vg_mesh *m,
                              const struct vg_sizing *field,
                              const uint8_t *fixed)
{
  struct lengths r = { 0, 0, INFINITY, 0 };

  for (size_t t = 0; t < m->n_tri; t++)
    for (int k = 0; k < 3 && !(fixed && fixed[m->tri_patch[t]]); k++) {
      const double l = length_of(field, m->point[m->tri[t][k]],
                                 m->point[m->tri[t][(k + 1) % 3]]);

      r.n++;
      r.n_fit += l >= 0.71 && l <= 1.41;
      r.least = fmin(r.least, l);
      r.most = fmax(r.most, l);
    }
  return r;
}

static void remesh(struct vg_mesh *m, const struct vg_remesh_options *o,
                   struct vg_remesh_report *r)
{
  struct vg_error err = VG_ERROR_INIT;

  if (vg_remesh(m, o, r, &err) < 0) fail_msg("%s", err.text);
}

/* --- tests ---------------------------------------------------------------- */

/* The faces of a box are remeshed from two triangles each. The share of fitting
 * edges in a uniform metric is 98 %; others are due to its variation and to
 * corners of the box whose angles are small in the metric: edges across them
 * are short. */
static void planes_follow_random_metrics(void **unused)
{
  const double size[3] = { 1, 1, 1 };
  const double aspect[3] = { 5, 20, 100 }, share[3] = { 0.95, 0.93, 0.93 };
  const uint32_t n[3] = { 1, 1, 1 };

  (void)unused;
  for (uint32_t i = 0; i < 5; i++) {
    struct smooth metric = draw_metric(i + 1, i == 2 ? 0.25 : 0.15,
                                       aspect[i % 3]);
    struct vg_mesh m = VG_MESH_INIT;
    struct vg_remesh_options o = VG_REMESH_OPTIONS_INIT;
    struct vg_remesh_report r = VG_REMESH_REPORT_INIT;
    struct vg_sizing *field;
    struct lengths l;

    shape_box(&m, size, n);
    field = make_field(&metric, &m);
    o.field = field;
    o.h_max = 1;
    remesh(&m, &o, &r);
    l = measure(&m, field, NULL);
    shape_expect_sound(&m, 0);
    for (size_t p = 0; p < 6; p++)
      assert_float_equal(shape_area(&m, p), 1, 1e-12);
    assert_true((double)l.n_fit > share[i % 3] * (double)l.n);
    assert_true(l.most < 2);
    vg_remesh_report_release(&r);
    vg_sizing_free(field);
    vg_mesh_release(&m);
  }
}

/* A cylinder with its axis along z, of 2 n facets. */
static void shape_cylinder(struct vg_mesh *m, double radius, double height,
                           uint32_t n)
{
  const uint32_t k = 2 * n;

  for (int i = 0; i < 3; i++) vg_mesh_add_patch(m, i + 1, NULL);
  for (uint32_t i = 0; i < k; i++)
    for (int end = 0; end < 2; end++)
      shape_point(m, radius * cos(2 * M_PI * i / k),
                  radius * sin(2 * M_PI * i / k), end ? height : 0);
  shape_point(m, 0, 0, 0);
  shape_point(m, 0, 0, height);
  for (uint32_t i = 0; i < k; i++) {
    const uint32_t a = 2 * i, b = 2 * ((i + 1) % k);

    shape_tri(m, a, b, b + 1, 0);
    shape_tri(m, a, b + 1, a + 1, 0);
    shape_tri(m, 2 * k, b, a, 1);
    shape_tri(m, 2 * k + 1, a + 1, b + 1, 2);
  }
  shape_weld(m);
}

/* On a cylinder, the shape limits the lengths around the axis: 24 edges per
 * turn. The report counts edges in the intersection of both. */
static void cylinder_follows_random_metrics(void **unused)
{
  const double aspect[3] = { 5, 20, 100 };

  (void)unused;
  for (uint32_t i = 0; i < 3; i++) {
    struct smooth metric = draw_metric(i + 100, i < 2 ? 0.2 : 0.5, aspect[i]);
    struct vg_mesh m = VG_MESH_INIT, old = VG_MESH_INIT;
    struct vg_remesh_options o = VG_REMESH_OPTIONS_INIT;
    struct vg_remesh_report r = VG_REMESH_REPORT_INIT;
    struct vg_remesh_distance d[2];
    struct vg_error err = VG_ERROR_INIT;
    struct vg_sizing *field;

    shape_cylinder(&m, 0.5, 1, 100);
    assert_int_equal(vg_mesh_copy(&old, &m, &err), VG_OK);
    field = make_field(&metric, &m);
    o.field = field;
    o.h_max = 1;
    o.tolerance = 1e-3;
    remesh(&m, &o, &r);
    shape_expect_sound(&m, 0);
    assert_int_equal(vg_remesh_measure(&m, &old, 1, NULL, NULL, d, &err),
                     VG_OK);
    /* at ridges of 90 degrees: the tolerance by the cosine of 20 degrees */
    assert_true(fmax(d[0].most, d[1].most) < 1.07e-3);
    assert_true((double)r.n_edge_fit > 0.95 * (double)r.n_edge);
    assert_int_equal(r.n_bad, 0);
    vg_remesh_report_release(&r);
    vg_sizing_free(field);
    vg_mesh_release(&m);
    vg_mesh_release(&old);
  }
}

/* Where the shape requests smaller sizes than the metric, they hold: a ball in
 * a metric of large sizes has the same number of triangles as without. */
static void shape_limits_the_metric(void **unused)
{
  const double size[3] = { 1, 1, 1 };
  size_t n_tri[2];

  (void)unused;
  for (int i = 0; i < 2; i++) {
    struct smooth metric = draw_metric(7, 40, 2);
    struct vg_mesh m = VG_MESH_INIT;
    struct vg_remesh_options o = VG_REMESH_OPTIONS_INIT;
    struct vg_sizing *field;

    shape_ball(&m, size, 60);
    field = make_field(&metric, &m);
    if (i) o.field = field;
    o.h_max = 1;
    o.tolerance = 2e-3;
    remesh(&m, &o, NULL);
    shape_expect_sound(&m, 0);
    n_tri[i] = m.n_tri;
    vg_sizing_free(field);
    vg_mesh_release(&m);
  }
  assert_in_range(n_tri[1], (size_t)(0.95 * (double)n_tri[0]),
                  (size_t)(1.05 * (double)n_tri[0]));
}

/* Triangles of fixed patches stay, and the others follow the metric up to
 * them. */
static void fixed_patches_stay(void **unused)
{
  const double size[3] = { 1, 1, 1 };
  const uint32_t n[3] = { 9, 9, 9 };
  const uint8_t fixed[6] = { 1, 0, 0, 0, 0, 1 };
  struct smooth metric = draw_metric(3, 0.2, 20);
  struct vg_mesh m = VG_MESH_INIT, old = VG_MESH_INIT;
  struct vg_remesh_options o = VG_REMESH_OPTIONS_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_sizing *field;
  struct lengths l;
  size_t n_fixed[2] = { 0, 0 };

  (void)unused;
  shape_box(&m, size, n);
  assert_int_equal(vg_mesh_copy(&old, &m, &err), VG_OK);
  field = make_field(&metric, &m);
  o.field = field;
  o.h_max = 1;
  o.fixed = fixed;
  remesh(&m, &o, NULL);
  shape_expect_sound(&m, 0);
  for (int i = 0; i < 2; i++) {
    const struct vg_mesh *of = i ? &m : &old;

    for (size_t t = 0; t < of->n_tri; t++)
      n_fixed[i] += fixed[of->tri_patch[t]];
  }
  assert_int_equal(n_fixed[0], n_fixed[1]);
  for (size_t t = 0; t < m.n_tri; t++) {
    size_t at = 0;

    if (!fixed[m.tri_patch[t]]) continue;
    while (at < old.n_tri &&
           (old.tri_patch[at] != m.tri_patch[t] ||
            vg_distance2(m.point[m.tri[t][0]], old.point[old.tri[at][0]]) +
                vg_distance2(m.point[m.tri[t][1]], old.point[old.tri[at][1]]) +
                vg_distance2(m.point[m.tri[t][2]], old.point[old.tri[at][2]]) >
              0))
      at++;
    assert_true(at < old.n_tri);
  }
  l = measure(&m, field, fixed);
  assert_true((double)l.n_fit > 0.85 * (double)l.n);
  vg_sizing_free(field);
  vg_mesh_release(&m);
  vg_mesh_release(&old);
}

static void threads_do_not_matter(void **unused)
{
  const double size[3] = { 1, 1, 1 };
  const uint32_t n[3] = { 1, 1, 1 };
  struct smooth metric = draw_metric(5, 0.1, 20);
  struct vg_mesh m[2] = { VG_MESH_INIT, VG_MESH_INIT };

  (void)unused;
  for (int i = 0; i < 2; i++) {
    struct vg_remesh_options o = VG_REMESH_OPTIONS_INIT;
    struct vg_sizing *field;

    shape_box(&m[i], size, n);
    field = make_field(&metric, &m[i]);
    o.field = field;
    o.h_max = 1;
    o.threads = 1 + 2 * i;
    remesh(&m[i], &o, NULL);
    vg_sizing_free(field);
  }
  assert_true(m[0].n_tri > 12000); /* two blocks at least */
  assert_int_equal(m[0].n_tri, m[1].n_tri);
  assert_int_equal(m[0].n_point, m[1].n_point);
  assert_memory_equal(m[0].point, m[1].point,
                      m[0].n_point * sizeof *m[0].point);
  assert_memory_equal(m[0].tri, m[1].tri, m[0].n_tri * sizeof *m[0].tri);
  vg_mesh_release(&m[0]);
  vg_mesh_release(&m[1]);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(planes_follow_random_metrics),
    cmocka_unit_test(cylinder_follows_random_metrics),
    cmocka_unit_test(shape_limits_the_metric),
    cmocka_unit_test(fixed_patches_stay),
    cmocka_unit_test(threads_do_not_matter),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
