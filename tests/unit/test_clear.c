/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Clearance of layers from each other and from the opposite surface. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "clear_shapes.h"

static size_t tops(const struct shape *s, const uint8_t *is_slide,
                   const uint8_t *active, int threads, uint8_t *bad)
{
  static const uint8_t none[PATCHES];
  struct vg_error err = VG_ERROR_INIT;
  size_t n_bad = SIZE_MAX, n = 0;

  memset(bad, 7, s->c.n_column);
  assert_int_equal(vg_clear_tops(&s->m, &s->c, is_slide ? is_slide : none,
                                 active, NULL, threads, bad, &n_bad, &err),
                   VG_OK);
  for (size_t i = 0; i < s->c.n_column; i++) {
    assert_true(bad[i] <= 1);
    n += bad[i];
  }
  assert_int_equal(n, n_bad);
  return n;
}

static const double ex[3] = { 1, 0, 0 }, ey[3] = { 0, 1, 0 };
static const double zero[3] = { 0, 0, 0 };

/* Two plates that face each other, `gap` apart, n x n squares each; the squares
 * of the two plates do not coincide. */
static struct shape *two_plates(int n, double gap, double thickness)
{
  struct shape *s = shape_new(thickness);
  const double up[3] = { 0.01, 0.02, gap };

  add_plate(s, 0, n, zero, ex, ey);
  add_plate(s, 1, n + 1, up, ey, ex);
  s->is_wall[0] = 1;
  return s;
}

/* --- tops ---------------------------------------------------------------- */

static void tops_between_plates(void **state)
{
  struct shape *s = two_plates(12, 0.25, 0.0625);
  uint8_t bad[MAX];

  (void)state;
  s->is_wall[1] = 1;
  grow(s, 1);
  /* 1/16 from each side leaves 1/8; 2/16 touch exactly; 3/16 do not intersect,
   * but have passed through each other: only the middle one is a contact of
   * tops. */
  assert_int_equal(tops(s, NULL, NULL, 1, bad), 0);
  for (size_t i = 0; i < s->c.n_column; i++) s->c.column[i].n = 2;
  /* All columns above a square of the other plate. */
  assert_true(tops(s, NULL, NULL, 1, bad) > s->c.n_column * 9 / 10);
  shape_free(s);
}

/* One column with a margin, which is at most as high as the column, in the gap
 * between two fronts. */
static void a_front_keeps_its_margin(void **state)
{
  const double gap = 0.25;
  size_t n_contact = 0;

  (void)state;
  for (int k = 0; k < 200; k++) {
    const double thickness = 0.0005 * (1 + k * 37 % 211);
    const double margin = 0.001 * (k * 53 % 197);
    const double left = gap - 2 * thickness - fmin(margin, thickness);
    struct shape *s = two_plates(12, gap, thickness);
    double m[MAX] = { 0 };
    uint8_t bad[MAX], none[PATCHES] = { 0 };
    struct vg_error err = VG_ERROR_INIT;
    size_t n_bad = 0;
    uint32_t i;

    s->is_wall[1] = 1;
    grow(s, 1);
    i = s->of_point[6 * 13 + 6];
    m[i] = margin;
    assert_int_equal(vg_clear_tops(&s->m, &s->c, none, NULL, m, 1, bad, &n_bad,
                                   &err),
                     VG_OK);
    if (fabs(left) > 1e-9) {
      assert_int_equal(n_bad > 0, left < 0);
      assert_int_equal(bad[i], left < 0);
    }
    n_contact += left < 0;
    shape_free(s);
  }
  assert_true(n_contact > 20 && n_contact < 180);
}

static void one_column_through_the_other_front(void **state)
{
  struct shape *s = two_plates(12, 0.25, 0.0625);
  uint32_t i;
  uint8_t bad[MAX];

  (void)state;
  s->is_wall[1] = 1;
  grow(s, 1);
  i = s->of_point[6 * 13 + 6];
  s->c.column[i].n = 4;
  tops(s, NULL, NULL, 1, bad);
  assert_int_equal(bad[i], 1);
  assert_int_equal(bad[s->of_point[0]], 0);
  /* Through the bare wall as well, which is then its own top. */
  s->c.column[i].n = 2;
  for (size_t k = 169; k < s->c.n_column; k++) s->c.column[k].n = 0;
  assert_int_equal(tops(s, NULL, NULL, 1, bad), 0);
  s->c.column[i].n = 4;
  assert_true(tops(s, NULL, NULL, 1, bad) > 0);
  assert_int_equal(bad[i], 1);
  /* A column without a level cannot be lowered and is not reported. */
  for (size_t k = 169; k < s->c.n_column; k++) assert_int_equal(bad[k], 0);
  shape_free(s);
}

