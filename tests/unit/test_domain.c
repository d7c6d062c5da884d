/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "ball_support.h"
#include "core/domain/farfield.h"
#include "core/domain/planar.h"
#include "core/domain/project.h"
#include "core/surface/surface_check.h"
#include "io/vgrid/vgrid.h"

struct side {
  uint32_t a, b;
};

static int side_compare(const void *pa, const void *pb)
{
  const struct side *x = pa, *y = pb;

  if (x->a != y->a) return x->a < y->a ? -1 : 1;
  return x->b < y->b ? -1 : x->b > y->b;
}

/* Every directed edge occurs once, and so does its reverse; every point is
 * used. */
static void check_closed(const struct vg_mesh *m)
{
  struct side *list = malloc(3 * m->n_tri * sizeof *list);
  char *used = calloc(m->n_point, 1);

  for (size_t i = 0; i < 3 * m->n_tri; i++) {
    list[i].a = m->tri[i / 3][i % 3];
    list[i].b = m->tri[i / 3][(i + 1) % 3];
    used[list[i].a] = 1;
  }
  qsort(list, 3 * m->n_tri, sizeof *list, side_compare);
  for (size_t i = 0; i < 3 * m->n_tri; i++) {
    const struct side back = { list[i].b, list[i].a };

    if (i) assert_true(side_compare(&list[i - 1], &list[i]) < 0);
    assert_non_null(
      bsearch(&back, list, 3 * m->n_tri, sizeof *list, side_compare));
  }
  for (size_t i = 0; i < m->n_point; i++) assert_true(used[i]);
  free(list);
  free(used);
}

/* Volume enclosed, positive if the normals point into it. */
static double volume(const struct vg_mesh *m)
{
  double sum = 0;

  for (size_t i = 0; i < m->n_tri; i++) {
    const double *a = m->point[m->tri[i][0]], *b = m->point[m->tri[i][1]],
                 *c = m->point[m->tri[i][2]];

    sum -= a[0] * (b[1] * c[2] - b[2] * c[1]) +
           a[1] * (b[2] * c[0] - b[0] * c[2]) +
           a[2] * (b[0] * c[1] - b[1] * c[0]);
  }
  return sum / 6;
}

static double angle_min_deg(const struct vg_mesh *m)
{
  double least = 180;

  for (size_t i = 0; i < m->n_tri; i++)
    for (int k = 0; k < 3; k++) {
      const double *a = m->point[m->tri[i][k]],
                   *b = m->point[m->tri[i][(k + 1) % 3]],
                   *c = m->point[m->tri[i][(k + 2) % 3]];
      double uu = 0, vv = 0, uv = 0;

      for (int j = 0; j < 3; j++) {
        uu += (b[j] - a[j]) * (b[j] - a[j]);
        vv += (c[j] - a[j]) * (c[j] - a[j]);
        uv += (b[j] - a[j]) * (c[j] - a[j]);
      }
      least = fmin(least, acos(uv / sqrt(uu * vv)) * 180 / 3.14159265358979);
    }
  return least;
}

static const double origin[3] = { 0, 0, 0 };

static int counts_down(void *user)
{
  size_t *left = user;

  return *left == 0 || --*left == 0;
}

static struct vg_sizing *field(const struct vg_mesh *m, double growth)
{
  struct vg_sizing_options o = VG_SIZING_OPTIONS_INIT;
  struct vg_sizing *s = NULL;
  struct vg_error err = VG_ERROR_INIT;

  o.growth = growth;
  assert_int_equal(vg_sizing_new(&o, 0, NULL, m, &s, &err), VG_OK);
  return s;
}

static void makes_even_spheres(void **state)
{
  (void)state;
  for (int n = 4; n <= 40; n *= 3) {
    struct vg_mesh m = ball(origin, -1, 1.0 / n);
    /* equilateral triangles of edge h on a sphere */
    const double want = 4 * 3.14159265 * n * n / (0.4330127);

    check_closed(&m);
    assert_true((double)m.n_tri > 0.9 * want && (double)m.n_tri < 1.15 * want);
    assert_true(angle_min_deg(&m) > 30);
    for (size_t i = 0; i < m.n_point; i++) {
      const double *x = m.point[i];

      assert_true(fabs(x[0] * x[0] + x[1] * x[1] + x[2] * x[2] - 1) < 1e-14);
    }
    assert_true(volume(&m) < 0); /* normals outward */
    vg_mesh_release(&m);
  }
}

