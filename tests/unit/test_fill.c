/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The fill gives a valid mesh that preserves its surface, for any shape. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "fill_shapes.h"
#include "fill_support.h"

static const double origin[3] = { 0, 0, 0 };

static void same_array(const void *a, const void *b, size_t n, size_t size)
{
  if (n) assert_memory_equal(a, b, n * size);
}

static void surface_is_kept(const struct vg_mesh *m, const struct vg_mesh *s)
{
  assert_int_equal(m->n_tri, s->n_tri);
  assert_int_equal(m->n_patch, s->n_patch);
  assert_true(m->n_point >= s->n_point);
  same_array(m->point, s->point, s->n_point, sizeof *s->point);
  same_array(m->tri, s->tri, s->n_tri, sizeof *s->tri);
  same_array(m->tri_patch, s->tri_patch, s->n_tri, sizeof *s->tri_patch);
  same_array(m->patch, s->patch, s->n_patch, sizeof *s->patch);
}

/* Fill `s` twice. The result must be valid, preserve the surface, and be the
 * same both times. Its quality is measured against the sizing field. */
static struct vg_mesh_report fill_and_judge(const struct vg_mesh *s,
                                            const struct vg_sizing *sizing,
                                            struct vg_fill_report *fill)
{
  struct vg_fill_options options = VG_FILL_OPTIONS_INIT;
  struct vg_mesh m = VG_MESH_INIT, again = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_mesh_report r;
  struct vg_fill_report other;

  if (fill_mesh(s, sizing, &options, &m, fill, &err) != VG_OK)
    fail_msg("%s", err.text);
  assert_int_equal(vg_mesh_judge(&m, sizing, &r, &err), VG_OK);
  assert_int_equal(r.not_positive, 0);
  assert_int_equal(r.open_face, 0);
  assert_int_equal(r.crowded_face, 0);
  assert_int_equal(r.same_side_face, 0);
  assert_int_equal(r.orphan_boundary, 0);
  assert_int_equal(r.outward_boundary, 0);
  assert_int_equal(r.unused_point, 0);
  assert_int_equal(r.duplicate_point, 0);
  assert_true(r.volume_error < 1e-9);
  assert_true(r.is_valid);
  assert_int_equal(m.n_pyr + m.n_pri + m.n_hex + m.n_quad, 0);
  surface_is_kept(&m, s);
  assert_int_equal(fill_mesh(s, sizing, &options, &again, &other, &err), VG_OK);
  assert_int_equal(again.n_point, m.n_point);
  assert_int_equal(again.n_tet, m.n_tet);
  same_array(again.point, m.point, m.n_point, sizeof *m.point);
  same_array(again.tet, m.tet, m.n_tet, sizeof *m.tet);
  vg_mesh_release(&m);
  vg_mesh_release(&again);
  return r;
}

static struct vg_mesh_report fill_shape(struct vg_mesh *s, double growth,
                                        double h_max,
                                        struct vg_fill_report *fill)
{
  struct vg_sizing *sizing = shape_sizing(s, growth, h_max);
  struct vg_mesh_report r = fill_and_judge(s, sizing, fill);

  vg_sizing_free(sizing);
  vg_mesh_release(s);
  return r;
}

/* The quality limits are those for a finished mesh (12 degrees, 158 degrees,
 * 0.8); the small cases here are no easier. */
static void a_box_of_one_size(void **state)
{
  struct vg_mesh s = VG_MESH_INIT;
  struct vg_mesh_report r;
  struct vg_fill_report fill;

  (void)state;
  shape_box(&s, 10, 0.5);
  r = fill_shape(&s, 1.2, 0.11, &fill);
  assert_true(fabs(r.volume - 1) < 1e-12);
  assert_int_equal(r.n_component, 1);
  assert_true(r.n_cell > 4000 && r.n_cell < 16000);
  assert_true(r.angle_min > 12 && r.angle_max < 158);
  assert_true(r.radius_ratio_mean > 0.8);
}

