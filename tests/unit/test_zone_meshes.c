/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Zones as meshes of their own, interfaces with two sides, and faces between
 * zones: three prisms on top of each other, a zone each. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "base/memory.h"
#include "core/judge/quality.h"
#include "core/mesh/double_faces.h"
#include "core/mesh/zone_meshes.h"
#include "core/mesh/zone_surface.h"

enum { LEVELS = 4, CELLS = 3 };

static struct vg_patch patch(int32_t id, const char *name)
{
  struct vg_patch p = { .id = id, .bc = VG_BC_NONE, .bc_fun3d = VG_BC_NONE };

  snprintf(p.name, sizeof p.name, "%s", name);
  return p;
}

/* The sides of prism k. */
static void add_quads(struct vg_mesh *m, uint32_t k)
{
  static const uint32_t face[3][4] = { { 0, 3, 4, 1 },
                                       { 1, 4, 5, 2 },
                                       { 0, 2, 5, 3 } };

  for (int f = 0; f < 3; f++) {
    for (int i = 0; i < 4; i++) m->quad[m->n_quad][i] = 3 * k + face[f][i];
    m->quad_patch[m->n_quad++] = 1;
  }
}

/* n_sheet interfaces, from below: 2 "low", without a name, of which the normal
 * points up and down. */
static void make(struct vg_mesh *m, size_t n_sheet)
{
  static const uint32_t end[2][3] = { { 0, 1, 2 }, { 9, 11, 10 } },
                        sheet[2][3] = { { 3, 4, 5 }, { 6, 8, 7 } };

  *m = (struct vg_mesh)VG_MESH_INIT;
  m->point = vg_calloc((size_t)3 * LEVELS, sizeof *m->point);
  for (int p = 0; p < 3 * LEVELS; p++) {
    m->point[p][0] = p % 3 == 1;
    m->point[p][1] = p % 3 == 2;
    m->point[p][2] = p / 3 + (p / 3 == 3); /* the third one is larger */
  }
  m->n_point = (size_t)3 * LEVELS;
  m->pri = vg_alloc(CELLS, sizeof *m->pri);
  m->quad = vg_alloc((size_t)3 * CELLS, sizeof *m->quad);
  m->quad_patch = vg_alloc((size_t)3 * CELLS, sizeof *m->quad_patch);
  for (uint32_t k = 0; k < CELLS; k++) {
    for (uint32_t i = 0; i < 6; i++) m->pri[k][i] = 3 * k + i;
    add_quads(m, k);
  }
  m->n_pri = CELLS;
  m->tri = vg_alloc(2, sizeof *m->tri);
  m->tri_patch = vg_calloc(2, sizeof *m->tri_patch);
  memcpy(m->tri, end, sizeof end);
  m->n_tri = 2;
  m->patch = vg_alloc(2, sizeof *m->patch);
  m->patch[0] = patch(1, "ends");
  m->patch[1] = patch(7, "sides");
  m->n_patch = 2;
  m->sheet_tri = vg_alloc(2, sizeof *m->sheet_tri);
  m->sheet_of = vg_alloc(2, sizeof *m->sheet_of);
  m->sheet = vg_alloc(2, sizeof *m->sheet);
  memcpy(m->sheet_tri, sheet, sizeof sheet);
  m->sheet_of[0] = 0;
  m->sheet_of[1] = 1;
  m->sheet[0] = patch(2, "low");
  m->sheet[1] = patch(9, "");
  m->sheet[0].is_interface = m->sheet[1].is_interface = 1;
  m->n_sheet = m->n_sheet_tri = n_sheet;
  m->zone = vg_calloc(CELLS, sizeof *m->zone);
  for (int z = 0; z < CELLS; z++) {
    m->zone[z].id = z + 1;
    m->zone[z].n_cell[2] = 1;
  }
  snprintf(m->zone[0].name, VG_NAME_MAX, "a");
  m->n_zone = CELLS;
}

static void valid(const struct vg_mesh *m, double volume)
{
  struct vg_mesh_report r;
  struct vg_error err = VG_ERROR_INIT;

  assert_int_equal(vg_mesh_judge(m, NULL, &r, &err), VG_OK);
  assert_true(r.is_valid);
  assert_true(r.volume == volume);
}