static void puts_a_sphere_around_a_body(void **state)
{
  struct vg_mesh m = ball(origin, -1, 0.1);
  const size_t n_point = m.n_point, n_tri = m.n_tri;
  struct vg_sizing *s = field(&m, 1.2);
  struct vg_farfield far = VG_FARFIELD_INIT;
  struct vg_domain_report report;
  struct vg_error err = VG_ERROR_INIT;
  double first[3];

  (void)state;
  memcpy(first, m.point[17], sizeof first);
  far.lengths = 10;
  assert_int_equal(vg_domain_complete(&m, &far, s, &report, &err), VG_OK);
  check_closed(&m);
  assert_true(report.added_farfield && !report.added_symmetry);
  assert_int_equal(report.n_added_tri, m.n_tri - n_tri);
  assert_memory_equal(first, m.point[17], sizeof first);
  /* chords lose about 1 - 3/20 h^2/R^2 of the volume; h is 4 of R = 20 */
  assert_true(volume(&m) > 0.95 * 4.18879 * 8000);
  assert_true(volume(&m) < 4.18879 * 8000);
  assert_int_equal(m.n_patch, 2);
  assert_int_equal(m.patch[1].id, 8);
  assert_string_equal(m.patch[1].name, "farfield");
  assert_int_equal(m.patch[1].bc, 3);
  assert_int_equal(m.patch[1].bc_fun3d, 5000);
  assert_true(m.n_point > n_point + 100);
  vg_sizing_free(s);
  vg_mesh_release(&m);
}

static void puts_a_box_around_a_body(void **state)
{
  struct vg_mesh m = ball(origin, -1, 0.1);
  struct vg_sizing *s = field(&m, 1.2);
  struct vg_farfield far = { .kind = VG_FARFIELD_BOX,
                             .lo = { -9, -5, -4 },
                             .hi = { 7, 5, 4 },
                             .has_box = 1,
                             .spacing = 0.8 };
  struct vg_error err = VG_ERROR_INIT;
  double body, lo[3], hi[3];

  (void)state;
  far.lengths = 1;
  body = -volume(&m);
  assert_int_equal(vg_domain_complete(&m, &far, s, NULL, &err), VG_OK);
  check_closed(&m);
  assert_true(fabs(volume(&m) - (16 * 10 * 8 - body)) < 1e-9);
  vg_mesh_bounds(&m, lo, hi);
  assert_memory_equal(lo, far.lo, sizeof lo);
  assert_memory_equal(hi, far.hi, sizeof hi);
  assert_true(angle_min_deg(&m) > 30);
  vg_sizing_free(s);
  vg_mesh_release(&m);
}

static void completes_half_bodies(void **state)
{
  (void)state;
  for (int half = 0; half < 6; half++)
    for (int kind = VG_FARFIELD_SPHERE; kind <= VG_FARFIELD_BOX; kind++) {
      struct vg_mesh m = ball(origin, half, 0.1);
      struct vg_sizing *s;
      struct vg_farfield far = VG_FARFIELD_INIT;
      struct vg_domain_report report;
      struct vg_error err = VG_ERROR_INIT;
      const double body = -volume(&m);
      size_t n_in_plane = 0;

      /* a plane with rounding errors, and not at zero */
      for (size_t i = 0; i < m.n_point; i++)
        m.point[i][half / 2] += 3 + (i % 3 ? 0 : 1e-12);
      s = field(&m, 1.2);
      far.kind = kind;
      far.size = 20;
      assert_int_equal(vg_domain_complete(&m, &far, s, &report, &err), VG_OK);
      check_closed(&m);
      assert_true(report.added_symmetry);
      assert_int_equal(report.symmetry_axis, half / 2);
      if (kind == VG_FARFIELD_BOX)
        assert_true(fabs(volume(&m) - (40 * 40 * 20 - body)) < 1e-7);
      else assert_true(volume(&m) > 0.94 * 16755.2);
      assert_true(angle_min_deg(&m) > 30);
      for (size_t i = 0; i < m.n_tri; i++) {
        const struct vg_patch *p = &m.patch[m.tri_patch[i]];

        if (strcmp(p->name, "symmetry")) continue;
        n_in_plane++;
        assert_int_equal(p->bc, 1);
        assert_int_equal(p->bc_fun3d, 6661 + half / 2);
        for (int k = 0; k < 3; k++)
          assert_true(m.point[m.tri[i][k]][half / 2] == report.symmetry_at);
      }
      assert_true(n_in_plane > 100);
      vg_sizing_free(s);
      vg_mesh_release(&m);
    }
}

/* A body open at x[axis] = at: half a ball stretched by the factor `deep`. Its
 * rim has `rim` of its radius and widens over half of the depth. */
static struct vg_mesh open_body(int axis, double deep, double rim, double at)
{
  struct vg_mesh m = ball(origin, 2 * axis + 1, 0.1);

  for (size_t i = 0; i < m.n_point; i++) {
    double *x = m.point[i], t = 2 * x[axis];

    for (int k = 0; k < 3; k++)
      if (k != axis) x[k] *= t < 1 ? rim + (1 - rim) * t : 1;
    x[axis] = x[axis] * deep + at;
  }
  return m;
}

