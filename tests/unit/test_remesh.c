/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Remeshed surfaces: shapes with known feature edges, areas and distances, a
 * random search, and refusals. */
#include "remesh_shapes.h"

#include "core/remesh/remesh.h"
#include "core/surface/surface_quality.h"
#include "io/mesh/format.h"

static void remesh(struct vg_mesh *m, const struct vg_remesh_options *o,
                   struct vg_remesh_report *r)
{
  struct vg_error err = VG_ERROR_INIT;

  if (vg_remesh(m, o, r, &err) < 0) fail_msg("%s", err.text);
}

static double edge_within(const struct vg_remesh_report *r)
{
  return (double)r->n_edge_fit / (double)r->n_edge;
}

/* The larger of the distances of each surface from the other. */
static double apart(const struct vg_mesh *a, const struct vg_mesh *b)
{
  struct vg_remesh_distance d[2];
  struct vg_error err = VG_ERROR_INIT;

  assert_int_equal(vg_remesh_measure(a, b, 1, NULL, NULL, d, &err), VG_OK);
  return fmax(d[0].most, d[1].most);
}

/* A ridge caused by a point that is off by less than the tolerance is not a
 * feature edge. */
static void leaves_out_false_ridges(void **unused)
{
  const double size[3] = { 3, 2, 1 };
  const uint32_t n[3] = { 2, 90, 1 };

  (void)unused;
  for (int i = 0; i < 2; i++) {
    struct vg_mesh m = VG_MESH_INIT;
    struct vg_remesh_options o = VG_REMESH_OPTIONS_INIT;
    struct vg_remesh_report r = VG_REMESH_REPORT_INIT;
    size_t n_up = 0;

    shape_box(&m, size, n);
    for (size_t p = 0; p < m.n_point; p++) {
      double *x = m.point[p];

      /* 45 rows of 0.022 from the edge: needles there turn by 48 degrees */
      if (x[0] != 1.5 || x[2] != 1 || fabs(x[1] - 1) > 1e-9) continue;
      x[2] += 0.025;
      n_up++;
    }
    assert_int_equal(n_up, 1);
    o.h_max = 0.2;
    o.tolerance = i ? 0.01 : 0.1;
    remesh(&m, &o, &r);
    shape_expect_sound(&m, 0);
    if (i) assert_true(r.n_line > 12);
    else assert_int_equal(r.n_line, 12);
    vg_remesh_report_release(&r);
    vg_mesh_release(&m);
  }
}

/* Edges requested across a strip are made, however narrow it is relative to the
 * surrounding sizes. */
static void edges_go_across_strips(void **unused)
{
  const double size[3] = { 1, 1, 0.01 };
  const uint32_t n[3] = { 4, 4, 1 };
  const double across[6] = { 4, 1, 1, 1, 1, 1 };
  size_t n_tri[2] = { 0, 0 };

  (void)unused;
  for (int i = 0; i < 2; i++) {
    struct vg_mesh m = VG_MESH_INIT;
    struct vg_remesh_options o = VG_REMESH_OPTIONS_INIT;

    shape_box(&m, size, n);
    o.h_max = 0.5; /* 0.02 of it is as wide as the strip */
    o.h_min = 1e-4;
    o.across = i ? across : NULL;
    remesh(&m, &o, NULL);
    shape_expect_sound(&m, 0);
    for (size_t t = 0; t < m.n_tri; t++) n_tri[i] += m.tri_patch[t] == 0;
    vg_mesh_release(&m);
  }
  /* one edge across: 2 or 3 triangles to a square of 0.01; four: 32 or 48 */
  assert_in_range(n_tri[0], 150, 450);
  assert_in_range(n_tri[1], 2400, 7200);
}

/* The edges of a plate stay, although they are thinner than the tolerance;
 * stretched triangles along them keep the surface small. Much thinner ones are
 * closed. */
static void keeps_thin_edges(void **unused)
{
  const uint32_t n[3] = { 1, 1, 1 };
  size_t n_tri[2];

  (void)unused;
  for (int i = 0; i < 3; i++) {
    const double size[3] = { 1, 1, (const double[]){ 1.5e-3, 5e-4, 5e-5 }[i] };
    struct vg_mesh m = VG_MESH_INIT;
    struct vg_remesh_options o = VG_REMESH_OPTIONS_INIT;
    struct vg_remesh_report r = VG_REMESH_REPORT_INIT;

    shape_box(&m, size, n);
    o.tolerance = 1e-3;
    o.h_max = 0.1;
    o.h_min = 2e-3;
    remesh(&m, &o, &r);
    shape_expect_sound(&m, 0);
    for (uint32_t p = 0; p < 6 && i < 2; p++)
      assert_float_equal(shape_area(&m, p), p < 4 ? size[2] : 1,
                         1e-6 * size[2]);
    assert_int_equal(r.n_closed > 0, i == 2);
    if (i < 2) n_tri[i] = r.n_tri[1];
    vg_remesh_report_release(&r);
    vg_mesh_release(&m);
  }
  assert_in_range(n_tri[0], 5000, 20000);
  assert_true(n_tri[1] < n_tri[0]);
}

