/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* First heights from the wall shear of a solution: the law of the heights,
 * bounds, ratios along edges, both sides of a thin body, and walls elsewhere.
 */
#include "remesh_shapes.h"

#include "core/mesh/edges.h"
#include "io/mesh/vtu.h"
#include "layers/columns/growth_law.h"
#include "run/layers/layers.h"
#include "run/input/wall_shear.h"

#define RATIO 1.2 /* L32 */
#define RE 1e6
#define LENGTH 2.0
#define Y_PLUS 0.5

typedef double friction(const double x[3]);

/* A surface whose patches all are walls, and a solution. */
struct scene {
  struct vg_read read;
  struct vg_notes notes;
  struct vg_boundary b;
  struct vg_layer_stage s;
  struct vg_point_heights h;
};

/* Writes cf at the points of m, which may be turned inside out and moved. */
static void write_solution(const char *path, struct vg_mesh *m, friction *cf,
                           int turned, double shift)
{
  double *v = malloc(m->n_point * sizeof *v);
  const struct vg_vtu_field f = { "cf", VG_VTU_POINT, VG_VTU_FLOAT64, 1, v };
  struct vg_error err = VG_ERROR_INIT;

  assert_non_null(v);
  for (size_t p = 0; p < m->n_point; p++) {
    v[p] = cf(m->point[p]);
    m->point[p][0] += shift;
  }
  for (size_t t = 0; t < m->n_tri && turned; t++) {
    const uint32_t a = m->tri[t][0];

    m->tri[t][0] = m->tri[t][1];
    m->tri[t][1] = a;
  }
  if (vg_vtu_write_boundary(path, m, &f, 1, &err) < 0) fail_msg("%s", err.text);
  free(v);
}

/* Sets up the surface b.surface, which the caller has made. */
static void open_scene(struct scene *c, const char *path)
{
  struct vg_settings *set = &c->read.settings;
  const size_t n = c->b.surface.n_patch;
  struct vg_error err = VG_ERROR_INIT;

  vg_settings_default(set);
  set->layer.y_plus = Y_PLUS;
  set->layer.reynolds = RE;
  set->layer.length = LENGTH;
  snprintf(set->layer.first_from, sizeof set->layer.first_from, "%s", path);
  c->b.read = &c->read;
  c->b.notes = c->read.notes = &c->notes;
  c->b.threads = 1;
  c->s.n_patch = n;
  c->s.request = calloc(n, sizeof *c->s.request);
  assert_non_null(c->s.request);
  for (size_t i = 0; i < n; i++) {
    c->s.request[i].is_wall = 1;
    c->s.request[i].law.delta1 = vg_first_height(Y_PLUS, RE, LENGTH);
  }
  if (vg_read_shear(&c->read, &err) < 0) fail_msg("%s", err.text);
}

static void close_scene(struct scene *c)
{
  vg_wall_shear_free(c->read.shear);
  vg_settings_release(&c->read.settings);
  vg_mesh_release(&c->b.surface);
  vg_notes_release(&c->notes);
  free(c->s.request);
  free(c->h.item);
}

static void run(struct scene *c)
{
  struct vg_error err = VG_ERROR_INIT;

  if (vg_first_from(&c->s, &c->b, &c->h, &err) < 0) fail_msg("%s", err.text);
  assert_int_equal(c->h.n, c->b.surface.n_point);
}

static const struct vg_point_height *at(const struct scene *c, size_t p)
{
  const struct vg_point_height *h = vg_point_height(&c->h,
                                                    c->b.surface.point[p]);

  assert_non_null(h);
  return h;
}

/* Height by y+ L / (Re sqrt(c_f / 2)), within the bound; negative c_f: that of
 * y_plus alone. */
static double law(const struct scene *c, double cf)
{
  const double plain = vg_first_height(Y_PLUS, RE, LENGTH);
  const double bound = c->read.settings.layer.first_bound;

  if (cf < 0) return plain;
  return fmin(plain * bound,
              fmax(plain / bound, Y_PLUS * LENGTH / (RE * sqrt(cf / 2))));
}

/* The heights are the greatest ones below `wanted` [n_point] that rise by
 * RATIO at the most along every edge: found here by passes over all edges. */
static void expect_graded(const struct scene *c, double *wanted)
{
  const struct vg_mesh *m = &c->b.surface;
  int changed = 1;

  while (changed) {
    changed = 0;
    for (size_t i = 0; i < 6 * m->n_tri; i++) {
      const uint32_t *v = m->tri[i / 6];
      const uint32_t a = v[i % 3], b = v[(i % 3 + 1 + i / 3 % 2) % 3];

      if (!(wanted[b] > RATIO * wanted[a])) continue;
      wanted[b] = RATIO * wanted[a];
      changed = 1;
    }
  }
  for (size_t p = 0; p < m->n_point; p++)
    assert_float_equal(at(c, p)->first / wanted[p], 1, 1e-12);
}