static vg_status completed(int axis, double deep, double rim, double at,
                           int symmetry)
{
  struct vg_mesh m = open_body(axis, deep, rim, at);
  struct vg_farfield far = VG_FARFIELD_INIT;
  struct vg_sizing *s = field(&m, 1.4);
  struct vg_error err = VG_ERROR_INIT;
  vg_status st;
  double cut;
  int half;

  assert_int_equal(vg_domain_half(&m, 0, &half, &cut, &err), VG_OK);
  far.symmetry = symmetry;
  st = vg_domain_complete(&m, &far, s, NULL, &err);
  if (st < 0) assert_non_null(strstr(err.text, "a hole"));
  if (!symmetry) assert_int_equal(half, st < 0 ? -1 : axis);
  if (half >= 0) assert_true(cut == at);
  vg_sizing_free(s);
  vg_mesh_release(&m);
  return st;
}

static void a_hole_is_not_a_symmetry_plane(void **state)
{
  (void)state;
  for (int axis = 0; axis < 3; axis++) {
    /* a rim of a third of the body, and a wide one on a blunt body */
    assert_int_equal(completed(axis, 1, 0.3, 0, 0), VG_ERR_GEOMETRY);
    assert_int_equal(completed(axis, 0.5, 0.6, 0, 0), VG_ERR_GEOMETRY);
    assert_int_equal(completed(axis, 1, 0.3, 0, 1), VG_OK);
    /* steep and wide, but deep, as a tube without its base would be */
    assert_int_equal(completed(axis, 4, 1, 3, 0), VG_ERR_GEOMETRY);
    assert_int_equal(completed(axis, 4, 1, 3, 1), VG_OK);
    assert_int_equal(completed(axis, 4, 1, 0, 0),
                     axis ? VG_OK : VG_ERR_GEOMETRY);
    assert_int_equal(completed(axis, 1, 1, 3, 0), VG_OK);
    assert_int_equal(completed(axis, 1, 1, 3, -1), VG_ERR_GEOMETRY);
  }
}

static void drop_unused(struct vg_mesh *m)
{
  uint32_t *to = calloc(m->n_point, sizeof *to), n = 0;

  for (size_t i = 0; i < 3 * m->n_tri; i++) to[m->tri[i / 3][i % 3]] = 1;
  for (size_t i = 0; i < m->n_point; i++) {
    if (!to[i]) continue;
    memmove(m->point[n], m->point[i], sizeof *m->point);
    to[i] = n++;
  }
  for (size_t i = 0; i < 3 * m->n_tri; i++)
    m->tri[i / 3][i % 3] = to[m->tri[i / 3][i % 3]];
  m->n_point = n;
  free(to);
}

/* Remove the triangles that reach beyond `at` along an axis, on one side, and
 * move the rim into that plane. */
static void cut_end(struct vg_mesh *m, int axis, int side, double at)
{
  size_t n = 0;

  for (size_t i = 0; i < m->n_tri; i++) {
    int beyond = 0;

    for (int k = 0; k < 3; k++)
      beyond += side * (m->point[m->tri[i][k]][axis] - at) > 0;
    for (int k = 0; k < 3 && beyond; k++) {
      double *x = m->point[m->tri[i][k]];

      if (side * (x[axis] - at) <= 0) x[axis] = at;
    }
    if (!beyond) memcpy(m->tri[n++], m->tri[i], sizeof *m->tri);
  }
  m->n_tri = n;
  drop_unused(m);
}

static vg_status close_holes(struct vg_mesh *m, int symmetry, size_t *n_hole)
{
  struct vg_sizing *s = field(m, 1.4);
  struct vg_error err = VG_ERROR_INIT;
  struct vg_cap_report r;
  size_t n_before = m->n_tri;
  vg_status st = vg_domain_close_holes(m, symmetry, s, &r, &err);

  *n_hole = r.n;
  assert_true(r.n_curved <= r.n);
  assert_int_equal(m->n_tri, n_before + (st < 0 ? 0 : r.n_tri));
  if (st < 0) assert_non_null(strstr(err.text, "the hole at"));
  vg_sizing_free(s);
  return st;
}

