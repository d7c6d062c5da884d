/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Edges stretched along feature curves: the tensors around these, and remeshed
 * wings with longer edges along their leading edges. */
#include "remesh_scene.h"

#include "core/remesh/remesh.h"
#include "core/remesh/stretch.h"

/* --- the tensors --------------------------------------------------------- */

/* `by` along edges of a box at z = 0 that run along x at y = 0, and along y at
 * x = 0. */
static double *two_sides(const struct vg_mesh *m, double along_x,
                         double along_y)
{
  double *by = calloc(3 * m->n_tri, sizeof *by);

  for (size_t t = 0; t < m->n_tri; t++)
    for (int k = 0; k < 3; k++) {
      const double *a = m->point[m->tri[t][k]];
      const double *b = m->point[m->tri[t][(k + 1) % 3]];

      if (a[2] + b[2] != 0) continue;
      if (a[1] + b[1] == 0) by[3 * t + (size_t)k] = along_x;
      if (a[0] + b[0] == 0) by[3 * t + (size_t)k] = along_y;
    }
  return by;
}

static double asked(const struct vg_stretch *s, double x, double y, double z,
                    double dx, double dy)
{
  struct vg_metric m = { 0.05, { 0 } };
  const double at[3] = { x, y, z }, d[3] = { dx, dy, 0 };

  vg_stretch_form(s, at, m.size, m.form);
  return vg_metric_along(&m, d);
}

/* A cube with uniform size 0.05: one of its sides is stretched by 8, another by
 * `by`. */
static void stretch_cube(struct scene *s, struct vg_stretch *stretch, double by)
{
  const double size[3] = { 4, 4, 4 };
  const uint32_t n[3] = { 3, 3, 3 };
  struct vg_error err = VG_ERROR_INIT;

  shape_box(&s->m, size, n);
  scene_set(s, 1e-3, 0.05);
  s->w.h_max = 1;
  stretch->by = two_sides(&s->m, 8, by);
  assert_int_equal(vg_stretch_make(stretch, &s->w, &err), VG_OK);
}

static void release_cube(struct scene *s, struct vg_stretch *stretch)
{
  free((double *)stretch->by);
  vg_stretch_release(stretch);
  scene_release(s);
}

/* Along the curve the requested length, reduced by growth - 1 (0.2) per length
 * away from it, and never below the size, which remains that across the
 * curve. */
static void falls_with_the_distance(void **unused)
{
  struct scene s = { .m = VG_MESH_INIT };
  struct vg_stretch stretch = { 0 };

  (void)unused;
  stretch_cube(&s, &stretch, 0);
  assert_int_equal(stretch.n_run, 1);
  assert_float_equal(asked(&stretch, 2, 0, 0, 1, 0), 0.4, 1e-9);
  assert_float_equal(asked(&stretch, 2, 0, 0, 0, 1), 0.05, 1e-9);
  assert_float_equal(asked(&stretch, 2, 0.5, 0, 1, 0), 0.3, 1e-9);
  assert_float_equal(asked(&stretch, 2, 0.3, 0.4, 1, 0), 0.3, 1e-9);
  assert_float_equal(asked(&stretch, 2, 2, 0, 1, 0), 0.05, 1e-9);
  release_cube(&s, &stretch);
}

/* Where two curves meet at right angles neither is stretched. On one of them
 * edges have its requested length, minus the remaining effect of the other. */
static void lines_share_their_corner(void **unused)
{
  struct scene s = { .m = VG_MESH_INIT };
  struct vg_stretch stretch = { 0 };

  (void)unused;
  stretch_cube(&s, &stretch, 8);
  assert_int_equal(stretch.n_run, 2);
  assert_float_equal(asked(&stretch, 0, 0, 0, 1, 0), 0.05, 1e-9);
  assert_float_equal(asked(&stretch, 0, 0, 0, 0, 1), 0.05, 1e-9);
  assert_float_equal(asked(&stretch, 0.5, 0.5, 0, 1, 0), 0.05, 1e-9);
  assert_float_equal(asked(&stretch, 3, 0, 0, 1, 0), 0.4, 1e-9);
  assert_float_equal(asked(&stretch, 0, 3, 0, 0, 1), 0.4, 1e-9);
  /* at distance 1 the other curve still has 0.4 - 0.2; its excess over the size
   * is subtracted from 0.4 */
  assert_float_equal(asked(&stretch, 1, 0, 0, 1, 0), 0.25, 1e-9);
  release_cube(&s, &stretch);
}