static void test_parts(void **state)
{
  struct vg_mesh m, part = VG_MESH_INIT;
  struct vg_zone_parts p;
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  make(&m, 2);
  assert_int_equal(vg_zone_parts_new(&m, &p, &err), VG_OK);
  assert_int_equal(p.n_pair, 2);
  assert_int_equal(p.n_patch, 6);
  assert_string_equal(p.patch[2].name, "low");
  assert_string_equal(p.patch[3].name, "low_back");
  assert_string_equal(p.patch[5].name, "patch_9_back");
  assert_int_equal(p.pair[0].zone[0], 1); /* the normal points up */
  assert_int_equal(p.pair[1].zone[0], 1); /* and down */
  for (size_t z = 0; z < CELLS; z++) {
    assert_int_equal(vg_zone_part(&p, z, &part, &err), VG_OK);
    assert_int_equal(part.n_point, 6);
    assert_int_equal(part.n_tri, 2);
    assert_int_equal(part.n_quad, 3);
    valid(&part, z == 2 ? 1 : 0.5);
  }
  vg_mesh_release(&part);
  vg_zone_parts_release(&p);
  m.tri[0][0] = 5; /* no face of a cell */
  assert_int_equal(vg_zone_parts_new(&m, &p, &err), VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "belongs to no cell"));
  vg_mesh_release(&m);
}

static void test_double(void **state)
{
  const uint8_t all[2] = { 1, 1 }, first[2] = { 1, 0 };
  struct vg_mesh m;
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  make(&m, 2);
  assert_int_equal(vg_mesh_double_faces(&m, all, &err), VG_OK);
  assert_int_equal(m.n_point, 18);
  assert_int_equal(m.n_tri, 6);
  assert_int_equal(m.n_sheet + m.n_sheet_tri, 0);
  assert_int_equal(m.n_patch, 6);
  assert_true(vg_patch_is_sliding(&m.patch[2]));
  assert_true(vg_patch_is_sliding(&m.patch[5]));
  assert_false(vg_patch_is_sliding(&m.patch[1]));
  assert_string_equal(m.patch[3].name, "low_back");
  assert_int_equal(m.patch[3].id, 10);
  valid(&m, 2);
  vg_mesh_release(&m);

  make(&m, 2);
  assert_int_equal(vg_mesh_double_faces(&m, first, &err), VG_OK);
  assert_int_equal(m.n_point, 15);
  assert_int_equal(m.n_sheet, 1);
  assert_int_equal(m.sheet[0].id, 9);
  assert_int_equal(m.sheet_of[0], 0);
  valid(&m, 2);
  vg_mesh_release(&m);
}

/* A sheet within a zone, and zones that stay connected. */
static void test_refused(void **state)
{
  const uint8_t all[2] = { 1, 1 };
  struct vg_mesh m;
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  make(&m, 2);
  m.n_zone = 2;
  m.zone[0].n_cell[2] = 2;
  assert_int_equal(vg_mesh_double_faces(&m, all, &err), VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "does not separate two zones at (0, 0, 1)"));
  assert_int_equal(m.n_point, 12);
  assert_int_equal(m.n_patch, 2);
  vg_mesh_release(&m);
}

static void test_interfaces(void **state)
{
  struct vg_error err = VG_ERROR_INIT;
  struct vg_mesh m;
  double seed[3];

  (void)state;
  for (size_t n = 0; n < 3; n++) {
    make(&m, n);
    vg_mesh_zone_seed(&m, 2, seed);
    assert_true(fabs(seed[2] - 3) < 1e-12);
    assert_int_equal(vg_mesh_add_interfaces(&m, "m", &err), VG_OK);
    assert_int_equal(m.n_tri, 4);
    assert_int_equal(m.n_patch, 4);
    assert_true(m.patch[2].is_interface && m.patch[3].is_interface);
    assert_string_equal(m.patch[2].name, n ? "low" : "a_to_zone_2");
    assert_string_equal(m.patch[3].name, "zone_2_to_zone_3");
    assert_int_equal(m.patch[3].id, n == 1 ? 8 : (int)(9 + n / 2));
    vg_mesh_release(&m);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_parts),
    cmocka_unit_test(test_double),
    cmocka_unit_test(test_refused),
    cmocka_unit_test(test_interfaces),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
