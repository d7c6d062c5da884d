/* Growing a void in steps: stopped anywhere, stored, continued, along planes;
 * at any moment cells and void together fill the domain. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "core/fill/grow.h"
#include "fill_shapes.h"
#include "zone_support.h"

struct scene {
  struct vg_mesh m;
  struct vg_sizing *sizing;
  struct vg_void v;
  struct vg_fill_report report;
};

static void scene_void(struct scene *s, double growth, double h_max)
{
  struct vg_void empty = VG_VOID_INIT;

  s->v = empty;
  memset(&s->report, 0, sizeof s->report);
  s->sizing = shape_sizing(&s->m, growth, h_max);
  assert_int_equal(vg_void_from_mesh(&s->v, &s->m, NULL), VG_OK);
  assert_int_equal(vg_void_defects(&s->v), 0);
}

static void box_scene(struct scene *s, int n)
{
  memset(&s->m, 0, sizeof s->m);
  shape_box(&s->m, n, 0.5);
  scene_void(s, 1.2, 1.0 / n);
}

static void sphere_scene(struct scene *s)
{
  const double centre[3] = {0.1, 0, 0};

  memset(&s->m, 0, sizeof s->m);
  shape_box(&s->m, 4, 3);
  shape_sphere(&s->m, 6, centre, 1, 7);
  scene_void(s, 1.3, 0);
}

static void scene_end(struct scene *s)
{
  vg_void_release(&s->v);
  vg_sizing_free(s->sizing);
  vg_mesh_release(&s->m);
}

/* One call; the void must be valid after it. Returns the cells it made. */
static size_t grow(struct scene *s, size_t max_cells)
{
  struct vg_grow_options options = VG_GROW_OPTIONS_INIT;
  struct vg_error err = VG_ERROR_INIT;
  size_t before = s->v.n_cell;

  options.max_cells = max_cells;
  if (vg_grow(&s->v, s->sizing, &options, &s->report, &err) != VG_OK)
    fail_msg("%s", err.text);
  assert_int_equal(vg_void_defects(&s->v), 0);
  return s->v.n_cell - before;
}

/* Likewise along a region's planes. */
static size_t cut(struct scene *s, const struct vg_region *region)
{
  struct vg_grow_options options = VG_GROW_OPTIONS_INIT;
  struct vg_error err = VG_ERROR_INIT;
  size_t before = s->v.n_cell;

  if (zone_take(&s->v, s->sizing, region, &options, &s->report,
                &err) != VG_OK)
    fail_msg("%s", err.text);
  assert_int_equal(vg_void_defects(&s->v), 0);
  return s->v.n_cell - before;
}

/* What the front encloses. */
static double volume_of_front(const struct vg_void *v)
{
  double sum = 0;

  for (size_t i = 0; i < v->n_face; i++) {
    const double *a = v->x[v->face[i][0]], *b = v->x[v->face[i][1]];
    const double *c = v->x[v->face[i][2]];

    sum -= (a[0] * (b[1] * c[2] - b[2] * c[1]) +
            a[1] * (b[2] * c[0] - b[0] * c[2]) +
            a[2] * (b[0] * c[1] - b[1] * c[0])) / 6;
  }
  return sum;
}

static double volume_of_cells(const struct vg_void *v)
{
  double sum = 0;

  for (size_t c = 0; c < v->n_cell; c++) {
    const double *a = v->x[v->cell[c][0]];
    double e[3][3];

    for (int i = 0; i < 3; i++)
      for (int k = 0; k < 3; k++) e[i][k] = v->x[v->cell[c][i + 1]][k] - a[k];
    sum += (e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) +
            e[0][1] * (e[1][2] * e[2][0] - e[1][0] * e[2][2]) +
            e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0])) / 6;
  }
  return sum;
}

/* Cells and void together have the volume of the domain. */
static void adds_up(const struct scene *s, double volume)
{
  double sum = volume_of_cells(&s->v) + volume_of_front(&s->v);

  assert_true(fabs(sum - volume) < 1e-10 * volume);
}