static void closes_holes_but_not_half_bodies(void **state)
{
  struct vg_mesh m = ball(origin, -1, 0.1);
  double whole = -volume(&m);
  size_t n;

  (void)state;
  assert_int_equal(close_holes(&m, 0, &n), VG_OK);
  assert_int_equal(n, 0);
  cut_end(&m, 2, 1, 0.95);
  cut_end(&m, 0, -1, -0.9);
  assert_int_equal(close_holes(&m, 0, &n), VG_OK);
  assert_int_equal(n, 2);
  check_closed(&m);
  assert_int_equal(m.n_patch, 3);
  assert_string_equal(m.patch[1].name, "cap_1");
  assert_string_equal(m.patch[2].name, "cap_2");
  assert_int_equal(m.patch[2].bc, VG_BC_NONE);
  assert_true(-volume(&m) > 0.95 * whole && -volume(&m) < whole);
  vg_mesh_release(&m);
  m = ball(origin, -1, 0.1); /* open at both ends: no half model */
  cut_end(&m, 1, 1, 0.3);
  cut_end(&m, 1, -1, -0.3);
  assert_int_equal(close_holes(&m, 0, &n), VG_OK);
  assert_int_equal(n, 2);
  check_closed(&m);
  vg_mesh_release(&m);
  m = ball(origin, 5, 0.1); /* half a ball with a hole at its end */
  cut_end(&m, 2, 1, 0.95);
  assert_int_equal(close_holes(&m, 1, &n), VG_OK);
  assert_int_equal(n, 1);
  assert_int_equal(close_holes(&m, 0, &n), VG_OK);
  assert_int_equal(n, 0);
  assert_int_equal(close_holes(&m, -1, &n), VG_OK);
  assert_int_equal(n, 1);
  check_closed(&m);
  vg_mesh_release(&m);
  m = ball(origin, 5, 0.1); /* a section that is open at both ends */
  cut_end(&m, 2, 1, 0.95);
  assert_int_equal(close_holes(&m, 0, &n), VG_OK);
  assert_int_equal(n, 2);
  check_closed(&m);
  vg_mesh_release(&m);
  m = open_body(0, 1, 0.3, 0);
  assert_int_equal(close_holes(&m, 1, &n), VG_OK);
  assert_int_equal(n, 0);
  assert_int_equal(close_holes(&m, 0, &n), VG_OK);
  assert_int_equal(n, 1);
  vg_mesh_release(&m);
  m = ball(origin, -1, 0.1);
  cut_end(&m, 2, 1, 0.9);
  for (size_t i = 0; i < m.n_point; i++)
    m.point[i][2] += 0.5 * m.point[i][1] * m.point[i][1];
  assert_int_equal(close_holes(&m, 0, &n), VG_OK); /* a curved rim */
  assert_int_equal(n, 1);
  check_closed(&m);
  vg_mesh_release(&m);
}

/* A quarter of a ball: the rim lies in two planes, and each gets
 * a cap of its own. */
static void closes_a_rim_in_two_planes(void **state)
{
  struct vg_mesh m = ball(origin, 5, 0.1);
  double quarter = -volume(&m) / 2;
  size_t n;

  (void)state;
  cut_end(&m, 0, 1, 0);
  assert_int_equal(close_holes(&m, -1, &n), VG_OK);
  assert_int_equal(n, 2);
  check_closed(&m);
  assert_string_equal(m.patch[m.n_patch - 1].name, "cap_2");
  quarter /= -volume(&m);
  assert_true(quarter > 0.9 && quarter < 1.1);
  vg_mesh_release(&m);
}

/* An eighth of a ball, such as half a hull without deck and transom. The rim is
 * curved in one case, so that none of the other two planes is exact. */
static void closes_a_rim_in_three_planes(void **state)
{
  (void)state;
  for (int is_curved = 0; is_curved < 2; is_curved++) {
    struct vg_mesh m = ball(origin, 5, 0.1);
    double eighth = -volume(&m) / 4;
    size_t n;

    cut_end(&m, 0, 1, 0);
    cut_end(&m, 1, 1, 0);
    for (size_t i = 0; i < m.n_point && is_curved; i++)
      m.point[i][0] += 0.1 * m.point[i][1] * m.point[i][2];
    assert_int_equal(close_holes(&m, -1, &n), VG_OK);
    assert_int_equal(n, 3);
    check_closed(&m);
    assert_string_equal(m.patch[m.n_patch - 1].name, "cap_3");
    eighth /= -volume(&m);
    assert_true(eighth > 0.8 && eighth < 1.2);
    vg_mesh_release(&m);
  }
}

/* Sides of a box of n^2 squares each, without those named by the bits of
 * `missing` (1: low x, 2: high x, ...), turned so that no side is normal to an
 * axis if is_turned is set. */
static struct vg_mesh open_box(int n, unsigned missing, int is_turned)
{
  static const double size[3] = { 2, 1, 0.7 };
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  size_t n_merged, n_dropped;

