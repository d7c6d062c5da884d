/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Gaps between facing surfaces: known widths, cases without a gap, and the
 * edges of a surface remeshed for gaps. */
#include "remesh_shapes.h"

#include "core/remesh/gaps.h"
#include "core/remesh/remesh.h"
#include "core/sizing/sizing_map.h"

/* A second box `gap` above the first one in z. */
static void add_box(struct vg_mesh *m, const double size[3],
                    const uint32_t n[3], double x, double gap)
{
  struct vg_mesh b = VG_MESH_INIT;
  uint32_t first = (uint32_t)m->n_point;

  shape_box(&b, size, n);
  for (size_t p = 0; p < b.n_point; p++)
    shape_point(m, b.point[p][0] + x, b.point[p][1],
                b.point[p][2] + size[2] + gap);
  for (size_t t = 0; t < b.n_tri; t++)
    shape_tri(m, b.tri[t][0] + first, b.tri[t][1] + first, b.tri[t][2] + first,
              b.tri_patch[t]);
  vg_mesh_release(&b);
}

static void find(const struct vg_mesh *m, double edges, int threads,
                 struct vg_gaps *g)
{
  struct vg_gap_options o = { .edges = edges, .threads = threads };
  struct vg_error err = VG_ERROR_INIT;

  if (vg_gaps_find(m, &o, g, &err) < 0) fail_msg("%s", err.text);
}

/* Two plates that overlap by half, with two triangles per side: every sample
 * point is in the gap, in pairs across it, and their spacing is the width of
 * the gap. */
static void measures_a_slot(void **unused)
{
  const double size[3] = { 1, 1, 0.2 }, gap = 0.02, edges = 4;
  const uint32_t n[3] = { 1, 1, 1 };
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_gaps g = VG_GAPS_INIT;

  (void)unused;
  shape_box(&m, size, n);
  add_box(&m, size, n, 0.5, gap);
  find(&m, edges, 1, &g);
  assert_float_equal(g.narrowest, gap, 1e-12);
  for (size_t i = 0; i < g.n; i++) {
    assert_float_equal(g.h[i], gap / edges, 1e-12);
    assert_true(g.x[i][0] >= 0.5 && g.x[i][0] <= 1);
    assert_float_equal(g.x[i][2],
                       g.x[i ^ 1][2] > g.x[i][2] ? size[2] : size[2] + gap,
                       1e-12);
  }
  /* An area of 2 x 0.5, seen from both sides, in right triangles with a
   * hypotenuse of gap / sqrt 2 to gap: of gap^2 / 8 to gap^2 / 4. */
  assert_true(g.n >= (size_t)(2 * 4 / (gap * gap) * 0.9));
  assert_true(g.n <= (size_t)(2 * 8 / (gap * gap) * 1.1));
  vg_gaps_release(&g);
  vg_mesh_release(&m);
}

/* The thickness of a plate is not a gap. Neither are planes at right angles,
 * nor distances wider than the largest size would need. */
static void ignores_distances_that_are_not_gaps(void **unused)
{
  const double plate[3] = { 1, 1, 0.001 }, size[3] = { 1, 1, 0.2 };
  const uint32_t n[3] = { 3, 3, 1 };
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_gaps g = VG_GAPS_INIT;

  (void)unused;
  shape_box(&m, plate, n);
  find(&m, 4, 1, &g);
  assert_int_equal(g.n, 0);
  vg_mesh_release(&m);
  shape_box(&m, size, n);
  add_box(&m, size, n, 0, 0.25); /* 4 x 0.04 x 0.65 is less than 0.05 */
  find(&m, 4, 1, &g);
  assert_int_equal(g.n, 0);
  find(&m, 8, 1, &g); /* 8 x 0.04 is more than 0.05 */
  assert_true(g.n > 0);
  vg_gaps_release(&g);
  vg_mesh_release(&m);
}

/* Two cylinders side by side: the narrowest point is between them, and the gap
 * widens with their circles. */
static void follows_round_sides(void **unused)
{
  const double r[3] = { 0.5, 0.5, 2 }, gap = 0.01;
  struct vg_mesh m = VG_MESH_INIT, b = VG_MESH_INIT;
  struct vg_gaps g = VG_GAPS_INIT, again = VG_GAPS_INIT;
  uint32_t first;

  (void)unused;
  shape_ball(&m, r, 40);
  first = (uint32_t)m.n_point;
  shape_ball(&b, r, 40);
  for (size_t p = 0; p < b.n_point; p++)
    shape_point(&m, b.point[p][0] + 1 + gap, b.point[p][1], b.point[p][2]);
  for (size_t t = 0; t < b.n_tri; t++)
    shape_tri(&m, b.tri[t][0] + first, b.tri[t][1] + first, b.tri[t][2] + first,
              0);
  find(&m, 3, 1, &g);
  assert_true(g.n > 0);
  /* Facets are inside the circles by 0.5 (1 - cos(pi / 80)). */
  assert_true(g.narrowest > 0.99 * gap && g.narrowest < gap + 0.002);
  assert_true(fabs(g.at[1]) < 0.1 && fabs(g.at[2]) < 0.3);
  for (size_t i = 0; i < g.n; i += 2) {
    double half = vg_distance(g.x[i], g.x[i + 1]) / 2;

    assert_float_equal(g.h[i], 2 * half / 3, 1e-12);
    assert_true(2 * half >= g.narrowest);
  }
  find(&m, 3, 3, &again);
  assert_int_equal(g.n, again.n);
  assert_memory_equal(g.x, again.x, g.n * sizeof *g.x);
  assert_memory_equal(g.h, again.h, g.n * sizeof *g.h);
  vg_gaps_release(&g);
  vg_gaps_release(&again);
  vg_mesh_release(&m);
  vg_mesh_release(&b);
}