/* Nothing is left, and what was made is a mesh of the surface. */
static void is_finished(struct scene *s, double volume)
{
  struct vg_mesh all = s->m;
  struct vg_mesh_report r;

  assert_int_equal(s->v.n_face, 0);
  all.point = s->v.x;
  all.n_point = s->v.n_point;
  all.tet = s->v.cell;
  all.n_tet = s->v.n_cell;
  assert_memory_equal(s->v.x, s->m.point, s->m.n_point * sizeof *s->m.point);
  assert_int_equal(vg_mesh_judge(&all, NULL, &r, NULL), VG_OK);
  assert_int_equal(r.not_positive, 0);
  assert_int_equal(r.open_face + r.crowded_face + r.same_side_face, 0);
  assert_int_equal(r.orphan_boundary + r.outward_boundary, 0);
  assert_int_equal(r.unused_point + r.duplicate_point, 0);
  assert_true(r.is_valid);
  assert_int_equal(r.n_component, 1);
  assert_true(fabs(r.volume - volume) < 1e-10 * volume);
}

/* --- stopping and going on ------------------------------------------------ */

static size_t cells_of_box(int n)
{
  struct scene s;
  size_t made;

  box_scene(&s, n);
  made = grow(&s, 0);
  is_finished(&s, 1);
  scene_end(&s);
  return made;
}

static void stopped_at_any_count(void **state)
{
  size_t all = cells_of_box(4);
  size_t most[7] = {1, 7, 100, all / 3, all / 2, all - 1, all};

  (void)state;
  assert_true(all > 200);
  for (int k = 0; k < 7; k++) {
    struct scene s;

    box_scene(&s, 4);
    assert_int_equal(grow(&s, most[k]), most[k]);
    assert_int_equal(s.v.n_face == 0, most[k] == all);
    adds_up(&s, 1);
    grow(&s, 0);
    is_finished(&s, 1);
    assert_int_equal(grow(&s, 0), 0);      /* nothing to do: no harm */
    scene_end(&s);
  }
}

static void in_many_steps(void **state)
{
  struct scene s;
  int calls = 0;

  (void)state;
  box_scene(&s, 4);
  while (s.v.n_face && calls++ < 100) {
    grow(&s, 60);
    adds_up(&s, 1);
  }
  assert_in_range(calls, 5, 60);
  is_finished(&s, 1);
  scene_end(&s);
}

static void around_a_body_in_steps(void **state)
{
  struct scene s;
  double volume;
  int calls = 0;

  (void)state;
  sphere_scene(&s);
  volume = volume_of_front(&s.v);
  while (s.v.n_face && calls++ < 40) {
    grow(&s, 700);
    adds_up(&s, volume);
  }
  assert_true(calls > 2);
  is_finished(&s, volume);
  scene_end(&s);
}

/* --- storing ------------------------------------------------------------ */

static FILE *stored(const struct vg_void *v)
{
  FILE *f = tmpfile();

  assert_non_null(f);
  assert_int_equal(vg_void_save(v, f, NULL), VG_OK);
  rewind(f);
  return f;
}

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

/* The fill goes on from the stored state as it would have without. */
static void stored_in_between(void **state)
{
  struct scene s, kept;
  FILE *f;

  (void)state;
  box_scene(&s, 4);
  box_scene(&kept, 4);
  grow(&s, 150);
  grow(&kept, 150);
  f = stored(&s.v);
  vg_void_release(&s.v);
  assert_int_equal(vg_void_load(&s.v, f, NULL), VG_OK);
  fclose(f);
  same_void(&s.v, &kept.v);
  grow(&s, 0);
  grow(&kept, 0);
  same_void(&s.v, &kept.v);
  is_finished(&s, 1);
  f = stored(&s.v);          /* no front, cells only */
  vg_void_release(&kept.v);
  assert_int_equal(vg_void_load(&kept.v, f, NULL), VG_OK);
  same_void(&s.v, &kept.v);
  fclose(f);
  scene_end(&s);
  scene_end(&kept);
}

static void load_refused(const unsigned char *bytes, size_t n, vg_status want)
{
  struct vg_void v = VG_VOID_INIT;
  struct vg_error err = VG_ERROR_INIT;
  FILE *f = tmpfile();

  assert_non_null(f);
  assert_int_equal(fwrite(bytes, 1, n, f), n);
  rewind(f);
  assert_int_equal(vg_void_load(&v, f, &err), want);
  assert_true(strlen(err.text) > 10);
  assert_null(v.x);
  assert_null(v.face);
  assert_null(v.cell);
  assert_int_equal(v.n_point + v.n_face + v.n_cell, 0);
  fclose(f);
}

