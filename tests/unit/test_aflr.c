/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "io_support.h"

#include "io/mesh/aflr.h"
#include "io/mesh/format.h"

static vg_status parse_mesh(struct vg_input *in, struct vg_mesh *m,
                            struct vg_error *err)
{
  return vg_aflr_surf_parse(in, m, NULL, err);
}

typedef vg_status (*settings_parse)(struct vg_input *, struct vg_aflr *,
                                    struct vg_error *);

static void accept_settings(settings_parse parse, const char *text,
                            struct vg_aflr *a)
{
  struct vg_input in = VG_INPUT_INIT;
  struct vg_error err = VG_ERROR_INIT;

  assert_int_equal(vg_input_memory("case", text, strlen(text), &in, &err), 0);
  if (parse(&in, a, &err) != VG_OK) fail_msg("refused: %s", err.text);
  vg_input_release(&in);
}

static void refuse_settings(settings_parse parse, const char *text, size_t size,
                            vg_status code, const char *phrase)
{
  struct vg_input in = VG_INPUT_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_aflr a = VG_AFLR_INIT;
  vg_status st;

  assert_int_equal(vg_input_memory("case", text, size, &in, &err), 0);
  st = parse(&in, &a, &err);
  if (st != code || err.code != code || !strstr(err.text, phrase) ||
      !strstr(err.text, "case"))
    fail_msg("status %d instead of %d, '%s' has no '%s'", st, code, err.text,
             phrase);
  assert_int_equal(a.n, 0);
  assert_null(a.patch);
  vg_input_release(&in);
}

/* The sample of formats.md 2.5. */
static const char t1_surf[] =
  "4 0 4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
  "1 2 3 1 7 -1\n1 4 2 2 7 1\n1 3 4 3 7 0\n2 4 3 4 7 2\n";

static vg_status parse_both(const char *text, struct vg_mesh *m,
                            struct vg_aflr *a)
{
  struct vg_input in = VG_INPUT_INIT;
  struct vg_error err = VG_ERROR_INIT;
  vg_status st;

  assert_int_equal(vg_input_memory("case", text, strlen(text), &in, &err), 0);
  st = vg_aflr_surf_parse(&in, m, a, &err);
  if (st) fail_msg("refused: %s", err.text);
  vg_input_release(&in);
  return st;
}

static void reads_the_sample(void **state)
{
  static const int32_t flag[4] = { -1, 1, 0, 2 };
  struct vg_mesh m = VG_MESH_INIT, t1;
  struct vg_aflr a = VG_AFLR_INIT;

  (void)state;
  parse_both(t1_surf, &m, &a);
  io_make_t1(&t1, 0);
  io_same(&t1, &m, 1);
  assert_int_equal(a.n, 4);
  assert_null(a.spacing);
  assert_null(a.thickness);
  for (int i = 0; i < 4; i++) {
    assert_int_equal(a.patch[i].id, i + 1);
    assert_int_equal(a.patch[i].flag, flag[i]);
    assert_int_equal(a.patch[i].is_viscous, i == 0);
    assert_true(a.patch[i].spacing == 0 && a.patch[i].thickness == 0);
  }
  assert_int_equal(m.patch[0].bc, 4);
  assert_int_equal(m.patch[0].bc_fun3d, 4000);
  assert_int_equal(m.patch[1].bc, 3);
  assert_int_equal(m.patch[1].bc_fun3d, 5000);
  assert_int_equal(m.patch[2].bc, VG_BC_NONE);
  assert_int_equal(m.patch[3].bc, VG_BC_NONE);
  assert_int_equal(m.patch[3].bc_fun3d, VG_BC_NONE);
  vg_mesh_release(&m);
  vg_mesh_release(&t1);
  vg_aflr_release(&a);
}

