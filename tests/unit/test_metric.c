/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Lengths and shapes measured by a tensor, and surfaces remeshed with a given
 * metric. */
#include "remesh_scene.h"

#include "core/remesh/metric.h"
#include "core/remesh/passes.h"

static const double round_form[6] = { 1, 1, 1, 0, 0, 0 };

/* Of the unit vector along (1, 2, 2). */
static const double oblique[3] = { 1. / 3, 2. / 3, 2. / 3 };

static void lengths_follow_the_direction(void **unused)
{
  struct vg_metric m = { 0.1, { 0 } };
  const double across[3] = { 0, 3, -3 }, along[3] = { 2, 4, 4 };
  double n[3], in_plane[3] = { 2, -1, 0 };

  (void)unused;
  vg_form_stretch(m.form, oblique, 5);
  assert_float_equal(vg_metric_along(&m, along), 0.5, 1e-12);
  assert_float_equal(vg_metric_along(&m, across), 0.1, 1e-12);
  assert_float_equal(vg_metric_along(&m, in_plane), 0.1, 1e-12);
  vg_cross(oblique, across, n);
  assert_float_equal(vg_form_aspect(m.form, n), 5, 1e-9);
  assert_float_equal(vg_form_aspect(m.form, oblique), 1, 1e-9);
  assert_float_equal(vg_form_aspect(round_form, n), 1, 1e-12);
}

/* Length 1 if the edge has the requested length at both ends; between different
 * sizes it is relative to their mean, in either direction. */
static void an_edge_has_the_mean_size_of_its_ends(void **unused)
{
  struct vg_metric a = { 0.1, { 0 } }, b = { 0.3, { 0 } };
  const double e[3] = { 0.1, 0.2, 0.2 }; /* 0.3 long */

  (void)unused;
  vg_form_stretch(a.form, oblique, 3);
  memcpy(b.form, round_form, sizeof b.form);
  assert_float_equal(vg_metric_ratio(&a, &a, e), 1, 1e-12);
  assert_float_equal(vg_metric_ratio(&a, &b, e), 1, 1e-12);
  memcpy(a.form, round_form, sizeof a.form);
  assert_float_equal(vg_metric_ratio(&a, &b, e), 1.5, 1e-12);
  assert_float_equal(vg_metric_ratio(&b, &a, e), 1.5, 1e-12);
  assert_float_equal(vg_metric_ratio(&a, &b, (double[3]){ 0, 0, 0 }), 0, 0);
}

/* An isotropic tensor gives the same result as no tensor; a triangle stretched
 * like the tensor is equilateral. */
static void shapes_are_those_before_stretching(void **unused)
{
  const double a[3] = { 0.2, 0.1, 0.4 }, b[3] = { 1.3, 0.2, 0.1 };
  const double c[3] = { 0.5, 0.9, 0.3 };
  double n[3], side[3], top[3], o[3] = { 0, 0, 0 }, form[6], u[3], v[3];

  (void)unused;
  assert_float_equal(vg_form_shape(round_form, a, b, c),
                     vg_form_shape(NULL, a, b, c), 1e-14);
  vg_cross(oblique, (double[3]){ 0, 1, -1 }, n);
  vg_unit(n);
  for (int k = 0; k < 3; k++) {
    side[k] = 4 * oblique[k];
    top[k] = side[k] / 2 + 0.8660254037844386 * n[k];
  }
  assert_true(vg_form_shape(NULL, o, side, top) < 0.2);
  vg_form_stretch(form, oblique, 4);
  assert_float_equal(vg_form_shape(form, o, side, top), 0.75, 1e-12);
  vg_sub(side, o, u);
  vg_sub(top, o, v);
  vg_cross(u, v, n);
  assert_float_equal(vg_form_area2(form, n), 0.75, 1e-12);
  vg_form_frame(form, u, v);
  assert_float_equal(vg_form_norm(form, u), 1, 1e-12);
  assert_float_equal(vg_form_norm(form, v), 1, 1e-12);
  assert_float_equal(vg_form_dot(form, u, v), 0, 1e-12);
  assert_float_equal(vg_form_shape(form, a, a, c), 0, 0);
}

/* Along x edges are ten times as long as across on the left, equally long on
 * the right, and vary linearly in between. */
static void falling(const void *unused, const double x[3], double size,
                    double form[6])
{
  (void)unused;
  (void)size;
  vg_form_stretch(form, (const double[3]){ 1, 0, 0 }, fmax(1, 10 - 3 * x[0]));
}

static void change(struct scene *s)
{
  struct vg_error err = VG_ERROR_INIT;
  struct vg_tris *w = &s->w;
  size_t n;

  if (vg_pass_divide(w, 1, &err) < 0) fail_msg("%s", err.text);
  vg_pass_curves(w);
  for (int i = 0; i < 5; i++) {
    assert_int_equal(vg_pass_collapse(w, VG_WORK_SHORT, VG_WORK_LONG, &n, &err),
                     VG_OK);
    assert_int_equal(vg_pass_split(w, VG_WORK_LONG, VG_SPLIT_ALL, &n, &err),
                     VG_OK);
    vg_pass_smooth(w, 2);
  }
  for (int i = 0; i < 3; i++) {
    assert_int_equal(vg_pass_polish(w, 0.3, &n, &err), VG_OK);
    vg_pass_swap(w);
    vg_pass_smooth(w, 1);
  }
}

/* A plate of 4 by 2 by 0.2, sizes of 0.1: triangles, edges and angles are, in
 * the metric, the same as with isotropic sizes. */
static void a_plate_gets_the_triangles_of_its_metric(void **unused)
{
  const double size[3] = { 4, 2, 0.2 };
  const uint32_t n[3] = { 8, 4, 1 };
  double worst = 1, wanted = 0;
  size_t n_edge = 0, n_fit = 0, n_tri = 0;
  struct scene s = { .m = VG_MESH_INIT };
  struct vg_tris *w = &s.w;

  (void)unused;
  shape_box(&s.m, size, n);
  scene_set(&s, 1e-6, 0.1);
  w->form = falling;
  for (size_t p = 0; p < w->n_point; p++)
    vg_tris_ask(w, &w->point[p], w->point[p].asked.size);
  change(&s);
  scene_expect_whole(&s);
  scene_expect_near(&s, 1e-9);
  for (uint32_t h = 0; h < 3 * w->n_tri; h++) {
    double l = vg_tris_ratio(w, h);

    if (vg_tris_removed(w, h / 3)) continue;
    n_edge++;
    n_fit += l <= M_SQRT2 && l >= M_SQRT1_2;
    n_tri += h % 3 == 0;
    worst = fmin(worst, vg_tris_tri_shape(w, h / 3));
  }
  /* The integral of 1 / (0.1 (10 - 3 x)) is 7.7 edges along x up to 3; there
   * are 10 from there on; instead of 40. */
  wanted = (log(10) / 3 + 1) * 10 * (2 * 20 + 2 * 2) / 0.4330127 +
           2 * 40 / 0.4330127;
  assert_true((double)n_tri > 0.85 * wanted && (double)n_tri < 1.2 * wanted);
  assert_true((double)n_fit > 0.9 * (double)n_edge);
  assert_true(worst > 0.179); /* 25 degrees */
  scene_release(&s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(lengths_follow_the_direction),
    cmocka_unit_test(an_edge_has_the_mean_size_of_its_ends),
    cmocka_unit_test(shapes_are_those_before_stretching),
    cmocka_unit_test(a_plate_gets_the_triangles_of_its_metric),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
