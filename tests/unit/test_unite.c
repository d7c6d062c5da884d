/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Unions of boxes with corners on a coarse grid, so that they cross, overlap
 * and touch in every way. Volume and area of the union are sums over grid
 * cells. */
#include "io_support.h"

#include <math.h>

#include "core/geometry/vector.h"
#include "core/surface/surface_check.h"
#include "core/wrap/unite.h"
#include "core/wrap/wrap.h"

#define GRID 6 /* cells of the grid along each axis */
#define MOST 5 /* boxes */

static int needs_cgal(void **state)
{
  (void)state;
  if (vg_wrap_is_available(NULL, 0)) return 0;
  print_message("no vanguard-wrap: skipped\n");
  exit(77);
}

struct box {
  int lo[3], hi[3];
};

/* Add a box as a patch of its own; inverted: with normals inwards. */
static void add_box(struct vg_mesh *m, const struct box *b, double size,
                    int inverted)
{
  static const uint32_t tri[12][3] = { { 0, 2, 3 }, { 0, 3, 1 }, { 4, 5, 7 },
                                       { 4, 7, 6 }, { 0, 1, 5 }, { 0, 5, 4 },
                                       { 2, 6, 7 }, { 2, 7, 3 }, { 0, 4, 6 },
                                       { 0, 6, 2 }, { 1, 3, 7 }, { 1, 7, 5 } };
  const size_t patch = vg_mesh_add_patch(m, (int32_t)m->n_patch + 1, "box");
  const size_t first = m->n_point;

  m->point = realloc(m->point, (first + 8) * sizeof *m->point);
  m->tri = realloc(m->tri, (m->n_tri + 12) * sizeof *m->tri);
  m->tri_patch = realloc(m->tri_patch, (m->n_tri + 12) * sizeof *m->tri_patch);
  for (int i = 0; i < 8; i++)
    for (int k = 0; k < 3; k++)
      m->point[first + (size_t)i][k] = size *
                                       (i >> k & 1 ? b->hi[k] : b->lo[k]);
  m->n_point += 8;
  for (size_t i = 0; i < 12; i++, m->n_tri++) {
    for (int k = 0; k < 3; k++)
      m->tri[m->n_tri][k] = (uint32_t)first + tri[i][inverted ? 2 - k : k];
    m->tri_patch[m->n_tri] = (uint32_t)patch;
  }
}

static int covers(const struct box *b, const int cell[3])
{
  for (int k = 0; k < 3; k++)
    if (cell[k] < b->lo[k] || cell[k] >= b->hi[k]) return 0;
  return 1;
}

static int is_full(const struct box *b, int n, const int cell[3])
{
  for (int i = 0; i < n; i++)
    if (covers(&b[i], cell)) return 1;
  return 0;
}

/* Volume and area of the union in units of the grid. */
static void expect(const struct box *b, int n, double *volume, double *area)
{
  *volume = *area = 0;
  for (int x = -1; x <= GRID; x++)
    for (int y = -1; y <= GRID; y++)
      for (int z = -1; z <= GRID; z++) {
        const int cell[3] = { x, y, z }, own = is_full(b, n, cell);

        *volume += own;
        for (int k = 0; k < 3; k++) {
          int next[3] = { x, y, z };

          next[k]++;
          *area += own != is_full(b, n, next);
        }
      }
}

static void measure(const struct vg_mesh *m, double *volume, double *area)
{
  *volume = *area = 0;
  for (size_t t = 0; t < m->n_tri; t++) {
    const double *p[3];
    double n[3];

    for (int k = 0; k < 3; k++) p[k] = m->point[m->tri[t][k]];
    vg_cross(p[1], p[2], n);
    *volume += vg_dot(p[0], n) / 6;
    *area += vg_triangle_area(p[0], p[1], p[2]);
  }
}

static vg_status unite(struct vg_mesh *m, int subtracts,
                       struct vg_unite_report *u)
{
  struct vg_surface_check_options o = VG_SURFACE_CHECK_OPTIONS_INIT;
  const struct vg_unite_options how = { .subtracts = subtracts };
  struct vg_surface_report r = VG_SURFACE_REPORT_INIT;
  struct vg_error err = VG_ERROR_INIT;
  vg_status st;

  o.external = -1;
  o.keeps_walls = 1;
  assert_int_equal(vg_surface_check(m, &o, &r, &err), VG_OK);
  st = vg_unite(m, &r, &how, u, &err);
  if (st < 0) fail_msg("%s", err.text);
  vg_surface_report_release(&r);
  return st;
}

static void expect_sound(struct vg_mesh *m)
{
  struct vg_surface_check_options o = { .external = -1, .threads = 1 };
  struct vg_surface_report r = VG_SURFACE_REPORT_INIT;
  struct vg_error err = VG_ERROR_INIT;

  assert_int_equal(vg_surface_check(m, &o, &r, &err), VG_OK);
  assert_int_equal(r.count[VG_DEFECT_OPEN_EDGE], 0);
  assert_int_equal(r.count[VG_DEFECT_INTERSECTION], 0);
  vg_surface_report_release(&r);
}