static void a_sphere_in_a_box(void **state)
{
  struct vg_mesh s = VG_MESH_INIT;
  struct vg_mesh_report r;
  struct vg_fill_report fill;

  (void)state;
  shape_box(&s, 8, 8);
  shape_sphere(&s, 12, origin, 1, 7);
  r = fill_shape(&s, 1.3, 0, &fill);
  assert_int_equal(r.n_component, 1);
  /* between the box minus the sphere's circumscribed ball and minus its
   * inscribed ball */
  assert_true(r.volume > 4096 - 4 * M_PI / 3);
  assert_true(r.volume < 4096 - 0.95 * 4 * M_PI / 3);
  assert_true(r.angle_min > 10 && r.angle_max < 162);
}

static void the_inside_of_a_torus(void **state)
{
  struct vg_mesh s = VG_MESH_INIT;
  struct vg_mesh_report r;
  struct vg_fill_report fill;

  (void)state;
  shape_torus(&s, 48, 18, 1, 0.35);
  r = fill_shape(&s, 1.2, 0, &fill);
  assert_int_equal(r.n_component, 1);
}

static int in_the_l(const int at[3])
{
  return at[0] < 4 || at[1] < 4;
}

static void an_l_shape(void **state)
{
  const int n[3] = { 12, 12, 5 };
  const double lo[3] = { 0, 0, 0 }, hi[3] = { 12, 12, 5 };
  struct vg_mesh s = VG_MESH_INIT;
  struct vg_mesh_report r;
  struct vg_fill_report fill;

  (void)state;
  shape_block(&s, n, lo, hi, in_the_l);
  r = fill_shape(&s, 1.2, 1.1, &fill);
  assert_true(fabs(r.volume - (144 - 64) * 5) < 1e-9);
}

/* Two plates of triangles, a tenth of their edges apart. */
static void a_thin_plate_of_fluid(void **state)
{
  const int n[3] = { 20, 20, 1 };
  const double lo[3] = { 0, 0, 0 }, hi[3] = { 20, 20, 0.1 };
  struct vg_mesh s = VG_MESH_INIT;
  struct vg_mesh_report r;
  struct vg_fill_report fill;

  (void)state;
  shape_block(&s, n, lo, hi, shape_all);
  r = fill_shape(&s, 1.2, 0, &fill);
  assert_true(fabs(r.volume - 40) < 1e-10);
}

static int around_the_plate(const int at[3])
{
  return at[0] < 3 || at[0] >= 9 || at[1] < 3 || at[1] >= 9 || at[2] != 3;
}

/* A plate as a body: sharp edges, one box thick, in a closed box. */
static void a_plate_in_the_fluid(void **state)
{
  const int n[3] = { 12, 12, 7 };
  const double lo[3] = { 0, 0, 0 }, hi[3] = { 12, 12, 7 };
  struct vg_mesh s = VG_MESH_INIT;
  struct vg_mesh_report r;
  struct vg_fill_report fill;

  (void)state;
  shape_block(&s, n, lo, hi, around_the_plate);
  r = fill_shape(&s, 1.2, 0, &fill);
  assert_true(fabs(r.volume - (144 * 7 - 36)) < 1e-9);
}

static void two_bodies_close_together(void **state)
{
  const double left[3] = { -1.02, 0, 0 }, right[3] = { 1.02, 0.3, 0 };
  struct vg_mesh s = VG_MESH_INIT;
  struct vg_mesh_report r;
  struct vg_fill_report fill;

  (void)state;
  shape_box(&s, 6, 6);
  shape_sphere(&s, 8, left, 1, 7);
  shape_sphere(&s, 6, right, 1, 8);
  r = fill_shape(&s, 1.3, 0, &fill);
  assert_int_equal(r.n_component, 1);
}

static int in_two_rooms(const int at[3])
{
  return at[0] != 4;
}

static void two_rooms_without_a_door(void **state)
{
  const int n[3] = { 9, 4, 4 };
  const double lo[3] = { 0, 0, 0 }, hi[3] = { 9, 4, 4 };
  struct vg_mesh s = VG_MESH_INIT;
  struct vg_mesh_report r;
  struct vg_fill_report fill;

  (void)state;
  shape_block(&s, n, lo, hi, in_two_rooms);
  r = fill_shape(&s, 1.2, 0, &fill);
  assert_int_equal(r.n_component, 2);
  assert_true(fabs(r.volume - 8 * 16) < 1e-10);
}

