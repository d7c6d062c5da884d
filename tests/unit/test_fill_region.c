/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Regions that are cut out of a front one after the other, and the remaining
 * void that is filled: at any moment the cells and the void together are the
 * domain. If the kernel refuses its input or is stopped, it returns nothing. */
#include "zone_scene.h"

/* --- regions ------------------------------------------------------------- */

static double side_of(const struct vg_plane *p, const double x[3])
{
  return p->normal[0] * x[0] + p->normal[1] * x[1] + p->normal[2] * x[2] -
         p->offset;
}

static int crosses(const struct scene *s, size_t c, const struct vg_region *r)
{
  for (int i = 0; i < r->n_plane; i++) {
    int above = 0, below = 0;

    for (int k = 0; k < 4; k++) {
      double side = side_of(&r->plane[i], s->front.x[s->cell[c][k]]);

      above |= side >= 0;
      below |= side <= 0;
    }
    if (!above || !below) return 0;
  }
  return 1;
}

/* All cells from `first` on cross the planes of the region, or fill a dent
 * between cells that do: their corners are corners of such cells. */
static void all_cross(const struct scene *s, size_t first,
                      const struct vg_region *r)
{
  uint8_t *used = vg_calloc(s->front.n_point, 1);
  size_t n = 0;

  assert_non_null(used);
  for (size_t c = first; c < s->n_cell; c++) {
    if (!crosses(s, c, r)) continue;
    n++;
    for (int k = 0; k < 4; k++) used[s->cell[c][k]] = 1;
  }
  assert_true(2 * n > s->n_cell - first);
  for (size_t c = first; c < s->n_cell; c++)
    for (int k = 0; k < 4; k++) assert_true(used[s->cell[c][k]]);
  free(used);
}

/* Faces of the front that cross the plane, and those on either side. */
static void front_sides(const struct vg_front *f, const struct vg_plane *s,
                        size_t count[3])
{
  memset(count, 0, 3 * sizeof *count);
  for (size_t i = 0; i < f->n_face; i++) {
    int above = 0, below = 0;

    for (int k = 0; k < 3; k++) {
      double side = side_of(s, f->x[f->face[i][k]]);

      above |= side > 0;
      below |= side < 0;
    }
    count[above && below ? 0 : below ? 1 : 2]++;
  }
}

/* Components of the front that share no point. */
static size_t front_components(const struct vg_front *f)
{
  uint32_t *parent = vg_alloc(f->n_point, sizeof *parent);
  uint8_t *used = vg_calloc(f->n_point, 1);
  size_t n = 0;

  assert_true(parent && used);
  for (uint32_t p = 0; p < f->n_point; p++) parent[p] = p;
  for (size_t i = 0; i < f->n_face; i++)
    for (int k = 0; k < 3; k++) {
      vg_union(parent, f->face[i][k], f->face[i][(k + 1) % 3]);
      used[f->face[i][k]] = 1;
    }
  for (uint32_t p = 0; p < f->n_point; p++)
    n += used[p] && vg_root_of(parent, p) == p;
  free(parent);
  free(used);
  return n;
}

static const struct vg_region plane_zone = {
  .n_plane = 1, .plane = { { { 0, 0, 1 }, 0.03 } }
};
static const struct vg_region line_pencil = {
  .n_plane = 2, .plane = { { { 0, 0, 1 }, 0.03 }, { { 1, 0, 0 }, 0.07 } }
};

static void a_zone_divides_the_void(void **state)
{
  struct scene s;
  size_t side[3], made;

  (void)state;
  box_scene(&s, 8);
  assert_true(fabs(s.volume - 1) < 1e-12);
  made = cut(&s, &plane_zone);
  assert_true(made > 100);
  all_cross(&s, 0, &plane_zone);
  front_sides(&s.front, &plane_zone.plane[0], side);
  assert_int_equal(side[0], 0);
  assert_true(side[1] > 350 && side[2] > 350);
  assert_int_equal(front_components(&s.front), 2);
  is_filled(&s);
  scene_end(&s);
}

