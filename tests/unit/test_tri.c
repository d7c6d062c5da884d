/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "io_support.h"

#include "io/mesh/tri.h"

static const char t1_sample[] =
  "4 4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 3 2\n1 2 4\n1 4 3\n2 3 4\n1\n1\n1\n1\n";

static const char t1_no_components[] =
  "   4 4\n0 0 0 1 0 0\n0 1 0 0 0 1\n1 3 2 1 2 4 1 4 3 2 3 4";

static const char t1_triq[] =
  "4 4 2\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 3 2\n1 2 4\n1 4 3\n2 3 4\n"
  "7\n-2\n7\n9\n0.5 NaN\n1 1\n1 1\n1 1\n";

static void reads_the_sample(void **state)
{
  static const uint32_t tri[4][3] = {
    { 0, 2, 1 }, { 0, 1, 3 }, { 0, 3, 2 }, { 1, 2, 3 }
  };
  struct vg_mesh m = VG_MESH_INIT;

  (void)state;
  io_accept(vg_tri_parse, t1_sample, &m);
  assert_int_equal(m.n_point, 4);
  assert_int_equal(m.n_tri, 4);
  assert_memory_equal(m.tri, tri, sizeof tri);
  assert_int_equal(m.n_patch, 1);
  assert_int_equal(m.patch[0].id, 1);
  assert_true(io_volume6(&m) > 0); /* kept: out of the solid */
  vg_mesh_release(&m);
}

static void components_are_optional(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;

  (void)state;
  io_accept(vg_tri_parse, t1_no_components, &m);
  assert_int_equal(m.n_tri, 4);
  assert_int_equal(m.n_patch, 1);
  assert_int_equal(m.patch[0].id, 1);
  vg_mesh_release(&m);
}

static void components_are_patches_by_number(void **state)
{
  static const uint32_t patch[4] = { 1, 0, 1, 2 };
  struct vg_mesh m = VG_MESH_INIT;

  (void)state;
  io_accept(vg_tri_parse, t1_triq, &m);
  assert_int_equal(m.n_patch, 3);
  assert_int_equal(m.patch[0].id, -2);
  assert_int_equal(m.patch[2].id, 9);
  assert_memory_equal(m.tri_patch, patch, sizeof patch);
  vg_mesh_release(&m);
}

static void text_round_trip_is_exact(void **state)
{
  struct vg_mesh m, back = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  const char *path = io_temp("round.tri");

  (void)state;
  io_make_t1(&m, 0);
  m.point[0][0] = 1.0 / 3;
  m.point[2][1] = 1e-17;
  assert_int_equal(vg_tri_write(path, &m, &err), VG_OK);
  assert_int_equal(vg_tri_read(path, &back, &err), VG_OK);
  io_same(&m, &back, 0);
  vg_mesh_release(&m);
  vg_mesh_release(&back);
}

static void binary_round_trips(void **state)
{
  struct vg_mesh m;
  struct vg_error err = VG_ERROR_INIT;
  const char *path = io_temp("round.bin.tri");

  (void)state;
  io_make_t1(&m, 0);
  m.point[1][0] = 0.75; /* a float, so that real*4 is exact too */
  for (int little = 0; little < 2; little++)
    for (int real = 4; real <= 8; real += 4) {
      struct vg_mesh back = VG_MESH_INIT;

      assert_int_equal(vg_tri_write_binary(path, &m, little, real, &err),
                       VG_OK);
      if (vg_tri_read(path, &back, &err) != VG_OK) fail_msg("%s", err.text);
      io_same(&m, &back, 0);
      vg_mesh_release(&back);
    }
  vg_mesh_release(&m);
}

/* A file without record markers: strip those of the record form. */
static void reads_streams_without_records(void **state)
{
  struct vg_mesh m;
  struct vg_error err = VG_ERROR_INIT;
  const char *path = io_temp("stream.tri");

  (void)state;
  io_make_t1(&m, 0);
  for (int little = 0; little < 2; little++)
    for (int real = 4; real <= 8; real += 4) {
      size_t part[4] = { 8, 12 * (size_t)real, 48, 16 }, size, at = 0, n = 0;
      struct vg_mesh back = VG_MESH_INIT;
      unsigned char *data, stream[256];

      assert_int_equal(vg_tri_write_binary(path, &m, little, real, &err),
                       VG_OK);
      data = io_slurp(path, &size);
      for (int k = 0; k < 4; k++) {
        memcpy(stream + n, data + at + 4, part[k]);
        n += part[k];
        at += part[k] + 8;
      }
      assert_int_equal(at, size);
      if (io_parse_bytes(vg_tri_parse, stream, n, &back, &err) != VG_OK)
        fail_msg("%s", err.text);
      io_same(&m, &back, 0);
      vg_mesh_release(&back);
      free(data);
    }
  vg_mesh_release(&m);
}

