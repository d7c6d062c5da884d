/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Sheets of a mesh: their table, the cells on both sides, and the files that
 * hold them. */
#define _GNU_SOURCE
#include "mixed_support.h"

#include "base/memory.h"
#include "core/judge/sheet_sides.h"
#include "core/mesh/sheets.h"
#include "io/mesh/foam.h"
#include "io/mesh/format.h"
#include "io/stream/sheet_file.h"
#include "run/commit/tree.h"

/* Adds every other triangle between cells as a sheet, with the names of two
 * sheets. */
static void make(struct vg_mesh *m)
{
  struct mixed_side *s;
  size_t n, n_inner = 0;

  mixed_make(m, 3, 2);
  n = mixed_sides(m, &s);
  m->sheet_tri = vg_alloc(n, sizeof *m->sheet_tri);
  m->sheet_of = vg_alloc(n, sizeof *m->sheet_of);
  m->sheet = vg_calloc(2, sizeof *m->sheet);
  m->n_sheet = 2;
  for (int i = 0; i < 2; i++)
    m->sheet[i] = (struct vg_patch){ .id = 70 + i,
                                     .bc = VG_BC_NONE,
                                     .bc_fun3d = VG_BC_NONE,
                                     .family = VG_BC_NONE,
                                     .is_sheet = 1 };
  strcpy(m->sheet[0].name, "disk");
  strcpy(m->sheet[1].name, "wake");
  for (size_t i = 1; i < n; i++) {
    if (mixed_by_key(s + i - 1, s + i) || s[i].node[3] != UINT32_MAX) continue;
    if (n_inner++ % 2) continue;
    memcpy(m->sheet_tri[m->n_sheet_tri], s[i].node, sizeof *m->sheet_tri);
    m->sheet_of[m->n_sheet_tri] = m->n_sheet_tri % 2;
    m->n_sheet_tri++;
  }
  free(s);
  assert_true(m->n_sheet_tri > 4);
}

static void same_sheets(const struct vg_mesh *a, const struct vg_mesh *b)
{
  struct vg_sheet_table t;

  assert_int_equal(a->n_sheet, b->n_sheet);
  assert_int_equal(a->n_sheet_tri, b->n_sheet_tri);
  assert_int_equal(vg_sheet_table_new(&t, a, NULL), VG_OK);
  for (size_t i = 0; i < b->n_sheet_tri; i++) {
    int is_same;
    const uint32_t at = vg_sheet_table_find(&t, b->sheet_tri[i], &is_same);

    assert_true(at != UINT32_MAX && is_same);
    assert_int_equal(a->sheet[a->sheet_of[at]].id, b->sheet[b->sheet_of[i]].id);
  }
  vg_sheet_table_release(&t);
}

static void both_sides_have_cells(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_sheet_report *r;
  double area = 0;

  (void)state;
  make(&m);
  assert_int_equal(vg_sheet_sides_judge(&m, &r, NULL), VG_OK);
  for (int i = 0; i < 2; i++) {
    assert_int_equal(r[i].n_bad, 0);
    assert_int_equal(r[i].n_cell[0], r[i].n_tri);
    assert_int_equal(r[i].n_cell[1], r[i].n_tri);
    area += r[i].area;
  }
  assert_true(area > 0);
  free(r);
  /* a triangle of the boundary, and one of no cell */
  memcpy(m.sheet_tri[0], m.tri[0], sizeof *m.tri);
  m.sheet_tri[1][0] = m.sheet_tri[1][1];
  assert_int_equal(vg_sheet_sides_judge(&m, &r, NULL), VG_OK);
  assert_int_equal(r[0].n_bad + r[1].n_bad, 2);
  free(r);
  vg_mesh_release(&m);
}

static void a_view_has_them_as_patches(void **state)
{
  struct vg_mesh m = VG_MESH_INIT, view;

  (void)state;
  make(&m);
  m.sheet[1].id = m.patch[0].id;
  assert_int_equal(vg_mesh_sheet_view(&m, &view, NULL), VG_OK);
  assert_int_equal(view.n_patch, m.n_patch + 1);
  assert_int_equal(view.n_tri, m.n_tri + m.n_sheet_tri);
  assert_true(view.patch[m.n_patch].is_sheet);
  assert_int_equal(view.tri_patch[m.n_tri], m.n_patch);
  assert_int_equal(view.tri_patch[m.n_tri + 1], 0);
  vg_mesh_sheet_view_release(&view, &m);
  vg_mesh_drop_sheets(&m);
  assert_int_equal(vg_mesh_sheet_view(&m, &view, NULL), VG_OK);
  assert_ptr_equal(view.tri, m.tri);
  vg_mesh_sheet_view_release(&view, &m);
  vg_mesh_release(&m);
}

static void formats_keep_them(void **state)
{
  static const char *const suffix[] = { "msh", "mesh", "meshb" };
  struct vg_mesh m = VG_MESH_INIT;

  (void)state;
  make(&m);
  for (size_t i = 0; i < sizeof suffix / sizeof *suffix; i++) {
    struct vg_mesh got = VG_MESH_INIT;
    struct vg_read_info info = { .mapbc = NULL };
    char name[32];

    assert_true(vg_format_holds_sheets(suffix[i]));
    snprintf(name, sizeof name, "sheets.%s", suffix[i]);
    assert_int_equal(vg_format_write(io_temp(name), &m, NULL), VG_OK);
    assert_int_equal(vg_mesh_read(io_temp(name), &got, &info, NULL), VG_OK);
    assert_int_equal(info.inner.n_sheet_face, m.n_sheet_tri);
    assert_int_equal(info.inner.n_face, 0);
    same_sheets(&m, &got);
    assert_int_equal(got.n_tri, m.n_tri);
    assert_int_equal(got.n_patch, m.n_patch);
    if (!i) assert_string_equal(got.sheet[1].name, "wake");
    vg_mesh_release(&got);
  }
  vg_mesh_release(&m);
}

