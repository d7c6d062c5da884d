/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "io_support.h"

#include "io/vgrid/mapbc.h"

static const char vgrid_sample[] =
  "#case T1\n#bc.map\n"
  "Patch #        BC             Family   #surf   surfIDs         Family\n"
  "#---------------------------------------------------------------------\n"
  "1              4              4              0            0        wall\n"
  "2              1              1              0            0        symm\n"
  "3              3              3              0            0        far\n"
  "4              3              3              0            0        far\n";

static const char fun3d_sample[] =
  "4\n1 4000 wall\n2 6662 symm\n3 5000 far\n4 5000 far\n";

static vg_status parse(const char *text, struct vg_mapbc *b,
                       struct vg_error *err)
{
  struct vg_input in = VG_INPUT_INIT;
  vg_status st = vg_input_memory("case", text, strlen(text), &in, err);

  if (st == VG_OK) st = vg_mapbc_parse(&in, b, err);
  vg_input_release(&in);
  return st;
}

static void accept(const char *text, struct vg_mapbc *b)
{
  struct vg_error err = VG_ERROR_INIT;

  if (parse(text, b, &err)) fail_msg("%s", err.text);
}

static void reads_both_layouts(void **state)
{
  struct vg_mapbc b = VG_MAPBC_INIT;

  (void)state;
  accept(vgrid_sample, &b);
  assert_int_equal(b.layout, VG_MAPBC_VGRID);
  assert_int_equal(b.n, 4);
  assert_int_equal(b.entry[0].bc, 4);
  assert_int_equal(b.entry[0].bc_fun3d, 4000);
  assert_int_equal(b.entry[1].family, 1);
  assert_string_equal(b.entry[3].name, "far");
  accept(fun3d_sample, &b);
  assert_int_equal(b.layout, VG_MAPBC_FUN3D);
  assert_int_equal(b.n, 4);
  assert_int_equal(b.entry[1].bc, 1);
  assert_int_equal(b.entry[1].bc_fun3d, 6662);
  assert_int_equal(b.entry[2].bc, 3);
  assert_string_equal(b.entry[0].name, "wall");
  vg_mapbc_release(&b);
}

/* The header is four lines of any content; old files have two or five columns;
 * names may be several words. */
static void reads_variations(void **state)
{
  struct vg_mapbc b = VG_MAPBC_INIT;

  (void)state;
  accept("12\nx\n# 3\n\n7 4\r\n8 3 3 0 0\n\n9 1 1 0 0 the  symmetry plane \n",
         &b);
  assert_int_equal(b.layout, VG_MAPBC_VGRID);
  assert_int_equal(b.n, 3);
  assert_int_equal(b.entry[0].id, 7);
  assert_int_equal(b.entry[0].family, 4);
  assert_string_equal(b.entry[1].name, "");
  assert_string_equal(b.entry[2].name, "the  symmetry plane");
  /* A shorter header: the first patch is among the first four lines. */
  accept("#title\n5 4 4 0 0 wing\n6 3 3 0 0 far\n", &b);
  assert_int_equal(b.n, 2);
  assert_int_equal(b.entry[0].id, 5);
  accept("\n 2 \n1 4000\n\n2 -4100 rough wall\n", &b);
  assert_int_equal(b.layout, VG_MAPBC_FUN3D);
  assert_int_equal(b.n, 2);
  assert_int_equal(b.entry[1].bc, 4);
  assert_string_equal(b.entry[1].name, "rough wall");
  /* FUN3D accepts the old codes 3, 4, 5. */
  accept("3\n1 3 far\n2 4 wall\n3 5 slip\n", &b);
  assert_int_equal(b.entry[0].bc_fun3d, 5000);
  assert_int_equal(b.entry[1].bc_fun3d, 4000);
  assert_int_equal(b.entry[2].bc_fun3d, 3000);
  assert_int_equal(b.entry[2].bc, 5);
  vg_mapbc_release(&b);
}

static void refuses_invalid_files(void **state)
{
  static const struct {
    const char *text, *phrase;
    vg_status code;
  } cases[] = {
    { "", "empty", VG_ERR_FORMAT },
    { "a\nb\nc\nd\n", "no patch line", VG_ERR_FORMAT },
    { "3\n1 4000 wall\n2 5000 far\n", "announces 3", VG_ERR_FORMAT },
    { "2\n1 4000 wall\nx 5000 far\n", "case:3", VG_ERR_FORMAT },
    { "a\nb\nc\nd\n1 4 4 0 0 w\n2\n", "case:6", VG_ERR_FORMAT },
    { "a\nb\nc\nd\n1 99999999999 4 0 0 w\n", "case:5", VG_ERR_FORMAT },
    { "a\nb\nc\nd\n1 4 4 0 0 w\n1 3 3 0 0 w\n", "listed twice", VG_ERR_INPUT },
    { "a\001b\nc\n", "binary", VG_ERR_FORMAT },
  };

  (void)state;
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    struct vg_mapbc b = VG_MAPBC_INIT;
    struct vg_error err = VG_ERROR_INIT;

    assert_int_equal(parse(cases[i].text, &b, &err), cases[i].code);
    if (!strstr(err.text, cases[i].phrase)) fail_msg("%s", err.text);
    assert_null(b.entry);
  }
}