/* Needles of 1 : 60 on a box become well-shaped triangles; its edges stay. */
static void improves_sliver_triangles(void **unused)
{
  const double size[3] = { 3, 2, 1 };
  const uint32_t n[3] = { 2, 90, 1 };
  struct vg_mesh m = VG_MESH_INIT, old = VG_MESH_INIT;
  struct vg_remesh_options o = VG_REMESH_OPTIONS_INIT;
  struct vg_remesh_report r = VG_REMESH_REPORT_INIT;
  struct vg_surface_quality q;
  struct vg_error err = VG_ERROR_INIT;

  (void)unused;
  shape_box(&m, size, n);
  assert_int_equal(vg_mesh_copy(&old, &m, &err), VG_OK);
  o.h_max = 0.2;
  remesh(&m, &o, &r);
  shape_expect_sound(&m, 0);
  assert_int_equal(r.n_corner, 8);
  assert_int_equal(r.n_line, 12);
  assert_float_equal(r.line_length[0], 24, 1e-12);
  assert_float_equal(r.line_length[1], 24, 1e-9);
  vg_surface_quality(&m, &q);
  assert_true(q.angle_min > 30);
  assert_true(q.angle_min_p1 >= 42);
  assert_true(edge_within(&r) > 0.95);
  assert_int_equal(r.n_bad, 0);
  for (size_t p = 0; p < 6; p++) /* planes: areas except for rounding */
    assert_float_equal(shape_area(&m, p), shape_area(&old, p), 1e-9);
  assert_true(apart(&m, &old) < 1e-9);
  vg_remesh_report_release(&r);
  vg_mesh_release(&m);
  vg_mesh_release(&old);
}

/* A ball stays within the tolerance. Its two patches, which share a smooth
 * border, keep their names and halves. Triangles at the border are as large as
 * 0.1: half of one along 2 pi is 0.3, of 12.6. */
static void keeps_a_ball_round(void **unused)
{
  const double size[3] = { 1, 1, 1 };
  struct vg_mesh m = VG_MESH_INIT, old = VG_MESH_INIT;
  struct vg_remesh_options o = VG_REMESH_OPTIONS_INIT;
  struct vg_remesh_report r = VG_REMESH_REPORT_INIT;
  struct vg_surface_quality q;
  struct vg_error err = VG_ERROR_INIT;

  (void)unused;
  shape_ball(&m, size, 48);
  assert_int_equal(vg_mesh_copy(&old, &m, &err), VG_OK);
  o.tolerance = 2e-3;
  remesh(&m, &o, &r);
  shape_expect_sound(&m, 0);
  assert_int_equal(r.n_line, 0);
  vg_surface_quality(&m, &q);
  assert_true(q.angle_min > 30);
  assert_true(q.angle_min_p1 >= 42);
  assert_true(apart(&m, &old) <= 1.001 * o.tolerance);
  assert_string_equal(m.patch[0].name, "aft");
  assert_string_equal(m.patch[1].name, "fore");
  for (size_t p = 0; p < 2; p++)
    assert_float_equal(shape_area(&m, p), shape_area(&old, p), 0.3);
  vg_remesh_report_release(&r);
  vg_mesh_release(&m);
  vg_mesh_release(&old);
}

/* On a fixed patch border, and on the border of a patch with another condition,
 * feature edges stay although the surface is smooth there. */
static void keeps_fixed_borders(void **unused)
{
  const double size[3] = { 1, 1, 1 };
  const uint8_t hard[2] = { 1, 0 };

  (void)unused;
  for (int by_condition = 0; by_condition < 2; by_condition++) {
    struct vg_mesh m = VG_MESH_INIT;
    struct vg_remesh_options o = VG_REMESH_OPTIONS_INIT;
    struct vg_remesh_report r = VG_REMESH_REPORT_INIT;

    shape_ball(&m, size, 24);
    o.tolerance = 2e-3;
    if (by_condition) m.patch[0].bc = 4;
    else o.hard = hard;
    remesh(&m, &o, &r);
    assert_true(r.n_line > 0);
    /* The great circle, in 48 chords or more. */
    assert_true(fabs(r.line_length[1] - 2 * M_PI) < 0.02);
    vg_remesh_report_release(&r);
    vg_mesh_release(&m);
  }
}

/* Borders between patches are kept where the patches are wide enough. The
 * opening in the side of a box keeps its area, although it is smaller than the
 * edges. */