/* A .ugrid with STEM.sheets; a file that belongs to another mesh. */
static void a_file_in_the_same_folder(void **state)
{
  struct vg_mesh m = VG_MESH_INIT, got = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  char path[400], sheets[400];
  size_t n_cell;

  (void)state;
  make(&m);
  n_cell = mixed_n_cell(&m);
  snprintf(path, sizeof path, "%s", io_temp("beside.lb8.ugrid"));
  snprintf(sheets, sizeof sheets, "%s", io_temp("beside.sheets"));
  assert_false(vg_format_holds_sheets("lb8.ugrid"));
  assert_int_equal(vg_format_write(path, &m, NULL), VG_OK);
  assert_false(vg_sheet_file_is_own(sheets));
  assert_int_equal(vg_sheet_file_write(sheets, &m, m.n_point, n_cell, NULL),
                   VG_OK);
  assert_true(vg_sheet_file_is_own(sheets));
  assert_int_equal(vg_mesh_read(path, &got, NULL, NULL), VG_OK);
  same_sheets(&m, &got);
  assert_string_equal(got.sheet[0].name, "disk");
  assert_int_equal(got.n_patch, m.n_patch);
  vg_mesh_release(&got);

  memcpy(m.sheet_tri[0], m.tri[0], sizeof *m.tri);
  vg_sheet_file_write(sheets, &m, m.n_point, n_cell, NULL);
  assert_int_equal(vg_mesh_read(path, &got, NULL, &err), VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "not a face between two cells"));
  vg_sheet_file_write(sheets, &m, m.n_point, n_cell + 1, NULL);
  assert_int_equal(vg_mesh_read(path, &got, NULL, &err), VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "belong to a mesh of"));
  remove(sheets);
  assert_int_equal(vg_mesh_read(path, &got, NULL, NULL), VG_OK);
  assert_int_equal(got.n_sheet, 0);
  vg_mesh_release(&got);
  vg_mesh_release(&m);
}

static void refuse(struct vg_mesh *m, const char *text, const char *why)
{
  struct vg_input in = VG_INPUT_INIT;
  struct vg_error err = VG_ERROR_INIT;
  const size_t n_tri = m->n_tri, n_patch = m->n_patch;
  vg_status st;

  assert_int_equal(vg_input_memory("s", text, strlen(text), &in, NULL), VG_OK);
  st = vg_sheet_file_parse(&in, m, &err);
  assert_true(st < 0);
  if (!strstr(err.text, why)) fail_msg("%s", err.text);
  assert_int_equal(m->n_tri, n_tri);
  assert_int_equal(m->n_patch, n_patch);
  vg_input_release(&in);
}

static void damaged_files_are_refused(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;

  (void)state;
  io_make_t1(&m, 1); /* 4 points, 1 cell */
  refuse(&m, "sheet 9 1", "the word mesh is expected");
  refuse(&m, "mesh 4 x", "the number of cells");
  refuse(&m, "mesh 4 1\nfan 1",
         "the word sheet, interface or zone is "
         "expected");
  refuse(&m, "mesh 4 1\nsheet 9 2 a\n1 2 3\n1 2", "");
  refuse(&m, "mesh 4 1\nsheet 9 1 a\n1 2 5\n", "point 5 does not exist");
  refuse(&m, "mesh 4 1\nsheet 9 1 a\n1 2 0\n", "point 0 does not exist");
  refuse(&m, "mesh 4 1\nsheet 9 1 a\n1 2 2\n", "a point twice");
  refuse(&m, "mesh 4 1\nsheet 9 99999999 a\n1 2 3\n", "truncated");
  refuse(&m, "mesh 4 1\nsheet 9 -1 a\n", "out of range");
  refuse(&m, "mesh 4 1\nsheet 3000000000 1 a\n1 2 3\n", "out of range");
  refuse(&m, "mesh 4 1\nsheet 9 1 a\n1 2 3\nsheet 2 1 b\n1 2 4\n",
         "s:4: the number 2 of a sheet is the number of a patch of the mesh");
  refuse(&m, "mesh 4 1\nsheet 9 1 a\n1 2 3\nsheet 9 1 b\n1 2 4\n",
         "s:4: the number 9 of a sheet is the number of two sheets");
  vg_mesh_release(&m);
}

/* The zones of an OpenFOAM case have all triangles. */
static void zones_of_faces(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  unsigned char *text;
  char path[400];
  size_t size;

  (void)state;
  make(&m);
  snprintf(path, sizeof path, "%s", io_temp("sheets.openfoam"));
  vg_tree_remove(path);
  assert_int_equal(vg_foam_write(path, &m, NULL, NULL), VG_OK);
  snprintf(path, sizeof path, "%s/constant/polyMesh/faceZones",
           io_temp("sheets.openfoam"));
  text = io_slurp(path, &size);
  assert_non_null(memmem(text, size, "    disk\n", 9));
  assert_non_null(memmem(text, size, "    wake\n", 9));
  free(text);
  vg_tree_remove(io_temp("sheets.openfoam"));
  vg_mesh_release(&m);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(both_sides_have_cells),
    cmocka_unit_test(a_view_has_them_as_patches),
    cmocka_unit_test(formats_keep_them),
    cmocka_unit_test(a_file_in_the_same_folder),
    cmocka_unit_test(damaged_files_are_refused),
    cmocka_unit_test(zones_of_faces),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