/* A column whose shift alone carries its top through the other front. */
static void the_shift_of_a_column_counts(void **state)
{
  const double thickness = 0.0625;

  (void)state;
  for (int k = 0; k < 200; k++) {
    const double gap = 0.2 + 0.0017 * (k * 61 % 101);
    const double shift = gap * (0.011 * (k * 37 % 199) - 0.9);
    struct shape *s = two_plates(12, gap, thickness);
    struct vg_column *c;
    uint8_t bad[MAX];

    s->is_wall[1] = 1;
    grow(s, 1);
    c = &s->c.column[s->of_point[6 * 13 + 6]];
    c->shift[2] = shift;
    assert_int_equal(tops(s, NULL, NULL, 1, bad) > 0,
                     2 * thickness + shift > gap);
    shape_free(s);
  }
}

static void inert_patch_is_in_the_way(void **state)
{
  struct shape *s = two_plates(8, 0.25, 0.0625);
  uint8_t bad[MAX];
  uint8_t is_slide[PATCHES] = { 0, 1, 0 };

  (void)state;
  grow(s, 3);
  assert_int_equal(tops(s, NULL, NULL, 1, bad), 0);
  for (size_t i = 0; i < s->c.n_column; i++) s->c.column[i].n = 4;
  assert_true(tops(s, NULL, NULL, 1, bad) > 60);
  /* A slide patch is an obstacle for columns that do not slide in it ... */
  assert_true(tops(s, is_slide, NULL, 1, bad) > 60);
  /* ... and only for them. */
  for (size_t i = 0; i < s->c.n_column; i++) s->c.column[i].slide[1] = 1;
  assert_int_equal(tops(s, is_slide, NULL, 1, bad), 0);
  shape_free(s);
}

static struct shape *cube(void)
{
  struct shape *s = shape_new(0.125);
  uint32_t p[3][3][3];

  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      for (int k = 0; k < 3; k++)
        if (i != 1 || j != 1 || k != 1)
          p[i][j][k] = add_point(s, 0.5 * i, 0.5 * j, 0.5 * k);
  for (int a = 0; a < 3; a++)
    for (int side = 0; side < 2; side++)
      for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++) {
          uint32_t q[2][2];

          for (int u = 0; u < 2; u++)
            for (int v = 0; v < 2; v++) {
              int at[3];

              at[a] = 2 * side;
              at[(a + 1) % 3] = side ? i + u : i + v;
              at[(a + 2) % 3] = side ? j + v : j + u;
              q[u][v] = p[at[0]][at[1]][at[2]];
            }
          add_tri(s, 0, q[0][0], q[1][0], q[1][1]);
          add_tri(s, 0, q[0][0], q[1][1], q[0][1]);
        }
  s->is_wall[0] = 1;
  return s;
}

static void cube_grows_outward(void **state)
{
  struct shape *s = cube();
  uint8_t bad[MAX];

  (void)state;
  grow(s, 3);
  assert_int_equal(s->c.n_column, 26);
  assert_int_equal(tops(s, NULL, NULL, 1, bad), 0);
  /* Uneven levels: still no neighbour is touched. */
  for (size_t i = 0; i < s->c.n_column; i += 3) s->c.column[i].n = 2;
  assert_int_equal(tops(s, NULL, NULL, 1, bad), 0);
  for (size_t i = 0; i < s->c.n_column; i++) s->c.column[i].n = 0;
  assert_int_equal(tops(s, NULL, NULL, 1, bad), 0);
  /* Inward, the tops of opposite sides meet in the middle. */
  for (size_t i = 0; i < s->c.n_column; i++) {
    s->c.column[i].n = 4;
    for (int k = 0; k < 3; k++) s->c.column[i].dir[k] *= -1;
  }
  assert_true(tops(s, NULL, NULL, 1, bad) > 0);
  shape_free(s);
}