static void translates_codes(void **state)
{
  static const int32_t both[][2] = { { 0, 5050 },   { 2, 5026 },  { 3, 5000 },
                                     { 4, 4000 },   { 5, 3000 },  { 101, 5051 },
                                     { 102, 7011 }, { 103, 7036 } };

  (void)state;
  for (size_t i = 0; i < sizeof both / sizeof *both; i++) {
    assert_int_equal(vg_bc_to_fun3d(both[i][0], -1), both[i][1]);
    assert_int_equal(vg_bc_to_usm3d(both[i][1]), both[i][0]);
  }
  for (int axis = 0; axis < 3; axis++) {
    assert_int_equal(vg_bc_to_fun3d(1, axis), 6661 + axis);
    assert_int_equal(vg_bc_to_usm3d(6661 + axis), 1);
  }
  assert_int_equal(vg_bc_to_fun3d(1, -1), 3000);
  assert_int_equal(vg_bc_to_usm3d(5052), 101);
  assert_int_equal(vg_bc_to_fun3d(77777, 0), 77777);
  assert_int_equal(vg_bc_to_usm3d(6100), 6100);
  assert_int_equal(vg_bc_to_usm3d(VG_BC_NONE), VG_BC_NONE);
  assert_int_equal(vg_bc_to_fun3d(VG_BC_NONE, 0), VG_BC_NONE);
}

static void applies_to_a_mesh(void **state)
{
  struct vg_mapbc b = VG_MAPBC_INIT;
  struct vg_mapbc_match match;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_mesh m;

  (void)state;
  io_make_t1(&m, 0);
  accept("1\n2\n3\n4\n9 3 3 0 0 unused\n3 1 1 0 0 plane\n1 1 1 0 0 floor\n"
         "4 1 1 0 0 skew\n8 3 3 0 0 unused\n",
         &b);
  assert_int_equal(vg_mapbc_apply(&b, &m, &match, &err), VG_OK);
  assert_int_equal(match.n_missing, 1);
  assert_int_equal(match.first_missing, 2);
  assert_int_equal(match.n_unused, 2);
  assert_int_equal(match.first_unused, 8);
  /* Patch 1 is z = 0, 3 is x = 0, 4 is slanted. */
  assert_int_equal(m.patch[0].bc_fun3d, 6663);
  assert_int_equal(m.patch[2].bc_fun3d, 6661);
  assert_int_equal(m.patch[3].bc_fun3d, 3000);
  assert_int_equal(m.patch[1].bc, VG_BC_NONE);
  assert_string_equal(m.patch[2].name, "plane");
  vg_mapbc_release(&b);
  vg_mesh_release(&m);
}

/* Patches with names, and numbers that are their order. */
static void name_patches(struct vg_mesh *m, const char *const name[4])
{
  io_make_t1(m, 0);
  for (int i = 0; i < 4; i++) {
    assert_int_equal(m->patch[i].id, i + 1);
    m->patch[i].bc = VG_BC_NONE;
    snprintf(m->patch[i].name, sizeof m->patch[i].name, "%s", name[i]);
  }
}

/* Conditions of the patches after applying the lines by name. */
static void expect_by_name(const char *const name[4], const char *lines,
                           const int32_t bc[4], size_t n_missing)
{
  struct vg_mapbc b = VG_MAPBC_INIT;
  struct vg_mapbc_match match;
  struct vg_error err = VG_ERROR_INIT;
  char text[1000];
  struct vg_mesh m;

  name_patches(&m, name);
  snprintf(text, sizeof text, "1\n2\n3\n4\n%s", lines);
  accept(text, &b);
  if (vg_mapbc_apply_names("case", &b, 26, &m, &match, &err))
    fail_msg("%s", err.text);
  for (int i = 0; i < 4; i++) assert_int_equal(m.patch[i].bc, bc[i]);
  assert_int_equal(match.n_missing, n_missing);
  vg_mapbc_release(&b);
  vg_mesh_release(&m);
}