  assert_true(vg_mesh_add_patch(&m, 1, "box") == 0);
  m.point = malloc((size_t)(24 * n * n) * sizeof *m.point);
  m.tri = malloc((size_t)(12 * n * n) * sizeof *m.tri);
  m.tri_patch = calloc((size_t)(12 * n * n), sizeof *m.tri_patch);
  assert_true(m.point && m.tri && m.tri_patch);
  for (int side = 0; side < 6; side++)
    for (int i = 0; i < n * n && !(missing >> side & 1); i++) {
      const int axis = side / 2, is_high = side % 2;
      const uint32_t first = (uint32_t)m.n_point;

      for (int k = 0; k < 4; k++) {
        double *x = m.point[m.n_point++], old[3];

        x[axis] = is_high;
        x[(axis + 1) % 3] = (double)(i / n + (k == 1 || k == 2)) / n;
        x[(axis + 2) % 3] = (double)(i % n + (k > 1)) / n;
        for (int d = 0; d < 3; d++) x[d] *= size[d];
        if (!is_turned) continue;
        memcpy(old, x, sizeof old);
        x[0] = 0.8 * old[0] - 0.6 * old[1];
        x[1] = 0.28 * (0.6 * old[0] + 0.8 * old[1]) - 0.96 * old[2];
        x[2] = 0.96 * (0.6 * old[0] + 0.8 * old[1]) + 0.28 * old[2];
      }
      for (uint32_t k = 1; k < 3; k++) {
        uint32_t *v = m.tri[m.n_tri++];

        v[0] = first;
        v[1] = first + (is_high ? k : k + 1);
        v[2] = first + (is_high ? k + 1 : k);
      }
    }
  assert_int_equal(vg_surface_weld(&m, 1e-9, &n_merged, &n_dropped, &err),
                   VG_OK);
  return m;
}

/* Two or three missing sides of a box have a common rim in that many planes of
 * any orientation. */
static void closes_missing_sides_of_a_box(void **state)
{
  static const unsigned missing[] = { 2 | 8, 1 | 32, 2 | 8 | 32, 1 | 4 | 16 };

  (void)state;
  for (int i = 0; i < 16; i++) {
    const unsigned sides = missing[i % 4];
    struct vg_mesh m = open_box(i / 8 ? 5 : 1, sides, i / 4 % 2);
    size_t n;

    assert_int_equal(close_holes(&m, -1, &n), VG_OK);
    assert_int_equal(n, i % 4 < 2 ? 2 : 3);
    check_closed(&m);
    assert_true(fabs(fabs(volume(&m)) - 1.4) < 1e-9);
    vg_mesh_release(&m);
  }
}

static void copy_shifted(struct vg_mesh *to, const struct vg_mesh *from,
                         double dx)
{
  struct vg_mesh both = VG_MESH_INIT;
  const size_t np = to->n_point, nt = to->n_tri;

  both.n_point = np + from->n_point;
  both.n_tri = nt + from->n_tri;
  both.point = malloc(both.n_point * sizeof *both.point);
  both.tri = malloc(both.n_tri * sizeof *both.tri);
  both.tri_patch = calloc(both.n_tri, sizeof *both.tri_patch);
  for (size_t i = 0; i < both.n_point; i++) {
    memcpy(both.point[i], i < np ? to->point[i] : from->point[i - np],
           sizeof *both.point);
    if (i >= np) both.point[i][0] += dx;
  }
  for (size_t i = 0; i < both.n_tri; i++)
    for (int k = 0; k < 3; k++)
      both.tri[i][k] = i < nt ? to->tri[i][k]
                              : from->tri[i - nt][k] + (uint32_t)np;
  vg_mesh_add_patch(&both, 1, "bodies");
  vg_mesh_move(to, &both);
}

static void takes_several_bodies(void **state)
{
  struct vg_mesh m = ball(origin, 3, 0.2), other = ball(origin, 3, 0.1),
                 free_body;
  struct vg_sizing *s;
  struct vg_farfield far = VG_FARFIELD_INIT;
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  free_body = ball(origin, -1, 0.15);
  for (size_t i = 0; i < free_body.n_point; i++) free_body.point[i][1] += 3;
  copy_shifted(&m, &other, 2.5);
  copy_shifted(&m, &free_body, 1);
  s = field(&m, 1.2);
  far.spacing = 6;
  assert_int_equal(vg_domain_complete(&m, &far, s, NULL, &err), VG_OK);
  check_closed(&m);
  assert_true(angle_min_deg(&m) > 30);
  vg_sizing_free(s);
  vg_mesh_release(&m);
  vg_mesh_release(&other);
  vg_mesh_release(&free_body);
}

static void refuses(struct vg_mesh m, const struct vg_farfield *far,
                    vg_status want, const char *word)
{
  struct vg_sizing *s = field(&m, 1.2);
  struct vg_error err = VG_ERROR_INIT;
  const size_t n = m.n_tri, n_point = m.n_point;

  assert_int_equal(vg_domain_complete(&m, far, s, NULL, &err), want);
  assert_int_equal(err.code, want);
  if (!strstr(err.text, word)) fail_msg("%s", err.text);
  assert_int_equal(m.n_tri, n);
  assert_int_equal(m.n_point, n_point);
  vg_sizing_free(s);
  vg_mesh_release(&m);
}

/* Without a farfield the surface is a half domain. */
static void adds_a_symmetry_plane_alone(void **state)
{
  struct vg_farfield none = VG_FARFIELD_INIT;
  struct vg_mesh m = ball(origin, 2, 0.3);
  struct vg_sizing *s = field(&m, 1.2);
  struct vg_domain_report r;
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  none.kind = VG_FARFIELD_NONE;
  none.symmetry = 1;
  assert_int_equal(vg_domain_complete(&m, &none, s, &r, &err), VG_OK);
  assert_true(r.added_symmetry && !r.added_farfield);
  assert_int_equal(m.n_patch, 2);
  assert_string_equal(m.patch[1].name, "symmetry");
  check_closed(&m);
  vg_sizing_free(s);
  vg_mesh_release(&m);
}