static void keeps_imprinted_openings(void **unused)
{
  const double size[3] = { 1, 1, 1 };
  const uint32_t n[3] = { 12, 12, 12 };
  size_t n_tri[2];

  (void)unused;
  for (int keeps = 0; keeps < 2; keeps++) {
    struct vg_mesh m = VG_MESH_INIT;
    struct vg_remesh_options o = VG_REMESH_OPTIONS_INIT;
    double before, after;
    size_t at;

    shape_box(&m, size, n);
    at = vg_mesh_add_patch(&m, 99, "fan");
    for (size_t t = 0; t < m.n_tri; t++) {
      int inside = 1;

      for (int k = 0; k < 3; k++) {
        const double *x = m.point[m.tri[t][k]];

        inside &= x[2] < 1e-9 && fabs(x[0] - 0.5) < 0.1 &&
                  fabs(x[1] - 0.5) < 0.1;
      }
      if (inside) m.tri_patch[t] = (uint32_t)at;
    }
    before = shape_area(&m, at);
    o.h_max = 0.4;
    o.keeps_borders = keeps;
    remesh(&m, &o, NULL);
    shape_expect_sound(&m, 0);
    after = shape_area(&m, at);
    if (keeps) assert_float_equal(after, before, 1e-9);
    else assert_true(fabs(after / before - 1) > 0.1);
    n_tri[keeps] = m.n_tri;
    vg_mesh_release(&m);
  }
  assert_in_range(n_tri[1], n_tri[0], 5 * n_tri[0]);
}

/* The tolerance follows the width of a patch, so that its area changes by about
 * a percent where sizes and tolerance would permit more. */
static void keeps_area_of_narrow_patches(void **unused)
{
  const double size[3] = { 1, 1, 1 };
  double change[2];

  (void)unused;
  for (int keeps = 0; keeps < 2; keeps++) {
    struct vg_mesh m = VG_MESH_INIT;
    struct vg_remesh_options o = VG_REMESH_OPTIONS_INIT;
    double before;

    shape_ball(&m, size, 24);
    before = shape_area(&m, 0);
    o.h_min = 0.9;
    o.h_max = 0.9;
    o.tolerance = 0.3;
    o.keeps_borders = keeps;
    remesh(&m, &o, NULL);
    shape_expect_sound(&m, 0);
    change[keeps] = fabs(shape_area(&m, 0) / before - 1);
    vg_mesh_release(&m);
  }
  assert_true(change[0] > 0.03);
  assert_true(change[1] < 0.015);
}

/* The sizes of a plate with two triangles per side are small at its rim only.
 * Interpolated between the corners, they would give 4 / (0.43 * 0.003 ^ 2), a
 * million triangles, on either side. */
static void refines_large_plane_triangles(void **unused)
{
  const double size[3] = { 2, 2, 0.003 };
  const uint32_t n[3] = { 1, 1, 1 };
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_remesh_options o = VG_REMESH_OPTIONS_INIT;

  (void)unused;
  shape_box(&m, size, n);
  o.h_max = 0.1;
  remesh(&m, &o, NULL);
  shape_expect_sound(&m, 0);
  assert_in_range(m.n_tri, 20000, 300000);
  assert_float_equal(shape_area(&m, 0), 2 * 0.003, 1e-9);
  vg_mesh_release(&m);
}

/* A blunt edge 0.01 wide on a plate gets equally narrow triangles, not
 * needles. */
static void follows_strips(void **unused)
{
  const double size[3] = { 2, 1, 0.01 };
  const uint32_t n[3] = { 4, 4, 1 };
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_remesh_options o = VG_REMESH_OPTIONS_INIT;
  struct vg_remesh_report r = VG_REMESH_REPORT_INIT;
  struct vg_surface_quality q;

  (void)unused;
  shape_box(&m, size, n);
  remesh(&m, &o, &r);
  shape_expect_sound(&m, 0);
  vg_surface_quality(&m, &q);
  assert_true(q.angle_min > 20);
  assert_true(q.angle_min_p1 >= 35);
  vg_remesh_report_release(&r);
  vg_mesh_release(&m);
}

/* A bar of length 2 with a chamfer along one edge that is `from` wide at one
 * end, `to` at the other. */
static void shape_chamfered(struct vg_mesh *m, double from, double to)
{
  const struct vg_patch patch = { .id = 1,
                                  .bc = VG_BC_NONE,
                                  .bc_fun3d = VG_BC_NONE };
  uint32_t p[2][5];

  m->patch = malloc(sizeof *m->patch);
  m->patch[m->n_patch++] = patch;
  for (int end = 0; end < 2; end++) {
    double w = (end ? to : from) / sqrt(2), x = 2. * end;
    const double at[5][2] = {
      { 0, 0 }, { 1, 0 }, { 1, 1 - w }, { 1 - w, 1 }, { 0, 1 }
    };

    for (int k = 0; k < 5; k++)
      p[end][k] = shape_point(m, x, at[k][0], at[k][1]);
  }
  for (int k = 0; k < 5; k++) {
    int l = (k + 1) % 5;

    shape_tri(m, p[0][k], p[0][l], p[1][l], 0);
    shape_tri(m, p[0][k], p[1][l], p[1][k], 0);
  }
  for (int k = 1; k < 4; k++) {
    shape_tri(m, p[0][0], p[0][k + 1], p[0][k], 0);
    shape_tri(m, p[1][0], p[1][k], p[1][k + 1], 0);
  }
}