static void expect_law(const struct scene *c)
{
  const struct vg_mesh *m = &c->b.surface;
  double *wanted = malloc(m->n_point * sizeof *wanted);

  assert_non_null(wanted);
  for (size_t p = 0; p < m->n_point; p++)
    wanted[p] = law(c, at(c, p)->friction);
  expect_graded(c, wanted);
  free(wanted);
}

static double on_plate(const double x[3])
{
  return x[2] > 0.005 ? 0.004 * (1 + x[0]) : 0.001 * (1 + x[1]);
}

static const double plate_size[3] = { 1, 1, 0.01 };

/* A plate of 1/100 of its length, whose sides have different frictions, both
 * linear: they are interpolated exactly between other points, on the right
 * side, for any orientation of the solution. */
static void separates_the_sides_of_a_plate(void **unused)
{
  const char *path = VG_TMP_DIR "/first_plate.vtu";

  (void)unused;
  for (int turned = 0; turned < 2; turned++) {
    struct vg_mesh old = VG_MESH_INIT;
    struct scene c = { .h = { 0, NULL } };

    shape_box(&old, plate_size, (const uint32_t[3]){ 9, 7, 1 });
    write_solution(path, &old, on_plate, turned, 0);
    shape_box(&c.b.surface, plate_size, (const uint32_t[3]){ 12, 13, 2 });
    open_scene(&c, path);
    run(&c);
    for (size_t p = 0; p < c.b.surface.n_point; p++) {
      const double *x = c.b.surface.point[p];

      if (x[0] <= 0 || x[0] >= 1 || x[1] <= 0 || x[1] >= 1) continue;
      assert_float_equal(at(&c, p)->friction, on_plate(x), 1e-12);
    }
    expect_law(&c);
    vg_mesh_release(&old);
    close_scene(&c);
  }
}

static double on_sphere(const double x[3])
{
  return 0.003 * (1 + 0.9 * x[0]);
}

/* Interpolation between two triangulations of a sphere; one thread and several
 * give the same bits. */
static void follows_the_friction_on_a_sphere(void **unused)
{
  const char *path = VG_TMP_DIR "/first_sphere.vtu";
  const double r[3] = { 1, 1, 1 };
  struct vg_mesh old = VG_MESH_INIT;
  struct scene c[2] = { { .h = { 0, NULL } }, { .h = { 0, NULL } } };

  (void)unused;
  shape_ball(&old, r, 23);
  write_solution(path, &old, on_sphere, 0, 0);
  for (int i = 0; i < 2; i++) {
    shape_ball(&c[i].b.surface, r, 32);
    open_scene(&c[i], path);
    c[i].b.threads = 1 + 2 * i;
    run(&c[i]);
  }
  for (size_t p = 0; p < c[0].b.surface.n_point; p++) {
    const double wanted = on_sphere(c[0].b.surface.point[p]);

    /* The linear function changes by h^2 / 2 within edges of h = pi / 23. */
    assert_float_equal(at(&c[0], p)->friction, wanted, 0.0027 * 0.0095);
  }
  expect_law(&c[0]);
  assert_int_equal(c[0].h.n, c[1].h.n);
  assert_memory_equal(c[0].h.item, c[1].h.item, c[0].h.n * sizeof *c[0].h.item);
  vg_mesh_release(&old);
  close_scene(&c[0]);
  close_scene(&c[1]);
}

/* Any friction, from none on: heights are bounded and graded. */
static double at_random(const double x[3])
{
  uint64_t k = 88172645463325252u;

  for (int i = 0; i < 3; i++) {
    k ^= (uint64_t)(int64_t)(x[i] * 1e6);
    for (int j = 0; j < 3; j++) k ^= k << 13, k ^= k >> 7, k ^= k << 17;
  }
  return k % 7 ? (double)(k % 100000) * 1e-6 : 0;
}

static void bounds_and_grades_any_friction(void **unused)
{
  const char *path = VG_TMP_DIR "/first_random.vtu";
  const double r[3] = { 1, 0.5, 0.3 };
  struct vg_mesh old = VG_MESH_INIT;

  (void)unused;
  shape_ball(&old, r, 17);
  write_solution(path, &old, at_random, 0, 0);
  for (int i = 1; i < 8; i += 3) {
    struct scene c = { .h = { 0, NULL } };
    const double plain = vg_first_height(Y_PLUS, RE, LENGTH);

    shape_ball(&c.b.surface, r, 20);
    open_scene(&c, path);
    c.read.settings.layer.first_bound = i;
    run(&c);
    for (size_t p = 0; p < c.h.n; p++) {
      assert_true(c.h.item[p].first >= plain / i * (1 - 1e-12));
      assert_true(c.h.item[p].first <= plain * i * (1 + 1e-12));
    }
    expect_law(&c);
    close_scene(&c);
  }
  vg_mesh_release(&old);
}