static void refuses_half_bodies_it_cannot_complete(void **state)
{
  struct vg_farfield far = VG_FARFIELD_INIT, small = VG_FARFIELD_INIT,
                     nowhere = VG_FARFIELD_INIT;
  struct vg_mesh m = ball(origin, -1, 0.3);

  (void)state;
  m.n_tri--; /* a hole in the middle of the surface */
  refuses(m, &far, VG_ERR_GEOMETRY, "open edges");
  small.size = 1.02;
  refuses(ball(origin, -1, 0.3), &small, VG_ERR_GEOMETRY,
          "inside the farfield");
  small.kind = VG_FARFIELD_BOX;
  small.size = 0.9;
  refuses(ball(origin, 3, 0.3), &small, VG_ERR_GEOMETRY, "inside the farfield");
  nowhere.lengths = NAN;
  refuses(ball(origin, -1, 0.3), &nowhere, VG_ERR_INPUT, "positive");
  m = ball(origin, -1, 0.3);
  for (size_t i = 0; i < m.n_tri; i++) {
    const uint32_t v = m.tri[i][0];

    m.tri[i][0] = m.tri[i][1];
    m.tri[i][1] = v;
  }
  refuses(m, &far, VG_ERR_INPUT, "into the body");
  m = ball(origin, 3, 0.3);
  for (size_t i = 0; i < m.n_point; i++) /* bulges through its plane */
    if (m.point[i][1] > 0.9) m.point[i][1] = -0.2;
  refuses(m, &far, VG_ERR_GEOMETRY, "plane");
}

/* --- projects of planar patches ------------------------------------------ */

/* VGRID's own example: a cube of half width 10, eight nodal sources, spacing 1
 * at the corners with y = -10 and 2 at those with y = +10. */
static void box_project(struct vg_project *p)
{
  static const int32_t line[12][2] = { { 1, 2 }, { 2, 3 }, { 4, 3 }, { 1, 4 },
                                       { 5, 6 }, { 7, 6 }, { 8, 7 }, { 5, 8 },
                                       { 1, 5 }, { 2, 6 }, { 3, 7 }, { 4, 8 } };
  static const int32_t loop[6][4] = { { 2, -3, -4, 1 },  { 8, 7, 6, -5 },
                                      { 9, 5, -10, -1 }, { 11, -7, -12, 3 },
                                      { 4, 12, -8, -9 }, { -6, -11, -2, 10 } };
  static const double corner[8][3] = { { -10, -10, -10 }, { 10, -10, -10 },
                                       { 10, 10, -10 },   { -10, 10, -10 },
                                       { -10, -10, 10 },  { 10, -10, 10 },
                                       { 10, 10, 10 },    { -10, 10, 10 } };

  memset(p, 0, sizeof *p);
  p->ifact = p->vfact = 1;
  p->n_point = p->n_source = 8;
  p->n_curve = 12;
  p->n_shape = 6;
  p->point = malloc(sizeof corner);
  memcpy(p->point, corner, sizeof corner);
  p->curve = calloc(12, sizeof *p->curve);
  p->shape = calloc(6, sizeof *p->shape);
  p->source = calloc(8, sizeof *p->source);
  for (int i = 0; i < 8; i++) {
    p->source[i].kind = VG_SOURCE_VGRID_NODE;
    memcpy(p->source[i].p0, corner[i], sizeof corner[i]);
    p->source[i].h0 = p->source[i].h1 = corner[i][1] < 0 ? 1 : 2;
    p->source[i].an = 1;
  }
  for (int i = 0; i < 12; i++) {
    p->curve[i].id = i + 1;
    p->curve[i].n = 2;
    p->curve[i].point = malloc(2 * sizeof(uint32_t));
    for (int k = 0; k < 2; k++) p->curve[i].point[k] = (uint32_t)line[i][k] - 1;
  }
  for (int i = 0; i < 6; i++) {
    p->shape[i].patch.id = i + 1;
    p->shape[i].n = 4;
    p->shape[i].curve = malloc(4 * sizeof(int32_t));
    memcpy(p->shape[i].curve, loop[i], sizeof loop[i]);
  }
}