/* Where the edges of the chamfer are closer together than the tolerance, one of
 * the two is dropped. */
static void closes_narrow_strips(void **unused)
{
  const double from = 2e-5, to = 0.01, across = 2;

  (void)unused;
  for (int kept = 0; kept < 2; kept++) {
    struct vg_mesh m = VG_MESH_INIT, given = VG_MESH_INIT;
    struct vg_remesh_options o = VG_REMESH_OPTIONS_INIT;
    struct vg_remesh_report r = VG_REMESH_REPORT_INIT;
    struct vg_surface_quality q;
    struct vg_error err = VG_ERROR_INIT;
    double far;

    shape_chamfered(&m, from, to);
    assert_int_equal(vg_mesh_copy(&given, &m, &err), VG_OK);
    o.across = kept ? &across : NULL;
    remesh(&m, &o, &r);
    shape_expect_sound(&m, 0);
    assert_true(apart(&m, &given) <= r.tolerance);
    vg_surface_quality(&m, &q);
    far = 2 * (r.tolerance - from) / (to - from);
    if (kept) {
      assert_int_equal(r.n_closed, 0);
      assert_true(q.angle_min < 10);
    } else {
      assert_int_equal(r.n_closed, 1);
      assert_true(fabs(r.closed_length - far) < 0.01 * far);
      assert_true(fabs(r.closed_width - r.tolerance) < 1e-3 * r.tolerance);
      /* edges of up to 2.8 tolerances across a strip of 1 */
      assert_true(q.angle_min > 15);
    }
    vg_remesh_report_release(&r);
    vg_mesh_release(&m);
    vg_mesh_release(&given);
  }
}

/* A thin plate whose accuracy is given, as that of a wrap: it becomes the
 * tolerance. If it is almost the thickness, the plate's edges need not stay
 * feature edges and sizes are larger. */
static void given_accuracy_becomes_the_tolerance(void **unused)
{
  const double size[3] = { 2, 1, 0.01 };
  const uint32_t n[3] = { 4, 4, 1 };
  size_t n_tri[3], n_line[3];

  (void)unused;
  for (int i = 0; i < 3; i++) {
    struct vg_mesh m = VG_MESH_INIT;
    struct vg_remesh_options o = VG_REMESH_OPTIONS_INIT;
    struct vg_remesh_report r = VG_REMESH_REPORT_INIT;

    shape_box(&m, size, n);
    o.accuracy = i ? i > 1 ? 0.008 : 0.0005 : 0;
    remesh(&m, &o, &r);
    shape_expect_sound(&m, 0);
    assert_float_equal(r.tolerance, i ? o.accuracy : 2e-4, 1e-12);
    n_tri[i] = r.n_tri[1];
    n_line[i] = r.n_line;
    vg_remesh_report_release(&r);
    vg_mesh_release(&m);
  }
  assert_int_equal(n_line[0], 12);
  assert_int_equal(n_line[1], 12);
  /* 0.01 across and less than 3 x 0.008: sizes are larger */
  assert_true(n_tri[2] < n_tri[0] / 2);
  assert_true(n_line[2] <= n_line[0]);
}

/* Half a body: the rim stays in its plane. */
static void keeps_open_rims(void **unused)
{
  const double size[3] = { 1, 1, 1 };
  const uint32_t n[3] = { 8, 3, 3 };
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_remesh_options o = VG_REMESH_OPTIONS_INIT;
  struct vg_remesh_report r = VG_REMESH_REPORT_INIT;
  size_t keep = 0, n_rim = 0;

  (void)unused;
  shape_box(&m, size, n);
  for (size_t t = 0; t < m.n_tri; t++) {
    if (m.tri_patch[t] == 2) continue; /* y = 0 */
    memmove(m.tri[keep], m.tri[t], sizeof *m.tri);
    m.tri_patch[keep++] = m.tri_patch[t];
  }
  m.n_tri = keep;
  shape_weld(&m); /* remove the points of the side */
  o.h_max = 0.1;
  remesh(&m, &o, &r);
  shape_expect_sound(&m, 1);
  for (size_t p = 0; p < m.n_point; p++) n_rim += m.point[p][1] == 0;
  assert_true(n_rim >= 36 && n_rim <= 60); /* a length of 4 by 0.1 */
  vg_remesh_report_release(&r);
  vg_mesh_release(&m);
}

