/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "cli/examples/demo.h"

struct side {
  uint32_t a, b;
};

static int side_compare(const void *pa, const void *pb)
{
  const struct side *x = pa, *y = pb;

  if (x->a != y->a) return x->a < y->a ? -1 : 1;
  return x->b < y->b ? -1 : x->b > y->b;
}

static void check_closed(const struct vg_mesh *m)
{
  const size_t n = 3 * m->n_tri;
  struct side *list = malloc(n * sizeof *list);
  char *used = calloc(m->n_point, 1);

  for (size_t i = 0; i < n; i++) {
    list[i].a = m->tri[i / 3][i % 3];
    list[i].b = m->tri[i / 3][(i + 1) % 3];
    used[list[i].a] = 1;
  }
  qsort(list, n, sizeof *list, side_compare);
  for (size_t i = 0; i < n; i++) {
    const struct side back = { list[i].b, list[i].a };

    if (i) assert_true(side_compare(&list[i - 1], &list[i]) < 0);
    assert_non_null(bsearch(&back, list, n, sizeof *list, side_compare));
  }
  for (size_t i = 0; i < m->n_point; i++) assert_true(used[i]);
  free(list);
  free(used);
}

static double distance(const double a[3], const double b[3])
{
  return sqrt((b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1]) +
              (b[2] - a[2]) * (b[2] - a[2]));
}

/* Volume enclosed, positive if the normals point into it. */
static double volume(const struct vg_mesh *m, size_t first, size_t last)
{
  double sum = 0;

  for (size_t i = first; i < last; i++) {
    const double *a = m->point[m->tri[i][0]], *b = m->point[m->tri[i][1]],
                 *c = m->point[m->tri[i][2]];

    sum -= a[0] * (b[1] * c[2] - b[2] * c[1]) +
           a[1] * (b[2] * c[0] - b[0] * c[2]) +
           a[2] * (b[0] * c[1] - b[1] * c[0]);
  }
  return sum / 6;
}

/* Longest over shortest edge of a triangle, and its smallest angle. */
static void shape(const struct vg_mesh *m, size_t i, double *ratio,
                  double *angle_deg)
{
  double l[3], lo = 1e300, hi = 0;

  *angle_deg = 180;
  for (int k = 0; k < 3; k++) {
    l[k] = distance(m->point[m->tri[i][k]], m->point[m->tri[i][(k + 1) % 3]]);
    lo = fmin(lo, l[k]);
    hi = fmax(hi, l[k]);
  }
  for (int k = 0; k < 3; k++) {
    const double x = l[k], y = l[(k + 1) % 3], z = l[(k + 2) % 3];
    const double c = (y * y + z * z - x * x) / (2 * y * z);

    *angle_deg = fmin(*angle_deg, acos(c) * 180 / 3.14159265358979);
  }
  *ratio = hi / lo;
}

static struct vg_demo make(const char *name, size_t n_cell)
{
  struct vg_demo d = VG_DEMO_INIT;
  struct vg_error err = VG_ERROR_INIT;

  if (vg_demo_make(name, n_cell, &d, &err) != VG_OK) fail_msg("%s", err.text);
  return d;
}

static void every_case_is_a_flow_domain(void **state)
{
  size_t n;
  const struct vg_demo_case *list = vg_demo_cases(&n);

  (void)state;
  assert_true(n >= 6);
  for (size_t c = 0; c < n; c++) {
    struct vg_demo d = make(list[c].name, 600000);
    const struct vg_mesh *m = &d.surface;

    check_closed(m);
    assert_true(volume(m, 0, m->n_tri) > 0);
    if (d.n_body_tri && !strstr(list[c].name, "half"))
      assert_true(volume(m, 0, d.n_body_tri) < 0);
    /* the estimate is fitted to 2 % */
    assert_true(fabs(d.n_cell - 600000) < 12000);
    for (size_t p = 0; p < m->n_patch; p++) {
      assert_true(m->patch[p].name[0] != 0);
      assert_true(m->patch[p].bc != VG_BC_NONE);
      assert_true(m->patch[p].bc_fun3d != VG_BC_NONE);
    }
    for (size_t i = 0; i < m->n_tri; i++) {
      double ratio, angle;

      shape(m, i, &ratio, &angle);
      assert_true(ratio < 4.5);
      /* the airfoil section itself has a corner of 16.5 degrees at a sharp
       * trailing edge */
      assert_true(angle > 11);
    }
    vg_demo_release(&d);
  }
}