static void marches_curves_as_vgrid_does(void **state)
{
  /* x along the first curve, from the .front that VGRID 3.6 wrote */
  static const double want[] = {
    -8.99999999417,  -7.99415543241, -6.97124623625, -5.92181255177,
    -4.83944148672,  -3.72168279456, -2.57037271621, -1.39130717951,
    -0.193415334438, 1.01231161176,  2.21395079804,  3.39981088209,
    4.55969946316,   5.68629598072,  6.77640351223,  7.83164467197,
    8.55442978131,   9.27721489066
  };
  struct vg_project p;
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  box_project(&p);
  assert_int_equal(vg_project_surface(&p, NULL, NULL, &m, &err), VG_OK);
  for (int i = 0; i < 8; i++)
    assert_memory_equal(m.point[i], p.point[i], sizeof m.point[i]);
  for (int i = 0; i < 18; i++)
    /* VGRID stays 1e-8 away from its sources and prints 12 digits */
    assert_true(fabs(m.point[8 + i][0] - want[i]) < 1e-6);
  assert_true(m.point[26][0] == 10 && m.point[26][1] != -10);
  vg_mesh_release(&m);
  vg_project_release(&p);
}

static void meshes_a_project_of_planes(void **state)
{
  struct vg_project p;
  struct vg_sizing *s = NULL;
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_sizing_options o = VG_SIZING_OPTIONS_INIT;
  struct vg_error err = VG_ERROR_INIT;
  size_t n_off = 0, n_floor = 0;

  (void)state;
  box_project(&p);
  assert_int_equal(vg_sizing_new(&o, p.n_source, p.source, NULL, &s, &err),
                   VG_OK);
  assert_int_equal(vg_project_surface(&p, s, NULL, &m, &err), VG_OK);
  check_closed(&m);
  assert_true(fabs(volume(&m) - 8000) < 1e-8);
  assert_true(angle_min_deg(&m) > 30);
  for (size_t i = 0; i < m.n_point; i++) {
    const double *x = m.point[i];

    n_off += fabs(x[0]) != 10 && fabs(x[1]) != 10 && fabs(x[2]) != 10;
  }
  assert_int_equal(n_off, 0);
  for (size_t i = 0; i < m.n_tri; i++) n_floor += m.tri_patch[i] == 2;
  /* VGRID has 574 there, the only patch whose boundary has no layers; its edges
   * are slightly longer than the spacing */
  assert_true(n_floor > 520 && n_floor < 720);
  vg_sizing_free(s);
  vg_mesh_release(&m);
  vg_project_release(&p);
}

/* The original input file of VGRID. Its .front has 3,407 points, but also layer
 * lines on four patches, which this mesh lacks. */
static void meshes_the_box_of_vgrid(void **state)
{
  const char *path = VG_DATA_DIR "/vgrid_box/box.d3m";
  struct vg_project p = VG_PROJECT_INIT;
  struct vg_mesh m = VG_MESH_INIT, front = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  size_t n_same = 0;
  FILE *f = fopen(path, "rb");

  (void)state;
  if (!f) {
    print_message("VG_DATA_DIR has no vgrid_box/box.d3m: skipped "
                  "(verification/fetch.md has the sources)\n");
    skip();
  }
  fclose(f);
  assert_int_equal(vg_d3m_read(path, &p, &err), VG_OK);
  assert_int_equal(vg_project_surface(&p, NULL, NULL, &m, &err), VG_OK);
  check_closed(&m);
  assert_true(fabs(volume(&m) - 8000) < 1e-8);
  assert_int_equal(m.n_patch, 6);
  assert_true(m.n_tri > 2400 && m.n_tri < 3200);
  /* curves without layers are equal to VGRID's: 8 corners, 18 points on each
   * edge around the floor, 10 on each around the ceiling */
  assert_int_equal(vg_front_read(VG_DATA_DIR "/vgrid_box/box.front", NULL,
                                 &front, &err),
                   VG_OK);
  for (size_t i = 0; i < 300 && i < front.n_point; i++)
    for (size_t k = 0; k < 300; k++)
      if (fabs(front.point[i][0] - m.point[k][0]) < 1e-6 &&
          fabs(front.point[i][1] - m.point[k][1]) < 1e-6 &&
          fabs(front.point[i][2] - m.point[k][2]) < 1e-6)
        n_same++;
  assert_int_equal(n_same, 120);
  vg_mesh_release(&front);
  vg_mesh_release(&m);
  vg_project_release(&p);
}

/* A square plate whose sides are chains of many points, in an oblique plane. It
 * is so small relative to the spacing that every side is one edge. */
