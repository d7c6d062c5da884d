/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "io_support.h"

#include "io/mesh/obj.h"

static const char sample[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\ng floor\nf 1 3 2\n";

static const char everything[] =
  "# comment\nmtllib a.mtl\no body\nv 0 0 0 1.0\nvt 0 0\nvn 0 0 1\n"
  "v 1 0 0\r\nv 1 1 0 # behind\nv 0 1 0\nv 0.5 1.5e0 0\nusemtl red\ns off\n"
  "f 1/1/1 2//1 3/1 5 -2/1/1\n"
  "g wing tip \nf -5 \\\n -4 -3\ng never used\ng body\nf 1 2 6\n"
  "v 0 0 1\n";

static void reads_the_sample(void **state)
{
  static const uint32_t tri[3] = { 0, 2, 1 };
  struct vg_mesh m = VG_MESH_INIT;

  (void)state;
  io_accept(vg_obj_parse, sample, &m);
  assert_int_equal(m.n_point, 3);
  assert_int_equal(m.n_tri, 1);
  assert_memory_equal(m.tri[0], tri, sizeof tri);
  assert_string_equal(m.patch[0].name, "floor");
  vg_mesh_release(&m);
}

static void reads_polygons_and_groups(void **state)
{
  static const uint32_t tri[5][3] = {
    { 0, 1, 2 }, { 0, 2, 4 }, { 0, 4, 3 }, { 0, 1, 2 }, { 0, 1, 5 }
  };
  static const uint32_t patch[5] = { 0, 0, 0, 1, 0 };
  struct vg_mesh m = VG_MESH_INIT;

  (void)state;
  io_accept(vg_obj_parse, everything, &m);
  assert_int_equal(m.n_point, 6);
  assert_int_equal(m.n_tri, 5);
  assert_memory_equal(m.tri, tri, sizeof tri);
  assert_memory_equal(m.tri_patch, patch, sizeof patch);
  assert_int_equal(m.n_patch, 2);
  assert_string_equal(m.patch[0].name, "body");
  assert_string_equal(m.patch[1].name, "wing tip");
  vg_mesh_release(&m);
}

static void round_trip_is_exact(void **state)
{
  struct vg_mesh m, back = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  const char *path = io_temp("round.obj");

  (void)state;
  io_make_t1(&m, 0);
  m.point[0][0] = -1.0 / 3;
  for (size_t i = 0; i < 4; i++)
    snprintf(m.patch[i].name, VG_NAME_MAX, "side %zu", i);
  assert_int_equal(vg_obj_write(path, &m, &err), VG_OK);
  assert_int_equal(vg_obj_read(path, &back, &err), VG_OK);
  io_same(&m, &back, 1);
  vg_mesh_release(&m);
  vg_mesh_release(&back);
}

static void nameless_patches_get_a_name(void **state)
{
  struct vg_mesh m, back = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  const char *path = io_temp("nameless.obj");

  (void)state;
  io_make_mixed(&m);
  m.patch[0].name[0] = 0;
  assert_int_equal(vg_obj_write(path, &m, &err), VG_OK);
  assert_int_equal(vg_obj_read(path, &back, &err), VG_OK);
  assert_string_equal(back.patch[0].name, "patch_-7");
  assert_int_equal(back.n_tri, 2 + 2 * 3);
  vg_mesh_release(&m);
  vg_mesh_release(&back);
}

static void reads_gzip(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  const char *path = io_temp("sample.obj.gz");

  (void)state;
  io_write_gzip(path, sample, strlen(sample));
  assert_int_equal(vg_obj_read(path, &m, &err), VG_OK);
  assert_int_equal(m.n_tri, 1);
  vg_mesh_release(&m);
}

static void refuses_damaged_files(void **state)
{
  (void)state;
  io_refuse(vg_obj_parse, "v 0 0 0\n", VG_ERR_INPUT, "no faces");
  io_refuse(vg_obj_parse, "v 0 0 0\nv 1 0\n", VG_ERR_FORMAT, "case:2");
  io_refuse(vg_obj_parse, "v 0 0 inf\n", VG_ERR_FORMAT, "'inf'");
  io_refuse(vg_obj_parse, "v 0 0 0\nf 1 1\n", VG_ERR_FORMAT,
            "three or more corners");
  io_refuse(vg_obj_parse, "v 0 0 0\nf 1 1 -2\n", VG_ERR_FORMAT, "range");
  io_refuse(vg_obj_parse, "v 0 0 0\nf 1 1 0\n", VG_ERR_FORMAT, "'0'");
  io_refuse(vg_obj_parse, "v 0 0 0\nf 1 1 99999999999\n", VG_ERR_FORMAT,
            "range");
  io_refuse(vg_obj_parse, "v 0 0 0\n\nf 1 1 7\nf 1 1 2\n", VG_ERR_INPUT,
            "case:3");
  io_refuse_bytes(vg_obj_parse, "v 0\0 0", 6, VG_ERR_FORMAT, "binary");
}

/* Triangle counts from the collection's table. */
static void reads_real_files(void **state)
{
  static const struct {
    const char *name;
    size_t n_tri;
    int n_patch;
  } file[] = {
    { "dirty/toy_airplane_with_holes.obj.xz", 16747, 1 },
    { "dirty/drivaer_fastback_body.obj.gz", 250962, 1 },
    { "dirty/motorbike.obj.gz", 331653, 67 },
  };

  (void)state;
  for (size_t i = 0; i < sizeof file / sizeof *file; i++) {
    struct vg_mesh m = VG_MESH_INIT;
    struct vg_error err = VG_ERROR_INIT;
    const char *path = io_real(file[i].name);

    if (vg_obj_read(path, &m, &err) != VG_OK) fail_msg("%s", err.text);
    assert_int_equal(m.n_tri, file[i].n_tri);
    assert_int_equal(m.n_patch, file[i].n_patch);
    if (strstr(path, VG_TMP_DIR) == path) unlink(path);
    vg_mesh_release(&m);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(reads_the_sample),
    cmocka_unit_test(reads_polygons_and_groups),
    cmocka_unit_test(round_trip_is_exact),
    cmocka_unit_test(nameless_patches_get_a_name),
    cmocka_unit_test(reads_gzip),
    cmocka_unit_test(refuses_damaged_files),
    cmocka_unit_test(reads_real_files),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
