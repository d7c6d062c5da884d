/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "mixed_support.h"

#include "core/mesh/sheets.h"
#include "io/mesh/format.h"
#include "io/stream/convention.h"
#include "io/vgrid/vgrid.h"

static int can_write(const char *suffix)
{
  const char *known;

  for (size_t i = 0; (known = vg_format_output_suffix(i)); i++)
    if (!strcmp(known, suffix)) return 1;
  return 0;
}

static void suffixes_are_known(void **state)
{
  static const struct {
    const char *name;
    size_t length;
  } cases[] = { { "wing.stl", 4 },
                { "dir.x/wing.lb8.ugrid", 10 },
                { "wing.ugrid", 6 },
                { "wing.B8.UGRID.gz", 12 },
                { "a.b.meshb", 6 },
                { "wing.b8.ugrid64", 11 },
                { "x.cogsg", 6 },
                { "x.front.gz", 9 },
                { "wing", 0 },
                { "wing.gz", 0 },
                { "wing.stl.bak", 0 },
                { "stl", 0 },
                { "", 0 },
                { ".stl", 4 },
                { "x.vtu", 4 },
                { "x.y8.ugrid", 6 },
                { "x.surf.gz", 8 },
                { "a.fluent.msh", 11 },
                { "fluent.msh", 4 },
                { "x.openfoam", 9 } };
  size_t n = 0;

  (void)state;
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
    if (vg_format_suffix_length(cases[i].name) != cases[i].length)
      fail_msg("%s: %zu", cases[i].name,
               vg_format_suffix_length(cases[i].name));
  for (const char *s; (s = vg_format_input_suffix(n)); n++) {
    char name[64];

    snprintf(name, sizeof name, "x.%s", s);
    assert_int_equal(vg_format_suffix_length(name), strlen(s) + 1);
  }
  assert_int_equal(n, 56);
  assert_true(can_write("b8.ugrid"));
  assert_true(can_write("cogsg"));
  assert_true(can_write("vtu"));
  assert_true(can_write("openfoam"));
  assert_false(can_write("front"));
  assert_false(can_write("surf"));
  assert_false(can_write("b9.ugrid"));
  assert_false(can_write(""));
}

static void unknown_suffixes_list_the_known(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  assert_int_equal(vg_mesh_read("wing.x_t", &m, NULL, &err), VG_ERR_FORMAT);
  assert_non_null(strstr(err.text, "wing.x_t"));
  assert_non_null(strstr(err.text, ".stl"));
  assert_non_null(strstr(err.text, ".ugrid"));
  assert_int_equal(vg_mesh_read("wing.vtu", &m, NULL, &err), VG_ERR_FORMAT);
  assert_non_null(strstr(err.text, "can only be written"));
  assert_int_equal(vg_format_write("wing.front", &m, &err), VG_ERR_FORMAT);
  assert_non_null(strstr(err.text, "can only be read"));
  assert_int_equal(vg_format_write("wing", &m, &err), VG_ERR_FORMAT);
}

/* Every format that can be written and read preserves T1's boundary; volume
 * formats its cell too. */