static void keeps_corners_of_chains(void **state)
{
  struct vg_project p = VG_PROJECT_INIT;
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_stop stop;
  struct vg_error err = VG_ERROR_INIT;
  double h = 0.21, area = 0;
  size_t n_asked = SIZE_MAX;

  (void)state;
  p.n_point = 41;
  p.n_curve = p.n_shape = p.n_source = 1;
  p.point = calloc(41, sizeof *p.point);
  p.curve = calloc(1, sizeof *p.curve);
  p.shape = calloc(1, sizeof *p.shape);
  p.source = calloc(1, sizeof *p.source);
  p.curve->point = malloc(41 * sizeof(uint32_t));
  p.shape->curve = malloc(sizeof(int32_t));
  p.curve->id = p.shape->curve[0] = 1;
  p.shape->n = 1;
  p.curve->n = 41;
  p.source->kind = VG_SOURCE_VGRID_NODE;
  p.source->an = 1;
  p.source->h0 = h;
  for (uint32_t i = 0; i < 41; i++) {
    const double t = i % 10 / 10.0, u = i / 10 % 4 == 0 ? t
                                      : i / 10 % 4 == 1 ? 1
                                      : i / 10 % 4 == 2 ? 1 - t
                                                        : 0;
    const double v = i / 10 % 4 == 0 ? 0
                   : i / 10 % 4 == 1 ? t
                   : i / 10 % 4 == 2 ? 1
                                     : 1 - t;

    p.point[i][0] = 0.6 * u;
    p.point[i][1] = v;
    p.point[i][2] = 0.8 * u;
    p.curve->point[i] = i < 40 ? i : 0;
  }
  p.n_point = 40;
  assert_int_equal(vg_project_surface(&p, NULL, NULL, &m, &err), VG_OK);
  for (size_t i = 0; i < m.n_tri; i++) {
    const double *a = m.point[m.tri[i][0]], *b = m.point[m.tri[i][1]],
                 *c = m.point[m.tri[i][2]];

    area += 0.5 *
            ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) /
            0.6;
  }
  assert_true(fabs(area - 1) < 1e-9);
  vg_mesh_release(&m);
  stop = (struct vg_stop){ counts_down, &n_asked };
  assert_int_equal(vg_project_surface(&p, NULL, &stop, &m, &err), VG_OK);
  vg_mesh_release(&m);
  n_asked = SIZE_MAX - n_asked;
  for (int last = 0; last < 2; last++) { /* on a curve; inside the patch */
    size_t left = last ? n_asked : 1;

    stop.user = &left;
    assert_int_equal(vg_project_surface(&p, NULL, &stop, &m, &err),
                     VG_ERR_STOPPED);
    assert_null(m.tri);
  }
  p.point[5][2] += 1; /* no longer plane */
  p.point[6][2] += 1;
  assert_int_equal(vg_project_surface(&p, NULL, NULL, &m, &err),
                   VG_ERR_GEOMETRY);
  p.curve->point[3] = 77;
  assert_int_equal(vg_project_surface(&p, NULL, NULL, &m, &err), VG_ERR_INPUT);
  assert_null(m.tri);
  vg_project_release(&p);
}

/* For a farfield, a symmetry plane, and planes of a project: stops at any poll
 * of the stop request, and leaves the input unchanged. */
static void stops_when_asked(void **state)
{
  static const enum vg_farfield_kind kind[2] = { VG_FARFIELD_SPHERE,
                                                 VG_FARFIELD_BOX };

  (void)state;
  for (int k = 0; k < 2; k++)
    for (int half = -1; half < 1; half++) {
      struct vg_mesh m = ball(origin, half, 0.1);
      const size_t n_tri = m.n_tri, n_patch = m.n_patch;
      struct vg_farfield far = VG_FARFIELD_INIT;
      struct vg_error err = VG_ERROR_INIT;
      size_t left = SIZE_MAX, n;

      far.kind = kind[k];
      far.lengths = 2;
      far.spacing = 0.2;
      far.stop = (struct vg_stop){ counts_down, &left };
      for (n = 1; n < 1000; n *= 3) {
        vg_status st;

        left = n;
        st = vg_domain_complete(&m, &far, NULL, NULL, &err);
        assert_int_equal(st, left ? VG_OK : VG_ERR_STOPPED);
        if (left) break;
        assert_int_equal(m.n_tri, n_tri);
        assert_int_equal(m.n_patch, n_patch);
      }
      assert_true(n >= 27);
      vg_mesh_release(&m);
    }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(stops_when_asked),
    cmocka_unit_test(makes_even_spheres),
    cmocka_unit_test(puts_a_sphere_around_a_body),
    cmocka_unit_test(puts_a_box_around_a_body),
    cmocka_unit_test(completes_half_bodies),
    cmocka_unit_test(a_hole_is_not_a_symmetry_plane),
    cmocka_unit_test(closes_holes_but_not_half_bodies),
    cmocka_unit_test(closes_a_rim_in_two_planes),
    cmocka_unit_test(closes_a_rim_in_three_planes),
    cmocka_unit_test(closes_missing_sides_of_a_box),
    cmocka_unit_test(takes_several_bodies),
    cmocka_unit_test(adds_a_symmetry_plane_alone),
    cmocka_unit_test(refuses_half_bodies_it_cannot_complete),
    cmocka_unit_test(marches_curves_as_vgrid_does),
    cmocka_unit_test(meshes_a_project_of_planes),
    cmocka_unit_test(meshes_the_box_of_vgrid),
    cmocka_unit_test(keeps_corners_of_chains),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
