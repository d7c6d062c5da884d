/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Load estimates: volumes of shapes, cells compared with the mesher's, the
 * split among children, quantiles, messages. */
#include "load_support.h"

#include "base/comm.h"
#include "fill_shapes.h"

static void demos_keep_their_volume(void **state)
{
  static const struct {
    const char *name;
    size_t n_cell;
  } list[] = { { "box", 200000 },
               { "sphere", 1000000 },
               { "wing-half", 100000 } };

  (void)state;
  for (size_t i = 0; i < sizeof list / sizeof *list; i++) {
    struct vg_load l;
    struct scene s;

    make_demo(&s, list[i].name, list[i].n_cell);
    estimate(&s, 1, &l);
    check_volume(&s, &l);
    vg_load_release(&l);
    release_scene(&s);
  }
}

/* Nothing inside the sphere, everything well outside of it. */
static void a_stray_body_is_omitted(void **state)
{
  struct vg_load l;
  struct scene s;
  double far = 0;

  (void)state;
  make_demo(&s, "sphere", 200000);
  estimate(&s, 1, &l);
  for (size_t i = 0; i < l.n; i++) {
    const struct vg_load_octant *c = &l.octant[i];
    double most = 0, least = 0, out = 0;

    for (int k = 0; k < 3; k++) {
      const double x = fabs((double)c->at[k]), half = (double)c->half;

      most += (x + half) * (x + half);
      least += x > half ? (x - half) * (x - half) : 0;
      if (x + half > out) out = x + half;
    }
    assert_true(most > 1);
    if (least < 1.1 || out > 20) continue;
    assert_true(c->part > 0.999f && c->part < 1.001f);
    far += volume_of(c);
  }
  assert_true(far > 0.4 * s.volume);
  vg_load_release(&l);
  release_scene(&s);
}

static void the_result_is_independent_of_threads(void **state)
{
  struct vg_load l, other;
  struct scene s;

  (void)state;
  make_demo(&s, "wing-half", 100000);
  estimate(&s, 1, &l);
  for (int threads = 2; threads < 4; threads++) {
    estimate(&s, threads, &other);
    assert_int_equal(other.n, l.n);
    assert_true(memcmp(&other.cells, &l.cells, sizeof l.cells) == 0);
    assert_memory_equal(other.octant, l.octant, l.n * sizeof *l.octant);
    vg_load_release(&other);
  }
  vg_load_release(&l);
  release_scene(&s);
}

/* --- against the mesher -------------------------------------------------- */

/* 15 %: an error that the choice of a decomposition tolerates. */
static void estimate_agrees_with_the_mesh(void **state)
{
  (void)state;
  compare_with_mesh("box", 20000, 1.2, 1.15);
  compare_with_mesh("box", 200000, 1.2, 1.15);
  compare_with_mesh("sphere", 200000, 1.2, 1.15);
}

/* Sources so small that no sample of a large octant would hit them. */
static void small_sources_count(void **state)
{
  const struct vg_source line = { .kind = VG_SOURCE_LINE,
                                  .h0 = 0.001,
                                  .h1 = 0.001,
                                  .p0 = { 0.2, 0.3, 0.25 },
                                  .p1 = { 0.8, 0.62, 0.7 } };
  const struct vg_source ball = {
    .kind = VG_SOURCE_SPHERE, .h0 = 0.02, .r0 = 0.2, .p0 = { 9.3, 4, 3 }
  };

  (void)state;
  compare_sourced("box", 20000, 2, &line, 1.15);
  compare_sourced("sphere", 50000, 2, &ball, 1.15);
  compare_sourced("sphere", 50000, 4, &ball, 1.15);
}

/* The number of cells that the faces alone require, where the sizing field
 * would give almost none. */
static void faces_alone_require_cells(void **state)
{
  struct vg_load l;
  struct scene s;
  double sum = 0;

  (void)state;
  make_grown(&s, "sphere", 20000, 4);
  estimate(&s, 1, &l);
  assert_true(l.cells >= 1.499 * (double)s.front.n_face);
  for (size_t i = 0; i < l.n; i++) sum += (double)l.octant[i].cells;
  assert_true(fabs(sum / l.cells - 1) < 1e-6);
  vg_load_release(&l);
  release_scene(&s);
}

/* --- split --------------------------------------------------------------- */

/* Blocks of boxes that are cut from a block of 12 x 4 x 4. */
static int in_slab(const int at[3])
{
  return at[0] < 5;
}