static void refuse_by_name(const char *const name[4], const char *lines,
                           const char *phrase)
{
  struct vg_mapbc b = VG_MAPBC_INIT;
  struct vg_error err = VG_ERROR_INIT;
  char text[1000];
  struct vg_mesh m;

  name_patches(&m, name);
  snprintf(text, sizeof text, "1\n2\n3\n4\n%s", lines);
  accept(text, &b);
  assert_int_equal(vg_mapbc_apply_names("case", &b, 26, &m, NULL, &err),
                   VG_ERR_INPUT);
  assert_non_null(strstr(err.text, phrase));
  for (int i = 0; i < 4; i++) assert_int_equal(m.patch[i].bc, VG_BC_NONE);
  vg_mapbc_release(&b);
  vg_mesh_release(&m);
}

static void names_go_before_numbers_without_meaning(void **state)
{
  static const char *const plain[4] = { "wall", "symm", "far", "end" };
  static const char *const other[4] = { "left wing", "", "disk", "a_name_of" };
  static const char *const word[4] = { "patch__inlet_x_", "wall", "wall_8",
                                       "b" };
  static const int32_t four[4] = { 4, 1, 3, 2 };
  static const int32_t none = VG_BC_NONE;

  (void)state;
  /* Other numbers; an entry that no patch has. */
  expect_by_name(plain,
                 "1 1 1 0 0 symm\n2 3 3 0 0 far\n5 4 4 0 0 wall\n"
                 "7 2 2 0 0 end\n4 5 5 0 0 none\n",
                 four, 0);
  /* Names agree with numbers, in any order of the lines. */
  expect_by_name(plain,
                 "4 2 2 0 0 end\n2 1 1 0 0 symm\n1 4 4 0 0 wall\n"
                 "3 3 3 0 0 far\n",
                 four, 0);
  /* Lines without a name, and patches without one. */
  expect_by_name(plain, "1 4 4 0 0\n2 1 1 0 0\n3 3 3 0 0\n4 2 2 0 0\n", four,
                 0);
  expect_by_name(other,
                 "9 4 4 0 0 left_wing\n2 1 1 0 0 patch_2\n"
                 "3 3 3 0 0 a_name_of\n",
                 (int32_t[]){ 4, 1, none, 3 }, 1);
  /* Words of a CGNS file; of equal names, that with the number. */
  expect_by_name(word,
                 "5 1 1 0 0 (inlet x)\n6 4 4 0 0 wall\n8 2 2 0 0 wall\n"
                 "4 3 3 0 0 b\n2 4 4 0 0 wall\n",
                 (int32_t[]){ 1, 4, 2, 3 }, 0);
  refuse_by_name(plain, "1 4 4 0 0 wall\n2 1 1 0 0 plane\n",
                 "patch 2 is 'plane' here but 'symm' in the mesh");
  refuse_by_name(plain, "1 1 1 0 0 a\n2 3 3 0 0 far\n", "remove or rename");
  /* No name of the mesh: the patches get other names. */
  expect_by_name(plain, "1 1 1 0 0 a\n2 3 3 0 0 b\n",
                 (int32_t[]){ 1, 3, none, none }, 2);
  refuse_by_name(plain, "5 4 4 0 0 wall\n6 3 3 0 0 wall\n",
                 "lines 5 and 6, with codes 4 and 3, both have the name");
}

static void writes_samples_byte_for_byte(void **state)
{
  const char *path = io_temp("mapbc_out.mapbc");
  struct vg_mapbc b = VG_MAPBC_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_mesh m;
  unsigned char *data;
  size_t size, n_unset;

  (void)state;
  io_make_t1(&m, 0);
  accept(vgrid_sample, &b);
  assert_int_equal(vg_mapbc_apply(&b, &m, NULL, &err), VG_OK);
  assert_int_equal(vg_mapbc_write(path, &m, VG_MAPBC_VGRID, "case T1", &n_unset,
                                  &err),
                   VG_OK);
  assert_int_equal(n_unset, 0);
  data = io_slurp(path, &size);
  assert_string_equal((char *)data, vgrid_sample);
  free(data);
  assert_int_equal(vg_mapbc_write(path, &m, VG_MAPBC_FUN3D, NULL, NULL, &err),
                   VG_OK);
  data = io_slurp(path, &size);
  assert_string_equal((char *)data, fun3d_sample);
  free(data);
  unlink(path);
  vg_mapbc_release(&b);
  vg_mesh_release(&m);
}