static void tops_that_cross(void **state)
{
  struct shape *s = shape_new(0.125);
  uint8_t bad[MAX];
  uint32_t a, b;

  (void)state;
  add_plate(s, 0, 10, zero, ex, ey);
  s->is_wall[0] = 1;
  grow(s, 1);
  assert_int_equal(tops(s, NULL, NULL, 1, bad), 0);
  /* Two columns three squares apart lean until they cross. */
  a = s->of_point[5 * 11 + 3];
  b = s->of_point[5 * 11 + 6];
  s->c.column[a].dir[0] = 2;
  s->c.column[b].dir[0] = -2;
  assert_true(tops(s, NULL, NULL, 1, bad) > 1);
  assert_true(bad[a] && bad[b]);
  assert_false(bad[s->of_point[0]]);
  shape_free(s);
}

static void degenerate_tops_are_bad(void **state)
{
  struct shape *s = shape_new(0.125);
  uint8_t bad[MAX];
  uint32_t a;

  (void)state;
  add_plate(s, 0, 8, zero, ex, ey);
  s->is_wall[0] = 1;
  grow(s, 1);
  /* The top of a is on the line between those of its neighbours. */
  a = s->of_point[4 * 9 + 4];
  s->c.column[a].dir[0] = 1;
  assert_true(tops(s, NULL, NULL, 1, bad) > 0);
  assert_true(bad[a]);
  s->c.column[a].dir[0] = NAN;
  assert_true(tops(s, NULL, NULL, 1, bad) > 0);
  assert_true(bad[a]);
  shape_free(s);
}

/* Columns of one root: faces between them have no area at level 0, and tops
 * that stay at the root share it. */
static void fan_of_columns(void **state)
{
  struct shape *s = shape_new(0.125);
  struct vg_columns *c = &s->c;
  uint8_t bad[MAX];
  uint32_t p[4];

  (void)state;
  p[0] = add_point(s, 0, 0, 0);
  p[1] = add_point(s, 0, 1, 0);
  p[2] = add_point(s, 1, 0, 0);
  p[3] = add_point(s, 1, 0.1, -0.01);
  add_tri(s, 0, p[0], p[2], p[1]);
  add_tri(s, 0, p[0], p[1], p[3]);
  s->is_wall[0] = 1;
  grow(s, 1);
  /* Two additional columns on point 0 and one on point 1. */
  free(c->face);
  free(c->face_tri);
  c->column = realloc(c->column, 7 * sizeof *c->column);
  c->face = room(5, sizeof *c->face);
  c->face_tri = room(5, sizeof *c->face_tri);
  assert_non_null(c->column);
  for (int i = 4; i < 7; i++) {
    c->column[i] = c->column[0];
    c->column[i].root = i < 6 ? p[0] : p[1];
  }
  c->n_column = 7;
  c->n_face = 5;
  memcpy(c->face[0], (uint32_t[]){ 0, 2, 1 }, sizeof *c->face);
  memcpy(c->face[1], (uint32_t[]){ 5, 6, 3 }, sizeof *c->face);
  memcpy(c->face[2], (uint32_t[]){ 0, 1, 4 }, sizeof *c->face);
  memcpy(c->face[3], (uint32_t[]){ 4, 1, 6 }, sizeof *c->face);
  memcpy(c->face[4], (uint32_t[]){ 4, 6, 5 }, sizeof *c->face);
  c->face_tri[1] = 1;
  for (int f = 2; f < 5; f++) c->face_tri[f] = VG_NO_INDEX;
  for (size_t i = 0; i < 7; i++) {
    static const double dir[7][3] = { { 0, 0, 1 },   { 0, 0, 1 },
                                      { 0, 0, 1 },   { 0, 0.1, -1 },
                                      { -1, 0, 0 },  { 0, 0.1, -1 },
                                      { 0, 0.1, -1 } };

    memcpy(c->column[i].dir, dir[i], sizeof dir[i]);
  }
  for (unsigned levels = 0; levels < 128; levels++) {
    /* Column 4 raised within a fan at level 0 makes a flap without volume: two
     * coincident tops. */
    int flap = (levels >> 4 & 1) && !(levels & 0x63);

    for (int i = 0; i < 7; i++) c->column[i].n = levels >> i & 1;
    assert_int_equal(tops(s, NULL, NULL, 1, bad), flap);
    assert_int_equal(bad[4], flap);
  }
  shape_free(s);
}

