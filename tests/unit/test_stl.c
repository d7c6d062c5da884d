/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "io_support.h"

#include "io/mesh/stl.h"

static const char floor_sample[] =
  "solid floor\n facet normal 0 0 -1\n  outer loop\n   vertex 0 0 0\n"
  "   vertex 0 1 0\n   vertex 1 0 0\n  endloop\n endfacet\n"
  "endsolid floor\n";

static const char two_solids[] =
  "SOLID\nFACET NORMAL nan nan nan OUTER LOOP VERTEX 0 0 0 VERTEX 1 0 0\n"
  "VERTEX 0 1 0 ENDLOOP ENDFACET\nENDSOLID\n"
  "solid empty\nendsolid empty\r\n"
  "solid  left wing \r\n facet normal 0 0 1\r\n outer loop\r\n"
  "vertex -0.0 0 -0\r\nvertex 0 1 0\r\nvertex 0 0 1e0\r\nendloop\r\n"
  "endfacet\r\nendsolid left wing";

static void reads_the_sample(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  static const uint32_t tri[3] = { 0, 1, 2 };

  (void)state;
  io_accept(vg_stl_parse, floor_sample, &m);
  assert_int_equal(m.n_point, 3);
  assert_int_equal(m.n_tri, 1);
  assert_memory_equal(m.tri[0], tri, sizeof tri);
  assert_true(m.point[1][1] == 1 && m.point[2][0] == 1);
  assert_int_equal(m.n_patch, 1);
  assert_string_equal(m.patch[0].name, "floor");
  assert_int_equal(m.patch[0].id, 1);
  assert_int_equal(m.patch[0].bc, VG_BC_NONE);
  vg_mesh_release(&m);
}

static void welds_bits_and_names_solids(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;

  (void)state;
  io_accept(vg_stl_parse, two_solids, &m);
  assert_int_equal(m.n_tri, 2);
  assert_int_equal(m.n_point, 4); /* origin with -0 and (0 1 0) are shared */
  assert_int_equal(m.n_patch, 2);
  assert_string_equal(m.patch[0].name, "");
  assert_string_equal(m.patch[1].name, "left wing");
  assert_int_equal(m.tri[1][0], m.tri[0][0]);
  assert_false(__builtin_signbit(m.point[m.tri[1][0]][0]));
  vg_mesh_release(&m);
}

static void text_round_trip_is_exact(void **state)
{
  struct vg_mesh m, back = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  const char *path = io_temp("round.stl");

  (void)state;
  io_make_t1(&m, 0);
  m.point[0][0] = 1.0 / 3;
  m.point[1][1] = -1.25e-45;
  m.point[2][2] = 123456789.123456789;
  for (size_t i = 0; i < 4; i++)
    snprintf(m.patch[i].name, VG_NAME_MAX, "side %zu", i);
  assert_int_equal(vg_stl_write(path, &m, &err), VG_OK);
  assert_int_equal(vg_stl_read(path, &back, &err), VG_OK);
  io_same(&m, &back, 1);
  vg_mesh_release(&m);
  vg_mesh_release(&back);
}

static void binary_round_trip_keeps_floats(void **state)
{
  struct vg_mesh m, back = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  const char *path = io_temp("round_binary.stl");
  unsigned char *data;
  size_t size;

  (void)state;
  io_make_t1(&m, 0);
  m.point[3][2] = 0.3; /* not a float: must be read back as the nearest one */
  assert_int_equal(vg_stl_write_binary(path, &m, &err), VG_OK);
  assert_int_equal(vg_stl_read(path, &back, &err), VG_OK);
  assert_int_equal(back.n_point, 4);
  assert_int_equal(back.n_tri, 4);
  assert_int_equal(back.n_patch, 1);
  io_same_array(m.tri, back.tri, 4, sizeof *m.tri);
  assert_true(back.point[3][2] == (double)0.3f);
  data = io_slurp(path, &size);
  assert_int_equal(size, 84 + 4 * 50);
  memcpy(data, "solid trap", 10); /* real headers begin like this */
  vg_mesh_release(&back);
  assert_int_equal(io_parse_bytes(vg_stl_parse, data, size, &back, &err),
                   VG_OK);
  assert_int_equal(back.n_tri, 4);
  free(data);
  vg_mesh_release(&m);
  vg_mesh_release(&back);
}

