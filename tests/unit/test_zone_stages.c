/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Pencils, tiles and blocks of a lattice of planes: all regions of a stage are
 * grown from the same front, kept apart by walls. */
#include "partition/cut/lattice.h"
#include "zone_scene.h"

struct stage {
  size_t n;
  struct zone_part *part;
  struct vg_filled *made;
  struct vg_region *region;
};

/* All regions of a stage, each from the front at the start of the stage. */
static void grow_stage(struct scene *s, const struct vg_lattice *l, int stage,
                       struct stage *out)
{
  const struct vg_fill_options options = VG_FILL_OPTIONS_INIT;
  struct vg_error err = VG_ERROR_INIT;

  out->n = vg_lattice_count(l, stage);
  out->part = vg_calloc(out->n, sizeof *out->part);
  out->made = vg_calloc(out->n, sizeof *out->made);
  out->region = vg_calloc(out->n, sizeof *out->region);
  assert_true(out->part && out->made && out->region);
  for (size_t k = 0; k < out->n; k++) {
    vg_lattice_region(l, stage, k, &out->region[k]);
    zone_select(s, &out->region[k], &out->part[k]);
    if (zone_make(s, &out->part[k], &out->region[k], &options, &out->made[k],
                  &err) != VG_OK)
      fail_msg("stage %d, region %zu: %s", stage, k, err.text);
  }
}

/* Add them to the scene. No two have consumed the same face, and all cells are
 * within their region's walls. Returns the number of cells. */
static size_t join_stage(struct scene *s, struct stage *g)
{
  size_t n_front = s->front.n_face, first = s->n_cell;
  uint8_t *is_gone = vg_calloc(n_front, 1);

  assert_non_null(is_gone);
  for (size_t k = 0; k < g->n; k++) {
    const struct vg_filled *made = &g->made[k];
    size_t c = s->n_cell;

    for (size_t i = 0; i < made->n_consumed; i++)
      assert_false(is_gone[g->part[k].from[made->consumed[i]]]);
    zone_add(s, &g->part[k], made, is_gone);
    for (; c < s->n_cell; c++)
      for (int i = 0; i < 4; i++)
        assert_true(vg_region_within(&g->region[k], s->front.x[s->cell[c][i]]));
    vg_filled_release(&g->made[k]);
    zone_part_release(&g->part[k]);
  }
  zone_compact(&s->front, is_gone, n_front);
  free(is_gone);
  free(g->part);
  free(g->made);
  free(g->region);
  is_valid(s);
  return s->n_cell - first;
}

/* Cut by a lattice, all regions of a stage from the same front. */
static void cut_by(struct scene *s, const struct vg_lattice *l,
                   size_t made[VG_LATTICE_STAGES])
{
  for (int stage = 0; stage < VG_LATTICE_STAGES; stage++) {
    struct stage g;

    grow_stage(s, l, stage, &g);
    made[stage] = join_stage(s, &g);
  }
}

static void two_planes_at_once(void **state)
{
  const struct vg_lattice l = { .n = { 0, 0, 2 },
                                .at = { { 0 }, { 0 }, { 2.7, 9.2 } } };
  const int count[3] = { 6, 6, 12 };
  const double lo[3] = { 0, 0, 0 }, hi[3] = { 6, 6, 12 };
  size_t made[VG_LATTICE_STAGES];
  struct scene s;

  (void)state;
  memset(&s, 0, sizeof s);
  shape_block(&s.m, count, lo, hi, shape_all);
  scene_begin(&s, 1.2, 1);
  cut_by(&s, &l, made);
  assert_int_equal(made[0] + made[1], 0);
  parts_are(&s, 3);
  is_filled(&s);
  scene_end(&s);
}

/* A line along z first, then four tiles at the same time. */
static void a_pencil_and_four_tiles(void **state)
{
  const struct vg_lattice l = { .n = { 1, 1, 0 },
                                .at = { { 0.03 }, { -0.04 }, { 0 } } };
  size_t made[VG_LATTICE_STAGES];
  struct scene s;

  (void)state;
  box_scene(&s, 14);
  cut_by(&s, &l, made);
  assert_true(made[0] > 14 * 10 && made[0] < made[VG_LATTICE_TILES]);
  assert_int_equal(made[1], 0);
  parts_are(&s, 4);
  assert_true(smallest_angle(&s, 0) > 5);
  print_message("pencil %zu, tiles %zu, smallest angle %.1f\n", made[0],
                made[VG_LATTICE_TILES], smallest_angle(&s, 0));
  is_filled(&s);
  scene_end(&s);
}

/* One line along z, four segments, twelve tiles, eight blocks. */
static void a_lattice_in_a_box(void **state)
{
  const struct vg_lattice l = { .n = { 1, 1, 1 },
                                .at = { { 0.02 }, { 0.01 }, { -0.03 } } };
  size_t made[VG_LATTICE_STAGES];
  struct scene s;

  (void)state;
  box_scene(&s, 14);
  cut_by(&s, &l, made);
  assert_true(made[0] > 100 && made[1] > 200 &&
              made[VG_LATTICE_TILES] > made[1]);
  parts_are(&s, 8);
  print_message("lines %zu and %zu, tiles %zu, smallest angle %.1f\n", made[0],
                made[1], made[VG_LATTICE_TILES], smallest_angle(&s, 0));
  assert_true(smallest_angle(&s, 0) > 5);
  is_filled(&s);
  scene_end(&s);
}