/* Two bars of triangles standing on the plane z = 0, in which they slide. */
static struct shape *two_bars(double distance)
{
  struct shape *s = shape_new(0.125);
  const double up[3] = { 0, 0, 2 }, back[3] = { 0, -1, 0 };
  const double right[3] = { distance, 1, 0 };
  const double o[3] = { -3, -3, 0 }, u[3] = { 0, 6, 0 }, v[3] = { 6, 0, 0 };

  add_plate(s, 0, 8, zero, ey, up);    /* fluid towards +x */
  add_plate(s, 0, 6, right, back, up); /* fluid towards -x */
  add_plate(s, 1, 4, o, v, u);
  s->is_wall[0] = 1;
  grow(s, 2);
  add_rims(s, 1, 0);
  return s;
}

static void flanks_in_one_plane(void **state)
{
  static const uint8_t is_slide[PATCHES] = { 0, 1, 0 };
  struct shape *s = two_bars(0.625);
  uint8_t bad[MAX];
  uint32_t a;

  (void)state;
  assert_int_equal(s->c.n_border, 14);
  assert_int_equal(tops(s, is_slide, NULL, 1, bad), 0);
  /* 3/8 on each side: they overlap, and so do the tops. */
  for (size_t i = 0; i < s->c.n_column; i++) s->c.column[i].n = 3;
  assert_true(tops(s, is_slide, NULL, 1, bad) > 14);
  /* Only columns in the plane rise. Their tops lean away and stay apart, so
   * that only the side faces collide. */
  for (size_t i = 0; i < s->c.n_column; i++)
    s->c.column[i].n = s->c.column[i].slide[0] == 1 ? 2 : 0;
  assert_int_equal(tops(s, is_slide, NULL, 1, bad), 0);
  a = s->of_point[4];
  s->c.column[a].n = 5;
  tops(s, is_slide, NULL, 1, bad);
  assert_true(bad[a]);
  /* Through an edge of the wall without a level. */
  for (size_t i = 0; i < s->c.n_column; i++) s->c.column[i].n = 0;
  s->c.column[a].n = 4;
  assert_int_equal(tops(s, is_slide, NULL, 1, bad), 0);
  s->c.column[a].n = 6;
  s->c.n_face = 0;
  assert_int_equal(tops(s, is_slide, NULL, 1, bad), 1);
  assert_true(bad[a]);
  shape_free(s);
}

/* A plane with rounding noise: no points are exactly coplanar. */
static void flanks_in_a_noisy_plane(void **state)
{
  static const uint8_t is_slide[PATCHES] = { 0, 1, 0 };
  struct shape *s = two_bars(0.625);
  uint8_t bad[MAX];

  (void)state;
  s->c.n_face = 0;
  for (size_t i = 0; i < s->c.n_border; i++)
    for (int k = 0; k < 2; k++)
      s->m.point[s->c.column[s->c.border[i][k]].root][2] = 1e-7 *
                                                             (double)(i % 5) -
                                                           2e-7;
  assert_int_equal(tops(s, is_slide, NULL, 1, bad), 0);
  for (size_t i = 0; i < s->c.n_column; i++) s->c.column[i].n = 3;
  /* All except the ends of the rows may be lowered: both rows overlap. */
  assert_int_equal(tops(s, is_slide, NULL, 1, bad), 16);
  shape_free(s);
}

static struct shape *sphere_over_plane(double distance)
{
  struct shape *s = shape_new(0.03125);
  const double o[3] = { 0, 0, 1 + distance };
  const double p[3] = { -2, -2, 0 }, u[3] = { 4, 0, 0 }, v[3] = { 0, 4, 0 };

  add_sphere(s, 0, 24, o, 1);
  add_plate(s, 1, 20, p, u, v);
  s->is_wall[0] = 1;
  return s;
}

/* The active columns only determine which pairs are tested. */
static void active_columns_only(void **state)
{
  struct shape *s = sphere_over_plane(0.2);
  uint8_t bad[MAX], part[MAX], active[MAX];
  size_t n;

  (void)state;
  s->is_wall[1] = 1;
  grow(s, 4);
  n = tops(s, NULL, NULL, 1, bad);
  assert_true(n > 10 && n < s->c.n_column / 2);
  /* Columns that touch nothing may be inactive. */
  assert_int_equal(tops(s, NULL, bad, 1, part), n);
  assert_memory_equal(bad, part, s->c.n_column);
  /* A single active column: its faces, and the faces that they touch. */
  for (size_t i = 0; i < s->c.n_column; i++) {
    memset(active, 0, sizeof active);
    if (!bad[i]) continue;
    active[i] = 1;
    assert_true(tops(s, NULL, active, 1, part) > 0);
    assert_true(part[i]);
    for (size_t k = 0; k < s->c.n_column; k++) assert_true(bad[k] || !part[k]);
    break;
  }
  memset(active, 0, sizeof active);
  assert_int_equal(tops(s, NULL, active, 1, part), 0);
  shape_free(s);
}