static void an_oblique_zone_around_a_body(void **state)
{
  const struct vg_region zone = { .n_plane = 1,
                                  .plane = { { { 0.6, 0, 0.8 }, 0.2 } } };
  struct scene s;
  size_t side[3];

  (void)state;
  sphere_scene(&s);
  assert_true(cut(&s, &zone) > 50);
  all_cross(&s, 0, &zone);
  front_sides(&s.front, &zone.plane[0], side);
  assert_int_equal(side[0], 0);
  assert_true(side[1] > 50 && side[2] > 50);
  is_filled(&s);
  scene_end(&s);
}

static void edge_separator_then_zone_then_remainder(void **state)
{
  struct scene s;
  size_t pencil, side[3];

  (void)state;
  box_scene(&s, 7);
  pencil = cut(&s, &line_pencil);
  assert_in_range(pencil, 14, 400);
  all_cross(&s, 0, &line_pencil);
  assert_true(cut(&s, &plane_zone) > pencil);
  all_cross(&s, pencil, &plane_zone);
  front_sides(&s.front, &plane_zone.plane[0], side);
  assert_true(side[1] > 300 && side[2] > 300);
  is_filled(&s);
  scene_end(&s);
}

static int around_the_plate(const int at[3])
{
  return at[0] < 2 || at[0] >= 6 || at[1] < 2 || at[1] >= 6 || at[2] != 2;
}

/* Oblique planes and lines through a plate, one after the other: fronts of any
 * shape. */
static void many_cuts_through_a_plate(void **state)
{
  static const struct vg_region cuts[4] = {
    { .n_plane = 1, .plane = { { { 0.6, 0, 0.8 }, 4.1 } } },
    { .n_plane = 2,
      .plane = { { { 0, 0.8, 0.6 }, 4.3 }, { { 0.8, -0.36, 0.48 }, 2.2 } } },
    { .n_plane = 1, .plane = { { { 0, 0, 1 }, 2.2 } } },
    { .n_plane = 1, .plane = { { { -0.28, 0.96, 0 }, 2.7 } } }
  };
  const int n[3] = { 8, 8, 5 };
  const double lo[3] = { 0, 0, 0 }, hi[3] = { 8, 8, 5 };
  struct scene s;

  (void)state;
  memset(&s, 0, sizeof s);
  shape_block(&s.m, n, lo, hi, around_the_plate);
  scene_begin(&s, 1.3, 0);
  assert_true(fabs(s.volume - (8 * 8 * 5 - 16)) < 1e-9);
  for (int k = 0; k < 4; k++) {
    size_t first = s.n_cell;

    assert_true(cut(&s, &cuts[k]) > 0);
    all_cross(&s, first, &cuts[k]);
  }
  is_filled(&s);
  scene_end(&s);
}

/* No face of the front is near a region outside the domain: nothing changes. */
static void a_region_elsewhere(void **state)
{
  const struct vg_region away = { .n_plane = 1,
                                  .plane = { { { 0, 0, 1 }, 3 } } };
  const struct vg_fill_options options = VG_FILL_OPTIONS_INIT;
  struct scene s;

  (void)state;
  box_scene(&s, 3);
  assert_int_equal(zone_take(&s, &away, &options, NULL), VG_BLOCKED);
  assert_int_equal(s.front.n_face, s.m.n_tri);
  assert_int_equal(s.n_cell, 0);
  is_filled(&s);
  scene_end(&s);
}

/* If everything is filled there is nothing to do, and this is no error. */
static void nothing_is_left_to_fill(void **state)
{
  size_t n_cell, n_point;
  struct scene s;

  (void)state;
  box_scene(&s, 4);
  is_filled(&s);
  n_cell = s.n_cell;
  n_point = s.front.n_point;
  is_filled(&s);
  assert_int_equal(s.n_cell, n_cell);
  assert_int_equal(s.front.n_point, n_point);
  scene_end(&s);
}