static int in_corner(const int at[3])
{
  return at[0] > 5 && (at[1] < 2 || at[2] < 2);
}

static int in_rest(const int at[3])
{
  return at[0] > 5 && at[1] > 2 && at[2] > 2;
}

static int (*const piece[3])(const int at[3]) = { in_slab, in_corner, in_rest };
static const double share[3] = { 5. / 12, 4.5 / 12, 0.375 / 12 };

static void make_piece(struct vg_mesh *m, int (*in)(const int at[3]))
{
  const int n[3] = { 12, 4, 4 };
  const double lo[3] = { 0, 0, 0 }, hi[3] = { 3, 1, 1 };

  *m = (struct vg_mesh)VG_MESH_INIT;
  shape_block(m, n, lo, hi, in);
}

static void make_bar(struct scene *s)
{
  const int n[3] = { 60, 20, 20 };
  const double lo[3] = { 0, 0, 0 }, hi[3] = { 3, 1, 1 };
  struct vg_mesh m = VG_MESH_INIT;

  shape_block(&m, n, lo, hi, shape_all);
  make_scene(s, &m, 0.05);
}

static void children_get_their_share(void **state)
{
  struct vg_load l, part[3];
  struct vg_mesh m[3];
  struct vg_front front[3];
  struct scene s;

  (void)state;
  make_bar(&s);
  estimate(&s, 1, &l);
  for (int c = 0; c < 3; c++) {
    make_piece(&m[c], piece[c]);
    front[c] = vg_front_of(&m[c]);
  }
  assert_int_equal(vg_load_split(&l, 3, front, 1.5, NULL, part, NULL), VG_OK);
  for (int c = 0; c < 3; c++) {
    const double volume = vg_front_volume(&front[c]);

    assert_true(part[c].n > 0 && part[c].n < l.n);
    assert_true(fabs(volume / 3 - share[c]) < 1e-12);
    /* some tens of octants along each wall, samples of an eighth each */
    assert_true(fabs(sampled(&part[c]) / volume - 1) < 0.1);
    assert_true(fabs(fitted(&part[c]) / volume - 1) < 1e-5);
    /* uniform spacing, so cells are proportional to volume, except for
     * rounding */
    assert_true(fabs(part[c].cells / (1.5 * l.cells * volume / 3) - 1) < 1e-4);
    vg_mesh_release(&m[c]);
    vg_load_release(&part[c]);
  }
  vg_load_release(&l);
  release_scene(&s);
}

/* Split repeatedly down to the smallest blocks: the sums do not drift. */
static void repeated_splits_do_not_drift(void **state)
{
  struct vg_load l, next;
  struct scene s;
  double cells;
  size_t n;

  (void)state;
  make_demo(&s, "sphere", 200000);
  estimate(&s, 1, &l);
  cells = l.cells;
  n = l.n;
  for (int i = 0; i < 5; i++) {
    assert_int_equal(vg_load_split(&l, 1, &s.front, 1, NULL, &next, NULL),
                     VG_OK);
    assert_int_equal(next.n, n);
    assert_true(fabs(next.cells / cells - 1) < 1e-3);
    vg_load_release(&l);
    l = next;
  }
  vg_load_release(&l);
  release_scene(&s);
}

static void tiny_and_empty_children(void **state)
{
  const double at[3] = { 0.71, 0.53, 0.47 };
  struct vg_load l, part[2];
  struct vg_front front[2] = { VG_FRONT_INIT, VG_FRONT_INIT };
  struct vg_mesh m = VG_MESH_INIT;
  struct scene s;
  double volume;

  (void)state;
  make_bar(&s);
  estimate(&s, 1, &l);
  shape_sphere(&m, 3, at, 1e-3, 1);
  for (size_t i = 0; i < m.n_tri; i++) { /* interior of the block */
    const uint32_t a = m.tri[i][0];

    m.tri[i][0] = m.tri[i][1];
    m.tri[i][1] = a;
  }
  front[0] = vg_front_of(&m);
  volume = vg_front_volume(&front[0]);
  assert_true(volume > 0);
  assert_int_equal(vg_load_split(&l, 2, front, 1, NULL, part, NULL), VG_OK);
  assert_int_equal(part[0].n, 1);
  assert_true(fabs(part[0].cells / (l.cells * volume / 3) - 1) < 0.1);
  assert_int_equal(part[1].n, 0);
  assert_true(part[1].cells == 0);
  for (int c = 0; c < 2; c++) vg_load_release(&part[c]);
  assert_int_equal(vg_load_new(&front[1], s.sizing, 9, 1, &part[1], NULL),
                   VG_OK);
  assert_int_equal(part[1].n, 0);
  vg_mesh_release(&m);
  vg_load_release(&l);
  release_scene(&s);
}