static void top_collisions_do_not_depend_on_threads(void **state)
{
  struct shape *s = sphere_over_plane(0.2);
  uint8_t bad[MAX], again[MAX];
  size_t n;

  (void)state;
  grow(s, 7);
  n = tops(s, NULL, NULL, 1, bad);
  assert_true(n > 0);
  for (int threads = 2; threads <= 3; threads++) {
    assert_int_equal(tops(s, NULL, NULL, threads, again), n);
    assert_memory_equal(bad, again, s->c.n_column);
  }
  shape_free(s);
}

/* --- clearance ahead ----------------------------------------------------- */

static double *ahead(struct shape *s, double reach, int threads)
{
  struct vg_error err = VG_ERROR_INIT;
  double *wanted = room(s->c.n_column + 1, sizeof *wanted);
  double *allowed = room(s->c.n_column + 1, sizeof *allowed);

  for (size_t i = 0; i < s->c.n_column; i++) wanted[i] = reach;
  assert_int_equal(vg_clear_ahead(&s->m, &s->c, &s->t, 0.4, threads, wanted,
                                  allowed, &err),
                   VG_OK);
  for (size_t i = 0; i < s->c.n_column; i++)
    assert_true(allowed[i] > 0 && allowed[i] <= reach);
  free(wanted);
  return allowed;
}

static void plates_share_the_gap(void **state)
{
  struct shape *s = two_plates(16, 0.3, 0.01);
  double *allowed;

  (void)state;
  s->is_wall[1] = 1;
  grow(s, 1);
  allowed = ahead(s, 1, 1);
  for (size_t i = 0; i < s->c.n_column; i++) {
    const double *x = s->m.point[s->c.column[i].root];

    /* Where the other plate covers it; 1e-12: rounding. */
    if (x[0] >= 0.01 && x[0] <= 1 && x[1] >= 0.02 && x[1] <= 1)
      assert_true(fabs(allowed[i] - 0.4 * 0.3) < 1e-12);
  }
  free(allowed);
  /* A dir twice as long takes half the steps. */
  for (size_t i = 0; i < s->c.n_column; i++) s->c.column[i].dir[2] *= 2;
  allowed = ahead(s, 1, 1);
  assert_true(fabs(allowed[8 * 17 + 8] - 0.2 * 0.3) < 1e-12);
  free(allowed);
  /* Too far away to matter. */
  allowed = ahead(s, 0.05, 1);
  for (size_t i = 0; i < s->c.n_column; i++) assert_true(allowed[i] == 0.05);
  free(allowed);
  shape_free(s);
}

static void patches_to_slide_in(void **state)
{
  struct shape *s = two_plates(16, 0.3, 0.01);
  double *allowed;
  size_t middle = 8 * 17 + 8;

  (void)state;
  grow(s, 1);
  s->c.column[middle].slide[1] = 1;
  allowed = ahead(s, 1, 1);
  assert_true(allowed[middle] == 1);
  /* For other columns it is an ordinary patch, straight ahead. */
  assert_true(fabs(allowed[middle + 1] - 0.4 * 0.3) < 1e-12);
  free(allowed);
  /* It limits a column straight ahead, at 0.3 / 0.8; a wall also limits
   * sideways. */
  s->c.column[middle + 1].dir[0] = 0.6;
  s->c.column[middle + 1].dir[2] = 0.8;
  allowed = ahead(s, 1, 1);
  assert_true(fabs(allowed[middle + 1] - 0.4 * 0.3 / 0.8) < 1e-12);
  free(allowed);
  s->c.column[middle].slide[1] = VG_NO_INDEX;
  allowed = ahead(s, 1, 1);
  assert_true(fabs(allowed[middle + 1] - 0.4 * 0.3 / 1.4) < 1e-12);
  free(allowed);
  shape_free(s);
}