/* The same through a sphere and around it: lines start and end on the body. */
static void a_lattice_around_a_sphere(void **state)
{
  const struct vg_lattice l = { .n = { 1, 1, 1 },
                                .at = { { 0.2 }, { -0.1 }, { 0.07 } } };
  size_t made[VG_LATTICE_STAGES];
  struct scene s;

  (void)state;
  sphere_scene(&s);
  cut_by(&s, &l, made);
  assert_true(made[0] > 0 && made[1] > 0 && made[VG_LATTICE_TILES] > 0);
  parts_are(&s, 8);
  print_message("lines %zu and %zu, tiles %zu, smallest angle %.1f\n", made[0],
                made[1], made[VG_LATTICE_TILES], smallest_angle(&s, 0));
  assert_true(smallest_angle(&s, 0) > 5);
  is_filled(&s);
  scene_end(&s);
}

/* Planes that meet in the body: six segments at the same time. */
static void segments_of_all_lines_at_once(void **state)
{
  const struct vg_lattice l = { .n = { 1, 1, 1 },
                                .lines_at_once = 1,
                                .at = { { 0.2 }, { -0.1 }, { 0.07 } } };
  size_t made[VG_LATTICE_STAGES];
  struct scene s;

  (void)state;
  sphere_scene(&s);
  assert_int_equal(vg_lattice_count(&l, 0), 6);
  cut_by(&s, &l, made);
  assert_true(made[0] > 0 && made[VG_LATTICE_TILES] > 0);
  assert_int_equal(made[1], 0);
  parts_are(&s, 8);
  assert_true(smallest_angle(&s, 0) > 5);
  is_filled(&s);
  scene_end(&s);
}

/* A plane in three pieces, two ribs first: the result is that of a whole
 * plane. */
static void a_plane_in_pieces(void **state)
{
  const struct vg_lattice l = { .n = { 0, 0, 1 },
                                .at = { { 0 }, { 0 }, { 0.03 } },
                                .n_rib = 2,
                                .rib = (struct vg_rib[]){
                                  { 0, { { 1, 0, 0 }, -0.18 } },
                                  { 0, { { 1, 0, 0 }, 0.17 } } } };
  size_t made[VG_LATTICE_STAGES];
  struct scene s;

  (void)state;
  box_scene(&s, 16);
  cut_by(&s, &l, made);
  assert_int_equal(made[0] + made[1], 0);
  assert_true(made[2] > 16 * 2 * 4 && made[2] < made[VG_LATTICE_TILES] / 4);
  parts_are(&s, 2);
  assert_true(smallest_angle(&s, 0) > 5);
  is_filled(&s);
  scene_end(&s);
}

/* Between lines that start at a body a rib continues obliquely from the
 * body. */
static void ribs_from_a_body(void **state)
{
  const double u = 0.7071067811865476;
  struct vg_rib rib[12] = { { 0 } };
  struct vg_lattice l = {
    .n = { 1, 1, 1 }, .lines_at_once = 1, .n_rib = 12, .rib = rib
  };
  size_t made[VG_LATTICE_STAGES];
  struct scene s;

  (void)state;
  assert_int_equal(vg_lattice_count(&l, VG_LATTICE_TILES), 24);
  for (int t = 0; t < 12; t++) {
    int axis = t / 4, b = (axis + 1) % 3, c = (axis + 2) % 3;

    l.rib[t].tile = t;
    l.rib[t].plane.normal[b] = -u;
    l.rib[t].plane.normal[c] = t % 4 == 0 || t % 4 == 3 ? u : -u;
  }
  sphere_scene(&s);
  cut_by(&s, &l, made);
  assert_true(made[0] > 0 && made[2] > 0 && made[VG_LATTICE_TILES] > made[2]);
  parts_are(&s, 8);
  assert_true(smallest_angle(&s, 0) > 5);
  is_filled(&s);
  scene_end(&s);
}

/* Where three lines meet, cells of tiles may need a corner beyond the walls. A
 * few cells are left out, and blocks stay connected there. Whole planes without
 * walls, one after the other, close the remaining places. */
static void planes_close_the_remaining_places(void **state)
{
  (void)state;
  for (int q = 0; q < 5; q++) {
    struct vg_lattice l = { .n = { 1, 1, 1 } };
    size_t made[VG_LATTICE_STAGES], n_tile, more = 0;
    struct scene s;

    if (q % 2) sphere_scene(&s);
    else box_scene(&s, 12 + 2 * q);
    for (int k = 0; k < 3; k++)
      l.at[k][0] = ((q * 37 + k * 53 + 11) % 97 / 97.0 - 0.5) *
                   (q % 2 ? 3 : 0.3);
    cut_by(&s, &l, made);
    n_tile = made[VG_LATTICE_TILES];
    for (int axis = 0; axis < 3; axis++) {
      struct vg_region r = plane_at(axis, l.at[axis][0]);

      more += cut(&s, &r);
    }
    assert_true(more < n_tile / 20);
    parts_are(&s, 8);
    is_filled(&s);
    scene_end(&s);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(two_planes_at_once),
    cmocka_unit_test(a_pencil_and_four_tiles),
    cmocka_unit_test(a_lattice_in_a_box),
    cmocka_unit_test(a_lattice_around_a_sphere),
    cmocka_unit_test(segments_of_all_lines_at_once),
    cmocka_unit_test(a_plane_in_pieces),
    cmocka_unit_test(ribs_from_a_body),
    cmocka_unit_test(planes_close_the_remaining_places),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