static void obeys_sources(void **unused)
{
  const double size[3] = { 1, 1, 1 };
  const uint32_t n[3] = { 2, 2, 2 };
  const struct vg_source s = {
    .kind = VG_SOURCE_POINT, .p0 = { 1, .5, .5 }, .h0 = 0.01, .h1 = 0.01
  };
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_remesh_options o = VG_REMESH_OPTIONS_INIT;
  struct vg_remesh_report r = VG_REMESH_REPORT_INIT;
  double least = INFINITY;

  (void)unused;
  shape_box(&m, size, n);
  o.h_max = 0.2;
  o.n_source = 1;
  o.source = &s;
  remesh(&m, &o, &r);
  shape_expect_sound(&m, 0);
  assert_true(edge_within(&r) > 0.9);
  for (size_t t = 0; t < m.n_tri; t++)
    for (int k = 0; k < 3; k++)
      least = fmin(least, vg_distance(m.point[m.tri[t][k]],
                                      m.point[m.tri[t][(k + 1) % 3]]));
  assert_true(least > 0.005 && least < 0.015);
  vg_remesh_report_release(&r);
  vg_mesh_release(&m);
}

/* Sources act on a surface as in the volume: edges are as long as in the sizing
 * field of the same settings, for VGRID's sources and others. */
static void obeys_the_field_of_the_volume(void **unused)
{
  const double size[3] = { 4, 4, 1 };
  const uint32_t n[3] = { 4, 4, 1 };
  const struct vg_source s[3] = { { .kind = VG_SOURCE_VGRID_NODE,
                                    .p0 = { 0, 0, 1 },
                                    .h0 = 0.05,
                                    .h1 = 0.05,
                                    .an = 1 },
                                  { .kind = VG_SOURCE_VGRID_NODE,
                                    .p0 = { 4, 4, 1 },
                                    .h0 = 0.4,
                                    .h1 = 0.4,
                                    .an = 1 },
                                  { .kind = VG_SOURCE_SPHERE,
                                    .p0 = { 3, 1, 1 },
                                    .r0 = 0.3,
                                    .h0 = 0.04,
                                    .h1 = 0.04,
                                    .growth = 1.3 } };
  const struct vg_sizing_options of = {
    .h_max = 0.3, .growth = 1.2, .scale = 1.2, .threads = 1, .coarseness = 1
  };
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_remesh_options o = VG_REMESH_OPTIONS_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_sizing *field;
  size_t n_edge = 0, n_fit = 0;
  double sum = 0;

  (void)unused;
  shape_box(&m, size, n);
  assert_int_equal(vg_sizing_new(&of, 3, s, &m, &field, &err), VG_OK);
  o.h_max = of.h_max;
  o.scale = of.scale;
  o.n_source = 3;
  o.source = s;
  remesh(&m, &o, NULL);
  for (size_t t = 0; t < m.n_tri; t++)
    for (int k = 0; k < 3; k++) {
      const double *a = m.point[m.tri[t][k]];
      const double *b = m.point[m.tri[t][(k + 1) % 3]];
      double mid[3], ratio;

      for (int d = 0; d < 3; d++) mid[d] = (a[d] + b[d]) / 2;
      ratio = vg_distance(a, b) / vg_sizing_at(field, mid);
      sum += ratio;
      n_edge++;
      n_fit += ratio > 0.7 && ratio < 1.42;
    }
  /* Edge lengths of any remeshed surface: row S21 of decisions.md. */
  assert_true((double)n_fit > 0.9 * (double)n_edge);
  assert_true(fabs(sum / (double)n_edge - 1) < 0.1);
  vg_sizing_free(field);
  vg_mesh_release(&m);
}

/* At half the scale edges are half as long and the number of triangles is four
 * times higher, whether sizes come from the settings, curvature, or a source.
 */
static void scales_all_sizes(void **unused)
{
  const double size[3] = { 1, 0.6, 0.3 };
  const struct vg_source s = { .kind = VG_SOURCE_POINT,
                               .p0 = { 1, 0, 0 },
                               .r0 = 0.1,
                               .h0 = 0.04,
                               .h1 = 0.04 };
  struct vg_surface_quality q[2];
  struct vg_remesh_report r = VG_REMESH_REPORT_INIT;

  (void)unused;
  for (int i = 0; i < 2; i++) {
    struct vg_mesh m = VG_MESH_INIT;
    struct vg_remesh_options o = VG_REMESH_OPTIONS_INIT;

    shape_ball(&m, size, 96);
    o.tolerance = 0.01;
    o.h_max = 0.2;
    o.h_min = 0.01;
    o.n_source = 1;
    o.source = &s;
    o.scale = i ? 0.5 : 1;
    remesh(&m, &o, &r);
    assert_float_equal(r.h_max, 0.2 * o.scale, 1e-12);
    assert_float_equal(r.tolerance, 0.01 * o.scale, 1e-12);
    vg_surface_quality(&m, &q[i]);
    vg_mesh_release(&m);
  }
  assert_float_equal((double)q[1].n / (double)q[0].n, 4, 0.3);
  assert_float_equal(q[1].edge_mean / q[0].edge_mean, 0.5, 0.025);
  vg_remesh_report_release(&r);
}