/* A shell inside a shell: fluid, solid, and fluid again in its middle. */
static void a_cavity_in_a_body(void **state)
{
  struct vg_mesh s = VG_MESH_INIT;
  struct vg_mesh_report r;
  struct vg_fill_report fill;
  size_t first;

  (void)state;
  shape_box(&s, 5, 4);
  shape_sphere(&s, 8, origin, 2, 7);
  first = s.n_tri;
  shape_sphere(&s, 6, origin, 1, 8);
  for (size_t i = first; i < s.n_tri; i++) {
    uint32_t t = s.tri[i][1];

    s.tri[i][1] = s.tri[i][2];
    s.tri[i][2] = t;
  }
  r = fill_shape(&s, 1.3, 0, &fill);
  assert_int_equal(r.n_component, 2);
}

/* Edges of 2e-5 on the body, of 4 on the farfield. */
static void sizes_over_five_orders(void **state)
{
  struct vg_mesh s = VG_MESH_INIT;
  struct vg_mesh_report r;
  struct vg_fill_report fill;

  (void)state;
  shape_box(&s, 8, 16);
  shape_sphere(&s, 8, origin, 1e-4, 7);
  r = fill_shape(&s, 1.4, 0, &fill);
  assert_int_equal(r.n_component, 1);
}

static void far_from_the_origin(void **state)
{
  struct vg_mesh s = VG_MESH_INIT;
  struct vg_mesh_report r;
  struct vg_fill_report fill;

  (void)state;
  shape_box(&s, 6, 0.5);
  for (size_t i = 0; i < s.n_point; i++) {
    s.point[i][0] += 1e6;
    s.point[i][1] -= 2e6;
  }
  r = fill_shape(&s, 1.2, 0, &fill);
  assert_true(fabs(r.volume - 1) < 1e-8);
}

static int stop_at_once(void *user)
{
  ++*(int *)user;
  return 1;
}

static void it_can_be_stopped(void **state)
{
  struct vg_mesh s = VG_MESH_INIT, m = VG_MESH_INIT;
  struct vg_fill_options options = VG_FILL_OPTIONS_INIT;
  struct vg_fill_report fill;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_sizing *sizing;
  int calls = 0;

  (void)state;
  shape_box(&s, 12, 0.5);
  sizing = shape_sizing(&s, 1.2, 0.1);
  options.stop = (struct vg_stop){ stop_at_once, &calls };
  assert_int_equal(fill_mesh(&s, sizing, &options, &m, &fill, &err),
                   VG_ERR_STOPPED);
  assert_int_equal(calls, 1);
  assert_int_equal(m.n_tet + m.n_point, 0);
  vg_sizing_free(sizing);
  vg_mesh_release(&s);
}

static void more_points_than_allowed_are_refused(void **state)
{
  struct vg_mesh s = VG_MESH_INIT, m = VG_MESH_INIT;
  struct vg_fill_options options = VG_FILL_OPTIONS_INIT;
  struct vg_fill_report fill;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_sizing *sizing;

  (void)state;
  shape_box(&s, 8, 0.5);
  sizing = shape_sizing(&s, 1.2, 0.02);
  options.point_limit = 400;
  assert_int_equal(fill_mesh(&s, sizing, &options, &m, &fill, &err),
                   VG_ERR_UNSUPPORTED);
  assert_true(err.text[0]);
  assert_int_equal(m.n_tet + m.n_point, 0);
  vg_sizing_free(sizing);
  vg_mesh_release(&s);
}

/* Expect a refusal with a message that leaves nothing behind. */
static void refused(const struct vg_mesh *s, const struct vg_sizing *sizing)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_fill_options options = VG_FILL_OPTIONS_INIT;
  struct vg_fill_report fill;
  struct vg_error err = VG_ERROR_INIT;

  assert_true(fill_mesh(s, sizing, &options, &m, &fill, &err) < 0);
  assert_true(strlen(err.text) > 10);
  assert_int_equal(m.n_tet + m.n_point, 0);
}