static void every_format_round_trips(void **state)
{
  static const struct {
    const char *suffix;
    int volume, patches;
  } cases[] = { { "stl", 0, 4 },      { "tri", 0, 4 },
                { "obj", 0, 4 },      { "mesh", 1, 4 },
                { "meshb", 1, 4 },    { "ugrid", 1, 4 },
                { "b8.ugrid", 1, 4 }, { "lb8l.ugrid", 1, 4 },
                { "r4.ugrid", 1, 4 }, { "msh", 1, 4 },
                { "cogsg", 1, 4 } };
  const char *stem = io_temp("format_t1");
  struct vg_mesh t1;

  (void)state;
  io_make_t1(&t1, 1);
  for (int k = 0; k < 4; k++) t1.patch[k].bc = k + 1;
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    struct vg_mesh m = VG_MESH_INIT;
    struct vg_read_info info = { 0 };
    struct vg_error err = VG_ERROR_INIT;
    char path[4200];

    snprintf(path, sizeof path, "%s.%s", stem, cases[i].suffix);
    if (vg_mesh_write(stem, cases[i].suffix, &t1, &err))
      fail_msg("%s", err.text);
    if (vg_mesh_read(path, &m, &info, &err)) fail_msg("%s", err.text);
    assert_string_equal(info.format, cases[i].suffix);
    assert_int_equal(info.n_cell, cases[i].volume);
    assert_int_equal(vg_format_holds_cells(path), cases[i].volume);
    assert_int_equal(m.n_tri, 4);
    assert_int_equal(m.n_point, 4);
    assert_int_equal(m.n_patch, cases[i].patches);
    assert_int_equal(info.has_mapbc, !strcmp(cases[i].suffix, "cogsg"));
    if (info.has_mapbc)
      for (int k = 0; k < 4; k++) assert_int_equal(m.patch[k].bc, k + 1);
    vg_mesh_release(&m);
    unlink(path);
  }
  for (int i = 0; i < 2; i++) {
    char path[4200];

    snprintf(path, sizeof path, "%s.%s", stem, i ? "bc" : "mapbc");
    unlink(path);
  }
  assert_int_equal(vg_mesh_write(stem, "vtu", &t1, NULL), VG_OK);
  unlink(io_temp("format_t1.vtu"));
  vg_mesh_release(&t1);
}

static void the_mapbc_in_the_same_folder_is_used(void **state)
{
  static const char text[] = "3\n1 4000 wall\n2 6662 symm\n9 5000 far\n";
  const char *grid = io_temp("format_bc.lb8.ugrid");
  const char *bc = io_temp("format_bc.mapbc");
  const char *packed = io_temp("format_bc.mapbc.gz");
  struct vg_mesh m, back = VG_MESH_INIT;
  struct vg_read_info info = { 0 };
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  io_make_t1(&m, 1);
  assert_int_equal(vg_format_write(grid, &m, &err), VG_OK);
  for (int turn = 0; turn < 2; turn++) {
    if (turn) io_write_gzip(packed, text, sizeof text - 1);
    else io_write_file(bc, text, sizeof text - 1);
    if (vg_surface_read(grid, &back, &info, &err)) fail_msg("%s", err.text);
    assert_int_equal(back.n_tet, 0);
    assert_int_equal(info.n_cell, 1);
    assert_int_equal(info.has_mapbc, 1);
    assert_int_equal(info.layout, VG_MAPBC_FUN3D);
    assert_int_equal(info.match.n_missing, 2);
    assert_int_equal(info.match.first_missing, 3);
    assert_int_equal(info.match.n_unused, 1);
    assert_int_equal(info.match.first_unused, 9);
    assert_string_equal(back.patch[0].name, "wall");
    assert_int_equal(back.patch[0].bc, 4);
    vg_mesh_release(&back);
    unlink(turn ? packed : bc);
  }
  /* A broken companion file is an error, not ignored. */
  io_write_file(bc, "x\n", 2);
  assert_int_equal(vg_mesh_read(grid, &back, &info, &err), VG_ERR_FORMAT);
  assert_non_null(strstr(err.text, "format_bc.mapbc"));
  assert_null(back.point);
  unlink(bc);
  unlink(grid);
  vg_mesh_release(&m);
}

/* A .mapbc written by an earlier run is read with a mesh, but not with a
 * surface unless it is named. */
static void the_mapbc_of_a_run_is_no_input(void **state)
{
  const char *grid = io_temp("format_own.lb8.ugrid");
  const char *bc = io_temp("format_own.mapbc");
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  for (int turn = 0; turn < 3; turn++) {
    struct vg_read_info info = { .mapbc = turn == 2 ? bc : turn ? "" : NULL };
    struct vg_mesh m, back = VG_MESH_INIT;
    const int is_used = turn != 1;

    io_make_t1(&m, turn == 0);
    assert_int_equal(vg_format_write(grid, &m, &err), VG_OK);
    m.patch[0].bc = 4;
    assert_int_equal(vg_mapbc_write_output(bc, &m, "own", NULL, &err), VG_OK);
    if (vg_mesh_read(grid, &back, &info, &err)) fail_msg("%s", err.text);
    assert_int_equal(info.has_mapbc, is_used);
    assert_int_equal(info.has_own_mapbc, !is_used);
    assert_int_equal(back.patch[0].bc, is_used ? 4 : VG_BC_NONE);
    vg_mesh_release(&back);
    vg_mesh_release(&m);
  }
  unlink(grid);
  unlink(bc);
}

