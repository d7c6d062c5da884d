/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Sources that do not reach their requested size, and the location of sample
 * points. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "core/sizing/sizing_effect.h"
#include "core/sizing/sizing_probes.h"

#define assert_near(a, b, tolerance) assert_true(fabs((a) - (b)) <= (tolerance))

static const struct vg_sizing_options plain = VG_SIZING_OPTIONS_INIT;

/* Appends a cube of half side r around c, each side n x n squares of two
 * triangles. Normals point outwards for way 1 and inwards for -1. */
static void add_cube(struct vg_mesh *m, const double c[3], double r, int n,
                     int way)
{
  size_t side = (size_t)((n + 1) * (n + 1)), at = m->n_point;

  m->point = realloc(m->point, (at + 6 * side) * sizeof *m->point);
  m->tri = realloc(m->tri, (m->n_tri + 12 * (size_t)(n * n)) * sizeof *m->tri);
  assert_true(m->point && m->tri);
  for (int f = 0; f < 6; f++)
    for (int j = 0; j <= n; j++)
      for (int i = 0; i <= n; i++) {
        int axis = f / 2, up = f % 2;
        double *p = m->point[m->n_point++], u[3];

        u[axis] = up ? 1 : -1;
        u[(axis + 1) % 3] = 2.0 * (up ? i : n - i) / n - 1;
        u[(axis + 2) % 3] = 2.0 * j / n - 1;
        for (int k = 0; k < 3; k++) p[k] = c[k] + r * u[k];
        if (i == n || j == n) continue;
        uint32_t v = (uint32_t)(at + (size_t)f * side) +
                     (uint32_t)(j * (n + 1) + i),
                 w = v + (uint32_t)n + 1;
        uint32_t t[2][3] = { { v, v + 1, w }, { v + 1, w + 1, w } };

        for (int q = 0; q < 2; q++) {
          if (way < 0) {
            uint32_t swap = t[q][1];

            t[q][1] = t[q][2];
            t[q][2] = swap;
          }
          memcpy(m->tri[m->n_tri++], t[q], sizeof t[q]);
        }
      }
}

/* A body of half side 1 in a domain of half side 20, whose squares are 4 wide:
 * edges of about 4.5. */
static void make_domain(struct vg_mesh *m)
{
  static const double origin[3] = { 0, 0, 0 };

  add_cube(m, origin, 20, 10, -1);
  add_cube(m, origin, 1, 10, 1);
}

static struct vg_effects look(size_t n, const struct vg_source *source,
                              const struct vg_mesh *m)
{
  struct vg_sizing *s = NULL;
  struct vg_effects h = VG_EFFECTS_INIT;
  struct vg_error err = VG_ERROR_INIT;

  assert_int_equal(vg_sizing_new(&plain, n, source, m, &s, &err), VG_OK);
  assert_int_equal(vg_effects_find(&plain, n, source, m, m, s, &h, &err),
                   VG_OK);
  vg_sizing_free(s);
  return h;
}

/* Rays through corners and along edges of the body too. */
static void samples_know_their_side(void **state)
{
  static const double at[][3] = {
    { -10, 0, 0 },    { -10, 1, 1 },     { 0, 0, 0 },     { -10, 1, 0.2 },
    { -10, -1, -1 },  { 0.3, 0.2, 0.2 }, { -21, 0, 0 },   { 21, 0, 0 },
    { -10, 20.5, 0 }, { 0, 10, 10 },     { -19.99, 4, 8 }
  };
  static const int in_void[] = { 1, 1, 0, 1, 1, 0, 0, 0, 0, 1, 1 };
  enum { N = sizeof in_void / sizeof *in_void };
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_probes p = VG_PROBES_INIT;
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  make_domain(&m);
  for (uint32_t i = 0; i < N; i++) {
    struct vg_source s = { .kind = VG_SOURCE_POINT };

    memcpy(s.p0, at[i], sizeof s.p0);
    vg_probes_shape(&p, &s, i, 1);
  }
  assert_int_equal(p.n, N);
  assert_int_equal(vg_probes_cross(&p, &m, &err), VG_OK);
  for (size_t i = 0; i < N; i++) {
    assert_int_equal(p.item[i].crossings < 0, in_void[i]);
    assert_true(p.item[i].crossings == 0 || p.item[i].crossings == -1);
  }
  vg_probes_release(&p);
  vg_mesh_release(&m);
}

