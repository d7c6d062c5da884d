/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Causes of flat cells: the kinds of the points of a cell, patches, connections
 * along the boundary; the same numbers for any cut into slices. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "core/judge/flat_cells.h"
#include "judge_support.h"

/* --- a made boundary ----------------------------------------------------- */

/* Three parts that no edge connects, with the patch in each triangle:
 *
 *   8---0---2                       9------10
 *   |7 /|4 /|2\         5---6      / \ 6 / |
 *   | / | / |  4        |2 /      /1  12   |
 *   |/ 7|/  | /         | /      11-------- 1
 *   3---1---+-          7
 *
 * 0, 1, 2, 4 and 5, 6, 7 are tops, 8 and 3 are on a slide patch, 12 is on a
 * wall without levels (patch 6). */
enum { N_POINT = 13, N_FACE = 8 };
#define NOT_TOP UINT32_MAX

static const uint32_t face[N_FACE][3] = { { 0, 1, 2 },   { 1, 4, 2 },
                                          { 5, 7, 6 },   { 0, 3, 1 },
                                          { 0, 8, 3 },   { 9, 10, 11 },
                                          { 12, 10, 9 }, { 12, 9, 11 } };
static const uint32_t patch[N_FACE] = { 4, 2, 2, 7, 7, 1, 6, 1 };
static const uint32_t top[N_FACE] = { 0,       1,       2, NOT_TOP,
                                      NOT_TOP, NOT_TOP, 3, NOT_TOP };
static const uint8_t kind[N_POINT] = {
  VG_POINT_TOP,   VG_POINT_TOP,     VG_POINT_TOP,     VG_POINT_SURFACE,
  VG_POINT_TOP,   VG_POINT_TOP,     VG_POINT_TOP,     VG_POINT_TOP,
  VG_POINT_SLIDE, VG_POINT_SURFACE, VG_POINT_SURFACE, VG_POINT_SURFACE,
  VG_POINT_WALL
};

/* Point p of the boundary has number 100 - 3 p in the mesh; F: not on the
 * boundary. */
#define F 99u
#define OF(p) ((p) == F ? 1000u : 100 - 3 * (uint32_t)(p))

/* Coordinates for cells in which shapes do not matter. */
static const double corner[4][3] = {
  { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }
};
static const double *const fine[4] = { corner[0], corner[1], corner[2],
                                       corner[3] };

static struct vg_flat *made(void)
{
  static uint32_t id[N_POINT];
  const struct vg_flat_boundary b = { N_POINT, N_FACE, id, kind,
                                      face,    patch,  top };
  struct vg_flat *f = NULL;

  for (uint32_t p = 0; p < N_POINT; p++) id[p] = OF(p);
  assert_int_equal(vg_flat_new(&b, &f, NULL), VG_OK);
  return f;
}