/* A face whose columns grow in the same direction is no limit, whatever the
 * shape of its wall. */
static void columns_of_one_stack_are_no_limit(void **state)
{
  struct shape *s = two_plates(16, 0.3, 0.01);
  size_t middle = 8 * 17 + 8;
  double *allowed;

  (void)state;
  s->is_wall[1] = 1;
  grow(s, 1);
  s->c.column[middle].dir[0] = 0.6;
  s->c.column[middle].dir[2] = 0.8;
  for (size_t i = 17 * 17; i < s->c.n_column; i++) {
    s->c.column[i].dir[0] = 0.8;
    s->c.column[i].dir[2] = -0.1;
  }
  allowed = ahead(s, 1, 1);
  assert_true(allowed[middle] == 1);
  assert_true(fabs(allowed[middle + 1] - 0.4 * 0.3) < 1e-12);
  free(allowed);
  shape_free(s);
}

/* On a sphere, dir makes the angle a with the downward normal of the plane: its
 * cone meets the plane first at height H / (cos a + sin a). */
static void sphere_near_a_plane(void **state)
{
  struct shape *s = sphere_over_plane(0.2);
  double *allowed;
  size_t n = 0;

  (void)state;
  grow(s, 1);
  for (size_t i = 0; i < s->c.n_column; i++)
    for (int k = 0; k < 3; k++)
      s->c.column[i].dir[k] = s->m.point[s->c.column[i].root][k] -
                              (k == 2 ? 1.2 : 0);
  allowed = ahead(s, 0.3, 1);
  for (size_t i = 0; i < s->c.n_column; i++) {
    double g = -s->c.column[i].dir[2];
    double expect = g > 0.2 ? 0.4 * (1.2 - g) / (g + sqrt(1 - g * g)) : 0.3;

    if (expect > 0.3) expect = 0.3;
    if (g < 0.2 || g > 0.3) {
      assert_true(fabs(allowed[i] - expect) < 1e-9);
      n += expect < 0.3;
    }
  }
  assert_true(n > 100);
  free(allowed);
  shape_free(s);
}

static void a_convex_body_has_no_opposite_surface(void **state)
{
  struct shape *s = shape_new(0.1);
  double *allowed;

  (void)state;
  add_sphere(s, 0, 16, zero, 1);
  s->is_wall[0] = 1;
  grow(s, 1);
  allowed = ahead(s, 10, 1);
  for (size_t i = 0; i < s->c.n_column; i++) assert_true(allowed[i] == 10);
  free(allowed);
  shape_free(s);
}

/* No triangle that faces the column may have a corner in the cone nearer than
 * the distance used for the answer; checked without a tree. */
static void every_face_in_the_cone_is_found(void **state)
{
  struct shape *s = shape_new(0.1);
  const double o[3] = { 0.3, 0.2, 1.4 };
  double *allowed;
  size_t n = 0;

  (void)state;
  add_sphere(s, 0, 30, zero, 1);
  add_sphere(s, 1, 11, o, 0.35);
  s->is_wall[0] = 1;
  grow(s, 1);
  allowed = ahead(s, 0.4, 1);
  for (size_t i = 0; i < s->c.n_column; i++) {
    const double *u = s->c.column[i].dir, *r = s->m.point[s->c.column[i].root];
    double nearest = 1;

    for (size_t t = 0; t < s->m.n_tri; t++) {
      double c[3], along = 0, far = 0, g = 0;

      if (s->m.tri_patch[t] == 0) continue;
      normal_of(s, s->m.tri[t], c);
      for (int k = 0; k < 3; k++) g += c[k] * u[k];
      if (g > -0.21 * sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2])) continue;
      for (int j = 0; j < 3; j++) {
        along = far = 0;
        for (int k = 0; k < 3; k++) {
          double d = s->m.point[s->m.tri[t][j]][k] - r[k];

          along += d * u[k];
          far += d * d;
        }
        if (along > 0 && far < 1.99 * along * along)
          nearest = fmin(nearest, along);
      }
    }
    if (nearest < 1) {
      assert_true(allowed[i] <= 0.4 * nearest + 1e-12);
      /* Edges are 0.1 long: the corner is close to the nearest point. */
      assert_true(allowed[i] >= 0.4 * (nearest - 0.15));
      n++;
    }
  }
  assert_true(n > 50);
  free(allowed);
  shape_free(s);
}