static void reads_columns_quads_and_short_lines(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_aflr a = VG_AFLR_INIT;

  (void)state;
  parse_both("2 1 5\r\n"
             "0 0 0 1e-5 0.25\n1 0 0 1e-5 0.25\n1 1 0 1.0d-5 .25\n"
             "0 1 0 2e-5 0.25\n2 2 2 -1 0\n\n"
             "1 2 3 9\n3 4 1 -2 7\n\n1 2 3 4 9 7 -1\n",
             &m, &a);
  assert_int_equal(m.n_quad, 1);
  assert_int_equal(m.quad[0][3], 3);
  assert_int_equal(m.n_patch, 2);
  assert_int_equal(m.patch[0].id, -2);
  assert_int_equal(m.patch[1].id, 9);
  assert_int_equal(a.n_point, 5);
  assert_true(a.spacing[2] == 1e-5 && a.spacing[3] == 2e-5);
  assert_true(a.thickness[0] == 0.25 && a.thickness[4] == 0);
  assert_int_equal(a.patch[0].flag, VG_AFLR_NONE);
  assert_int_equal(a.patch[0].is_viscous, 0);
  /* Patch 9 is defined by its quadrilateral; points 1 to 4 differ in
   * spacing. */
  assert_int_equal(a.patch[1].flag, -1);
  assert_true(a.patch[1].spacing == 0);
  assert_true(a.patch[1].thickness == 0.25);
  vg_mesh_release(&m);
  parse_both("1 0 3\n0 0 0 3e-6\n1 0 0 3e-6\n0 1 0 3e-6\n1 2 3 5 0 -1\n", &m,
             &a);
  assert_non_null(a.spacing);
  assert_null(a.thickness);
  assert_true(a.patch[0].spacing == 3e-6);
  vg_mesh_release(&m);
  vg_aflr_release(&a);
}

/* The majority of faces decides; if equal, the lower flag. */
static void faces_vote_for_their_patch(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_aflr a = VG_AFLR_INIT;

  (void)state;
  parse_both("7 0 3\n0 0 0\n1 0 0\n0 1 0\n"
             "1 2 3 1 0 -1\n1 2 3 1 0 2\n1 2 3 1 0 2\n1 2 3 1\n"
             "1 2 3 2 0 0\n1 2 3 2 0 -1\n1 2 3 3 0 -6\n",
             &m, &a);
  assert_int_equal(a.patch[0].flag, 2);
  assert_int_equal(a.patch[1].flag, -1);
  assert_int_equal(a.patch[2].flag, -6);
  assert_int_equal(m.patch[0].bc, VG_BC_NONE);
  assert_int_equal(m.patch[1].bc, 4);
  assert_int_equal(m.patch[2].bc, 4);
  vg_mesh_release(&m);
  vg_aflr_release(&a);
}