/* Millimetres instead of metres: the impossible size is reported at once. */
static void sizes_in_another_unit_are_named(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_load l = VG_LOAD_INIT;
  struct scene s;

  (void)state;
  shape_box(&m, 2, 1);
  make_scene(&s, &m, 1e-6);
  for (int threads = 1; threads <= 2; threads++) {
    assert_int_equal(vg_load_new(&s.front, s.sizing, VG_LOAD_CELLS_PER_CUBE,
                                 threads, &l, &err),
                     VG_ERR_UNSUPPORTED);
    assert_non_null(strstr(err.text, "10 billion cells"));
    assert_null(l.octant);
  }
  release_scene(&s);
}

/* A void smaller than an edge still has a load equal to its volume. */
static void a_small_void_has_octants(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_load l;
  struct scene s;

  (void)state;
  shape_box(&m, 2, 1);
  make_scene(&s, &m, 0);
  estimate(&s, 1, &l);
  assert_true(l.n >= 8);
  assert_true(fabs(fitted(&l) / 8 - 1) < 1e-5);
  assert_true(fabs(vg_load_quantile(&l, 2, 0.5)) < 0.3);
  vg_load_release(&l);
  release_scene(&s);
}

/* --- queries ------------------------------------------------------------- */

static void two_octants(struct vg_load *l)
{
  static struct vg_load_octant octant[2] = {
    { { 1, 5, 0 }, 1, 0.5f, { 0.5f, 0.5f, 0.5f }, 1, 300 },
    { { 4, 5, 0 }, 2, 1, { 1, 1, 1 }, 1, 100 }
  };

  *l = (struct vg_load){ .n = 2, .octant = octant, .cells = 400, .unit = 1 };
  assert_int_equal(vg_load_index(l, 1, NULL), VG_OK);
}

static void release_index(struct vg_load *l)
{
  l->octant = NULL;
  vg_load_release(l);
}

static void answers_on_two_octants(void **state)
{
  struct vg_load l;

  (void)state;
  two_octants(&l); /* x: 300 cells in 0 .. 2, 100 in 2 .. 6 */
  assert_true(fabs(vg_load_quantile(&l, 0, 0.375) - 1) < 1e-3);
  assert_true(fabs(vg_load_quantile(&l, 0, 0.875) - 4) < 1e-3);
  assert_true(fabs(vg_load_quantile(&l, 0, 0) - 0) < 1e-12);
  assert_true(fabs(vg_load_quantile(&l, 0, 1) - 6) < 1e-12);
  assert_true(fabs(vg_load_quantile(&l, 1, 0.5) - 5) < 1e-3);
  assert_true(fabs(vg_load_zone(&l, 0, 4, 1) - 50) < 1e-9);
  assert_true(fabs(vg_load_zone(&l, 0, 2, 1) - (75 + 25)) < 1e-9);
  assert_true(fabs(vg_load_zone(&l, 1, 5, 2) - 400) < 1e-9);
  assert_true(vg_load_coarsest(&l, 0, 1) == 0.5);
  assert_true(vg_load_coarsest(&l, 0, 2) == 1);
  assert_true(vg_load_coarsest(&l, 0, 7) == 0);
  release_index(&l);
}

static void boxes_hold_shares_of_octants(void **state)
{
  const double all[2][3] = { { -1, 0, -4 }, { 9, 9, 4 } };
  const double both[2][3] = { { 1, 3, 0 }, { 4, 5, 2 } };
  const double low[2][3] = { { 0, 0, -4 }, { 1, 9, 4 } };
  struct vg_load l;

  (void)state;
  two_octants(&l);
  assert_true(fabs(vg_load_within(&l, all[0], all[1]) - 400) < 1e-9);
  assert_true(fabs(vg_load_within(&l, both[0], both[1]) -
                   (300 / 8.0 + 100 / 8.0)) < 1e-9);
  assert_true(fabs(vg_load_within(&l, low[0], low[1]) - 150) < 1e-9);
  assert_true(vg_load_within(&l, all[1], all[1]) == 0);
  release_index(&l);
}