/* --- wings --------------------------------------------------------------- */

#define CHORD 40
#define SPAN 30

/* A tapered wing with a round leading edge and a sharp trailing edge: upper and
 * lower side meet in both. */
static void wing(struct vg_mesh *m)
{
  static const char *const name[] = { "upper", "lower", "root", "tip" };
  uint32_t first[2];

  for (int i = 0; i < 4; i++) vg_mesh_add_patch(m, i + 1, name[i]);
  for (uint32_t side = 0; side < 2; side++) {
    first[side] = (uint32_t)m->n_point;
    for (uint32_t j = 0; j <= SPAN; j++)
      for (uint32_t i = 0; i <= CHORD; i++) {
        double y = 4. * j / SPAN, u = (double)i / CHORD, chord = 1 - 0.1 * y;
        double z = 0.15 * u * (1 - u * u); /* of x = u^2: round in front */

        shape_point(m, 0.2 * y + chord * u * u, y, (side ? -z : z) * chord);
      }
    for (uint32_t j = 0; j < SPAN; j++)
      for (uint32_t i = 0; i < CHORD; i++) {
        uint32_t a = first[side] + j * (CHORD + 1) + i, b = a + 1;
        uint32_t c = b + CHORD + 1, d = a + CHORD + 1;

        shape_tri(m, a, side ? c : b, side ? b : c, side);
        shape_tri(m, a, side ? d : c, side ? c : d, side);
      }
  }
  for (uint32_t end = 0; end < 2; end++)
    for (uint32_t i = 0; i < CHORD; i++) {
      uint32_t a = first[0] + end * SPAN * (CHORD + 1) + i, b = a + 1;
      uint32_t c = a + first[1], d = c + 1;

      if (i) shape_tri(m, a, end ? c : b, end ? b : c, 2 + end);
      if (i + 1 < CHORD) shape_tri(m, b, end ? c : d, end ? d : c, 2 + end);
    }
  shape_weld(m);
}

static int is_leading(const struct vg_mesh *m, const uint32_t *tri, int k)
{
  const double *a = m->point[tri[k]], *b = m->point[tri[(k + 1) % 3]];

  return fabs(a[0] - 0.2 * a[1]) < 1e-6 && fabs(b[0] - 0.2 * b[1]) < 1e-6 &&
         fabs(a[1] - b[1]) > 1e-9;
}

static double *along_leading_edge(const struct vg_mesh *m, double by)
{
  double *stretch = calloc(3 * m->n_tri, sizeof *stretch);

  for (size_t t = 0; t < m->n_tri; t++)
    for (int k = 0; k < 3; k++)
      if (is_leading(m, m->tri[t], k)) stretch[3 * t + (size_t)k] = by;
  return stretch;
}

static size_t edges_of_leading_edge(const struct vg_mesh *m)
{
  size_t n = 0;

  for (size_t t = 0; t < m->n_tri; t++)
    for (int k = 0; k < 3; k++) n += (size_t)is_leading(m, m->tri[t], k);
  return n / 2;
}

static void make_wing(struct vg_mesh *m, double by, double h_max, int threads,
                      struct vg_remesh_report *r)
{
  struct vg_remesh_options o = VG_REMESH_OPTIONS_INIT;
  struct vg_mesh given = VG_MESH_INIT;
  struct vg_remesh_distance d[2];
  struct vg_error err = VG_ERROR_INIT;
  double *stretch;