/* A tetrahedron around a point inside it: four cells, five points. */
static void surface_files_omit_inner_points(void **state)
{
  static const double point[5][3] = {
    { 0.1, 0.1, 0.1 }, { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }
  };
  static const uint32_t tri[4][3] = {
    { 1, 2, 3 }, { 1, 4, 2 }, { 1, 3, 4 }, { 2, 4, 3 }
  };
  const char *path = io_temp("format_inner.b8.ugrid");
  struct vg_mesh m, back = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  io_make_t1(&m, 0);
  m.point = realloc(m.point, sizeof point);
  memcpy(m.point, point, sizeof point);
  m.n_point = 5;
  memcpy(m.tri, tri, sizeof tri);
  m.tet = malloc(4 * sizeof *m.tet);
  m.n_tet = 4;
  for (int f = 0; f < 4; f++) {
    memcpy(m.tet[f], tri[f], sizeof tri[f]);
    m.tet[f][3] = 0;
  }
  assert_int_equal(vg_format_write(path, &m, &err), VG_OK);
  assert_int_equal(vg_surface_read(path, &back, NULL, &err), VG_OK);
  assert_int_equal(back.n_point, 4);
  assert_int_equal(back.n_tet, 0);
  for (int f = 0; f < 4; f++)
    for (int k = 0; k < 3; k++) assert_int_equal(back.tri[f][k], tri[f][k] - 1);
  assert_memory_equal(back.point, point + 1, 4 * sizeof *point);
  unlink(path);
  vg_mesh_release(&m);
  vg_mesh_release(&back);
}

/* Given its name alone, a .front finds its project. */
static void reads_the_real_project(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_read_info info = { 0 };
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  if (vg_surface_read(io_real("vgrid_box/box.front"), &m, &info, &err))
    fail_msg("%s", err.text);
  assert_int_equal(m.n_patch, 6);
  assert_int_equal(info.has_mapbc, 1);
  assert_int_equal(info.match.n_missing + info.match.n_unused, 0);
  assert_int_equal(m.patch[2].bc, 4);
  assert_int_equal(m.patch[2].bc_fun3d, 4000);
  assert_string_equal(m.patch[2].name, "viscous");
  vg_mesh_release(&m);
}

static void reads_real_surfaces(void **state)
{
  static const char *const name[] = {
    "dirty/f16_components_overlapping.stl.xz", "dirty/three_plugs.bin.tri.xz",
    "dirty/toy_airplane_with_holes.obj.xz", "simple/cape_bullet.tri.xz",
    "simple/cube_sphere_uniform_volume.meshb.xz"
  };
  static const size_t n_tri[] = { 17064, 11280, 16747, 4890, 700 };

  (void)state;
  for (size_t i = 0; i < 5; i++) {
    const char *path = io_real(name[i]);
    struct vg_mesh m = VG_MESH_INIT;
    struct vg_error err = VG_ERROR_INIT;

    if (vg_surface_read(path, &m, NULL, &err)) fail_msg("%s", err.text);
    assert_int_equal(m.n_tri, n_tri[i]);
    assert_int_equal(m.n_tet, 0);
    vg_mesh_release(&m);
    unlink(path);
  }
}

/* A function that returns different numbers in each call. */
static uint32_t next_random(uint32_t *state)
{
  *state = *state * 1664525u + 1013904223u;
  return *state >> 8;
}

/* Append a face with w nodes at a random position of the list of its kind. */
static void insert_face(struct vg_mesh *m, const uint32_t *node, int w,
                        uint32_t patch, uint32_t *random)
{
  size_t n = w == 3 ? m->n_tri++ : m->n_quad++, at = next_random(random) % n;
  uint32_t(*tri)[3] = m->tri, (*quad)[4] = m->quad;
  uint32_t *of = w == 3 ? m->tri_patch : m->quad_patch;

  memmove(of + at + 1, of + at, (n - at) * sizeof *of);
  of[at] = patch;
  if (w == 3) {
    memmove(tri + at + 1, tri + at, (n - at) * sizeof *tri);
    memcpy(tri[at], node, sizeof *tri);
  } else {
    memmove(quad + at + 1, quad + at, (n - at) * sizeof *quad);
    memcpy(quad[at], node, sizeof *quad);
  }
}