/* --- refusal ------------------------------------------------------------- */

static void is_empty(const struct vg_filled *f)
{
  const struct vg_filled empty = VG_FILLED_INIT;

  assert_memory_equal(f, &empty, sizeof empty);
}

struct stop {
  int at, calls;
};

static int stop_later(void *user)
{
  struct stop *s = user;

  return ++s->calls >= s->at;
}

/* Fill the remaining void after a separator zone has divided it. */
static void the_rest(struct scene *s, struct zone_part *p)
{
  box_scene(s, 4);
  cut(s, &plane_zone);
  zone_select(s, NULL, p);
  assert_int_equal(p->front.n_face, s->front.n_face);
}

static void it_can_be_stopped_at_every_call(void **state)
{
  struct vg_fill_options options = VG_FILL_OPTIONS_INIT;
  struct vg_filled made = VG_FILLED_INIT;
  struct stop stop = { 1, 0 };
  struct zone_part p;
  struct scene s;
  vg_status st = VG_ERR_STOPPED;

  (void)state;
  the_rest(&s, &p);
  options.stop = (struct vg_stop){ stop_later, &stop };
  for (; stop.at < 100; stop.at++, stop.calls = 0) {
    struct vg_error err = VG_ERROR_INIT;

    st = zone_make(&s, &p, NULL, &options, &made, &err);
    if (st == VG_OK) break;
    assert_int_equal(st, VG_ERR_STOPPED);
    assert_int_equal(err.code, VG_ERR_STOPPED);
    assert_int_equal(stop.calls, stop.at);
    is_empty(&made);
  }
  assert_int_equal(st, VG_OK);
  assert_true(stop.at > 3);
  assert_int_equal(vg_filled_defects(&p.front, &made, 0), 0);
  vg_filled_release(&made);
  is_empty(&made);
  zone_part_release(&p);
  is_filled(&s);
  scene_end(&s);
}

/* The expected status, a message, and no result. */
static void refused(struct scene *s, const struct zone_part *p,
                    const struct vg_fill_options *options, vg_status want)
{
  struct vg_filled made = VG_FILLED_INIT;
  struct vg_error err = VG_ERROR_INIT;

  assert_int_equal(zone_make(s, p, NULL, options, &made, &err), want);
  assert_true(strlen(err.text) > 10);
  is_empty(&made);
}

static void failures_return_nothing(void **state)
{
  struct vg_fill_options options = VG_FILL_OPTIONS_INIT, few = options;
  struct zone_part p;
  struct scene s;
  uint32_t keep;

  (void)state;
  the_rest(&s, &p);
  few.point_limit = 3;
  refused(&s, &p, &few, VG_ERR_UNSUPPORTED);
  p.front.n_face--; /* open */
  refused(&s, &p, &options, VG_ERR_GEOMETRY);
  p.front.n_face++;
  keep = p.front.face[4][1];
  p.front.face[4][1] = (uint32_t)p.front.n_point; /* no such point */
  refused(&s, &p, &options, VG_ERR_INPUT);
  p.front.face[4][1] = keep;
  p.front.x = realloc(p.front.x, (p.front.n_point + 1) * sizeof *p.front.x);
  assert_non_null(p.front.x);
  memset(p.front.x[p.front.n_point++], 0, sizeof *p.front.x);
  refused(&s, &p, &options, VG_ERR_INPUT); /* a point without faces */
  zone_part_release(&p);
  is_filled(&s);
  scene_end(&s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(a_zone_divides_the_void),
    cmocka_unit_test(an_oblique_zone_around_a_body),
    cmocka_unit_test(edge_separator_then_zone_then_remainder),
    cmocka_unit_test(many_cuts_through_a_plate),
    cmocka_unit_test(a_region_elsewhere),
    cmocka_unit_test(nothing_is_left_to_fill),
    cmocka_unit_test(it_can_be_stopped_at_every_call),
    cmocka_unit_test(failures_return_nothing),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