static void writes_patches_without_a_condition(void **state)
{
  const char *path = io_temp("mapbc_unset.mapbc");
  struct vg_mapbc b = VG_MAPBC_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_mesh m;
  size_t n_unset;

  (void)state;
  io_make_t1(&m, 0);
  snprintf(m.patch[1].name, sizeof m.patch[1].name, "upper\twing \n#1");
  m.patch[2].bc_fun3d = 5000;
  m.patch[3].bc = 44;
  for (int layout = 0; layout < 2; layout++) {
    assert_int_equal(vg_mapbc_write(path, &m, (enum vg_mapbc_layout)layout,
                                    NULL, &n_unset, &err),
                     VG_OK);
    assert_int_equal(n_unset, 2);
    if (vg_mapbc_read(path, &b, &err)) fail_msg("%s", err.text);
    assert_int_equal(b.layout, layout);
    assert_int_equal(b.n, 4);
    assert_int_equal(b.entry[0].bc, 5);
    assert_int_equal(b.entry[0].bc_fun3d, 3000);
    assert_string_equal(b.entry[0].name, "patch_1");
    assert_string_equal(b.entry[1].name, "upper_wing__#1");
    assert_int_equal(b.entry[2].bc, 3);
    assert_int_equal(b.entry[3].bc_fun3d, 4000);
  }
  unlink(path);
  vg_mapbc_release(&b);
  vg_mesh_release(&m);
}

static int is_output(const char *path)
{
  int is;

  assert_int_equal(vg_mapbc_is_output(path, &is, NULL), VG_OK);
  return is;
}

/* The reader recognises a .mapbc that a run wrote by the mark in its title.
 * Both the longest title and an empty one keep the mark. */
static void an_output_is_known_again(void **state)
{
  const char *path = io_temp("mapbc_marked.mapbc");
  struct vg_mapbc b = VG_MAPBC_INIT;
  struct vg_error err = VG_ERROR_INIT;
  char title[1001];
  struct vg_mesh m;
  unsigned char *data;
  size_t size;

  (void)state;
  memset(title, 't', sizeof title - 1);
  title[sizeof title - 1] = 0;
  io_make_t1(&m, 0);
  for (int turn = 0; turn < 3; turn++) {
    const char *t = turn ? turn > 1 ? title : "" : NULL;

    assert_int_equal(vg_mapbc_write(path, &m, VG_MAPBC_VGRID, t, NULL, &err),
                     VG_OK);
    assert_int_equal(is_output(path), 0);
    assert_int_equal(vg_mapbc_write_output(path, &m, t, NULL, &err), VG_OK);
    assert_int_equal(is_output(path), 1);
    if (vg_mapbc_read(path, &b, &err)) fail_msg("%s", err.text);
    assert_int_equal(b.layout, VG_MAPBC_VGRID);
    assert_int_equal(b.n, 4);
  }
  data = io_slurp(path, &size);
  io_write_gzip(path, data, size);
  assert_int_equal(is_output(path), 1);
  /* on another line it means nothing */
  io_write_file(path, "#\n# [written by vanguard mesh]\n", 31);
  assert_int_equal(is_output(path), 0);
  unlink(path);
  assert_int_equal(is_output(path), 0);
  free(data);
  vg_mapbc_release(&b);
  vg_mesh_release(&m);
}

static void survives_damage(void **state)
{
  static const char *const sample[2] = { vgrid_sample, fun3d_sample };
  uint32_t seed = 5;

  (void)state;
  for (int s = 0; s < 2; s++) {
    size_t n = strlen(sample[s]);
    char *work = malloc(n + 1);

    for (int turn = 0; turn < 10000; turn++) {
      struct vg_mapbc b = VG_MAPBC_INIT;
      struct vg_error err = VG_ERROR_INIT;

      memcpy(work, sample[s], n + 1);
      for (int k = 0; k < 1 + turn % 3; k++) {
        seed = seed * 1664525u + 1013904223u;
        work[(seed >> 8) % n] = (char)(seed >> 24);
      }
      if (turn % 5 == 0) work[(seed >> 4) % n] = 0;
      parse(work, &b, &err);
      vg_mapbc_release(&b);
    }
    free(work);
  }
}

static void reads_the_real_file(void **state)
{
  struct vg_mapbc b = VG_MAPBC_INIT;
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  if (vg_mapbc_read(io_real("vgrid_box/box.mapbc"), &b, &err))
    fail_msg("%s", err.text);
  assert_int_equal(b.n, 6);
  assert_int_equal(b.entry[2].bc, 4);
  assert_string_equal(b.entry[2].name, "viscous");
  assert_string_equal(b.entry[3].name, "Box");
  vg_mapbc_release(&b);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(reads_both_layouts),
    cmocka_unit_test(reads_variations),
    cmocka_unit_test(refuses_invalid_files),
    cmocka_unit_test(translates_codes),
    cmocka_unit_test(applies_to_a_mesh),
    cmocka_unit_test(names_go_before_numbers_without_meaning),
    cmocka_unit_test(writes_samples_byte_for_byte),
    cmocka_unit_test(writes_patches_without_a_condition),
    cmocka_unit_test(an_output_is_known_again),
    cmocka_unit_test(survives_damage),
    cmocka_unit_test(reads_the_real_file),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