/* The same queries, evaluated by a loop over all octants. */
static double cells_below(const struct vg_load *l, int axis, double x)
{
  double sum = 0;

  for (size_t i = 0; i < l->n; i++) {
    const double half = (double)l->octant[i].half;
    const double s = (x - (double)l->octant[i].at[axis]) / half;

    sum += (double)l->octant[i].cells * (s < -1  ? 0
                                         : s > 1 ? 1
                                                 : 0.5 * (1 + s));
  }
  return sum;
}

static double cells_near(const struct vg_load *l, int axis, double x,
                         double width)
{
  double sum = 0;

  for (size_t i = 0; i < l->n; i++) {
    const struct vg_load_octant *c = &l->octant[i];

    if (fabs((double)c->at[axis] - x) < (double)c->half)
      sum += (double)c->cells * width * (double)c->h / (double)c->half;
  }
  return sum;
}

/* Spacing varies by a factor of tens here. Bins are as wide as the octants of a
 * sample, about a tenth of the region around the sphere. */
static void bins_agree_with_octants(void **state)
{
  struct vg_load l;
  struct scene s;

  (void)state;
  make_demo(&s, "sphere", 400000);
  estimate(&s, 1, &l);
  for (int axis = 0; axis < 3; axis++)
    for (int i = 1; i < 32; i++) {
      const double x = vg_load_quantile(&l, axis, i / 32.);
      const double all = cells_near(&l, axis, x, 1);

      assert_true(fabs(cells_below(&l, axis, x) / l.cells - i / 32.) < 2e-3);
      assert_true(fabs(vg_load_zone(&l, axis, x, 1) / all - 1) < 0.15);
      for (size_t k = 0; k < l.n; k++)
        if (fabs((double)l.octant[k].at[axis] - x) <
            0.97 * (double)l.octant[k].half)
          assert_true((double)l.octant[k].h <= vg_load_coarsest(&l, axis, x));
    }
  vg_load_release(&l);
  release_scene(&s);
}

/* --- blocks -------------------------------------------------------------- */

static const int planes[3] = { 2, 1, 1 };
static const double across[3][2] = { { 0.93, 1.71 }, { 0.47 }, { 0.61 } };
static const double *const places[3] = { across[0], across[1], across[2] };

static void blocks_share_a_load(void **state)
{
  struct vg_load l, part[12];
  struct scene s;
  double cells = 0, expected;

  (void)state;
  make_bar(&s);
  estimate(&s, 1, &l);
  assert_int_equal(vg_load_split_blocks(&l, planes, places, 0, 1.5, NULL, part,
                                        NULL),
                   VG_OK);
  for (int b = 0; b < 12; b++) {
    const double wide[3] = { 0.93, 0.78, 1.29 };
    const double y = b / 3 % 2 ? 0.53 : 0.47, z = b / 6 ? 0.39 : 0.61;

    expected = 1.5 * l.cells * wide[b % 3] / 3 * y * z;
    cells += part[b].cells;
    /* uniform spacing; octants along the walls have the volume found by
     * samples */
    assert_true(fabs(part[b].cells / expected - 1) < 0.05);
    if (b % 3) /* nothing is beyond the plane */
      assert_true(vg_load_quantile(&part[b], 0, 0) >= across[0][b % 3 - 1]);
    vg_load_release(&part[b]);
  }
  assert_true(fabs(cells / (1.5 * l.cells) - 1) < 1e-3);
  vg_load_release(&l);
  release_scene(&s);
}

/* Cells near planes belong to separator zones: each plane takes 2 x 1.2 edges
 * of the bar, 0.05 wide, over its whole cross-section. */
static void zones_belong_to_no_block(void **state)
{
  const double left = (3 - 2 * 0.12) / 3 * (1 - 0.12) * (1 - 0.12);
  struct vg_load l, part[12];
  struct scene s;
  double cells = 0;

  (void)state;
  make_bar(&s);
  estimate(&s, 1, &l);
  assert_int_equal(vg_load_split_blocks(&l, planes, places, 1.2, 1, NULL, part,
                                        NULL),
                   VG_OK);
  for (int b = 0; b < 12; b++) {
    cells += part[b].cells;
    vg_load_release(&part[b]);
  }
  assert_true(fabs(cells / (left * l.cells) - 1) < 0.02);
  vg_load_release(&l);
  release_scene(&s);
}