/* A copy of the state with n bytes at `at` put in their place. */
static void load_with(const unsigned char *bytes, size_t size, size_t at,
                      const void *with, size_t n)
{
  unsigned char *copy = vg_alloc(size, 1);

  assert_non_null(copy);
  memcpy(copy, bytes, size);
  memcpy(copy + at, with, n);
  load_refused(copy, size, VG_ERR_FORMAT);
  free(copy);
}

static void damaged_states_are_refused(void **state)
{
  const uint64_t huge[3] = {UINT64_MAX, UINT32_MAX, (uint64_t)1 << 33};
  const uint32_t far = UINT32_MAX, beyond = 1000000;
  const double not_finite[2] = {NAN, INFINITY};
  struct scene s;
  unsigned char *bytes;
  size_t size, face, cell;
  FILE *f;

  (void)state;
  box_scene(&s, 3);
  grow(&s, 20);
  f = stored(&s.v);
  face = 32 + s.v.n_point * sizeof *s.v.x;
  cell = face + s.v.n_face * sizeof *s.v.face;
  size = cell + s.v.n_cell * sizeof *s.v.cell;
  bytes = vg_alloc(size + 1, 1);
  assert_non_null(bytes);
  assert_int_equal(fread(bytes, 1, size + 1, f), size);
  fclose(f);
  for (size_t n = 0; n < size; n += n < 40 ? 1 : 97)
    load_refused(bytes, n, VG_ERR_FORMAT);
  load_refused(bytes, size - 1, VG_ERR_FORMAT);
  load_with(bytes, size, 6, "2", 1);
  for (int i = 0; i < 3; i++)
    for (size_t k = 0; k < 3; k++)
      load_with(bytes, size, 8 + 8 * k, &huge[i], sizeof huge[i]);
  load_with(bytes, size, face + 16, &far, sizeof far);
  load_with(bytes, size, cell - 4, &beyond, sizeof beyond);
  load_with(bytes, size, cell, &beyond, sizeof beyond);
  load_with(bytes, size, size - 4, &far, sizeof far);
  for (int i = 0; i < 2; i++)
    load_with(bytes, size, 32 + 40, &not_finite[i], sizeof not_finite[i]);
  free(bytes);
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

static void defects_of_a_void_are_seen(void **state)
{
  struct scene s;
  uint32_t keep;

  (void)state;
  box_scene(&s, 3);
  grow(&s, 10);
  s.v.n_face--;
  assert_int_equal(vg_void_defects(&s.v), 3);
  s.v.n_face++;
  keep = s.v.cell[3][0];
  s.v.cell[3][0] = s.v.cell[3][1];
  s.v.cell[3][1] = keep;
  assert_int_equal(vg_void_defects(&s.v), 1);
  scene_end(&s);
}

/* --- regions ------------------------------------------------------------ */

static double side_of(const struct vg_plane *p, const double x[3])
{
  return p->normal[0] * x[0] + p->normal[1] * x[1] + p->normal[2] * x[2] -
         p->offset;
}

static int crosses(const struct vg_void *v, size_t c,
                   const struct vg_region *r)
{
  for (int i = 0; i < r->n_plane; i++) {
    int above = 0, below = 0;

    for (int k = 0; k < 4; k++) {
      double side = side_of(&r->plane[i], v->x[v->cell[c][k]]);

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
      double side = side_of(s, v->x[v->face[i][k]]);

      above |= side > 0;
      below |= side < 0;
    }
    count[above && below ? 0 : below ? 1 : 2]++;
  }
}

/* Parts of the front that share no point. */
static uint32_t root(uint32_t *parent, uint32_t p)
{
  while (parent[p] != p) p = parent[p] = parent[parent[p]];
  return p;
}

static size_t front_components(const struct vg_void *v)
{
  uint32_t *parent = vg_alloc(v->n_point, sizeof *parent);
  uint8_t *used = vg_calloc(v->n_point, 1);
  size_t n = 0;

  assert_true(parent && used);
  for (uint32_t p = 0; p < v->n_point; p++) parent[p] = p;
  for (size_t i = 0; i < v->n_face; i++)
    for (int k = 0; k < 3; k++) {
      uint32_t a = root(parent, v->face[i][k]);

      parent[a] = root(parent, v->face[i][(k + 1) % 3]);
      used[v->face[i][k]] = 1;
    }
  for (uint32_t p = 0; p < v->n_point; p++)
    n += used[p] && root(parent, p) == p;
  free(parent);
  free(used);
  return n;
}

static const struct vg_region plane_zone = {
  .n_plane = 1, .plane = {{{0, 0, 1}, 0.03}} };
static const struct vg_region line_pencil = {
  .n_plane = 2, .plane = {{{0, 0, 1}, 0.03}, {{1, 0, 0}, 0.07}} };

static void a_zone_parts_the_void(void **state)
{
  struct scene s;
  size_t side[3], made;

  (void)state;
  box_scene(&s, 8);
  made = cut(&s, &plane_zone);
  assert_true(made > 100);
  all_cross(&s.v, 0, &plane_zone);
  adds_up(&s, 1);
  front_sides(&s.v, &plane_zone.plane[0], side);
  assert_int_equal(side[0], 0);
  assert_true(side[1] > 350 && side[2] > 350);
  assert_int_equal(front_components(&s.v), 2);
  grow(&s, 0);
  is_finished(&s, 1);
  scene_end(&s);
}

static void an_oblique_zone_around_a_body(void **state)
{
  const struct vg_region zone = {
    .n_plane = 1, .plane = {{{0.6, 0, 0.8}, 0.2}} };
  struct scene s;
  size_t side[3];
  double volume;

  (void)state;
  sphere_scene(&s);
  volume = volume_of_front(&s.v);
  assert_true(cut(&s, &zone) > 50);
  all_cross(&s.v, 0, &zone);
  adds_up(&s, volume);
  front_sides(&s.v, &zone.plane[0], side);
  assert_int_equal(side[0], 0);
  assert_true(side[1] > 50 && side[2] > 50);
  grow(&s, 0);
  is_finished(&s, volume);
  scene_end(&s);
}

static void pencil_zone_rest(void **state)
{
  struct scene s;
  size_t pencil, side[3];

  (void)state;
  box_scene(&s, 7);
  pencil = cut(&s, &line_pencil);
  assert_in_range(pencil, 14, 400);
  all_cross(&s.v, 0, &line_pencil);
  adds_up(&s, 1);
  assert_true(cut(&s, &plane_zone) > pencil);
  all_cross(&s.v, pencil, &plane_zone);
  adds_up(&s, 1);
  front_sides(&s.v, &plane_zone.plane[0], side);
  assert_true(side[1] > 300 && side[2] > 300);
  grow(&s, 0);
  is_finished(&s, 1);
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
    adds_up(&s, 8 * 8 * 5 - 16);
  }
  grow(&s, 0);
  is_finished(&s, 8 * 8 * 5 - 16);
  scene_end(&s);
}