/* A front without faces bounds no void. */
static void an_empty_front_gets_no_cells(void **state)
{
  struct vg_fill_options options = VG_FILL_OPTIONS_INIT;
  struct vg_mesh s = VG_MESH_INIT, empty = VG_MESH_INIT, m = VG_MESH_INIT;
  struct vg_fill_report fill;
  struct vg_sizing *sizing;

  (void)state;
  shape_box(&s, 4, 0.5);
  sizing = shape_sizing(&s, 1.2, 0);
  assert_int_equal(fill_mesh(&empty, sizing, &options, &m, &fill, NULL), VG_OK);
  assert_int_equal(m.n_tet + m.n_point, 0);
  vg_mesh_release(&m);
  vg_sizing_free(sizing);
  vg_mesh_release(&s);
}

static void invalid_boundaries_are_refused(void **state)
{
  struct vg_mesh s = VG_MESH_INIT;
  struct vg_sizing *sizing;
  uint32_t t;

  (void)state;
  shape_box(&s, 4, 0.5);
  sizing = shape_sizing(&s, 1.2, 0);
  s.n_tri--; /* a hole */
  refused(&s, sizing);
  s.n_tri++;
  t = s.tri[9][0]; /* one triangle reversed */
  s.tri[9][0] = s.tri[9][1];
  s.tri[9][1] = t;
  refused(&s, sizing);
  t = s.tri[9][0];
  s.tri[9][0] = s.tri[9][1];
  s.tri[9][1] = t;
  shape_point(&s, 0, 0, 0); /* a point without triangles */
  refused(&s, sizing);
  s.n_point--;
  for (size_t i = 0; i < s.n_tri; i++) { /* unbounded fluid outside */
    t = s.tri[i][0];
    s.tri[i][0] = s.tri[i][1];
    s.tri[i][1] = t;
  }
  refused(&s, sizing);
  vg_sizing_free(sizing);
  vg_mesh_release(&s);
}

static void shells_that_cross_are_refused(void **state)
{
  const double off[3] = { 0.7, 0.1, 0.2 };
  struct vg_mesh s = VG_MESH_INIT;
  struct vg_sizing *sizing;

  (void)state;
  shape_box(&s, 5, 4);
  shape_sphere(&s, 6, origin, 1, 7);
  shape_sphere(&s, 5, off, 1, 8);
  sizing = shape_sizing(&s, 1.3, 0);
  refused(&s, sizing);
  vg_sizing_free(sizing);
  vg_mesh_release(&s);
}

/* Without optimisation the mesh has lower quality, but is equally valid. */
static void optimisation_is_optional(void **state)
{
  struct vg_mesh s = VG_MESH_INIT, m = VG_MESH_INIT;
  struct vg_fill_options options = VG_FILL_OPTIONS_INIT;
  struct vg_fill_report fill;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_mesh_report r;
  struct vg_sizing *sizing;

  (void)state;
  shape_box(&s, 8, 0.5);
  sizing = shape_sizing(&s, 1.2, 0);
  options.sweeps = 0;
  assert_int_equal(fill_mesh(&s, sizing, &options, &m, &fill, &err), VG_OK);
  assert_int_equal(vg_mesh_judge(&m, NULL, &r, &err), VG_OK);
  assert_true(r.is_valid);
  assert_int_equal(fill.n_smoothed + fill.n_flip, 0);
  vg_sizing_free(sizing);
  vg_mesh_release(&m);
  vg_mesh_release(&s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(a_box_of_one_size),
    cmocka_unit_test(a_sphere_in_a_box),
    cmocka_unit_test(the_inside_of_a_torus),
    cmocka_unit_test(an_l_shape),
    cmocka_unit_test(a_thin_plate_of_fluid),
    cmocka_unit_test(a_plate_in_the_fluid),
    cmocka_unit_test(two_bodies_close_together),
    cmocka_unit_test(two_rooms_without_a_door),
    cmocka_unit_test(a_cavity_in_a_body),
    cmocka_unit_test(sizes_over_five_orders),
    cmocka_unit_test(far_from_the_origin),
    cmocka_unit_test(it_can_be_stopped),
    cmocka_unit_test(more_points_than_allowed_are_refused),
    cmocka_unit_test(an_empty_front_gets_no_cells),
    cmocka_unit_test(invalid_boundaries_are_refused),
    cmocka_unit_test(shells_that_cross_are_refused),
    cmocka_unit_test(optimisation_is_optional),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