static void refuses_broken_surfaces(void **state)
{
#define HEAD "1 0 3\n0 0 0\n1 0 0\n0 1 0\n"
  static const struct {
    const char *text;
    vg_status code;
    const char *word;
  } bad[] = {
    { "1 0", VG_ERR_FORMAT, "number of points" },
    { "-1 0 3\n", VG_ERR_FORMAT, "number of triangles" },
    { "9999999999 0 3\n", VG_ERR_FORMAT, "must be between" },
    { "4294967293 4294967293 4294967293\n", VG_ERR_FORMAT, "truncated" },
    { "1 0 3\n0 0\n1 0 0\n0 1 0\n1 2 3 1 0 0 0 0 0\n", VG_ERR_FORMAT,
      "3 to 5 numbers" },
    { "1 0 3\n0 0 0 1 1 1\n1 0 0\n0 1 0\n1 2 3 1\n", VG_ERR_FORMAT,
      "3 to 5 numbers" },
    { "1 0 3\n0 0 0\n1 0 nan\n0 1 0\n1 2 3 1\n", VG_ERR_FORMAT, "case:3:" },
    { "1 0 3\n0 0 0\n1 0 1e999\n0 1 0\n1 2 3 1\n", VG_ERR_FORMAT, "case:3:" },
    { "1 0 3\n0 0 0\n1 0 1e99\n0 1 0\n1 2 3 1\n", VG_ERR_INPUT, "point 2" },
    { HEAD "1 2 4 1 0 0\n", VG_ERR_INPUT, "triangle 1 refers to point 4" },
    { HEAD "1 2 0 1 0 0\n", VG_ERR_INPUT, "case:5: triangle 1" },
    { HEAD "1 2 3\n1 0 0\n", VG_ERR_FORMAT, "line of triangle 1" },
    { HEAD "1 2 3 1 0 0 0\n", VG_ERR_FORMAT, "line of triangle 1" },
    { HEAD "1 2 3 x 0\n", VG_ERR_FORMAT, "line of triangle 1" },
    { HEAD "1 2 3 3000000000\n", VG_ERR_FORMAT, "line of triangle 1" },
    { HEAD "1 2 3 1 0 99\n", VG_ERR_FORMAT, "flag 99" },
    { HEAD "1 2 3 1 0 -2147483648\n", VG_ERR_FORMAT, "flag" },
    { "0 1 3\n0 0 0\n1 0 0\n0 1 0\n1 2 3 4 5 6 0\n", VG_ERR_INPUT,
      "quadrilateral 1 refers to point 4" },
    { "2 0 3\n0 0 0\n1 0 0\n0 1 0\n1 2 3 1 0 00000000\n", VG_ERR_FORMAT,
      "triangle" },
  };

  (void)state;
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
    io_refuse(parse_mesh, bad[i].text, bad[i].code, bad[i].word);
  io_refuse_bytes(parse_mesh, "\0\0\0\1\0\0\0\0\0\0\0\3", 12, VG_ERR_FORMAT,
                  "binary");
#undef HEAD
}

static void tags_files_of_every_version(void **state)
{
  struct vg_aflr a = VG_AFLR_INIT;

  (void)state;
  accept_settings(vg_aflr_tags_parse,
                  "#  Trans Initial BL\n#ID Group Visc ...\n"
                  "1 Wall 1 1 0 0 0 0 0 1.0e-6 1.0e-2 41\n"
                  "  -7 Symmetry 0 0 1 0 0 0 0 0 0 0\n\n"
                  "30 Control 0 0 0 0 0 0 1 0 0 0\n"
                  "4 FarField 0 1 0 0 0 0 0 0 0\n"
                  "5 Old 1 1 0 0 0 0 2d-5 0.5\n"
                  "6 Both 1 1 0 0 0 1 0 2d-5 0.5 3\n"
                  "# end",
                  &a);
  assert_int_equal(a.n, 6);
  assert_string_equal(a.patch[0].name, "Wall");
  assert_int_equal(a.patch[0].is_viscous, 1);
  assert_int_equal(a.patch[0].flag, -1);
  assert_true(a.patch[0].spacing == 1e-6 && a.patch[0].thickness == 1e-2);
  assert_int_equal(a.patch[0].n_layer, 41);
  assert_int_equal(a.patch[1].id, -7);
  assert_int_equal(a.patch[1].flag, 2);
  assert_int_equal(a.patch[2].flag, 5);
  assert_int_equal(a.patch[3].flag, 0);
  assert_int_equal(a.patch[3].n_layer, 0);
  assert_string_equal(a.patch[3].name, "FarField");
  assert_int_equal(a.patch[4].is_viscous, 1);
  assert_true(a.patch[4].spacing == 2e-5 && a.patch[4].thickness == 0.5);
  /* `trans` comes after `visc`, so it overrides it. */
  assert_int_equal(a.patch[5].is_viscous, 0);
  accept_settings(vg_aflr_tags_parse, "# nothing\n", &a);
  assert_int_equal(a.n, 0);
  vg_aflr_release(&a);
}