/* A region beside the void finds no front, and leaves everything. */
static void a_region_elsewhere(void **state)
{
  const struct vg_region away = {
    .n_plane = 1, .plane = {{{0, 0, 1}, 3}} };
  struct vg_grow_options options = VG_GROW_OPTIONS_INIT;
  struct scene s;

  (void)state;
  box_scene(&s, 3);
  assert_int_equal(zone_take(&s.v, s.sizing, &away, &options, &s.report,
                             NULL), VG_BLOCKED);
  assert_int_equal(s.v.n_face, s.m.n_tri);
  assert_int_equal(s.v.n_cell, 0);
  adds_up(&s, 1);
  grow(&s, 0);
  is_finished(&s, 1);
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
  grow(&s, 50);
  grow(&kept, 50);
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
  is_finished(&s, 1);
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
  grow(&s, 50);
  grow(&kept, 50);
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
    cmocka_unit_test(stopped_at_any_count),
    cmocka_unit_test(in_many_steps),
    cmocka_unit_test(around_a_body_in_steps),
    cmocka_unit_test(stored_in_between),
    cmocka_unit_test(damaged_states_are_refused),
    cmocka_unit_test(quads_and_bad_indices_are_no_void),
    cmocka_unit_test(defects_of_a_void_are_seen),
    cmocka_unit_test(a_zone_parts_the_void),
    cmocka_unit_test(an_oblique_zone_around_a_body),
    cmocka_unit_test(pencil_zone_rest),
    cmocka_unit_test(many_cuts_through_a_plate),
    cmocka_unit_test(a_region_elsewhere),
    cmocka_unit_test(it_can_be_stopped_at_every_call),
    cmocka_unit_test(failures_leave_the_void_alone),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