static void quantiles_halve_a_mesh(void **state)
{
  struct vg_load l;
  struct scene s;

  (void)state;
  make_bar(&s);
  estimate(&s, 1, &l);
  for (int i = 1; i < 10;
       i++) /* uniform spacing: to a fraction of an edge, 0.05 */
    assert_true(fabs(vg_load_quantile(&l, 0, i / 10.) - 0.3 * i) < 0.05);
  assert_true(fabs(vg_load_quantile(&l, 1, 0.5) - 0.5) < 0.02);
  vg_load_release(&l);
  release_scene(&s);
}

/* Every octant is found at its middle and near its corners (they are kept in
 * single precision); no octant is found outside of all. */
static void places_find_their_octants(void **state)
{
  struct vg_load_finder *f;
  struct vg_load l;
  struct scene s;
  double x[3], outside = 0;

  (void)state;
  make_demo(&s, "sphere", 200000);
  estimate(&s, 1, &l);
  assert_int_equal(vg_load_finder_new(&l, &f, NULL), VG_OK);
  for (size_t i = 0; i < l.n; i++)
    for (int corner = 0; corner < 9; corner++) {
      const struct vg_load_octant *c = &l.octant[i];
      const double off = corner < 8 ? 0.98 * (double)c->half : 0;

      for (int k = 0; k < 3; k++)
        x[k] = (double)c->at[k] + (corner >> k & 1 ? off : -off);
      assert_int_equal(vg_load_find(f, x), i);
    }
  for (int k = 0; k < 3; k++) x[k] = 0; /* in the body */
  assert_true(vg_load_find(f, x) == SIZE_MAX);
  for (size_t i = 0; i < l.n; i++)
    outside = fmax(outside, fabs((double)l.octant[i].at[0]));
  x[0] = 3 * outside;
  assert_true(vg_load_find(f, x) == SIZE_MAX);
  x[0] = NAN;
  assert_true(vg_load_find(f, x) == SIZE_MAX);
  vg_load_finder_free(f);
  vg_load_finder_free(NULL);
  vg_load_release(&l);
  release_scene(&s);
}

static void messages_are_received(void **state)
{
  struct vg_bytes bytes = { 0, NULL }, shorter;
  struct vg_load l, back = VG_LOAD_INIT;

  (void)state;
  two_octants(&l);
  assert_int_equal(vg_load_pack(&l, &bytes, NULL), VG_OK);
  assert_int_equal(vg_load_unpack(&bytes, &back, NULL), VG_OK);
  assert_int_equal(back.n, 2);
  assert_memory_equal(back.octant, l.octant, 2 * sizeof *l.octant);
  assert_true(back.cells == 400 && back.unit == 1);
  vg_load_release(&back);
  for (size_t n = 0; n < bytes.n; n++) {
    shorter = (struct vg_bytes){ n, bytes.data };
    assert_int_equal(vg_load_unpack(&shorter, &back, NULL), VG_ERR_FORMAT);
  }
  for (size_t i = 0; i < 16; i++) { /* name and count */
    bytes.data[i] ^= 0x40;
    assert_int_equal(vg_load_unpack(&bytes, &back, NULL), VG_ERR_FORMAT);
    bytes.data[i] ^= 0x40;
  }
  memset(bytes.data + bytes.n - 28, 0xff, 28); /* an octant of NaN */
  assert_int_equal(vg_load_unpack(&bytes, &back, NULL), VG_ERR_FORMAT);
  assert_null(back.octant);
  free(bytes.data);
  release_index(&l);
}

/* --- real surfaces ------------------------------------------------------- */

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(demos_keep_their_volume),
    cmocka_unit_test(a_stray_body_is_omitted),
    cmocka_unit_test(the_result_is_independent_of_threads),
    cmocka_unit_test(estimate_agrees_with_the_mesh),
    cmocka_unit_test(small_sources_count),
    cmocka_unit_test(faces_alone_require_cells),
    cmocka_unit_test(children_get_their_share),
    cmocka_unit_test(repeated_splits_do_not_drift),
    cmocka_unit_test(tiny_and_empty_children),
    cmocka_unit_test(a_small_void_has_octants),
    cmocka_unit_test(answers_on_two_octants),
    cmocka_unit_test(boxes_hold_shares_of_octants),
    cmocka_unit_test(bins_agree_with_octants),
    cmocka_unit_test(blocks_share_a_load),
    cmocka_unit_test(zones_belong_to_no_block),
    cmocka_unit_test(quantiles_halve_a_mesh),
    cmocka_unit_test(places_find_their_octants),
    cmocka_unit_test(messages_are_received),
    cmocka_unit_test(sizes_in_another_unit_are_named),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