static void refuses_broken_tags(void **state)
{
  static const struct {
    const char *text;
    vg_status code;
    const char *word;
  } bad[] = {
    { "1 Wall 1 1 0 0 0 0 0 1e-6\n1 W 1\n", VG_ERR_FORMAT, "case:2:" },
    { "\nx Wall 1 1 0 0 0 0 0 1e-6 1 1\n", VG_ERR_FORMAT, "case:2:" },
    { "1 A B 1 1 0 0 0 0 0 1e-6 1 1\n", VG_ERR_FORMAT, "case:1:" },
    { "1 W 1 1 0 0 0 0 0 -1e-6 1 1\n", VG_ERR_FORMAT, "case:1:" },
    { "1 W 1 1 0 0 0 0 0 inf 1 1\n", VG_ERR_FORMAT, "case:1:" },
    { "1 W 1 1 0 0 0 0 0 0 1 -1\n", VG_ERR_FORMAT, "case:1:" },
    { "1 W 1 1 0 0 0 0 0 0 1 3000000000\n", VG_ERR_FORMAT, "case:1:" },
    { "1 W 1 1 0 0 0 0 0 0 1 1 1 1 1 1 1 1 1\n", VG_ERR_FORMAT, "case:1:" },
    { "7 W 1 1 0 0 0 0 0 0\n1 X 1 1 0 0 0 0 0 0\n7 Z 1 1 0 0 0 0 0 0\n",
      VG_ERR_INPUT, "patch 7" },
  };

  (void)state;
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
    refuse_settings(vg_aflr_tags_parse, bad[i].text, strlen(bad[i].text),
                    bad[i].code, bad[i].word);
  refuse_settings(vg_aflr_tags_parse, "1 W\0 1", 6, VG_ERR_FORMAT, "binary");
}

static void conditions_by_name(void **state)
{
  struct vg_aflr a = VG_AFLR_INIT;

  (void)state;
  accept_settings(vg_aflr_bc_parse,
                  "farfield           1\n"
                  "# wall\nbullet_total      -1   0.01 0.5\r\nfin -1 2D-3\n",
                  &a);
  assert_int_equal(a.n, 3);
  assert_string_equal(a.patch[0].name, "farfield");
  assert_int_equal(a.patch[0].flag, 1);
  assert_int_equal(a.patch[0].is_viscous, 0);
  assert_int_equal(a.patch[1].is_viscous, 1);
  assert_true(a.patch[1].spacing == 0.01 && a.patch[1].thickness == 0.5);
  assert_true(a.patch[2].spacing == 2e-3 && a.patch[2].thickness == 0);
  vg_aflr_release(&a);
#define REFUSE(text, code, word)                                               \
  refuse_settings(vg_aflr_bc_parse, text, strlen(text), code, word)
  REFUSE("       4       4       4       1\n Triangle\n", VG_ERR_FORMAT,
         "VGRID");
  REFUSE("wall\n", VG_ERR_FORMAT, "case:1:");
  REFUSE("wall one\n", VG_ERR_FORMAT, "case:1:");
  REFUSE("wall -1 -1\n", VG_ERR_FORMAT, "case:1:");
  REFUSE("wall -2147483648\n", VG_ERR_FORMAT, "case:1:");
  REFUSE("ok 1\nwall -1 1 1 1\n", VG_ERR_FORMAT, "case:2:");
  REFUSE("wall -1\nfar 1\nwall 1\n", VG_ERR_INPUT, "wall is listed twice");
#undef REFUSE
}

static void distinguished_from_vgrid_files(void **state)
{
  const char *path = io_temp("apart.bc");

  (void)state;
  io_write_file(path, "# x\nwall -1\n", 12);
  assert_true(vg_aflr_is_bc(path));
  io_write_file(path, " 4 4 4 1\nTitle\n", 15);
  assert_false(vg_aflr_is_bc(path));
  io_write_file(path, "\0\0\0\0", 4);
  assert_false(vg_aflr_is_bc(path));
  unlink(path);
  assert_false(vg_aflr_is_bc(path));
}