/* A wall that the solution lacks keeps the height of y_plus, and a patch with a
 * height of its own keeps that, whatever the solution says. */
static void keeps_heights_without_a_solution(void **unused)
{
  const char *path = VG_TMP_DIR "/first_part.vtu";
  const double size[3] = { 1, 1, 1 }, own = 1e-9;
  const uint32_t n[3] = { 8, 8, 8 };
  struct vg_mesh old = VG_MESH_INIT;
  struct scene c = { .h = { 0, NULL } };
  struct vg_layer_row row;
  double *wanted;

  (void)unused;
  shape_box(&old, size, n);
  for (size_t t = 0; t < old.n_tri; t++) /* Without the last two patches. */
    if (old.tri_patch[t] >= 4) {
      old.n_tri = t;
      break;
    }
  write_solution(path, &old, on_sphere, 0, 0);
  shape_box(&c.b.surface, size, n);
  open_scene(&c, path);
  vg_settings_row_default(VG_TABLE_LAYERS, &row);
  row.id = 1;
  row.first = c.s.request[0].law.delta1 = own;
  assert_int_equal(vg_settings_add(&c.read.settings, VG_TABLE_LAYERS, &row,
                                   NULL),
                   VG_OK);
  run(&c);
  wanted = malloc(c.h.n * sizeof *wanted);
  assert_non_null(wanted);
  for (size_t p = 0; p < c.h.n; p++) {
    const double *x = c.b.surface.point[p], cf = at(&c, p)->friction;
    const int inside = x[0] > 0 && x[0] < 1 && x[1] > 0 && x[1] < 1;

    if (inside) assert_true(cf < 0); /* In the patches without a solution. */
    wanted[p] = x[0] <= 0 ? own : law(&c, cf);
  }
  expect_graded(&c, wanted);
  assert_int_equal(c.notes.n, 2);
  free(wanted);
  vg_mesh_release(&old);
  close_scene(&c);
}

static void refuses_walls_elsewhere(void **unused)
{
  const char *path = VG_TMP_DIR "/first_far.vtu";
  const double r[3] = { 1, 1, 1 };
  struct vg_mesh old = VG_MESH_INIT;
  struct scene c = { .h = { 0, NULL } };
  struct vg_error err = VG_ERROR_INIT;

  (void)unused;
  shape_ball(&old, r, 8);
  write_solution(path, &old, on_sphere, 0, 100);
  shape_ball(&c.b.surface, r, 8);
  open_scene(&c, path);
  assert_int_equal(vg_first_from(&c.s, &c.b, &c.h, &err), VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "between (99 "));
  vg_mesh_release(&old);
  close_scene(&c);
}

static double constant(const double x[3])
{
  (void)x;
  return 0.003;
}

/* Spheres in other units touch the walls at one place; they are not theirs. */
static void refuses_other_units(void **unused)
{
  static const double unit[] = { 1000, 10, 2, 0.1, 0.001 };
  const char *path = VG_TMP_DIR "/first_unit.vtu";
  const double one[3] = { 1, 1, 1 };

  (void)unused;
  for (size_t i = 0; i < sizeof unit / sizeof *unit; i++) {
    const double r[3] = { unit[i], unit[i], unit[i] };
    struct vg_mesh old = VG_MESH_INIT;
    struct scene c = { .h = { 0, NULL } };
    struct vg_error err = VG_ERROR_INIT;

    shape_ball(&old, r, 8);
    write_solution(path, &old, constant, 0, unit[i] - 1);
    shape_ball(&c.b.surface, one, 8);
    open_scene(&c, path);
    assert_int_equal(vg_first_from(&c.s, &c.b, &c.h, &err), VG_ERR_INPUT);
    assert_non_null(strstr(err.text, "less than half"));
    vg_mesh_release(&old);
    close_scene(&c);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(separates_the_sides_of_a_plate),
    cmocka_unit_test(follows_the_friction_on_a_sphere),
    cmocka_unit_test(bounds_and_grades_any_friction),
    cmocka_unit_test(keeps_heights_without_a_solution),
    cmocka_unit_test(refuses_walls_elsewhere),
    cmocka_unit_test(refuses_other_units)
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