  wing(m);
  assert_int_equal(vg_mesh_copy(&given, m, &err), VG_OK);
  o.stretch = stretch = along_leading_edge(m, by);
  o.h_max = h_max;
  o.threads = threads;
  if (vg_remesh(m, &o, r, &err) < 0) fail_msg("%s", err.text);
  shape_expect_sound(m, 0);
  assert_int_equal(vg_remesh_measure(m, &given, 1, NULL, NULL, d, &err), VG_OK);
  /* between samples up to twice as far as in them, as remesh.h says */
  assert_true(fmax(d[0].most, d[1].most) < 2 * r->tolerance);
  assert_float_equal(shape_area(m, 2), shape_area(&given, 2), 0.02 * 0.1);
  free(stretch);
  vg_mesh_release(&given);
}

/* The edges along the leading edge are fewer by the requested factor, and the
 * triangles are fewer; shapes are equally good in the requested metric. */
static void stretches_a_leading_edge(void **unused)
{
  const double by[3] = { 1.0001, 4, 10 };
  size_t n_tri[3], n_edge[3];

  (void)unused;
  for (int i = 0; i < 3; i++) {
    struct vg_mesh m = VG_MESH_INIT;
    struct vg_remesh_report r = VG_REMESH_REPORT_INIT;

    make_wing(&m, by[i], 0.2, 1, &r);
    n_tri[i] = m.n_tri;
    n_edge[i] = edges_of_leading_edge(&m);
    assert_true((double)r.n_edge_fit > 0.95 * (double)r.n_edge);
    assert_float_equal(r.aspect_most, by[i], 0.01 * by[i]);
    vg_remesh_report_release(&r);
    vg_mesh_release(&m);
  }
  for (int i = 1; i < 3; i++) {
    double less = (double)n_edge[0] / (double)n_edge[i];

    assert_true(less > 0.8 * by[i] && less < 1.2 * by[i]);
    assert_true(n_tri[i] < n_tri[i - 1]);
  }
  assert_true((double)n_tri[2] < 0.6 * (double)n_tri[0]);
}

/* Blocks of 6,000 triangles: 13,000 are made in some. */
static void same_bytes_for_any_threads(void **unused)
{
  struct vg_mesh m[2];
  struct vg_remesh_report r[2];

  (void)unused;
  memset(m, 0, sizeof m);
  memset(r, 0, sizeof r);
  for (int i = 0; i < 2; i++) make_wing(&m[i], 5, 0.03, 1 + 2 * i, &r[i]);
  assert_true(m[0].n_tri > 13000);
  assert_int_equal(m[0].n_point, m[1].n_point);
  assert_int_equal(m[0].n_tri, m[1].n_tri);
  assert_memory_equal(m[0].point, m[1].point,
                      m[0].n_point * sizeof *m[0].point);
  assert_memory_equal(m[0].tri, m[1].tri, m[0].n_tri * sizeof *m[0].tri);
  for (int i = 0; i < 2; i++) {
    vg_remesh_report_release(&r[i]);
    vg_mesh_release(&m[i]);
  }
}

static void refuses_invalid_stretch_factors(void **unused)
{
  const double bad[3] = { 20.5, -2, NAN };

  (void)unused;
  for (int i = 0; i < 3; i++) {
    struct vg_mesh m = VG_MESH_INIT;
    struct vg_remesh_options o = VG_REMESH_OPTIONS_INIT;
    struct vg_error err = VG_ERROR_INIT;
    double *stretch;

    wing(&m);
    o.stretch = stretch = calloc(3 * m.n_tri, sizeof *stretch);
    stretch[4] = bad[i];
    assert_int_equal(vg_remesh(&m, &o, NULL, &err), VG_ERR_INPUT);
    assert_non_null(strstr(err.text, "edge 2 of triangle 2"));
    free(stretch);
    vg_mesh_release(&m);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(falls_with_the_distance),
    cmocka_unit_test(lines_share_their_corner),
    cmocka_unit_test(stretches_a_leading_edge),
    cmocka_unit_test(same_bytes_for_any_threads),
    cmocka_unit_test(refuses_invalid_stretch_factors),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
