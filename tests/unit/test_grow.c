/* Filling a void, whole or after zones were grown in it. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "zone_scene.h"

/* --- filling ------------------------------------------------------------- */

static void same_void(const struct vg_void *a, const struct vg_void *b)
{
  assert_int_equal(a->n_point, b->n_point);
  assert_int_equal(a->n_face, b->n_face);
  assert_int_equal(a->n_cell, b->n_cell);
  assert_memory_equal(a->x, b->x, a->n_point * sizeof *a->x);
  if (a->n_face)
    assert_memory_equal(a->face, b->face, a->n_face * sizeof *a->face);
  if (a->n_cell)
    assert_memory_equal(a->cell, b->cell, a->n_cell * sizeof *a->cell);
}

static void a_box_is_filled(void **state)
{
  struct vg_grow_options options = VG_GROW_OPTIONS_INIT;
  struct scene s;
  size_t made;

  (void)state;
  box_scene(&s, 4);
  is_filled(&s);
  made = s.v.n_cell;
  assert_true(made > 200);
  assert_int_equal(vg_grow(&s.v, s.sizing, &options, &s.report, NULL), VG_OK);
  assert_int_equal(s.v.n_cell, made);     /* nothing to do: no harm */
  scene_end(&s);
}

static void quads_and_bad_indices_are_no_void(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_void v = VG_VOID_INIT;
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  shape_box(&m, 2, 0.5);
  m.n_quad = 1;
  assert_int_equal(vg_void_from_mesh(&v, &m, &err), VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "quad"));
  m.n_quad = 0;
  m.tri[4][1] = (uint32_t)m.n_point;
  assert_int_equal(vg_void_from_mesh(&v, &m, &err), VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "triangle 5"));
  assert_null(v.x);
  vg_mesh_release(&m);
}

/* --- regions ------------------------------------------------------------ */

static int crosses(const struct vg_void *v, size_t c,
                   const struct vg_region *r)
{
  for (int i = 0; i < r->n_plane; i++) {
    int above = 0, below = 0;

    for (int k = 0; k < 4; k++) {
      double side = vg_plane_side(&r->plane[i], v->x[v->cell[c][k]]);

      above |= side >= 0;
      below |= side <= 0;
    }
    if (!above || !below) return 0;
  }
  return 1;
}

/* Cells from `first` on all cross the planes of the region, or fill a dent
 * between cells that do: their corners are corners of such cells. */
static void all_cross(const struct vg_void *v, size_t first,
                      const struct vg_region *r)
{
  uint8_t *used = vg_calloc(v->n_point, 1);
  size_t n = 0;

  assert_non_null(used);
  for (size_t c = first; c < v->n_cell; c++) {
    if (!crosses(v, c, r)) continue;
    n++;
    for (int k = 0; k < 4; k++) used[v->cell[c][k]] = 1;
  }
  assert_true(2 * n > v->n_cell - first);
  for (size_t c = first; c < v->n_cell; c++)
    for (int k = 0; k < 4; k++) assert_true(used[v->cell[c][k]]);
  free(used);
}

/* Faces of the front which cross the plane; those on either side. */
static void front_sides(const struct vg_void *v, const struct vg_plane *s,
                        size_t count[3])
{
  memset(count, 0, 3 * sizeof *count);
  for (size_t i = 0; i < v->n_face; i++) {
    int above = 0, below = 0;

    for (int k = 0; k < 3; k++) {
      double side = vg_plane_side(s, v->x[v->face[i][k]]);

      above |= side > 0;
      below |= side < 0;
    }
    count[above && below ? 0 : below ? 1 : 2]++;
  }
}

static const struct vg_region plane_zone = {
  .n_plane = 1, .plane = {{{0, 0, 1}, 0.03}} };
static const struct vg_region line_pencil = {
  .n_plane = 2, .plane = {{{0, 0, 1}, 0.03}, {{1, 0, 0}, 0.07}} };

static void pencil_zone_rest(void **state)
{
  struct scene s;
  size_t pencil, side[3];

  (void)state;
  box_scene(&s, 7);
  pencil = cut(&s, &line_pencil);
  assert_in_range(pencil, 14, 400);
  all_cross(&s.v, 0, &line_pencil);
  assert_true(cut(&s, &plane_zone) > pencil);
  all_cross(&s.v, pencil, &plane_zone);
  front_sides(&s.v, &plane_zone.plane[0], side);
  assert_true(side[1] > 300 && side[2] > 300);
  is_filled(&s);
  scene_end(&s);
}