static void causes(void **state)
{
  static const struct {
    uint32_t p[4];
    enum vg_flat_cause cause;
    int spanning;
    uint32_t patch[4];
  } row[] = {
    /* 1 and 2 are on both strips, 0 on the first one only */
    { { 0, 1, 2, 4 }, VG_FLAT_TOPS_SEVERAL, 0, { 4, 2, 2, 2 } },
    { { 5, 6, 7, 4 }, VG_FLAT_TOPS_ONE, 1, { 2, 2, 2, 2 } },
    { { 1, 2, 5, 6 }, VG_FLAT_TOPS_ONE, 1, { 2, 2, 2, 2 } },
    { { 0, 2, 5, 6 }, VG_FLAT_TOPS_SEVERAL, 1, { 4, 2, 2, 2 } },
    { { 0, F, 1, 2 }, VG_FLAT_TOPS_FIELD, 0, { 4, VG_NO_PATCH, 4, 4 } },
    { { 0, F, F, 5 },
      VG_FLAT_TOPS_FIELD,
      1,
      { 4, VG_NO_PATCH, VG_NO_PATCH, 2 } },
    { { 4, F, F, F },
      VG_FLAT_TOPS_FIELD,
      0,
      { 2, VG_NO_PATCH, VG_NO_PATCH, VG_NO_PATCH } },
    /* the slide patch does not count for 0 and 1 */
    { { 0, 1, 3, 8 }, VG_FLAT_TOPS_SURFACE, 0, { 4, 4, 7, 7 } },
    { { 1, 8, F, 9 }, VG_FLAT_TOPS_SURFACE, 1, { 2, 7, VG_NO_PATCH, 1 } },
    /* only the wall counts for 12; all patches do for 9 */
    { { 9, 10, 11, 12 }, VG_FLAT_SURFACE, 0, { 1, 1, 1, 6 } },
    { { 3, F, 10, 8 }, VG_FLAT_SURFACE_FIELD, 1, { 7, VG_NO_PATCH, 1, 7 } },
    { { F, F, F, F },
      VG_FLAT_FIELD,
      0,
      { VG_NO_PATCH, VG_NO_PATCH, VG_NO_PATCH, VG_NO_PATCH } },
  };
  struct vg_flat *f = made();

  (void)state;
  for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
    const uint32_t *p = row[i].p;
    const uint32_t id[4] = { OF(p[0]), OF(p[1]), OF(p[2]), OF(p[3]) };
    enum vg_point_kind inner[4] = { VG_POINT_FIELD, VG_POINT_INTERFACE,
                                    VG_POINT_FIELD, VG_POINT_FIELD };
    struct vg_flat_class c = vg_flat_classify(f, id, fine, inner);

    assert_int_equal(c.cause, row[i].cause);
    assert_int_equal(c.is_spanning, row[i].spanning);
    assert_int_equal(c.at_interface, p[1] == F);
    assert_false(c.has_needle);
    assert_memory_equal(c.points.patch, row[i].patch, sizeof row[i].patch);
    for (int k = 0; k < 4; k++)
      assert_int_equal(c.points.kind[k], p[k] == F ? inner[k] : kind[p[k]]);
  }
  vg_flat_free(f);
  vg_flat_free(NULL);
}

/* Without ids, kinds and tops, the points of the surface come first. */
static void a_plain_surface(void **state)
{
  const struct vg_flat_boundary b = { N_POINT, N_FACE, NULL, NULL,
                                      face,    patch,  NULL };
  const enum vg_point_kind inner[4] = { VG_POINT_FIELD, VG_POINT_FIELD,
                                        VG_POINT_FIELD, VG_POINT_FIELD };
  struct vg_flat *f = NULL;
  struct vg_flat_class c;

  (void)state;
  assert_int_equal(vg_flat_new(&b, &f, NULL), VG_OK);
  c = vg_flat_classify(f, (uint32_t[]){ 0, 12, 13, UINT32_MAX }, fine, inner);
  assert_int_equal(c.cause, VG_FLAT_SURFACE_FIELD);
  assert_true(c.is_spanning);
  assert_int_equal(c.points.kind[0], VG_POINT_SURFACE);
  assert_int_equal(c.points.patch[0], 4);
  assert_int_equal(c.points.patch[1], 1);
  assert_int_equal(c.points.kind[2], VG_POINT_FIELD);
  c = vg_flat_classify(f, (uint32_t[]){ 0, 1, 2, 3 }, fine, inner);
  assert_int_equal(c.cause, VG_FLAT_SURFACE);
  assert_false(c.is_spanning);
  vg_flat_free(f);
}

/* A needle counts if it is a face of the boundary. */
static void needles(void **state)
{
  static const enum vg_point_kind inner[4] = { VG_POINT_FIELD, VG_POINT_FIELD,
                                               VG_POINT_FIELD, VG_POINT_FIELD };
  struct vg_flat *f = made();

  (void)state;
  for (int degrees = 4; degrees <= 6; degrees++)
    for (int turn = 0; turn < 3; turn++)
      for (int joined = 0; joined < 2; joined++) {
        /* tan(4, 5.01, 6 degrees) */
        static const double height[] = { 0.0699, 0.08767, 0.1051 };
        const double x[4][3] = { { 0, 0, 0 },
                                 { 1, 0, 0 },
                                 { 1, height[degrees - 4], 0 },
                                 { 0.5, 0, 0.8 } };
        const uint32_t p[3] = { 0, joined ? 1 : 4, 2 };
        uint32_t id[4] = { 0, 0, 0, OF(F) };
        const double *at[4] = { NULL, NULL, NULL, x[3] };
        struct vg_flat_class c;

        for (int k = 0; k < 3; k++) {
          id[k] = OF(p[(k + turn) % 3]);
          at[k] = x[(k + turn) % 3];
        }
        c = vg_flat_classify(f, id, at, inner);
        assert_int_equal(c.has_needle, degrees == 4 && joined);
      }
  vg_flat_free(f);
}