static void quadrilaterals_are_split(void **state)
{
  struct vg_mesh m, back = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  const char *path = io_temp("quads.stl");

  (void)state;
  io_make_mixed(&m);
  assert_int_equal(vg_stl_write(path, &m, &err), VG_OK);
  assert_int_equal(vg_stl_read(path, &back, &err), VG_OK);
  assert_int_equal(back.n_tri, 2 + 2 * 3);
  assert_int_equal(back.n_patch, 3);
  assert_string_equal(back.patch[1].name, "front side");
  vg_mesh_release(&m);
  vg_mesh_release(&back);
}

static void reads_gzip(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  const char *path = io_temp("floor.stl.gz");

  (void)state;
  io_write_gzip(path, floor_sample, strlen(floor_sample));
  assert_int_equal(vg_stl_read(path, &m, &err), VG_OK);
  assert_int_equal(m.n_tri, 1);
  vg_mesh_release(&m);
}

static void refuses_damaged_files(void **state)
{
  unsigned char binary[84 + 50] = { 0 };
  const float nan_value = __builtin_nanf("");

  (void)state;
  io_refuse(vg_stl_parse, "solid x\nendsolid x\n", VG_ERR_INPUT, "no facets");
  io_refuse(vg_stl_parse,
            "solid x\nfacet normal 0 0 1\nouter loop\n"
            "vertex 0 0 0\nvertex 1 0",
            VG_ERR_FORMAT, "case:5");
  io_refuse(vg_stl_parse,
            "solid x\nfacet normal 0 0 1 outer loop vertex 0 0 "
            "0 vertex 1 0 0 vertex 0 1 0 endloop endfacet\n",
            VG_ERR_FORMAT, "truncated");
  io_refuse(vg_stl_parse,
            "solid x\nfacet normal 0 0 1 outer loop vertex 0 0 "
            "0 vertex 1 0 0 vertex 0 1 0 vertex 1 1 0 endloop endfacet\n",
            VG_ERR_FORMAT, "more than three");
  io_refuse(vg_stl_parse,
            "solid x\nfacet normal 0 0 1 outer loop vertex 0 "
            "nan 0 vertex",
            VG_ERR_FORMAT, "'nan'");
  io_refuse(vg_stl_parse, "4 4\n0 0 0\n", VG_ERR_FORMAT, "'solid'");
  binary[80] = 2; /* two facets, room for one */
  io_refuse_bytes(vg_stl_parse, binary, sizeof binary, VG_ERR_FORMAT,
                  "84 + 50 x 2");
  binary[80] = 1;
  memcpy(binary + 84 + 12, &nan_value, 4);
  io_refuse_bytes(vg_stl_parse, binary, sizeof binary, VG_ERR_INPUT,
                  "facet 1, vertex 1");
  memset(binary + 80, 0, 4);
  io_refuse_bytes(vg_stl_parse, binary, 84, VG_ERR_INPUT, "no facets");
}

/* The collection's table: 17,064 triangles, 110 free edges. */
static void reads_a_real_file(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  const char *path = io_real("dirty/f16_components_overlapping.stl.xz");

  (void)state;
  if (vg_stl_read(path, &m, &err) != VG_OK) fail_msg("%s", err.text);
  assert_int_equal(m.n_tri, 17064);
  assert_int_equal(io_bad_edges(&m), 110);
  unlink(path);
  vg_mesh_release(&m);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(reads_the_sample),
    cmocka_unit_test(welds_bits_and_names_solids),
    cmocka_unit_test(text_round_trip_is_exact),
    cmocka_unit_test(binary_round_trip_keeps_floats),
    cmocka_unit_test(quadrilaterals_are_split),
    cmocka_unit_test(reads_gzip),
    cmocka_unit_test(refuses_damaged_files),
    cmocka_unit_test(reads_a_real_file),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