/* Edges of the remeshed surface in the slot are at most a fourth of its width,
 * and long again away from it. */
static void makes_edges_short_in_a_slot(void **unused)
{
  const double size[3] = { 1, 0.3, 0.2 }, gap = 0.04, edges = 4;
  const uint32_t n[3] = { 2, 1, 1 };
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_gaps g = VG_GAPS_INIT;
  struct vg_size_samples *samples;
  struct vg_remesh_options o = VG_REMESH_OPTIONS_INIT;
  struct vg_error err = VG_ERROR_INIT;
  double in = 0, out = 0;
  size_t n_in = 0;

  (void)unused;
  shape_box(&m, size, n);
  add_box(&m, size, n, 0.6, gap);
  find(&m, edges, 1, &g);
  assert_int_equal(vg_size_samples_new(g.n, (const double(*)[3])g.x, g.h, 1.2,
                                       1, &samples, &err),
                   VG_OK);
  o.map = vg_size_samples_map(samples);
  o.h_max = 0.1;
  if (vg_remesh(&m, &o, NULL, &err) < 0) fail_msg("%s", err.text);
  shape_expect_sound(&m, 0);
  for (size_t t = 0; t < m.n_tri; t++)
    for (int k = 0; k < 3; k++) {
      const double *a = m.point[m.tri[t][k]];
      const double *b = m.point[m.tri[t][(k + 1) % 3]];
      double l = vg_distance(a, b);
      double x = (a[0] + b[0]) / 2, z = (a[2] + b[2]) / 2;

      if (x > 0.65 && x < 0.95 && z > 0.199 && z < 0.241) in += l, n_in++;
      if (x < 0.3) out = fmax(out, l);
    }
  assert_true(n_in > 100);
  assert_true(in / (double)n_in < 1.1 * gap / edges);
  assert_true(out > 0.05);
  vg_size_samples_free(samples);
  vg_gaps_release(&g);
  vg_mesh_release(&m);
}

/* The plates of measures_a_slot: the forecast of sample points is right within
 * a factor of 2, and that of triangles follows from the area of the gap. If the
 * forecast exceeds the limit, no sample points are made. */
static void forecasts(void **unused)
{
  const double size[3] = { 1, 1, 0.2 }, gap = 0.02, edges = 4;
  const double exact = 2 * 0.5 / (0.433 * (gap / edges) * (gap / edges));
  const uint32_t n[3] = { 1, 1, 1 };
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_gaps g = VG_GAPS_INIT, few = VG_GAPS_INIT;
  struct vg_gap_options o = { .edges = edges, .threads = 1 };
  struct vg_error err = VG_ERROR_INIT;

  (void)unused;
  shape_box(&m, size, n);
  add_box(&m, size, n, 0.5, gap);
  assert_int_equal(vg_gaps_find(&m, &o, &g, &err), VG_OK);
  assert_true(g.n > 0);
  o.most_place = 0.4 * (double)g.n;
  assert_int_equal(vg_gaps_find(&m, &o, &few, &err), VG_BLOCKED);
  assert_true(few.n == 0 && few.x == NULL);
  assert_true(few.n_place > 0.5 * (double)g.n);
  assert_true(few.n_place < 2 * (double)g.n);
  assert_float_equal(few.narrowest, gap, 1e-12);
  assert_true(few.n_tri > 0.95 * exact && few.n_tri < 1.05 * exact);
  o.most_place = 3 * (double)g.n;
  o.most_tri = 0.9 * exact;
  assert_int_equal(vg_gaps_find(&m, &o, &few, &err), VG_BLOCKED);
  assert_true(few.patch[0] != few.patch[1] || m.n_patch == 1);
  o.most_tri = 1.1 * exact;
  o.threads = 2;
  vg_gaps_release(&few);
  assert_int_equal(vg_gaps_find(&m, &o, &few, &err), VG_OK);
  assert_int_equal(few.n, g.n); /* as without limits */
  vg_gaps_release(&few);
  vg_gaps_release(&g);
  vg_mesh_release(&m);
}

static void refuses(void **unused)
{
  const double size[3] = { 1, 1, 1 };
  const uint32_t n[3] = { 1, 1, 1 };
  struct vg_mesh m = VG_MESH_INIT, none = VG_MESH_INIT;
  struct vg_gaps g = VG_GAPS_INIT;
  struct vg_gap_options o = { .edges = 0 };
  struct vg_error err = VG_ERROR_INIT;

  (void)unused;
  shape_box(&m, size, n);
  assert_int_equal(vg_gaps_find(&m, &o, &g, &err), VG_ERR_INPUT);
  o.edges = 3;
  o.h_max = 1e-6;
  assert_int_equal(vg_gaps_find(&m, &o, &g, &err), VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "unit"));
  o.h_max = 0;
  shape_tri(&m, m.tri[0][0], m.tri[0][1], m.tri[0][2], 0);
  assert_int_equal(vg_gaps_find(&m, &o, &g, &err), VG_ERR_INPUT);
  assert_int_equal(g.n, 0);
  assert_int_equal(vg_gaps_find(&none, &o, &g, &err), VG_OK);
  vg_mesh_release(&m);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(measures_a_slot),
    cmocka_unit_test(ignores_distances_that_are_not_gaps),
    cmocka_unit_test(follows_round_sides),
    cmocka_unit_test(makes_edges_short_in_a_slot),
    cmocka_unit_test(forecasts),
    cmocka_unit_test(refuses),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