static void box_has_even_edges(void **state)
{
  struct vg_demo d = make("box", 1000000);
  const struct vg_mesh *m = &d.surface;
  const double h = d.source[0].h0;
  double sum = 0;

  (void)state;
  assert_true(fabs(VG_DEMO_CELLS_PER_CUBE / (h * h * h) - 1e6) < 1);
  assert_true(fabs(volume(m, 0, m->n_tri) - 1) < 1e-12);
  assert_int_equal(m->n_patch, 6);
  for (size_t i = 0; i < 3 * m->n_tri; i++)
    sum += distance(m->point[m->tri[i / 3][i % 3]],
                    m->point[m->tri[i / 3][(i + 1) % 3]]);
  assert_true(fabs(sum / (3 * m->n_tri * h) - 1) < 0.05);
  vg_demo_release(&d);
}

static void half_wing_stands_on_its_plane(void **state)
{
  struct vg_demo d = make("wing-half", 100000);
  const struct vg_mesh *m = &d.surface;
  size_t n = 0;

  (void)state;
  for (size_t i = 0; i < m->n_point; i++) assert_true(m->point[i][1] >= 0);
  for (size_t i = 0; i < m->n_tri; i++) {
    const struct vg_patch *p = &m->patch[m->tri_patch[i]];

    if (strcmp(p->name, "symmetry")) continue;
    n++;
    assert_int_equal(p->bc, 1);
    assert_int_equal(p->bc_fun3d, 6662);
    for (int k = 0; k < 3; k++) assert_true(m->point[m->tri[i][k]][1] == 0);
  }
  assert_true(n > 1000);
  vg_demo_release(&d);
}

/* The edges of the skin compared with the sources that control them. */
static void wing_follows_its_sources(void **state)
{
  struct vg_demo d = make("wing-sharp", 600000);
  const struct vg_mesh *m = &d.surface;
  size_t n_good = 0, n = 0;
  double sum = 0;

  (void)state;
  for (size_t i = 0; i < 3 * d.n_body_tri; i++) {
    const double *a = m->point[m->tri[i / 3][i % 3]],
                 *b = m->point[m->tri[i / 3][(i + 1) % 3]];
    const double mid[3] = { (a[0] + b[0]) / 2, (a[1] + b[1]) / 2,
                            (a[2] + b[2]) / 2 };
    const double r = distance(a, b) /
                     vg_sizing_sources_at(&d.sizing, d.n_source, d.source, mid);

    sum += r;
    n_good += r > 0.7 && r < 1.5;
    n++;
  }
  assert_true(n_good > 0.97 * n);
  assert_true(fabs(sum / n - 1) < 0.06);
  vg_demo_release(&d);
}

static void whole_wing_is_symmetric(void **state)
{
  struct vg_demo d = make("wing", 100000);
  double left = 0, right = 0;

  (void)state;
  for (size_t i = 0; i < d.n_body_tri; i++)
    for (int k = 0; k < 3; k++) {
      const double y = d.surface.point[d.surface.tri[i][k]][1];

      if (y < 0) left -= y;
      else right += y;
    }
  assert_true(fabs(left - right) < 1e-9 * right);
  vg_demo_release(&d);
}

static void refuses_impossible_demos(void **state)
{
  struct vg_demo d = VG_DEMO_INIT;
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  assert_int_equal(vg_demo_make("swing", 0, &d, &err), VG_ERR_USAGE);
  assert_non_null(strstr(err.text, "wing-sharp-half"));
  assert_int_equal(vg_demo_make("box", 3000000000u, &d, &err), VG_ERR_INPUT);
  assert_null(d.source);
}

static void gives_the_same_bytes_twice(void **state)
{
  struct vg_demo a = make("wing-sharp-half", 50000),
                 b = make("wing-sharp-half", 50000);

  (void)state;
  assert_int_equal(a.surface.n_point, b.surface.n_point);
  assert_int_equal(a.surface.n_tri, b.surface.n_tri);
  assert_memory_equal(a.surface.point, b.surface.point,
                      a.surface.n_point * sizeof *a.surface.point);
  assert_memory_equal(a.surface.tri, b.surface.tri,
                      a.surface.n_tri * sizeof *a.surface.tri);
  vg_demo_release(&a);
  vg_demo_release(&b);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(every_case_is_a_flow_domain),
    cmocka_unit_test(box_has_even_edges),
    cmocka_unit_test(half_wing_stands_on_its_plane),
    cmocka_unit_test(wing_follows_its_sources),
    cmocka_unit_test(whole_wing_is_symmetric),
    cmocka_unit_test(refuses_impossible_demos),
    cmocka_unit_test(gives_the_same_bytes_twice),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