static void refuses_damaged_files(void **state)
{
  static const unsigned char negative[24] = { 0,    0,    0, 8, 0xff, 0xff,
                                              0xff, 0xff, 0, 0, 0,    4,
                                              0,    0,    0, 8 };
  static const unsigned char huge[24] = { 0,    0,    0,    8,    0x7f, 0xff,
                                          0xff, 0xff, 0x7f, 0xff, 0xff, 0xff,
                                          0,    0,    0,    8 };

  (void)state;
  io_refuse(vg_tri_parse, "0 0\n", VG_ERR_INPUT, "no surface");
  io_refuse(vg_tri_parse, "3 1\n0 0 0 1 0 0 0 1 0\n1 2 4\n", VG_ERR_INPUT,
            "triangle 1 refers to vertex 4");
  io_refuse(vg_tri_parse, "3 1\n0 0 0 1 0 0 0 1 0\n0 1 2\n", VG_ERR_INPUT,
            "out of range");
  io_refuse(vg_tri_parse, "3 1\n0 0 0 1 nan 0 0 1 0\n1 2 3\n", VG_ERR_FORMAT,
            "'nan'");
  io_refuse(vg_tri_parse, "4000000000 4000000000\n0 0 0\n", VG_ERR_FORMAT,
            "truncated");
  io_refuse(vg_tri_parse, "9000000000000000000 1\n0 0 0\n", VG_ERR_FORMAT,
            "32-bit");
  io_refuse(vg_tri_parse, "3 1\n0 0 0 1 0 0 0 1 0\n1 2\n", VG_ERR_FORMAT,
            "ends where");
  io_refuse(vg_tri_parse, "3 2\n0 0 0 1 0 0 0 1 0\n1 2 3 2 1 3\n1",
            VG_ERR_FORMAT, "component");
  io_refuse(vg_tri_parse, "hello world", VG_ERR_FORMAT, "hello");
  io_refuse_bytes(vg_tri_parse, negative, sizeof negative, VG_ERR_INPUT,
                  "no surface");
  io_refuse_bytes(vg_tri_parse, huge, sizeof huge, VG_ERR_FORMAT, "trunc");
  io_refuse_bytes(vg_tri_parse, "\0\1\2\3\4\5\6\7", 8, VG_ERR_FORMAT,
                  "neither text nor");
}

/* Triangle counts and edge defects from the collection's table. */
static void reads_real_files(void **state)
{
  static const struct {
    const char *name;
    size_t n_tri, bad_edges;
  } file[] = {
    { "simple/cape_bullet.tri.xz", 4890, 0 },
    { "simple/cape_ellipsoid.lr4.tri", 480, 0 },
    { "dirty/three_plugs.bin.tri.xz", 11280, 0 },
    { "dirty/openvsp_cfdmesh_lowboom.tri.xz", 62957, 3 },
    { "dirty/openvsp_cfdmesh_concorde.tri.xz", 59013, 113 + 550 },
  };

  (void)state;
  for (size_t i = 0; i < sizeof file / sizeof *file; i++) {
    struct vg_mesh m = VG_MESH_INIT;
    struct vg_error err = VG_ERROR_INIT;
    const char *path = io_real(file[i].name);

    if (vg_tri_read(path, &m, &err) != VG_OK) fail_msg("%s", err.text);
    assert_int_equal(m.n_tri, file[i].n_tri);
    assert_int_equal(io_bad_edges(&m), file[i].bad_edges);
    if (!file[i].bad_edges) assert_true(io_volume6(&m) > 0);
    if (strstr(path, VG_TMP_DIR) == path) unlink(path);
    vg_mesh_release(&m);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(reads_the_sample),
    cmocka_unit_test(components_are_optional),
    cmocka_unit_test(components_are_patches_by_number),
    cmocka_unit_test(text_round_trip_is_exact),
    cmocka_unit_test(binary_round_trips),
    cmocka_unit_test(reads_streams_without_records),
    cmocka_unit_test(refuses_damaged_files),
    cmocka_unit_test(reads_real_files),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