/* Two walls at 30 degrees with the edge y; both have columns. */
static struct shape *wedge(int n)
{
  struct shape *s = shape_new(0.01);
  const double c = cos(M_PI / 6), z = sin(M_PI / 6);
  uint32_t w = (uint32_t)n + 1;

  add_plate(s, 0, n, zero, ex, ey);
  for (int j = 0; j <= n; j++)
    for (int i = 1; i <= n; i++)
      add_point(s, c * i / n, (double)j / n, z * i / n);
  for (uint32_t j = 0; j + 1 < w; j++)
    for (uint32_t i = 0; i + 1 < w; i++) {
      uint32_t p[2][2];

      for (uint32_t u = 0; u < 2; u++)
        for (uint32_t v = 0; v < 2; v++)
          p[u][v] = i + u ? w * w + (j + v) * (w - 1) + i + u - 1 : (j + v) * w;
      add_tri(s, 0, p[0][0], p[1][1], p[1][0]);
      add_tri(s, 0, p[0][0], p[0][1], p[1][1]);
    }
  s->is_wall[0] = 1;
  return s;
}

static void concave_wedge_at_right_angles(void **state)
{
  enum { N = 20 };
  struct shape *s = wedge(N);
  const double t = tan(M_PI / 6);
  double *allowed;

  (void)state;
  grow(s, 1);
  allowed = ahead(s, 0.2, 1);
  /* Normal to its wall, the cone meets the other at x t / (1 + t). */
  for (uint32_t i = 5; i <= N; i++) {
    double x = (double)i / N, expect = 0.4 * x * t / (1 + t);

    assert_true(fabs(allowed[N / 2 * (N + 1) + i] - expect) < 1e-9);
  }
  /* Next to the edge, triangles of the other wall that touch the edge do not
   * count: the next row begins at z = 1/2 of a square. */
  assert_true(fabs(allowed[N / 2 * (N + 1) + 1] - 0.4 * 0.5 / N) < 1e-9);
  /* On the edge itself there is no opposite surface. */
  for (uint32_t j = 0; j <= N; j++) assert_true(allowed[j * (N + 1)] == 0.2);
  free(allowed);
  shape_free(s);
}

static void concave_wedge_with_turned_columns(void **state)
{
  enum { N = 20 };
  struct shape *s = wedge(N);
  double *allowed;

  (void)state;
  grow(s, 1);
  /* Along the bisector on the edge, turning to the wall's normal over 8
   * squares. */
  for (size_t i = 0; i < s->c.n_column; i++) {
    struct vg_column *c = &s->c.column[i];
    const double *x = s->m.point[c->root];
    int upper = x[2] > 0;
    double far = sqrt(x[0] * x[0] + x[2] * x[2]) * N / 8;
    double a = fmin(far, 1) * 75 * M_PI / 180, l;

    c->dir[0] = cos(M_PI / 12 + (upper ? -a : a));
    c->dir[1] = 0;
    c->dir[2] = sin(M_PI / 12 + (upper ? -a : a));
    l = sqrt(c->dir[0] * c->dir[0] + c->dir[2] * c->dir[2]);
    for (int k = 0; k < 3; k++) c->dir[k] /= l;
  }
  allowed = ahead(s, 0.2, 1);
  /* The columns next to the edge belong to one stack and have no limit. */
  for (uint32_t i = 0; i <= 2; i++)
    assert_true(allowed[N / 2 * (N + 1) + i] == 0.2);
  assert_true(allowed[N / 2 * (N + 1) + 16] < 0.2);
  free(allowed);
  shape_free(s);
}

/* A flat bar along y with a sharp edge at x = at; `side` -1: it lies before the
 * edge, 1: after it. */
static void add_sharp_bar(struct shape *s, int n, double at, int side)
{
  uint32_t first = (uint32_t)s->m.n_point;

  for (int j = 0; j <= n; j++) {
    double y = (double)j / n;

    add_point(s, at, y, 0);
    add_point(s, at + side, y, 0.05);
    add_point(s, at + side, y, -0.05);
  }
  for (uint32_t j = 0; j < (uint32_t)n; j++)
    for (uint32_t k = 1; k < 3; k++) {
      uint32_t a = first + 3 * j, b = a + 3;
      int flip = (k == 1) == (side > 0);

      add_tri(s, 0, a, flip ? b + k : b, flip ? b : b + k);
      add_tri(s, 0, a, flip ? a + k : b + k, flip ? b + k : a + k);
    }
}