/* All sample points are within the extent of each kind of source. */
static void places_are_in_the_shape(void **state)
{
  const struct vg_source shape[] = {
    { .kind = VG_SOURCE_VGRID_NODE, .p0 = { 1, 2, 3 } },
    { .kind = VG_SOURCE_VGRID_LINE, .p1 = { 1, 2, 3 } },
    { .kind = VG_SOURCE_POINT, .r0 = 2 },
    { .kind = VG_SOURCE_LINE, .p1 = { 0, 3, 4 }, .r0 = 0.5 },
    { .kind = VG_SOURCE_TRIANGLE,
      .p1 = { 1, 0, 0 },
      .p2 = { 0, 1, 0 },
      .r0 = 0.3 },
    { .kind = VG_SOURCE_BOX, .p0 = { 1, 1, 1 }, .p1 = { -1, 2, 0 } },
    { .kind = VG_SOURCE_SPHERE, .r0 = 2 },
    { .kind = VG_SOURCE_CYLINDER, .p1 = { 0, 0, 2 }, .r0 = 1, .r1 = 3 }
  };

  (void)state;
  for (uint32_t i = 0; i < sizeof shape / sizeof *shape; i++)
    for (int fine = 0; fine < 2; fine++) {
      struct vg_source s = shape[i];
      struct vg_probes p = VG_PROBES_INIT;

      s.h0 = s.h1 = 0.25;
      if (s.kind == VG_SOURCE_VGRID_NODE) s.kind = VG_SOURCE_POINT;
      if (s.kind == VG_SOURCE_VGRID_LINE) s.kind = VG_SOURCE_LINE;
      vg_probes_shape(&p, &s, i, fine);
      assert_true(p.n >= (i ? 5 : 1));
      for (size_t j = 0; j < p.n; j++) {
        assert_int_equal(p.item[j].source, i);
        assert_near(vg_sizing_sources_at(&plain, 1, &s, p.item[j].x), 0.25,
                    1e-12);
      }
      vg_probes_release(&p);
    }
}

static void effective_sources_are_not_reported(void **state)
{
  const struct vg_source source[] = {
    { .kind = VG_SOURCE_SPHERE, .r0 = 1.5, .h0 = 0.2 }, /* around the body */
    { .kind = VG_SOURCE_CYLINDER,
      .p0 = { 0, 0, 0 },
      .p1 = { 5, 0, 0 },
      .h0 = 0.1,
      .h1 = 0.1,
      .r0 = 0.3,
      .r1 = 0.3 }, /* from its middle */
    { .kind = VG_SOURCE_POINT, .p0 = { 1, 0, 0 }, .h0 = 0.2 },
    { .kind = VG_SOURCE_POINT, .p0 = { 0, 0.9, 0 }, .h0 = 0.2 },
    { .kind = VG_SOURCE_VGRID_NODE, .p0 = { 0, 4, 0 }, .h0 = 0.3, .an = 1 },
    { .kind = VG_SOURCE_VGRID_NODE, .p0 = { 19, 0, 0 }, .h0 = 5, .an = 1 }
  };
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_effects h;

  (void)state;
  make_domain(&m);
  h = look(sizeof source / sizeof *source, source, &m);
  assert_int_equal(h.n, 0);
  assert_int_equal(h.n_outside, 0);
  vg_effects_release(&h);
  vg_mesh_release(&m);
}

static void limited_sources_are_found(void **state)
{
  const struct vg_source source[] = {
    { .kind = VG_SOURCE_POINT, .p0 = { 3, 0, 0 }, .h0 = 0.1 },
    { .kind = VG_SOURCE_POINT, .p0 = { 0, 14, 1 }, .h0 = 0.1 },
    { .kind = VG_SOURCE_LINE,
      .p0 = { 2, 0, 0 },
      .p1 = { 19, 0, 0 },
      .h0 = 0.2,
      .h1 = 0.2 }
  };
  struct vg_mesh m = VG_MESH_INIT;
  const struct vg_limited_source *a, *b;
  struct vg_effects h;

  (void)state;
  make_domain(&m);
  h = look(3, source, &m);
  assert_int_equal(h.n, 2);
  assert_int_equal(h.n_outside, 0);
  a = h.item;
  b = h.item + 1;
  assert_int_equal(a->source, 1);
  assert_int_equal(a->n_place, 1);
  assert_int_equal(a->n_limited, 1);
  assert_near(a->asked, 0.1, 1e-12);
  assert_true(a->got > 1 && a->got < 4);
  assert_true(a->at[0] == 0 && a->at[1] == 14 && a->at[2] == 1);
  assert_true(a->face < 1200); /* of the outer cube */
  assert_near(m.point[m.tri[a->face][0]][1], 20, 1e-12);
  assert_near(a->edge, (8 + 4 * sqrt(2)) / 3, 1e-9);
  assert_true(a->distance >= 6 && a->distance < 6.7);
  /* with that edge the source would not be limited */
  assert_near(vg_sizing_below(1.2, a->edge_wanted, sqrt(37)), 0.1, 1e-9);
  assert_true(a->edge_wanted < a->edge);
  assert_true(a->growth_wanted > 1.5 && a->growth_wanted < 2);
  /* the line only where it ends */
  assert_int_equal(b->source, 2);
  assert_true(b->n_limited >= 4 && b->n_limited < b->n_place);
  assert_true(b->at[0] > 17 && b->got > 1.5 * b->asked);
  vg_effects_release(&h);
  vg_mesh_release(&m);
}