static int around_the_plate(const int at[3])
{
  return at[0] < 2 || at[0] >= 6 || at[1] < 2 || at[1] >= 6 || at[2] != 2;
}

/* Oblique planes and lines through a plate, one after the other: fronts of
 * any shape. */
static void many_cuts_through_a_plate(void **state)
{
  static const struct vg_region cuts[4] = {
    { .n_plane = 1, .plane = {{{0.6, 0, 0.8}, 4.1}} },
    { .n_plane = 2,
      .plane = {{{0, 0.8, 0.6}, 4.3}, {{0.8, -0.36, 0.48}, 2.2}} },
    { .n_plane = 1, .plane = {{{0, 0, 1}, 2.2}} },
    { .n_plane = 1, .plane = {{{-0.28, 0.96, 0}, 2.7}} }};
  const int n[3] = {8, 8, 5};
  const double lo[3] = {0, 0, 0}, hi[3] = {8, 8, 5};
  struct scene s;

  (void)state;
  memset(&s.m, 0, sizeof s.m);
  shape_block(&s.m, n, lo, hi, around_the_plate);
  scene_void(&s, 1.3, 0);
  for (int k = 0; k < 4; k++) {
    size_t first = s.v.n_cell;

    assert_true(cut(&s, &cuts[k]) > 0);
    all_cross(&s.v, first, &cuts[k]);
  }
  is_filled(&s);
  scene_end(&s);
}

/* --- refusal ------------------------------------------------------------- */

struct stop { int at, calls; };

static int stop_later(void *user, const char *stage, size_t done,
                      size_t expected)
{
  struct stop *s = user;

  (void)done;
  (void)expected;
  assert_non_null(stage);
  return ++s->calls >= s->at;
}

static void it_can_be_stopped_at_every_call(void **state)
{
  struct vg_grow_options options = VG_GROW_OPTIONS_INIT;
  struct scene s, kept;
  struct stop stop = {1, 0};
  vg_status st = VG_BLOCKED;

  (void)state;
  box_scene(&s, 4);
  box_scene(&kept, 4);
  cut(&s, &plane_zone);
  cut(&kept, &plane_zone);
  options.progress = stop_later;
  options.user = &stop;
  for (; stop.at < 100; stop.at++, stop.calls = 0) {
    st = vg_grow(&s.v, s.sizing, &options, &s.report, NULL);
    if (st == VG_OK) break;
    assert_int_equal(st, VG_BLOCKED);
    assert_int_equal(stop.calls, stop.at);
    same_void(&s.v, &kept.v);
  }
  assert_int_equal(st, VG_OK);
  assert_true(stop.at > 3);
  is_filled(&s);
  scene_end(&s);
  scene_end(&kept);
}

static void failures_leave_the_void_alone(void **state)
{
  struct vg_grow_options options = VG_GROW_OPTIONS_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct scene s, kept;

  (void)state;
  box_scene(&s, 4);
  box_scene(&kept, 4);
  cut(&s, &plane_zone);
  cut(&kept, &plane_zone);
  options.point_limit = 3;
  assert_int_equal(vg_grow(&s.v, s.sizing, &options, &s.report, &err),
                   VG_ERR_UNSUPPORTED);
  assert_true(strlen(err.text) > 10);
  same_void(&s.v, &kept.v);
  options.point_limit = 0;
  s.v.n_face--;              /* open */
  kept.v.n_face--;
  assert_int_equal(vg_grow(&s.v, s.sizing, &options, &s.report, &err),
                   VG_ERR_GEOMETRY);
  assert_true(strlen(err.text) > 10);
  same_void(&s.v, &kept.v);
  scene_end(&s);
  scene_end(&kept);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(a_box_is_filled),
    cmocka_unit_test(quads_and_bad_indices_are_no_void),
    cmocka_unit_test(pencil_zone_rest),
    cmocka_unit_test(many_cuts_through_a_plate),
    cmocka_unit_test(it_can_be_stopped_at_every_call),
    cmocka_unit_test(failures_leave_the_void_alone),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