/* The report on a surface that is not changed. */
static void judges_a_surface(void **unused)
{
  const double size[3] = { 3, 2, 1 };
  const uint32_t n[3] = { 30, 20, 10 };
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_remesh_options o = VG_REMESH_OPTIONS_INIT;
  struct vg_remesh_report r = VG_REMESH_REPORT_INIT;
  struct vg_error err = VG_ERROR_INIT;

  (void)unused;
  shape_box(&m, size, n);
  o.h_max = 0.1;
  assert_int_equal(vg_remesh_judge(&m, &o, &r, &err), VG_OK);
  assert_int_equal(r.n_corner, 8);
  assert_int_equal(r.n_line, 12);
  assert_float_equal(r.line_length[0], 24, 1e-9);
  assert_int_equal(r.n_tri[0], m.n_tri);
  assert_int_equal(r.n_tri[1], m.n_tri);
  assert_int_equal(r.n_split + r.n_collapse + r.n_swap + r.n_move, 0);
  assert_int_equal(r.n_bad, 0);
  /* 0.1 along the axes; diagonals, a third of all, are 0.14. */
  assert_true(edge_within(&r) > 0.6);
  o.h_max = 0.4;
  assert_int_equal(vg_remesh_judge(&m, &o, &r, &err), VG_OK);
  assert_true(edge_within(&r) < 0.01);
  vg_remesh_report_release(&r);
  vg_mesh_release(&m);
}

static void expect_equal(const struct vg_mesh *a, const struct vg_mesh *b)
{
  assert_int_equal(a->n_point, b->n_point);
  assert_int_equal(a->n_tri, b->n_tri);
  assert_memory_equal(a->point, b->point, a->n_point * sizeof *a->point);
  assert_memory_equal(a->tri, b->tri, a->n_tri * sizeof *a->tri);
  assert_memory_equal(a->tri_patch, b->tri_patch,
                      a->n_tri * sizeof *a->tri_patch);
}

static void same_bytes_for_any_threads(void **unused)
{
  const double size[3] = { 2, 1, 0.5 };
  struct vg_mesh m[3] = { VG_MESH_INIT };
  struct vg_remesh_options o = VG_REMESH_OPTIONS_INIT;

  (void)unused;
  o.tolerance = 2e-3;
  for (int i = 0; i < 3; i++) {
    shape_ball(&m[i], size, 16);
    o.threads = i + 1;
    remesh(&m[i], &o, NULL);
    expect_equal(&m[0], &m[i]);
  }
  for (int i = 0; i < 3; i++) vg_mesh_release(&m[i]);
}

static double drawn(uint32_t *state, double lo, double hi)
{
  *state = *state * 1664525u + 1013904223u;
  return lo + (hi - lo) * ((double)(*state >> 8) / 16777216.);
}

/* Stretch factors for all edges of constant z, which makes them feature edges:
 * many curves close to each other, closed ones and some that meet in corners.
 */
static double *along_levels(const struct vg_mesh *m, double by)
{
  double *stretch = calloc(3 * m->n_tri, sizeof *stretch);

  for (size_t t = 0; t < m->n_tri; t++)
    for (int k = 0; k < 3; k++)
      if (m->point[m->tri[t][k]][2] == m->point[m->tri[t][(k + 1) % 3]][2])
        stretch[3 * t + (size_t)k] = by;
  return stretch;
}

/* Boxes and ellipsoids of any proportion, some with a box a gap apart: for any
 * settings the remeshed surface is valid, within the tolerance, and keeps its
 * feature edges. */
static void random_search(void **unused)
{
  uint32_t state = 7;

  (void)unused;
  for (int i = 0; i < 24; i++) {
    struct vg_mesh m = VG_MESH_INIT, old = VG_MESH_INIT;
    struct vg_remesh_options o = VG_REMESH_OPTIONS_INIT;
    struct vg_remesh_report r = VG_REMESH_REPORT_INIT;
    struct vg_error err = VG_ERROR_INIT;
    double size[3], gap = drawn(&state, 0.001, 0.02), *stretch = NULL;
    uint32_t n[3];
    size_t first;

    for (int k = 0; k < 3; k++) {
      size[k] = drawn(&state, 0.02, 1);
      n[k] = (uint32_t)drawn(&state, 1, 12);
    }
    if (i % 2) shape_box(&m, size, n);
    else shape_ball(&m, size, 4 + n[0]);
    first = m.n_point;
    if (i % 3 == 0) { /* next to it, a box of the same height */
      struct vg_mesh b = VG_MESH_INIT;

      shape_box(&b, size, n);
      for (size_t p = 0; p < b.n_point; p++)
        shape_point(&m, b.point[p][0] + size[0] + gap, b.point[p][1],
                    b.point[p][2]);
      for (size_t t = 0; t < b.n_tri; t++)
        shape_tri(&m, b.tri[t][0] + (uint32_t)first,
                  b.tri[t][1] + (uint32_t)first, b.tri[t][2] + (uint32_t)first,
                  0);
      vg_mesh_release(&b);
    }
    assert_int_equal(vg_mesh_copy(&old, &m, &err), VG_OK);
    o.tolerance = drawn(&state, 1e-3, 1e-2);
    o.per_turn = drawn(&state, 8, 30);
    o.h_max = drawn(&state, 0.05, 0.5);
    o.h_min = 2e-3;
    o.growth = drawn(&state, 1.1, 1.6);
    if (i % 4 > 1) o.stretch = stretch = along_levels(&m, 1.5 * i / 2);
    remesh(&m, &o, &r);
    free(stretch);
    shape_expect_sound(&m, 0);
    /* divided by the cosine of half the feature angle */
    assert_true(apart(&m, &old) <= 1.065 * o.tolerance);
    if (i % 2) /* straight ones */
      assert_float_equal(r.line_length[1], r.line_length[0], 1e-9);
    vg_remesh_report_release(&r);
    vg_mesh_release(&m);
    vg_mesh_release(&old);
  }
}