static void crossing_boxes(void **unused)
{
  const struct box a = { { 0, 0, 0 }, { 4, 2, 2 } };
  const struct box b = { { 2, 1, 1 }, { 6, 2, 4 } };
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_unite_report r;
  double volume, area;

  (void)unused;
  add_box(&m, &a, 1, 0);
  add_box(&m, &b, 1, 1); /* shells are turned outwards */
  assert_int_equal(unite(&m, 0, &r), VG_OK);
  expect_sound(&m);
  measure(&m, &volume, &area);
  assert_float_equal(volume, 26, 1e-12);
  assert_int_equal(r.n_shell, 2);
  assert_int_equal(r.n_set, 1);
  assert_int_equal(r.n_before, 24);
  assert_int_equal(r.n_after, m.n_tri);
  assert_false(r.is_ambiguous);
  assert_int_equal(m.n_patch, 2);
  vg_mesh_release(&m);
}

/* Shells that meet nothing stay as they are, whatever is around them. */
static void others_stay(void **unused)
{
  const struct box room = { { -9, -9, -9 }, { 9, 9, 9 } };
  const struct box a = { { 0, 0, 0 }, { 2, 2, 2 } };
  const struct box b = { { 1, 1, 1 }, { 3, 3, 3 } };
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_unite_report r;
  double volume, area;

  (void)unused;
  add_box(&m, &room, 1, 0);
  assert_int_equal(unite(&m, 0, &r), VG_BLOCKED);
  assert_int_equal(m.n_tri, 12);
  add_box(&m, &a, 1, 0);
  add_box(&m, &b, 1, 0);
  assert_int_equal(unite(&m, 0, &r), VG_OK);
  measure(&m, &volume, &area);
  assert_float_equal(volume, 18. * 18 * 18 + 15, 1e-9);
  assert_int_equal(r.n_after, m.n_tri - 12);
  vg_mesh_release(&m);
}

/* A house sunk into the floor of a tunnel. */
static void house_in_a_tunnel(void **unused)
{
  const struct box tunnel = { { 0, 0, 0 }, { 60, 30, 30 } };
  const struct box house = { { 20, 10, -1 }, { 30, 20, 9 } };
  double volume, area;

  (void)unused;
  for (int subtracts = 0; subtracts < 2; subtracts++) {
    struct vg_mesh m = VG_MESH_INIT;
    struct vg_unite_report r;

    add_box(&m, &house, 0.1, 0);
    add_box(&m, &tunnel, 0.1, 0);
    assert_int_equal(unite(&m, subtracts, &r), VG_OK);
    assert_true(subtracts || r.is_ambiguous);
    expect_sound(&m);
    measure(&m, &volume, &area);
    assert_float_equal(volume, subtracts ? 53.1 : 54.1, 1e-9);
    vg_mesh_release(&m);
  }
}

/* Open shells and shells that intersect themselves are left alone. */
static void refuses_faulty_shells(void **unused)
{
  const struct box a = { { 0, 0, 0 }, { 2, 2, 2 } };
  const struct box b = { { 1, 1, 1 }, { 3, 3, 3 } };

  (void)unused;
  for (int fault = 0; fault < 2; fault++) {
    struct vg_mesh m = VG_MESH_INIT;
    struct vg_unite_report r;

    add_box(&m, &a, 1, 0);
    add_box(&m, &b, 1, 0);
    if (fault) { /* a corner through the opposite face */
      m.point[7][0] = m.point[7][1] = 1;
      m.point[7][2] = -1;
    } else m.n_tri--;
    assert_int_equal(unite(&m, 0, &r), VG_BLOCKED);
    assert_int_equal(m.n_tri, fault ? 24 : 23);
    vg_mesh_release(&m);
  }
}

static int draw(uint64_t *state, int n)
{
  *state = *state * 6364136223846793005u + 1442695040888963407u;
  return (int)((*state >> 33) % (uint64_t)n);
}

static void random_search(void **unused)
{
  uint64_t state = 20261129;
  int n_done = 0;

  (void)unused;
  for (int run = 0; run < 300; run++) {
    const double size = run % 2 ? 1 : 0.1; /* 0.1: corners are rounded */
    const int n = 2 + draw(&state, MOST - 1);
    struct vg_mesh m = VG_MESH_INIT;
    struct vg_unite_report r;
    double volume[2], area[2];
    struct box b[MOST];

    for (int i = 0; i < n; i++) {
      for (int k = 0; k < 3; k++) {
        b[i].lo[k] = draw(&state, GRID - 1);
        b[i].hi[k] = b[i].lo[k] + 1 + draw(&state, GRID - b[i].lo[k]);
        if (b[i].hi[k] > GRID) b[i].hi[k] = GRID;
      }
      add_box(&m, &b[i], size, draw(&state, 2));
    }
    if (unite(&m, 0, &r) == VG_OK) {
      expect(b, n, &volume[0], &area[0]);
      measure(&m, &volume[1], &area[1]);
      /* Boxes inside others that they do not touch remain. */
      if (r.n_shell == (size_t)n && r.n_set == 1) {
        assert_float_equal(volume[1], volume[0] * size * size * size, 1e-9);
        assert_float_equal(area[1], area[0] * size * size, 1e-9);
        n_done++;
      }
    }
    vg_mesh_release(&m);
  }
  assert_in_range(n_done, 100, 300);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(crossing_boxes),
    cmocka_unit_test(others_stay),
    cmocka_unit_test(house_in_a_tunnel),
    cmocka_unit_test(refuses_faulty_shells),
    cmocka_unit_test(random_search),
  };

  return cmocka_run_group_tests(tests, needs_cgal, NULL);
}