/* List a third of the faces between cells as boundary, from one side or both.
 * Patch 3 has only such faces, patch 2 others too. Returns their number. */
static size_t list_inner(struct vg_mesh *m, uint32_t *random)
{
  struct mixed_side *s;
  size_t n = mixed_sides(m, &s), room = m->n_tri + m->n_quad + n, n_inner = 0;

  m->tri = realloc(m->tri, room * sizeof *m->tri);
  m->quad = realloc(m->quad, room * sizeof *m->quad);
  m->tri_patch = realloc(m->tri_patch, room * sizeof *m->tri_patch);
  m->quad_patch = realloc(m->quad_patch, room * sizeof *m->quad_patch);
  vg_mesh_add_patch(m, 14, "interface");
  for (size_t i = 1; i < n; i++) {
    uint32_t what = next_random(random) % 9;

    if (mixed_by_key(s + i - 1, s + i)) continue;
    for (uint32_t side = 0; side < 2; side++) {
      if (what != side && what != 2) continue;
      insert_face(m, s[i - side].node, s[i].node[3] == UINT32_MAX ? 3 : 4,
                  n_inner % 3 ? 3 : 2, random);
      n_inner++;
    }
  }
  free(s);
  return n_inner;
}

static void inner_faces_become_sheets(void **state)
{
  uint32_t random = 7;

  (void)state;
  for (uint32_t turn = 0; turn < 20; turn++) {
    struct vg_mesh m = VG_MESH_INIT, want = VG_MESH_INIT;
    struct vg_inner_faces found;
    size_t n;

    mixed_make(&m, 1 + turn % 4, 1 + turn % 3);
    assert_int_equal(vg_mesh_copy(&want, &m, NULL), VG_OK);
    n = list_inner(&m, &random);
    assert_int_equal(vg_mesh_take_inner(&m, &found, NULL), VG_OK);
    assert_int_equal(found.n_face + found.n_sheet_face, n);
    assert_int_equal(m.n_sheet_tri, found.n_sheet_face);
    if (found.n_face) assert_non_null(strchr(found.patches, '('));
    for (size_t i = 0; i < m.n_sheet; i++) assert_true(m.sheet[i].is_sheet);
    for (size_t t = 0; t < m.n_sheet_tri; t++)
      assert_true(m.sheet_of[t] < m.n_sheet);
    vg_mesh_drop_sheets(&m);
    if (n < 2) m.n_patch = 3; /* patch 3 had no faces at all */
    io_same(&want, &m, 1);
    assert_int_equal(vg_mesh_take_inner(&m, &found, NULL), VG_OK);
    assert_int_equal(found.n_face + found.n_sheet_face, 0);
    assert_string_equal(found.patches, "");
    vg_mesh_release(&m);
    vg_mesh_release(&want);
  }
}

/* Two cells on the same side of a face overlap: the face remains, and the mesh
 * check reports the cells. */
static void faces_of_overlapping_cells_remain(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_inner_faces found;

  (void)state;
  io_make_t1(&m, 1);
  m.tet = realloc(m.tet, 2 * sizeof *m.tet);
  memcpy(m.tet[m.n_tet++], m.tet[0], sizeof *m.tet);
  assert_int_equal(vg_mesh_take_inner(&m, &found, NULL), VG_OK);
  assert_int_equal(found.n_face, 0);
  assert_int_equal(m.n_tri, 4);
  vg_mesh_release(&m);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(suffixes_are_known),
    cmocka_unit_test(unknown_suffixes_list_the_known),
    cmocka_unit_test(every_format_round_trips),
    cmocka_unit_test(the_mapbc_in_the_same_folder_is_used),
    cmocka_unit_test(the_mapbc_of_a_run_is_no_input),
    cmocka_unit_test(surface_files_omit_inner_points),
    cmocka_unit_test(inner_faces_become_sheets),
    cmocka_unit_test(faces_of_overlapping_cells_remain),
    cmocka_unit_test(reads_the_real_project),
    cmocka_unit_test(reads_real_surfaces),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