/* --- refusals ------------------------------------------------------------ */

static void refuse(struct vg_mesh *m, const struct vg_remesh_options *o,
                   vg_status status, const char *phrase)
{
  struct vg_remesh_report r = { .n_split = 77 };
  struct vg_error err = VG_ERROR_INIT;
  struct vg_mesh old = VG_MESH_INIT;

  assert_int_equal(vg_mesh_copy(&old, m, &err), VG_OK);
  assert_int_equal(vg_remesh(m, o, &r, &err), status);
  if (!strstr(err.text, phrase)) fail_msg("%s", err.text);
  assert_int_equal(r.n_split, 77);
  assert_int_equal(m->n_tri, old.n_tri);
  assert_memory_equal(m->tri, old.tri, m->n_tri * sizeof *m->tri);
  assert_memory_equal(m->point, old.point, m->n_point * sizeof *m->point);
  vg_mesh_release(&old);
}

static void refuses(void **unused)
{
  const double size[3] = { 1, 1, 1 };
  const uint32_t n[3] = { 2, 2, 2 };
  struct vg_mesh m = VG_MESH_INIT, none = VG_MESH_INIT;
  struct vg_remesh_options o = VG_REMESH_OPTIONS_INIT;
  double x;
  uint32_t k;

  (void)unused;
  shape_box(&m, size, n);
  refuse(&none, &o, VG_ERR_INPUT, "can be remeshed");
  x = m.point[3][1];
  m.point[3][1] = NAN;
  refuse(&m, &o, VG_ERR_INPUT, "not finite");
  m.point[3][1] = x;
  k = m.tri[4][0];
  m.tri[4][0] = (uint32_t)m.n_point;
  refuse(&m, &o, VG_ERR_INPUT, "triangle 5");
  m.tri[4][0] = m.tri[4][1];
  m.tri[4][1] = k;
  refuse(&m, &o, VG_ERR_INPUT, "orientation is opposite");
  m.tri[4][1] = m.tri[4][0];
  m.tri[4][0] = k;
  shape_tri(&m, m.tri[0][0], m.tri[0][1], m.tri[0][2], 0);
  refuse(&m, &o, VG_ERR_INPUT, "three triangles");
  m.n_tri--;
  o.h_max = 1e-7;
  refuse(&m, &o, VG_ERR_INPUT, "unit");
  o.h_min = 2e-7;
  refuse(&m, &o, VG_ERR_INPUT, "above the largest");
  o = (struct vg_remesh_options)VG_REMESH_OPTIONS_INIT;
  o.tolerance = -1;
  refuse(&m, &o, VG_ERR_INPUT, "tolerance");
  o.tolerance = 0;
  o.accuracy = NAN;
  refuse(&m, &o, VG_ERR_INPUT, "accuracy");
  o.accuracy = 0;
  o.growth = 1;
  refuse(&m, &o, VG_ERR_INPUT, "growth");
  o.growth = 1.2;
  vg_mesh_release(&m);
}

/* Requests a stop from the k-th poll on. */
struct patience {
  size_t asked, k;
};

static int is_over(void *user)
{
  struct patience *p = user;

  return __atomic_add_fetch(&p->asked, 1, __ATOMIC_RELAXED) > p->k;
}

static vg_status remesh_until(struct vg_mesh *m, struct patience *p)
{
  struct vg_remesh_options o = VG_REMESH_OPTIONS_INIT;
  struct vg_error err = VG_ERROR_INIT;

  o.h_max = 0.03;
  o.threads = 2;
  o.stop = (struct vg_stop){ is_over, p };
  return vg_remesh(m, &o, NULL, &err);
}

/* The stop request is polled before every change, so the work does not continue
 * after it: each stage, or block of the surface, notices it within a poll or
 * two. */