static void settings_are_applied(void **state)
{
  struct vg_aflr a = VG_AFLR_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_mesh m;
  size_t unused;

  (void)state;
  io_make_t1(&m, 0);
  strcpy(m.patch[1].name, "mine");
  m.patch[1].bc = 4;
  m.patch[1].bc_fun3d = 4000;
  m.patch[2].bc = 3;
  m.patch[3].bc = 44;
  accept_settings(vg_aflr_tags_parse,
                  "9 Nobody 1 1 0 0 0 0 0 0 0 0\n"
                  "1 Wall 1 1 0 0 0 0 0 0 0 0\n2 Body 0 1 0 0 0 0 0 0 0 0\n"
                  "3 Far 0 1 0 0 0 0 0 0 0 0\n",
                  &a);
  if (vg_aflr_apply(&a, &m, &unused, &err)) fail_msg("%s", err.text);
  assert_int_equal(unused, 1);
  assert_string_equal(m.patch[0].name, "Wall");
  assert_int_equal(m.patch[0].bc, 4);
  assert_int_equal(m.patch[0].bc_fun3d, 4000);
  assert_string_equal(m.patch[1].name, "mine");
  assert_int_equal(m.patch[1].bc, 5);
  assert_int_equal(m.patch[1].bc_fun3d, 3000);
  assert_int_equal(m.patch[2].bc, 3);
  assert_int_equal(m.patch[3].bc, 44);
  accept_settings(vg_aflr_bc_parse, "mine -1 1e-5\nWall 1\nthird -1\n", &a);
  assert_int_equal(vg_aflr_apply(&a, &m, &unused, &err), VG_OK);
  assert_int_equal(unused, 1);
  assert_int_equal(m.patch[1].bc, 4);
  assert_int_equal(m.patch[0].bc, 5);
  assert_int_equal(m.patch[2].bc, 3);
  vg_mesh_release(&m);
  vg_aflr_release(&a);
}

/* As an input surface, found by its name; a .mapbc in the same folder overrides
 * the flags. */
static void is_a_format(void **state)
{
  const char *path = io_temp("aflr_t1.surf"), *bc = io_temp("aflr_t1.mapbc");
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_read_info info = { 0 };
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  io_write_file(path, t1_surf, sizeof t1_surf - 1);
  if (vg_surface_read(path, &m, &info, &err)) fail_msg("%s", err.text);
  assert_string_equal(info.format, "surf");
  assert_int_equal(m.patch[0].bc, 4);
  assert_int_equal(m.patch[1].bc, 3);
  vg_mesh_release(&m);
  io_write_file(bc, "2\n2 3000 body\n4 6662 sym\n", 25);
  if (vg_surface_read(path, &m, &info, &err)) fail_msg("%s", err.text);
  assert_int_equal(m.patch[0].bc, 4);
  assert_int_equal(m.patch[1].bc, 5);
  assert_int_equal(m.patch[3].bc, 1);
  vg_mesh_release(&m);
  assert_int_equal(vg_format_write(path, &m, &err), VG_ERR_FORMAT);
  unlink(path);
  unlink(bc);
  assert_int_equal(vg_aflr_surf_read(path, &m, NULL, &err), VG_ERR_IO);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(reads_the_sample),
    cmocka_unit_test(reads_columns_quads_and_short_lines),
    cmocka_unit_test(faces_vote_for_their_patch),
    cmocka_unit_test(refuses_broken_surfaces),
    cmocka_unit_test(tags_files_of_every_version),
    cmocka_unit_test(refuses_broken_tags),
    cmocka_unit_test(conditions_by_name),
    cmocka_unit_test(distinguished_from_vgrid_files),
    cmocka_unit_test(settings_are_applied),
    cmocka_unit_test(is_a_format),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