static void every_name_is_different(void **state)
{
  (void)state;
  for (int a = 0; a < VG_FLAT_CAUSES; a++)
    for (int b = 0; b < a; b++) {
      assert_string_not_equal(vg_flat_cause_key((enum vg_flat_cause)a),
                              vg_flat_cause_key((enum vg_flat_cause)b));
      assert_string_not_equal(vg_flat_cause_name((enum vg_flat_cause)a),
                              vg_flat_cause_name((enum vg_flat_cause)b));
    }
  for (int a = 0; a < VG_POINT_KINDS; a++)
    for (int b = 0; b < a; b++)
      assert_string_not_equal(vg_point_kind_name((enum vg_point_kind)a),
                              vg_point_kind_name((enum vg_point_kind)b));
}

/* --- in the mesh check --------------------------------------------------- */

/* The flat cells of a mesh in n slices. The points of layers make many of its
 * cells flat. */
static struct vg_mesh_report judged(const struct vg_mesh *m,
                                    const struct vg_flat *f, size_t n,
                                    int threads)
{
  struct vg_mesh_report r;
  struct vg_error err = VG_ERROR_INIT;
  struct cut c;

  cut_make(&c, m, n, 0, NULL, 31 + n);
  if (vg_slices_judge_with(NULL, &c.s, 0, NULL, threads, f, 0, NULL, NULL, &r,
                           NULL, &err) < 0)
    fail_msg("%s", err.text);
  cut_release(&c);
  return r;
}

static void any_cut_has_the_same_causes(void **state)
{
  struct vg_mesh m = judge_mesh(VG_LAYER_TETS);
  uint32_t *one = vg_calloc(m.n_tri, sizeof *one);
  float *angle = vg_alloc(m.n_tet, sizeof *angle);
  struct vg_flat_boundary b = { .n_point = m.n_point, .n_face = m.n_tri };
  struct vg_mesh_report want, r;
  struct vg_flat *f = NULL;
  size_t sum = 0, n_flat = 0;

  (void)state;
  assert_true(one && angle);
  /* the last third of the points is in the field */
  b.n_point = 2 * m.n_point / 3;
  for (size_t i = 0; i < 3 * m.n_tri; i++)
    if (m.tri[i / 3][i % 3] >= b.n_point) b.n_point = m.tri[i / 3][i % 3] + 1;
  b.face = (const uint32_t(*)[3])m.tri;
  b.patch = one;
  assert_int_equal(vg_flat_new(&b, &f, NULL), VG_OK);
  vg_mesh_cell_quality(&m, angle, NULL);
  for (size_t i = 0; i < m.n_tet; i++)
    n_flat += (double)angle[i] < VG_FLAT_LIMIT;
  want = judged(&m, f, 1, 1);
  assert_true(want.has_flat);
  for (int c = 0; c < VG_FLAT_CAUSES; c++) {
    sum += want.flat[c].n;
    assert_int_equal(want.flat[c].at_interface, 0);
  }
  assert_int_equal(sum, n_flat);
  assert_true(n_flat > 100);
  for (size_t n = 3; n < 40; n += 12) {
    size_t at_interface = 0;

    r = judged(&m, f, n, 1 + (int)n % 3);
    for (int c = 0; c < VG_FLAT_CAUSES; c++) {
      assert_int_equal(r.flat[c].n, want.flat[c].n);
      assert_int_equal(r.flat[c].spanning, want.flat[c].spanning);
      assert_int_equal(r.flat[c].needle, want.flat[c].needle);
      assert_true(r.flat[c].at_interface <= r.flat[c].n);
      at_interface += r.flat[c].at_interface;
    }
    assert_int_equal(r.n_worst, want.n_worst);
    for (size_t i = 0; i < r.n_worst; i++)
      assert_memory_equal(r.worst[i].points.patch, want.worst[i].points.patch,
                          sizeof r.worst[i].points.patch);
    assert_true(at_interface > 0 || !r.flat[VG_FLAT_SURFACE_FIELD].n);
  }
  vg_flat_free(f);
  free(one);
  free(angle);
  vg_mesh_release(&m);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(causes),
    cmocka_unit_test(a_plain_surface),
    cmocka_unit_test(needles),
    cmocka_unit_test(every_name_is_different),
    cmocka_unit_test(any_cut_has_the_same_causes),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