static void stops_wherever_it_is(void **unused)
{
  struct vg_mesh m = VG_MESH_INIT, old = VG_MESH_INIT;
  struct patience all = { 0, SIZE_MAX };
  struct vg_error err = VG_ERROR_INIT;

  (void)unused;
  shape_ball(&m, (double[3]){ 1, 0.7, 0.4 }, 40);
  assert_int_equal(vg_mesh_copy(&old, &m, &err), VG_OK);
  assert_int_equal(remesh_until(&m, &all), VG_OK);
  assert_true(all.asked > 10 * m.n_tri);
  for (size_t i = 0; i <= 20; i++) {
    struct patience p = { 0, i ? all.asked * (i - 1) / 20 : 0 };

    vg_mesh_release(&m);
    assert_int_equal(vg_mesh_copy(&m, &old, &err), VG_OK);
    assert_int_equal(remesh_until(&m, &p), VG_ERR_STOPPED);
    assert_true(p.asked < p.k + 40);
    assert_int_equal(m.n_tri, old.n_tri);
    assert_memory_equal(m.tri, old.tri, m.n_tri * sizeof *m.tri);
  }
  vg_mesh_release(&old);
  vg_mesh_release(&m);
}

static void stops_measuring(void **unused)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_remesh_distance d[2];
  struct vg_error err = VG_ERROR_INIT;

  (void)unused;
  shape_ball(&m, (double[3]){ 1, 0.7, 0.4 }, 40);
  for (size_t k = 0; k < 10; k += 3) {
    struct patience p = { 0, k };
    const struct vg_stop stop = { is_over, &p };

    assert_int_equal(vg_remesh_measure(&m, &m, 2, &stop, NULL, d, &err),
                     VG_ERR_STOPPED);
  }
  vg_mesh_release(&m);
}

/* Two boxes, one of them longer by 0.2: the distance is 0.2 in both directions,
 * for any order of triangles and any number of threads. */
static void measures_in_any_order(void **unused)
{
  const double size[2][3] = { { 3, 2, 1 }, { 3.2, 2, 1 } };
  const uint32_t n[2][3] = { { 2, 90, 4 }, { 7, 5, 30 } };
  struct vg_mesh m[2] = { VG_MESH_INIT, VG_MESH_INIT };
  struct vg_error err = VG_ERROR_INIT;
  double area[2][6], *face;

  (void)unused;
  for (int i = 0; i < 2; i++) {
    shape_box(&m[i], size[i], n[i]);
    for (size_t p = 0; p < 6; p++) area[i][p] = shape_area(&m[i], p);
  }
  face = calloc(m[0].n_tri, sizeof *face);
  assert_non_null(face);
  for (int arranged = 0; arranged < 2; arranged++) {
    for (int threads = 1; threads < 4; threads++) {
      struct vg_remesh_distance d[2];
      double most = 0;

      assert_int_equal(vg_remesh_measure(&m[0], &m[1], threads, NULL, face, d,
                                         &err),
                       VG_OK);
      for (size_t t = 0; t < m[0].n_tri; t++) most = fmax(most, face[t]);
      assert_float_equal(d[0].most, 0.2, 1e-12);
      assert_float_equal(d[1].most, 0.2, 1e-12);
      assert_float_equal(d[1].at[0], 3.2, 1e-12);
      assert_true(most == d[0].most);
    }
    for (int i = 0; i < 2; i++) {
      assert_int_equal(vg_remesh_arrange(&m[i], &err), VG_OK);
      for (size_t p = 0; p < 6; p++)
        assert_float_equal(shape_area(&m[i], p), area[i][p], 1e-12);
    }
  }
  free(face);
  vg_mesh_release(&m[0]);
  vg_mesh_release(&m[1]);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(leaves_out_false_ridges),
    cmocka_unit_test(edges_go_across_strips),
    cmocka_unit_test(keeps_thin_edges),
    cmocka_unit_test(improves_sliver_triangles),
    cmocka_unit_test(keeps_a_ball_round),
    cmocka_unit_test(keeps_fixed_borders),
    cmocka_unit_test(keeps_imprinted_openings),
    cmocka_unit_test(keeps_area_of_narrow_patches),
    cmocka_unit_test(refines_large_plane_triangles),
    cmocka_unit_test(follows_strips),
    cmocka_unit_test(closes_narrow_strips),
    cmocka_unit_test(given_accuracy_becomes_the_tolerance),
    cmocka_unit_test(keeps_open_rims),
    cmocka_unit_test(obeys_sources),
    cmocka_unit_test(obeys_the_field_of_the_volume),
    cmocka_unit_test(scales_all_sizes),
    cmocka_unit_test(judges_a_surface),
    cmocka_unit_test(same_bytes_for_any_threads),
    cmocka_unit_test(measures_in_any_order),
    cmocka_unit_test(random_search),
    cmocka_unit_test(refuses),
    cmocka_unit_test(stops_wherever_it_is),
    cmocka_unit_test(stops_measuring),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