/* Neither edge can see a triangle of the other: all are parallel to its
 * direction. */
static void sharp_edges_face_each_other(void **state)
{
  enum { N = 16 };
  struct shape *s = shape_new(0.01);
  double *allowed;

  (void)state;
  add_sharp_bar(s, N, 0, -1);
  add_sharp_bar(s, N, 0.2, 1);
  s->is_wall[0] = 1;
  grow(s, 1);
  assert_true(s->c.column[3 * (N / 2)].dir[0] > 0.99);
  assert_true(s->c.column[3 * (N + 1 + N / 2)].dir[0] < -0.99);
  allowed = ahead(s, 1, 1);
  for (uint32_t j = 2; j + 2 <= N; j++) {
    assert_true(fabs(allowed[3 * j] - 0.4 * 0.2) < 1e-9);
    assert_true(fabs(allowed[3 * (N + 1 + j)] - 0.4 * 0.2) < 1e-9);
  }
  free(allowed);
  shape_free(s);
}

static void allowed_heights_do_not_depend_on_threads(void **state)
{
  struct shape *s = sphere_over_plane(0.05);
  double *one, *more;

  (void)state;
  s->is_wall[1] = 1;
  grow(s, 1);
  one = ahead(s, 1, 1);
  for (int threads = 2; threads <= 3; threads++) {
    more = ahead(s, 1, threads);
    assert_memory_equal(one, more, s->c.n_column * sizeof *one);
    free(more);
  }
  free(one);
  shape_free(s);
}

static void gap_must_leave_room(void **state)
{
  struct shape *s = two_plates(2, 1, 1);
  struct vg_error err = VG_ERROR_INIT;
  double h[18] = { 0 }, allowed[18];

  (void)state;
  grow(s, 1);
  assert_int_equal(vg_clear_ahead(&s->m, &s->c, &s->t, 0, 1, h, allowed, &err),
                   VG_ERR_INPUT);
  assert_int_equal(vg_clear_ahead(&s->m, &s->c, &s->t, NAN, 1, h, allowed,
                                  &err),
                   VG_ERR_INPUT);
  /* A column with requested height 0 gets 0. */
  assert_int_equal(vg_clear_ahead(&s->m, &s->c, &s->t, 0.4, 1, h, allowed,
                                  &err),
                   VG_OK);
  for (size_t i = 0; i < s->c.n_column; i++) assert_true(allowed[i] == 0);
  shape_free(s);
}

static void an_empty_surface(void **state)
{
  struct shape *s = shape_new(1);
  uint8_t bad[1];

  (void)state;
  grow(s, 1);
  assert_int_equal(tops(s, NULL, NULL, 1, bad), 0);
  free(ahead(s, 1, 1));
  shape_free(s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(tops_between_plates),
    cmocka_unit_test(a_front_keeps_its_margin),
    cmocka_unit_test(one_column_through_the_other_front),
    cmocka_unit_test(the_shift_of_a_column_counts),
    cmocka_unit_test(inert_patch_is_in_the_way),
    cmocka_unit_test(cube_grows_outward),
    cmocka_unit_test(tops_that_cross),
    cmocka_unit_test(degenerate_tops_are_bad),
    cmocka_unit_test(fan_of_columns),
    cmocka_unit_test(flanks_in_one_plane),
    cmocka_unit_test(flanks_in_a_noisy_plane),
    cmocka_unit_test(active_columns_only),
    cmocka_unit_test(top_collisions_do_not_depend_on_threads),
    cmocka_unit_test(plates_share_the_gap),
    cmocka_unit_test(patches_to_slide_in),
    cmocka_unit_test(columns_of_one_stack_are_no_limit),
    cmocka_unit_test(sphere_near_a_plane),
    cmocka_unit_test(a_convex_body_has_no_opposite_surface),
    cmocka_unit_test(every_face_in_the_cone_is_found),
    cmocka_unit_test(sharp_edges_face_each_other),
    cmocka_unit_test(concave_wedge_at_right_angles),
    cmocka_unit_test(concave_wedge_with_turned_columns),
    cmocka_unit_test(allowed_heights_do_not_depend_on_threads),
    cmocka_unit_test(gap_must_leave_room),
    cmocka_unit_test(an_empty_surface),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