static void ineffective_sources_are_classified(void **state)
{
  const struct vg_source source[] = {
    { .kind = VG_SOURCE_POINT, .p0 = { 0, 0, 0 }, .h0 = 0.1 },
    { .kind = VG_SOURCE_POINT, .p0 = { 5, 0, 0 }, .h0 = 0.3 },
    { .kind = VG_SOURCE_BOX, .p0 = { 30, 0, 0 }, .p1 = { 40, 1, 1 }, .h0 = 0.5 }
  };
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_effects h;

  (void)state;
  make_domain(&m);
  h = look(3, source, &m);
  assert_int_equal(h.n, 0);
  assert_int_equal(h.n_outside, 2);
  assert_int_equal(h.outside[0].source, 0);
  assert_int_equal(h.outside[0].is_beyond, 0);
  assert_int_equal(h.outside[1].source, 2);
  assert_int_equal(h.outside[1].is_beyond, 1);
  vg_effects_release(&h);
  vg_mesh_release(&m);
}

/* A mesh of points alone, in two slices. */
static vg_status half_of(const struct vg_slices *s, size_t i,
                         struct vg_slice *out, struct vg_error *err)
{
  const struct vg_mesh *m = s->user;
  size_t half = m->n_point / 2;

  (void)err;
  memset(out, 0, sizeof *out);
  out->n_point = i ? m->n_point - half : half;
  out->x = (const double(*)[3])m->point + i * half;
  return VG_OK;
}

static void put_half(const struct vg_slices *s, struct vg_slice *slice)
{
  (void)s;
  (void)slice;
}

/* Points near two sources of three, within twice the size there or slightly
 * farther away. The third source is wide: it is sampled on its border only. */
static void sources_without_effect_are_reported(void **state)
{
  const struct vg_source source[] = {
    { .kind = VG_SOURCE_POINT, .p0 = { 5, 0, 0 }, .h0 = 0.01 },
    { .kind = VG_SOURCE_POINT, .p0 = { 0, 5, 0 }, .h0 = 0.01 },
    { .kind = VG_SOURCE_SPHERE, .p0 = { 0, 0, 9 }, .r0 = 2, .h0 = 0.2 }
  };
  double point[3][3] = { { 5.015, 0, 0 }, { 0, 5.03, 0 }, { 7, 7, 7 } };
  struct vg_mesh points = { .n_point = 3, .point = point };
  const struct vg_slices slices = {
    .n_slice = 2, .get = half_of, .put = put_half, .user = &points
  };
  struct vg_sizing_options steep = plain;
  struct vg_sizing *s = NULL;
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_effects h;

  (void)state;
  make_domain(&m);
  h = look(3, source, &m);
  assert_int_equal(h.n_place, 0); /* cells follow growth of 1.2 */
  vg_effects_release(&h);
  steep.growth = 3;
  assert_int_equal(vg_sizing_new(&steep, 3, source, &m, &s, NULL), VG_OK);
  assert_int_equal(vg_effects_find(&steep, 3, source, &m, &m, s, &h, NULL),
                   VG_OK);
  assert_int_equal(vg_effects_in_mesh(NULL, &slices, 2, &h, NULL), VG_OK);
  assert_int_equal(h.n_unmet, 2);
  assert_int_equal(h.unmet[0].source, 1);
  assert_int_equal(h.unmet[0].n_place, 1);
  assert_int_equal(h.unmet[0].n_unmet, 1);
  assert_true(h.unmet[0].place.got < 0.015);
  assert_near(h.unmet[0].place.x[1], 5, 1e-12);
  assert_int_equal(h.unmet[1].source, 2);
  assert_int_equal(h.unmet[1].n_place, 14);
  assert_int_equal(h.unmet[1].n_unmet, 14);
  vg_effects_release(&h);
  vg_sizing_free(s);
  vg_mesh_release(&m);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(samples_know_their_side),
    cmocka_unit_test(places_are_in_the_shape),
    cmocka_unit_test(effective_sources_are_not_reported),
    cmocka_unit_test(limited_sources_are_found),
    cmocka_unit_test(ineffective_sources_are_classified),
    cmocka_unit_test(sources_without_effect_are_reported),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
